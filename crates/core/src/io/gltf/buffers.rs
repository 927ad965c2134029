//! The bytes that a document refers to: the binary chunk, data addresses and external files.

use base64::Engine as _;
use base64::alphabet;
use base64::engine::general_purpose::GeneralPurpose;
use base64::engine::{DecodePaddingMode, GeneralPurposeConfig};
use gltf::Document;
use gltf::buffer::{Source, View};

use crate::io::detect::MeshFormat;
use crate::io::gltf::{DECOMPRESS, is_compression, malformed};
use crate::io::read::{Place, ReadError, Resolver, brief};

/// All buffers of a document, at least as long as it says.
pub(super) struct Buffers(Vec<Vec<u8>>);

impl Buffers {
    pub(super) fn load(
        document: &Document,
        mut blob: Option<Vec<u8>>,
        resolver: &Resolver<'_>,
    ) -> Result<Self, ReadError> {
        let mut buffers = Vec::new();
        for buffer in document.buffers() {
            let place = Place::Item("buffer", buffer.index());
            let bytes = match buffer.source() {
                Source::Bin => blob.take().ok_or_else(|| without_address(document, place))?,
                Source::Uri(uri) => match uri.strip_prefix("data:") {
                    Some(data) => {
                        embedded(data).ok_or_else(|| malformed(place, "its data is not base64".into()))?
                    }
                    None => resolver(&percent_decoded(uri)).map_err(|reason| ReadError::Missing {
                        format: MeshFormat::Gltf,
                        uri: brief(uri),
                        reason,
                    })?,
                },
            };
            if bytes.len() < buffer.length() {
                return Err(ReadError::Truncated {
                    format: MeshFormat::Gltf,
                    place,
                    problem: format!("it should have {} bytes, but has {}", buffer.length(), bytes.len()),
                });
            }
            buffers.push(bytes);
        }
        Ok(Self(buffers))
    }

    /// Some bytes of a buffer; `None` if there are none such.
    pub(super) fn bytes(&self, buffer: usize, offset: u64, length: u64) -> Option<&[u8]> {
        let start = usize::try_from(offset).ok()?;
        self.0.get(buffer)?.get(start..start.checked_add(usize::try_from(length).ok()?)?)
    }

    /// The bytes of a view; `None` if it reaches beyond its buffer.
    pub(super) fn view(&self, view: &View<'_>) -> Option<&[u8]> {
        let end = view.offset().checked_add(view.length())?;
        self.0.get(view.buffer().index())?.get(view.offset()..end)
    }
}

/// Compressed files have such buffers, for what is unpacked.
fn without_address(document: &Document, place: Place) -> ReadError {
    match document.extensions_used().find(|extension| is_compression(extension)) {
        Some(extension) => ReadError::Unsupported {
            format: MeshFormat::Gltf,
            place,
            what: format!("a buffer compressed with {}", brief(extension)),
            advice: DECOMPRESS,
        },
        None => malformed(place, "it has no address, and there is no binary chunk".into()),
    }
}

/// What stands behind `data:`.
pub(super) fn embedded(data: &str) -> Option<Vec<u8>> {
    // Some exporters leave out the padding.
    let lenient = GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent);
    let (_, base64) = data.split_once(";base64,")?;
    GeneralPurpose::new(&alphabet::STANDARD, lenient).decode(base64).ok()
}

/// `%20` and the like replaced by the bytes they stand for; left alone if that makes no text.
pub(super) fn percent_decoded(uri: &str) -> String {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, tail @ ..] = rest {
        let hex = |byte: u8| char::from(byte).to_digit(16).map(|digit| digit as u8);
        rest = match (first, tail) {
            (b'%', [high, low, after @ ..]) if hex(*high).is_some() && hex(*low).is_some() => {
                bytes.extend(hex(*high).zip(hex(*low)).map(|(high, low)| high * 16 + low));
                after
            }
            _ => {
                bytes.push(*first);
                tail
            }
        };
    }
    String::from_utf8(bytes).unwrap_or_else(|_| uri.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses() {
        assert_eq!(percent_decoded("a%20b%C3%A9.bin"), "a b\u{e9}.bin");
        assert_eq!(percent_decoded("100%.bin%2"), "100%.bin%2");
        assert_eq!(percent_decoded("%ff"), "%ff");
        assert_eq!(embedded("application/octet-stream;base64,AQID"), Some(vec![1, 2, 3]));
        assert_eq!(embedded(";base64,AQ"), Some(vec![1]));
        assert_eq!(embedded(";base64,A*"), None);
        assert_eq!(embedded("text/plain,abc"), None);
    }
}

//! Materials and their pictures.

use glam::{DAffine2, DVec2, DVec4};

use super::color::from_srgb8;

/// What gives a polygon its base colour.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// The factor: linear red, green, blue, and alpha.
    pub base_color: DVec4,
    /// The texture that the factor is multiplied by.
    pub texture: Option<Texture>,
    /// What colours at corners do to it.
    pub tint: Tint,
}

impl Default for Material {
    fn default() -> Self {
        Self { base_color: DVec4::ONE, texture: None, tint: Tint::Multiply }
    }
}

/// How colours at corners and a material go together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tint {
    /// The material's colour is multiplied by them, as glTF wants it (section 3.9.2).
    Multiply,
    /// They stand in for the factor of a material without a texture; a texture hides them. OBJ does not say: its
    /// programs draw either the one or the other.
    Replace,
}

/// A picture on the surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// Its index in [`MeshAttributes::images`](super::MeshAttributes::images).
    pub image: usize,
    /// The set of texture coordinates, an index into [`MeshAttributes::uv`](super::MeshAttributes::uv).
    pub uv_set: usize,
    /// Applied to coordinates whose origin is the upper left corner (`KHR_texture_transform`).
    pub transform: DAffine2,
    /// How the picture goes on beyond its edges, to the side and up.
    pub wrap: [Wrap; 2],
    /// What lies between the middles of texels.
    pub filter: Filter,
}

/// How a picture goes on beyond its edge.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// It starts anew.
    #[default]
    Repeat,
    /// It is mirrored every second time.
    Mirror,
    /// The texels of its edge go on.
    Clamp,
}

impl Wrap {
    /// The texel that stands at `index`, of `count`.
    fn apply(self, index: f64, count: u32) -> u32 {
        let n = f64::from(count);
        let inside = match self {
            Self::Repeat => index - (index / n).floor() * n,
            Self::Mirror => {
                let at = index - (index / (2.0 * n)).floor() * 2.0 * n;
                if at < n { at } else { 2.0 * n - 1.0 - at }
            }
            Self::Clamp => index,
        };
        // Also where the index is so large that the subtraction rounds, or not a number.
        inside.clamp(0.0, n - 1.0) as u32
    }
}

/// What lies between the middles of texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// The colour of the nearest texel.
    Nearest,
    /// Linear light between the four texels around.
    #[default]
    Linear,
}

/// A picture in memory: 8-bit sRGB with straight alpha.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    width: u32,
    height: u32,
    texels: Vec<[u8; 4]>,
}

/// Why bytes are not a picture.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// They are not a PNG or JPEG file, or a damaged one, or one with very long sides.
    #[error("{0}")]
    Unreadable(String),
    /// It has more texels than there may be.
    #[error("the picture has more texels than the limit")]
    TooLarge,
    /// The reader of pictures was left out of this build.
    #[error("this build reads no textures: build ldwrap with the feature of that name")]
    Disabled,
}

/// The longest side of a picture, and the most bytes that decoding may take.
#[cfg(feature = "textures")]
const LARGEST: (u32, u64) = (1 << 15, 1 << 30);

impl Image {
    /// A picture of these texels, row by row from the upper left.
    ///
    /// # Panics
    /// If there is no texel, or not `width` in each row.
    pub fn new(width: u32, texels: Vec<[u8; 4]>) -> Self {
        let height = texels.len() / width as usize;
        assert!(height > 0 && texels.len() == width as usize * height, "rows of {width} texels");
        Self { width, height: height as u32, texels }
    }

    /// Width and height, in texels.
    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// The bytes of a PNG or JPEG file. Pictures of more than 32,768 texels to a side, or that need more than a
    /// gigabyte to decode, are refused. 16-bit channels are rounded to 8; embedded colour profiles are passed over.
    ///
    /// # Errors
    /// [`ImageError`].
    pub fn decode(bytes: &[u8]) -> Result<Self, ImageError> {
        Self::decode_within(bytes, u64::MAX)
    }

    /// As [`decode`](Self::decode); pictures of more than `most` texels are refused before memory is taken for them.
    ///
    /// # Errors
    /// [`ImageError`].
    pub fn decode_within(bytes: &[u8], most: u64) -> Result<Self, ImageError> {
        #[cfg(feature = "textures")]
        {
            let unreadable = |error: image::ImageError| ImageError::Unreadable(error.to_string());
            let reader = || {
                image::ImageReader::new(std::io::Cursor::new(bytes))
                    .with_guessed_format()
                    .map_err(|error| ImageError::Unreadable(error.to_string()))
            };
            let (width, height) = reader()?.into_dimensions().map_err(unreadable)?;
            if u64::from(width) * u64::from(height) > most {
                return Err(ImageError::TooLarge);
            }
            let mut reader = reader()?;
            let mut limits = image::Limits::default();
            limits.max_image_width = Some(LARGEST.0);
            limits.max_image_height = Some(LARGEST.0);
            limits.max_alloc = Some(LARGEST.1);
            reader.limits(limits);
            let decoded = reader.decode().map_err(unreadable)?.into_rgba8();
            let (width, height) = decoded.dimensions();
            if width == 0 || height == 0 {
                return Err(ImageError::Unreadable("the picture is empty".to_owned()));
            }
            Ok(Self { width, height, texels: decoded.pixels().map(|p| p.0).collect() })
        }
        #[cfg(not(feature = "textures"))]
        {
            let _ = (bytes, most);
            Err(ImageError::Disabled)
        }
    }

    /// The linear colour at coordinates whose origin is the upper left corner, in widths and heights of the picture.
    pub fn at(&self, place: DVec2, wrap: [Wrap; 2], filter: Filter) -> DVec4 {
        let size = DVec2::new(self.width.into(), self.height.into());
        let texel = |x: f64, y: f64| {
            let (column, row) = (wrap[0].apply(x, self.width), wrap[1].apply(y, self.height));
            from_srgb8(self.texels[row as usize * self.width as usize + column as usize])
        };
        let at = place * size;
        match filter {
            Filter::Nearest => texel(at.x.floor(), at.y.floor()),
            Filter::Linear => {
                let middle = at - 0.5;
                let corner = middle.floor();
                let share = middle - corner;
                let row = |y: f64| texel(corner.x, y) * (1.0 - share.x) + texel(corner.x + 1.0, y) * share.x;
                // A coordinate that is not finite has no share: the texel at the corner.
                if share.is_finite() {
                    row(corner.y) * (1.0 - share.y) + row(corner.y + 1.0) * share.y
                } else {
                    texel(corner.x, corner.y)
                }
            }
        }
    }
}

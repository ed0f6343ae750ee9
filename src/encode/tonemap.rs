//! Tone mapping curves.

use crate::base::color::{Rgb, linear_to_srgb};

/// A curve from linear radiance to display values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tonemap {
    /// Clip at 1 and encode with the sRGB transfer function.
    #[default]
    Srgb,
    /// Clip at 1 and display linear values as they are.
    None,
    /// Scale every pixel so that its luminance L becomes L / (1 + L), then encode like [`Tonemap::Srgb`]. White never
    /// clips and hues are preserved, except that saturated colours still clip (Reinhard, Stark, Shirley, Ferwerda,
    /// *Photographic Tone Reproduction for Digital Images*, 2002, equation 3).
    Reinhard,
    /// An S-shaped film curve on each channel, then encode like [`Tonemap::Srgb`]. Shadows become deeper, and
    /// highlights roll off and desaturate. The fit is from Narkowicz, *ACES Filmic Tone Mapping Curve*, 2015. It maps
    /// radiance 1 to 0.80 and radiance 7.25 to white.
    Filmic,
}

/// Relative luminance of linear sRGB (Rec. 709).
const LUMINANCE: Rgb = Rgb::new(0.2126, 0.7152, 0.0722);

impl Tonemap {
    /// All curves with the names that users write.
    pub const NAMED: [(&'static str, Self); 4] =
        [("Srgb", Self::Srgb), ("None", Self::None), ("Reinhard", Self::Reinhard), ("Filmic", Self::Filmic)];

    /// Whether colours pass through [`compressed`] before [`Tonemap::displayed`] maps each channel.
    pub(super) fn compresses(self) -> bool {
        self == Self::Reinhard
    }

    /// The display value of one linear channel of 0 or more, at most 1. It never decreases as `linear` increases.
    pub(super) fn displayed(self, linear: f64) -> f64 {
        let displayed = match self {
            Self::Srgb | Self::Reinhard => linear_to_srgb(linear),
            Self::None => linear,
            Self::Filmic => linear_to_srgb(filmic(linear).min(1.0)),
        };
        displayed.min(1.0)
    }
}

/// The linear display value of scene radiance (Narkowicz 2015).
fn filmic(x: f64) -> f64 {
    x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)
}

/// Scales a colour so that its luminance L becomes L / (1 + L). Negative components and NaN count as 0, because they
/// display as 0. Infinity counts as the largest f32.
pub(super) fn compressed(color: [f32; 3]) -> [f32; 3] {
    let color = Rgb::from_array(color.map(|c| if c > 0.0 { c.min(f32::MAX) } else { 0.0 }));
    (color / (1.0 + color.dot(LUMINANCE))).to_array()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn compressed_luminance_never_reaches_one_and_hues_hold() {
        for luminance in [0.0, 0.18, 1.0, 4.0, 1e6] {
            let grey = compressed([luminance; 3])[0];
            assert!((grey - luminance / (1.0 + luminance)).abs() < 1e-6, "{luminance} {grey}");
        }
        let [r, g, b] = compressed([8.0, 4.0, 2.0]);
        assert!((r - 2.0 * g).abs() < 1e-6 && (g - 2.0 * b).abs() < 1e-6, "{r} {g} {b}");
    }

    #[test]
    fn invalid_colours_are_compressed_to_valid_ones() {
        assert_eq!(compressed([f32::NAN, -1.0, 0.0]), [0.0; 3]);
        assert!(compressed([f32::INFINITY, 1.0, 0.0])[0] > 1.0);
        assert!(compressed([f32::INFINITY; 3])[0] > 0.999);
    }

    #[test]
    fn filmic_passes_through_its_known_points() {
        assert_eq!(filmic(0.0), 0.0);
        assert!((filmic(1.0) - 2.54 / 3.16).abs() < 1e-15);
        assert!(filmic(7.24) < 1.0 && filmic(7.25) > 1.0);
    }
}

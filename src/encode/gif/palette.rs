//! One palette for a whole animation.

use super::histogram::Weighted;
use crate::color::srgb_to_linear;
use quantette::deps::palette::Oklab;
use quantette::kmeans::{Kmeans, KmeansOptions};
use quantette::wu::{BinnerF32x3, WuF32x3};
use quantette::{PaletteBuf, PaletteCounts, PaletteSize, color_space};

/// How many samples k-means sees: enough for about 500 per colour of a full palette.
const SAMPLES: u32 = 1 << 17;

/// Distinct colours, in the order of their bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Palette {
    colors: Vec<[u8; 3]>,
    exact: bool,
}

impl Palette {
    /// The animation has no other colours than these.
    pub fn exact(mut colors: Vec<[u8; 3]>) -> Self {
        colors.sort_unstable();
        colors.dedup();
        Self { colors, exact: true }
    }

    /// At most `size` colours (2..=256) that stand for those of an animation: Wu's method to start from, then
    /// k-means in Oklab over samples drawn in proportion to the counts. The same input gives the same palette.
    pub fn clustered(weighted: &[Weighted], size: usize) -> Self {
        let oklab: Vec<Oklab> = weighted.iter().map(|w| oklab(w.color.map(linear_of_code))).collect();
        let counts = scaled_counts(weighted);
        let size = PaletteSize::try_from(size.clamp(1, 256)).unwrap_or(PaletteSize::MAX);
        let centroids = PaletteCounts::new(oklab.clone(), counts.clone())
            .ok()
            .and_then(|counts| WuF32x3::run_palette_counts(&counts, BinnerF32x3::oklab_from_srgb8()))
            .map(|wu| wu.palette(size));
        let Some(centroids) = centroids else { return Self::exact(vec![[0; 3]]) };
        let colors = refined(&samples(&oklab, &counts), centroids);
        let bytes = color_space::oklab_to_srgb8(&colors).into_iter().map(Into::into).collect();
        Self { exact: false, ..Self::exact(bytes) }
    }

    pub fn colors(&self) -> &[[u8; 3]] {
        &self.colors
    }

    /// Whether every colour of the animation is in the palette as it is.
    pub fn is_exact(&self) -> bool {
        self.exact
    }
}

/// k-means from `centroids` on; they come back as they are if there is nothing to learn from.
fn refined(samples: &[Oklab], centroids: PaletteBuf<Oklab>) -> Vec<Oklab> {
    let options = KmeansOptions::new().sampling_factor(f32::INFINITY).max_samples(SAMPLES);
    match Kmeans::run_slice(samples, centroids.clone(), options) {
        Ok(kmeans) => kmeans.into_palette().into_vec(),
        Err(_) => centroids.into_vec(),
    }
}

/// The counts as weights whose sum fits the quantiser's `u32`; none becomes zero.
fn scaled_counts(weighted: &[Weighted]) -> Vec<u32> {
    let total: u64 = weighted.iter().map(|w| w.count).sum();
    let divisor = (total >> 31) + 1;
    weighted.iter().map(|w| (w.count / divisor).max(1) as u32).collect()
}

/// A list of colours in which each is as frequent as its count says: every n-th pixel of the animation, as
/// if its pixels were sorted by colour.
fn samples(colors: &[Oklab], counts: &[u32]) -> Vec<Oklab> {
    let total: u64 = counts.iter().map(|&count| u64::from(count)).sum();
    let wanted = total.min(u64::from(SAMPLES));
    let (mut seen, mut taken) = (0, 0);
    let mut samples = Vec::with_capacity(wanted as usize);
    for (&color, &count) in colors.iter().zip(counts) {
        seen += u64::from(count);
        while taken < wanted && taken * total < seen * wanted {
            samples.push(color);
            taken += 1;
        }
    }
    samples
}

/// Linear light of an sRGB code with fractions.
pub fn linear_of_code(code: f32) -> f32 {
    srgb_to_linear(f64::from(code) / 255.0) as f32
}

/// Cone responses of a linear sRGB colour, and Oklab from their cube roots
/// (Ottosson, <https://bottosson.github.io/posts/oklab/>).
pub const RGB_TO_LMS: [[f32; 3]; 3] = [
    [0.412_221_47, 0.536_332_54, 0.051_445_993],
    [0.211_903_5, 0.680_699_5, 0.107_396_96],
    [0.088_302_46, 0.281_718_84, 0.629_978_7],
];
pub const LMS_ROOT_TO_OKLAB: [[f32; 3]; 3] = [
    [0.210_454_26, 0.793_617_8, -0.004_072_047],
    [1.977_998_5, -2.428_592_2, 0.450_593_7],
    [0.025_904_037, 0.782_771_77, -0.808_675_77],
];

pub fn multiply(matrix: &[[f32; 3]; 3], v: [f32; 3]) -> [f32; 3] {
    matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

/// Oklab of a linear colour.
pub fn oklab(linear: [f32; 3]) -> Oklab {
    let [l, a, b] = multiply(&LMS_ROOT_TO_OKLAB, multiply(&RGB_TO_LMS, linear).map(libm::cbrtf));
    Oklab { l, a, b }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube() -> Vec<Weighted> {
        let color = |i: u32| [i & 15, (i >> 4) & 15, i >> 8].map(|c| (c * 17) as f32);
        (0..4096).map(|i| Weighted { color: color(i), count: u64::from(i % 7 + 1) << 33 }).collect()
    }

    #[test]
    fn the_same_every_time_and_never_larger_than_asked() {
        for size in [1, 2, 16] {
            let palette = Palette::clustered(&cube(), size);
            assert!((1..=size).contains(&palette.colors().len()));
            assert_eq!(palette, Palette::clustered(&cube(), size));
            assert!(!palette.is_exact());
        }
        assert!((240..=256).contains(&Palette::clustered(&cube(), 256).colors().len()));
    }

    #[test]
    fn rare_colors_are_far_from_lost() {
        let mut weighted = cube();
        for w in &mut weighted {
            w.color[1] = w.color[0];
            w.color[2] = w.color[0];
        }
        weighted.push(Weighted { color: [255.0, 0.0, 0.0], count: 1 << 38 });
        let palette = Palette::clustered(&weighted, 64);
        assert!(palette.colors().iter().any(|&[r, g, b]| r > 240 && g < 40 && b < 40), "{palette:?}");
    }

    #[test]
    fn oklab_of_known_colors() {
        let white = oklab([1.0; 3]);
        assert!((white.l - 1.0).abs() < 1e-5 && white.a.abs() < 1e-5 && white.b.abs() < 1e-5);
        let red = oklab([1.0, 0.0, 0.0]);
        assert!((red.l - 0.62796).abs() < 1e-4 && (red.a - 0.22486).abs() < 1e-4);
    }
}

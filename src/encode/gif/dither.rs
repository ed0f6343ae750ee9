//! Dithering: the palette colours whose mix looks like a colour.

use super::oklab::{LMS_ROOT_TO_OKLAB, RGB_TO_LMS, linear_of_code, multiply, oklab};
use super::palette::Palette;

/// Colours in a mix. The threshold of a pixel selects one of them.
pub const PARTS: usize = 16;
/// Palette colours around the nearest one that a mix may contain.
const NEIGHBORS: usize = 24;
/// Weight of a part's own distance from the colour, relative to the error of the mix. It costs little accuracy: a
/// colour up to 1/16 of the way to the next palette colour stays flat. Without it, colours outside the palette's gamut
/// would be mixed from distant colours, which shows as coloured dots.
const DISTANCE_WEIGHT: f32 = 1.0;
/// Minimum cone response for the slope of the cube root, which is infinite at 0.
const MIN_RESPONSE: f32 = 1e-3;

/// Maps colours to the nearest palette colour, or to a mix in linear light that looks like the colour.
pub struct Mixer {
    palette: Palette,
    dither: bool,
    /// Palette colours in Oklab, one list per axis.
    oklab: [Vec<f32>; 3],
    lms: Vec<[f32; 3]>,
    /// For each palette colour, the nearest palette colours. The first is itself.
    neighbors: Vec<Vec<u8>>,
    /// The linear value of each code.
    linear: Vec<f32>,
}

impl Mixer {
    pub fn new(palette: Palette, dither: bool) -> Self {
        let linear: Vec<f32> = (0..=255u8).map(|code| linear_of_code(f32::from(code))).collect();
        let linears = palette.colors().iter().map(|c| c.map(|code| linear[usize::from(code)]));
        let mut perceived: [Vec<f32>; 3] = Default::default();
        let mut lms = Vec::new();
        for color in linears {
            let lab = oklab(color);
            for (axis, value) in perceived.iter_mut().zip([lab.l, lab.a, lab.b]) {
                axis.push(value);
            }
            lms.push(multiply(&RGB_TO_LMS, color));
        }
        let dither = dither && !palette.is_exact();
        let mut mixer = Self { palette, dither, oklab: perceived, lms, neighbors: Vec::new(), linear };
        mixer.neighbors = (0..mixer.lms.len()).map(|i| mixer.around(i)).collect();
        mixer
    }

    pub fn palette(&self) -> &Palette {
        &self.palette
    }

    /// The palette indices of the mix for `color`, from dark to light. They depend on the colour alone.
    pub fn mix(&self, color: [u8; 3]) -> [u8; PARTS] {
        if self.palette.is_exact() {
            return [self.palette.colors().binary_search(&color).unwrap_or(0) as u8; PARTS];
        }
        let linear = color.map(|code| self.linear[usize::from(code)]);
        let lab = oklab(linear);
        let nearest = self.nearest([lab.l, lab.a, lab.b]);
        let close = self.palette.colors()[nearest].iter().zip(color).all(|(p, c)| p.abs_diff(c) <= 1);
        if close || !self.dither {
            return [nearest as u8; PARTS];
        }
        self.mix_around(nearest, multiply(&RGB_TO_LMS, linear))
    }

    /// The index of the palette colour nearest to a colour.
    pub fn flat(&self, color: [u8; 3]) -> u8 {
        if let Ok(index) = self.palette.colors().binary_search(&color) {
            return index as u8;
        }
        let lab = oklab(color.map(|code| self.linear[usize::from(code)]));
        self.nearest([lab.l, lab.a, lab.b]) as u8
    }

    /// Adds parts greedily, so that the sum of their deviations stays closest to zero. Light adds linearly, so
    /// deviations are differences of cone responses. The derivative of Oklab at the colour gives their perceived size.
    fn mix_around(&self, nearest: usize, target: [f32; 3]) -> [u8; PARTS] {
        let slope = target.map(|response| {
            let root = libm::cbrtf(response.max(MIN_RESPONSE));
            1.0 / (3.0 * root * root)
        });
        let candidates = &self.neighbors[nearest];
        let mut deviations = [[0.0; 3]; NEIGHBORS];
        for (deviation, &index) in deviations.iter_mut().zip(candidates) {
            let lms = self.lms[usize::from(index)];
            let scaled = [0, 1, 2].map(|i| slope[i] * (lms[i] - target[i]));
            *deviation = multiply(&LMS_ROOT_TO_OKLAB, scaled);
        }
        let deviations = &deviations[..candidates.len()];
        let mut sum = [0.0; 3];
        let mut parts = [0; PARTS];
        for part in &mut parts {
            let cost = |d: &[f32; 3]| {
                square([sum[0] + d[0], sum[1] + d[1], sum[2] + d[2]]) + DISTANCE_WEIGHT * square(*d)
            };
            let best = first_least(deviations.iter().map(cost));
            sum = [0, 1, 2].map(|i| sum[i] + deviations[best][i]);
            *part = candidates[best];
        }
        let lightness = |&index: &u8| self.oklab[0][usize::from(index)];
        parts.sort_by(|a, b| lightness(a).total_cmp(&lightness(b)).then(a.cmp(b)));
        parts
    }

    fn nearest(&self, lab: [f32; 3]) -> usize {
        let [l, a, b] = &self.oklab;
        let distances = l.iter().zip(a).zip(b);
        first_least(distances.map(|((l, a), b)| square([l - lab[0], a - lab[1], b - lab[2]])))
    }

    fn around(&self, index: usize) -> Vec<u8> {
        let [l, a, b] = &self.oklab;
        let distance = |i: u8| {
            let i = usize::from(i);
            square([l[i] - l[index], a[i] - a[index], b[i] - b[index]])
        };
        let mut all: Vec<u8> = (0..l.len()).map(|i| i as u8).collect();
        all.sort_by(|&i, &j| distance(i).total_cmp(&distance(j)).then(i.cmp(&j)));
        all.truncate(NEIGHBORS);
        all
    }
}

fn square([x, y, z]: [f32; 3]) -> f32 {
    x * x + y * y + z * z
}

/// Index of the least value, the first of equals.
fn first_least(values: impl Iterator<Item = f32>) -> usize {
    let mut least = (f32::INFINITY, 0);
    for (index, value) in values.enumerate() {
        if value < least.0 {
            least = (value, index);
        }
    }
    least.1
}

#[cfg(test)]
mod tests {
    use super::super::palette::WeightedColor;
    use super::*;

    fn grays(codes: &[u8]) -> Palette {
        let weighted: Vec<_> =
            codes.iter().map(|&c| WeightedColor { color: [f32::from(c); 3], count: 1000 }).collect();
        Palette::clustered(&weighted, codes.len())
    }

    #[test]
    fn mixes_preserve_linear_light() {
        let mixer = Mixer::new(grays(&[0, 80, 160, 255]), true);
        for code in 0..=255u8 {
            let parts = mixer.mix([code; 3]);
            let light = |part: &u8| {
                let color = mixer.palette.colors()[usize::from(*part)];
                mixer.linear[usize::from(color[1])]
            };
            let mean = parts.iter().map(light).sum::<f32>() / PARTS as f32;
            let wanted = mixer.linear[usize::from(code)];
            assert!((mean - wanted).abs() < 0.04, "{code}: {mean} instead of {wanted}");
        }
    }

    #[test]
    fn palette_colors_and_their_neighbors_stay_flat() {
        let mixer = Mixer::new(grays(&[0, 80, 160, 255]), true);
        for (index, &[r, g, b]) in mixer.palette.colors().iter().enumerate() {
            assert_eq!(mixer.mix([r, g, b]), [index as u8; PARTS]);
            assert_eq!(mixer.mix([r.saturating_sub(1), g, b.saturating_add(1)]), [index as u8; PARTS]);
        }
    }

    #[test]
    fn without_dither_the_nearest_color_is_used() {
        let mixer = Mixer::new(grays(&[0, 80, 160, 255]), false);
        for code in 0..=255u8 {
            let parts = mixer.mix([code; 3]);
            assert!(parts.iter().all(|&part| part == parts[0]));
        }
        assert_eq!(mixer.mix([100; 3])[0], 1);
    }

    #[test]
    fn exact_palettes_are_looked_up() {
        let mixer = Mixer::new(Palette::exact(vec![[1, 2, 3], [1, 2, 4], [0, 0, 0]]), true);
        assert_eq!(mixer.mix([1, 2, 3]), [1; PARTS]);
        assert_eq!(mixer.mix([1, 2, 4]), [2; PARTS]);
    }
}

//! One palette for a whole animation.

use super::histogram::Weighted;
use crate::base::color::{linear_to_srgb, srgb_to_linear};
use rayon::prelude::*;

/// How often centres are moved, at most.
const ROUNDS: usize = 16;

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

    /// At most `size` colours (2..=256) that stand for those of an animation: clusters in Oklab, divided until there
    /// are enough, then moved to where they fit best. The same input gives the same palette.
    pub fn clustered(weighted: &[Weighted], size: usize) -> Self {
        let points: Vec<Point> = weighted.iter().map(Point::new).collect();
        let mut centers = divided(&points, size.clamp(1, 256));
        for _ in 0..ROUNDS {
            if !settle(&points, &mut centers) {
                break;
            }
        }
        Self { exact: false, ..Self::exact(centers.into_iter().map(code_of_oklab).collect()) }
    }

    pub fn colors(&self) -> &[[u8; 3]] {
        &self.colors
    }

    /// Whether every colour of the animation is in the palette as it is.
    pub fn is_exact(&self) -> bool {
        self.exact
    }
}

/// A colour as it looks, and how much of it there is.
struct Point {
    place: [f32; 3],
    weight: f64,
}

impl Point {
    fn new(weighted: &Weighted) -> Self {
        let Oklab { l, a, b } = oklab(weighted.color.map(linear_of_code));
        Self { place: [l, a, b], weight: weighted.count as f64 }
    }
}

/// A part of the colours.
struct Cluster {
    members: Vec<u32>,
    mean: [f64; 3],
    /// Squared distances from the mean along each axis, summed.
    spread: [f64; 3],
}

impl Cluster {
    fn new(points: &[Point], members: Vec<u32>) -> Self {
        let (mut weight, mut sum, mut squares) = (0.0, [0.0; 3], [0.0; 3]);
        for point in members.iter().map(|&member| &points[member as usize]) {
            weight += point.weight;
            for axis in 0..3 {
                let x = f64::from(point.place[axis]);
                sum[axis] += point.weight * x;
                squares[axis] += point.weight * x * x;
            }
        }
        let mean = sum.map(|sum| if weight > 0.0 { sum / weight } else { 0.0 });
        let spread = [0, 1, 2].map(|axis| (squares[axis] - mean[axis] * sum[axis]).max(0.0));
        Self { members, mean, spread }
    }

    fn error(&self) -> f64 {
        if self.members.len() > 1 { self.spread.iter().sum() } else { 0.0 }
    }

    /// Two clusters, on both sides of the mean along the axis of the largest spread.
    fn halves(self, points: &[Point]) -> [Self; 2] {
        let axis = (0..3).max_by(|&a, &b| self.spread[a].total_cmp(&self.spread[b])).unwrap_or(0);
        let below = |&member: &u32| f64::from(points[member as usize].place[axis]) < self.mean[axis];
        let (low, high) = self.members.into_iter().partition(below);
        [low, high].map(|members| Self::new(points, members))
    }
}

/// The means of `size` clusters, or fewer if there are fewer colours: always that with the largest error is divided.
fn divided(points: &[Point], size: usize) -> Vec<[f32; 3]> {
    let mut clusters = vec![Cluster::new(points, (0..points.len() as u32).collect())];
    while clusters.len() < size {
        let errors = clusters.iter().map(Cluster::error).enumerate();
        let Some((worst, error)) = errors.max_by(|a, b| a.1.total_cmp(&b.1)) else { break };
        if error <= 0.0 {
            break;
        }
        let halves = clusters.swap_remove(worst).halves(points);
        // Rounding may leave nothing on one side.
        let whole = halves.iter().any(|half| half.members.is_empty());
        clusters.extend(halves.into_iter().filter(|half| !half.members.is_empty()));
        if whole {
            break;
        }
    }
    clusters.into_iter().map(|cluster| cluster.mean.map(|x| x as f32)).collect()
}

/// Moves every centre to the mean of the colours that are nearest to it (Lloyd); whether any has moved.
fn settle(points: &[Point], centers: &mut [[f32; 3]]) -> bool {
    let nearest = |point: &Point| {
        let mut best = (f32::INFINITY, 0);
        for (index, center) in centers.iter().enumerate() {
            let [l, a, b] = [0, 1, 2].map(|axis| center[axis] - point.place[axis]);
            let distance = l * l + a * a + b * b;
            if distance < best.0 {
                best = (distance, index);
            }
        }
        best.1
    };
    let owners: Vec<usize> = points.par_iter().map(nearest).collect();
    let mut sums = vec![(0.0, [0.0; 3]); centers.len()];
    for (point, owner) in points.iter().zip(owners) {
        let (weight, sum) = &mut sums[owner];
        *weight += point.weight;
        *sum = [0, 1, 2].map(|axis| sum[axis] + point.weight * f64::from(point.place[axis]));
    }
    let mut moved = false;
    for (center, (weight, sum)) in centers.iter_mut().zip(sums).filter(|(_, (weight, _))| *weight > 0.0) {
        let mean = sum.map(|sum| (sum / weight) as f32);
        moved |= mean != *center;
        *center = mean;
    }
    moved
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

/// The way back.
const OKLAB_TO_LMS_ROOT: [[f32; 3]; 3] = [
    [1.0, 0.396_337_78, 0.215_803_76],
    [1.0, -0.105_561_346, -0.063_854_17],
    [1.0, -0.089_484_18, -1.291_485_5],
];
const LMS_TO_RGB: [[f32; 3]; 3] = [
    [4.076_741_7, -3.307_711_6, 0.230_969_94],
    [-1.268_438, 2.609_757_4, -0.341_319_38],
    [-0.004_196_086_3, -0.703_418_6, 1.707_614_7],
];

/// A colour as it looks: how light it is, and how far from grey to red and to yellow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Oklab {
    pub l: f32,
    pub a: f32,
    pub b: f32,
}

/// The sRGB codes nearest to a colour in Oklab.
fn code_of_oklab(lab: [f32; 3]) -> [u8; 3] {
    let linear = multiply(&LMS_TO_RGB, multiply(&OKLAB_TO_LMS_ROOT, lab).map(|root| root * root * root));
    linear.map(|part| (linear_to_srgb(f64::from(part).clamp(0.0, 1.0)) * 255.0 + 0.5) as u8)
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

    /// A long gradient alone takes all the palette, to its very ends.
    #[test]
    fn gradients_take_what_there_is() {
        let yellow = |i: u32| Weighted { color: [i as f32, i as f32, 0.0], count: 100 };
        let weighted: Vec<_> = (0..256).map(yellow).collect();
        for size in [16, 64, 128] {
            let palette = Palette::clustered(&weighted, size);
            let count = palette.colors().len();
            assert!((size * 9 / 10..=size).contains(&count), "{count} of {size}");
            let (first, last) = (palette.colors()[0][0], palette.colors()[count - 1][0]);
            let step = (255 / size) as u8 + 3;
            assert!(first <= 2 * step && last >= 255 - step, "{size}: {first} {last}");
        }
    }

    #[test]
    fn codes_survive_oklab() {
        for code in [[0, 0, 0], [255, 255, 255], [255, 0, 0], [3, 200, 90], [17, 17, 255]] {
            let Oklab { l, a, b } = oklab(code.map(|code| linear_of_code(f32::from(code))));
            assert_eq!(code_of_oklab([l, a, b]), code);
        }
    }

    #[test]
    fn oklab_of_known_colors() {
        let white = oklab([1.0; 3]);
        assert!((white.l - 1.0).abs() < 1e-5 && white.a.abs() < 1e-5 && white.b.abs() < 1e-5);
        let red = oklab([1.0, 0.0, 0.0]);
        assert!((red.l - 0.62796).abs() < 1e-4 && (red.a - 0.22486).abs() < 1e-4);
    }
}

//! The palette of an animation, by clustering in Oklab.

use super::oklab::{Oklab, code_of_oklab, linear_of_code, oklab};
use rayon::prelude::*;

/// Iterations of Lloyd's algorithm, at most.
const MAX_ITERATIONS: usize = 16;

/// A colour that stands for `count` pixels, in 0..=255 per channel with fractions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeightedColor {
    pub color: [f32; 3],
    pub count: u64,
}

/// Distinct colours, in the order of their bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Palette {
    colors: Vec<[u8; 3]>,
    exact: bool,
}

impl Palette {
    /// A palette of all colours of the animation.
    pub fn exact(mut colors: Vec<[u8; 3]>) -> Self {
        colors.sort_unstable();
        colors.dedup();
        Self { colors, exact: true }
    }

    /// A palette of at most `size` colours (2..=256) that approximate those of an animation. Clusters in Oklab are
    /// split until there are enough, then refined by Lloyd's algorithm. The same input gives the same palette.
    pub fn clustered(weighted: &[WeightedColor], size: usize) -> Self {
        let points: Vec<Point> = weighted.iter().map(Point::new).collect();
        let mut centers = split_centers(&points, size.clamp(1, 256));
        for _ in 0..MAX_ITERATIONS {
            if !lloyd_step(&points, &mut centers) {
                break;
            }
        }
        Self { exact: false, ..Self::exact(centers.into_iter().map(code_of_oklab).collect()) }
    }

    /// The same palette with more colours.
    pub fn with(mut self, more: &[[u8; 3]]) -> Self {
        self.colors.extend(more);
        Self { exact: false, ..Self::exact(self.colors) }
    }

    pub fn colors(&self) -> &[[u8; 3]] {
        &self.colors
    }

    /// Whether the palette contains every colour of the animation exactly.
    pub fn is_exact(&self) -> bool {
        self.exact
    }
}

/// A colour in Oklab with its weight.
struct Point {
    place: [f32; 3],
    weight: f64,
}

impl Point {
    fn new(weighted: &WeightedColor) -> Self {
        let Oklab { l, a, b } = oklab(weighted.color.map(linear_of_code));
        Self { place: [l, a, b], weight: weighted.count as f64 }
    }
}

/// A subset of the colours.
struct Cluster {
    members: Vec<u32>,
    mean: [f64; 3],
    /// The sum of the squared distances from the mean along each axis.
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

    /// Splits the cluster at its mean, along the axis of the largest spread.
    fn halves(self, points: &[Point]) -> [Self; 2] {
        let axis = (0..3).max_by(|&a, &b| self.spread[a].total_cmp(&self.spread[b])).unwrap_or(0);
        let below = |&member: &u32| f64::from(points[member as usize].place[axis]) < self.mean[axis];
        let (low, high) = self.members.into_iter().partition(below);
        [low, high].map(|members| Self::new(points, members))
    }
}

/// The means of `size` clusters, or fewer if there are fewer colours. Each step splits the cluster of the largest
/// error.
fn split_centers(points: &[Point], size: usize) -> Vec<[f32; 3]> {
    let mut clusters = vec![Cluster::new(points, (0..points.len() as u32).collect())];
    while clusters.len() < size {
        let errors = clusters.iter().map(Cluster::error).enumerate();
        let Some((worst, error)) = errors.max_by(|a, b| a.1.total_cmp(&b.1)) else { break };
        if error <= 0.0 {
            break;
        }
        let halves = clusters.swap_remove(worst).halves(points);
        // Rounding may leave one side empty.
        let whole = halves.iter().any(|half| half.members.is_empty());
        clusters.extend(halves.into_iter().filter(|half| !half.members.is_empty()));
        if whole {
            break;
        }
    }
    clusters.into_iter().map(|cluster| cluster.mean.map(|x| x as f32)).collect()
}

/// One step of Lloyd's algorithm: moves every centre to the mean of the colours nearest to it. Returns whether a centre
/// has moved.
fn lloyd_step(points: &[Point], centers: &mut [[f32; 3]]) -> bool {
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

#[cfg(test)]
mod tests {
    use super::*;

    fn cube() -> Vec<WeightedColor> {
        let color = |i: u32| [i & 15, (i >> 4) & 15, i >> 8].map(|c| (c * 17) as f32);
        (0..4096).map(|i| WeightedColor { color: color(i), count: u64::from(i % 7 + 1) << 33 }).collect()
    }

    #[test]
    fn palettes_are_deterministic_and_never_too_large() {
        for size in [1, 2, 16] {
            let palette = Palette::clustered(&cube(), size);
            assert!((1..=size).contains(&palette.colors().len()));
            assert_eq!(palette, Palette::clustered(&cube(), size));
            assert!(!palette.is_exact());
        }
        assert!((240..=256).contains(&Palette::clustered(&cube(), 256).colors().len()));
    }

    #[test]
    fn rare_distant_colors_are_kept() {
        let mut weighted = cube();
        for w in &mut weighted {
            w.color[1] = w.color[0];
            w.color[2] = w.color[0];
        }
        weighted.push(WeightedColor { color: [255.0, 0.0, 0.0], count: 1 << 38 });
        let palette = Palette::clustered(&weighted, 64);
        assert!(palette.colors().iter().any(|&[r, g, b]| r > 240 && g < 40 && b < 40), "{palette:?}");
    }

    /// A long gradient uses the whole palette, up to its ends.
    #[test]
    fn gradients_use_the_whole_palette() {
        let yellow = |i: u32| WeightedColor { color: [i as f32, i as f32, 0.0], count: 100 };
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
}

//! A blue-noise threshold matrix for ordered dithering, without the crosshatch pattern of a Bayer matrix.

use std::sync::LazyLock;

/// The matrix repeats after this many pixels along both axes.
pub const SIDE: usize = 64;
const AREA: usize = SIDE * SIDE;
/// Standard deviation of the Gaussian that measures crowding, in pixels. Ulichney recommends this value.
const SIGMA: f64 = 1.5;
/// Beyond this distance the Gaussian is below 1e-6 of its peak.
const REACH: isize = 8;

/// The result of [`ranks`], computed once per process.
pub static RANKS: LazyLock<Vec<u16>> = LazyLock::new(ranks);

/// Ranks the pixels of a `SIDE`² square from 0 to SIDE² - 1, so that the pixels below any rank are spread evenly. Uses
/// the void-and-cluster method (R. Ulichney, "The void-and-cluster method for dither array generation", 1993).
fn ranks() -> Vec<u16> {
    let mut ranks = vec![0; AREA];
    let prototype = relaxed(scattered());
    let ones = prototype.set.iter().filter(|&&set| set).count();
    // Ranks below the prototype: the most crowded pixel is removed first.
    let mut field = prototype.clone();
    for rank in (0..ones).rev() {
        let pixel = field.tightest_cluster();
        field.toggle(pixel);
        ranks[pixel] = rank as u16;
    }
    // Ranks above the prototype: the largest void is filled first.
    let mut field = prototype;
    for rank in ones..AREA {
        let pixel = field.largest_void();
        field.toggle(pixel);
        ranks[pixel] = rank as u16;
    }
    ranks
}

/// The pixels that are set, and the crowding around each pixel, on a torus. Integers make setting and clearing a pixel
/// exact inverses.
#[derive(Clone)]
struct Field {
    set: Vec<bool>,
    crowding: Vec<u64>,
    kernel: Vec<(isize, isize, u64)>,
}

impl Field {
    fn new() -> Self {
        let weight = |x: isize, y: isize| {
            let exponent = -((x * x + y * y) as f64) / (2.0 * SIGMA * SIGMA);
            (libm::exp(exponent) * f64::from(1 << 30)) as u64
        };
        let axis = || -REACH..=REACH;
        let kernel = axis().flat_map(|y| axis().map(move |x| (x, y, weight(x, y)))).collect();
        Self { set: vec![false; AREA], crowding: vec![0; AREA], kernel }
    }

    fn toggle(&mut self, pixel: usize) {
        self.set[pixel] = !self.set[pixel];
        let (px, py) = ((pixel % SIDE) as isize, (pixel / SIDE) as isize);
        for &(dx, dy, weight) in &self.kernel {
            let wrap = |v: isize| v.rem_euclid(SIDE as isize) as usize;
            let near = &mut self.crowding[wrap(py + dy) * SIDE + wrap(px + dx)];
            if self.set[pixel] { *near += weight } else { *near -= weight }
        }
    }

    /// The set pixel with the most crowded surroundings; the first of equals.
    fn tightest_cluster(&self) -> usize {
        let set = (0..AREA).filter(|&pixel| self.set[pixel]);
        set.max_by_key(|&pixel| (self.crowding[pixel], AREA - pixel)).unwrap_or(0)
    }

    /// The unset pixel with the emptiest surroundings; the first of equals.
    fn largest_void(&self) -> usize {
        let unset = (0..AREA).filter(|&pixel| !self.set[pixel]);
        unset.min_by_key(|&pixel| self.crowding[pixel]).unwrap_or(0)
    }
}

/// Sets a tenth of the pixels, chosen by a multiplicative hash of their index.
fn scattered() -> Field {
    let mut field = Field::new();
    for pixel in 0..AREA {
        if (pixel as u32 + 1).wrapping_mul(0x9E37_79B1).rotate_left(15).wrapping_mul(0x85EB_CA6B)
            < u32::MAX / 10
        {
            field.toggle(pixel);
        }
    }
    field
}

/// Moves the most crowded pixel into the largest void until nothing changes.
fn relaxed(mut field: Field) -> Field {
    // This converges long before the limit, which only guards against a cycle of equal values.
    for _ in 0..AREA {
        let cluster = field.tightest_cluster();
        field.toggle(cluster);
        let void = field.largest_void();
        field.toggle(void);
        if void == cluster {
            break;
        }
    }
    field
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_are_a_permutation() {
        let mut ranks = RANKS.clone();
        ranks.sort_unstable();
        assert!(ranks.iter().enumerate().all(|(i, &rank)| i == usize::from(rank)));
    }

    /// Blue noise: squares of 8 pixels hold about the same number of low ranks. White noise deviates by 3.7.
    #[test]
    fn low_ranks_are_spread_evenly() {
        for share in [1, 2, 4] {
            let mut squares = [0i32; 64];
            for (pixel, &rank) in RANKS.iter().enumerate() {
                let square = pixel / SIDE / 8 * 8 + pixel % SIDE / 8;
                squares[square] += i32::from(usize::from(rank) < AREA * share / 8);
            }
            let mean = 8 * share as i32;
            let variance = squares.iter().map(|n| (n - mean) * (n - mean)).sum::<i32>() as f64 / 64.0;
            assert!(variance.sqrt() < 1.8, "share {share}/8: {}", variance.sqrt());
        }
    }
}

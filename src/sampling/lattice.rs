//! Rank-1 lattices: points that fill the unit square evenly, and go on evenly in the squares around it.

/// The points (i + 1/2, (i g mod n) + 1/2) / n for i from 0 to n - 1. The generator g makes the smallest distance
/// between two points as large as possible (Dammertz, Keller, *Image Synthesis by Rank-1 Lattices*, 2008). Copies of the
/// lattice in all unit squares of the plane form one lattice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RankOneLattice {
    count: u32,
    generator: u32,
}

/// The most generators that are tried. If there are more, those next to the golden section are, which is always good.
const MAX_TRIED: u32 = 1 << 10;

impl RankOneLattice {
    /// The lattice of `count` points, at least one.
    pub fn new(count: u32) -> Self {
        let first = match count {
            0..=MAX_TRIED => 1,
            _ => (f64::from(count) * GOLDEN_SECTION) as u32 - MAX_TRIED / 2,
        };
        let tried = first..first + count.clamp(1, MAX_TRIED);
        let best =
            tried.max_by_key(|&generator| (shortest_square(count, generator), std::cmp::Reverse(generator)));
        Self { count, generator: best.unwrap_or(1) }
    }

    pub fn count(&self) -> u32 {
        self.count
    }

    /// A point of the lattice that is moved by `shift`, as far as it lies in the unit square.
    pub fn point(&self, index: u32, shift: [f64; 2]) -> [f64; 2] {
        let row = (u64::from(index) * u64::from(self.generator) % u64::from(self.count)) as u32;
        let moved = |number: u32, by: f64| {
            let place = (f64::from(number) + 0.5) / f64::from(self.count) + by;
            place - place.floor()
        };
        [moved(index, shift[0]), moved(row, shift[1])]
    }
}

/// The smaller part of a unit that is divided in the golden ratio.
const GOLDEN_SECTION: f64 = 0.381_966_011_250_105_2;

/// The square of the shortest distance between points of the lattice, in units of 1 / count: by Gauss's reduction of the
/// basis (1, g), (0, n).
fn shortest_square(count: u32, generator: u32) -> i64 {
    let mut a = [1, i64::from(generator)];
    let mut b = [0, i64::from(count)];
    let dot = |a: [i64; 2], b: [i64; 2]| a[0] * b[0] + a[1] * b[1];
    loop {
        if dot(a, a) < dot(b, b) {
            std::mem::swap(&mut a, &mut b);
        }
        // `b` is the shorter one. Its multiple that is nearest to `a` is subtracted.
        let (along, square) = (dot(a, b), dot(b, b));
        let times = (2 * along + square).div_euclid(2 * square);
        if times == 0 {
            return square;
        }
        a = [a[0] - times * b[0], a[1] - times * b[1]];
        if a == [0, 0] {
            return square;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_as_large_as_known() {
        // 2, 5, 10 and 13 points are square lattices, turned; 1 is the plain one.
        for (count, square) in [(1, 1), (2, 2), (5, 5), (10, 10), (12, 10), (13, 13), (80, 82)] {
            let lattice = RankOneLattice::new(count);
            let found = shortest_square(count, lattice.generator);
            assert_eq!(found, square, "{count}");
            // No two points of nine neighbouring squares are nearer.
            let mut least = i64::MAX;
            for i in 1..i64::from(count) * 2 {
                for k in -1..=1 {
                    let y = i * i64::from(lattice.generator) % i64::from(count) + k * i64::from(count);
                    least = least.min(i * i + y * y);
                }
            }
            assert_eq!(found, least.min(i64::from(count) * i64::from(count)), "{count}");
        }
    }

    #[test]
    fn any_unit_square_has_all_points() {
        for count in [1, 2, 5, 12, 80, 5000] {
            let lattice = RankOneLattice::new(count);
            for corner in [[0.0, 0.0], [0.313_71, 0.771_03], [0.999_01, 0.042_13]] {
                let inside = (-1..=1).flat_map(|x| (-1..=1).map(move |y| [f64::from(x), f64::from(y)]));
                let inside = inside.map(|cell| {
                    let is_in = |index: &u32| {
                        let p = lattice.point(*index, [0.0; 2]);
                        (0..2).all(|axis| (0.0..1.0).contains(&(p[axis] + cell[axis] - corner[axis])))
                    };
                    (0..count).filter(is_in).count() as u32
                });
                assert_eq!(inside.sum::<u32>(), count);
            }
        }
    }

    #[test]
    fn a_shift_keeps_points_in_the_square() {
        let lattice = RankOneLattice::new(20);
        for index in 0..20 {
            let p = lattice.point(index, [0.99, 0.5]);
            assert!(p.iter().all(|p| (0.0..1.0).contains(p)), "{p:?}");
        }
    }
}

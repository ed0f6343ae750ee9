//! Ascending borders, and the search for the interval between them that holds a number.

use crate::base::lanes::{Level, Real};

/// Rows of ascending numbers, the borders of intervals. All rows have equally many, and the same first and last one.
///
/// The way from the first border to the last one is divided into equal steps. A table has the interval in which each
/// step begins (the cutpoint method: Chen, Asau, *On Generating Random Variates from an Empirical Distribution*, 1974).
#[derive(Clone, Debug, PartialEq)]
pub struct Borders {
    /// Row by row. Each ends with [`WINDOW`] infinite ones.
    ends: Vec<f64>,
    /// The first interval of each step of each row.
    cutpoints: Vec<u16>,
    /// Intervals in a row.
    count: usize,
    /// Steps in a row, a power of two, so that the place of a step is exact.
    steps: usize,
    first: f64,
    /// 1 / the way from the first border to the last one.
    per_range: f64,
}

/// The borders that are compared at a time: as many as a cache line holds.
const WINDOW: usize = 8;

/// Intervals per step. With fewer, the table of large skies would not fit into a core's cache. With more, the borders
/// of many steps would not fit into a window.
const PER_STEP: usize = 4;

impl Borders {
    /// Borders from rows, whose first numbers are all equal, and whose last ones are, too. At least two numbers, at
    /// most 2^16.
    pub fn new(rows: impl IntoIterator<Item = Vec<f64>>) -> Self {
        let mut rows = rows.into_iter().peekable();
        let ends = rows.peek().map_or(&[0.0, 1.0][..], |row| row);
        let (count, first, last) = (ends.len() - 1, ends[0], ends[ends.len() - 1]);
        let steps = (count.next_power_of_two() / PER_STEP).max(1);
        let (mut ends, mut cutpoints) = (Vec::new(), Vec::new());
        for row in rows {
            debug_assert!(row.len() == count + 1 && row[0] == first && row[count] == last);
            let mut interval = 0;
            cutpoints.extend((0..steps).map(|step| {
                let begin = first + (last - first) * (step as f64 / steps as f64);
                while interval < count - 1 && row[interval + 1] <= begin {
                    interval += 1;
                }
                interval as u16
            }));
            ends.extend(row);
            ends.extend([f64::INFINITY; WINDOW]);
        }
        Self { ends, cutpoints, count, steps, first, per_range: 1.0 / (last - first) }
    }

    /// Intervals in a row.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The distance of rows in memory.
    #[inline(always)]
    fn stride(&self) -> usize {
        self.count + 1 + WINDOW
    }

    /// The lower and the upper border of an interval of a row.
    #[inline(always)]
    pub fn around(&self, row: usize, interval: usize) -> [f64; 2] {
        let at = row * self.stride() + interval;
        [self.ends[at], self.ends[at + 1]]
    }

    /// The width of an interval of a row.
    #[inline(always)]
    pub fn width(&self, row: usize, interval: usize) -> f64 {
        let [low, high] = self.around(row, interval);
        high - low
    }

    /// The interval of a row that holds a finite value: the first one for values before it, the last one for those
    /// behind it.
    #[inline(always)]
    pub fn find(&self, row: usize, value: f64) -> usize {
        self.find_from(self.begin(self.step(row, value)), row, value)
    }

    /// [`Borders::find`] of each lane, with a row for each. All ask for their borders before any is compared: those of
    /// many rows do not fit into a core's cache, and would be waited for one after the other.
    #[inline(always)]
    pub fn find_each<F: Real>(&self, rows: &[usize; 8], values: F) -> [usize; 8] {
        let (values, mut at) = (values.to_array(), [0; 8]);
        for lane in 0..F::LANES {
            at[lane] = self.step(rows[lane], values[lane]);
            F::Level::prefetch(&self.cutpoints, at[lane]);
        }
        for lane in 0..F::LANES {
            at[lane] = self.begin(at[lane]);
            self.prefetch::<F::Level>(rows[lane], at[lane]);
        }
        for lane in 0..F::LANES {
            at[lane] = self.find_from(at[lane], rows[lane], values[lane]);
        }
        at
    }

    /// Asks for the borders around an interval of a row and the ones behind it.
    #[inline(always)]
    pub fn prefetch<L: Level>(&self, row: usize, interval: usize) {
        let at = row * self.stride() + interval;
        L::prefetch(&self.ends, at);
        L::prefetch(&self.ends, at + WINDOW);
    }

    /// The index of the cutpoint of a value.
    #[inline(always)]
    fn step(&self, row: usize, value: f64) -> usize {
        debug_assert!(value < f64::INFINITY, "{value} is not before the infinite ones");
        let step = ((value - self.first) * self.per_range * self.steps as f64) as usize;
        row * self.steps + step.min(self.steps - 1)
    }

    /// The first interval that may hold a value of this step.
    ///
    /// Rounding of the place may reach the step that begins just above the value. At most one border lies between them:
    /// from 0 to 1, places are exact, so that borders may be equal there, and heights all differ.
    #[inline(always)]
    fn begin(&self, step: usize) -> usize {
        usize::from(self.cutpoints[step]).saturating_sub(1)
    }

    /// [`Borders::find`] from an interval on.
    #[inline(always)]
    fn find_from(&self, mut at: usize, row: usize, value: f64) -> usize {
        let row = &self.ends[row * self.stride()..][..self.stride()];
        loop {
            // All are compared, because a processor could not predict which one is the last.
            let below: usize = row[at + 1..][..WINDOW].iter().map(|end| usize::from(*end <= value)).sum();
            at += below;
            if below < WINDOW {
                return at.min(self.count - 1);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::lanes::tests::on_all_levels;
    use crate::base::lanes::{Row, SimdKernel, dispatch};
    use crate::testing::Random;

    /// Even, crowded and equal borders, and values at them, between them and beyond them.
    #[test]
    fn the_interval_is_that_of_a_search_of_all() {
        let mut random = Random(5);
        let heights = |count: u32| -> Vec<f64> {
            let height = |i: u32| -libm::cos(std::f64::consts::PI * f64::from(i) / f64::from(count));
            (0..=count).map(height).collect()
        };
        let crowded = |power: f64| (0..=1000).map(move |i| libm::pow(f64::from(i) / 1000.0, power)).collect();
        let equal = vec![0.0, 0.25, 0.25, 0.25, 0.9, 1.0, 1.0];
        let kinds: [Vec<Vec<f64>>; 5] = [
            vec![heights(37)],
            vec![heights(512)],
            vec![crowded(9.0), crowded(0.2)],
            vec![equal],
            vec![vec![0.0, 1.0]],
        ];
        for rows in kinds {
            let borders = Borders::new(rows.clone());
            for (row, ends) in rows.iter().enumerate() {
                let (first, last) = (ends[0], ends[ends.len() - 1]);
                let inner = ends.iter().flat_map(|end| [end.next_down(), *end, end.next_up()]);
                let anywhere: Vec<f64> =
                    (0..10_000).map(|_| first + random.unit() * (last - first)).collect();
                for value in inner.chain(anywhere).chain([-9.0, 9.0]) {
                    let all = ends.partition_point(|end| *end <= value).clamp(1, ends.len() - 1) - 1;
                    assert_eq!(borders.find(row, value), all, "{value:e}");
                }
                assert!(borders.find(row, f64::NAN) < ends.len() - 1);
            }
        }
    }

    struct Each<'a>(&'a Borders, [usize; 8], [f64; 8]);

    impl SimdKernel for Each<'_> {
        type Output = [usize; 8];

        #[inline(always)]
        fn run<L: Level>(self) -> [usize; 8] {
            self.0.find_each(&self.1, L::F64::from_array(self.2))
        }
    }

    /// Eight lanes, in rows of their own, find what each finds alone.
    #[test]
    fn lanes_find_their_own_intervals() {
        let mut random = Random(6);
        let row =
            |power: i32| (0..=100).map(move |i| libm::pow(f64::from(i) / 100.0, f64::from(power))).collect();
        let borders = Borders::new((1..=9).map(row));
        for _ in 0..1000 {
            let rows = std::array::from_fn(|_| (random.unit() * 9.0) as usize);
            let values = std::array::from_fn(|_| random.unit());
            let alone: [usize; 8] = std::array::from_fn(|lane| borders.find(rows[lane], values[lane]));
            for (level, all) in on_all_levels(|| dispatch(Each(&borders, rows, values))) {
                assert_eq!(all, alone, "{level:?} {rows:?} {values:?}");
            }
        }
    }
}

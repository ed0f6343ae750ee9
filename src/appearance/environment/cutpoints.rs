//! Finds the interval that holds a number without a search of all intervals.

/// Divides the way from the first of ascending borders to the last one into equal steps, and returns the interval in
/// which each step begins, then the last interval (the cutpoint method: Chen, Asau, *On Generating Random Variates from
/// an Empirical Distribution*, 1974).
pub fn cutpoints(ends: &[f64]) -> impl Iterator<Item = u16> {
    let (steps, last) = (steps(ends.len() - 1), ends.len() - 2);
    let (first, range) = (ends[0], ends[last + 1] - ends[0]);
    let mut cell = 0;
    (0..=steps).map(move |step| {
        let begin = first + range * (step as f64 / steps as f64);
        while cell < last && ends[cell + 1] <= begin {
            cell += 1;
        }
        cell as u16
    })
}

/// The number of steps for so many intervals: a power of two, so that the place of a step is exact.
pub fn steps(intervals: usize) -> usize {
    intervals.next_power_of_two()
}

/// The index of the interval between ascending `ends` that holds `value`. `place` is the value's share of the way from
/// the first border to the last one.
#[inline]
pub fn interval_of(ends: &[f64], cutpoints: &[u16], value: f64, place: f64) -> usize {
    let step = ((place * (cutpoints.len() - 1) as f64) as usize).min(cutpoints.len() - 2);
    // Rounding of the place may reach the step that begins just above the value.
    let from = usize::from(cutpoints[step]).saturating_sub(1);
    let to = usize::from(cutpoints[step + 1]);
    from + ends[from + 1..=to].partition_point(|end| *end <= value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    /// Even, crowded and equal borders, and values at them, between them and beyond them.
    #[test]
    fn the_interval_is_that_of_a_search_of_all() {
        let mut random = Random(5);
        let heights = |i: usize| -libm::cos(std::f64::consts::PI * i as f64 / 37.0);
        let crowded: Vec<f64> = (0..=1000).map(|i| libm::pow(f64::from(i) / 1000.0, 9.0)).collect();
        let steps = vec![0.0, 0.25, 0.25, 0.25, 0.9, 1.0, 1.0];
        for ends in [(0..38).map(heights).collect(), crowded, steps, vec![0.0, 1.0]] {
            let (first, last) = (ends[0], ends[ends.len() - 1]);
            let cutpoints: Vec<u16> = cutpoints(&ends).collect();
            let inner = ends.iter().flat_map(|end| [end.next_down(), *end, end.next_up()]);
            let anywhere: Vec<f64> = (0..10_000).map(|_| first + random.unit() * (last - first)).collect();
            for value in inner.chain(anywhere) {
                let all = ends.partition_point(|end| *end <= value).clamp(1, ends.len() - 1) - 1;
                let place = (value - first) / (last - first);
                assert_eq!(interval_of(&ends, &cutpoints, value, place), all, "{value:e}");
            }
        }
    }
}

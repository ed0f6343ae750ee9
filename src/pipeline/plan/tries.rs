//! When to try again to trace films together.

/// The number of tries in a row that failed. A try prepares the scenes of two films, so films that cannot share paths
/// would cost twice their preparation. A film that differs from the next one says little about those behind them, so
/// the next try is with the next film. After each further failure, twice as many films are left out.
#[derive(Default)]
pub struct Tries(u32);

impl Tries {
    /// The number of films to go on by, after a try with `asked` films of which `traced` were traced together. If that
    /// did not pay, the try failed too.
    pub fn next(&mut self, asked: usize, traced: usize, pays: bool) -> usize {
        if traced > 0 && pays {
            self.0 = 0;
            return traced;
        }
        let skipped = 1 << self.0.min(usize::BITS - 2);
        self.0 += 1;
        (traced + asked.saturating_sub(traced).min(skipped)).max(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn failures_in_a_row_leave_out_more_and_more() {
        let mut tries = Tries::default();
        let next: Vec<usize> = [0, 0, 0, 5, 0, 0].map(|traced| tries.next(64, traced, true)).to_vec();
        assert_eq!(next, [1, 2, 4, 5, 1, 2]);
        assert_eq!((tries.next(3, 0, true), tries.next(0, 0, true)), (3, 1));
        (0..100).for_each(|_| assert!(tries.next(64, 0, true) <= 64));
        // Films that were traced together in vain are left behind, with some of the others.
        let mut tries = Tries::default();
        assert_eq!([64, 11, 11, 64].map(|traced| tries.next(64, traced, false)), [64, 13, 15, 64]);
        assert_eq!([tries.next(64, 9, true), tries.next(64, 0, true)], [9, 1]);
    }
}

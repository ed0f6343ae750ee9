//! Neighbours of floats.

/// 2^-900, far below any length that matters. Computations with smaller numbers soon become subnormal, and processors
/// are about a hundred times slower on those.
pub const NEAR_ZERO: f64 = f64::from_bits((1023 - 900) << 52);

/// The next float from `value` in the direction of the sign of `towards`; `value` itself if `towards` is zero. Next
/// to zero it is ±[`NEAR_ZERO`].
#[inline]
pub fn next_away(value: f64, towards: f64) -> f64 {
    let next = if towards > 0.0 {
        value.next_up()
    } else if towards < 0.0 {
        value.next_down()
    } else {
        return value;
    };
    if next.abs() < NEAR_ZERO { NEAR_ZERO.copysign(towards) } else { next }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn next_away_moves_by_one_number() {
        assert_eq!(next_away(1.0, 5.0), 1.0 + f64::EPSILON);
        assert_eq!(next_away(1.0, -5.0), 1.0 - 0.5 * f64::EPSILON);
        assert_eq!(next_away(1.0, 0.0), 1.0);
        assert_eq!((next_away(0.0, 2.0), next_away(1e-300, -2.0)), (NEAR_ZERO, -NEAR_ZERO));
        assert_eq!(next_away(0.0, 0.0), 0.0);
    }
}

//! Roots of functions of one variable, between bounds.

/// No search takes more steps: every second one halves the bracket at least, and the exponents of f64 span
/// about 2100 halvings only for brackets that no shape has.
const STEPS: u32 = 200;

/// Where a function crosses zero between `low` and `high`, where its signs differ; `rising` says that it is
/// below zero at `low`. `f` gives its value and its slope. Ends when a step is not longer than `resolution`.
///
/// Newton's method within a bracket: a step that leaves the bracket, or that is not half as long as the one
/// before, is replaced by a bisection (Press et al., *Numerical Recipes*, 3rd ed., section 9.4).
pub fn root_between(
    (mut low, mut high): (f64, f64),
    rising: bool,
    resolution: f64,
    f: impl Fn(f64) -> (f64, f64),
) -> f64 {
    let mut x = low * 0.5 + high * 0.5;
    let mut last = high - low;
    for _ in 0..STEPS {
        let (value, slope) = f(x);
        if value == 0.0 {
            return x;
        }
        if (value < 0.0) == rising {
            low = x;
        } else {
            high = x;
        }
        let newton = x - value / slope;
        // Comparisons fail for the NaN of a vanishing slope.
        let good = newton >= low && newton <= high && (newton - x).abs() < 0.5 * last;
        let next = if good { newton } else { low * 0.5 + high * 0.5 };
        last = (next - x).abs();
        if last <= resolution {
            return next;
        }
        x = next;
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn finds_simple_and_flat_roots() {
        let cosine = root_between((0.0, 3.0), false, 0.0, |x| (libm::cos(x), -libm::sin(x)));
        assert!((cosine - PI / 2.0).abs() <= 2.0 * f64::EPSILON);
        // A triple root: Newton's steps shrink by a third each, so it is found by halving.
        let flat = root_between((-1.0, 2.5), true, 1e-15, |x| ((x - 0.3) * (x - 0.3) * (x - 0.3), 0.0));
        assert!((flat - 0.3).abs() <= 2e-15, "{flat}");
    }

    #[test]
    fn ends_where_the_slope_is_no_number() {
        let x = root_between((-1.0, 3.0), true, 1e-12, |x| (x, f64::NAN));
        assert!(x.abs() <= 1e-11);
    }
}

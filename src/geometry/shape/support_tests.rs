//! Supports of shapes, compared with points of their surfaces and with their bounds.

use super::{Cone, Cylinder, Disk, Geometric, Rectangle, Sphere, Torus, Triangle};
use crate::base::math::DVec3;
use crate::testing::Random;

/// Points per shape.
const POINTS: usize = 20_000;

/// Checks that the support in random directions is at least that of every sampled point, and not much more, and that it
/// is the extent of the bounds along the axes.
fn check(shape: &impl Geometric, size: f64) {
    let mut random = Random(3);
    let points: Vec<DVec3> = (0..POINTS)
        .map(|_| DVec3::from(shape.sample_area::<f64>(random.unit(), random.unit()).0.point))
        .collect();
    for _ in 0..50 {
        let direction = random.point(1.0);
        let support = shape.support(direction).expect("a finite shape");
        let most = points.iter().map(|point| point.dot(direction)).fold(f64::NEG_INFINITY, f64::max);
        let reach = size * direction.length();
        assert!(most <= support + 1e-12 * reach, "{most} {support}");
        assert!(most >= support - 0.05 * reach, "{most} {support}");
    }
    let bounds = shape.bounds().expect("a finite shape");
    for axis in 0..3 {
        let direction = DVec3::from_array(std::array::from_fn(|i| if i == axis { 1.0 } else { 0.0 }));
        let ends = [(direction, bounds.max[axis]), (-direction, -bounds.min[axis])];
        for (direction, end) in ends {
            let support = shape.support(direction).expect("a finite shape");
            // Bounds are padded by rounding errors, of disks up to the square root of one.
            assert!(support <= end && support >= end - 1e-6 * size, "{support} {end}");
        }
    }
}

#[test]
fn supports_touch_the_surface() {
    let (from, to) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(2.0, 1.5, 5.0));
    check(&Sphere { center: from, radius: 2.0 }, 2.0);
    check(&Disk { center: from, normal: (to - from).normalize(), radius: 2.0 }, 2.0);
    check(&Cylinder::new(from, to, 0.5, true).expect("a cylinder"), 2.0);
    check(&Cone::new(from, to, 1.5, 0.5, true).expect("a cone"), 3.0);
    check(&Torus::new(from, (to - from).normalize(), 2.0, 0.5), 2.5);
    check(&Rectangle { corner: from, u: to, v: DVec3::X }, 6.0);
    check(&Triangle { corners: [from, to, DVec3::Y] }, 6.0);
}

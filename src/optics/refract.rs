//! Directions after a surface.

use crate::math::DVec3;

/// `direction` as a mirror across `normal` sends it on.
pub fn reflect(direction: DVec3, normal: DVec3) -> DVec3 {
    direction - normal * (2.0 * normal.dot(direction))
}

/// `direction` (a unit vector) behind a boundary across the unit vector `normal`, which faces it, with the
/// cosine of its angle there (Snell's law); none when all is reflected inside. `eta` is the index of
/// refraction behind the boundary over that before it.
pub fn refract(direction: DVec3, normal: DVec3, eta: f64) -> Option<(DVec3, f64)> {
    let cosine = -direction.dot(normal);
    if eta == 1.0 {
        return Some((direction, cosine));
    }
    // The part of the direction within the boundary: its length is the sine, without the cancellation of
    // 1 - cos².
    let along = (direction + normal * cosine) / eta;
    let sine = along.length();
    if sine > 1.0 {
        return None;
    }
    let refracted = ((1.0 - sine) * (1.0 + sine)).sqrt();
    Some(((along - normal * refracted).normalize(), refracted))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Angle;

    #[test]
    fn snells_law_both_ways() {
        for degrees in [0.0, 1e-6, 20.0, 45.0, 70.0, 89.999] {
            let turn = Angle(degrees).cos_sin();
            let into = DVec3::new(turn.y, -turn.x, 0.0);
            let (inside, cosine) = refract(into, DVec3::Y, 1.5).expect("light enters");
            assert!((inside.x * 1.5 - into.x).abs() < 1e-15 && (inside.y + cosine).abs() < 1e-15);
            let (out, _) = refract(inside, DVec3::Y, 1.0 / 1.5).expect("light leaves");
            // The cosine of a grazing ray is the root of a difference: half of the digits are lost.
            assert!((out - into).length() < if degrees > 80.0 { 1e-11 } else { 1e-15 }, "{degrees}");
        }
        let steep = DVec3::new(0.8, 0.6, 0.0);
        assert_eq!(refract(steep, DVec3::NEG_Y, 1.0 / 1.5), None);
        assert_eq!(refract(steep, DVec3::NEG_Y, 1.0), Some((steep, 0.6)));
        assert_eq!(reflect(steep, DVec3::NEG_Y), DVec3::new(0.8, -0.6, 0.0));
    }
}

//! Cube maps: seams, directions, faces.

use super::*;
use crate::testing::Random;

/// Faces of `size` texels. Each texel holds `light` of the direction of its centre.
fn faces(size: u32, light: impl Fn(DVec3) -> Rgb) -> [Image; 6] {
    AXES.map(|axes| {
        let along = |i: u32| (2.0 * f64::from(i) + 1.0) / f64::from(size) - 1.0;
        let places = (0..size * size).map(|i| (along(i % size), along(i / size)));
        let texels = places.map(|(s, t)| light((axes.forward + axes.right * s + axes.down * t).normalize()));
        Image::new(size, size, texels.collect()).expect("a face")
    })
}

fn cube_map(size: u32, light: impl Fn(DVec3) -> Rgb) -> CubeMap {
    CubeMap::new(faces(size, light).each_ref()).expect("a cube map")
}

fn smooth(direction: DVec3) -> f64 {
    0.5 + 0.5 * direction.dot(DVec3::new(0.2, 0.3, 0.93).normalize())
}

#[test]
fn sh_15_edges_have_no_seams() {
    let map = cube_map(64, |d| Rgb::splat(smooth(d) as f32));
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let signs = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];
    let (mut jump, mut error) = (0.0f64, 0.0f64);
    for (along, (a, b)) in (0..3).flat_map(|along| signs.map(|sign| (along, sign))) {
        let (one, other) = (axes[(along + 1) % 3] * a, axes[(along + 2) % 3] * b);
        for k in 0..1000 {
            let on_edge = one + other + axes[along] * (f64::from(k) / 499.5 - 1.0);
            let across = (one - other).normalize() * on_edge.length() * 1e-6;
            let sides = [on_edge + across, on_edge - across].map(DVec3::normalize);
            let seen = sides.map(|d| f64::from(map.radiance_from(d).x));
            jump = jump.max((seen[0] - seen[1]).abs());
            error = error.max((seen[0] - smooth(sides[0])).abs());
        }
    }
    assert!(jump <= 1e-5 && error <= 1e-3, "jump {jump:e}, error {error:e}");
}

#[test]
fn sh_15_corners_have_no_seams() {
    let mut random = Random(6);
    let map = cube_map(8, |d| Rgb::splat(smooth(d) as f32));
    for sign in 0..8u8 {
        let corner = DVec3::from_array([1, 2, 4].map(|bit| if sign & bit == 0 { 1.0 } else { -1.0 }));
        let at_corner = map.radiance_from(corner);
        for _ in 0..100 {
            let near = map.radiance_from(corner + random.point(1e-7));
            assert!((near - at_corner).abs().max_element() < 1e-5);
        }
    }
}

#[test]
fn sh_15_no_direction_leaves_the_map() {
    let mut random = Random(1);
    let map = cube_map(4, |_| Rgb::ONE);
    for k in 0..1_000_000 {
        let mut d = random.direction();
        if k % 4 == 0 {
            // Exactly on an edge or a corner.
            d.y = d.x.abs().max(d.y.abs());
            d.x = if k % 8 == 0 { -d.y } else { d.y };
            d.z = if k % 16 == 0 { d.x } else { d.z };
        }
        assert!((map.radiance_from(d) - Rgb::ONE).abs().max_element() < 1e-6, "{d}");
    }
    for none in [DVec3::ZERO, DVec3::NAN, DVec3::INFINITY, DVec3::new(f64::INFINITY, 0.0, 1.0)] {
        assert_eq!(map.radiance_from(none), Rgb::ZERO);
    }
}

#[test]
fn faces_lie_as_their_names_say() {
    let map = cube_map(32, |d| d.as_vec3() + Rgb::ONE);
    let mut random = Random(9);
    for _ in 0..10_000 {
        let d = random.direction();
        assert!((map.radiance_from(d) - Rgb::ONE - d.as_vec3()).abs().max_element() < 2e-3, "{d}");
    }
    let images = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0].map(|face: f32| Image::new(1, 1, vec![Rgb::splat(face)]));
    let images = images.map(|image| image.expect("an image"));
    let map = CubeMap::new(images.each_ref()).expect("a cube map");
    for (face, axes) in AXES.iter().enumerate() {
        assert_eq!(map.radiance_from(axes.forward), Rgb::splat(face as f32), "{}", FACES[face]);
    }
}

#[test]
fn faces_must_fit() {
    let grey = |width: u32, height: u32| {
        Image::new(width, height, vec![Rgb::ONE; (width * height) as usize]).expect("an image")
    };
    let (two, three, flat) = (grey(2, 2), grey(3, 3), grey(2, 1));
    assert_eq!(CubeMap::new([&two, &two, &three, &two, &two, &two]), Err(FacesError::Differs(2)));
    assert_eq!(CubeMap::new([&two, &two, &two, &flat, &two, &two]), Err(FacesError::NotSquare(3)));
}

//! Light on surfaces. Most cases stand beside their formulas: SH-02 in `src/trace/bsdf`, SH-05 in `src/appearance/optics`, SH-11 in
//! `src/appearance/fog.rs`, SH-13 in `src/geometry/shape/sphere.rs`, SH-15 in `src/appearance/environment/cube_map`, SH-14 with the
//! meshes, SH-08 with SELF-05; SH-01, SH-03, SH-04, SH-07 and SH-18 see the whole renderer in `tests/integration`.

use crate::support::{Random, direction, hit, placed, radiance_at_target};
use kinora::appearance::material::MaterialBinding;
use kinora::appearance::texture::{Footprint, Pattern, TextureInputs};
use kinora::base::math::{Angle, DAffine3, DVec3, Ray};
use kinora::geometry::shape::{LaneSurface, OneRay, Plane, Rectangle, Shape};
use kinora::scene::{Finish, Geometry};

/// Corners of Phong's table, through the renderer: highlights only where N·L > 0 and R·V > 0. A power alone gives no
/// number for R·V < 0, and 0^0 = 1.
#[test]
fn sh_02_the_corners_of_phongs_table() {
    let shade = |light: [f64; 3], eye: [f64; 3], shininess: f64| {
        let at = |[x, y, z]: [f64; 3]| format!("({x:?}, {y:?}, {z:?})");
        let radiance = radiance_at_target(&format!(
            "camera: (position: {}), lights: {{ \"l\": Directional(direction: {}) }},
            default_material: (color: 1, ambient: 0.1, diffuse: 0.5, specular: 0.4, shininess: {shininess:?}),
            objects: {{ \"floor\": (shape: Plane()) }}",
            at(eye),
            at(light.map(|part| -part))
        ));
        f64::from(radiance.x)
    };
    let below = [0.99f64.sqrt(), -0.1, 0.0];
    let f32_digits = 2.0 * f64::from(f32::EPSILON);
    let near = |found: f64, expected: f64| {
        assert!((found - expected).abs() <= f32_digits * expected, "{found} instead of {expected}");
    };
    // (a) A light below, whose mirror image is before the eye; (b) one on the horizon.
    near(shade(below, [-0.99f64.sqrt(), 0.1, 0.0], 32.0), 0.1);
    near(shade([1.0, 0.0, 0.0], [-1.0, 1e-3, 0.0], 32.0), 0.1);
    // (c) R·V = -0.1 or so: an eye on the light's own side, beyond the right angle; (d) at it, with n = 0.
    let light = [0.6, 0.8, 0.0];
    for shininess in [50.5, 32.0, 0.0] {
        near(shade(light, [0.96, 0.28, 0.0], shininess), 0.1 + 0.5 * 0.8);
    }
    // (e) The centre of the sharpest highlight.
    near(shade(light, [-0.6, 0.8, 0.0], 1e6), 0.1 + 0.5 * 0.8 + 0.4);
}

/// A checker of unit cubes on planes between two layers of them: floor(y) alone puts 8.5 % of the hits into the wrong
/// one.
#[test]
fn sh_17_planes_between_layers_show_one_of_them() {
    let mut random = Random(17);
    let tilt = DAffine3::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 0.7);
    for height in [0.0, 2.0, 1.0, -3.0, 1000.0] {
        let at = DVec3::Y * height;
        let plane = Shape::Plane(Plane { point: at, normal: DVec3::Y });
        let (u, v) = (DVec3::X * 60.0, DVec3::Z * 60.0);
        let rectangle = Shape::Rectangle(Rectangle { corner: at - (u + v) * 0.5, u, v });
        for (shape, to_world) in [
            (&plane, DAffine3::IDENTITY),
            (&rectangle, DAffine3::IDENTITY),
            // The block that the pattern is cut from goes with its object.
            (&plane, tilt),
            (&rectangle, DAffine3::from_translation(DVec3::splat(1e4)) * tilt),
            (&rectangle, DAffine3::from_scale(DVec3::new(3.0, -0.1, 7.0)) * tilt),
        ] {
            let mut geometry = Geometry::default();
            geometry.push(shape, to_world, Finish::Material(MaterialBinding::One(0)));
            let mut speckles = 0;
            let inputs = TextureInputs { footprint: true, ..TextureInputs::default() };
            for _ in 0..2000 {
                let p = random.point(25.0).with_y(height);
                let eye = p + DVec3::new(random.unit() - 0.5, 0.5 + random.unit(), random.unit() - 0.5) * 9.0;
                let [p_world, eye] = [p, eye].map(|q| to_world.transform_point3(q));
                let ray = Ray { origin: eye, direction: (p_world - eye).normalize() };
                let at = hit(&geometry.primitives[0], ray.origin, ray.direction).expect("a hit");
                let surface = geometry.primitives[0].surface_at(&ray, at);
                let (surface, seen) = (LaneSurface::from(&surface), Footprint::zero());
                let context = geometry.texture_context::<f64>((0, at.part), &surface, &seen, inputs, true);
                let share = Pattern::Checker.share(context.point.into(), context.error.into(), DVec3::ZERO);
                let clear = |x: f64| (x - x.round()).abs() > 1e-4;
                let cells = p.x.floor() + p.z.floor() + height;
                let wrong = share != f64::from(u8::from(cells.rem_euclid(2.0) == 1.0));
                speckles += u32::from(clear(p.x) && clear(p.z) && wrong);
            }
            assert_eq!(speckles, 0, "{shape:?} at {to_world}");
        }
    }
}

/// Poles and seams of spheres of any size anywhere: coordinates stay within 0..1 and are no NaN, where acos(y) is given
/// 1 + 2^-52.
#[test]
fn sh_13_coordinates_of_spheres_anywhere() {
    let mut random = Random(13);
    for _ in 0..20_000 {
        let radius = libm::exp2(40.0 * random.unit() - 20.0);
        let center = direction(&mut random) * (radius * libm::exp2(40.0 * random.unit() - 20.0));
        let shape = Shape::Sphere(kinora::geometry::shape::Sphere { center, radius });
        let pole = if random.unit() < 0.5 { 1.0 } else { -1.0 };
        let theta = libm::pow(10.0, -14.0 * random.unit());
        let turn = Angle(360.0 * random.unit()).cos_sin() * libm::sin(theta);
        let aim = center + DVec3::new(turn.x, pole * libm::cos(theta), turn.y) * radius;
        let origin = center + direction(&mut random) * (2.0 * radius) + DVec3::Y * (3.0 * pole * radius);
        let sphere = placed(&shape, DAffine3::IDENTITY);
        let Some(at) = hit(&sphere, origin, aim - origin) else { continue };
        let surface = sphere.surface_at(&Ray { origin, direction: aim - origin }, at);
        let uv = shape.uv_at(surface.point, 0);
        assert!((0.0..1.0).contains(&uv.x) && (0.0..=1.0).contains(&uv.y), "{uv} of {shape:?}");
    }
}

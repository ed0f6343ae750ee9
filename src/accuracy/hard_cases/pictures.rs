//! Pictures of hard cases: the textbook in f32 beside Kinora.

use super::cameras::{at_elevation, fixed_up, our_right};
use super::maps::{self, PolePoint};
use super::number::{Float, Number, Vector3};
use super::spawning::{self, LitPoint, ShadowTest};
use super::spheres::{SphereRay, quadratic};
use super::triangles::published;
use crate::appearance::environment::CubeMap;
use crate::base::color::linear_to_srgb;
use crate::base::math::{Angle, DVec3, Ray};
use crate::base::time::{Rate, Timeline};
use crate::encode::{EncodeError, Picture, Sheet, write_png};
use crate::geometry::bvh::TraversalRay;
use crate::geometry::shape::{OneRay, Triangle};
use std::path::{Path, PathBuf};

/// The side of a panel, in pixels.
const SIDE: u32 = 280;
const TITLES: [&str; 2] = ["textbook, f32", "ours"];
/// The colour of missed hits and NaN.
const NOTHING: DVec3 = DVec3::new(0.8, 0.0, 0.1);

/// Writes all pictures into a folder, which is created if needed.
pub fn write(folder: &Path) -> Result<Vec<PathBuf>, EncodeError> {
    let pictures = [
        ("far-sphere", far_sphere()),
        ("edges", edges()),
        ("acne", acne()),
        ("pole", pole()),
        ("seam", seam()),
        ("over-the-pole", over_the_pole()),
    ];
    let mut written = Vec::new();
    for (name, picture) in pictures {
        let path = folder.join(format!("{name}.png"));
        write_png(&path, &picture)?;
        written.push(path);
    }
    Ok(written)
}

/// A picture of a function of linear colours at the centres of pixels: x from -1 to 1 to the right, y upwards.
fn panel(side: u32, color: impl Fn(f64, f64) -> DVec3) -> Picture {
    let at = |i: u32| (f64::from(i) + 0.5) / f64::from(side) * 2.0 - 1.0;
    let pixel = |k: u32| color(at(k % side), -at(k / side));
    let code = |part: f64| (linear_to_srgb(part.clamp(0.0, 1.0)) * 255.0 + 0.5) as u8;
    let rgb = (0..side * side).flat_map(|k| pixel(k).to_array().map(code)).collect();
    Picture::opaque(side, side, rgb)
}

fn beside(panels: [Picture; 2]) -> Picture {
    let mut sheet = Sheet::new(2, 2, (SIDE, SIDE), 1);
    for (index, (panel, title)) in (0..).zip(panels.iter().zip(TITLES)) {
        sheet.put(index, panel, title);
    }
    sheet.finish()
}

fn grey(light: f64) -> DVec3 {
    DVec3::splat(light)
}

/// A sphere of radius 1 from 1000 away, shaded by its normal at the hit.
fn far_sphere() -> Picture {
    let light = DVec3::new(0.5, 0.6, 0.62).normalize();
    let eye = DVec3::new(300.0, 400.0, 866.0);
    let (right, up) = (DVec3::Y.cross(eye).normalize(), eye.cross(DVec3::Y.cross(eye)).normalize());
    let aim = |x: f64, y: f64| (right * x + up * y) * 1.1;
    let shade = |normal: DVec3| grey(0.03 + 0.9 * normal.dot(light).max(0.0));
    let textbook = panel(SIDE, |x, y| {
        let at = SphereRay::<f32>::new(DVec3::ZERO, 1.0, eye, aim(x, y) - eye);
        let hit = quadratic(at.center, at.radius, at.origin, at.direction, 0.0);
        hit.map_or(DVec3::ZERO, |t| shade((at.origin + at.direction * t).unit().wide()))
    });
    let ours = panel(SIDE, |x, y| {
        let at = SphereRay::<f64>::new(DVec3::ZERO, 1.0, eye, aim(x, y) - eye);
        let hit = at.sphere.intersect_up_to(&at.probe, f64::INFINITY);
        hit.map_or(DVec3::ZERO, |found| shade(at.sphere.surface_at(&at.probe.ray, found).normal))
    });
    beside([textbook, ours])
}

/// A wall of triangles; rows and diagonals of pixels are exactly on its edges.
fn edges() -> Picture {
    const CELLS: u32 = 5;
    // Each ray fills 2 x 2 pixels.
    const RAYS: u32 = SIDE / 2;
    let (corner, u, v) = (DVec3::new(-3.1, -2.2, 1.3), DVec3::new(4.7, 0.9, 1.7), DVec3::new(0.6, 5.3, -1.1));
    let eye = DVec3::new(0.3, 0.7, 9.1);
    let place = |i: f64, j: f64| corner + u * i + v * j;
    let vertex = |i: u32, j: u32| {
        let share = |k: u32| f64::from(k) / f64::from(CELLS);
        Vector3::<f32>::of(place(share(i), share(j)))
    };
    let cells = (0..CELLS * CELLS).map(|k| (k % CELLS, k / CELLS));
    let triangles: Vec<_> = cells
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    let mesh: Vec<_> = triangles.iter().map(|t| Triangle { corners: t.map(Vector3::wide) }).collect();
    let shown = |hit: Option<usize>| hit.map_or(NOTHING, |k| grey(if k % 2 == 0 { 0.45 } else { 0.6 }));
    // From the centre of the first cell to that of the last one, so that all visible edges are shared.
    let aim = |x: f64, y: f64| {
        let rays = f64::from(RAYS);
        let share = |along: f64| 0.1 + 0.8 * (((0.5 * along + 0.5) * rays).floor() + 0.5) / rays;
        place(share(x), share(y))
    };
    let textbook = panel(SIDE, |x, y| {
        let (origin, direction) =
            (Vector3::<f32>::of(eye), Vector3::<f32>::of((aim(x, y) - eye).normalize()));
        shown(triangles.iter().position(|t| published(*t, origin, direction).is_some()))
    });
    let ours = panel(SIDE, |x, y| {
        let probe = TraversalRay::new(Ray { origin: eye, direction: (aim(x, y) - eye).normalize() });
        shown(mesh.iter().position(|t| t.intersect_up_to(&probe, f64::INFINITY).is_some()))
    });
    beside([textbook, ours])
}

/// A lit sphere of radius 100, a million units from the origin.
fn acne() -> Picture {
    const RADIUS: f64 = 100.0;
    let center = DVec3::new(0.6, 0.64, 0.48) * 1e6;
    let light = DVec3::new(0.5, 0.6, 0.62).normalize();
    fn lit<R: Float>(center: DVec3, light: DVec3, x: f64, y: f64) -> LitPoint<R> {
        let origin = center + DVec3::new(x * 1.1, y * 1.1, 3.0) * RADIUS;
        LitPoint { aimed: SphereRay::new(center, RADIUS, origin, DVec3::NEG_Z), light: Vector3::of(light) }
    }
    let shade = |x: f64, y: f64, shadow: Option<ShadowTest>| {
        let square = 1.0 - 1.21 * (x * x + y * y);
        let Some(shadow) = shadow.filter(|_| square > 0.0) else { return DVec3::ZERO };
        let facing = DVec3::new(1.1 * x, 1.1 * y, square.sqrt()).dot(light);
        grey(0.03 + if shadow.blocked { 0.0 } else { 0.9 * facing.max(0.0) })
    };
    let textbook = panel(SIDE, |x, y| shade(x, y, spawning::textbook(&lit::<f32>(center, light, x, y))));
    let ours = panel(SIDE, |x, y| shade(x, y, spawning::ours(&lit(center, light, x, y))));
    beside([textbook, ours])
}

/// Circles of latitude 0.0002 radians apart around the pole of a sphere.
fn pole() -> Picture {
    fn at<R: Float>(x: f64, y: f64) -> PolePoint<R> {
        let (across, center) = (2e-3, DVec3::new(0.0, 3.0, 0.0));
        let (x, z) = (x * across, y * across);
        PolePoint::new(center, 0.7, center + DVec3::new(x, -(1.0 - x * x - z * z).sqrt(), z) * 0.7)
    }
    let shown = |angle: f64| match angle.is_finite() {
        true => grey(if ((angle / 2e-4).floor() as u32).is_multiple_of(2) { 0.75 } else { 0.1 }),
        false => NOTHING,
    };
    let textbook = panel(SIDE, |x, y| shown(maps::arc_cosine(&at::<f32>(x, y)).wide()));
    let ours = panel(SIDE, |x, y| shown(maps::ours(&at(x, y))));
    beside([textbook, ours])
}

/// The corner of a sky of six faces of 8 x 8 texels.
fn seam() -> Picture {
    let sky = |d: DVec3| 0.5 + 0.45 * libm::sin(5.0 * d.normalize().dot(DVec3::new(0.9, -0.3, -0.3)) + 1.0);
    let forward = DVec3::ONE.normalize();
    let right = forward.cross(DVec3::Y).normalize();
    let up = right.cross(forward);
    let direction = |x: f64, y: f64| forward + (right * x + up * y) * 0.5;
    let dark = || Picture::filled(SIDE, SIDE, [0; 3]);
    let Some(faces) = maps::faces(8, sky) else { return beside([dark(), dark()]) };
    let map = CubeMap::new(faces.each_ref()).ok();
    let textbook =
        panel(SIDE, |x, y| grey(maps::clamped(&faces, Vector3::<f32>::of(direction(x, y))).wide()));
    let ours = map.map(|map| panel(SIDE, |x, y| map.radiance_from(direction(x, y)).as_dvec3()));
    beside([textbook, ours.unwrap_or_else(dark)])
}

/// A floor of four colours, seen by a camera that moves over the pole; in the upper row, +y is always up.
fn over_the_pole() -> Picture {
    const FRAMES: [f64; 5] = [70.0, 85.0, 90.0, 95.0, 110.0];
    const SMALL: u32 = 128;
    let timeline = Timeline::of_frames(1, Rate::default());
    let view = |elevation: f64, right: DVec3| {
        let turn = Angle(elevation).cos_sin();
        let (eye, forward) = (DVec3::new(0.0, turn.y, turn.x) * 10.0, DVec3::new(0.0, -turn.y, -turn.x));
        let up = right.cross(forward);
        panel(SMALL, |x, y| {
            let direction = forward + (right * x + up * y) * 0.35;
            let at = eye - direction * (eye.y / direction.y);
            if !at.is_finite() {
                return NOTHING;
            }
            let dim = if (at.x.floor() + at.z.floor()).rem_euclid(2.0) == 0.0 { 0.55 } else { 1.0 };
            let color = match (at.x > 0.0, at.z > 0.0) {
                (true, true) => DVec3::new(0.7, 0.25, 0.15),
                (false, true) => DVec3::new(0.75, 0.6, 0.2),
                (true, false) => DVec3::new(0.15, 0.35, 0.7),
                (false, false) => DVec3::new(0.2, 0.55, 0.3),
            };
            color * dim
        })
    };
    let count = FRAMES.len() as u32;
    let mut sheet = Sheet::new(2 * count, count, (SMALL, SMALL), 1);
    for (index, elevation) in (0..).zip(FRAMES) {
        let rights = [fixed_up::<f32>(elevation).wide(), our_right(&at_elevation(elevation), &timeline)];
        for (row, (right, title)) in (0..).zip(rights.into_iter().zip(TITLES)) {
            sheet.put(row * count + index, &view(elevation, right), &format!("{title}, {elevation}°"));
        }
    }
    sheet.finish()
}

//! Cameras and animation. CA-02, CA-03, CA-04, CA-07 and CA-08 stand beside their formulas: in `src/camera/path`,
//! `src/base/math`, `src/base/time.rs` and `src/encode/gif`; the lens of CA-09 in `src/camera/mod.rs`.

use crate::exact::{Exact, Vector};
use crate::support::{Random, U, direction, sequence, shoot, shoot_all};
use kinora::base::math::{Angle, DMat3, DQuat, DVec2, DVec3, axis_angle, look_at, slerp};
use kinora::camera::{Camera, Projection, ThinLens};

/// Films of frames that a whole turn lies between are the same bit for bit, after a hundred turns too. cos(2πk/N)
/// differs in 104 of 120 frames.
#[test]
fn ca_01_orbits_close_in_pictures() {
    let scene = "output: (size: (12, 9)), quality: (antialias: 1),
        lights: { \"l\": Point(position: (3, 5, 4)) },
        objects: { \"floor\": (shape: Plane(point: (0, -1, 0)), material: (color: Checker())),
            \"box\": (shape: Box(min: (-1, -1, -0.5), max: (0.5, 1, 1))) }";
    let films = |timeline: &str, path: &str, frames: Vec<u32>| {
        let text = format!("({timeline}, camera: (position: (1, 2, 6), {path}), {scene})");
        let shots = shoot(&sequence(&text), frames);
        shots.into_iter().map(|shot| shot.film).collect::<Vec<_>>()
    };
    // Of 120 frames to a turn the angles are whole degrees; of 119 they are no binary fractions.
    for period in [120, 119] {
        let timeline = format!("timeline: (frames: {}, fps: 24)", 3 * period);
        for path in ["path: Orbit(turns: 3)", "path: Orbit(turns: -3, elevation: 30, radius: 5)"] {
            let all = films(&timeline, path, (0..3 * period as u32).collect());
            for k in 0..2 * period {
                assert!(all[k] == all[k + period], "{path}: frame {k} of {period}");
            }
        }
    }
    let many =
        films("timeline: (frames: 12000, fps: 24)", "path: Orbit(turns: 100)", vec![0, 7, 11_880, 11_887]);
    assert!(many[0] == many[2] && many[1] == many[3]);
    // The camera itself, to its last bits, which pictures may hide.
    for (turns, frames) in [(3, 21), (100, 700), (-7, 343), (3, 357)] {
        let timeline = format!("timeline: (frames: {frames}, fps: 24)");
        let text = format!("({timeline}, camera: (position: (1, 2, 6), path: Orbit(turns: {turns})))");
        let (orbit, period) = (sequence(&text), (frames / i32::abs(turns)) as u32);
        let camera = |frame: u32| orbit.cameras[0].value.at(&orbit.timeline.clock(frame), None);
        for frame in 0..frames as u32 - period {
            assert_eq!(camera(frame), camera(frame + period), "frame {frame} of {turns} turns");
        }
    }
    let keyed = "position: Track(keys: [(0, (1, 2, 6)), (1, (5, 3, 1)), (5, (1, 2, 6))], repeat: Loop)";
    let text = format!("(timeline: (frames: 241, fps: 24), camera: ({keyed}), {scene})");
    let shots = shoot(&sequence(&text), [0, 120, 240, 7, 127]);
    assert!(shots[0].film == shots[1].film && shots[0].film == shots[2].film);
    assert!(shots[3].film == shots[4].film);
}

/// A path that is declared closed ends where it begins.
#[test]
fn ca_01_closed_splines_end_where_they_begin() {
    let path = "Spline(points: [(0, 1, 5), (5, 2, 0), (0, 1, -5), (-5, 3, 0)], closed: true)";
    let text = format!(
        "(timeline: (frames: 121, duration: 5), output: (size: (8, 6)), camera: (path: {path}), objects: {{ \"b\": (shape: Sphere()) }})"
    )
    .replace("frames: 121, ", "");
    // The end is exclusive: the frame after the last is the first one again.
    let sequence = sequence(&text);
    let shots = shoot(&sequence, [0, sequence.timeline.frames]);
    assert!(shots[0].film == shots[1].film);
}

/// Quaternions that are nearly opposite, opposite and equal: the angle is that of the shorter arc, to its last digits.
#[test]
fn ca_04_slerp_between_all_rotations() {
    let mut random = Random(4);
    for _ in 0..20_000 {
        let axis = direction(&mut random);
        let start = DQuat::from_axis_angle(direction(&mut random), 7.0 * random.unit());
        let angle = match (random.unit() * 4.0) as u32 {
            0 => libm::exp2(-60.0 * random.unit()),
            1 => std::f64::consts::PI * (1.0 - libm::exp2(-50.0 * random.unit())),
            _ => std::f64::consts::PI * random.unit(),
        };
        let end = DQuat::from_axis_angle(axis, angle) * start;
        let end = if random.unit() < 0.5 { -end } else { end };
        let s = random.unit();
        let found = slerp(start, end, s);
        assert!((found.length() - 1.0).abs() <= 8.0 * U, "{}", found.length());
        let near = if start.dot(found) < 0.0 { -found } else { found };
        let turned = 4.0 * libm::atan2((near - start).length(), (near + start).length());
        // Next to half a turn, rounding decides which way is shorter, and both are as long.
        assert!((turned - s * angle).abs() <= 1e-12 + 1e-9 * angle, "{angle} {s}: {turned}");
    }
    let start = DQuat::from_axis_angle(DVec3::Y, 0.3);
    for s in [0.0, 0.3, 1.0] {
        assert_eq!(slerp(start, start, s), start);
        let opposite = slerp(start, -start, s);
        assert!((opposite - start).length() <= 8.0 * U || (opposite + start).length() <= 8.0 * U);
    }
}

/// Keys of angles turn by all that lies between them: a quarter of 720 degrees is half a turn.
#[test]
fn ca_05_angles_turn_all_the_way() {
    let s = kinora::base::time::Fraction { num: 1.0, den: 4.0 };
    let quarter = axis_angle(DVec3::Y, Angle(0.0).mix(Angle(720.0), s));
    assert_eq!(quarter * DVec3::X, DVec3::NEG_X);
    let half = kinora::base::time::Fraction { num: 1.0, den: 2.0 };
    assert_eq!(axis_angle(DVec3::Y, Angle(0.0).mix(Angle(180.0), half)) * DVec3::X, DVec3::NEG_Z);
}

/// Frames of sight in any direction with any up: orthonormal to 8 u, right-handed, forward as it was.
#[test]
fn ca_03_frames_of_sight_everywhere() {
    let mut random = Random(3);
    for k in 0..50_000 {
        let scale = libm::exp2(600.0 * random.unit() - 300.0);
        let way = direction(&mut random) * scale;
        let up = match k % 4 {
            0 => direction(&mut random),
            1 => way,
            2 => way * -1e-5 + direction(&mut random) * (scale * libm::exp2(-60.0 * random.unit())),
            _ => direction(&mut random) * libm::exp2(600.0 * random.unit() - 300.0),
        };
        let basis = look_at(DVec3::ZERO, way, up).expect("a frame");
        let b = DMat3::from_cols(basis.right, basis.up, -basis.forward);
        let off = b * b.transpose() - DMat3::IDENTITY;
        let off = off.abs().to_cols_array().into_iter().fold(0.0, f64::max);
        assert!(off <= 8.0 * U && b.determinant() > 0.0, "{} u for {way} {up}", off / U);
        assert!((basis.forward - way / scale / (way / scale).length()).length() <= 4.0 * U);
        let exact = (Vector::from(way / scale)).cross(Vector::from(up));
        let sine = exact.length().value() / up.length();
        // What is no direction to within rounding is answered by another one.
        if k % 4 != 1 && sine > 64.0 * U {
            let expected = exact.scaled(Exact::from(1.0) / exact.length()).value();
            assert!((basis.right - expected).length() <= 8.0 * U / sine, "{way} {up}");
        }
    }
}

/// All rays of a pixel meet in one point of the plane in focus.
#[test]
fn ca_09_lenses_meet_in_focus() {
    let basis = look_at(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y).expect("a frame");
    let projection = Projection::Perspective { half_height: 0.4 };
    let lens = Some(ThinLens { radius: 0.5, focus: 7.0 });
    let camera = Camera { position: DVec3::ZERO, basis, projection, lens };
    let mut random = Random(9);
    let screen = DVec2::new(0.3, -0.8);
    let sharp = DVec3::new(screen.x * 0.4, screen.y * 0.4, -1.0) * 7.0;
    for _ in 0..1000 {
        let ray = camera.ray(screen, DVec2::new(random.unit(), random.unit()));
        let met = ray.at((sharp.z - ray.origin.z) / ray.direction.z);
        assert!((met - sharp).length() <= 16.0 * U * 7.0, "{} u", (met - sharp).length() / U);
    }
}

/// From 10 and from a million units away an orthographic camera sees the same, to the last bit.
#[test]
fn ca_09_orthographic_cameras_see_the_same_from_anywhere() {
    let picture = |z: f64| {
        let text = format!(
            "(output: (size: (32, 24)), camera: (position: (0, 0, {z:?}), projection: Orthographic(height: 3)),
            lights: {{ \"l\": Directional(direction: (-1, -2, -3)) }},
            objects: {{ \"ball\": (shape: Sphere(radius: 0.8)),
                \"wall\": (shape: Plane(point: (0, 0, -1), normal: (0, 0, 1)), material: (color: Checker(scale: 0.5))) }})"
        );
        shoot_all(&text)[0].film.radiance().collect::<Vec<_>>()
    };
    let near = picture(10.0);
    for z in [100.0, 1e4, 1e6] {
        let off = near.iter().zip(picture(z)).map(|(a, b)| (*a - b).abs().max_element()).fold(0.0, f32::max);
        assert_eq!(off, 0.0, "from {z}");
    }
}

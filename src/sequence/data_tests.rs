//! Sequences with data of other programs: axes, units, fitted cameras, and poses from tables.

use super::{Sequence, parse};
use crate::base::math::{DAffine3, DQuat, DVec3};
use crate::base::time::Time;
use crate::camera::path::{CameraPath, Fit};
use crate::camera::{Camera, Projection};
use crate::world::{self, Transform};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

fn read(text: &str) -> Sequence {
    parse("test.ron", text).unwrap_or_else(|faults| panic!("{faults}"))
}

/// A folder with these files.
fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    files.iter().for_each(|(name, text)| fs::write(folder.path().join(name), text).expect("a disk"));
    folder
}

fn read_in(folder: &TempDir, text: &str) -> Sequence {
    let path = folder.path().join("test.ron");
    parse(&path.to_string_lossy(), text).unwrap_or_else(|faults| panic!("{faults}"))
}

fn faults_in(folder: &TempDir, text: &str) -> String {
    let path = folder.path().join("test.ron");
    parse(&path.to_string_lossy(), text).expect_err("faults").to_string()
}

fn at(sequence: &Sequence, frame: u32) -> Camera {
    sequence.fitted_camera(0).at(&sequence.timeline.clock(frame), None).expect("a camera")
}

/// Where a camera shows a point: from -1 to 1 from the bottom to the top, in the same scale to the right.
fn shown(camera: &Camera, point: DVec3) -> (f64, f64) {
    let v = point - camera.position;
    let (x, y, depth) = (v.dot(camera.basis.right), v.dot(camera.basis.up), v.dot(camera.basis.forward));
    match camera.projection {
        Projection::Perspective { half_height } => (x / (half_height * depth), y / (half_height * depth)),
        Projection::Orthographic { half_height } => (x / half_height, y / half_height),
    }
}

/// The largest coordinates of the points of a box, as shares of the picture's half width and height.
fn reach(camera: &Camera, aspect: f64, corners: impl IntoIterator<Item = DVec3>) -> (f64, f64) {
    corners
        .into_iter()
        .map(|corner| shown(camera, corner))
        .fold((0.0, 0.0), |(a, b), (x, y)| (f64::max(a, x.abs() / aspect), f64::max(b, y.abs())))
}

const BOX: &str = "\"box\": (shape: Box(min: (99999, 99998, -3), max: (100001, 100002, 3)))";

fn corners() -> [DVec3; 8] {
    let bounds = crate::base::math::Aabb {
        min: DVec3::new(99999.0, 99998.0, -3.0),
        max: DVec3::new(100001.0, 100002.0, 3.0),
    };
    bounds.corners()
}

#[test]
fn a_still_camera_touches_the_margins_on_opposite_sides() {
    for projection in ["Perspective(fov: 30)", "Orthographic()"] {
        let sequence = read(&format!(
            "(output: (size: (300, 200)), camera: (position: (3, 2, 4), projection: {projection}, frame: All, \
             margin: 0.05), objects: {{ \"floor\": (shape: Plane()), {BOX} }})"
        ));
        let camera = at(&sequence, 0);
        let points: Vec<_> = corners().map(|corner| shown(&camera, corner)).to_vec();
        let ends = |of: fn(&(f64, f64)) -> f64| {
            points.iter().map(of).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)))
        };
        let (left, right) = ends(|(x, _)| *x);
        let (bottom, top) = ends(|(_, y)| *y);
        // A free share of 0.05 of the height, which is 2, on every side.
        assert!((top - 0.9).abs() < 1e-6 && (bottom + 0.9).abs() < 1e-6, "{projection} {bottom} {top}");
        assert!(right < 1.4 && left > -1.4, "{projection} {left} {right}");
    }
}

#[test]
fn an_orbit_keeps_its_distance_and_shows_everything() {
    let text = |projection: &str| {
        format!(
            "(timeline: (frames: 72), output: (size: (200, 300)), camera: (position: (3, 2, 4), frame: \"box\", \
             margin: 0, projection: {projection}, path: Orbit()), objects: {{ {BOX}, \
             \"far\": (shape: Sphere(center: (0, 0, 0), radius: 50)) }})"
        )
    };
    for projection in ["Perspective()", "Orthographic()"] {
        let sequence = read(&text(projection));
        let CameraPath { frame, .. } = sequence.fitted_camera(0);
        let Fit { center, distance, .. } = frame.and_then(|frame| frame.fit).expect("a fit");
        assert_eq!(center, DVec3::new(1e5, 1e5, 0.0));
        let mut most: f64 = 0.0;
        for frame in 0..72 {
            let camera = at(&sequence, frame);
            assert!(((camera.position - center).length() / distance - 1.0).abs() < 1e-9);
            let (x, y) = reach(&camera, 2.0 / 3.0, corners());
            assert!(x <= 1.0 + 1e-6 && y <= 1.0 + 1e-6, "{projection}, frame {frame}: {x} {y}");
            most = most.max(x).max(y);
        }
        assert!(most > 1.0 - 1e-6, "{projection} {most}");
    }
}

/// A moving object is framed over all frames, by one camera.
#[test]
fn a_still_camera_does_not_breathe() {
    let sequence = read(
        "(timeline: (frames: 48), camera: (frame: \"arm\"), objects: { \
         \"arm\": (shape: Group, rotation: AxisAngle(axis: (0, 0, 1), angle: [(0, 0), (2, 360)])), \
         \"hand\": (shape: Sphere(center: (5, 0, 0), radius: 0.5), parent: \"arm\") })",
    );
    let (first, later) = (at(&sequence, 0), at(&sequence, 31));
    assert_eq!(first, later);
    // Seen almost along the axis, the hand goes around a circle of radius 5.5.
    let (_, y) = shown(&first, DVec3::new(0.0, 5.5, 0.0));
    assert!(y > 0.7 && y <= 0.8, "{y}");
}

#[test]
fn spheres_and_meshes_are_framed_by_their_outlines() {
    let of = |shape: &str| {
        let text = format!(
            "(camera: (position: (1, 2, 5), margin: 0, projection: Orthographic(), frame: All), \
             output: (size: (100, 100)), objects: {{ \"a\": (shape: {shape}, scale: (1, 2, 1)) }})"
        );
        read(&text).fitted_camera(0).frame.and_then(|frame| frame.fit?.half_height).expect("a height")
    };
    // An ellipsoid's outline in a direction n is |diag(1, 2, 1) n|.
    let camera = read("(camera: (position: (1, 2, 5)))").fitted_camera(0);
    let up = camera.at(&read("()").timeline.clock(0), None).expect("a camera").basis.up;
    let expected = (up * DVec3::new(1.0, 2.0, 1.0)).length();
    assert!((of("Sphere()") - expected).abs() < 1e-14);
    let triangle = of("Mesh(vertices: [(0, 0, 0), (1, 0, 0), (0, 1, 0), (9, 9, 9)], triangles: [(0, 1, 2)])");
    assert!(triangle < 1.1, "{triangle}");
}

/// Objects that a transform flattens are not visible, and do not count.
#[test]
fn flattened_objects_are_not_framed() {
    let distance = |more: &str| {
        let text = format!(
            "(timeline: (frames: 4, keys: Frames), camera: (position: (0, 0, 1), frame: All), \
             objects: {{ \"a\": (shape: Sphere()){more} }})"
        );
        read(&text).fitted_camera(0).frame.and_then(|frame| Some(frame.fit?.distance)).expect("a distance")
    };
    let alone = distance("");
    for scale in ["[(0, 0, Step), (9, 1)]", "[(0, (0, 1, 1), Step), (9, 1)]"] {
        let far = format!(", \"b\": (shape: Sphere(), translation: (40, 0, 0), scale: {scale})");
        assert_eq!(distance(&far), alone, "{scale}");
    }
    assert!(distance(", \"b\": (shape: Sphere(), translation: (40, 0, 0))") > 10.0 * alone);
}

/// The world is the same whether a file writes it with y up or with z up.
#[test]
fn z_up_is_another_notation() {
    let common = "timeline: (frames: 9, fps: 4)";
    let y = read(&format!(
        "({common}, camera: (position: (1, 2, 5), target: (0, 1, 0), path: Orbit(turns: 0.5)), \
         lights: {{ \"a\": Point(position: (1, 2, -3)) }}, objects: {{ \"floor\": (shape: Plane()), \
         \"cone\": (shape: Cone(), translation: [(0, (1, 2, -3)), (1, (4, 5, -6))], \
         rotation: AxisAngle(axis: (0, 1, 0), angle: 30), scale: (1, 2, 3)), \
         \"ball\": (shape: Sphere(center: (1, 2, -3)), parent: \"cone\") }})"
    ));
    let z = read(&format!(
        "(up: Z, {common}, camera: (position: (1, -5, 2), target: (0, 0, 1), path: Orbit(turns: 0.5)), \
         lights: {{ \"a\": Point(position: (1, 3, 2)) }}, objects: {{ \"floor\": (shape: Plane()), \
         \"cone\": (shape: Cone(), translation: [(0, (1, 3, 2)), (1, (4, 6, 5))], \
         rotation: AxisAngle(axis: (0, 0, 1), angle: 30), scale: (1, 3, 2)), \
         \"ball\": (shape: Sphere(center: (1, 3, 2)), parent: \"cone\") }})"
    ));
    assert_eq!(y.lights, z.lights);
    assert_eq!(at(&y, 3), at(&z, 3));
    let (up, objects) = (z.up, [transforms(&y), transforms(&z)]);
    let [y_up, z_up] = objects;
    for (a, b) in y_up.into_iter().zip(z_up) {
        let probe = DVec3::new(0.3, -0.7, 1.9);
        let (p, q) = (a.transform_point3(up.to_y_up(probe)), b.transform_point3(probe));
        assert!((p - q).length() < 1e-14, "{p} {q}");
    }
}

/// The world transforms of all objects at the first frame.
fn transforms(sequence: &Sequence) -> Vec<DAffine3> {
    let mut world = world::spawn(sequence);
    let mut schedule = bevy_ecs::schedule::Schedule::default();
    schedule.add_systems(world::animate::transforms);
    schedule.run(&mut world);
    let entities = world.resource::<world::Objects>().0.clone();
    entities.into_iter().map(|entity| world.get::<Transform>(entity).expect("a transform").0).collect()
}

const PART: &str = "v 100000 100000 0\nv 100040 100000 0\nv 100000 100010 0\nv 100000 100000 20\n\
                    f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

#[test]
fn meshes_are_turned_centred_and_scaled() {
    let folder = folder(&[("part.obj", PART)]);
    let mesh = |fields: &str| {
        let text = format!("(objects: {{ \"a\": (shape: Mesh(file: \"part.obj\"{fields})) }})");
        read_in(&folder, &text).meshes()[0].1.positions().to_vec()
    };
    assert_eq!(mesh("")[3], DVec3::new(1e5, 1e5, 20.0));
    assert_eq!(mesh(", up: Z")[3], DVec3::new(1e5, 20.0, -1e5));
    let centred = mesh(", up: Z, center: Base, scale: 0.001");
    assert_eq!(centred[0], DVec3::new(-0.02, 0.0, 0.005));
    assert_eq!(centred[3], DVec3::new(-0.02, 0.02, 0.005));
    assert_eq!(mesh(", center: Bounds")[0], DVec3::new(-20.0, -5.0, -10.0));
    // In a file with z up, the same mesh needs no turn.
    let text = "(up: Z, objects: { \"a\": (shape: Mesh(file: \"part.obj\", center: Base)), \
                \"b\": (shape: Mesh(file: \"part.obj\", center: Base)) })";
    let sequence = read_in(&folder, text);
    assert_eq!(sequence.meshes().len(), 1);
    assert_eq!(sequence.meshes()[0].1.positions()[3], DVec3::new(-20.0, -5.0, 20.0));
}

fn seconds(num: i128, den: i128) -> Time {
    Time::new(num, den)
}

#[test]
fn poses_are_keys() {
    let table = "t,x,y,z,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n0.5,1,2,3,0,0,2,0\n";
    let folder = folder(&[("arm.csv", table)]);
    let sequence = read_in(&folder, "(objects: { \"a\": (shape: Sphere(), poses: \"arm.csv\") })");
    let tracks = &sequence.objects[0].value.transform;
    assert_eq!(tracks.translation.at(seconds(1, 4)), DVec3::new(0.5, 1.0, 1.5));
    let quarter = tracks.at(seconds(1, 4)).matrix3 * DVec3::Z;
    assert!((quarter - DVec3::X).length() < 1e-15, "{quarter}");
    let frames = "(timeline: (fps: 10, keys: Frames), objects: { \"a\": (shape: Sphere(), poses: \
                  Poses(file: \"arm.csv\", ease: Step, repeat: Loop)) })";
    let tracks = read_in(&folder, frames).objects.remove(0).value.transform;
    assert_eq!(tracks.translation.at(seconds(1, 20)), DVec3::ZERO);
}

#[test]
fn matrices_are_poses_in_both_orders() {
    let row = "t,a,b,c,d,e,f,g,h,i,j,k,l,m,n,o,p\n0,0,0,2,1,0,2,0,2,-2,0,0,3,0,0,0,1\n";
    let column = "t,a,b,c,d,e,f,g,h,i,j,k,l,m,n,o,p\n0,0,0,-2,0,0,2,0,0,2,0,0,0,1,2,3,1\n";
    let usual = "t,m00,m01,m02,m03,m10,m11,m12,m13,m20,m21,m22,m23,m30,m31,m32,m33\n\
                 0,0,0,2,1,0,2,0,2,-2,0,0,3,0,0,0,1\n";
    let folder = folder(&[("row.csv", row), ("column.csv", column), ("usual.csv", usual)]);
    let names = ["a", "b", "c", "d", "e", "f", "g", "h", "i", "j", "k", "l", "m", "n", "o", "p"];
    let names = names.map(|name| format!("{name:?}")).join(", ");
    let of = |poses: &str| {
        let text = format!("(objects: {{ \"a\": (shape: Sphere(), poses: {poses}) }})");
        read_in(&folder, &text).objects.remove(0).value.transform.at(seconds(0, 1))
    };
    let expected = DAffine3::from_scale_rotation_translation(
        DVec3::splat(2.0),
        DQuat::from_rotation_y(std::f64::consts::FRAC_PI_2),
        DVec3::new(1.0, 2.0, 3.0),
    );
    let ordered = |file: &str, order: &str| {
        of(&format!("Poses(file: {file:?}, rotation: Matrix(columns: [{names}], order: {order}))"))
    };
    for found in [ordered("row.csv", "Row"), ordered("column.csv", "Column"), of("\"usual.csv\"")] {
        assert!(found.abs_diff_eq(expected, 1e-15), "{found}");
    }
    let text = format!(
        "(objects: {{ \"a\": (shape: Sphere(), poses: Poses(file: \"row.csv\", rotation: Matrix(columns: [{names}], \
         order: Column))) }})"
    );
    let message = faults_in(&folder, &text);
    assert!(message.contains("line 2, column \"a\": the last row of the matrix is"), "{message}");
    assert!(message.contains("is its order Row?"), "{message}");
}

#[test]
fn a_camera_follows_poses() {
    let table = "time,px,py,pz,qw,qx,qy,qz\n0,1,2,3,1,0,0,0\n1,1,2,3,0,0,1,0\n";
    let folder = folder(&[("cam.csv", table)]);
    let at = |text: &str, frame| {
        let sequence = read_in(&folder, text);
        sequence.fitted_camera(0).at(&sequence.timeline.clock(frame), None).expect("a camera")
    };
    let plain = "(timeline: (frames: 24), camera: (poses: \"cam.csv\"))";
    let camera = at(plain, 0);
    assert_eq!(
        (camera.position, camera.basis.forward, camera.basis.up),
        (DVec3::new(1.0, 2.0, 3.0), DVec3::NEG_Z, DVec3::Y)
    );
    assert!((at(plain, 12).basis.forward - DVec3::NEG_X).length() < 1e-14);
    let computer_vision = "(camera: (poses: Poses(file: \"cam.csv\", axes: OpenCv)))";
    let camera = at(computer_vision, 0);
    assert_eq!((camera.basis.forward, camera.basis.up), (DVec3::Z, DVec3::NEG_Y));
    let z_up = "(up: Z, camera: (poses: \"cam.csv\"))";
    let camera = at(z_up, 0);
    assert_eq!(camera.position, DVec3::new(1.0, 3.0, -2.0));
    assert!((camera.basis.forward - DVec3::NEG_Y).length() < 1e-15, "{}", camera.basis.forward);
}

#[test]
fn faults_of_poses_name_file_line_and_column() {
    let folder = folder(&[
        ("bad.csv", "t,x,y,z\n0,0,0,0\n1,a,0,0\n"),
        ("times.csv", "t,x,y,z\n0,0,0,0\n1,0,0,0\n1,0,0,0\n"),
        ("zero.csv", "t,qw,qx,qy,qz\n0,0,0,0,0\n"),
        ("other.csv", "frame,left\n0,0\n"),
        ("shear.csv", "t,a,b,c,d,e,f,g,h,i\n0,1,0,0,0,1,0,0,0,1\n1,1,1,0,0,1,0,0,0,1\n"),
        ("mirror.csv", "t,a,b,c,d,e,f,g,h,i\n0,1,0,0,0,1,0,0,0,1\n1,-1,0,0,0,1,0,0,0,1\n"),
    ]);
    let fault = |poses: &str| {
        faults_in(&folder, &format!("(objects: {{ \"a\": (shape: Sphere(), poses: {poses}) }})"))
    };
    let has = |poses: &str, part: &str| {
        let message = fault(poses);
        assert!(message.contains(part), "{message}");
    };
    has("\"bad.csv\"", "cannot use the poses in \"bad.csv\"");
    has("\"bad.csv\"", "line 3, column \"x\": expected a finite number, found `a`");
    has("\"times.csv\"", "line 4, column \"t\": times must ascend, but 1 is not after the time of line 3");
    has("\"zero.csv\"", "line 2, column \"qw\": the quaternion is zero");
    has("\"other.csv\"", "no column of times");
    has(
        "Poses(file: \"bad.csv\", time: \"s\")",
        "it has no column `s`; its columns are `t`, `x`, `y` and `z`",
    );
    has("\"none.csv\"", "there is no such file");
    has("\"a.txt\"", "tables are read from .csv");
    has("3", "the name of a table in quotes");
    let matrix = "rotation: Matrix(columns: [\"a\", \"b\", \"c\", \"d\", \"e\", \"f\", \"g\", \"h\", \"i\"], order: Row)";
    has(
        &format!("Poses(file: \"shear.csv\", {matrix})"),
        "line 3, column \"a\": the matrix shears: two of its columns meet at 45.0000",
    );
    has(
        &format!("Poses(file: \"mirror.csv\", {matrix})"),
        "line 3, column \"a\": the matrix mirrors, unlike those before",
    );
    has("\"zero.csv\", translation: (1, 2, 3)", "line 2");
}

/// Particles without a number are shown in the colour `nan`; a column of anything else is refused where it is used.
#[test]
fn columns_of_colours_may_lack_numbers() {
    let folder = folder(&[("p.csv", "x,y,z,heat,kind\n0,0,0,1,7\n1,0,0,,8\n2,0,0,NaN,b\n3,0,0,5,9\n")]);
    let text = |of: &str| {
        format!(
            "(objects: {{ \"p\": (shape: Particles(file: \"p.csv\", radius: 0.1), \
             material: Unlit(color: Scalar(\"{of}\"))) }})"
        )
    };
    let path = folder.path().join("test.ron");
    let sequence = parse(&path.to_string_lossy(), &text("heat")).expect("a sequence");
    assert!(sequence.warnings.iter().any(|warning| warning.contains("`heat` is (1, 5)")), "{sequence:?}");
    let faults = faults_in(&folder, &text("kind"));
    assert!(faults.contains("cannot colour by the column `kind`"), "{faults}");
    assert!(faults.contains("line 4, column \"kind\": expected a finite number, found `b`"), "{faults}");
}

/// Instances share their description, so one mistake in it is one mistake.
#[test]
fn a_mistake_of_instances_is_reported_once() {
    let folder = folder(&[("at.csv", "x,y,z\n0,0,0\n1,0,0\n2,0,0\n3,0,0\n")]);
    let text = "(objects: { \"a\": (shape: Instances(shape: Sphere(), file: \"at.csv\"), \
                material: Lambertian(color: Scalar(\"none\"))) })";
    let faults = faults_in(&folder, text);
    assert_eq!(faults.matches("error").count(), 1, "{faults}");
}

#[test]
fn frames_that_cannot_be_fitted_are_refused() {
    let has = |camera: &str, part: &str| {
        let text = format!(
            "(camera: ({camera}), objects: {{ \"floor\": (shape: Plane()), \"a\": (shape: Sphere()) }})"
        );
        let message = parse("test.ron", &text).expect_err("faults").to_string();
        assert!(message.contains(part), "{message}");
    };
    has("frame: \"floor\"", "there is nothing to frame");
    has("frame: \"b\"", "there is no object `b`");
    has("frame: 3", "`All`, the name of an object");
    has("margin: 0.1", "`margin` belongs to `frame`");
    has("frame: All, margin: 0.5", "a number from 0 to below 0.5");
    has("frame: All, path: Orbit(radius: 3)", "`Orbit` has a `radius` here");
    has("frame: All, path: Spline(points: [(0, 0, 1), (1, 0, 1)])", "`Spline` gives positions here");
    has("frame: All, projection: Orthographic(height: 3)", "`frame` finds the height");
}

#[test]
fn tables_are_files_of_the_sequence() {
    let folder = folder(&[("arm.csv", "t,x,y,z\n0,0,0,0\n")]);
    let root = crate::base::files::Root::of(folder.path());
    let path = folder.path().join("test.ron");
    fs::write(&path, "(objects: { \"a\": (shape: Sphere(), poses: \"arm.csv\") })").expect("a disk");
    super::load_watched(&path, root.clone(), &std::sync::Arc::default()).expect("a sequence");
    let names: Vec<_> = root.admitted();
    assert!(names.iter().any(|path| path.file_name() == Path::new("arm.csv").file_name()), "{names:?}");
}

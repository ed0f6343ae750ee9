//! Particles and instances: many things from the rows of a table.

use crate::command::{contents, kinora, refused};
use crate::support::{folder, put, sequence_in, shoot_all_in};
use kinora::base::digest::Digest;
use kinora::film::Film;
use kinora::pipeline::plan::evaluate;
use std::path::Path;

/// Five frames with these objects, on a floor that they shade.
fn text(objects: &str) -> String {
    format!(
        "(timeline: (frames: 5, fps: 24, keys: Frames), output: (size: (40, 30)), quality: (antialias: 2),
        camera: (position: (0, 1, 6)), background: 0.2, lights: {{ \"sun\": Point(position: (3, 4, 5)) }},
        materials: {{ \"m\": (color: \"#c08040\", mirror: 0.3, specular: 0.4) }},
        objects: {{ \"floor\": (shape: Plane(point: (0, -1, 0))), {objects} }})"
    )
}

fn films(folder: &Path, objects: &str) -> Vec<Film> {
    shoot_all_in(folder, &text(objects)).into_iter().map(|shot| shot.film).collect()
}

/// An object of this shape, with further fields.
fn object(name: u32, shape: &str, rest: &str) -> String {
    format!("\"{name}\": (shape: {shape}, material: \"m\", {rest}),")
}

fn keys(folder: &Path, objects: &str) -> Vec<Digest> {
    let sequence = sequence_in(folder, &text(objects));
    evaluate(&sequence, &[0, 1, 2, 3, 4]).frames.into_iter().map(|frame| frame.image_hash).collect()
}

const SPRAY: &str = "\"spray\": (shape: Particles(\"spray.csv\"), material: \"m\")";

/// 1 moves, 2 appears at frame 1, 3 vanishes after frame 2, and 4 is there at frame 3 alone.
const ROWS: &str = "t,id,x,y,z,r,heat\n0,1,-1,0,0,0.5,0\n0,3,1,1,0,0.25,10\n1,2,0,0,1,0.4,20\n2,3,1.5,1,0,0.5,30\n\
    3,4,-2,1,0,0.3,40\n4,1,-2,0,1,0.5,50\n4,2,0,-0.5,1,0.2,60\n";

#[test]
fn particles_look_like_spheres() {
    let folder = folder();
    put(folder.path(), "spray.csv", ROWS);
    let found = films(folder.path(), SPRAY);
    let sphere = |name: &str, keys: [(&str, &str, &str); 2], visible: &str| {
        let [(a, at_a, size_a), (b, at_b, size_b)] = keys;
        format!(
            "\"{name}\": (shape: Sphere(), translation: [({a}, {at_a}), ({b}, {at_b})],
            scale: [({a}, {size_a}), ({b}, {size_b})], visible: {visible}, material: \"m\"),"
        )
    };
    let spheres = [
        sphere("1", [("0", "(-1, 0, 0)", "0.5"), ("4", "(-2, 0, 1)", "0.5")], "true"),
        sphere("2", [("1", "(0, 0, 1)", "0.4"), ("4", "(0, -0.5, 1)", "0.2")], "[(0, false), (1, true)]"),
        sphere("3", [("0", "(1, 1, 0)", "0.25"), ("2", "(1.5, 1, 0)", "0.5")], "[(0, true), (3, false)]"),
        sphere(
            "4",
            [("3", "(-2, 1, 0)", "0.3"), ("4", "(-2, 1, 0)", "0.3")],
            "[(0, false), (3, true), (4, false)]",
        ),
    ];
    let expected = films(folder.path(), &spheres.concat());
    for frame in 0..5 {
        assert_eq!(found[frame], expected[frame], "frame {frame}");
    }
    assert!(found.windows(2).all(|pair| pair[0] != pair[1]));
}

#[test]
fn particles_follow_their_object() {
    let folder = folder();
    put(folder.path(), "still.csv", "x,y,z\n0,0,0\n1,0,0\n0,1,-1\n");
    let object = "\"p\": (shape: Particles(file: \"still.csv\", radius: 0.5), material: \"m\", scale: 2, translation: (-1, 0, 0))";
    let found = films(folder.path(), object);
    let sphere = |name: u32, center: &str| {
        format!("\"{name}\": (shape: Sphere(center: {center}, radius: 1), material: \"m\"),")
    };
    let expected = films(
        folder.path(),
        &[sphere(1, "(-1, 0, 0)"), sphere(2, "(1, 0, 0)"), sphere(3, "(-1, 2, -2)")].concat(),
    );
    let apart = found[0]
        .radiance()
        .zip(expected[0].radiance())
        .map(|(a, b)| (a - b).abs().max_element())
        .fold(0.0, f32::max);
    assert!(apart < 1e-4, "{apart}");
    assert_eq!(found[0], found[4]);
}

#[test]
fn columns_color_particles() {
    let folder = folder();
    put(folder.path(), "spray.csv", ROWS);
    let by = |range: &str| SPRAY.replace("\"m\")", &format!("Unlit(color: Scalar(of: \"heat\"{range})))"));
    let auto = films(folder.path(), &by(""));
    assert_eq!(auto, films(folder.path(), &by(", range: (0, 60)")));
    // Only the numbers change.
    let before = keys(folder.path(), &by(", range: (0, 60)"));
    put(folder.path(), "spray.csv", &ROWS.replace("0.5,30\n", "0.5,35\n"));
    let after = keys(folder.path(), &by(", range: (0, 60)"));
    let changed: Vec<bool> = before.iter().zip(&after).map(|(a, b)| a != b).collect();
    assert_eq!(changed, [false, true, true, false, false]);
    assert_eq!(keys(folder.path(), SPRAY), {
        put(folder.path(), "spray.csv", ROWS);
        keys(folder.path(), SPRAY)
    });
}

#[test]
fn later_rows_leave_earlier_frames_alone() {
    let folder = folder();
    put(folder.path(), "spray.csv", "t,id,x,y,z,r\n0,1,0,0,0,1\n2,1,1,0,0,1\n");
    let before = keys(folder.path(), SPRAY);
    assert!(before[2] == before[3] && before[3] == before[4], "held after the last time");
    put(folder.path(), "spray.csv", "t,id,x,y,z,r\n0,1,0,0,0,1\n2,1,1,0,0,1\n4,1,2,0,0,1\n");
    let after = keys(folder.path(), SPRAY);
    let changed: Vec<bool> = before.iter().zip(&after).map(|(a, b)| a != b).collect();
    assert_eq!(changed, [false, false, false, true, true]);
}

#[test]
fn threads_and_shards_write_the_same_frames() {
    let folder = folder();
    put(folder.path(), "spray.csv", ROWS);
    put(folder.path(), "a.ron", &text(SPRAY));
    kinora(folder.path(), &["render", "a.ron", "-t", "1", "-o", "one/f_#.png"]);
    for shard in ["1/2", "2/2"] {
        kinora(folder.path(), &["render", "a.ron", "-t", "2", "--shard", shard, "-o", "two/f_#.png"]);
    }
    let all = contents(&folder.path().join("one"));
    assert_eq!(all.len(), 5);
    assert!(all == contents(&folder.path().join("two")));
    put(folder.path(), "spray.csv", &ROWS.replace("4,1,-2", "4,1,two"));
    let printed = refused(folder.path(), &["check", "a.ron"]);
    assert!(printed.contains("line 7, column \"x\": expected a finite number, found `two`"), "{printed}");
}

#[test]
fn instances_look_like_objects() {
    let folder = folder();
    put(
        folder.path(),
        "trees.csv",
        "x,y,z,qw,qx,qy,qz,scale\n0,0,0,1,0,0,0,1\n1.5,0,0,0,0,0,1,0.5\n-1,0,-1,1,0,0,1,2\n",
    );
    let shape = "Cone(radius: 0.4)";
    let instances =
        format!("\"trees\": (shape: Instances(shape: {shape}, file: \"trees.csv\"), material: \"m\")");
    let object = |name: u32, rest: &str| object(name, shape, rest);
    let objects = [
        object(1, ""),
        object(2, "translation: (1.5, 0, 0), rotation: Quaternion((0, 0, 1, 0)), scale: 0.5"),
        object(3, "translation: (-1, 0, -1), rotation: Quaternion((0, 0, 1, 1)), scale: 2"),
    ];
    let (found, expected) = (films(folder.path(), &instances), films(folder.path(), &objects.concat()));
    assert_eq!(found, expected);
}

#[test]
fn instances_move_appear_and_vanish() {
    let folder = folder();
    put(folder.path(), "cars.csv", "id,t,x,y,z\n1,0,0,0,0\n2,1,1,0,0\n1,2,0,1,0\n2,4,1,1,0\n");
    let shape = "Box(min: (-0.3, -0.3, -0.3), max: (0.3, 0.3, 0.3))";
    let instances = format!(
        "\"cars\": (shape: Instances(shape: {shape}, file: \"cars.csv\"), translation: (0, 0, 1), material: \"m\")"
    );
    let objects = format!(
        "\"1\": (shape: {shape}, translation: [(0, (0, 0, 1)), (2, (0, 1, 1))], visible: [(0, true), (4, false)], material: \"m\"),
        \"2\": (shape: {shape}, translation: [(1, (1, 0, 1)), (4, (1, 1, 1))], visible: [(0, false), (1, true)], material: \"m\")"
    );
    assert_eq!(films(folder.path(), &instances), films(folder.path(), &objects));
}

/// 1 moves, 2 appears at frame 1, and 3 is gone after frame 2, before the next row of the table at frame 4.
#[test]
fn particles_of_a_shape_look_like_objects() {
    let folder = folder();
    let rows = "t,id,x,y,z,r\n0,1,-1,0,0,0.5\n4,1,-2,0,1,0.5\n1,2,0,0,1,0.4\n4,2,0,-0.5,1,0.2\n0,3,1,1,0,0.25\n\
        2,3,1.5,1,0,0.5\n";
    put(folder.path(), "spray.csv", rows);
    let shape = "Box(min: (-1, -0.5, -0.5), max: (1, 0.5, 0.5))";
    let particles =
        format!("\"spray\": (shape: Particles(file: \"spray.csv\", shape: {shape}), material: \"m\")");
    let object = |name: u32, rest: &str| object(name, shape, rest);
    let objects = [
        object(1, "translation: [(0, (-1, 0, 0)), (4, (-2, 0, 1))], scale: 0.5"),
        object(
            2,
            "translation: [(1, (0, 0, 1)), (4, (0, -0.5, 1))], scale: [(1, 0.4), (4, 0.2)],
            visible: [(0, false), (1, true)]",
        ),
        object(
            3,
            "translation: [(0, (1, 1, 0)), (2, (1.5, 1, 0))], scale: [(0, 0.25), (2, 0.5)],
            visible: [(0, true), (3, false)]",
        ),
    ];
    assert!(films(folder.path(), &particles) == films(folder.path(), &objects.concat()));
    let spheres = SPRAY.replace("\"spray.csv\"", "file: \"spray.csv\", shape: Sphere");
    assert!(films(folder.path(), &spheres) == films(folder.path(), SPRAY), "one packed shape");
}

/// Two boxes that do not move, in colours that change with the numbers of their rows.
#[test]
fn columns_color_instances() {
    let folder = folder();
    let rows =
        "t,id,x,y,z,scale,heat\n0,1,-1,0,0,0.5,0\n4,1,-1,0,0,0.5,40\n0,2,1,0,0,0.5,30\n4,2,1,0,0,0.5,30\n";
    put(folder.path(), "boxes.csv", rows);
    let shape = "Box(min: (-1, -1, -1), max: (1, 1, 1))";
    let map = "map: [\"#ff0000\", \"#0000ff\"], steps: 2";
    let painted = |many: &str, range: &str| {
        let color = format!("Unlit(color: Scalar(of: \"heat\", {map}{range}))");
        format!("\"boxes\": (shape: {many}, material: {color})")
    };
    let instances = format!("Instances(shape: {shape}, file: \"boxes.csv\")");
    let particles = format!("Particles(shape: {shape}, file: \"boxes.csv\", radius: \"scale\")");
    let found = films(folder.path(), &painted(&instances, ""));
    assert!(found == films(folder.path(), &painted(&instances, ", range: (0, 40)")), "the range of all rows");
    assert!(found == films(folder.path(), &painted(&particles, "")));
    // The first one is blue from 20 on, which is frame 2.
    let one = |name: &str, x: i32, color: &str, visible: &str| {
        format!(
            "\"{name}\": (shape: {shape}, translation: ({x}, 0, 0), scale: 0.5,
            material: Unlit(color: \"{color}\"), visible: {visible}),"
        )
    };
    let objects = [
        one("before", -1, "#ff0000", "[(0, true), (2, false)]"),
        one("after", -1, "#0000ff", "[(0, false), (2, true)]"),
        one("other", 1, "#0000ff", "true"),
    ];
    assert!(found == films(folder.path(), &objects.concat()));
    let fixed = painted(&instances, ", range: (0, 40)");
    let before = keys(folder.path(), &fixed);
    put(folder.path(), "boxes.csv", &rows.replace("4,2,1,0,0,0.5,30", "4,2,1,0,0,0.5,20"));
    let changed: Vec<bool> = before.iter().zip(keys(folder.path(), &fixed)).map(|(a, b)| *a != b).collect();
    assert_eq!(changed, [false, true, true, true, true], "the numbers are content");
    put(folder.path(), "a.ron", &text(&fixed));
    kinora(folder.path(), &["render", "a.ron", "-o", "with/f_#.png"]);
    kinora(folder.path(), &["render", "a.ron", "--no-reuse", "-o", "without/f_#.png"]);
    assert!(contents(&folder.path().join("with")) == contents(&folder.path().join("without")));
}

#[test]
fn the_data_of_a_mesh_comes_before_that_of_the_table() {
    let folder = folder();
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        property float own\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
        -1 -1 0 5\n1 -1 0 5\n0 1 0 5\n3 0 1 2\n";
    put(folder.path(), "leaf.ply", ply);
    put(folder.path(), "at.csv", "x,y,z,own,other\n-1,0,0,1,2\n1,0,0,2,3\n");
    let checked = |of: &str| {
        let leaf = format!(
            "\"leaves\": (shape: Instances(shape: Mesh(\"leaf.ply\"), file: \"at.csv\"),
            material: Unlit(color: Scalar(\"{of}\")))"
        );
        put(folder.path(), "a.ron", &text(&leaf));
        kinora(folder.path(), &["check", "a.ron"])
    };
    assert!(checked("own").contains("the range of `own` is (5, 5)"));
    assert!(checked("other").contains("the range of `other` is (2, 3)"));
}

/// Numbers that no texture shows change nothing: frames are equal, though the table has times.
#[test]
fn only_shown_columns_make_frames_different() {
    let folder = folder();
    put(folder.path(), "at.csv", "t,id,x,y,z,heat,load\n0,1,0,0,0,5,1\n4,1,0,0,0,5,2\n");
    let by = |column: &str| {
        let shape = "Instances(shape: Sphere(), file: \"at.csv\")";
        format!("\"ball\": (shape: {shape}, material: (color: Scalar(of: \"{column}\", range: (0, 10))))")
    };
    let same = |keys: Vec<Digest>| keys.windows(2).all(|pair| pair[0] == pair[1]);
    assert!(same(keys(folder.path(), &by("heat"))));
    assert!(!same(keys(folder.path(), &by("load"))));
}

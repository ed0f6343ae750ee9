//! Groups as instances: objects, and all below them, at the places of a table.

use crate::command::{contents, kinora, refused};
use crate::support::{folder, put, sequence_in, shoot_all_in};
use kinora::film::Film;
use kinora::sequence::Sequence;
use std::path::Path;

/// Four frames with these objects.
fn text(objects: &str) -> String {
    format!(
        "(timeline: (frames: 4, fps: 24, keys: Frames), output: (size: (40, 30)), quality: (antialias: 2),
        camera: (position: (0, 1, 8)), background: 0.2, lights: {{ \"sun\": Point(position: (3, 4, 5)) }},
        materials: {{ \"red\": (color: \"#c04040\", mirror: 0.2), \"blue\": (color: \"#4040c0\") }},
        objects: {{ \"floor\": (shape: Plane(point: (0, -1, 0))), {objects} }})"
    )
}

fn films(folder: &Path, objects: &str) -> Vec<Film> {
    shoot_all_in(folder, &text(objects)).into_iter().map(|shot| shot.film).collect()
}

fn names(sequence: &Sequence) -> Vec<&str> {
    sequence.objects.iter().map(|object| object.name.as_str()).collect()
}

/// A car with two wheels, one of which turns.
const CAR: &str = "
    \"car\": (shape: Box(min: (-0.5, 0, -0.2), max: (0.5, 0.3, 0.2)), material: \"red\", visible: false,
        scale: 1.5, rotation: Euler(x: 0, y: 20, z: 0)),
    \"front\": (shape: Torus(axis: (0, 0, 1), major: 0.15, minor: 0.05), parent: \"car\", material: \"blue\",
        translation: (0.4, 0, 0), rotation: AxisAngle(axis: (0, 1, 0), angle: [(0, 0), (4, 90)])),
    \"back\": (shape: Torus(axis: (0, 0, 1), major: 0.15, minor: 0.05), parent: \"car\", material: \"blue\",
        translation: (-0.4, 0, 0)),";

const PLACES: &str = "t,id,x,y,z,scale\n0,1,-1.2,0,0,1\n3,1,-1.2,0.6,0,1\n0,2,1,0,-1,0.5\n3,2,1,0,-1,0.5\n";

/// The same cars, each as a group that is moved.
fn by_hand(name: &str, moved: &str) -> String {
    let own = CAR.replace("visible: false,", &format!("parent: \"{name}\","));
    let own = ["car", "front", "back"]
        .iter()
        .fold(own, |text, part| text.replace(&format!("\"{part}\""), &format!("\"{name} {part}\"")));
    format!("\"{name}\": (shape: Group, {moved}),{own}")
}

#[test]
fn instances_of_a_group_look_like_objects() {
    let folder = folder();
    put(folder.path(), "cars.csv", PLACES);
    let cars = format!(
        "{CAR} \"cars\": (shape: Instances(of: \"car\", file: \"cars.csv\"), translation: (0, 0, 1))"
    );
    let moved = by_hand("one", "translation: [(0, (-1.2, 0, 1)), (3, (-1.2, 0.6, 1))]")
        + &by_hand("two", "translation: (1, 0, 0), scale: 0.5");
    assert!(films(folder.path(), &cars) == films(folder.path(), &moved));
    let sequence = sequence_in(folder.path(), &text(&cars));
    let expected = ["cars[0]", "cars[0]/car", "cars[0]/front", "cars[0]/back", "cars[1]"];
    assert_eq!(names(&sequence)[5..10], expected);
    put(folder.path(), "a.ron", &text(&cars));
    kinora(folder.path(), &["render", "a.ron", "-t", "1", "-o", "with/f_#.png"]);
    kinora(folder.path(), &["render", "a.ron", "-t", "2", "--no-reuse", "-o", "without/f_#.png"]);
    assert!(contents(&folder.path().join("with")) == contents(&folder.path().join("without")));
}

/// Rows of cars: groups that hold instances of groups.
#[test]
fn groups_may_hold_instances() {
    let folder = folder();
    put(folder.path(), "row.csv", "x,y,z\n-1,0,0\n1,0,0\n");
    put(folder.path(), "rows.csv", "x,y,z\n0,0,0\n0,0.8,-1\n0,1.6,-2\n");
    let rows = format!(
        "\"rows\": (shape: Instances(of: \"row\", file: \"rows.csv\")),
        \"row\": (shape: Group, visible: false),
        \"in row\": (shape: Instances(of: \"car\", file: \"row.csv\"), parent: \"row\"), {CAR}"
    );
    let place = |(row, x): (i32, i32)| {
        let (y, z) = (0.8 * f64::from(row), -f64::from(row));
        by_hand(&format!("{row} {x}"), &format!("translation: ({x}, {y}, {z})"))
    };
    let places = [(0, -1), (0, 1), (1, -1), (1, 1), (2, -1), (2, 1)];
    let cars: String = places.map(place).concat();
    assert!(films(folder.path(), &rows) == films(folder.path(), &cars));
}

/// Cuts with caps and exploded views of a group are those of its instances, and of what shows them.
#[test]
fn instances_are_cut_and_explode() {
    let folder = folder();
    put(folder.path(), "at.csv", "x,y,z\n-1.5,0,0\n1.5,0,0\n");
    let cut = "clip: [Plane(normal: (0, 0, 1))], cap: \"blue\"";
    let explode = "explode: (factor: [(0, 0), (3, 1)])";
    let two = |inner: &str| {
        format!(
            "\"pair\": (shape: Group, {inner}),
            \"left\": (shape: Sphere(center: (-0.4, 0, 0), radius: 0.5), parent: \"pair\", material: \"red\"),
            \"right\": (shape: Sphere(center: (0.4, 0, 0), radius: 0.5), parent: \"pair\", material: \"red\"),"
        )
    };
    let hand = |inner: &str, outer: &str| {
        let one = |name: &str, x: f64| {
            let own = two(&format!("{inner}, parent: \"place {name}\""));
            let own = ["pair", "left", "right"]
                .iter()
                .fold(own, |text, part| text.replace(&format!("\"{part}\""), &format!("\"{name} {part}\"")));
            format!("\"place {name}\": (shape: Group, translation: ({x}, 0, 0), parent: \"all\"), {own}")
        };
        format!("\"all\": (shape: Group{outer}), {}{}", one("a", -1.5), one("b", 1.5))
    };
    let shown = |inner: &str, outer: &str| {
        let hidden = two(&format!("visible: false, {inner}"));
        format!("{hidden} \"all\": (shape: Instances(of: \"pair\", file: \"at.csv\"){outer})")
    };
    let inside = format!("{cut}, {explode}");
    assert!(films(folder.path(), &shown(&inside, "")) == films(folder.path(), &hand(&inside, "")));
    let outside = format!(", {cut}, {explode}");
    let found = films(folder.path(), &shown("scale: 0.9", &outside));
    assert!(found == films(folder.path(), &hand("scale: 0.9", &outside)));
}

/// The colours of instances come from their rows, which the hidden group itself does not have.
#[test]
fn columns_color_the_objects_of_a_group() {
    let folder = folder();
    put(folder.path(), "at.csv", "x,y,z,heat\n-1,0,0,0\n1,0,0,10\n");
    let color = "Unlit(color: Scalar(of: \"heat\", map: [\"#ff0000\", \"#0000ff\"], steps: 2))";
    let group = |visible: bool| {
        format!(
            "\"lamp\": (shape: Group, visible: {visible}),
            \"bulb\": (shape: Sphere(radius: 0.5), parent: \"lamp\", material: {color}),
            \"lamps\": (shape: Instances(of: \"lamp\", file: \"at.csv\"))"
        )
    };
    let bulb = |x: i32, color: &str| {
        format!(
            "\"{x}\": (shape: Sphere(radius: 0.5), translation: ({x}, 0, 0), material: Unlit(color: \"{color}\")),"
        )
    };
    let expected = films(folder.path(), &(bulb(-1, "#ff0000") + &bulb(1, "#0000ff")));
    assert!(films(folder.path(), &group(false)) == expected);
    put(folder.path(), "a.ron", &text(&group(true)));
    let printed = refused(folder.path(), &["check", "a.ron"]);
    assert!(printed.contains("only meshes, particles and instances have data such as `heat`"), "{printed}");
}

/// Templates may hold a group and its instances.
#[test]
fn templates_show_their_own_groups() {
    let folder = folder();
    put(folder.path(), "at.csv", "x,y,z\n-1,0,0\n1,0,0\n");
    let text = "(output: (size: (8, 8)), templates: { \"fleet\": (objects: {
            \"car\": (shape: Box(min: (0, 0, 0), max: (1, 1, 1))),
            \"all\": (shape: Instances(of: \"car\", file: \"at.csv\")) }) },
        objects: { \"one\": (template: \"fleet\"), \"two\": (template: \"fleet\", translation: (0, 2, 0)) })";
    let sequence = sequence_in(folder.path(), text);
    let copies: Vec<_> = names(&sequence).into_iter().filter(|name| name.ends_with("[1]/one/car")).collect();
    assert_eq!(copies, ["one/all[1]/one/car"]);
}

/// Every level shows the next one; too many are a fault, not a deep recursion.
#[test]
fn groups_are_not_too_deep() {
    let folder = folder();
    put(folder.path(), "one.csv", "x,y,z\n0,0,0\n");
    let levels = |count: u32| {
        let level = |index: u32| {
            format!(
                "\"g{index}\": (shape: Group),
                \"i{index}\": (shape: Instances(of: \"g{}\", file: \"one.csv\"), parent: \"g{index}\"),",
                index + 1
            )
        };
        let all: String = (0..count).map(level).collect();
        put(folder.path(), "a.ron", &format!("(objects: {{ {all} \"g{count}\": (shape: Sphere()) }})"));
    };
    levels(16);
    kinora(folder.path(), &["check", "a.ron"]);
    levels(3000);
    let printed = refused(folder.path(), &["check", "a.ron"]);
    assert!(printed.contains("groups hold instances of each other at most 16 deep"), "{printed}");
}

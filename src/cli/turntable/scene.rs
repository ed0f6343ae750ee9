//! The text of a turntable's sequence.

use super::parts::{Part, scene_object};
use crate::base::math::{Aabb, DVec3, UpAxis};
use crate::base::time::Rate;
use crate::sequence::quoted_value;
use std::collections::HashSet;
use std::fmt::Write;

/// Colours of parts without their own, one after the other.
const COLORS: [&str; 6] = ["#8fa3b8", "#d9834a", "#5b8fb0", "#d8b34c", "#7fa66b", "#a87f9f"];

/// Samples of a pixel where something is random.
const ROUGH_SAMPLES: u32 = 16;

/// What a sequence is written of.
pub struct Scene<'a> {
    pub parts: &'a [Part],
    /// The files to render.
    pub files: &'a [String],
    pub frames: u32,
    pub rate: Rate,
    pub size: (u32, u32),
    pub bounces: u32,
    pub antialias: u32,
}

impl Scene<'_> {
    /// The sequence: the parts turn in front of a still camera and still lights.
    pub fn text(&self) -> String {
        let Self { frames, rate, size: (width, height), bounces, antialias, .. } = self;
        let files: Vec<String> = self.files.iter().map(|file| quoted_value(file)).collect();
        let files = files.join(", ");
        // The rough surfaces of glTF are sampled at random; few samples do under lights that are even.
        let is_rough = self.parts.iter().any(|part| part.is_scene);
        let samples = if is_rough { format!(", samples: {ROUGH_SAMPLES}") } else { String::new() };
        let lights = self.lights();
        let (materials, objects) = (self.materials(), self.objects());
        format!(
            r##"// Written by `kinora turntable`. Change what you like: sequences/README.md explains every field.
(
    timeline: (frames: {frames}, fps: "{rate}", keys: Frames),
    output: (size: ({width}, {height}), files: [{files}]),
    // `antialias: 3` smooths edges, in about nine times the time.
    quality: (bounces: {bounces}, antialias: {antialias}{samples}),
    background: "#e9ebee",
    // From this direction. The distance follows from the parts, which all frames show entirely.
    camera: (position: (0, 0.5, 1), projection: Perspective(fov: 28), frame: "turntable", margin: 0.1),
    lights: {{
{lights}    }},
    materials: {{
{materials}    }},
    objects: {{
{objects}    }},
)
"##
        )
    }

    fn bounds(&self) -> Aabb {
        self.parts.iter().fold(Aabb::EMPTY, |bounds, part| bounds.union(part.bounds))
    }

    /// Three lights: the key from the left in front, a weak fill from the right, and a rim light from behind. Only the
    /// key casts shadows: those of weak lights would hardly show, and take two thirds of the shadow rays.
    fn lights(&self) -> String {
        let size = self.bounds().max - self.bounds().min;
        // The parts turn within a circle around the axis.
        let radius = 0.5 * size.length();
        let middle = 0.5 * size.y;
        let point = |x: f64, y: f64, z: f64| vector(DVec3::new(x, y, z) * radius + DVec3::Y * middle);
        let target = vector(DVec3::Y * middle);
        let key = point(-3.2, 4.6, 4.2);
        format!(
            r##"        "key": Spot(position: {key}, target: {target}, angle: 56, inner_angle: 6, color: "#fff4e6"),
        "fill": Directional(direction: (-1, -0.7, -0.6), intensity: 0.2, color: "#dfe9ff", shadows: false),
        "rim": Directional(direction: (0.5, -0.9, 1), intensity: 0.2, shadows: false),
"##
        )
    }

    fn materials(&self) -> String {
        let mut text =
            String::from("        \"ground\": (color: \"#d9dde3\", ambient: 0.4, diffuse: 0.68),\n");
        let plain = self.parts.iter().filter(|part| !part.has_colors).count();
        for (index, color) in COLORS.iter().take(plain).enumerate() {
            let name = material(index);
            // Writing to a text does not fail.
            let _ = writeln!(
                text,
                "        {name:?}: (color: {color:?}, ambient: 0.24, diffuse: 0.85, specular: 0.5, shininess: 50, \
                 highlight: BlinnPhong),"
            );
        }
        text
    }

    fn objects(&self) -> String {
        let mut text = String::from("        \"ground\": (shape: Plane(), material: \"ground\"),\n");
        let _ = writeln!(
            text,
            "        \"turntable\": (shape: Group, rotation: AxisAngle(axis: (0, 1, 0), angle: [(0, 0), ({}, 360)])),",
            self.frames
        );
        // A mesh alone says itself that it stands in the middle.
        let is_centered = matches!(self.parts, [part] if !part.is_scene);
        if !is_centered {
            let bounds = self.bounds();
            let base = bounds.center() * DVec3::new(1.0, 0.0, 1.0) + bounds.min * DVec3::Y;
            let by = vector(DVec3::ZERO - base);
            let _ = writeln!(
                text,
                "        // To the middle of the turntable.\n        \"parts\": (shape: Group, translation: {by}, \
                 parent: \"turntable\"),"
            );
        }
        let mut names: HashSet<String> = ["ground", "turntable", "parts"].map(str::to_owned).into();
        let mut plain = 0;
        for part in self.parts {
            let parent = if is_centered { "turntable" } else { "parts" };
            let name = unused(&part.name, &mut names);
            if part.is_scene {
                let more = format!(", parent: {parent:?}");
                let _ = writeln!(text, "        {name:?}: {},", scene_object(&part.file, part.up, &more));
                continue;
            }
            let up = if part.up == UpAxis::Z { ", up: Z" } else { "" };
            let center = if is_centered { ", center: Base" } else { "" };
            let normals = if part.has_normals { "" } else { ", normals: Crease(angle: 40)" };
            let mut material_of = String::new();
            if !part.has_colors {
                material_of = format!(", material: {:?}", material(plain % COLORS.len()));
                plain += 1;
            }
            let file = quoted_value(&part.file);
            let _ = writeln!(
                text,
                "        {name:?}: (shape: Mesh(file: {file}{up}{center}{normals}), parent: {parent:?}{material_of}),"
            );
        }
        text
    }
}

fn material(index: usize) -> String {
    if index == 0 { "part".to_owned() } else { format!("part {}", index + 1) }
}

/// A name that no object has yet.
fn unused(name: &str, names: &mut HashSet<String>) -> String {
    let name = if name.trim().is_empty() { "part" } else { name };
    let candidates = (2..).map(|number| format!("{name} {number}"));
    let free = std::iter::once(name.to_owned()).chain(candidates).find(|name| names.insert(name.clone()));
    free.unwrap_or_default()
}

/// A point that reads back as the same numbers.
fn vector(DVec3 { x, y, z }: DVec3) -> String {
    format!("({x:?}, {y:?}, {z:?})")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::files::Root;
    use crate::geometry::mesh::generate;
    use crate::import::ply;
    use crate::sequence::load_text;
    use std::fs::File;
    use std::path::Path;

    fn part(name: &str, file: &str, at: DVec3) -> Part {
        let bounds = Aabb { min: at, max: at + DVec3::new(1.0, 2.0, 3.0) };
        Part {
            name: name.into(),
            file: file.into(),
            is_scene: false,
            up: UpAxis::Z,
            bounds,
            has_colors: false,
            has_normals: false,
        }
    }

    /// Every text loads, whatever the names are and wherever the parts stand.
    #[test]
    fn texts_load() {
        let folder = tempfile::tempdir().expect("a folder");
        for odd in ["a \"part\" {1}.ply", "=1+1.ply"] {
            let file = File::create(folder.path().join(odd)).expect("a file");
            ply::write(file, &generate::icosphere(1)).expect("a disk");
            texts_of_file_load(folder.path(), odd);
        }
    }

    fn texts_of_file_load(folder: &Path, odd: &str) {
        let far = DVec3::new(1e5, -1e-7, 1e12);
        for count in 1..9 {
            let names = ["ground", "ground", "", "x", "=x", "\\", "turntable", "é"];
            let parts: Vec<_> = names[..count].iter().map(|name| part(name, odd, far)).collect();
            let files = ["out/a.gif".to_owned(), "=f_####.png".to_owned()];
            let rate = Rate::new(30000, 1001).expect("a rate");
            let (size, bounces, antialias) = ((64, 48), 3, 2);
            let scene = Scene { parts: &parts, files: &files, frames: 7, rate, size, bounces, antialias };
            let path = folder.join("turn.ron");
            let sequence = load_text(&path, &scene.text(), Root::anywhere(), &Default::default());
            let sequence = sequence.unwrap_or_else(|error| panic!("{error}\n{}", scene.text()));
            assert_eq!((sequence.timeline.frames, sequence.timeline.rate), (7, rate));
            assert_eq!((sequence.quality.bounces, sequence.quality.antialias), (3, 2));
            let groups = if count == 1 { 2 } else { 3 };
            assert_eq!(sequence.objects.len(), count + groups);
            assert!(sequence.fitted_camera(0).frame.is_some_and(|frame| frame.fit.is_some()));
        }
        assert!(Path::new(odd).extension().is_some());
    }
}

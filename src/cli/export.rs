//! `kinora export`: writes a sequence as a glTF file.

use super::failure::Failure;
use super::loading::LoadingReporter;
use super::progress::ProgressMode;
use super::{load, terminal};
use crate::base::escape;
use crate::base::units::{bytes, counted};
use crate::encode::write_file;
use crate::export::{Container, Exported, Options, exported};
use crate::sequence::LightUnit;
use clap::{Args, ValueEnum};
use std::path::{Path, PathBuf};

/// Write a sequence as a glTF file, for viewers and other programs.
#[derive(Args, Debug, PartialEq)]
#[command(after_help = "\
Example:
  kinora export sequences/cradle.ron -o cradle.glb

Objects become nodes with the same parents, shapes meshes, and keys animations: steps, linear keys
and cubic curves as they are, all others and cameras at every frame. Kinora prints what glTF does
not have. `Scene(\"cradle.glb\")` shows the file in another sequence.")]
pub struct Arguments {
    /// The sequence file (.ron or .json)
    file: PathBuf,

    /// The file to write: .glb, or .gltf as text. It is replaced if it exists
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,

    /// Largest distance between round shapes and their meshes, as a fraction of their radius
    #[arg(long, value_name = "FRACTION", default_value_t = 0.001, value_parser = tolerance)]
    tolerance: f64,

    /// Unit of lights: candela and lux, or watts as programs without units write them
    #[arg(long, value_name = "UNIT", default_value = "photometric")]
    light_unit: Unit,

    /// Allow images and meshes outside of the sequence's root folder, as in `render`
    #[arg(long)]
    allow_outside: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Unit {
    Photometric,
    Radiometric,
}

/// The least and the largest tolerance.
const TOLERANCES: [f64; 2] = [1e-6, 0.5];

fn tolerance(text: &str) -> Result<f64, String> {
    let [least, most] = TOLERANCES;
    let wrong = || format!("not a fraction from {least} to {most}");
    text.parse().ok().filter(|value| (least..=most).contains(value)).ok_or_else(wrong)
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { file, output, tolerance, light_unit, allow_outside } = arguments;
    let container = container(output)?;
    let loading = LoadingReporter::new(ProgressMode::Auto, false);
    let sequence = load::sequence(file, *allow_outside, loading)?;
    let light_unit = match light_unit {
        Unit::Photometric => LightUnit::Photometric,
        Unit::Radiometric => LightUnit::Radiometric,
    };
    let options = Options { container, tolerance: *tolerance, light_unit };
    let exported = exported(&sequence, options).map_err(|error| Failure::Bad(error.to_string()))?;
    write_file(output, &exported.bytes).map_err(|error| Failure::Incomplete(error.to_string()))?;
    terminal::print_line(&line(output, &exported))?;
    match exported.left_out.is_empty() {
        true => Ok(()),
        false => terminal::print_line(&format!("left out: {}", exported.left_out.join(", "))),
    }
}

/// The form that the extension asks for.
fn container(path: &Path) -> Result<Container, Failure> {
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
    match extension.as_deref() {
        Some("glb") => Ok(Container::Binary),
        Some("gltf") => Ok(Container::Text),
        _ => Err(Failure::Bad(format!("--output: {} ends in neither .glb nor .gltf", escape::path(path)))),
    }
}

/// What was written, in one line.
fn line(path: &Path, exported: &Exported) -> String {
    let Exported { nodes, meshes, triangles, materials, cameras, lights, channels, .. } = exported;
    let number = |count: &usize, noun| counted(*count as u64, noun);
    let facts = [
        number(nodes, "node"),
        format!(
            "{} in {meshes} shared {}",
            number(triangles, "triangle"),
            plural(*meshes, ["mesh", "meshes"])
        ),
        number(materials, "material"),
        number(cameras, "camera"),
        number(lights, "light"),
        format!("{channels} keyed {}", plural(*channels, ["property", "properties"])),
        bytes(exported.bytes.len() as u64),
    ];
    format!("{}: {}", escape::path(path), facts.join(" · "))
}

fn plural(count: usize, [one, several]: [&str; 2]) -> &str {
    if count == 1 { one } else { several }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_extension_selects_the_form() {
        let form = |name: &str| container(Path::new(name)).ok();
        assert_eq!(form("a.glb"), Some(Container::Binary));
        assert_eq!(form("a.GLTF"), Some(Container::Text));
        assert_eq!([form("a.obj"), form("glb")], [None; 2]);
    }

    #[test]
    fn tolerances_are_fractions() {
        assert_eq!(tolerance("0.01"), Ok(0.01));
        for wrong in ["0", "-1", "nan", "2", "fine"] {
            assert!(tolerance(wrong).is_err(), "{wrong}");
        }
    }
}

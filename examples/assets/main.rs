//! Makes the pictures, the data, the tables and the meshes in `assets/` that sequences use:
//!
//! ```text
//! cargo run --release --example assets
//! ```
//!
//! Everything is computed from formulas and fixed seeds, so that the files are the same on every machine. The
//! pictures, data and tables are part of the repository; the meshes, 13 and 22 MB, are not.

mod equations;
mod forest;
mod fountain;
mod hills;
mod moon;
mod paint;
mod pendulum;
mod planet;
mod pressure;
mod shell;
mod sky;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use kinora::import::ply;
use rayon::prelude::*;
use std::error::Error;
use std::fs::{self, File};
use std::io::BufWriter;
use std::path::{Path, PathBuf};

/// A picture by rule: the sRGB codes of each pixel, counted from the top left.
struct Picture {
    name: String,
    size: (u32, u32),
    pixel: Box<dyn Fn(u32, u32) -> [u8; 3] + Sync>,
}

/// A table's file, and the function that writes its text.
type TableByRule = (&'static str, fn() -> String);

/// Tables by rule.
const TABLES: [TableByRule; 3] = [
    ("tables/pendulum.csv", pendulum::table),
    ("tables/fountain.csv", fountain::table),
    ("tables/forest.csv", forest::table),
];

fn main() -> Result<(), Box<dyn Error>> {
    for picture in pictures() {
        write(&picture, &path(&picture.name)?)?;
    }
    fs::write(path("data/pressure.vtk")?, pressure::file())?;
    for step in 0..pressure::STEPS {
        fs::write(path(&format!("data/waves/step-{step:02}.vtk"))?, pressure::step(step))?;
    }
    fs::write(path("data/waves/waves.pvd")?, pressure::list())?;
    for (name, table) in TABLES {
        fs::write(path(name)?, table())?;
    }
    for (name, parts) in [("meshes/shell.ply", shell::parts()), ("meshes/hills.ply", hills::parts())] {
        ply::write(BufWriter::new(File::create(path(name)?)?), &parts)?;
    }
    Ok(())
}

fn pictures() -> Vec<Picture> {
    let mut pictures = vec![planet::picture(), moon::picture()];
    pictures.extend(sky::pictures());
    pictures
}

/// Where a file of this name belongs; its folder is made.
fn path(name: &str) -> Result<PathBuf, std::io::Error> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets").join(name);
    path.parent().map_or(Ok(()), fs::create_dir_all)?;
    Ok(path)
}

fn write(picture: &Picture, path: &Path) -> Result<(), Box<dyn Error>> {
    let (width, height) = picture.size;
    let row = |y| (0..width).flat_map(|x| (picture.pixel)(x, y)).collect::<Vec<u8>>();
    let codes = (0..height).into_par_iter().map(row).collect::<Vec<_>>().concat();
    let out = BufWriter::new(File::create(path)?);
    let encoder = PngEncoder::new_with_quality(out, CompressionType::Best, FilterType::Adaptive);
    encoder.write_image(&codes, width, height, ExtendedColorType::Rgb8)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_data_is_up_to_date() {
        let path = path("data/pressure.vtk").expect("the folder is there");
        assert!(fs::read(path).expect("the file") == pressure::file());
        let file = |name: &str| fs::read(super::path(name).expect("the folder is there")).expect("the file");
        for step in 0..pressure::STEPS {
            assert!(file(&format!("data/waves/step-{step:02}.vtk")) == pressure::step(step));
        }
        for (name, table) in &TABLES[1..] {
            assert!(file(name) == table().into_bytes(), "{name}");
        }
        assert_eq!(file("data/waves/waves.pvd"), pressure::list().into_bytes());
    }

    /// The pictures in the repository are those that the command makes: every 13th pixel of every 29th row.
    #[test]
    fn the_pictures_are_up_to_date() {
        for picture in pictures() {
            let path = path(&picture.name).expect("the folder is there");
            let file = image::open(&path).unwrap_or_else(|error| panic!("{path:?}: {error}")).into_rgb8();
            assert_eq!(file.dimensions(), picture.size, "{}", picture.name);
            for y in (0..picture.size.1).step_by(29) {
                for x in (0..picture.size.0).step_by(13) {
                    let expected = (picture.pixel)(x, y);
                    assert_eq!(file.get_pixel(x, y).0, expected, "{} at {x}, {y}", picture.name);
                }
            }
        }
    }
}

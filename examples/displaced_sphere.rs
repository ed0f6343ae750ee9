//! Writes a hilly sphere of 20·4^SUBDIVISIONS triangles, as large as a scene can bear:
//!
//! ```text
//! cargo run --release --example displaced_sphere -- 7 1 sphere.ply     327,680 triangles
//! ```
//!
//! The extension says the format, `.ply` or `.obj`; another seed gives other hills.

use kinora::geometry::mesh::generate::displaced_sphere;
use kinora::import::{obj, ply};
use std::error::Error;
use std::fs::File;
use std::io::BufWriter;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<_> = std::env::args().skip(1).collect();
    let [subdivisions, seed, name] = &arguments[..] else {
        return Err("usage: displaced_sphere SUBDIVISIONS SEED FILE".into());
    };
    let parts = displaced_sphere(subdivisions.parse()?, seed.parse()?);
    let out = BufWriter::new(File::create(name)?);
    if name.ends_with(".obj") {
        obj::write(out, &parts)?
    } else {
        ply::write(out, &parts)?
    }
    Ok(())
}

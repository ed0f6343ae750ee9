//! Lists what a release of Kinora consists of:
//!
//! ```text
//! cargo metadata --locked --format-version 1 --filter-platform TARGET > metadata.json
//! kinora-inventory metadata.json Cargo.lock LICENCES.txt sbom.cdx.json
//! ```
//!
//! In: the metadata and the checksums of cargo. Out: the licence texts of all crates in the program, and a bill of
//! materials in CycloneDX's JSON. Both are the same for the same input: they hold no times and no paths.

mod bill;
mod crates;
mod licences;

use std::error::Error;
use std::fs;

pub type Outcome<T> = Result<T, Box<dyn Error>>;

fn main() -> Outcome<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [metadata, lock, licences, bill] = &arguments[..] else {
        return Err("usage: kinora-inventory METADATA LOCKFILE LICENCES BILL".into());
    };
    let read =
        |path: &String| fs::read_to_string(path).map_err(|error| format!("cannot read {path}: {error}"));
    let crates = crates::of(&serde_json::from_str(&read(metadata)?)?, &read(lock)?)?;
    fs::write(licences, licences::page(&crates)?)?;
    fs::write(bill, format!("{:#}\n", bill::document(&crates)))?;
    Ok(())
}

//! Inputs that fuzzing found to lead to places of their own: `fuzz/seeds/TARGET/` holds some for each target.

use std::fs;
use std::path::Path;

#[path = "../../fuzz/inputs.rs"]
mod targets;

/// Does what a target does with all inputs that were kept for it.
fn every_input_of(target: &str, does: fn(&[u8])) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/seeds").join(target);
    let entries = fs::read_dir(folder).expect(target).flatten();
    let inputs: Vec<_> = entries.map(|entry| fs::read(entry.path()).expect("an input")).collect();
    assert!(!inputs.is_empty());
    // Also what is cut off.
    inputs.iter().for_each(|input| {
        does(input);
        does(&input[..input.len() / 2]);
    });
}

macro_rules! targets {
    ($($target:ident),* $(,)?) => {
        $(#[test]
        fn $target() {
            every_input_of(stringify!($target), targets::$target);
        })*
    };
}

targets!(sequence, frame, frame_set, obj, ply, stl, vtk, gltf, pvd, table, picture, kept, gif);

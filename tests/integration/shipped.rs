//! The sequences and assets of the repository: those that its READMEs list.

use crate::support::shoot;
use kinora::sequence::load;
use std::fs;
use std::path::Path;

/// The names in the first column of a folder's README, between `open` and `close`.
fn listed(folder: &str, open: &str, close: &str) -> Vec<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder).join("README.md");
    let readme = fs::read_to_string(path).expect("a README");
    let name = |line: &str| Some(line.strip_prefix(open)?.split_once(close)?.0.to_owned());
    readme.lines().filter_map(name).filter(|name| name.contains('.')).collect()
}

/// Every sequence has its row in the README of its folder. `tests/corpus` loads and renders each.
#[test]
fn shipped_sequences_are_listed() {
    for folder in ["sequences", "sequences/bench"] {
        let mut listed = listed(folder, "| [", "]");
        let entries = fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)).expect(folder);
        let names = entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned());
        let mut there: Vec<_> = names.filter(|name| name.ends_with(".ron")).collect();
        listed.sort();
        there.sort();
        assert_eq!(listed, there, "{folder}/README.md");
    }
}

#[test]
fn listed_assets_are_there() {
    let assets = listed("assets", "| `", "`");
    assert!(assets.len() >= 8, "{assets:?}");
    for name in assets.iter().filter(|name| !name.ends_with(".ply")) {
        assert!(Path::new(env!("CARGO_MANIFEST_DIR")).join("assets").join(name).is_file(), "{name}");
    }
}

/// Whoever looks for an example of a feature finds one.
#[test]
fn shipped_sequences_show_all_features() {
    let texts = listed("sequences", "| [", "]").into_iter().map(|name| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("sequences").join(name);
        fs::read_to_string(path).expect("a sequence")
    });
    let all: String = texts.collect();
    for feature in [
        "Orbit(",
        "Zoom(",
        "Dolly(",
        "Spline(",
        "aperture:",
        "shutter:",
        "integrator: Whitted",
        "integrator: Path",
        "fog:",
        "active_camera:",
        "Perspective(",
        "Orthographic(",
        "CubeMap(",
        "Mesh(",
        "Image(",
        "Checker(",
        "Poses(",
        "frame: ",
        "include: ",
        "let: ",
        "Repeat(",
        "template: ",
    ] {
        assert!(all.contains(feature), "no sequence shows `{feature}`");
    }
}

/// A flight, an open shutter and Whitted's integrator, each at a few of its frames.
#[test]
fn flights_and_open_shutters_render() {
    for (name, frames, moments) in
        [("flight", [0, 40, 89], [1; 3]), ("cradle", [0, 7, 27], [32; 3]), ("whitted", [0, 20, 47], [1; 3])]
    {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("sequences/{name}.ron"));
        let mut sequence = load(&path).unwrap_or_else(|error| panic!("{error}"));
        (sequence.output.size, sequence.quality.antialias) = ((48, 32), 1);
        for (frame, moments) in frames.into_iter().zip(moments) {
            let shot = shoot(&sequence, [frame]).remove(0);
            assert_eq!(
                shot.work.bvh_builds + shot.work.bvh_refits,
                moments,
                "{name}, frame {frame}: what moves"
            );
            let mean =
                shot.film.radiance().map(|radiance| f64::from(radiance.y)).sum::<f64>() / (48.0 * 32.0);
            assert!((0.1..0.8).contains(&mean), "{name}, frame {frame}: {mean}");
        }
    }
}

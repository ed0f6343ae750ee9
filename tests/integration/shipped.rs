//! The sequences and assets of the repository: those that its READMEs list.

use crate::support::shoot;
use kinora::sequence::load;
use std::fs;
use std::path::Path;

/// Meshes made by `cargo run --release --example assets`, and too large for the repository.
const MADE: [&str; 2] = [
    "cannot read the mesh \"../assets/meshes/shell.ply\"",
    "cannot read the mesh \"../../assets/meshes/hills.ply\"",
];

/// The names in the first column of a folder's README, between `open` and `close`.
fn listed(folder: &str, open: &str, close: &str) -> Vec<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder).join("README.md");
    let readme = fs::read_to_string(path).expect("a README");
    let name = |line: &str| Some(line.strip_prefix(open)?.split_once(close)?.0.to_owned());
    readme.lines().filter_map(name).filter(|name| name.contains('.')).collect()
}

#[test]
fn shipped_sequences_have_no_mistakes() {
    for (folder, least) in [("sequences", 15), ("sequences/bench", 4)] {
        let sequences = listed(folder, "| [", "]");
        assert!(sequences.len() >= least, "{sequences:?}");
        for name in sequences {
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder).join(name);
            let Err(error) = load(&path) else { continue };
            let error = error.to_string();
            let made = MADE.iter().any(|message| error.contains(message));
            let missing = made && error.contains("there is no such file");
            assert!(missing && error.matches("error:").count() == 1, "{path:?}: {error}");
            // The text that is shown says how to make it.
            assert!(error.contains("cargo run --release --example assets"), "{error}");
        }
    }
}

/// What is compared with other renderers is what those were told, too: a small first frame of each scene that needs
/// no mesh casts the rays that its settings ask for, and shows something.
#[test]
fn bench_sequences_render() {
    for (name, samples) in [("glazed", 1), ("weekend", 16)] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("sequences/bench/{name}.ron"));
        let mut sequence = load(&path).unwrap_or_else(|error| panic!("{error}"));
        sequence.output.size = (48, 32);
        let [shot] = &shoot(&sequence, [0])[..] else { panic!("one frame") };
        assert_eq!(shot.work.camera, 48 * 32 * samples, "{name}");
        let mean = shot.film.radiance().map(|radiance| f64::from(radiance.y)).sum::<f64>() / (48.0 * 32.0);
        assert!((0.2..0.6).contains(&mean), "{name}: {mean}");
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
fn shipped_sequences_show_what_there_is() {
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
            assert_eq!(shot.work.bvh_builds, moments, "{name}, frame {frame}: what moves");
            let mean =
                shot.film.radiance().map(|radiance| f64::from(radiance.y)).sum::<f64>() / (48.0 * 32.0);
            assert!((0.1..0.8).contains(&mean), "{name}, frame {frame}: {mean}");
        }
    }
}

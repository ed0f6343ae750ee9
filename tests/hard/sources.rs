//! What the sources must not hold: a second place where rays start on surfaces, and tolerances.

use std::fs;
use std::path::{Path, PathBuf};

/// The sources of the library, without comments and tests, each as its path from `src` and its lines.
fn sources() -> Vec<(String, Vec<String>)> {
    fn files(folder: &Path, into: &mut Vec<PathBuf>) {
        for entry in fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                files(&path, into);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                into.push(path);
            }
        }
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut paths = Vec::new();
    files(&root, &mut paths);
    paths.sort();
    let name =
        |path: &Path| path.strip_prefix(&root).expect("below src").to_string_lossy().replace('\\', "/");
    let of_tests = |path: &str| path.contains("tests") || path == "testing.rs";
    paths
        .iter()
        .map(|path| (name(path), code(&fs::read_to_string(path).expect("a text"))))
        .filter(|(path, _)| !of_tests(path))
        .collect()
}

/// The lines of a source up to its tests, without comments.
fn code(text: &str) -> Vec<String> {
    let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    text.lines().map(|line| line.split("//").next().unwrap_or_default().to_owned()).collect()
}

/// The rooms in which geometry is decided.
const KERNEL: [&str; 4] = ["base/math/", "geometry/", "scene/", "trace/"];

fn kernel() -> Vec<(String, Vec<String>)> {
    let kernel: Vec<_> =
        sources().into_iter().filter(|(path, _)| KERNEL.iter().any(|room| path.starts_with(room))).collect();
    // A test that finds no source finds no fault either.
    for room in KERNEL {
        assert!(kernel.iter().any(|(path, _)| path.starts_with(room)), "{room} is no more");
    }
    assert!(kernel.iter().map(|(_, lines)| lines.len()).sum::<usize>() > 3000);
    kernel
}

/// Whether a line has a name that is not the end of a longer one.
fn has_name(line: &str, name: &str) -> bool {
    let is_of_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
    line.match_indices(name).any(|(at, _)| !line[..at].ends_with(is_of_name))
}

/// Places that may use a name, besides the one that defines it.
#[track_caller]
fn only_in(name: &str, allowed: &[&str]) {
    let mut found = Vec::new();
    for (path, lines) in kernel() {
        for (number, line) in (1..).zip(&lines) {
            if has_name(line, name) {
                found.push((path.clone(), number));
            }
        }
    }
    let strangers: Vec<_> = found.iter().filter(|(path, _)| !allowed.contains(&path.as_str())).collect();
    assert!(strangers.is_empty(), "`{name}` is used in {strangers:?}");
    for allowed in allowed {
        assert!(found.iter().any(|(path, _)| path == allowed), "`{name}` is no more in {allowed}");
    }
}

#[test]
fn rays_start_on_surfaces_in_one_place() {
    // What moves an origin off a surface: its error bound and the next number away.
    only_in(
        "next_away(",
        &[
            "geometry/shape/cuboid.rs",
            "geometry/shape/lane_ray.rs", // a t, not an origin
            "trace/spawn.rs",
        ],
    );
    // Rays are made of an origin and a direction where they start, or are moved into another space: no others.
    only_in(
        "Ray {",
        &[
            "base/math/ray.rs",                       // the type
            "geometry/shape/solid/part_intervals.rs", // from the same origin in another direction
            "geometry/shape/stored_rays.rs",          // one of eight
            "scene/instance_transform.rs",            // moved into a shape's space
            "trace/coincident.rs",                    // across a surface
            "trace/intersect.rs",                     // one of eight
            "trace/marks.rs",                         // one of eight
            "trace/spawn.rs",
            "trace/transmittance.rs", // one of eight
        ],
    );
    only_in(
        "LaneRay {",
        &[
            "geometry/shape/cuboid.rs",      // taken apart
            "geometry/shape/frame.rs",       // moved into a shape's axes
            "geometry/shape/sphere.rs",      // taken apart
            "geometry/shape/stored_rays.rs", // of rows
            "geometry/shape/taper.rs",       // begun closer to the shape
            "scene/instance_transform.rs",   // moved into a shape's space
            "trace/light/mod.rs",            // to a light, from where it is spawned
            "trace/path.rs",                 // what is spawned
            "trace/segment.rs",              // the rest of a segment through fog
            "trace/shade.rs",                // a segment through fog
            "trace/shadow_stream.rs",        // of columns
            "trace/stream.rs",               // of columns
            "trace/whitted.rs",              // what is spawned
        ],
    );
}

/// Numbers in scientific notation with a negative exponent: what tolerances look like. Those of the kernel that are
/// none are listed with what they are.
#[test]
fn the_kernel_has_no_tolerances() {
    const KNOWN: [(&str, &str); 8] = [
        ("geometry/bvh/tree_space.rs", "reach.clamp(1e-300, 1e300)"), // what has a reciprocal
        ("geometry/bvh/build/bins.rs", "const CLOSEST: f32 = 1e-30;"), // which split, not what is hit
        ("geometry/bvh/build/bounds.rs", "const LENGTH: f32 = 1e-12;"), // likewise
        ("base/math/rotation.rs", "const ROUNDED: f64 = 0.5e-4;"),    // of matrices in files
        ("base/math/rotation.rs", "const PERPENDICULAR: f64 = 1.74e-4;"), // likewise
        ("base/math/rotation.rs", "(1e-30..=1e30)"), // likewise: lengths whose squares are numbers
        ("base/math/elementary.rs", "const FRAC_PI_4_REST: f64 ="), // digits of a constant
        ("base/math/elementary.rs", "const LN_2_REST: f64 ="), // likewise
    ];
    const NAMED: [&str; 5] = ["eps", "tolerance", "fudge", "bias", "slop"];
    let small = |line: &str| {
        let bytes = line.as_bytes();
        line.match_indices("e-").any(|(at, _)| {
            let digit = |i: usize| bytes.get(i).is_some_and(u8::is_ascii_digit);
            at > 0 && digit(at - 1) && digit(at + 2)
        })
    };
    assert!(small("x > 1e-9") && small("const EPS: f64 = 0.5e-3;") && !small("one-sided"));
    let mut found = Vec::new();
    let mut met = [false; KNOWN.len()];
    for (path, lines) in kernel() {
        for (number, line) in (1..).zip(&lines) {
            let known = KNOWN.iter().position(|(known, text)| path == *known && line.contains(text));
            if let Some(known) = known {
                met[known] = true;
            } else if small(line) || decimal_fraction_below(line, 0.01) {
                found.push(format!("{path}:{number}: {}", line.trim()));
            }
            let lower = line.to_lowercase();
            let mut words = lower.split(|c: char| !c.is_ascii_alphanumeric());
            if lower.contains("t_min") || words.any(|word| NAMED.contains(&word)) {
                found.push(format!("{path}:{number}: {}", line.trim()));
            }
        }
    }
    assert!(found.is_empty(), "tolerances?\n{}", found.join("\n"));
    assert_eq!(met, [true; KNOWN.len()], "what is known to be none is no more there");
}

/// Whether a line holds a number like 0.001, below a limit but not 0.
fn decimal_fraction_below(line: &str, limit: f64) -> bool {
    line.match_indices("0.0").any(|(at, _)| {
        let whole = at > 0 && line.as_bytes()[at - 1].is_ascii_digit();
        let text: String =
            line[at..].chars().take_while(|c| c.is_ascii_digit() || *c == '.' || *c == '_').collect();
        let value: f64 = text.trim_end_matches('.').replace('_', "").parse().unwrap_or(1.0);
        !whole && value > 0.0 && value < limit
    })
}

/// Multiples of a number's last place stand for rounding, where a bound says how many there are: in the filters of the
/// trees, and where shapes without an area are reported.
#[test]
fn multiples_of_the_last_place_are_bounds_of_rounding() {
    only_in(
        "EPSILON",
        &[
            "base/math/error.rs",
            "geometry/mesh/build.rs",
            "geometry/mesh/packet.rs",
            "geometry/shape/flat.rs",
            "geometry/shape/mesh/surface.rs",
            "geometry/shape/sphere.rs",
            "geometry/bvh/build/pieces.rs",
            "geometry/bvh/slabs.rs",
            "geometry/bvh/tree_space.rs",
        ],
    );
}

#[test]
fn fractions_are_found() {
    assert!(decimal_fraction_below("if t < 0.001 {", 0.01) && decimal_fraction_below("0.000_1", 0.01));
    assert!(!decimal_fraction_below("0.0 1.0 10.001 0.5 0.05", 0.01));
    assert_eq!(code("a // 1e-9\nb\n#[cfg(test)]\nmod tests {\n1e-9"), ["a ", "b", ""][..2]);
}

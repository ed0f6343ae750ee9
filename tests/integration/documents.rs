//! The documents name only files that exist.

use std::fs;
use std::path::{Path, PathBuf};

const DOCUMENTS: [&str; 6] = [
    "README.md",
    "ARCHITECTURE.md",
    "CONTRIBUTING.md",
    "SECURITY.md",
    "sequences/README.md",
    "python/README.md",
];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// All documents, relative to the root of the repository.
fn documents() -> Vec<PathBuf> {
    let pages = fs::read_dir(root().join("docs")).expect("the folder docs");
    let pages = pages.map(|page| Path::new("docs").join(page.expect("an entry").file_name()));
    let pages = pages.filter(|page| page.extension().is_some_and(|extension| extension == "md"));
    DOCUMENTS.map(PathBuf::from).into_iter().chain(pages).collect()
}

/// The names of all files and folders directly in a folder.
fn entries(folder: &str) -> Vec<String> {
    let entries = fs::read_dir(root().join(folder)).expect("a folder");
    entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect()
}

/// The texts between `start` and `end` in a line.
fn enclosed<'t>(line: &'t str, start: &'t str, end: &'t str) -> impl Iterator<Item = &'t str> {
    line.split(start).skip(1).filter_map(move |rest| Some(rest.split_once(end)?.0))
}

/// The texts in backticks. A line that breaks inside backticks has no path there.
fn quoted(line: &str) -> impl Iterator<Item = &str> {
    line.split('`').skip(1).step_by(2)
}

/// Whether a text looks like a source file or like a path that starts in the root of the repository or in `src/`.
fn looks_like_path(text: &str, top: &[String]) -> bool {
    let plain = text.chars().all(|c| c.is_ascii_alphanumeric() || "_-./".contains(c));
    let (first, rest) = text.split_once('/').map_or((text, None), |(first, rest)| (first, Some(rest)));
    // Runs and builds make these folders.
    let made = ["output", "target"].contains(&first);
    let source = text.len() > 3 && Path::new(text).extension().is_some_and(|extension| extension == "rs");
    plain && !made && (source || rest.is_some() && top.iter().any(|name| name == first))
}

/// Whether a path exists: from the root, from `src/`, or from a folder that the same item of the document names.
fn exists(path: &str, folders: &[PathBuf]) -> bool {
    let places = [root().to_path_buf(), root().join("src")];
    places.iter().chain(folders).any(|place| place.join(path).exists())
}

/// The folders that an item names, also as the folders of files.
fn folders(paths: &[&str]) -> Vec<PathBuf> {
    let places = ["", "src"].map(|place| root().join(place));
    let named = paths.iter().flat_map(|path| places.iter().map(move |place| place.join(path)));
    let with_parents = named.filter(|path| path.exists()).flat_map(|path| {
        let parent = path.parent().map(Path::to_path_buf);
        [Some(path), parent].into_iter().flatten()
    });
    with_parents.filter(|folder| folder.is_dir() && folder != root()).collect()
}

/// The paragraphs, list items and table rows of a document, each with the number of its first line. Code is left out.
/// The heading of a table belongs to each of its rows.
fn items(text: &str) -> Vec<(usize, String)> {
    let (mut items, mut heading, mut code, mut apart) = (Vec::<(usize, String)>::new(), "", false, true);
    for (number, line) in (1..).zip(text.lines()) {
        let fence = line.trim_start().starts_with("```");
        code ^= fence;
        if code || fence || line.trim().is_empty() {
            (heading, apart) = ("", true);
            continue;
        }
        let numbered = line.split_once(". ").is_some_and(|(digits, _)| digits.parse::<u8>().is_ok());
        let (row, listed) = (line.starts_with('|'), line.starts_with("- ") || numbered);
        match items.last_mut() {
            Some((_, item)) if !apart && !row && !listed => *item = format!("{item} {}", line.trim_start()),
            _ => items.push((number, format!("{heading} {line}"))),
        }
        if row && apart {
            heading = line;
        }
        apart = false;
    }
    items
}

/// The paths that a document names and that do not exist.
fn missing(document: &Path, top: &[String]) -> Vec<String> {
    let text = fs::read_to_string(root().join(document)).expect("a document");
    let beside = root().join(document.parent().expect("a folder"));
    let mut missing = Vec::new();
    for (line, item) in items(&text) {
        let paths: Vec<&str> = quoted(&item).filter(|text| looks_like_path(text, top)).collect();
        let folders = folders(&paths);
        let unknown = paths.into_iter().filter(|path| !exists(path, &folders));
        let targets = enclosed(&item, "](", ")").map(|target| target.split('#').next().unwrap_or_default());
        let dead = targets.filter(|target| !target.contains("://") && !beside.join(target).exists());
        missing
            .extend(unknown.chain(dead).map(|path| format!("{}:{line}: {path}", document.to_string_lossy())));
    }
    missing
}

#[test]
fn named_files_exist() {
    let top: Vec<String> = entries("").into_iter().chain(entries("src")).collect();
    let missing: Vec<String> = documents().iter().flat_map(|document| missing(document, &top)).collect();
    assert!(missing.is_empty(), "the documents name files that do not exist:\n{}", missing.join("\n"));
}

/// The wheel has a manifest of its own, which cargo would give other profiles and lints.
#[test]
fn the_wheel_is_built_as_the_command() {
    let read = |path: &str| -> toml::Table {
        fs::read_to_string(root().join(path)).expect("a manifest").parse().expect("TOML")
    };
    let (own, wheel) = (read("Cargo.toml"), read("python/Cargo.toml"));
    assert_eq!(own["workspace"]["lints"], wheel["lints"]);
    for name in ["archive", "quick"] {
        assert_eq!(own["profile"][name], wheel["profile"][name]);
    }
    let release = |manifest: &toml::Table| {
        let mut release = manifest["profile"]["release"].as_table().expect("a profile").clone();
        let packages = release.remove("package").expect("packages");
        (release, packages.as_table().expect("a table of packages").clone())
    };
    let ((own, packages), (wheel, of_wheel)) = (release(&own), release(&wheel));
    assert_eq!(own, wheel);
    // The wheel has no packages for tests.
    let lockfile = fs::read_to_string(root().join("python/Cargo.lock")).expect("a lockfile");
    for (package, settings) in packages {
        let is_in_wheel = lockfile.contains(&format!("name = \"{package}\"\n"));
        assert_eq!(of_wheel.get(&package), is_in_wheel.then_some(&settings), "{package}");
    }
}

/// A release sets its version in several files.
#[test]
fn versions_agree() {
    let version = env!("CARGO_PKG_VERSION");
    for (file, line) in [
        ("CITATION.cff", format!("version: {version}")),
        ("derive/Cargo.toml", format!("version = \"{version}\"")),
        ("python/Cargo.toml", format!("version = \"{version}\"")),
        ("python/Cargo.toml", format!("kinora = {{ path = \"..\", version = \"{version}\" }}")),
        ("Cargo.toml", format!("kinora-derive = {{ path = \"derive\", version = \"{version}\" }}")),
    ] {
        let text = fs::read_to_string(root().join(file)).expect(file);
        assert!(text.lines().any(|known| known == line), "{file} has no line `{line}`");
    }
}

#[test]
fn paths_are_recognised() {
    let top = ["docs", "trace", "output"].map(str::to_owned);
    let paths = ["docs/farm.md", "trace/light/", "disk.rs", "gif/fit.rs"];
    assert!(paths.iter().all(|path| looks_like_path(path, &top)));
    let others = ["trace", ".rs", "output/a.png", "out/f_####.png", "a/b", "docs/*.md"];
    assert!(!others.iter().any(|text| looks_like_path(text, &top)));
    assert_eq!(quoted("`a` and [`b`](c)").collect::<Vec<_>>(), ["a", "b"]);
    assert_eq!(enclosed("see [a](b.md) and [c](d.md#e)", "](", ")").collect::<Vec<_>>(), ["b.md", "d.md#e"]);
}

#[test]
fn items_are_rows_and_paragraphs() {
    let text = "one\ntwo\n\n- a\n  b\n- c\n\n```\nd\n```\n| h |\n| i |\n\n1. x\n2. y\n";
    let items = items(text);
    let texts: Vec<&str> = items.iter().map(|(_, item)| item.trim_start()).collect();
    assert_eq!(texts, ["one two", "- a b", "- c", "| h |", "| h | | i |", "1. x", "2. y"]);
    assert_eq!(items.iter().map(|(line, _)| *line).collect::<Vec<_>>(), [1, 4, 6, 11, 12, 14, 15]);
}

//! The order of the rooms: no module uses one that stands below its own in `src/lib.rs`.

use std::fs;
use std::path::{Path, PathBuf};

/// The modules of `src/lib.rs` in their order.
fn rooms(source: &Path) -> Vec<String> {
    let text = fs::read_to_string(source.join("lib.rs")).expect("the root of the library");
    let names = text.lines().filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';'));
    names.map(str::to_string).collect()
}

/// All files below a folder, but those that hold tests alone.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if path.is_dir() {
            found.extend(files(&path));
        } else if path.extension().is_some_and(|kind| kind == "rs") && !name.ends_with("tests") {
            found.push(path);
        }
    }
    found
}

/// The rooms that a file names, with their lines. Comments and tests do not count.
fn named(text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    let mut lines = (1..).zip(text.lines()).peekable();
    while let Some((number, line)) = lines.next() {
        // A module of tests stands at the end of its file.
        if line == "#[cfg(test)]" && lines.peek().is_some_and(|(_, next)| next.ends_with('{')) {
            break;
        }
        if line.trim_start().starts_with("//") {
            continue;
        }
        for part in line.split("crate::").skip(1) {
            let end = part.find(|c: char| !c.is_ascii_lowercase() && c != '_').unwrap_or(part.len());
            found.push((number, part[..end].to_string()));
        }
    }
    found
}

#[test]
fn rooms_import_only_rooms_above_them() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let rooms = rooms(&source);
    assert!(rooms.len() > 10, "{rooms:?}");
    let mut against = Vec::new();
    for (place, room) in rooms.iter().enumerate() {
        for path in files(&source.join(room)) {
            let text = fs::read_to_string(&path).expect("a file");
            for (line, name) in named(&text) {
                let other = rooms.iter().position(|room| *room == name);
                if other.is_some_and(|other| other > place) {
                    let path = path.strip_prefix(&source).unwrap_or(&path);
                    let path = path.to_string_lossy();
                    against.push(format!("{path}:{line} uses `{name}`, which stands below `{room}`"));
                }
            }
        }
    }
    assert!(against.is_empty(), "{}", against.join("\n"));
}

#[test]
fn imports_are_found() {
    let text = "#[cfg(test)]\nmod tests;\nuse crate::scene::Scene;\n// crate::cli\nlet x: crate::film::Film;\n\
        #[cfg(test)]\nmod tests {\nuse crate::cli;\n";
    assert_eq!(named(text), [(3, "scene".to_string()), (5, "film".to_string())]);
}

//! The documented names of the library: the lint `missing_docs` looks at each of them.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

const MARK: &str = "#[warn(missing_docs)]";

/// Names of other crates, which have their own documentation.
const FOREIGN: [&str; 3] = ["DAffine3", "DQuat", "DVec3"];

fn source() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// The names that `src/lib.rs` exports, each with its room.
fn names(root: &str) -> Vec<(String, String)> {
    let mut names = Vec::new();
    for statement in root.split("\npub use ").skip(1).filter_map(|rest| rest.split(';').next()) {
        let room = statement.split("::").next().unwrap_or_default();
        let list = statement.split_once('{').map_or_else(
            || statement.rsplit("::").next().unwrap_or_default(),
            |(_, list)| list.trim_end_matches('}'),
        );
        let list = list.split(',').map(str::trim).filter(|name| !name.is_empty());
        names.extend(list.map(|name| (room.to_owned(), name.to_owned())));
    }
    names
}

/// All files below a folder, with their texts.
fn files(folder: &Path) -> Vec<(PathBuf, String)> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            found.extend(files(&path));
        } else if path.extension().is_some_and(|kind| kind == "rs") {
            let text = fs::read_to_string(&path).expect("a file");
            found.push((path, text));
        }
    }
    found
}

/// Whether a text begins with a name that ends there.
fn begins_with(text: &str, name: &str) -> bool {
    text.strip_prefix(name)
        .is_some_and(|rest| !rest.starts_with(|c: char| c.is_alphanumeric() || "_:".contains(c)))
}

/// Whether a line defines the name: as a type or, within a room's `mod.rs` or a file of it, as a function.
fn defines(line: &str, name: &str) -> bool {
    let kinds = ["pub struct ", "pub enum ", "pub fn ", "pub type "];
    kinds.iter().any(|kind| line.trim_start().strip_prefix(kind).is_some_and(|rest| begins_with(rest, name)))
}

/// Whether a line opens methods of the type.
fn opens_methods(line: &str, name: &str) -> bool {
    let Some(rest) = line.trim_start().strip_prefix("impl") else { return false };
    let own = match rest.strip_prefix('<') {
        Some(generic) => generic.split_once("> ").map_or("", |(_, own)| own),
        None => rest.trim_start(),
    };
    begins_with(own, name) && !line.contains(" for ") && line.ends_with('{')
}

/// Whether methods that begin at a line have a public one.
fn has_public(lines: &[&str]) -> bool {
    let indent = lines[0].len() - lines[0].trim_start().len();
    let end = format!("{}}}", " ".repeat(indent));
    let methods = lines.iter().take_while(|line| **line != end);
    let depth = " ".repeat(indent + 4);
    methods.into_iter().any(|line| {
        let method = line.strip_prefix(&depth).unwrap_or_default();
        method.starts_with("pub fn ") || method.starts_with("pub const ")
    })
}

#[test]
fn the_lint_sees_every_documented_name() {
    let root = fs::read_to_string(source().join("lib.rs")).expect("the root of the library");
    let names = names(&root);
    assert!(names.len() > 50, "{names:?}");
    let mut without = Vec::new();
    let mut rooms = HashMap::new();
    for (room, name) in names.iter().filter(|(_, name)| !FOREIGN.contains(&name.as_str())) {
        let mut is_defined = false;
        for (path, text) in rooms.entry(room).or_insert_with(|| files(&source().join(room))) {
            let lines: Vec<&str> = text.lines().collect();
            for (at, line) in lines.iter().enumerate() {
                let is_type = name.starts_with(char::is_uppercase);
                let marked = at > 0 && lines[at - 1].trim() == MARK;
                is_defined |= defines(line, name) && marked;
                let is_open = is_type && opens_methods(line, name) && has_public(&lines[at..]);
                if !marked && (is_open || is_type && defines(line, name) && !line.starts_with(' ')) {
                    without.push(format!("{}:{}: {name}", path.to_string_lossy(), at + 1));
                }
            }
        }
        if !is_defined {
            without.push(format!("src/{room}: no definition of {name} with {MARK}"));
        }
    }
    assert!(without.is_empty(), "these need {MARK} in front:\n{}", without.join("\n"));
}

#[test]
fn exports_and_methods_are_found() {
    let root = "\nuse a::B;\npub use film::{Film,\n    LayerId};\npub use trace::trace;\n";
    let pair = |room: &str, name: &str| (room.to_owned(), name.to_owned());
    assert_eq!(names(root), [pair("film", "Film"), pair("film", "LayerId"), pair("trace", "trace")]);
    assert!(defines("pub struct Film {", "Film") && !defines("pub struct FilmCache {", "Film"));
    for line in ["impl Film {", "impl<S: FilmSink> Film<S> {", "    impl Film {"] {
        assert!(opens_methods(line, "Film"), "{line}");
    }
    for line in ["impl Default for Film {", "impl FilmCache {", "impl<T> From<T> for Film<T> {"] {
        assert!(!opens_methods(line, "Film"), "{line}");
    }
    assert!(has_public(&["impl Film {", "    pub fn new() {}", "}"]));
    assert!(!has_public(&["impl Film {", "    fn new() {}", "}", "    pub fn other() {}"]));
}

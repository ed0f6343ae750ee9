//! The crates of the program, from cargo's metadata.

use crate::Outcome;
use serde_json::Value;
use std::collections::{BTreeSet, HashMap};
use std::path::PathBuf;

/// A crate that is compiled into the program, or runs while it is compiled.
#[derive(Debug)]
pub struct Crate {
    pub name: String,
    pub version: String,
    /// The licence as an SPDX expression. None if the crate states none.
    pub licence: Option<String>,
    /// The file with its licence, if it names one.
    pub licence_file: Option<PathBuf>,
    pub folder: PathBuf,
    /// SHA-256 of its archive. None for crates of this repository.
    pub checksum: Option<String>,
    /// Names and versions of the crates that it uses, sorted.
    pub uses: Vec<(String, String)>,
}

/// All crates, by name and version. The program itself is first.
pub fn of(metadata: &Value, lock: &str) -> Outcome<Vec<Crate>> {
    let packages: HashMap<&str, &Value> =
        list(metadata, "packages").filter_map(|package| Some((package["id"].as_str()?, package))).collect();
    let resolve = &metadata["resolve"];
    let nodes: HashMap<&str, &Value> =
        list(resolve, "nodes").filter_map(|node| Some((node["id"].as_str()?, node))).collect();
    let program = list(metadata, "packages").find(|package| package["name"] == "kinora");
    let program =
        program.and_then(|package| package["id"].as_str()).ok_or("the metadata has no package kinora")?;
    let checksums = checksums(lock);
    let (mut found, mut open) = (BTreeSet::from([program]), vec![program]);
    let mut crates = Vec::new();
    while let Some(id) = open.pop() {
        let (package, node) = (packages.get(id), nodes.get(id));
        let (package, node) = package.zip(node).ok_or_else(|| format!("the metadata has no package {id}"))?;
        let mut uses = Vec::new();
        for used in list(node, "deps").filter(|used| is_built(used)) {
            let used = used["pkg"].as_str().unwrap_or_default();
            uses.extend(packages.get(used).map(|package| name_and_version(package)));
            if found.insert(used) {
                open.push(used);
            }
        }
        uses.sort();
        let (name, version) = name_and_version(package);
        let manifest = PathBuf::from(package["manifest_path"].as_str().unwrap_or_default());
        crates.push(Crate {
            licence: package["license"].as_str().map(expression),
            licence_file: package["license_file"].as_str().map(PathBuf::from),
            folder: manifest.parent().map(PathBuf::from).unwrap_or_default(),
            checksum: checksums.get(&(name.as_str(), version.as_str())).map(|sum| (*sum).to_owned()),
            name,
            version,
            uses,
        });
    }
    crates[1..].sort_by(|a, b| (&a.name, &a.version).cmp(&(&b.name, &b.version)));
    Ok(crates)
}

fn list<'v>(value: &'v Value, name: &str) -> impl Iterator<Item = &'v Value> {
    value[name].as_array().into_iter().flatten()
}

/// Whether a dependency is more than one of tests.
fn is_built(used: &Value) -> bool {
    list(used, "dep_kinds").any(|kind| kind["kind"] != "dev")
}

fn name_and_version(package: &Value) -> (String, String) {
    let text = |name: &str| package[name].as_str().unwrap_or_default().to_owned();
    (text("name"), text("version"))
}

/// Older crates write `MIT/Apache-2.0`.
fn expression(licence: &str) -> String {
    licence.split('/').map(str::trim).collect::<Vec<_>>().join(" OR ")
}

/// The checksums of a lockfile, by name and version. Its lines have one key each.
fn checksums(lock: &str) -> HashMap<(&str, &str), &str> {
    let packages = lock.split("[[package]]").skip(1);
    let summed = packages.filter_map(|package| {
        let value = |key: &str| {
            package.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(" = \"")?.strip_suffix('"'))
        };
        Some(((value("name")?, value("version")?), value("checksum")?))
    });
    summed.collect()
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use serde_json::json;

    const LOCK: &str = "[[package]]\nname = \"a\"\nversion = \"1.0.0\"\nchecksum = \"0a\"\n\n\
                        [[package]]\nname = \"kinora\"\nversion = \"0.1.0\"\n";

    /// The program, which uses `a` and, in tests, `t`; `a` uses `b` in its build script.
    pub fn some() -> Vec<Crate> {
        let package = |name: &str, version: &str, licence: Option<&str>| {
            json!({ "id": name, "name": name, "version": version, "license": licence, "license_file": null,
                    "manifest_path": format!("/none/{name}/Cargo.toml") })
        };
        let used = |name: &str, kind: Option<&str>| json!({ "pkg": name, "dep_kinds": [{ "kind": kind }] });
        let metadata = json!({
            "packages": [
                package("b", "2.0.0", None), package("t", "1.0.0", None), package("a", "1.0.0", Some("MIT/Apache-2.0")),
                package("kinora", "0.1.0", Some("MIT OR Apache-2.0")),
            ],
            "resolve": { "nodes": [
                { "id": "kinora", "deps": [used("t", Some("dev")), used("a", None)] },
                { "id": "a", "deps": [used("b", Some("build"))] },
                { "id": "b", "deps": [] }, { "id": "t", "deps": [] },
            ] },
        });
        of(&metadata, LOCK).expect("crates")
    }

    #[test]
    fn crates_of_tests_alone_are_left_out() {
        let crates = some();
        let names: Vec<_> = crates.iter().map(|known| known.name.as_str()).collect();
        assert_eq!(names, ["kinora", "a", "b"]);
        assert_eq!(crates[0].uses, [("a".to_owned(), "1.0.0".to_owned())]);
        assert_eq!(crates[1].licence.as_deref(), Some("MIT OR Apache-2.0"));
        assert_eq!((crates[0].checksum.as_deref(), crates[1].checksum.as_deref()), (None, Some("0a")));
    }

    #[test]
    fn other_metadata_is_an_error() {
        assert!(of(&json!({ "packages": [] }), "").is_err());
        assert!(of(&json!([1]), "").is_err());
    }
}

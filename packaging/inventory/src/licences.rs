//! The licence texts of all crates, each text once.

use crate::Outcome;
use crate::crates::Crate;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

/// How names of files with licences begin, in small letters.
const NAMES: [&str; 6] = ["license", "licence", "copying", "copyright", "notice", "unlicense"];

/// Folders of a crate that may hold licences alone.
const FOLDERS: [&str; 3] = ["LICENSES", "licenses", "LICENSE"];

/// Files that are longer hold something else.
const LARGEST: u64 = 1 << 20;

const HEAD: &str = "\
This program contains the crates below. Each line gives the licence that the crate states. Behind the list stand the
texts that the crates include, each once, with the crates that include it. The program also contains Rust's standard
library, under MIT OR Apache-2.0.
";

/// The whole page.
pub fn page(crates: &[Crate]) -> Outcome<String> {
    let mut texts: BTreeMap<String, (String, Vec<String>)> = BTreeMap::new();
    let mut page = format!("{HEAD}\n");
    for known in crates {
        let name = format!("{} {}", known.name, known.version);
        let files = files(known)?;
        let note = if files.is_empty() { "; the crate includes no text" } else { "" };
        writeln!(page, "- {name}: {}{note}", known.licence.as_deref().unwrap_or("see its text"))?;
        for file in files {
            let text = String::from_utf8_lossy(&fs::read(&file)?).replace('\r', "");
            // Copies differ in blanks and line breaks.
            let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
            let (_, users) = texts.entry(words).or_insert_with(|| (text, Vec::new()));
            if !users.contains(&name) {
                users.push(name.clone());
            }
        }
    }
    let mut texts: Vec<_> = texts.into_values().collect();
    // In the order of the crates, those of the program first.
    let place =
        |user: &str| crates.iter().position(|known| user == format!("{} {}", known.name, known.version));
    texts.sort_by_key(|(_, users)| users.first().and_then(|user| place(user)));
    for (text, users) in texts {
        writeln!(page, "\n{}\n{}\n{0}\n\n{}", "=".repeat(80), users.join(", "), text.trim_matches('\n'))?;
    }
    Ok(page)
}

/// The files with licences of a crate, by name.
fn files(known: &Crate) -> Outcome<Vec<PathBuf>> {
    let folders = FOLDERS.map(|folder| known.folder.join(folder));
    let mut found: Vec<PathBuf> = known.licence_file.iter().map(|file| known.folder.join(file)).collect();
    for entry in entries(&known.folder)? {
        if is_licence(&entry) {
            found.push(entry);
        }
    }
    for folder in folders.iter().filter(|folder| folder.is_dir()) {
        found.extend(entries(folder)?);
    }
    found.retain(|path| fs::metadata(path).is_ok_and(|file| file.is_file() && file.len() <= LARGEST));
    found.sort();
    found.dedup();
    Ok(found)
}

fn entries(folder: &Path) -> Outcome<Vec<PathBuf>> {
    let listed =
        fs::read_dir(folder).map_err(|error| format!("cannot list {}: {error}", folder.to_string_lossy()));
    listed?.map(|entry| Ok(entry?.path())).collect()
}

/// Whether the name of a file is one of a licence: `LICENSE-MIT`, `COPYING.txt`, not `license.rs`.
fn is_licence(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    let is_source = [".rs", ".toml", ".json", ".html"].iter().any(|end| name.ends_with(end));
    !is_source && NAMES.iter().any(|start| name.starts_with(start))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crates;

    #[test]
    fn licences_are_found_by_name() {
        for name in ["LICENSE", "LICENSE-MIT", "license.md", "COPYING", "Licence.txt", "UNLICENSE", "NOTICE"]
        {
            assert!(is_licence(Path::new(name)), "{name}");
        }
        for name in ["license.rs", "README.md", "src", "license.json"] {
            assert!(!is_licence(Path::new(name)), "{name}");
        }
    }

    #[test]
    fn equal_texts_stand_once() {
        let root = std::env::temp_dir().join(format!("kinora-inventory-{}", std::process::id()));
        let mut crates = crates::tests::some();
        for known in &mut crates {
            known.folder = root.join(&known.name);
            fs::create_dir_all(&known.folder).expect("a folder");
        }
        fs::write(crates[0].folder.join("LICENSE"), "Do  what\r\nyou like.\n").expect("a file");
        fs::create_dir_all(crates[1].folder.join("LICENSES")).expect("a folder");
        fs::write(crates[1].folder.join("LICENSES/MIT.txt"), "Do what you like.").expect("a file");
        let page = page(&crates);
        fs::remove_dir_all(&root).expect("removed");
        let page = page.expect("a page");
        assert_eq!(page.matches("you like").count(), 1, "{page}");
        assert!(page.contains("\nkinora 0.1.0, a 1.0.0\n"), "{page}");
        assert!(page.contains("- b 2.0.0: see its text; the crate includes no text"), "{page}");
        assert!(!page.contains('\r') && !page.contains("kinora-inventory"), "{page}");
    }
}

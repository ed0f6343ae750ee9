//! Comparing paths that may be written in different ways.

use std::path::{Component, Path, PathBuf, absolute};

/// The folder of `path`. It is the working directory if the path has no folder.
pub fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Whether both paths name the same file. A link counts as a file of its own, because outputs replace links.
pub fn same_file(one: &Path, other: &Path) -> bool {
    one.file_name() == other.file_name() && same_folder(one, other)
}

/// Whether two files are in the same folder.
pub fn same_folder(one: &Path, other: &Path) -> bool {
    let (one, other) = (folder_of(one), folder_of(other));
    one == other || resolved(one) == resolved(other)
}

/// The folder's path without links, `.` and `..`. Folders that do not exist yet are assumed not to be links.
fn resolved(folder: &Path) -> PathBuf {
    let folder = absolute(folder).unwrap_or_else(|_| folder.to_owned());
    let known = folder.ancestors().find_map(|known| Some((known.canonicalize().ok()?, known)));
    let Some((mut found, known)) = known else { return folder };
    for part in folder.strip_prefix(known).unwrap_or(Path::new("")).components() {
        if part == Component::ParentDir {
            found.pop();
        } else {
            found.push(part);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_of_the_same_file_are_equal() {
        let dir = tempfile::tempdir().expect("a folder");
        let at = |path: &str| dir.path().join(path);
        std::fs::create_dir(at("a")).expect("a disk");
        let mut same = vec!["a/f", "./a/f", "a/./f", "b/../a/f", "a/../a/f", "b/c/../../a/f"];
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("a", at("link")).expect("a link");
            same.push("link/f");
        }
        for path in same {
            assert!(same_file(&at("a/f"), &at(path)), "{path}");
        }
        for path in ["f", "a/g", "a/b/f", "b/f", "b/a/f", "../a/f"] {
            assert!(!same_file(&at("a/f"), &at(path)), "{path}");
        }
        assert!(
            same_file(Path::new("f"), Path::new("./f")) && same_file(Path::new("f"), Path::new("none/../f"))
        );
    }
}

//! The meshes that `cargo run --release --example assets` makes: too large for the repository, and needed by some of
//! its sequences.

#[path = "../../examples/assets/hills.rs"]
#[allow(unused_imports, reason = "the tests of hills.rs run with the example")]
mod hills;
#[path = "../../examples/assets/shell.rs"]
#[allow(unused_imports, reason = "the tests of shell.rs run with the example")]
mod shell;

use kinora::geometry::mesh::MeshData;
use kinora::import::ply;
use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::Path;
use std::sync::LazyLock;

/// Makes the meshes that are not there yet, once for all tests of a run.
pub fn make() {
    static MADE: LazyLock<io::Result<()>> = LazyLock::new(|| {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/meshes");
        fs::create_dir_all(&folder)?;
        write(&folder.join("shell.ply"), shell::parts)?;
        write(&folder.join("hills.ply"), hills::parts)
    });
    if let Err(error) = &*MADE {
        panic!("assets/meshes: {error}");
    }
}

/// Writes a mesh beside its place first: other tests may look for it at the same time.
fn write(path: &Path, parts: fn() -> MeshData) -> io::Result<()> {
    if path.exists() {
        return Ok(());
    }
    let file = tempfile::NamedTempFile::new_in(path.parent().unwrap_or(Path::new(".")))?;
    let mut out = BufWriter::new(&file);
    ply::write(&mut out, &parts())?;
    out.flush()?;
    drop(out);
    file.persist(path).map(drop).map_err(|error| error.error)
}

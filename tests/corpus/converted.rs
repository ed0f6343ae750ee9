//! The sequences of the repository mean the same in JSON and back in RON, and their JSON satisfies the schema.

use crate::{meshes, validator};
use kinora::base::files::Root;
use kinora::sequence::{Sequence, converted_text, parse, schema};
use libtest_mimic::Failed;
use std::fs;
use std::path::Path;
use std::sync::LazyLock;

static SCHEMA: LazyLock<serde_json::Value> = LazyLock::new(|| schema(&|_| None));

/// Converts a sequence to JSON and back. All three load as the same sequence.
pub fn check(path: &Path) -> Result<(), Failed> {
    meshes::make();
    let root = Root::of(path.parent().unwrap_or(path));
    let json_path = path.with_extension("json");
    let text = fs::read_to_string(path)?;
    let expected = sequence(path, &text)?;
    let json = converted_text(path, &text, root.clone())?;
    validator::validate(&SCHEMA, &SCHEMA, &serde_json::from_str(&json)?)?;
    if !is_same(&sequence(&json_path, &json)?, &expected) {
        return Err(format!("another sequence in JSON:\n{json}").into());
    }
    let again = converted_text(&json_path, &json, root.clone())?;
    if !is_same(&sequence(path, &again)?, &expected) {
        return Err(format!("another sequence in RON:\n{again}").into());
    }
    if converted_text(path, &again, root)? != json {
        return Err("its JSON differs from that of the result".into());
    }
    Ok(())
}

fn sequence(path: &Path, text: &str) -> Result<Sequence, Failed> {
    let sequence = parse(&path.to_string_lossy(), text)?;
    Ok(Sequence { warnings: Vec::new(), ..sequence })
}

/// Parts of glTF files are only equal to themselves, so their content is compared.
fn is_same(one: &Sequence, other: &Sequence) -> bool {
    one == other || format!("{one:?}") == format!("{other:?}")
}

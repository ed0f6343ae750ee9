//! `kinora schema`: writes the JSON Schema of sequences in JSON.

use super::failure::Failure;
use super::{explain, terminal};
use crate::base::escape;
use crate::encode::write_file;
use crate::sequence::schema;
use clap::Args;
use std::path::PathBuf;

/// Print the JSON Schema of sequences in JSON, for editors.
#[derive(Args, Debug, PartialEq)]
#[command(after_help = "\
Examples:
  kinora schema -o kinora.schema.json      beside the sequences
  kinora schema | jq '.properties | keys'  the names of all sections

Editors complete and explain the fields of a .json sequence that names the schema:

  {\"$schema\": \"./kinora.schema.json\", \"timeline\": {\"frames\": 48}}

sequences/README.md says how to set it for a whole folder. The schema describes the format of this
version of Kinora. `kinora check` also finds what a schema cannot express, such as names of objects
that do not exist.")]
pub struct Arguments {
    /// The file to write; without it, the schema is printed
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let text = text()?;
    let Some(path) = &arguments.output else { return terminal::print_text(text.trim_end()) };
    write_file(path, text.as_bytes()).map_err(|error| Failure::Incomplete(error.to_string()))?;
    terminal::print_line(&format!("wrote {}", escape::path(path)))
}

fn text() -> Result<String, Failure> {
    let schema = schema(&explain::describer());
    let text = serde_json::to_string_pretty(&schema);
    text.map(|text| text + "\n").map_err(|error| Failure::Incomplete(error.to_string()))
}

//! Decodes `output`: size, display and files.

use super::OutputSettings;
use super::annotations::caption;
use super::colors::color;
use super::fault::Fault;
use super::fields::Fields;
use super::formats::formats;
use super::keys::keyed;
use super::node::Node;
use super::values::{between, each, list, one_of, switch, text, tuple, whole};
use crate::encode::{DEFAULT_BACKGROUND_COLOR, Formats, Output, Tonemap};
use crate::film::MAX_STOPS;
use std::cell::RefCell;
use std::collections::HashSet;
use std::path::{Component, PathBuf};

const LONGEST_SIDE: u32 = 65_536;

/// Decodes the output of a sequence called `name` with `frames` frames.
pub fn output(node: Node<'_>, name: &str, frames: u32) -> Option<OutputSettings> {
    let mut fields = Fields::of(node, "the output")?;
    let defaults = default_output(name, frames);
    let size = fields.or("size", size, defaults.size);
    let files = fields.or("files", |node| files(node, frames), defaults.files);
    let tonemap = fields.or("tonemap", one_of("tone map", &Tonemap::NAMED), defaults.tonemap);
    let exposure = fields.or("exposure", keyed(between(-MAX_STOPS..=MAX_STOPS)), defaults.exposure);
    let transparent = fields.or("transparent", switch, defaults.transparent);
    let background_color = fields.renamed("background_color", "matte", color);
    let caption = fields.optional("caption", |node| caption(node, None));
    let formats = formats(&mut fields);
    report_loop_count(&mut fields);
    fields.finish();
    Some(OutputSettings {
        size: size?,
        files: files?,
        tonemap: tonemap?,
        exposure: exposure?,
        transparent: transparent?,
        background_color: background_color?.unwrap_or(defaults.background_color),
        caption: caption?,
        formats: formats?,
    })
}

/// Reports `loop_count`, or its former name, outside of the animation's format.
fn report_loop_count(fields: &mut Fields<'_>) {
    for (name, title) in [
        ("plays", "`plays` is now `loop_count`, a field of `gif`, `apng` and `webp`"),
        ("loop_count", "`loop_count` is a field of `gif`, `apng` and `webp`"),
    ] {
        if fields.has(name) {
            let fault = Fault::new(fields.place(name), title, "not a field of the output");
            fields.node().fault(fault.help("write it as in `gif: (loop_count: 2)`"));
            fields.pass_over(name);
        }
    }
}

/// The output of a file without `output`.
pub fn default_output(name: &str, frames: u32) -> OutputSettings {
    // These characters would stand for the frame number.
    let name = name.replace(['#', '%'], "_");
    let names = match frames {
        1 => vec![format!("output/{name}.png")],
        _ => vec![format!("output/{name}/frame_####.png"), format!("output/{name}.gif")],
    };
    let files = names.iter().filter_map(|name| Output::parse(name).ok()).collect();
    OutputSettings {
        size: (640, 360),
        files,
        tonemap: Tonemap::default(),
        exposure: 0.0.into(),
        transparent: false,
        background_color: DEFAULT_BACKGROUND_COLOR,
        caption: None,
        formats: Formats::default(),
    }
}

fn size(node: Node<'_>) -> Option<(u32, u32)> {
    let [width, height] = each(tuple(node, "a size (width, height)")?, whole(1..=LONGEST_SIDE))?;
    Some((width, height))
}

fn files(node: Node<'_>, frames: u32) -> Option<Vec<Output>> {
    let files = if node.is_text() {
        file(node, frames).map(|file| vec![file])
    } else {
        let named = RefCell::new(HashSet::new());
        list(node, "file names", |node| {
            let output = file(node, frames)?;
            // `a.gif` and `./a.gif` are the same file.
            let parts = output.name().components().filter(|part| *part != Component::CurDir);
            if named.borrow_mut().insert(parts.collect::<PathBuf>()) {
                return Some(output);
            }
            node.fault(Fault::new(node.span(), format!("`files` names \"{output}\" twice"), "named before"));
            None
        })
    }?;
    if files.is_empty() {
        node.fault(Fault::new(node.span(), "nothing would be written", "needs at least one file"));
        return None;
    }
    Some(files)
}

/// Decodes an output file. It must be within the working directory, have a known format, and a name for each frame.
fn file(node: Node<'_>, frames: u32) -> Option<Output> {
    let path = text(node)?;
    if let Err((what, help)) = check_place(&path) {
        node.fault(node.mismatch(what).help(help));
        return None;
    }
    if path == "-" {
        let help = "`-o -` on the command line writes there";
        node.fault(node.mismatch("a file, not the standard output").help(help));
        return None;
    }
    let output = match Output::parse(&path) {
        Ok(output) => output,
        Err(error) => {
            node.fault(Fault::new(node.span(), format!("`files`: {error}"), "cannot be written"));
            return None;
        }
    };
    if output.needs_placeholder(frames as usize) {
        let what = "a file name with a place for the frame number";
        node.fault(
            node.mismatch(what).help("write `####` where the number goes, as in \"output/frame_####.png\""),
        );
        return None;
    }
    Some(output)
}

/// A sequence from someone else must not write outside the working directory.
fn check_place(path: &str) -> Result<(), (&'static str, &'static str)> {
    let parts: Vec<_> = path.split(['/', '\\']).collect();
    let drive = parts[0].contains(':');
    if drive || parts.contains(&"..") || path.starts_with(['/', '\\']) {
        let help = "only `-o` on the command line may write outside of the working directory";
        return Err(("a relative path without `..`", help));
    }
    if path.chars().any(char::is_control) {
        return Err((
            "a file name without control characters",
            "remove control characters, such as line breaks and tabs",
        ));
    }
    Ok(())
}

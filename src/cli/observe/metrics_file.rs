//! One JSON object per finished frame. The frame loop knows what a frame took, and the encoder what became of it: their
//! two events make one line.

use super::log_file::LineFile;
use crate::cli::json::line;
use serde_json::{Map, Value};
use std::collections::BTreeMap;

#[derive(Debug, Default)]
pub struct MetricsFile {
    pub lines: LineFile,
    /// Frames of which one event is missing.
    waiting: BTreeMap<u64, Map<String, Value>>,
}

/// The keys of a line in order. Those with a dot are in an object.
const KEYS: [&str; 17] = [
    "frame",
    "film",
    "wall_s",
    "cpu_s",
    "encode_s",
    "bytes",
    "rays.camera",
    "rays.mirror",
    "rays.transmitted",
    "rays.scattered",
    "rays.shadow",
    "rays.total",
    "light_samples",
    "bvh_builds",
    "bvh_refits",
    "noise",
    "denoised",
];

impl MetricsFile {
    pub fn event(&mut self, fields: Map<String, Value>) {
        let Some(frame) = fields.get("frame").and_then(Value::as_u64) else { return };
        let all = self.waiting.entry(frame).or_default();
        all.extend(fields);
        let is_kept = all.get("film").is_some_and(|film| film == "kept" || film == "redrawn");
        if is_kept || all.contains_key("wall_s") && all.contains_key("encode_s") {
            let all = self.waiting.remove(&frame).unwrap_or_default();
            self.lines.line(&text(all));
        }
    }

    /// Writes frames that were traced, but not written, because the run stopped or does not write them singly.
    pub fn finish(mut self) -> Option<std::io::Error> {
        for all in std::mem::take(&mut self.waiting).into_values() {
            self.lines.line(&text(all));
        }
        self.lines.finish()
    }
}

fn text(mut all: Map<String, Value>) -> String {
    let mut object = Map::new();
    for key in KEYS {
        let value = all.remove(key).unwrap_or(Value::Null);
        match key.split_once('.') {
            Some((outer, inner)) => {
                let inside = object.entry(outer).or_insert_with(|| Map::new().into());
                if let Value::Object(inside) = inside {
                    inside.insert(inner.to_owned(), value);
                }
            }
            None => {
                object.insert(key.to_owned(), value);
            }
        }
    }
    line(object)
}

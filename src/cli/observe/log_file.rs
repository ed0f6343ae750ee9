//! A text line for each span that has ended, and for each event.

use crate::base::escape;
use serde_json::{Map, Value};
use std::fs::File;
use std::io::{self, Write};
use tracing::Level;

/// Lines wait in memory until there is a file; then each is written at once, for those who follow the file.
#[derive(Debug, Default)]
pub struct LineFile {
    file: Option<File>,
    waiting: String,
    fault: Option<io::Error>,
}

impl LineFile {
    pub fn open(&mut self, file: File) {
        self.file = Some(file);
        self.write();
    }

    pub fn line(&mut self, line: &str) {
        self.waiting.push_str(line);
        self.waiting.push('\n');
        self.write();
    }

    fn write(&mut self) {
        let Some(file) = self.file.as_mut().filter(|_| self.fault.is_none()) else { return };
        self.fault = file.write_all(self.waiting.as_bytes()).err();
        self.waiting.clear();
    }

    pub fn finish(self) -> Option<io::Error> {
        self.fault
    }
}

/// `    0.012345 DEBUG [render 0] trace frame=3 took=11.204ms`: the time since the start in seconds, at the end of a span.
pub fn text(
    (at, took): (u64, Option<u64>),
    level: Level,
    thread: &str,
    name: &str,
    fields: &Map<String, Value>,
) -> String {
    let mut line = format!("{:12.6} {level:5} [{thread}] {}", at as f64 * 1e-9, escape::line(name));
    for (key, value) in fields {
        // JSON quotes texts and escapes what could steer a terminal.
        line += &format!(" {key}={}", crate::cli::json::line(value.clone()));
    }
    if let Some(took) = took {
        line += &format!(" took={:.3}ms", took as f64 * 1e-6);
    }
    line
}

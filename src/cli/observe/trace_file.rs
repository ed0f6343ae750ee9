//! A timeline in Chrome's trace event format, which is valid JSON after every write.
//!
//! Format: "Trace Event Format" by the Chromium project. Times are in microseconds, here with three decimals, so that
//! nanoseconds are exact and events nest exactly.

use crate::cli::json::line;
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;
use std::fs::File;
use std::io::{self, Seek, SeekFrom, Write};

const HEAD: &str = "{\"displayTimeUnit\":\"ms\",\"traceEvents\":[\n";
/// Ends the file. The next write replaces it.
const TAIL: &str = "\n]}\n";
/// Bytes that wait for a write.
const BUFFER: usize = 1 << 16;

#[derive(Debug)]
pub struct TraceFile {
    file: Option<File>,
    /// Where the next event goes.
    end: u64,
    waiting: String,
    named: BTreeSet<u64>,
    fault: Option<io::Error>,
}

/// A thread as the file names it.
pub type Thread<'a> = (u64, &'a str);

impl TraceFile {
    pub fn new() -> Self {
        let name = line(json!({
            "name": "process_name", "ph": "M", "pid": std::process::id(), "tid": 0, "args": { "name": "kinora" }
        }));
        let waiting = format!("{HEAD}{name}");
        Self { file: None, end: 0, waiting, named: BTreeSet::new(), fault: None }
    }

    pub fn open(&mut self, file: File) {
        self.file = Some(file);
        self.write();
    }

    /// A span of a thread, in nanoseconds since the start.
    pub fn span(&mut self, name: &str, (begin, end): (u64, u64), thread: Thread, args: &Map<String, Value>) {
        self.name(thread);
        let event = format!(
            r#"{{"name":{},"ph":"X","ts":{},"dur":{},"pid":{},"tid":{},"args":{}}}"#,
            line(name),
            microseconds(begin),
            microseconds(end.saturating_sub(begin)),
            std::process::id(),
            thread.0,
            line(args.clone())
        );
        self.add(&event);
    }

    /// An event (`i`) or the values of counters (`C`) at a time.
    pub fn instant(&mut self, kind: char, name: &str, at: u64, thread: Thread, args: &Map<String, Value>) {
        self.name(thread);
        let scope = if kind == 'i' { r#","s":"t""# } else { "" };
        let event = format!(
            r#"{{"name":{},"ph":"{kind}"{scope},"ts":{},"pid":{},"tid":{},"args":{}}}"#,
            line(name),
            microseconds(at),
            std::process::id(),
            thread.0,
            line(args.clone())
        );
        self.add(&event);
    }

    fn name(&mut self, (number, name): Thread) {
        if self.named.insert(number) {
            let pid = std::process::id();
            let event = json!({ "name": "thread_name", "ph": "M", "pid": pid, "tid": number, "args": { "name": name } });
            self.add(&line(event));
        }
    }

    fn add(&mut self, event: &str) {
        self.waiting.push_str(",\n");
        self.waiting.push_str(event);
        if self.waiting.len() >= BUFFER {
            self.write();
        }
    }

    /// Writes what waits, over the end of the last write, and a new end.
    pub fn write(&mut self) {
        let Some(file) = self.file.as_mut().filter(|_| self.fault.is_none()) else { return };
        let bytes = self.waiting.len() as u64;
        self.waiting.push_str(TAIL);
        let written =
            file.seek(SeekFrom::Start(self.end)).and_then(|_| file.write_all(self.waiting.as_bytes()));
        self.waiting.clear();
        match written {
            Ok(()) => self.end += bytes,
            Err(error) => {
                // The disk is full. What was there before becomes valid again.
                let _ = file.set_len(self.end);
                let _ = file.seek(SeekFrom::Start(self.end)).and_then(|_| file.write_all(TAIL.as_bytes()));
                self.fault = Some(error);
            }
        }
    }

    pub fn finish(mut self) -> Option<io::Error> {
        self.write();
        self.fault
    }
}

fn microseconds(nanoseconds: u64) -> String {
    format!("{}.{:03}", nanoseconds / 1000, nanoseconds % 1000)
}

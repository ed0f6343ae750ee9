//! The receiver of spans and events.

use super::log_file::{LineFile, text};
use super::metrics_file::MetricsFile;
use super::thread_slot;
use super::trace_file::TraceFile;
use crate::base::stats::FRAME_EVENTS;
use serde_json::{Map, Value};
use std::cell::RefCell;
use std::collections::HashMap;
use std::fmt::Debug;
use std::fs::File;
use std::io;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;
use tracing::field::{Field, Visit};
use tracing::level_filters::LevelFilter;
use tracing::span::{Attributes, Id, Record};
use tracing::{Event, Level, Metadata, Subscriber};

/// The target of events that are counters of the timeline.
const COUNTERS: &str = "kinora::counter";

/// The most detailed level of the log: no tiles.
const LOG_LEVEL: Level = Level::DEBUG;

#[derive(Debug)]
pub struct Recorder {
    start: Instant,
    level: LevelFilter,
    last: AtomicU64,
    spans: Mutex<HashMap<u64, OpenSpan>>,
    files: Mutex<Files>,
}

#[derive(Debug)]
struct OpenSpan {
    metadata: &'static Metadata<'static>,
    fields: Map<String, Value>,
    references: usize,
}

/// The files of the options, until the run ends.
#[derive(Debug)]
struct Files {
    trace: Option<TraceFile>,
    log: Option<LineFile>,
    metrics: Option<MetricsFile>,
}

thread_local! {
    /// The spans that this thread is in, each with its begin in nanoseconds.
    static ENTERED: RefCell<Vec<(u64, u64)>> = const { RefCell::new(Vec::new()) };
}

impl Recorder {
    pub fn new(trace: bool, log: bool, metrics: bool) -> Self {
        let level = match (trace, log) {
            (true, _) => LevelFilter::TRACE,
            (_, true) => LevelFilter::from_level(LOG_LEVEL),
            _ => LevelFilter::INFO,
        };
        let files = Files {
            trace: trace.then(TraceFile::new),
            log: log.then(LineFile::default),
            metrics: metrics.then(MetricsFile::default),
        };
        Self {
            start: Instant::now(),
            level,
            last: AtomicU64::new(0),
            spans: Mutex::default(),
            files: files.into(),
        }
    }

    /// Gives an option its file, and writes what waits for it.
    pub fn open(&self, option: &str, file: File) {
        let mut files = lock(&self.files);
        let Files { trace, log, metrics } = &mut *files;
        match (option, trace, log, metrics) {
            ("--trace", Some(trace), ..) => trace.open(file),
            ("--log", _, Some(log), _) => log.open(file),
            (_, _, _, Some(metrics)) => metrics.lines.open(file),
            _ => {}
        }
    }

    /// Completes all files. Returns the options whose files could not be written. What comes later is dropped.
    pub fn finish(&self) -> Vec<(&'static str, io::Error)> {
        let mut files = lock(&self.files);
        let trace = files.trace.take().and_then(TraceFile::finish).map(|error| ("--trace", error));
        let log = files.log.take().and_then(LineFile::finish).map(|error| ("--log", error));
        let metrics = files.metrics.take().and_then(MetricsFile::finish).map(|error| ("--metrics", error));
        [trace, log, metrics].into_iter().flatten().collect()
    }

    fn now(&self) -> u64 {
        self.start.elapsed().as_nanos() as u64
    }
}

impl Subscriber for Recorder {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        metadata.target().starts_with("kinora") && *metadata.level() <= self.level
    }

    fn max_level_hint(&self) -> Option<LevelFilter> {
        Some(self.level)
    }

    fn new_span(&self, attributes: &Attributes<'_>) -> Id {
        let id = self.last.fetch_add(1, Relaxed) + 1;
        let mut fields = Fields::default();
        attributes.record(&mut fields);
        let span = OpenSpan { metadata: attributes.metadata(), fields: fields.0, references: 1 };
        lock(&self.spans).insert(id, span);
        Id::from_u64(id)
    }

    fn record(&self, id: &Id, values: &Record<'_>) {
        let mut fields = Fields::default();
        values.record(&mut fields);
        if let Some(span) = lock(&self.spans).get_mut(&id.into_u64()) {
            span.fields.extend(fields.0);
        }
    }

    fn record_follows_from(&self, _: &Id, _: &Id) {}

    fn event(&self, event: &Event<'_>) {
        let mut fields = Fields::default();
        event.record(&mut fields);
        let mut fields = fields.0;
        let name = match fields.shift_remove("message") {
            Some(Value::String(message)) => message,
            _ => event.metadata().name().to_owned(),
        };
        let (at, (number, thread)) = (self.now(), thread_slot::current());
        let (level, target) = (*event.metadata().level(), event.metadata().target());
        let mut files = lock(&self.files);
        if let Some(trace) = &mut files.trace {
            match target == COUNTERS {
                true => trace.instant('C', "rays", at, (number, &thread), &fields),
                false => trace.instant('i', &name, at, (number, &thread), &fields),
            }
        }
        if let Some(log) = files.log.as_mut().filter(|_| level <= LOG_LEVEL) {
            log.line(&text((at, None), level, &thread, &name, &fields));
        }
        if let Some(metrics) = files.metrics.as_mut().filter(|_| target == FRAME_EVENTS) {
            metrics.event(fields);
        }
    }

    fn enter(&self, id: &Id) {
        // Before the begin: a thread that takes its number only at the end of a span may get one whose last owner was still
        // at work when the span began, and their spans would overlap.
        thread_slot::current();
        let _ = ENTERED.try_with(|entered| entered.borrow_mut().push((id.into_u64(), self.now())));
    }

    fn exit(&self, id: &Id) {
        let end = self.now();
        let last = ENTERED.try_with(|entered| entered.borrow_mut().pop()).ok().flatten();
        let Some((_, begin)) = last.filter(|(last, _)| *last == id.into_u64()) else { return };
        let (metadata, fields) = {
            let spans = lock(&self.spans);
            let Some(span) = spans.get(&id.into_u64()) else { return };
            (span.metadata, span.fields.clone())
        };
        let (number, thread) = thread_slot::current();
        let mut files = lock(&self.files);
        if let Some(trace) = &mut files.trace {
            trace.span(metadata.name(), (begin, end), (number, &thread), &fields);
        }
        if let Some(log) = files.log.as_mut().filter(|_| *metadata.level() <= LOG_LEVEL) {
            let times = (end, Some(end.saturating_sub(begin)));
            log.line(&text(times, *metadata.level(), &thread, metadata.name(), &fields));
        }
    }

    fn clone_span(&self, id: &Id) -> Id {
        if let Some(span) = lock(&self.spans).get_mut(&id.into_u64()) {
            span.references += 1;
        }
        id.clone()
    }

    fn try_close(&self, id: Id) -> bool {
        let mut spans = lock(&self.spans);
        let Some(span) = spans.get_mut(&id.into_u64()) else { return false };
        span.references -= 1;
        let closed = span.references == 0;
        if closed {
            spans.remove(&id.into_u64());
        }
        closed
    }
}

/// The fields of a span or an event as JSON.
#[derive(Default)]
struct Fields(Map<String, Value>);

impl Fields {
    fn put(&mut self, field: &Field, value: impl Into<Value>) {
        self.0.insert(field.name().to_owned(), value.into());
    }
}

impl Visit for Fields {
    fn record_f64(&mut self, field: &Field, value: f64) {
        // Microseconds are enough for seconds, and shorter.
        let value = if field.name().ends_with("_s") { (value * 1e6).round() / 1e6 } else { value };
        self.put(field, value);
    }

    fn record_i64(&mut self, field: &Field, value: i64) {
        self.put(field, value);
    }

    fn record_u64(&mut self, field: &Field, value: u64) {
        self.put(field, value);
    }

    fn record_bool(&mut self, field: &Field, value: bool) {
        self.put(field, value);
    }

    fn record_str(&mut self, field: &Field, value: &str) {
        self.put(field, value);
    }

    fn record_debug(&mut self, field: &Field, value: &dyn Debug) {
        self.put(field, format!("{value:?}"));
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

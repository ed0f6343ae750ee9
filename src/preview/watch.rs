//! Watches files: by the system's notices, and by looking at them now and then for systems that send none.

use super::engine::EngineHandle;
use notify::event::{AccessKind, AccessMode};
use notify::{EventKind, RecommendedWatcher, RecursiveMode, Watcher as _};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant, SystemTime};

/// The time between two looks at the files.
const PAUSE: Duration = Duration::from_millis(250);

/// Editors save in several steps. A notice waits so long for more.
const SETTLE: Duration = Duration::from_millis(8);

/// The longest wait, if notices keep coming.
const MOST_SETTLE: Duration = Duration::from_millis(40);

/// Tells an engine about changes of the files that it watches.
pub struct Watcher {
    notices: Option<RecommendedWatcher>,
    folders: BTreeSet<PathBuf>,
    known: BTreeMap<PathBuf, Option<Signature>>,
}

/// What differs after a file was written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Signature {
    modified: Option<SystemTime>,
    length: u64,
}

impl Signature {
    fn of(path: &Path) -> Option<Self> {
        let data = std::fs::metadata(path).ok()?;
        Some(Self { modified: data.modified().ok(), length: data.len() })
    }
}

impl Watcher {
    /// Watches on a thread of its own, as long as the process lives.
    pub fn start(engine: EngineHandle) -> std::io::Result<()> {
        let (sender, events) = mpsc::channel();
        let sent = move |event: notify::Result<notify::Event>| {
            let paths = event.ok().filter(|event| is_change(&event.kind)).map(|event| event.paths);
            // Nobody listens at the end of the process.
            let _ = paths.map(|paths| sender.send(paths));
        };
        // Without notices, the looks remain.
        let notices = notify::recommended_watcher(sent).ok();
        let watcher = Self { notices, folders: BTreeSet::new(), known: BTreeMap::new() };
        thread::Builder::new().name("watch".to_owned()).spawn(move || watcher.run(&engine, &events))?;
        Ok(())
    }

    fn run(mut self, engine: &EngineHandle, events: &Receiver<Vec<PathBuf>>) {
        loop {
            let files = engine.watched();
            self.follow(&files);
            let mut changed = self.look(&files);
            match events.recv_timeout(PAUSE) {
                Ok(first) => {
                    let mut paths = first;
                    let end = Instant::now() + MOST_SETTLE;
                    while Instant::now() < end {
                        let Ok(more) = events.recv_timeout(SETTLE) else { break };
                        paths.extend(more);
                    }
                    changed |= paths.iter().any(|path| is_one_of(path, &files));
                    // What was read just now is known.
                    self.look(&files);
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => thread::sleep(PAUSE),
            }
            if changed {
                engine.files_changed();
            }
        }
    }

    /// Asks for notices about the folders of the files. Editors replace files, so files alone would be lost.
    fn follow(&mut self, files: &BTreeSet<PathBuf>) {
        let Some(notices) = &mut self.notices else { return };
        let folder = |file: &PathBuf| {
            let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty());
            folder.unwrap_or(Path::new(".")).to_owned()
        };
        let folders: BTreeSet<PathBuf> = files.iter().map(folder).collect();
        for folder in folders.difference(&self.folders) {
            // Looks find what notices miss.
            let _ = notices.watch(folder, RecursiveMode::NonRecursive);
        }
        for folder in self.folders.difference(&folders) {
            let _ = notices.unwatch(folder);
        }
        self.folders = folders;
    }

    /// Whether files differ from the last look.
    fn look(&mut self, files: &BTreeSet<PathBuf>) -> bool {
        let now: BTreeMap<_, _> = files.iter().map(|path| (path.clone(), Signature::of(path))).collect();
        let differs = |(path, signature): (&PathBuf, &Option<Signature>)| {
            self.known.get(path).is_some_and(|known| known != signature)
        };
        let changed = now.iter().any(differs);
        self.known = now;
        changed
    }
}

/// Whether something was written. Reading is no change.
fn is_change(kind: &EventKind) -> bool {
    match kind {
        EventKind::Access(access) => *access == AccessKind::Close(AccessMode::Write),
        EventKind::Create(_) | EventKind::Modify(_) | EventKind::Remove(_) | EventKind::Any => true,
        EventKind::Other => false,
    }
}

/// Whether a path is one of the files, by its name and its folder.
fn is_one_of(path: &Path, files: &BTreeSet<PathBuf>) -> bool {
    let folder = |path: &Path| {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        folder.canonicalize().unwrap_or_else(|_| folder.to_owned())
    };
    let names: Vec<&PathBuf> = files.iter().filter(|file| file.file_name() == path.file_name()).collect();
    !names.is_empty() && names.into_iter().any(|file| folder(file) == folder(path))
}

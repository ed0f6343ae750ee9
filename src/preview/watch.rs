//! Watches files: by the system's notices, and by looking at them now and then for systems that send none.

use super::engine::EngineHandle;
use super::session::WatchedFiles;
use crate::base::files::FileStamp;
use notify::event::{AccessKind, AccessMode};
use notify::{EventKind, RecommendedWatcher, RecursiveMode, Watcher as _};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

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
    reported: WatchedFiles,
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
        let watcher = Self { notices, folders: BTreeSet::new(), reported: WatchedFiles::new() };
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
                    // The engine may have read other files meanwhile.
                    let files = engine.watched();
                    changed |= paths.iter().any(|path| is_one_of(path, &files));
                    // What a notice tells, a look need not tell again.
                    changed |= self.look(&files);
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
    fn follow(&mut self, files: &WatchedFiles) {
        let Some(notices) = &mut self.notices else { return };
        let folder = |file: &PathBuf| {
            let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty());
            folder.unwrap_or(Path::new(".")).to_owned()
        };
        let folders: BTreeSet<PathBuf> = files.keys().map(folder).collect();
        for folder in folders.difference(&self.folders) {
            // Looks find what notices miss.
            let _ = notices.watch(folder, RecursiveMode::NonRecursive);
        }
        for folder in self.folders.difference(&folders) {
            let _ = notices.unwatch(folder);
        }
        self.folders = folders;
    }

    /// Whether files differ from what was read and from what was reported.
    fn look(&mut self, files: &WatchedFiles) -> bool {
        let now = files.iter().map(|(path, read)| (path, *read, FileStamp::of(path)));
        let changed: Vec<_> = now.filter(|(_, read, now)| read != now).collect();
        let is_known = |(path, _, now): &(&PathBuf, _, _)| self.reported.get(*path) == Some(now);
        let is_news = !changed.iter().all(is_known);
        self.reported = changed.into_iter().map(|(path, _, now)| (path.clone(), now)).collect();
        is_news
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
fn is_one_of(path: &Path, files: &WatchedFiles) -> bool {
    let folder = |path: &Path| {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        folder.canonicalize().unwrap_or_else(|_| folder.to_owned())
    };
    let names: Vec<&PathBuf> = files.keys().filter(|file| file.file_name() == path.file_name()).collect();
    !names.is_empty() && names.into_iter().any(|file| folder(file) == folder(path))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn watcher() -> Watcher {
        Watcher { notices: None, folders: BTreeSet::new(), reported: WatchedFiles::new() }
    }

    #[test]
    fn changes_between_the_read_and_the_first_look_are_reported_once() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.png");
        fs::write(&path, "1").expect("a disk");
        let read = FileStamp::of(&path);
        fs::write(&path, "12").expect("a disk");
        let mut watcher = watcher();
        let files = WatchedFiles::from([(path.clone(), read)]);
        assert_eq!([watcher.look(&files), watcher.look(&files)], [true, false]);
        // The engine may take longer than the time to the next change.
        fs::write(&path, "123").expect("a disk");
        assert_eq!([watcher.look(&files), watcher.look(&files)], [true, false]);
        let files = WatchedFiles::from([(path.clone(), FileStamp::of(&path))]);
        assert!(!watcher.look(&files));
    }

    #[test]
    fn files_that_go_or_come_are_reported() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.png");
        let mut watcher = watcher();
        let files = WatchedFiles::from([(path.clone(), None)]);
        assert!(!watcher.look(&files));
        fs::write(&path, "1").expect("a disk");
        assert!(watcher.look(&files));
        let files = WatchedFiles::from([(path.clone(), FileStamp::of(&path))]);
        assert!(!watcher.look(&files));
        fs::remove_file(&path).expect("a disk");
        assert!(watcher.look(&files));
    }
}

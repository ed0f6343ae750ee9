//! Claims: files that say which frames a process has in hand, so that others leave them alone.
//!
//! Claims are for films: whoever has one in hand makes all frames of it, as only one of them has to be traced. A claim is a
//! hidden file in the folder of the frames, called after the film and the frames' names. It is written aside and then linked or renamed into its
//! place if that is free, which only one process can; no lock is asked for. Its process touches it every few seconds. A
//! claim is void when its process is known to have ended, or has not touched it for a long time. Times are those of the
//! file system alone: that of a file which is made now is compared with that of the claim.
//!
//! Claims save work, and are nothing that bytes depend on: should two processes ever make the same frame, because one was
//! held up for longer than that, both write the same file, whole.

use super::atomic::PREFIX;
use super::disk::{Operation, attempt};
use super::error::EncodeError;
use super::output::Output;
use super::place::folder_of;
use crate::base::digest::Digest;
use crate::base::process::Process;
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, ErrorKind, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, SystemTime};
use tempfile::NamedTempFile;

/// How often a claim is touched.
const BEAT: Duration = Duration::from_secs(10);

/// How long a claim holds that nobody touches: twelve beats, longer than network file systems keep what they know of a
/// file, and than a machine is usually held up.
const LEASE: Duration = Duration::from_secs(120);

/// What claims of any run are called, before what they are for.
const CLAIM: &str = "claim-";

/// The claims of a process.
#[derive(Debug)]
pub struct Claims {
    process: Process,
    held: Arc<Held>,
    /// Dropped, it ends the thread that touches them.
    _alive: Sender<()>,
}

/// The files of the claims that are held, open.
type Held = Mutex<BTreeMap<PathBuf, File>>;

/// A claim that is held. Dropped, it is given up.
#[derive(Debug)]
pub struct Claim {
    path: PathBuf,
    text: String,
    held: Arc<Held>,
}

/// Who has a frame in hand, and since when nothing has been heard of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Holder {
    /// None if the claim does not say.
    pub process: Option<Process>,
    pub silent: Duration,
    text: String,
}

/// The claim for those frames of an output that are made of a film, whichever of them are wanted.
pub fn path_of(output: &Output, film: Digest) -> PathBuf {
    // Called alike on all machines, wherever the folder is there.
    let frame = output.path(0);
    let name = frame.file_name().unwrap_or_default().as_encoded_bytes();
    let what = Digest::of(&(film, name));
    frame.with_file_name(format!("{PREFIX}{CLAIM}{what}"))
}

/// Whether a file is a claim, by its name.
pub fn is_claim(name: &str) -> bool {
    name.strip_prefix(PREFIX).is_some_and(|rest| rest.starts_with(CLAIM))
}

/// Who claims a frame, if anybody does.
pub fn holder(claim: &Path) -> io::Result<Option<Holder>> {
    let found = attempt(Operation::Read, claim, || {
        // Opened first: what network file systems know of a file is renewed by that.
        let mut file = File::open(claim)?;
        let mut text = String::new();
        io::Read::read_to_string(&mut file, &mut text)?;
        Ok((file.metadata()?.modified()?, text))
    });
    let (touched, text) = match found {
        Ok(found) => found,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        // Half a character of a foreign file says as little as none.
        Err(error) if error.kind() == ErrorKind::InvalidData => {
            (fs::metadata(claim)?.modified()?, String::new())
        }
        Err(error) => return Err(error),
    };
    // Where nothing may be written, this machine's clock has to do.
    let now = now(folder_of(claim)).unwrap_or_else(|_| SystemTime::now());
    let silent = now.duration_since(touched).unwrap_or_default();
    let process = text.lines().next().and_then(|line| line.parse().ok());
    Ok(Some(Holder { process, silent, text }))
}

/// The time, as the file system of a folder has it.
fn now(folder: &Path) -> io::Result<SystemTime> {
    let probe = || aside(folder)?.as_file().metadata()?.modified();
    attempt(Operation::Create, folder, probe)
}

fn aside(folder: &Path) -> io::Result<NamedTempFile> {
    tempfile::Builder::new().prefix(PREFIX).suffix(".part").tempfile_in(folder)
}

impl Holder {
    /// Somebody who does not say who it is.
    pub fn unknown(silent: Duration) -> Self {
        Self { process: None, silent, text: String::new() }
    }

    /// Whether the claim is void, so that its frame may be claimed by another.
    pub fn is_gone(&self) -> bool {
        self.silent >= LEASE || self.process.as_ref().is_some_and(Process::has_ended)
    }
}

impl Claims {
    /// None is held yet.
    pub fn new() -> Self {
        let held: Arc<Held> = Arc::default();
        let (alive, over) = channel();
        let touched = Arc::downgrade(&held);
        let beats = move || {
            while over.recv_timeout(BEAT) == Err(RecvTimeoutError::Timeout) {
                let Some(held) = touched.upgrade() else { return };
                for (path, file) in lock(&held).iter_mut() {
                    // The same again, in the same place; should it fail once, there are others to come.
                    let _ = attempt(Operation::Write, path, || touch(file));
                }
            }
        };
        // Without a thread to spare claims hold no longer than their lease, which costs others work, and no frame.
        let _ = thread::Builder::new().name("claims".into()).spawn(beats);
        Self { process: Process::this(), held, _alive: alive }
    }

    /// Claims what this claim is for, unless somebody else does.
    pub fn claim(&self, path: &Path) -> Result<Result<Claim, Holder>, EncodeError> {
        let fault = |error| EncodeError::write(path, error);
        loop {
            if let Some(claim) = self.put(path).map_err(fault)? {
                return Ok(Ok(claim));
            }
            match holder(path).map_err(fault)? {
                // Given up meanwhile.
                None => {}
                Some(holder) if holder.is_gone() => clear(path, &holder).map_err(fault)?,
                Some(holder) => return Ok(Err(holder)),
            }
        }
    }

    /// Puts a claim into its place, if that is free.
    fn put(&self, path: &Path) -> io::Result<Option<Claim>> {
        static COUNT: AtomicU64 = AtomicU64::new(0);
        let text = format!("{}\n{}\n", self.process, COUNT.fetch_add(1, Relaxed));
        let mut file = attempt(Operation::Create, path, || aside(folder_of(path)))?;
        attempt(Operation::Write, path, || file.write_all(text.as_bytes()))?;
        let placed = attempt(Operation::Rename, path, || match file.persist_noclobber(path) {
            Ok(file) => Ok(Some(file)),
            // A server may have done it and its answer got lost.
            Err(error) if error.error.kind() == ErrorKind::AlreadyExists && is(path, &text) => {
                error.file.as_file().try_clone().map(Some)
            }
            Err(error) if error.error.kind() == ErrorKind::AlreadyExists => Ok(None),
            Err(error) => Err(error.error),
        });
        Ok(placed?.map(|file| {
            lock(&self.held).insert(path.to_owned(), file);
            Claim { path: path.to_owned(), text, held: Arc::clone(&self.held) }
        }))
    }
}

fn touch(file: &mut File) -> io::Result<()> {
    let text = {
        let mut text = Vec::new();
        file.seek(SeekFrom::Start(0))?;
        io::Read::read_to_end(file, &mut text)?;
        text
    };
    file.seek(SeekFrom::Start(0))?;
    file.write_all(&text)
}

impl Drop for Claim {
    fn drop(&mut self) {
        lock(&self.held).remove(&self.path);
        // One that was taken for void is another's now.
        if is(&self.path, &self.text) {
            let _ = fs::remove_file(&self.path);
        }
    }
}

fn is(path: &Path, text: &str) -> bool {
    fs::read_to_string(path).is_ok_and(|found| found == text)
}

fn lock(held: &Held) -> MutexGuard<'_, BTreeMap<PathBuf, File>> {
    held.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes a claim that is void. Of several that try, one does; and whoever finds that it was another's by then, puts it
/// back.
fn clear(path: &Path, holder: &Holder) -> io::Result<()> {
    let taken = aside(folder_of(path))?.into_temp_path();
    match attempt(Operation::Rename, path, || fs::rename(path, &taken)) {
        Ok(()) if is(&taken, &holder.text) => Ok(()),
        Ok(()) => match taken.persist_noclobber(path) {
            Err(error) if error.error.kind() != ErrorKind::AlreadyExists => Err(error.error),
            _ => Ok(()),
        },
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
        Err(error) => Err(error),
    }
}

/// Removes a claim that nobody will take over, if it is void.
pub fn sweep(path: &Path) {
    if let Ok(Some(holder)) = holder(path)
        && holder.is_gone()
    {
        let _ = clear(path, &holder);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NAME: &str = ".kinora-claim-0";

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).expect("a folder").flatten();
        entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect()
    }

    fn age(path: &Path, by: Duration) {
        let file = File::options().write(true).open(path).expect("a claim");
        file.set_modified(SystemTime::now() - by).expect("a claim");
    }

    #[test]
    fn one_of_several_has_a_claim_and_none_stays() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join(NAME);
        let (claims, got) = (Claims::new(), AtomicU64::new(0));
        thread::scope(|scope| {
            for _ in 0..8 {
                scope.spawn(|| {
                    for _ in 0..20 {
                        if let Ok(claim) = claims.claim(&path).expect("a disk") {
                            assert_eq!(got.fetch_add(1, Relaxed), 0, "two have it");
                            got.fetch_sub(1, Relaxed);
                            drop(claim);
                        }
                    }
                });
            }
        });
        assert_eq!(names(dir.path()), Vec::<String>::new());
    }

    #[test]
    fn a_claim_says_who_has_it() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join(NAME);
        let claims = Claims::new();
        let claim = claims.claim(&path).expect("a disk").expect("free");
        let found = claims.claim(&path).expect("a disk").expect_err("taken");
        assert_eq!(found.process, Some(Process::this()));
        assert!(found.silent < LEASE && !found.is_gone());
        assert_eq!(names(dir.path()), [NAME]);
        drop(claim);
        assert_eq!(holder(&path).expect("a disk"), None);
    }

    #[test]
    fn void_claims_are_taken_over_and_others_are_not() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join(NAME);
        let claims = Claims::new();
        let there = |text: &str, silent: u64| {
            fs::write(&path, text).expect("a disk");
            age(&path, Duration::from_secs(silent));
            claims.claim(&path).expect("a disk").is_ok()
        };
        let elsewhere = "elsewhere boot 1 1\n0\n";
        assert!(!there(elsewhere, 60) && there(elsewhere, 300));
        // Whoever it is of: a claim that says nothing is as good as another.
        assert!(!there("", 60) && there("", 300));
        #[cfg(target_os = "linux")]
        {
            let this = Process::this().to_string();
            let ended = this.rsplit_once(' ').expect("words").0.to_owned() + " 1\n0\n";
            assert!(there(&ended, 0));
        }
        assert_eq!(names(dir.path()), Vec::<String>::new());
    }

    /// Whoever was held up for too long does not remove the claim of who came after.
    #[test]
    fn a_claim_that_was_taken_over_is_left_alone() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join(NAME);
        let (first, second) = (Claims::new(), Claims::new());
        let lost = first.claim(&path).expect("a disk").expect("free");
        // The file system's clock goes in steps.
        age(&path, 2 * LEASE);
        let taken = second.claim(&path).expect("a disk").expect("void");
        drop(lost);
        assert!(first.claim(&path).expect("a disk").is_err());
        drop(taken);
        assert!(names(dir.path()).is_empty());
    }

    #[test]
    fn a_claim_that_is_void_no_more_is_put_back() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join(NAME);
        fs::write(&path, "new").expect("a disk");
        let before = Holder { process: None, silent: LEASE, text: "old".to_owned() };
        clear(&path, &before).expect("a disk");
        assert!(is(&path, "new"));
        clear(&path, &Holder { text: "new".to_owned(), ..before }).expect("a disk");
        assert!(names(dir.path()).is_empty());
    }

    #[test]
    fn touched_claims_stay_fresh() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join(NAME);
        let claims = Claims::new();
        let claim = claims.claim(&path).expect("a disk").expect("free");
        age(&path, LEASE);
        lock(&claims.held).values_mut().for_each(|file| touch(file).expect("a disk"));
        let found = holder(&path).expect("a disk").expect("a claim");
        assert!(found.silent < BEAT && found.text == claim.text, "{found:?}");
    }

    #[test]
    fn claims_are_for_films_of_an_output() {
        let output = |name: &str| Output::parse(name).expect(name);
        let path = |name: &str, film: u128| path_of(&output(name), Digest(film));
        assert_eq!(path("a/f_##.png", 1), path("a/f_%02d.png", 1));
        assert_ne!(path("a/f_##.png", 1), path("a/f_##.png", 2));
        assert_ne!(path("a/f_##.png", 1), path("a/g_##.png", 1));
        let one = path("a/f_##.png", 1);
        assert_eq!(one.parent(), Some(Path::new("a")));
        assert_eq!(one.file_name(), path("b/f_##.png", 1).file_name());
        assert!(is_claim(&one.file_name().expect("a name").to_string_lossy()));
        assert!(!is_claim(".kinora-abcdef.part"));
    }
}

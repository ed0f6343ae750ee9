//! A job: everything that an engine writes down in its own format.

use super::chunk::{Chunk, CostClass};
use crate::base::frame_set;
use std::path::{Path, PathBuf};

/// A program that hands out the tasks of a job.
pub trait Engine {
    /// Writes the job in the format of this engine.
    fn export(&self, job: &Job) -> Export;
}

/// Every file of a job contains this text. An export replaces only files that contain it.
pub const MARK: &str = "Written by kinora farm export";

/// The start of the option for the number of threads, as it appears in [`Job::settings`].
pub const THREADS: &str = "--threads=";

/// A sequence as a job. Its commands run in `base`, and its paths are relative to that folder.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// The sequence's name. The names of the job's files start with it.
    pub name: String,
    /// The folder of the job's files, which is the sequence's folder, as seen by the export. Empty if it is the current
    /// folder.
    pub folder: PathBuf,
    /// The path from the job's folder to the folder in which its commands run, such as `..`. Empty if they are the
    /// same.
    pub base: PathBuf,
    /// The sequence's file, relative to `base`.
    pub sequence: PathBuf,
    /// The folder that holds all files that the sequence reads, relative to `base`. `None` if it may read any file.
    pub root: Option<PathBuf>,
    /// Version and contents of everything that is read, for `--expect`.
    pub fingerprint: String,
    /// Options of `render` that travel with the job, one word each.
    pub settings: Vec<String>,
    /// The frames of the job, for `--frames`.
    pub frames: String,
    /// File name patterns of the frames. At least one.
    pub stills: Vec<String>,
    /// Whether the stills record what they show. Then tasks can skip frames that are done or claimed by others.
    pub claims: bool,
    /// Commands that run after all frames are there.
    pub assemblies: Vec<AssembleStep>,
    /// Chunks of frames, most expensive films first.
    pub classes: Vec<CostClass>,
    /// The largest number of tasks that run at the same time.
    pub throttle: Option<u32>,
    /// Threads of a task.
    pub threads: Option<u32>,
}

/// One `kinora assemble`: makes files from finished frames.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AssembleStep {
    /// The file name pattern of the frames.
    pub source: String,
    /// The frames to use, for `--frames`.
    pub frames: String,
    pub settings: Vec<String>,
    pub outputs: Vec<String>,
}

/// A file of a job.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JobFile {
    /// Its name in the job's folder.
    pub name: String,
    pub text: String,
    pub executable: bool,
}

/// A job in the format of an engine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Export {
    pub files: Vec<JobFile>,
    /// The command that submits the job from the current folder.
    pub submit: String,
}

impl Job {
    /// All chunks, in the order in which they should start.
    pub fn chunks(&self) -> impl Iterator<Item = &Chunk> {
        self.classes.iter().flat_map(|class| &class.chunks)
    }

    /// The command that renders these frames. It runs in `base`.
    pub fn render(&self, frames: &str) -> Vec<String> {
        self.render_with(&Verbatim, frames)
    }

    /// The commands that run after all frames are there. They run in `base`.
    pub fn assemble(&self) -> impl Iterator<Item = Vec<String>> {
        self.assemble_with(&Verbatim)
    }

    /// [`Job::render`] with the names that an engine uses.
    pub(super) fn render_with(&self, naming: &impl Naming, frames: &str) -> Vec<String> {
        let mut words = vec!["kinora".to_owned(), "render".to_owned(), naming.sequence(self)];
        words.extend(["--frames".to_owned(), frames.to_owned()]);
        words.extend(self.stills.iter().flat_map(|still| ["-o".to_owned(), naming.file(still)]));
        words.extend(self.claims.then(|| "--claim".to_owned()));
        words.extend(["--expect".to_owned(), self.fingerprint.clone()]);
        words.extend(self.settings.iter().map(|word| naming.word(word)));
        words
    }

    /// [`Job::assemble`] with the names that an engine uses.
    pub(super) fn assemble_with(&self, naming: &impl Naming) -> impl Iterator<Item = Vec<String>> {
        self.assemblies.iter().map(|step| {
            let AssembleStep { source, frames, settings, outputs } = step;
            let mut words = vec!["kinora".to_owned(), "assemble".to_owned(), naming.file(source)];
            words.extend(["--of".to_owned(), naming.sequence(self), "--frames".to_owned(), frames.clone()]);
            words.extend(settings.iter().map(|word| naming.word(word)));
            words.extend(outputs.iter().flat_map(|output| ["-o".to_owned(), naming.file(output)]));
            words
        })
    }

    /// The path of one of the job's files from the current folder.
    pub fn path_of(&self, name: &str) -> String {
        text(&self.folder.join(name))
    }
}

/// How an engine writes file names, and words that it would otherwise interpret.
pub(super) trait Naming {
    fn sequence(&self, job: &Job) -> String {
        text(&job.sequence)
    }

    fn file(&self, name: &str) -> String {
        name.to_owned()
    }

    fn word(&self, word: &str) -> String {
        word.to_owned()
    }
}

/// Writes all names and words unchanged.
struct Verbatim;

impl Naming for Verbatim {}

impl Chunk {
    /// Its frames, for `--frames`.
    pub fn frame_set(&self) -> String {
        frame_set::text(&self.frames)
    }
}

fn text(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}

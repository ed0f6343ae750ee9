//! A job: what every engine is told, each in its own words.

use super::chunk::{Chunk, Class};
use super::{hyperqueue, openjd, shell, slurm};
use crate::base::frame_set;
use std::path::{Path, PathBuf};

/// The engines that jobs are written for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Engine {
    /// Open Job Description, 2023-09.
    OpenJd,
    Slurm,
    HyperQueue,
    /// Any POSIX shell, with `xargs`.
    Shell,
}

/// Stands in every file of a job, so that no other file is taken for one and replaced.
pub const MARK: &str = "Written by kinora farm export";

/// The option for the number of threads, as settings have it, if they have it.
pub const THREADS: &str = "--threads=";

/// A sequence as a job. Its paths are relative to `base`, the folder in which the commands run.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// The sequence's name, which the job's files are called by.
    pub name: String,
    /// Where the job's files go: the sequence's folder, from where the export runs. Empty if it is that folder.
    pub folder: PathBuf,
    /// From the job's folder to the folder in which its commands run, such as `..`. Empty if they are one.
    pub base: PathBuf,
    /// The sequence's file, from `base`.
    pub sequence: PathBuf,
    /// The folder that holds all files which the sequence reads, from `base`; none if it may read any.
    pub root: Option<PathBuf>,
    /// Version and contents of all that is read, as `--expect` takes them.
    pub fingerprint: String,
    /// Options of `render` that travel with the job, each a word.
    pub settings: Vec<String>,
    /// The frames of the job, as `--frames` takes them.
    pub frames: String,
    /// Patterns of the frames' own files. At least one.
    pub stills: Vec<String>,
    /// Whether these say what they show, so that tasks can tell what others have done and are doing.
    pub claims: bool,
    /// What follows once all frames are there.
    pub assemblies: Vec<Assembly>,
    /// Chunks of frames, those first whose films take longest.
    pub classes: Vec<Class>,
    /// Tasks that run at the same time, at most.
    pub throttle: Option<u32>,
    /// Threads of a task.
    pub threads: Option<u32>,
}

/// Files that are made of frames which are there, by one `kinora assemble`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Assembly {
    /// The pattern of the frames.
    pub source: String,
    /// Which of them, as `--frames` takes them.
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

/// A job in the words of an engine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Export {
    pub files: Vec<JobFile>,
    /// The command that submits it, from where the export runs.
    pub submit: String,
}

impl Job {
    /// The job in an engine's words.
    pub fn export(&self, engine: Engine) -> Export {
        match engine {
            Engine::OpenJd => openjd::export(self),
            Engine::Slurm => slurm::export(self),
            Engine::HyperQueue => hyperqueue::export(self),
            Engine::Shell => shell::export(self),
        }
    }

    /// All chunks, in the order in which they should be begun.
    pub fn chunks(&self) -> impl Iterator<Item = &Chunk> {
        self.classes.iter().flat_map(|class| &class.chunks)
    }

    /// The command that renders these frames, to be run in `base`.
    pub fn render(&self, frames: &str) -> Vec<String> {
        self.render_in(&Plain, frames)
    }

    /// The commands that follow when all frames are there, to be run in `base`.
    pub fn assemble(&self) -> impl Iterator<Item = Vec<String>> {
        self.assemble_in(&Plain)
    }

    /// The same with names as an engine has them.
    pub(super) fn render_in(&self, names: &impl Names, frames: &str) -> Vec<String> {
        let mut words = vec!["kinora".to_owned(), "render".to_owned(), names.sequence(self)];
        words.extend(["--frames".to_owned(), frames.to_owned()]);
        words.extend(self.stills.iter().flat_map(|still| ["-o".to_owned(), names.file(still)]));
        words.extend(self.claims.then(|| "--claim".to_owned()));
        words.extend(["--expect".to_owned(), self.fingerprint.clone()]);
        words.extend(self.settings.iter().map(|word| names.word(word)));
        words
    }

    pub(super) fn assemble_in(&self, names: &impl Names) -> impl Iterator<Item = Vec<String>> {
        self.assemblies.iter().map(|assembly| {
            let Assembly { source, frames, settings, outputs } = assembly;
            let mut words = vec!["kinora".to_owned(), "assemble".to_owned(), names.file(source)];
            words.extend(["--of".to_owned(), names.sequence(self), "--frames".to_owned(), frames.clone()]);
            words.extend(settings.iter().map(|word| names.word(word)));
            words.extend(outputs.iter().flat_map(|output| ["-o".to_owned(), names.file(output)]));
            words
        })
    }

    /// A file of the job, from where the export runs.
    pub fn beside(&self, name: &str) -> String {
        path(&self.folder.join(name))
    }
}

/// What an engine calls files, and words that it would take for something else.
pub(super) trait Names {
    fn sequence(&self, job: &Job) -> String {
        path(&job.sequence)
    }

    fn file(&self, name: &str) -> String {
        name.to_owned()
    }

    fn word(&self, word: &str) -> String {
        word.to_owned()
    }
}

/// As they are.
struct Plain;

impl Names for Plain {}

impl Chunk {
    /// Its frames, as `--frames` takes them.
    pub fn set(&self) -> String {
        frame_set::text(&self.frames)
    }
}

fn path(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}

//! `kinora farm export`: a sequence file and options of `render` in, a job for an engine out, beside the sequence.

use super::stills::{Wanted, is_said, source};
use crate::base::escape;
use crate::base::files::{self, Root, way};
use crate::base::frame_set::{self, FrameSet};
use crate::base::units::{count, counted};
use crate::cli::failure::Failure;
use crate::cli::render::{fingerprint, frames_of};
use crate::cli::settings::Spoken;
use crate::cli::{load, loading, overrides, terminal, values};
use crate::encode::{Existing, Output, write_file};
use crate::farm::{Assembly, Engine, Export, Films, Job, JobFile, MARK, classes};
use crate::pipeline::filmstrip::spread;
use crate::pipeline::plan::Survey;
use crate::pipeline::render::{Request, Reuse, extras, job, pool};
use crate::sequence::Sequence;
use clap::{Args, ValueEnum};
use std::fs;
use std::io::{ErrorKind, Read};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

/// Write a render as a job for an engine, and tell how to submit it.
#[derive(Args, Debug, PartialEq)]
#[command(after_help = AFTER_HELP)]
pub struct Arguments {
    /// Who hands out the work
    #[arg(value_name = "ENGINE")]
    engine: Name,

    /// The sequence file (.ron); the job is written beside it
    file: PathBuf,

    /// File to write, as `render` has it; may be given several times
    ///
    /// Tasks write stills. Where there are none, PNGs are added for animations to be made of:
    /// in a folder beside each that is called as it is.
    #[arg(short, long, value_name = "FILE", value_parser = values::output(), verbatim_doc_comment)]
    output: Vec<Output>,

    /// A filmstrip of some of the frames besides
    #[arg(long, value_name = "FILE", value_parser = values::output())]
    filmstrip: Option<Output>,

    /// Frames to render, as `render` has them [default: all]
    #[arg(long, value_name = "SET", allow_hyphen_values = true)]
    frames: Option<FrameSet>,

    /// About how many tasks there are [default: as many as are worth one, at most 1000]
    ///
    /// Tasks take about equally long. Frames that are made of one film are in one task, as only
    /// one of them has to be traced; so there may be fewer.
    #[arg(long, value_name = "N", verbatim_doc_comment)]
    chunks: Option<NonZeroUsize>,

    /// Tasks that run at the same time, at most [default: as the engine likes]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    throttle: Option<u32>,

    #[command(flatten)]
    spoken: Spoken,
}

/// Engines as the command line calls them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Name {
    /// Open Job Description 2023-09, which AWS Deadline Cloud and others read
    Openjd,
    /// An array of sbatch
    Slurm,
    /// A job file of hq
    Hyperqueue,
    /// A script for one machine, or for several that share a folder
    Shell,
}

const AFTER_HELP: &str = "\
Examples:
  kinora farm export slurm turn.ron -t 8 --throttle 50     an array of tasks with 8 processors each
  kinora farm export openjd turn.ron -o out/turn.mp4       frames in out/turn, and a video of them
  kinora farm export shell turn.ron --filmstrip strip.png  a filmstrip besides

Settings travel with the job. It refuses to run with another version of Kinora, or if the sequence
or what it reads has changed. docs/farm.md tells more.";

/// Frames of a filmstrip.
const STRIP: u32 = 9;

/// Bytes at the beginning of a file in which the mark stands.
const HEAD: u64 = 512;

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let settings = &arguments.spoken.settings;
    let options = &settings.options;
    let loading = loading::Reporter::new(options.progress, options.quiet);
    let (sequence, root) = load::with_files(&arguments.file, options.allow_outside, loading)?;
    let sequence = overrides::applied(sequence, &settings.overrides()).map_err(Failure::Bad)?;
    let frames = frames_of(arguments.frames.as_ref(), &sequence)?;
    let job = arguments.job(&sequence, &root, &frames)?;
    let export = job.export(arguments.engine());
    let folder = arguments.folder();
    for file in &export.files {
        check_place(&folder.join(&file.name))?;
    }
    for file in &export.files {
        write(&folder.join(&file.name), file)?;
    }
    if options.quiet {
        return Ok(());
    }
    terminal::say(&told(&job, &export, frames.len()))
}

impl Arguments {
    fn engine(&self) -> Engine {
        match self.engine {
            Name::Openjd => Engine::OpenJd,
            Name::Slurm => Engine::Slurm,
            Name::Hyperqueue => Engine::HyperQueue,
            Name::Shell => Engine::Shell,
        }
    }

    fn folder(&self) -> &Path {
        self.file.parent().unwrap_or(Path::new(""))
    }

    fn job(&self, sequence: &Sequence, root: &Root, frames: &[u32]) -> Result<Job, Failure> {
        let options = &self.spoken.settings.options;
        let wanted =
            Wanted { outputs: &self.output, filmstrip: self.filmstrip.as_ref(), draft: options.draft };
        let (stills, animations) = wanted.of(sequence, frames)?;
        self.check(sequence, frames, [&stills[..], &animations].concat())?;
        let here = Path::new("");
        let base = found(self.folder(), way(self.folder(), here))?;
        let down = found(self.folder(), way(here, self.folder()))?;
        let file = down.join(self.file.file_name().unwrap_or_default());
        let read = root;
        let root = root.folder().map(|root| found(root, way(here, root))).transpose()?;
        let fingerprint = fingerprint(&self.file, read)?.to_string();
        let films = || Films::of(sequence, frames, extras(sequence, &stills));
        let films = pool(options.threads)?.install(films);
        Ok(Job {
            name: sequence.name.clone(),
            claims: stills.iter().all(|still| is_said(still, sequence)),
            folder: self.folder().to_owned(),
            base,
            sequence: file.clone(),
            root,
            fingerprint,
            settings: self.spoken.words.clone(),
            frames: frame_set::text(frames),
            stills: names(&stills)?,
            assemblies: self.assemblies((&stills, &animations), frames)?,
            classes: classes(&films, self.chunks.map(NonZeroUsize::get)),
            throttle: self.throttle,
            threads: options.threads.map(|threads| threads.get() as u32),
        })
    }
}

impl Arguments {
    /// Finds what would let every task fail: outputs that cannot be written.
    fn check(&self, sequence: &Sequence, frames: &[u32], outputs: Vec<Output>) -> Result<(), Failure> {
        let check = |frames: &[u32], outputs: Vec<Output>| {
            let request = Request {
                frames: frames.to_vec(),
                outputs,
                confined: self.output.is_empty(),
                existing: Existing::Keep,
                threads: None,
                reuse: Reuse::Off,
                time_limit: None,
            };
            job(sequence, &request, &Survey::default())
                .check()
                .map_err(|error| Failure::Bad(error.to_string()))
        };
        check(frames, outputs)?;
        // A filmstrip is one picture of several frames.
        self.filmstrip.iter().try_for_each(|strip| check(&frames[..1], vec![strip.clone()]))
    }

    /// What `kinora assemble` is told, for the animations and for the filmstrip.
    fn assemblies(
        &self,
        (stills, animations): (&[Output], &[Output]),
        frames: &[u32],
    ) -> Result<Vec<Assembly>, Failure> {
        let Some(source) = source(stills) else { return Ok(Vec::new()) };
        let source = name(source)?;
        let assembly = |set: &[u32], outputs: &[Output]| {
            Ok(Assembly {
                source: source.clone(),
                frames: frame_set::text(set),
                settings: self.spoken.words.iter().filter_map(|word| for_assembly(word)).collect(),
                outputs: names(outputs)?,
            })
        };
        let moving = (!animations.is_empty()).then(|| assembly(frames, animations));
        let some: Vec<u32> =
            spread(frames.len() as u32, STRIP).into_iter().map(|index| frames[index as usize]).collect();
        let strip = self.filmstrip.as_ref().map(|strip| assembly(&some, std::slice::from_ref(strip)));
        moving.into_iter().chain(strip).collect()
    }
}

/// An output's name, which jobs hold as text.
fn name(output: &Output) -> Result<String, Failure> {
    let name = output.name().to_str().map(str::to_owned);
    name.ok_or_else(|| {
        Failure::Bad(format!("jobs are text files, and {output} is no UTF-8; name it otherwise"))
    })
}

fn names(outputs: &[Output]) -> Result<Vec<String>, Failure> {
    outputs.iter().map(name).collect()
}

/// A setting of `render` as `assemble` takes it, which compares frames with what they would be with the same settings.
fn for_assembly(word: &str) -> Option<String> {
    match word.split_once('=').unwrap_or((word, "")) {
        // How they are made does not show.
        ("--memory" | "--no-reuse", _) => None,
        // What stands below the frames of a filmstrip is called so.
        ("--caption", text) => Some(format!("--frame-caption={text}")),
        _ => Some(word.to_owned()),
    }
}

/// No file may be replaced but a job's.
fn check_place(path: &Path) -> Result<(), Failure> {
    let mut head = Vec::new();
    match fs::File::open(path).and_then(|file| file.take(HEAD).read_to_end(&mut head)) {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
        Ok(_) if String::from_utf8_lossy(&head).contains(MARK) => Ok(()),
        _ => Err(Failure::Bad(format!(
            "{} is there already, and is no job of `kinora farm export`; move it away, or name the sequence otherwise",
            escape::path(path)
        ))),
    }
}

fn write(path: &Path, file: &JobFile) -> Result<(), Failure> {
    let incomplete = |what: String| Failure::Incomplete(what);
    write_file(path, file.text.as_bytes()).map_err(|error| incomplete(error.to_string()))?;
    #[cfg(unix)]
    if file.executable {
        use std::os::unix::fs::PermissionsExt;
        let mode = fs::metadata(path).map(|found| found.permissions().mode());
        // Whoever may read it may run it.
        let made = mode.and_then(|mode| {
            fs::set_permissions(path, fs::Permissions::from_mode(mode | (mode & 0o444) >> 2))
        });
        made.map_err(|error| incomplete(format!("cannot make {} executable: {error}", escape::path(path))))?;
    }
    Ok(())
}

/// A way between folders that are there.
fn found(folder: &Path, way: std::io::Result<PathBuf>) -> Result<PathBuf, Failure> {
    way.map_err(|error| {
        Failure::Bad(format!("cannot find the way to {}: {}", escape::path(folder), files::why(&error)))
    })
}

fn told(job: &Job, export: &Export, frames: usize) -> String {
    let tasks = job.chunks().count() as u64;
    let films: u64 = job.chunks().map(|chunk| chunk.leads.len() as u64).sum();
    let mut lines: Vec<String> =
        export.files.iter().map(|file| format!("wrote   {}", job.beside(&file.name))).collect();
    lines.push(format!(
        "frames  {}, made of {}, in {}",
        count(frames as u64),
        counted(films, "film"),
        counted(tasks, "task")
    ));
    lines.extend(job.assemble().map(|words| format!("then    {}", crate::farm::command(&words))));
    lines.push(format!("submit  {}", export.submit));
    lines.join("\n")
}

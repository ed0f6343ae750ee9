//! `kinora farm export`: writes a render as a job for an engine, beside the sequence file.

use super::job_outputs::{JobOutputs, assembly_source, has_identity};
use crate::base::escape;
use crate::base::files::{self, Root, relative_path as path_between};
use crate::base::frame_set::{self, FrameSet};
use crate::base::units::{count, counted};
use crate::cli::failure::Failure;
use crate::cli::frame_selection::selected_frames;
use crate::cli::loading::LoadingReporter;
use crate::cli::settings::RecordedSettings;
use crate::cli::{load, overrides, terminal, values};
use crate::encode::{Existing, Output, write_file};
use crate::farm::{
    AssembleStep, Engine, Export, FilmCosts, HyperQueue, Job, JobFile, MARK, OpenJd, Shell, Slurm,
    cost_classes, shell_command,
};
use crate::pipeline::filmstrip::spread;
use crate::pipeline::plan::FrameStates;
use crate::pipeline::render::{Request, Reuse, job, pool, requested_aovs};
use crate::sequence::Sequence;
use clap::{Args, ValueEnum};
use std::fs;
use std::io::{ErrorKind, Read};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

/// Write a render as a job for an engine, and print the command that submits it.
#[derive(Args, Debug, PartialEq)]
#[command(after_help = AFTER_HELP)]
pub struct Arguments {
    /// The engine that hands out the work
    #[arg(value_name = "ENGINE")]
    engine: EngineName,

    /// The sequence file (.ron or .json); the job is written into its folder
    file: PathBuf,

    /// File to write, as for `render`; repeat for several files
    ///
    /// Tasks write stills. A final command makes animations from PNGs. If no PNGs are requested,
    /// they are added, in a folder with the name of the animation: out/turn/ for out/turn.mp4.
    #[arg(short, long, value_name = "FILE", value_parser = values::output(), verbatim_doc_comment)]
    output: Vec<Output>,

    /// Also make a filmstrip of nine of the frames
    #[arg(long, value_name = "FILE", value_parser = values::output())]
    filmstrip: Option<Output>,

    /// Frames to render, written as for `render` [default: all]
    #[arg(long, value_name = "SET", allow_hyphen_values = true)]
    frames: Option<FrameSet>,

    /// Approximate number of tasks [default: tasks of similar time, at most 1000]
    ///
    /// Tasks take similar times. Frames that share a film are in one task, because it is traced
    /// only once; so there may be fewer tasks.
    #[arg(long, value_name = "N", verbatim_doc_comment)]
    chunks: Option<NonZeroUsize>,

    /// Maximum number of tasks at the same time [default: the engine decides]
    #[arg(long, value_name = "N", value_parser = values::between(1, u32::MAX))]
    throttle: Option<u32>,

    #[command(flatten)]
    recorded: RecordedSettings,
}

/// Names of engines on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum EngineName {
    /// Open Job Description 2023-09, for AWS Deadline Cloud and others
    Openjd,
    /// Slurm: a job array for sbatch
    Slurm,
    /// HyperQueue: a job file for hq
    Hyperqueue,
    /// A script for one machine, or for several machines that share a folder
    Shell,
}

const AFTER_HELP: &str = "\
Examples:
  kinora farm export slurm turn.ron -t 8 --throttle 50     an array of tasks with 8 processors each
  kinora farm export openjd turn.ron -o out/turn.mp4       frames in out/turn, and a video of them
  kinora farm export shell turn.ron --filmstrip strip.png  also a filmstrip

The job records all options. Its tasks refuse to run with another version of Kinora, or after the
sequence file or a file that it reads has changed. See docs/farm.md.";

/// Number of frames of a filmstrip.
const STRIP_FRAMES: u32 = 9;

/// The first bytes of a job's file, which hold the mark.
const HEAD_BYTES: u64 = 512;

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let settings = &arguments.recorded.settings;
    let options = &settings.options;
    let reporter = LoadingReporter::new(options.progress, options.quiet);
    let (sequence, root) = load::with_files(&arguments.file, options.allow_outside, reporter)?;
    let sequence = overrides::apply(sequence, &settings.overrides()).map_err(Failure::Bad)?;
    let frames = selected_frames(arguments.frames.as_ref(), &sequence)?;
    let job = arguments.job(&sequence, &root, &frames)?;
    let export = arguments.engine().export(&job);
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
    terminal::print_line(&summary(&job, &export, frames.len()))
}

impl Arguments {
    fn engine(&self) -> &'static dyn Engine {
        match self.engine {
            EngineName::Openjd => &OpenJd,
            EngineName::Slurm => &Slurm,
            EngineName::Hyperqueue => &HyperQueue,
            EngineName::Shell => &Shell,
        }
    }

    fn folder(&self) -> &Path {
        self.file.parent().unwrap_or(Path::new(""))
    }

    fn job(&self, sequence: &Sequence, root: &Root, frames: &[u32]) -> Result<Job, Failure> {
        let options = &self.recorded.settings.options;
        let filmstrip = self.filmstrip.as_ref();
        let outputs = JobOutputs { outputs: &self.output, filmstrip, draft: options.draft };
        let (stills, animations) = outputs.resolve(sequence, frames)?;
        self.check(sequence, frames, [&stills[..], &animations].concat())?;
        let here = Path::new("");
        let base = existing(self.folder(), path_between(self.folder(), here))?;
        let down = existing(self.folder(), path_between(here, self.folder()))?;
        let file = down.join(self.file.file_name().unwrap_or_default());
        let fingerprint = load::fingerprint(&self.file, root)?.to_string();
        let root = root.folder().map(|root| existing(root, path_between(here, root))).transpose()?;
        let films = || FilmCosts::of(sequence, frames, requested_aovs(sequence, &stills));
        let films = pool(options.threads)?.install(films);
        Ok(Job {
            name: sequence.name.clone(),
            claims: stills.iter().all(|still| has_identity(still, sequence)),
            folder: self.folder().to_owned(),
            base,
            sequence: file.clone(),
            root,
            fingerprint,
            settings: self.recorded.arguments.clone(),
            frames: frame_set::text(frames),
            stills: names(&stills)?,
            assemblies: self.assemblies((&stills, &animations), frames)?,
            classes: cost_classes(&films, self.chunks.map(NonZeroUsize::get)),
            throttle: self.throttle,
            threads: options.threads.map(|threads| threads.get() as u32),
        })
    }
}

impl Arguments {
    /// Fails if an output cannot be written, because then every task would fail.
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
            job(sequence, &request, &FrameStates::default())
                .check()
                .map_err(|error| Failure::Bad(error.to_string()))
        };
        check(frames, outputs)?;
        // A filmstrip is one picture of several frames.
        self.filmstrip.iter().try_for_each(|strip| check(&frames[..1], vec![strip.clone()]))
    }

    /// The arguments of `kinora assemble` for the animations and for the filmstrip.
    fn assemblies(
        &self,
        (stills, animations): (&[Output], &[Output]),
        frames: &[u32],
    ) -> Result<Vec<AssembleStep>, Failure> {
        let Some(source) = assembly_source(stills) else { return Ok(Vec::new()) };
        let source = name(source)?;
        let step = |set: &[u32], outputs: &[Output]| {
            Ok(AssembleStep {
                source: source.clone(),
                frames: frame_set::text(set),
                settings: self.recorded.arguments.iter().filter_map(|word| for_assembly(word)).collect(),
                outputs: names(outputs)?,
            })
        };
        let moving = (!animations.is_empty()).then(|| step(frames, animations));
        let some: Vec<u32> = spread(frames.len() as u32, STRIP_FRAMES)
            .into_iter()
            .map(|index| frames[index as usize])
            .collect();
        let strip = self.filmstrip.as_ref().map(|strip| step(&some, std::slice::from_ref(strip)));
        moving.into_iter().chain(strip).collect()
    }
}

/// The name of an output. Jobs are text, so it must be UTF-8.
fn name(output: &Output) -> Result<String, Failure> {
    let name = output.name().to_str().map(str::to_owned);
    name.ok_or_else(|| {
        Failure::Bad(format!("jobs are text files, but {output} is not UTF-8; give it another name"))
    })
}

fn names(outputs: &[Output]) -> Result<Vec<String>, Failure> {
    outputs.iter().map(name).collect()
}

/// An option of `render` as an option of `assemble`, which needs the settings of the frames to verify them.
fn for_assembly(word: &str) -> Option<String> {
    match word.split_once('=').unwrap_or((word, "")) {
        // These do not change the frames.
        ("--film-cache" | "--no-reuse", _) => None,
        // In `assemble`, `--caption` is the text below the frames of a filmstrip.
        ("--caption", text) => Some(format!("--frame-caption={text}")),
        _ => Some(word.to_owned()),
    }
}

/// Fails if the file exists and is not part of a job.
fn check_place(path: &Path) -> Result<(), Failure> {
    let mut head = Vec::new();
    match fs::File::open(path).and_then(|file| file.take(HEAD_BYTES).read_to_end(&mut head)) {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
        Ok(_) if String::from_utf8_lossy(&head).contains(MARK) => Ok(()),
        _ => Err(Failure::Bad(format!(
            "{} is there already, and `kinora farm export` has not written it; move it away, or rename the sequence",
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
        // Everyone who may read the file may run it.
        let made = mode.and_then(|mode| {
            fs::set_permissions(path, fs::Permissions::from_mode(mode | (mode & 0o444) >> 2))
        });
        made.map_err(|error| incomplete(format!("cannot make {} executable: {error}", escape::path(path))))?;
    }
    Ok(())
}

/// A path between folders, or the error if one of them does not exist.
fn existing(folder: &Path, path: std::io::Result<PathBuf>) -> Result<PathBuf, Failure> {
    path.map_err(|error| {
        Failure::Bad(format!("cannot find the folder {}: {}", escape::path(folder), files::describe(&error)))
    })
}

fn summary(job: &Job, export: &Export, frames: usize) -> String {
    let tasks = job.chunks().count() as u64;
    let films: u64 = job.chunks().map(|chunk| chunk.first_frames.len() as u64).sum();
    let mut lines: Vec<String> =
        export.files.iter().map(|file| format!("wrote   {}", job.path_of(&file.name))).collect();
    lines.push(format!(
        "frames  {}, made from {}, in {}",
        count(frames as u64),
        counted(films, "film"),
        counted(tasks, "task")
    ));
    lines.extend(job.assemble().map(|words| format!("then    {}", shell_command(&words))));
    lines.push(format!("submit  {}", export.submit));
    lines.join("\n")
}

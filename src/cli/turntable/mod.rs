//! `kinora turntable`: one turn around the parts in mesh and glTF files. It writes a sequence and renders that.

mod parts;
mod scene;
mod written;

use super::failure::Failure;
use super::loading::{self, LoadingReporter};
use super::observe::{Observation, ObserveOptions, observed};
use super::settings::RecordedSettings;
use super::time_limit::{self, TimeLimitOption};
use super::{overrides, render, terminal, values};
use crate::base::escape;
use crate::base::files::Root;
use crate::base::time::Rate;
use crate::encode::{Existing, Output};
use crate::pipeline::render::Request;
use crate::sequence::{Sequence, load_text};
use clap::{Arg, Args, ValueEnum};
use parts::Part;
use scene::Scene;
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;
use written::Written;

/// Render one turn of a part, or of several parts together, from mesh or glTF files.
#[derive(Args, Debug, PartialEq)]
#[command(after_help = AFTER_HELP, mut_arg("size", describe_size), mut_arg("fps", describe_rate))]
pub struct Arguments {
    /// The parts: .stl, .obj, .ply, .glb, .gltf, .vtk, .vtp, .vtu, .pvtp or .pvtu files, which share their coordinates
    #[arg(required = true, value_name = "PART")]
    parts: Vec<PathBuf>,

    /// File to write; repeat for several files [default: output/PART.gif]
    ///
    /// As for `kinora render`: .gif, .mp4, .apng, .webp, or one picture per frame: f_####.png.
    #[arg(short, long, value_name = "FILE", value_parser = values::output())]
    output: Vec<Output>,

    /// Also write the sequence that is rendered, to edit it and go on with `kinora render`
    #[arg(long, value_name = "FILE")]
    write: Option<PathBuf>,

    /// Number of frames of the turn
    #[arg(long, value_name = "N", default_value = "60", value_parser = values::between(1, MAX_FRAMES))]
    frames: u32,

    /// The axis of the files that points up: y or z [default: z for .stl, y for others]
    #[arg(long, value_enum, value_name = "AXIS")]
    up: Option<Up>,

    #[command(flatten)]
    recorded: RecordedSettings,

    #[command(flatten)]
    limit: TimeLimitOption,

    #[command(flatten)]
    observe: ObserveOptions,
}

/// An upward axis of files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Up {
    Y,
    Z,
}

/// The largest number of frames of a sequence.
const MAX_FRAMES: u32 = 10_000_000;

/// The size of the pictures, unless options say otherwise.
const SIZE: (u32, u32) = (640, 480);

/// The settings of the sequence, unless options say otherwise.
const BOUNCES: u32 = 1;
const ANTIALIAS: u32 = 1;

fn describe_size(option: Arg) -> Arg {
    let (width, height) = SIZE;
    option.help(format!("Width and height in pixels, such as 1280x720 [default: {width}x{height}]"))
}

fn describe_rate(option: Arg) -> Arg {
    let help = format!("Frames per second: 24, 29.97 or 30000/1001 [default: {}]", default_rate());
    option.long_help(format!("{help}\n\nThe turn keeps its number of frames.")).help(help)
}

/// 20 frames per second: GIFs show them exactly, and a turn of 60 frames takes 3 s.
fn default_rate() -> Rate {
    Rate::new(20, 1).unwrap_or_default()
}

const AFTER_HELP: &str = "\
Examples:
  kinora turntable part.stl -o part.gif
  kinora turntable body.stl lid.stl -o box.mp4 -s 1280x720 --frames 120 -r 30
  kinora turntable scan.ply --up z -o scan.gif
  kinora turntable part.stl --write part.ron         the sequence, to change light, colours and camera

The camera is fitted to the parts. Parts without colours of their own get some. All options of
`kinora render` that change pictures apply.";

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    observed(&arguments.observe, |observation| rendered(arguments, observation))
}

fn rendered(arguments: &Arguments, observation: &Observation) -> Result<(), Failure> {
    let settings = &arguments.recorded.settings;
    let options = &settings.options;
    let (sequence, written) = tracing::info_span!("read").in_scope(|| arguments.sequence())?;
    let mut sequence = overrides::apply(sequence, &settings.overrides()).map_err(Failure::Bad)?;
    let outputs = match arguments.output.is_empty() {
        true => sequence.output.files.clone(),
        false => arguments.output.clone(),
    };
    terminal::check_stream(&outputs)?;
    let request = Request {
        outputs,
        confined: arguments.output.is_empty(),
        existing: Existing::Keep,
        frames: (0..sequence.timeline.frames).collect(),
        threads: options.threads,
        reuse: settings.reuse(),
        time_limit: arguments.limit.time_limit,
    };
    for part in &arguments.parts {
        observation.open_check(part)?;
    }
    observation.open(&arguments.path()?, &request.outputs, &request.frames)?;
    let limit_note = time_limit::apply(&mut sequence, &request, options.quiet)?;
    let mut done = render::with_progress(options, &sequence, &request)?;
    if let Some(written) = written {
        // Last, so that a failed turn leaves no file in the way of the next one.
        written.write()?;
        done.notes.push(written.note);
    }
    done.notes.extend(limit_note);
    if options.draft {
        done.notes.insert(0, render::draft_note(&sequence));
    }
    render::print(options, &done, &request.outputs)
}

impl Arguments {
    /// The sequence, and its file if there is one to be written.
    fn sequence(&self) -> Result<(Sequence, Option<Written>), Failure> {
        let options = &self.recorded.settings.options;
        // The user names all files, so they may be anywhere.
        let root = Root::anywhere();
        let meter = Arc::default();
        let path = self.path()?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let reporter = || LoadingReporter::new(options.progress, options.quiet);
        let parts = loading::watch(&meter, reporter(), || self.parts(folder, &root, &meter))?;
        let text = Scene {
            parts: &parts,
            files: &self.files(&path),
            frames: self.frames,
            rate: options.fps.unwrap_or_else(default_rate),
            size: options.size.unwrap_or(SIZE),
            bounces: options.bounces.unwrap_or(BOUNCES),
            antialias: options.antialias.unwrap_or(ANTIALIAS),
        }
        .text();
        let load = || load_text(&path, &text, root.clone(), &meter);
        let sequence = loading::watch(&meter, reporter(), load);
        let sequence = sequence.map_err(|error| Failure::Faults(error.render(terminal::color())))?;
        if self.write.is_none() {
            return Ok((sequence, None));
        }
        let inside = Root::of(folder);
        let outside = root.admitted().iter().any(|file| inside.admit(file).is_err());
        let note = written::note(&path, outside, &self.recorded);
        let written = Written { path, text, note };
        written.check()?;
        Ok((sequence, Some(written)))
    }

    /// The path of the sequence, whether it is written or not.
    fn path(&self) -> Result<PathBuf, Failure> {
        let Some(path) = &self.write else {
            let stem = self.parts[0].file_stem().unwrap_or_default();
            return Ok(Path::new(stem).with_extension("ron"));
        };
        if path.extension().is_none_or(|extension| extension != "ron") {
            return Err(Failure::Bad(format!(
                "--write: a sequence is a .ron file, not {}",
                escape::path(path)
            )));
        }
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        match folder.filter(|folder| !folder.is_dir()) {
            Some(folder) => {
                Err(Failure::Bad(format!("--write: there is no folder {}", escape::path(folder))))
            }
            None => Ok(path.clone()),
        }
    }

    fn parts(
        &self,
        folder: &Path,
        root: &Root,
        meter: &Arc<crate::import::LoadProgress>,
    ) -> Result<Vec<Part>, Failure> {
        let part = |file: &PathBuf| {
            let from = if self.write.is_some() { Some(folder) } else { None };
            let part = Part::load(file, from, self.up, root, meter);
            part.map_err(|why| Failure::Bad(format!("cannot read {}: {why}", escape::path(file))))
        };
        self.parts.iter().map(part).collect()
    }

    /// The files that the sequence names: those of the command line that a sequence may name, or a default.
    fn files(&self, path: &Path) -> Vec<String> {
        let names = self.output.iter().filter_map(nameable);
        let names: Vec<String> = names.collect();
        if names.is_empty() {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy().replace(['#', '%'], "_");
            return vec![format!("output/{stem}.gif")];
        }
        names
    }
}

/// The name of a file, if a sequence may name it: sequences write below the working directory only, and are UTF-8.
fn nameable(output: &Output) -> Option<String> {
    let file = output.name();
    let inside = |part: Component| matches!(part, Component::Normal(_) | Component::CurDir);
    let is_file = !matches!(output, Output::Stream(_));
    (is_file && file.components().all(inside)).then(|| file.to_str().map(str::to_owned)).flatten()
}

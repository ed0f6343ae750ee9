//! `kinora farm status`: which frames of a job are done, and who has the others in hand.

use super::stills::Wanted;
use crate::base::escape;
use crate::base::frame_set::{self, FrameSet};
use crate::base::units::{count, rough_time};
use crate::cli::failure::Failure;
use crate::cli::json::Object;
use crate::cli::render::frames_of;
use crate::cli::settings::Settings;
use crate::cli::{load, loading, overrides, terminal, values};
use crate::encode::{Existing, Found, Holder, Output, found, in_hand};
use crate::farm::{Frame, Status};
use crate::pipeline::plan::{Plan, samples};
use crate::pipeline::render::{Request, Reuse, extras, job, pool};
use crate::sequence::Sequence;
use clap::Args;
use std::path::{Path, PathBuf};

/// Tell which frames are done, stale, missing or in work, and how long the rest will take.
#[derive(Args, Debug, PartialEq)]
#[command(after_help = AFTER_HELP)]
pub struct Arguments {
    /// The folder that the frames go into
    folder: PathBuf,

    /// The sequence file (.ron)
    file: PathBuf,

    /// The frames' files as the job has them: their names count [default: as the sequence says]
    #[arg(short, long, value_name = "FILE", value_parser = values::output())]
    output: Vec<Output>,

    /// The frames of the job [default: all]
    #[arg(long, value_name = "SET", allow_hyphen_values = true)]
    frames: Option<FrameSet>,

    /// One JSON object, for programs
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    settings: Settings,
}

const AFTER_HELP: &str = "\
Examples:
  kinora farm status out/turn turn.ron               what there is of turn.ron in out/turn
  kinora farm status out turn.ron -s 640x360         of a job with another size: settings count
  kinora farm status out turn.ron --json             for programs

Stale frames are there, but would be made otherwise now: by another version, of another sequence
file, or with other settings.";

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let settings = &arguments.settings;
    let options = &settings.options;
    if arguments.folder.is_file() {
        return Err(Failure::Bad(format!(
            "{} is a file; the frames' folder comes first, then the sequence file",
            escape::path(&arguments.folder)
        )));
    }
    let loading = loading::Reporter::new(options.progress, options.quiet);
    let sequence = load::sequence(&arguments.file, options.allow_outside, loading)?;
    let sequence = overrides::applied(sequence, &settings.overrides()).map_err(Failure::Bad)?;
    let numbers = frames_of(arguments.frames.as_ref(), &sequence)?;
    let stills = arguments.stills(&sequence, &numbers)?;
    let names = stills.first().map(ToString::to_string).unwrap_or_default();
    let status = arguments.status(&sequence, numbers, stills)?;
    terminal::say(&if arguments.json { json(&status) } else { text(&status, &names) })
}

impl Arguments {
    /// The frames' files in the folder.
    fn stills(&self, sequence: &Sequence, numbers: &[u32]) -> Result<Vec<Output>, Failure> {
        let draft = self.settings.options.draft;
        let wanted = Wanted { outputs: &self.output, filmstrip: None, draft };
        let (stills, _) = wanted.of(sequence, numbers)?;
        self.check_folder(&stills)?;
        stills.iter().map(|still| self.placed(still)).collect()
    }

    fn status(&self, sequence: &Sequence, numbers: Vec<u32>, stills: Vec<Output>) -> Result<Status, Failure> {
        let options = &self.settings.options;
        let Some(first) = stills.first().cloned() else { return Ok(Status::default()) };
        let pool = pool(options.threads)?;
        let films = extras(sequence, &stills);
        let request = Request {
            frames: numbers,
            outputs: stills,
            confined: false,
            existing: Existing::Share,
            threads: options.threads,
            reuse: Reuse::Off,
            time_limit: None,
        };
        let (plan, job) = pool.install(|| {
            let plan = Plan::new(sequence, &request.frames, films, u64::MAX);
            let job = job(sequence, &request, &plan.survey);
            (plan, job)
        });
        let found = found(&job, &pool).map_err(|error| Failure::Bad(error.to_string()))?;
        let frame = |(place, found): (usize, Found)| {
            let look = &plan.survey.frames[place];
            let shares = plan.takes[plan.of[place]].frames.len() as f64;
            let work = samples(sequence, look) as f64 / shares;
            Frame { number: look.frame, film: look.transport, work, found }
        };
        let frames: Vec<Frame> = found.into_iter().enumerate().map(frame).collect();
        Ok(Status::of(&frames, |film| in_hand(&first, film)))
    }

    /// The folder must be there; where it is not, says where the frames go.
    fn check_folder(&self, stills: &[Output]) -> Result<(), Failure> {
        if self.folder.is_dir() {
            return Ok(());
        }
        let own = stills.first().map(|still| still.path(0)).unwrap_or_default();
        let own = own.parent().filter(|own| !own.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let (folder, file) = (escape::path(&self.folder), escape::path(&self.file));
        Err(Failure::Bad(if own == self.folder {
            format!("there is no folder {folder} yet; it appears with the first task of the job")
        } else {
            format!(
                "there is no folder {folder}; the frames of {file} go into {}, or where -o says",
                escape::path(own)
            )
        }))
    }

    /// The files of this name in the folder.
    fn placed(&self, still: &Output) -> Result<Output, Failure> {
        let name = still.name().file_name().unwrap_or_default();
        Output::parse(self.folder.join(name)).map_err(|error| Failure::Bad(error.to_string()))
    }
}

/// What there is of files that are called like this.
fn text(status: &Status, names: &str) -> String {
    let Status { done, stale, missing, in_work, left } = status;
    let working: usize = in_work.iter().map(|(_, frames)| frames.len()).sum();
    let all = done.len() + stale.len() + missing.len() + working;
    let mut lines = vec![format!(
        "frames  {}: {} done, {} in work, {} stale, {} missing",
        count(all as u64),
        count(done.len() as u64),
        count(working as u64),
        count(stale.len() as u64),
        count(missing.len() as u64)
    )];
    for (place, (holder, frames)) in in_work.iter().enumerate() {
        let heading = if place == 0 { "in work" } else { "" };
        lines.push(format!("{heading:<7} {} {}", frame_set::text(frames), who(holder)));
    }
    for (heading, frames) in [("stale", stale), ("missing", missing)] {
        if !frames.is_empty() {
            lines.push(format!("{heading:<7} {}", frame_set::text(frames)));
        }
    }
    if missing.len() == all {
        lines.push(format!(
            "note    there is no file {names}; if the job's are called otherwise, say how with -o"
        ));
    }
    if let Some(left) = left.filter(|_| done.len() < all) {
        lines.push(format!("left    {}, if it goes on as so far", rough_time(left)));
    }
    lines.join("\n")
}

/// `by process 4711 on build-7, heard of 3 s ago`.
fn who(holder: &Holder) -> String {
    let silent = rough_time(holder.silent);
    match &holder.process {
        Some(process) => format!("by process {} on {}, heard of {silent} ago", process.id, process.host),
        None => format!("by somebody, heard of {silent} ago"),
    }
}

fn json(status: &Status) -> String {
    let Status { done, stale, missing, in_work, left } = status;
    let list = |frames: &[u32]| {
        Object::new().whole("count", frames.len() as u64).text("frames", &frame_set::text(frames))
    };
    let working = in_work.iter().map(|(holder, frames)| {
        let object = list(frames).real("silent_s", Some(holder.silent.as_secs_f64()));
        match &holder.process {
            Some(process) => object.text("host", &process.host).whole("process", process.id.into()),
            None => object,
        }
    });
    Object::new()
        .text("event", "status")
        .object("done", list(done))
        .objects("in_work", working)
        .object("stale", list(stale))
        .object("missing", list(missing))
        .real("left_s", left.map(|left| left.as_secs_f64()))
        .finish()
}

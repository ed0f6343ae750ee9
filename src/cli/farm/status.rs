//! `kinora farm status`: which frames of a job are done, and which processes have claimed others.

use super::job_outputs::JobOutputs;
use crate::base::escape;
use crate::base::frame_set::{self, FrameSet};
use crate::base::units::{count, rough_time};
use crate::cli::failure::Failure;
use crate::cli::frame_selection::selected_frames;
use crate::cli::json::{line, object, rounded};
use crate::cli::loading::LoadingReporter;
use crate::cli::settings::Settings;
use crate::cli::{load, overrides, terminal, values};
use crate::encode::{Existing, FrameStatus, LeaseHolder, Output, frame_statuses, lease_holder};
use crate::farm::{JobFrame, JobStatus};
use crate::pipeline::plan::{Plan, camera_rays};
use crate::pipeline::render::{Request, Reuse, job, pool, requested_aovs};
use crate::sequence::Sequence;
use clap::Args;
use serde_json::json;
use std::path::{Path, PathBuf};

/// List the frames that are done, stale, missing or in work, and estimate the time left.
#[derive(Args, Debug, PartialEq)]
#[command(after_help = AFTER_HELP, mut_arg("film_cache", |argument| argument.hide(true)), mut_arg("no_reuse", |argument| argument.hide(true)))]
pub struct Arguments {
    /// The folder of the frames
    folder: PathBuf,

    /// The sequence file (.ron or .json)
    file: PathBuf,

    /// File names of the frames as in the job, without their folder [default: as in the file]
    #[arg(short, long, value_name = "FILE", value_parser = values::output())]
    output: Vec<Output>,

    /// The frames of the job [default: all]
    #[arg(long, value_name = "SET", allow_hyphen_values = true)]
    frames: Option<FrameSet>,

    /// Print one JSON object, for programs
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    settings: Settings,
}

const AFTER_HELP: &str = "\
Examples:
  kinora farm status out/turn turn.ron               the frames of turn.ron in out/turn
  kinora farm status out turn.ron -s 640x360         give the same settings as for the job
  kinora farm status out turn.ron --json             for programs

A stale frame was rendered with another version, file or setting.";

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let settings = &arguments.settings;
    let options = &settings.options;
    if arguments.folder.is_file() {
        return Err(Failure::Bad(format!(
            "{} is a file; the frames' folder comes first, then the sequence file",
            escape::path(&arguments.folder)
        )));
    }
    let reporter = LoadingReporter::new(options.progress, options.quiet);
    let sequence = load::sequence(&arguments.file, options.allow_outside, reporter)?;
    let sequence = overrides::apply(sequence, &settings.overrides()).map_err(Failure::Bad)?;
    let numbers = selected_frames(arguments.frames.as_ref(), &sequence)?;
    let stills = arguments.stills(&sequence, &numbers)?;
    let names = stills.first().map(ToString::to_string).unwrap_or_default();
    let status = arguments.status(&sequence, numbers, stills)?;
    terminal::print_line(&if arguments.json { json(&status) } else { text(&status, &names) })
}

impl Arguments {
    /// The frames' files, in the folder of the command line.
    fn stills(&self, sequence: &Sequence, numbers: &[u32]) -> Result<Vec<Output>, Failure> {
        let draft = self.settings.options.draft;
        let outputs = JobOutputs { outputs: &self.output, filmstrip: None, draft };
        let (stills, _) = outputs.resolve(sequence, numbers)?;
        self.check_folder(&stills)?;
        stills.iter().map(|still| self.placed(still)).collect()
    }

    fn status(
        &self,
        sequence: &Sequence,
        numbers: Vec<u32>,
        stills: Vec<Output>,
    ) -> Result<JobStatus, Failure> {
        let options = &self.settings.options;
        let Some(first) = stills.first().cloned() else { return Ok(JobStatus::default()) };
        let pool = pool(options.threads)?;
        let films = requested_aovs(sequence, &stills);
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
            let job = job(sequence, &request, &plan.states);
            (plan, job)
        });
        let statuses = frame_statuses(&job, &pool).map_err(|error| Failure::Bad(error.to_string()))?;
        let frame = |(place, status): (usize, FrameStatus)| {
            let state = &plan.states.frames[place];
            let shares = plan.films[plan.film_of[place]].frames.len() as f64;
            let work = camera_rays(sequence, state) as f64 / shares;
            JobFrame { number: state.frame, film: state.scene_hash, work, status }
        };
        let frames: Vec<JobFrame> = statuses.into_iter().enumerate().map(frame).collect();
        Ok(JobStatus::of(&frames, |film| lease_holder(&first, film)))
    }

    /// Fails if the folder does not exist. The error says where the frames go.
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
                "there is no folder {folder}; the frames of {file} are in {}, unless the job was exported with -o: then \
                 pass the job's -o",
                escape::path(own)
            )
        }))
    }

    /// Files of the same name in the folder.
    fn placed(&self, still: &Output) -> Result<Output, Failure> {
        let name = still.name().file_name().unwrap_or_default();
        Output::parse(self.folder.join(name)).map_err(|error| Failure::Bad(error.to_string()))
    }
}

/// The status in lines. `names` is the pattern of the frames' file names.
fn text(status: &JobStatus, names: &str) -> String {
    let JobStatus { done, stale, missing, in_work, left } = status;
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
            "note    there is no file {names}; if the job was exported with -o, pass the job's -o"
        ));
    }
    if let Some(left) = left.filter(|_| done.len() < all) {
        lines.push(format!("left    about {} at the rate so far", rough_time(left)));
    }
    lines.join("\n")
}

/// `by process 4711 on build-7, last sign of life 3 s ago`.
fn who(holder: &LeaseHolder) -> String {
    let silent = rough_time(holder.idle);
    match &holder.process {
        Some(process) => {
            format!("by process {} on {}, last sign of life {silent} ago", process.id, process.host)
        }
        None => format!("by an unknown process, last sign of life {silent} ago"),
    }
}

fn json(status: &JobStatus) -> String {
    let JobStatus { done, stale, missing, in_work, left } = status;
    let list = |frames: &[u32]| json!({ "count": frames.len(), "frames": frame_set::text(frames) });
    let working = in_work.iter().map(|(holder, frames)| {
        let mut entry = object(list(frames));
        entry.insert("silent_s".to_owned(), rounded(holder.idle.as_secs_f64()));
        if let Some(process) = &holder.process {
            entry.extend(object(json!({ "host": process.host, "process": process.id })));
        }
        entry
    });
    line(json!({
        "event": "status",
        "done": list(done),
        "in_work": working.collect::<Vec<_>>(),
        "stale": list(stale),
        "missing": list(missing),
        "left_s": left.map(|left| rounded(left.as_secs_f64())),
    }))
}

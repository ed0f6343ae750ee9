//! Jobs for engines that read Open Job Description, version 2023-09, with the extension `TASK_CHUNKING`
//! (<https://github.com/OpenJobDescription/openjd-specifications>, RFC 0001).
//!
//! The engine forms the chunks, and may change their size while it learns how long tasks take. So a task is a film,
//! named by its first frame, and any chunk of films is valid. `--include-shared` adds the other frames of each film.

use super::chunk::CostClass;
use super::job::{Engine, Export, Job, JobFile, MARK, Naming};
use super::shell_words::shell_command;
use crate::base::escape::quoted;
use crate::base::frame_set;
use std::cell::RefCell;

/// Seconds that a cancelled task has to finish its current frame.
const GRACE_SECONDS: u32 = 120;

/// The longest name that a job may have, in characters.
const MAX_NAME: usize = 128;

/// Open Job Description, 2023-09.
pub struct OpenJd;

impl Engine for OpenJd {
    fn export(&self, job: &Job) -> Export {
        let name = format!("{}.openjd.yaml", job.name);
        let mut submit: Vec<String> = ["openjd", "run", &job.path_of(&name)].map(str::to_owned).to_vec();
        if !job.base.as_os_str().is_empty() {
            submit.extend(["-p".to_owned(), "Folder=.".to_owned()]);
        }
        let assets = assets_elsewhere(job).map(|root| format!("Assets={root}"));
        submit.extend(assets.into_iter().flat_map(|word| ["-p".to_owned(), word]));
        let files = vec![JobFile { name, text: text(job), executable: false }];
        Export { files, submit: shell_command(&submit) }
    }
}

/// The folder of the files that the sequence reads, if it is not the job's own. Relative to `base`.
fn assets_elsewhere(job: &Job) -> Option<String> {
    let root = job.root.as_ref()?;
    let own = job.sequence.parent().is_some_and(|folder| folder == root);
    (!own).then(|| {
        if root.as_os_str().is_empty() { ".".to_owned() } else { root.to_string_lossy().into_owned() }
    })
}

/// Writes names as parameters of the job.
#[derive(Default)]
struct Parameters {
    /// Words with double braces. Format strings would interpret them, so they become the defaults of parameters, which
    /// are not format strings.
    words: RefCell<Vec<String>>,
}

impl Naming for Parameters {
    fn sequence(&self, _: &Job) -> String {
        "{{Param.Sequence}}".to_owned()
    }

    fn file(&self, name: &str) -> String {
        let name = self.word(name);
        if name.starts_with('/') { name } else { format!("{{{{Param.Folder}}}}/{name}") }
    }

    fn word(&self, word: &str) -> String {
        if !word.contains("{{") && !word.contains("}}") {
            return word.to_owned();
        }
        let mut words = self.words.borrow_mut();
        let place = words.iter().position(|known| known == word).unwrap_or(words.len());
        if place == words.len() {
            words.push(word.to_owned());
        }
        format!("{{{{Param.Word{}}}}}", place + 1)
    }
}

fn text(job: &Job) -> String {
    let naming = Parameters::default();
    let classes = job.classes.len();
    let step = |(place, class): (usize, &CostClass)| {
        let name = if classes == 1 { "Frames".to_owned() } else { format!("Frames {}", place + 1) };
        (frames_step(job, &naming, &name, class), name)
    };
    let (mut steps, steps_before): (Vec<String>, Vec<String>) =
        job.classes.iter().enumerate().map(step).unzip();
    for (place, words) in job.assemble_with(&naming).enumerate() {
        let name =
            if job.assemblies.len() == 1 { "Files".to_owned() } else { format!("Files {}", place + 1) };
        steps.push(files_step(job, &name, &steps_before, &words));
    }
    let file = job.sequence.file_name().unwrap_or_default().to_string_lossy();
    let mut text = format!(
        "# {MARK}. File names are relative to the parameter Folder, by default the folder of this file:\n\
         #     {}\n\
         specificationVersion: jobtemplate-2023-09\n\
         extensions: [TASK_CHUNKING]\n\
         name: {}\n\
         description: {}\n\
         parameterDefinitions:\n",
        submit_line(job),
        quoted(&name(job)),
        quoted(&format!("Frames {} of {file}, rendered by Kinora.", job.frames)),
    );
    text += &path("Folder", "DIRECTORY", "INOUT", ".", "The folder that file names are relative to.");
    text += &path("Sequence", "FILE", "IN", &file, "The sequence to render.");
    if job.root.is_some() {
        text += &path("Assets", "DIRECTORY", "IN", ".", "Holds the sequence and all files that it reads.");
    }
    for (place, word) in (1..).zip(naming.words.borrow().iter()) {
        text += &format!("  - name: Word{place}\n    type: STRING\n    default: {}\n", quoted(word));
    }
    text + "steps:\n" + &steps.concat()
}

/// The command that submits the job from the folder in which its commands run.
fn submit_line(job: &Job) -> String {
    let mut words = vec!["openjd".to_owned(), "run".to_owned()];
    let file = job.sequence.with_file_name(format!("{}.openjd.yaml", job.name));
    words.extend([file.to_string_lossy().into_owned(), "-p".to_owned(), "Folder=.".to_owned()]);
    shell_command(&words)
}

fn name(job: &Job) -> String {
    // Engines interpret double braces.
    job.name.replace("{{", "{ {").chars().filter(|letter| !letter.is_control()).take(MAX_NAME).collect()
}

/// The definition of a parameter that holds a path.
fn path(name: &str, kind: &str, flow: &str, default: &str, what: &str) -> String {
    format!(
        "  - name: {name}\n    type: PATH\n    objectType: {kind}\n    dataFlow: {flow}\n    default: {}\n    \
         description: {}\n",
        quoted(default),
        quoted(what)
    )
}

/// A step that renders the films of a class.
fn frames_step(job: &Job, naming: &Parameters, name: &str, class: &CostClass) -> String {
    let mut words = job.render_with(naming, "{{Task.Param.Frame}}");
    let mut first_frames: Vec<u32> =
        class.chunks.iter().flat_map(|chunk| &chunk.first_frames).copied().collect();
    first_frames.sort_unstable();
    if class.chunks.iter().any(|chunk| chunk.frames.len() > chunk.first_frames.len()) {
        words.extend(["--include-shared".to_owned(), job.frames.clone()]);
    }
    words.extend(["--progress".to_owned(), "openjd".to_owned()]);
    let space = format!(
        "    parameterSpace:\n      taskParameterDefinitions:\n        - name: Frame\n          type: CHUNK[INT]\n          \
         range: {}\n          chunks:\n            defaultTaskCount: {}\n            rangeConstraint: NONCONTIGUOUS\n",
        quoted(&frame_set::text(&first_frames)),
        class.films_per_chunk
    );
    step(job, name, &space, words)
}

/// A step that assembles the frames of the steps `after`.
fn files_step(job: &Job, name: &str, after: &[String], words: &[String]) -> String {
    let after: String = after.iter().map(|name| format!("      - dependsOn: {}\n", quoted(name))).collect();
    step(job, name, &format!("    dependencies:\n{after}"), words.to_vec())
}

fn step(job: &Job, name: &str, what: &str, mut words: Vec<String>) -> String {
    let threads = job.threads.map_or_else(String::new, |threads| {
        words.push(format!("--threads={threads}"));
        format!("    hostRequirements:\n      amounts:\n        - name: amount.worker.vcpu\n          min: {threads}\n")
    });
    let arguments: String =
        words.iter().skip(1).map(|word| format!("            - {}\n", quoted(word))).collect();
    format!(
        "  - name: {}\n{what}{threads}    script:\n      actions:\n        onRun:\n          command: {}\n          \
         args:\n{arguments}          cancelation:\n            mode: NOTIFY_THEN_TERMINATE\n            \
         notifyPeriodInSeconds: {GRACE_SECONDS}\n",
        quoted(name),
        words[0]
    )
}

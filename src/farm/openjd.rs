//! Jobs for engines that read Open Job Description, version 2023-09, with the extension `TASK_CHUNKING`
//! (<https://github.com/OpenJobDescription/openjd-specifications>, RFC 0001).
//!
//! An engine forms chunks by itself, as many tasks at a time as it is told, and may choose another number while it learns
//! how long they take. So its tasks are films, each by its first frame: every chunk of them is as good as any other. The
//! other frames of a film come along by `--with-shared`.

use super::chunk::Class;
use super::job::{Export, Job, JobFile, MARK, Names};
use super::words::command;
use crate::base::escape::quoted;
use crate::base::frame_set;
use std::cell::RefCell;

/// Seconds that a frame in hand is given when a task is cancelled.
const PATIENCE: u32 = 120;

/// Letters of a job's name, at most.
const LONGEST: usize = 128;

pub fn export(job: &Job) -> Export {
    let name = format!("{}.openjd.yaml", job.name);
    let mut submit: Vec<String> = ["openjd", "run", &job.beside(&name)].map(str::to_owned).to_vec();
    if !job.base.as_os_str().is_empty() {
        submit.extend(["-p".to_owned(), "Folder=.".to_owned()]);
    }
    submit.extend(
        assets_elsewhere(job)
            .map(|root| format!("Assets={root}"))
            .into_iter()
            .flat_map(|word| ["-p".to_owned(), word]),
    );
    Export { files: vec![JobFile { name, text: text(job), executable: false }], submit: command(&submit) }
}

/// The folder of what the sequence reads, from where the export runs, if that is not the job's own.
fn assets_elsewhere(job: &Job) -> Option<String> {
    let root = job.root.as_ref()?;
    let own = job.sequence.parent().is_some_and(|folder| folder == root);
    (!own).then(|| {
        if root.as_os_str().is_empty() { ".".to_owned() } else { root.to_string_lossy().into_owned() }
    })
}

/// Names as parameters, and as format strings read them.
#[derive(Default)]
struct Parameters {
    /// Words with braces, which format strings would take for theirs: they are defaults of parameters, which are none.
    words: RefCell<Vec<String>>,
}

impl Names for Parameters {
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
    let names = Parameters::default();
    let classes = job.classes.len();
    let step = |(place, class): (usize, &Class)| {
        let name = if classes == 1 { "Frames".to_owned() } else { format!("Frames {}", place + 1) };
        (frames(job, &names, &name, class), name)
    };
    let (mut steps, steps_before): (Vec<String>, Vec<String>) =
        job.classes.iter().enumerate().map(step).unzip();
    for (place, words) in job.assemble_in(&names).enumerate() {
        let name =
            if job.assemblies.len() == 1 { "Files".to_owned() } else { format!("Files {}", place + 1) };
        steps.push(files(job, &name, &steps_before, &words));
    }
    let file = job.sequence.file_name().unwrap_or_default().to_string_lossy();
    let mut text = format!(
        "# {MARK}. File names begin at Folder, which is this file's unless it is said:\n\
         #     {}\n\
         specificationVersion: jobtemplate-2023-09\n\
         extensions: [TASK_CHUNKING]\n\
         name: {}\n\
         description: {}\n\
         parameterDefinitions:\n",
        export_line(job),
        quoted(&name(job)),
        quoted(&format!("Frames {} of {file}, rendered by Kinora.", job.frames)),
    );
    text += &path("Folder", "DIRECTORY", "INOUT", ".", "Where the names of files begin.");
    text += &path("Sequence", "FILE", "IN", &file, "What is rendered.");
    if job.root.is_some() {
        text +=
            &path("Assets", "DIRECTORY", "IN", ".", "Holds all files that the sequence reads, and itself.");
    }
    for (place, word) in (1..).zip(names.words.borrow().iter()) {
        text += &format!("  - name: Word{place}\n    type: STRING\n    default: {}\n", quoted(word));
    }
    text + "steps:\n" + &steps.concat()
}

/// The command that submits the job, from the folder in which the export ran.
fn export_line(job: &Job) -> String {
    let mut words = vec!["openjd".to_owned(), "run".to_owned()];
    let file = job.sequence.with_file_name(format!("{}.openjd.yaml", job.name));
    words.extend([file.to_string_lossy().into_owned(), "-p".to_owned(), "Folder=.".to_owned()]);
    command(&words)
}

fn name(job: &Job) -> String {
    // An engine would take braces for its own.
    job.name.replace("{{", "{ {").chars().filter(|letter| !letter.is_control()).take(LONGEST).collect()
}

fn path(name: &str, kind: &str, flow: &str, default: &str, what: &str) -> String {
    format!(
        "  - name: {name}\n    type: PATH\n    objectType: {kind}\n    dataFlow: {flow}\n    default: {}\n    \
         description: {}\n",
        quoted(default),
        quoted(what)
    )
}

/// A step that renders a class of films.
fn frames(job: &Job, names: &Parameters, name: &str, class: &Class) -> String {
    let mut words = job.render_in(names, "{{Task.Param.Frame}}");
    let mut leads: Vec<u32> = class.chunks.iter().flat_map(|chunk| &chunk.leads).copied().collect();
    leads.sort_unstable();
    if class.chunks.iter().any(|chunk| chunk.frames.len() > chunk.leads.len()) {
        words.extend(["--with-shared".to_owned(), job.frames.clone()]);
    }
    words.extend(["--progress".to_owned(), "openjd".to_owned()]);
    let space = format!(
        "    parameterSpace:\n      taskParameterDefinitions:\n        - name: Frame\n          type: CHUNK[INT]\n          \
         range: {}\n          chunks:\n            defaultTaskCount: {}\n            rangeConstraint: NONCONTIGUOUS\n",
        quoted(&frame_set::text(&leads)),
        class.films
    );
    step(job, name, &space, words)
}

/// A step that assembles what others have rendered.
fn files(job: &Job, name: &str, after: &[String], words: &[String]) -> String {
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
         notifyPeriodInSeconds: {PATIENCE}\n",
        quoted(name),
        words[0]
    )
}

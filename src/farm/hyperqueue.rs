//! Jobs for HyperQueue: a job definition file, with a task for each chunk, and one for each file that is assembled of what
//! they made.

use super::job::{Export, Job, JobFile, MARK, THREADS};
use super::words;
use crate::base::escape::quoted;
use std::path::Path;

/// Workers that may be lost while they have the same task.
const CRASHES: u32 = 20;

pub fn export(job: &Job) -> Export {
    let name = format!("{}.hq.toml", job.name);
    let submit = format!("hq job submit-file {}", words::quoted(&job.beside(&name)));
    Export { files: vec![JobFile { name, text: text(job), executable: false }], submit }
}

fn text(job: &Job) -> String {
    let path = job.sequence.with_file_name(format!("{}.hq.toml", job.name));
    let submit = format!("hq job submit-file {}", words::quoted(&path.to_string_lossy()));
    let threads = job.threads.unwrap_or(1);
    let renders: Vec<Vec<String>> =
        job.chunks().map(|chunk| on_threads(job.render(&chunk.set()), threads)).collect();
    let cpus = format!("request = [{{ resources = {{ cpus = {threads} }} }}]\n");
    let mut text = format!(
        "# {MARK}. From the folder in which its commands run: {submit}\n\
         # Submitted again, it renders what is missing. Tasks that should take longest come first.\n\
         name = {}\n",
        quoted(&job.name)
    );
    for (id, words) in renders.iter().enumerate() {
        text += &task(job, id, words, &cpus);
    }
    let all: Vec<String> = (0..renders.len()).map(|id| id.to_string()).collect();
    let deps = format!("{cpus}deps = [{}]\n", all.join(", "));
    for (place, words) in job.assemble().enumerate() {
        text += &task(job, renders.len() + place, &on_threads(words, threads), &deps);
    }
    text
}

/// A command with as many threads as its task has processors.
fn on_threads(mut words: Vec<String>, threads: u32) -> Vec<String> {
    words.retain(|word| !word.starts_with(THREADS));
    words.push(format!("{THREADS}{threads}"));
    words
}

/// A task with its output beside the job. A lost worker's task goes to another one.
fn task(job: &Job, id: usize, words: &[String], rest: &str) -> String {
    let folder = job.sequence.parent().unwrap_or(Path::new(""));
    let logs = folder.join(format!("{}.hq-logs", job.name));
    let log = |kind: &str| {
        quoted(&logs.join(format!("%{{JOB_ID}}-%{{TASK_ID}}-%{{INSTANCE_ID}}.{kind}")).to_string_lossy())
    };
    let words: Vec<String> = words.iter().map(|word| quoted(word)).collect();
    format!(
        "\n[[task]]\nid = {id}\ncommand = [{}]\nstdout = {}\nstderr = {}\ncrash_limit = {CRASHES}\n{rest}",
        words.join(", "),
        log("out"),
        log("err"),
    )
}

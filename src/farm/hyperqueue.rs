//! Jobs for HyperQueue: a job definition file with a task for each chunk, and one for each file that is assembled from
//! the frames.

use super::job::{Engine, Export, Job, JobFile, MARK, THREADS};
use super::shell_words::shell_quote;
use crate::base::escape::quoted;
use std::path::Path;

/// How many workers may fail during the same task before it fails.
const CRASH_LIMIT: u32 = 20;

/// HyperQueue.
pub struct HyperQueue;

impl Engine for HyperQueue {
    fn export(&self, job: &Job) -> Export {
        let name = format!("{}.hq.toml", job.name);
        let submit = format!("hq job submit-file {}", shell_quote(&job.path_of(&name)));
        Export { files: vec![JobFile { name, text: text(job), executable: false }], submit }
    }
}

fn text(job: &Job) -> String {
    let path = job.sequence.with_file_name(format!("{}.hq.toml", job.name));
    let submit = format!("hq job submit-file {}", shell_quote(&path.to_string_lossy()));
    let threads = job.threads.unwrap_or(1);
    let renders: Vec<Vec<String>> =
        job.chunks().map(|chunk| on_threads(job.render(&chunk.frame_set()), threads)).collect();
    let cpus = format!("request = [{{ resources = {{ cpus = {threads} }} }}]\n");
    let mut text = format!(
        "# {MARK}. Submit it from the folder in which its commands run: {submit}\n\
         # Submit it again to render missing frames. The longest tasks come first.\n\
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

/// A command that uses as many threads as its task has processors.
fn on_threads(mut words: Vec<String>, threads: u32) -> Vec<String> {
    words.retain(|word| !word.starts_with(THREADS));
    words.push(format!("{THREADS}{threads}"));
    words
}

/// A task. Its output goes to files beside the job. If its worker fails, another worker takes it.
fn task(job: &Job, id: usize, words: &[String], rest: &str) -> String {
    let folder = job.sequence.parent().unwrap_or(Path::new(""));
    let logs = folder.join(format!("{}.hq-logs", job.name));
    let log = |kind: &str| {
        quoted(&logs.join(format!("%{{JOB_ID}}-%{{TASK_ID}}-%{{INSTANCE_ID}}.{kind}")).to_string_lossy())
    };
    let words: Vec<String> = words.iter().map(|word| quoted(word)).collect();
    format!(
        "\n[[task]]\nid = {id}\ncommand = [{}]\nstdout = {}\nstderr = {}\ncrash_limit = {CRASH_LIMIT}\n{rest}",
        words.join(", "),
        log("out"),
        log("err"),
    )
}

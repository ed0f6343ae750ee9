//! Jobs for Slurm: an array of tasks, a job that depends on it, and the script that submits both.

use super::job::{Export, Job, JobFile, MARK, THREADS};
use super::words::quoted;
use std::path::Path;

/// Seconds before the end of its time at which a task is told, and after which a frame that is still in hand is given
/// up, so that there is time left to requeue.
const NOTICE: u32 = 120;
const PATIENCE: u32 = 90;

/// How often a task goes back to the queue by itself. A frame that no machine has the memory or the time for would
/// otherwise go on for ever.
const RESTARTS: u32 = 20;

pub fn export(job: &Job) -> Export {
    let script =
        |kind: &str, text: String| JobFile { name: named(job, kind), text, executable: kind == SUBMIT };
    let mut files = vec![script(RENDER, render(job)), script(SUBMIT, submit(job))];
    if !job.assemblies.is_empty() {
        files.push(script(ASSEMBLE, assemble(job)));
    }
    Export { files, submit: quoted(&local(&job.beside(&named(job, SUBMIT)))) }
}

/// What files are called after the job's name.
const RENDER: &str = "slurm.sh";
const ASSEMBLE: &str = "slurm-assemble.sh";
const SUBMIT: &str = "slurm-submit.sh";
const LOGS: &str = "slurm-logs";

fn named(job: &Job, kind: &str) -> String {
    format!("{}.{kind}", job.name)
}

/// A path that shells do not look for among their commands.
fn local(path: &str) -> String {
    if path.contains('/') { path.to_owned() } else { format!("./{path}") }
}

/// A file of the job, from `base`.
fn from_base(job: &Job, kind: &str) -> String {
    let folder = job.sequence.parent().unwrap_or(Path::new(""));
    local(&folder.join(named(job, kind)).to_string_lossy())
}

/// The head of a script for sbatch. Options on the command line outdo those that stand here.
fn head(job: &Job, name: &str, log: &str, array: Option<String>) -> String {
    let mut options = vec![format!("--job-name={}", option(name))];
    options.extend(array.map(|array| format!("--array={array}")));
    options.extend([
        format!("--cpus-per-task={}", job.threads.unwrap_or(1)),
        "--requeue".to_owned(),
        "--open-mode=append".to_owned(),
        format!("--output={}", option(&format!("{}/{log}", from_base(job, LOGS).replace('%', "%%")))),
    ]);
    let options: String = options.iter().map(|option| format!("#SBATCH {option}\n")).collect();
    format!("#!/bin/bash\n# {MARK}; {} submits it.\n{options}", named(job, SUBMIT))
}

/// A value of an option as sbatch reads it in a script.
fn option(value: &str) -> String {
    if value.chars().any(|c| c.is_whitespace() || "\"'\\#".contains(c)) {
        format!("\"{}\"", value.replace('\\', r"\\").replace('"', "\\\""))
    } else {
        value.to_owned()
    }
}

fn render(job: &Job) -> String {
    let chunks: Vec<String> = job.chunks().map(|chunk| format!("    {}\n", chunk.set())).collect();
    let throttle = job.throttle.map(|most| format!("%{most}")).unwrap_or_default();
    let array = format!("0-{}{throttle}", chunks.len().saturating_sub(1));
    let head =
        head(job, &job.name, "%A_%a.log", Some(array)) + &format!("#SBATCH --signal=B:TERM@{NOTICE}\n");
    let chunks = chunks.concat();
    let render = command(&job.render(FRAMES));
    format!(
        r#"{head}
# What each task renders; those that should take longest come first.
chunks=(
{chunks})
frames=${{chunks[SLURM_ARRAY_TASK_ID]}}
echo "frames $frames on ${{SLURMD_NODENAME:-$HOSTNAME}}, restart ${{SLURM_RESTART_COUNT:-0}}"
# Not by SLURM_JOB_ID: the last task's is that of the whole array.
task=${{SLURM_ARRAY_JOB_ID}}_$SLURM_ARRAY_TASK_ID

# Near the end of its time, this script alone is told. Kinora then ends after the frame in hand; told again, at once, which
# leaves time to go back to the queue.
make_room() {{
    kill -TERM "$render"
    {{ sleep {PATIENCE} && kill -TERM "$render"; }} &
}} 2>/dev/null
trap make_room TERM

{render} &
render=$!
wait "$render"
code=$?
# The signal ends the waiting, not the render.
while kill -0 "$render" 2>/dev/null; do
    wait "$render"
    code=$?
done

# Stopped (143) or killed (137): the frames that are missing go back to the queue, unless the job is being cancelled.
running() {{ [[ $(squeue --noheader --jobs="$task" --format=%T) == RUNNING ]]; }}
if ((code == 143 || code == 137)) && ((${{SLURM_RESTART_COUNT:-0}} < {RESTARTS})) && running; then
    scontrol requeue "$task"
fi
exit "$code"
"#
    )
}

/// Stands for the frames of a task. No word of a command line holds it.
const FRAMES: &str = "\0";

/// A command with as many threads as its task is given processors.
fn command(words: &[String]) -> String {
    let word = |word: &String| if word == FRAMES { "\"$frames\"".to_owned() } else { quoted(word) };
    let words: Vec<String> = words.iter().filter(|word| !word.starts_with(THREADS)).map(word).collect();
    format!("{} \\\n    {THREADS}\"${{SLURM_CPUS_PER_TASK:-1}}\"", words.join(" "))
}

fn assemble(job: &Job) -> String {
    let head = head(job, &format!("{}-assemble", job.name), "%j-assemble.log", None);
    let commands: String = job.assemble().map(|words| command(&words) + "\n").collect();
    format!("{head}\nset -e\n{commands}")
}

fn submit(job: &Job) -> String {
    let base = job.base.to_string_lossy();
    let base = if base.is_empty() { String::new() } else { quoted(&format!("/{base}")) };
    let [render, assemble, logs] = [RENDER, ASSEMBLE, LOGS].map(|kind| quoted(&from_base(job, kind)));
    let after = match job.assemblies.is_empty() {
        true => String::new(),
        false => format!(
            r#"# Only when all frames are there; if a task has failed for good, not at all.
after=$(sbatch --parsable --dependency="afterok:$frames" --kill-on-invalid-dep=yes "$@" {assemble})
echo "job ${{after%%;*}} assembles them"
"#
        ),
    };
    format!(
        r#"#!/bin/bash
# {MARK}. Options go to sbatch: --partition=NAME --account=NAME --mem=2G --time=2:00:00
# Submitted again, it renders what is missing.
set -euo pipefail
cd -- "$(dirname -- "${{BASH_SOURCE[0]}}")"{base}
mkdir -p {logs}

frames=$(sbatch --parsable "$@" {render})
frames=${{frames%%;*}}
echo "job $frames renders the frames"
{after}"#
    )
}

//! Jobs for Slurm: an array of tasks, a job that depends on it, and a script that submits both.

use super::job::{Engine, Export, Job, JobFile, MARK, THREADS};
use super::shell_words::shell_quote;
use std::path::Path;

/// Seconds before the time limit at which Slurm sends SIGTERM.
const NOTICE_SECONDS: u32 = 120;

/// Seconds after SIGTERM at which a second one makes Kinora drop the current frame. The rest of the notice is left to
/// requeue the task.
const GRACE_SECONDS: u32 = 90;

/// How often a task requeues itself. The limit ends tasks that no machine has the memory or the time for.
const MAX_RESTARTS: u32 = 20;

/// Slurm.
pub struct Slurm;

impl Engine for Slurm {
    fn export(&self, job: &Job) -> Export {
        let script =
            |kind: &str, text: String| JobFile { name: named(job, kind), text, executable: kind == SUBMIT };
        let mut files = vec![script(RENDER, render(job)), script(SUBMIT, submit(job))];
        if !job.assemblies.is_empty() {
            files.push(script(ASSEMBLE, assemble(job)));
        }
        let submit = local(&job.path_of(&named(job, SUBMIT)));
        Export { files, submit: shell_quote(&submit).into_owned() }
    }
}

/// The parts of file names after the job's name.
const RENDER: &str = "slurm.sh";
const ASSEMBLE: &str = "slurm-assemble.sh";
const SUBMIT: &str = "slurm-submit.sh";
const LOGS: &str = "slurm-logs";

fn named(job: &Job, kind: &str) -> String {
    format!("{}.{kind}", job.name)
}

/// A path with a slash, which a shell does not search for in PATH.
fn local(path: &str) -> String {
    if path.contains('/') { path.to_owned() } else { format!("./{path}") }
}

/// The path of a file of the job from `base`.
fn from_base(job: &Job, kind: &str) -> String {
    let folder = job.sequence.parent().unwrap_or(Path::new(""));
    local(&folder.join(named(job, kind)).to_string_lossy())
}

/// The head of a script for sbatch. Options on the command line of sbatch override these.
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
    format!("#!/bin/bash\n# {MARK}. {} submits it.\n{options}", named(job, SUBMIT))
}

/// A value of an option in the syntax of sbatch scripts.
fn option(value: &str) -> String {
    if value.chars().any(|c| c.is_whitespace() || "\"'\\#".contains(c)) {
        format!("\"{}\"", value.replace('\\', r"\\").replace('"', "\\\""))
    } else {
        value.to_owned()
    }
}

fn render(job: &Job) -> String {
    let chunks: Vec<String> = job.chunks().map(|chunk| format!("    {}\n", chunk.frame_set())).collect();
    let throttle = job.throttle.map(|most| format!("%{most}")).unwrap_or_default();
    let array = format!("0-{}{throttle}", chunks.len().saturating_sub(1));
    let head = head(job, &job.name, "%A_%a.log", Some(array))
        + &format!("#SBATCH --signal=B:TERM@{NOTICE_SECONDS}\n");
    let chunks = chunks.concat();
    let render = command(&job.render(FRAMES));
    format!(
        r#"{head}
# The frames of each task, longest tasks first.
chunks=(
{chunks})
frames=${{chunks[SLURM_ARRAY_TASK_ID]}}
echo "frames $frames on ${{SLURMD_NODENAME:-$HOSTNAME}}, restart ${{SLURM_RESTART_COUNT:-0}}"
# Not SLURM_JOB_ID: for the last task, that is the ID of the whole array.
task=${{SLURM_ARRAY_JOB_ID}}_$SLURM_ARRAY_TASK_ID

# Slurm signals only this script. After the first SIGTERM, Kinora stops after the current frame. The second one stops
# it at once, so that there is time to requeue the task.
stop_render() {{
    kill -TERM "$render"
    {{ sleep {GRACE_SECONDS} && kill -TERM "$render"; }} &
}} 2>/dev/null
trap stop_render TERM

{render} &
render=$!
wait "$render"
code=$?
# The signal interrupts `wait` while the render continues.
while kill -0 "$render" 2>/dev/null; do
    wait "$render"
    code=$?
done

# Stopped (143) or killed (137): requeue the task for its missing frames, unless the job is being cancelled.
running() {{ [[ $(squeue --noheader --jobs="$task" --format=%T) == RUNNING ]]; }}
if ((code == 143 || code == 137)) && ((${{SLURM_RESTART_COUNT:-0}} < {MAX_RESTARTS})) && running; then
    scontrol requeue "$task"
fi
exit "$code"
"#
    )
}

/// Placeholder for the frames of a task. No word of a command line contains it.
const FRAMES: &str = "\0";

/// A command that uses as many threads as Slurm gives its task processors.
fn command(words: &[String]) -> String {
    let word = |word: &String| match word.as_str() {
        FRAMES => "\"$frames\"".to_owned(),
        word => shell_quote(word).into_owned(),
    };
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
    let base = if base.is_empty() { String::new() } else { shell_quote(&format!("/{base}")).into_owned() };
    let [render, assemble, logs] =
        [RENDER, ASSEMBLE, LOGS].map(|kind| shell_quote(&from_base(job, kind)).into_owned());
    let after = match job.assemblies.is_empty() {
        true => String::new(),
        false => format!(
            r#"# Runs only if all tasks succeed.
after=$(sbatch --parsable --dependency="afterok:$frames" --kill-on-invalid-dep=yes "$@" {assemble})
echo "job ${{after%%;*}} assembles them"
"#
        ),
    };
    format!(
        r#"#!/bin/bash
# {MARK}. Passes its options to sbatch: --partition=NAME --account=NAME --mem=2G --time=2:00:00
# Submit it again to render missing frames.
set -euo pipefail
cd -- "$(dirname -- "${{BASH_SOURCE[0]}}")"{base}
mkdir -p {logs}

frames=$(sbatch --parsable "$@" {render})
frames=${{frames%%;*}}
echo "job $frames renders the frames"
{after}"#
    )
}

//! Jobs for any POSIX shell: a script that gives chunks to processes of one machine. Several machines that share a
//! folder may run it at the same time.

use super::job::{Engine, Export, Job, JobFile, MARK};
use super::shell_words::{shell_command, shell_quote};

/// Any POSIX shell, with `xargs`.
pub struct Shell;

impl Engine for Shell {
    fn export(&self, job: &Job) -> Export {
        let name = format!("{}.farm.sh", job.name);
        let submit = format!("sh {}", shell_quote(&job.path_of(&name)));
        Export { files: vec![JobFile { name, text: text(job), executable: true }], submit }
    }
}

/// The default number of processes: one for each `threads` processors.
fn processes(job: &Job, threads: u32) -> String {
    match job.throttle {
        Some(most) => most.to_string(),
        None if threads == 1 => "$(getconf _NPROCESSORS_ONLN)".to_owned(),
        None => format!("$((($(getconf _NPROCESSORS_ONLN) + {}) / {threads}))", threads - 1),
    }
}

fn text(job: &Job) -> String {
    let base = job.base.to_string_lossy();
    let base = if base.is_empty() { String::new() } else { shell_quote(&format!("/{base}")).into_owned() };
    let chunks: String = job.chunks().map(|chunk| chunk.frame_set() + "\n").collect();
    let threads = job.threads.unwrap_or(1);
    let mut words = job.render("");
    // `--frames` comes last, because `xargs` appends the frame set to the command.
    let frames = words.iter().position(|word| word == "--frames");
    frames.into_iter().for_each(|place| drop(words.drain(place..place + 2)));
    words.extend(["--quiet".to_owned(), format!("--threads={threads}"), "--frames".to_owned()]);
    let render = shell_command(&words);
    // `xargs` returns one code for all failures. So the shell of each task prints its own code, one a line.
    let task = r#"sh -c '"$@" 3>&- || { echo "$?" >&3; exit 1; }' sh"#;
    let processes = processes(job, threads);
    let assemble: String = job.assemble().map(|words| shell_command(&words) + "\n").collect();
    let then = if assemble.is_empty() { "" } else { "\n# Runs only if all frames are there.\n" };
    format!(
        r#"#!/bin/sh
# {MARK}. Optional argument: the number of processes.
# Run it again to render missing frames. Machines that share this folder may run it at the same time.
set -eu
cd -- "$(dirname -- "$0")"{base}
processes=${{1:-{processes}}}

# The frames of one task per line, longest tasks first.
status=0
exec 4>&1
codes=$(xargs -n 1 -P "$processes" {task} {render} 3>&1 >&4 4>&- <<'FRAMES'
{chunks}FRAMES
) || status=$?
# Exit with the least code of all tasks: after 2, running again does not help; after 3, it may.
if [ "$status" -ne 0 ]; then
    code=$(printf '%s\n' $codes | sort -n | head -n 1)
    exit "${{code:-$status}}"
fi
{then}{assemble}"#
    )
}

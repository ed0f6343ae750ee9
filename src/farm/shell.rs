//! Jobs for any POSIX shell: a script that hands chunks to processes of one machine, and that several machines which
//! share a folder may run at the same time.

use super::job::{Export, Job, JobFile, MARK};
use super::words::{command, quoted};

pub fn export(job: &Job) -> Export {
    let name = format!("{}.farm.sh", job.name);
    let submit = format!("sh {}", quoted(&job.beside(&name)));
    Export { files: vec![JobFile { name, text: text(job), executable: true }], submit }
}

/// Processes where nobody says how many: as many as have a processor for each of their threads.
fn processes(job: &Job, threads: u32) -> String {
    match job.throttle {
        Some(most) => most.to_string(),
        None if threads == 1 => "$(getconf _NPROCESSORS_ONLN)".to_owned(),
        None => format!("$((($(getconf _NPROCESSORS_ONLN) + {}) / {threads}))", threads - 1),
    }
}

fn text(job: &Job) -> String {
    let base = job.base.to_string_lossy();
    let base = if base.is_empty() { String::new() } else { quoted(&format!("/{base}")) };
    let chunks: String = job.chunks().map(|chunk| chunk.set() + "\n").collect();
    let threads = job.threads.unwrap_or(1);
    let mut words = job.render("");
    // The set stands last, where xargs puts it.
    let frames = words.iter().position(|word| word == "--frames");
    frames.into_iter().for_each(|place| drop(words.drain(place..place + 2)));
    words.extend(["--quiet".to_owned(), format!("--threads={threads}"), "--frames".to_owned()]);
    let render = command(&words);
    // Its shell tells the code of a task that fails on a line of its own: `xargs` has one for all of them.
    let task = r#"sh -c '"$@" 3>&- || { echo "$?" >&3; exit 1; }' sh"#;
    let processes = processes(job, threads);
    let assemble: String = job.assemble().map(|words| command(&words) + "\n").collect();
    let then = if assemble.is_empty() { "" } else { "\n# Only when all frames are there.\n" };
    format!(
        r#"#!/bin/sh
# {MARK}. With a number, so many processes at a time.
# Run again, it renders what is missing; run on several machines that share this folder, they share the work.
set -eu
cd -- "$(dirname -- "$0")"{base}
processes=${{1:-{processes}}}

# Frames of a task in each line; those that should take longest come first.
status=0
exec 4>&1
codes=$(xargs -n 1 -P "$processes" {task} {render} 3>&1 >&4 4>&- <<'FRAMES'
{chunks}FRAMES
) || status=$?
# Of the tasks' exit codes the least says most: with 2 it does not help to try again, with 3 it may.
if [ "$status" -ne 0 ]; then
    code=$(printf '%s\n' $codes | sort -n | head -n 1)
    exit "${{code:-$status}}"
fi
{then}{assemble}"#
    )
}

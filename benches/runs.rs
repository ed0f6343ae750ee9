//! Whole runs of `kinora`, and of other commands beside them:
//!
//! ```text
//! cargo bench --bench runs -- SEQUENCE [COMMAND]... [--rounds N] [--threads N] [--json FILE]
//! cargo bench --bench runs -- glazed 'env THREADS=2 other-renderer glazed.scene' --threads 2
//! ```
//!
//! SEQUENCE is a file, or the name of one in `sequences/bench`. A COMMAND is its words between spaces; no shell reads
//! it. In every round each command runs once, so that a slow spell of the machine meets all of them; a round before
//! those that count warms up. Commands start in the root of the repository, and what they say is not shown.
//!
//! It prints the medians of the wall time, from the start of the process until it has ended, of the CPU time and of the
//! peak memory, with the quartiles of the first; and of the share that `kinora` took of what the other command did in the
//! same round. On a machine that is busy otherwise, CPU time is the steadier one. It and memory are the system's own
//! counts, and only Linux is asked for them: those of the process that the command starts, and for the CPU time of the
//! children too that it has waited for.

use rustix::process::{Pid, WaitId, WaitIdOptions, waitid};
use std::error::Error;
use std::fmt::Write as _;
use std::fs;
use std::io::{Write as _, stdout};
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

type Outcome<T> = Result<T, Box<dyn Error>>;

/// What `/proc` counts CPU time in.
const TICKS_PER_SECOND: f64 = 100.0;

/// How often memory is looked at. The system keeps the peak, so only what comes after the last look is missed.
const LOOK: Duration = Duration::from_millis(5);

/// One run: seconds, and MiB.
#[derive(Clone, Copy)]
struct Run {
    wall: f64,
    cpu: Option<f64>,
    peak: Option<f64>,
}

/// A command and its runs, by round.
struct Runner {
    words: Vec<String>,
    runs: Vec<Run>,
}

struct Settings {
    sequence: String,
    others: Vec<String>,
    rounds: usize,
    threads: Option<String>,
    json: Option<String>,
}

fn main() -> Outcome<()> {
    let Some(settings) = settings()? else {
        // `cargo bench` alone runs every bench; this one needs a sequence.
        return Ok(writeln!(stdout(), "runs: give a sequence, such as glazed, and other commands")?);
    };
    let mut runners = vec![ours(&settings)];
    runners.extend(
        settings.others.iter().map(|command| command.split_whitespace().map(str::to_owned).collect()),
    );
    let mut runners: Vec<_> = runners.into_iter().map(|words| Runner { words, runs: Vec::new() }).collect();
    for round in 0..=settings.rounds {
        for runner in &mut runners {
            let run = run(&runner.words).map_err(|error| format!("{}: {error}", runner.words.join(" ")))?;
            if round > 0 {
                runner.runs.push(run);
            }
        }
    }
    report(&settings, &runners)?;
    match &settings.json {
        Some(file) => Ok(fs::write(file, json(&settings, &runners)?)?),
        None => Ok(()),
    }
}

fn settings() -> Outcome<Option<Settings>> {
    let mut arguments = std::env::args().skip(1).filter(|argument| argument != "--bench");
    let (mut rounds, mut threads, mut json) = (5, None, None);
    let mut names = Vec::new();
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or_else(|| format!("{argument} needs a value"));
        match argument.as_str() {
            "--rounds" => rounds = value()?.parse()?,
            "--threads" => threads = Some(value()?),
            "--json" => json = Some(value()?),
            _ => names.push(argument),
        }
    }
    if rounds == 0 {
        return Err("at least one round".into());
    }
    if names.is_empty() {
        return Ok(None);
    }
    let others = names.split_off(1);
    Ok(names.pop().map(|sequence| Settings { sequence, others, rounds, threads, json }))
}

fn ours(settings: &Settings) -> Vec<String> {
    let name = &settings.sequence;
    let shipped = format!("sequences/bench/{name}.ron");
    let file = if Path::new(&shipped).is_file() { &shipped } else { name };
    let mut words = vec![env!("CARGO_BIN_EXE_kinora"), "render", file, "-q", "--overwrite"];
    words.extend(settings.threads.iter().flat_map(|threads| ["-t", threads]));
    words.into_iter().map(str::to_owned).collect()
}

fn run(words: &[String]) -> Outcome<Run> {
    let (program, arguments) = words.split_first().ok_or("a command without words")?;
    let start = Instant::now();
    let mut child = Command::new(program)
        .args(arguments)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()?;
    let facts = format!("/proc/{}", child.id());
    let watch = thread::spawn({
        let facts = facts.clone();
        move || watched(&facts)
    });
    // It has ended, but its counts can still be read.
    waitid(WaitId::Pid(Pid::from_child(&child)), WaitIdOptions::EXITED | WaitIdOptions::NOWAIT)?;
    let wall = start.elapsed().as_secs_f64();
    let cpu = fs::read_to_string(facts + "/stat").ok().and_then(|stat| cpu(&stat));
    let status = child.wait()?;
    let peak = watch.join().unwrap_or_default();
    if status.success() { Ok(Run { wall, cpu, peak }) } else { Err(status.to_string().into()) }
}

/// The peak memory of a process that runs, watched until it has ended.
fn watched(facts: &str) -> Option<f64> {
    let look = || fs::read_to_string(format!("{facts}/status")).ok().and_then(|status| peak(&status));
    let mut last = None;
    // Without a memory of its own, a process has ended.
    while let Some(peak) = look() {
        last = Some(peak);
        thread::sleep(LOOK);
    }
    last
}

fn peak(status: &str) -> Option<f64> {
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: f64 = line.trim().strip_suffix(" kB")?.parse().ok()?;
    Some(kib / 1024.0)
}

/// What the process and the children that it has waited for took, of programs and of the system for them.
fn cpu(stat: &str) -> Option<f64> {
    // The name of the program, in brackets, may hold anything.
    let (_, rest) = stat.rsplit_once(") ")?;
    let ticks: Vec<f64> = rest.split(' ').skip(11).take(4).filter_map(|word| word.parse().ok()).collect();
    (ticks.len() == 4).then(|| ticks.iter().sum::<f64>() / TICKS_PER_SECOND)
}

fn report(settings: &Settings, runners: &[Runner]) -> Outcome<()> {
    let mut text = format!("{}, {} rounds", settings.sequence, settings.rounds);
    if let Some(load) = load() {
        write!(text, ", load {load}")?;
    }
    writeln!(text, "\n  wall s  quartiles          CPU s  peak MiB   ours / this")?;
    writeln!(text, "{:44}wall  quartiles       CPU", "")?;
    for (index, runner) in runners.iter().enumerate() {
        let [low, wall, high] = quartiles(runner.runs.iter().map(|run| run.wall)).unwrap_or_default();
        let cpu = median(runner.runs.iter().filter_map(|run| run.cpu), 2);
        let peak = median(runner.runs.iter().filter_map(|run| run.peak), 0);
        write!(text, "{wall:8.3}  {low:7.3} - {high:<7.3}  {cpu:>6}  {peak:>8}")?;
        let rounds = || runners[0].runs.iter().zip(&runner.runs);
        match quartiles(rounds().map(|(ours, other)| ours.wall / other.wall)) {
            Some([low, wall, high]) if index > 0 => {
                let cpu = median(rounds().filter_map(|(ours, other)| Some(ours.cpu? / other.cpu?)), 3);
                write!(text, "   {wall:.3}  {low:.3} - {high:.3}  {cpu:>6}")?;
            }
            _ => write!(text, "{:31}", "")?,
        }
        writeln!(text, "  {}", runner.words.join(" "))?;
    }
    Ok(stdout().write_all(text.as_bytes())?)
}

/// To so many digits; a dash if there are no values.
fn median(values: impl Iterator<Item = f64>, digits: usize) -> String {
    quartiles(values).map_or("-".to_owned(), |[_, median, _]| format!("{median:.digits$}"))
}

/// How many processes have wanted a processor in the last minute.
fn load() -> Option<String> {
    let loads = fs::read_to_string("/proc/loadavg").ok()?;
    loads.split(' ').next().map(str::to_owned)
}

/// The lower quartile, the median and the upper one, between the values next to them.
fn quartiles(values: impl Iterator<Item = f64>) -> Option<[f64; 3]> {
    let mut values: Vec<_> = values.collect();
    values.sort_by(f64::total_cmp);
    let last = values.len().checked_sub(1)?;
    Some([1.0, 2.0, 3.0].map(|quarter| {
        let place = quarter / 4.0 * last as f64;
        let (below, above) = (values[place.floor() as usize], values[place.ceil() as usize]);
        below + (above - below) * place.fract()
    }))
}

/// All runs, for whoever wants to do other sums; `null` stands for what the system does not report.
fn json(settings: &Settings, runners: &[Runner]) -> Outcome<String> {
    let mut text = format!("{{\"sequence\": {}, \"commands\": [", quoted(&settings.sequence));
    for (index, runner) in runners.iter().enumerate() {
        let list = |of: fn(&Run) -> Option<f64>| {
            let numbers = runner.runs.iter().map(|run| of(run).map_or("null".to_owned(), |x| x.to_string()));
            numbers.collect::<Vec<_>>().join(", ")
        };
        write!(
            text,
            "{}\n  {{\"command\": {}, ",
            if index > 0 { "," } else { "" },
            quoted(&runner.words.join(" "))
        )?;
        write!(text, "\"wall_s\": [{}], ", list(|run| Some(run.wall)))?;
        write!(text, "\"cpu_s\": [{}], ", list(|run| run.cpu))?;
        write!(text, "\"peak_mib\": [{}]}}", list(|run| run.peak))?;
    }
    text.push_str("\n]}\n");
    Ok(text)
}

fn quoted(text: &str) -> String {
    let mut quoted = String::from('"');
    for letter in text.chars() {
        match letter {
            '"' | '\\' => quoted.extend(['\\', letter]),
            // Control characters cannot be written as they are; a command has no use for them.
            letter => quoted.push(if letter.is_control() { ' ' } else { letter }),
        }
    }
    quoted.push('"');
    quoted
}

//! `kinora preview`: shows a sequence in a browser while its file is edited.

use super::failure::Failure;
use super::{signals, terminal, values};
use crate::base::escape;
use crate::encode::write_file;
use crate::preview::{Engine, Server, SessionOptions, Watcher, channel, snapshot};
use crate::sequence::is_json;
use clap::Args;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::thread;
use std::time::Duration;

/// Look at a sequence in a browser while you write it.
#[derive(Args, Debug, PartialEq)]
#[command(after_help = AFTER_HELP)]
pub struct Arguments {
    /// The sequence file (.ron or .json)
    file: PathBuf,

    /// Open the page in the default browser
    #[arg(long)]
    open: bool,

    /// The port of the page [default: any free one]
    #[arg(long, value_name = "PORT", default_value_t = 0, hide_default_value = true)]
    port: u16,

    /// Let the page write single values into the file: the camera, and the lights
    #[arg(long)]
    edit: bool,

    /// Another size, such as 640x360 [default: as in the sequence]
    #[arg(short, long, value_name = "WIDTHxHEIGHT", value_parser = values::size)]
    size: Option<(u32, u32)>,

    /// Write the page's picture of frame N into a file and end, without a page
    #[arg(long, value_name = "N", requires = "output", conflicts_with_all = ["open", "port", "edit"])]
    snapshot: Option<u32>,

    /// The file of --snapshot (.png)
    #[arg(short, long, value_name = "FILE", requires = "snapshot")]
    output: Option<PathBuf>,

    /// Most samples per pixel of --snapshot [default: as in the sequence]
    #[arg(long, value_name = "N", value_parser = values::samples, requires = "snapshot")]
    samples: Option<u32>,

    /// Allow images and meshes outside of the sequence's root folder, as in `render`
    #[arg(long)]
    allow_outside: bool,
}

const AFTER_HELP: &str = "\
Examples:
  kinora preview turn.ron --open                 the page in the default browser
  kinora preview turn.ron --port 8000            for a tunnel: ssh -L 8000:127.0.0.1:8000 HOST
  kinora preview turn.ron --edit                 the page may write the camera and lights
  kinora preview turn.ron --snapshot 12 -o a.png one picture, without a browser
Kinora prints the address of the page. It contains a secret: only who knows it can see the page.
Ctrl-C ends the preview.";

/// How often Ctrl-C is looked for.
const PAUSE: Duration = Duration::from_millis(100);

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.file.is_dir() || !arguments.file.exists() {
        let name = escape::path(&arguments.file);
        return Err(Failure::Bad(format!("there is no file {name}")));
    }
    if arguments.edit && is_json(&arguments.file) {
        let name = escape::path(&arguments.file);
        return Err(Failure::Bad(format!("--edit writes RON, and {name} is in JSON; leave --edit out")));
    }
    let options = SessionOptions {
        file: arguments.file.clone(),
        allow_outside: arguments.allow_outside,
        edit: arguments.edit,
        size: arguments.size,
    };
    match (arguments.snapshot, &arguments.output) {
        (Some(frame), Some(output)) => {
            if output.extension().is_none_or(|extension| extension != "png") {
                return Err(Failure::Bad(format!("a snapshot is a .png file, not {}", escape::path(output))));
            }
            let png = snapshot(options, frame, arguments.samples).map_err(Failure::Faults)?;
            write_file(output, &png).map_err(|error| Failure::Incomplete(error.to_string()))
        }
        _ => serve(arguments, options),
    }
}

fn serve(arguments: &Arguments, options: SessionOptions) -> Result<(), Failure> {
    let failed =
        |what: &'static str| move |error: std::io::Error| Failure::Incomplete(format!("{what}: {error}"));
    let port = arguments.port;
    let (server, address) =
        Server::bind(port).map_err(|error| Failure::Bad(format!("cannot listen on port {port}: {error}")))?;
    let (publish, updates) = channel();
    let (engine, session) = Engine::start(options, publish).map_err(failed("cannot start the preview"))?;
    Watcher::start(engine.clone()).map_err(failed("cannot watch files"))?;
    server.start(engine.clone(), updates).map_err(failed("cannot serve the page"))?;
    let url = address.url();
    terminal::print_line(&format!("preview of {}: {url}", escape::path(&arguments.file)))?;
    if arguments.open && !open(&url) {
        terminal::eprint_line("note: no browser could be opened; open the address yourself");
    }
    let stop = signals::stop_on_signals();
    while stop.signal().is_none() && !session.is_finished() {
        thread::sleep(PAUSE);
    }
    engine.quit();
    match stop.signal() {
        Some(signal) => {
            // Files of a running render are closed.
            let _ = session.join();
            Err(Failure::Stopped { signal, message: String::new() })
        }
        None => Err(Failure::Incomplete("the preview ended by a mistake of its own".to_owned())),
    }
}

/// Opens an address in the default browser. Returns whether a program was started.
fn open(url: &str) -> bool {
    let (program, arguments): (_, &[&str]) = match () {
        () if cfg!(target_os = "macos") => ("open", &[]),
        () if cfg!(windows) => ("cmd", &["/c", "start", ""]),
        () => ("xdg-open", &[]),
    };
    let mut command = Command::new(program);
    command.args(arguments).arg(url).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.spawn().is_ok()
}

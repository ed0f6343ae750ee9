//! Identities of processes: machine, process number and start time. They stay unique when numbers are reused.

use std::fmt;
use std::fs;
use std::str::FromStr;

/// A process. Its text form is one line: `HOST MACHINE PID START`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Process {
    pub host: String,
    /// The boot id of the machine and the PID namespace, in which `id` is unique; `?` if the system does not report
    /// them.
    machine: String,
    pub id: u32,
    /// Start time in clock ticks since boot; 0 if the system does not report it.
    start: u64,
}

impl Process {
    pub fn this() -> Self {
        let read = |path: &str| fs::read_to_string(path).map(|text| text.trim().to_owned()).ok();
        let host = read("/proc/sys/kernel/hostname").or_else(|| std::env::var("HOSTNAME").ok());
        let space = fs::read_link("/proc/self/ns/pid").ok();
        let machine = read("/proc/sys/kernel/random/boot_id").zip(space);
        let machine = machine.map(|(boot, space)| format!("{boot},{}", space.to_string_lossy()));
        let id = std::process::id();
        Self {
            // The text form separates its words by spaces.
            host: word(&host.unwrap_or_default()),
            machine: word(&machine.unwrap_or_default()),
            id,
            start: start_time(id).unwrap_or_default(),
        }
    }

    /// Whether it has certainly ended. False for processes on other machines, and if the system does not report
    /// processes.
    pub fn has_ended(&self) -> bool {
        let this = Self::this();
        let here = self.host == this.host && self.machine == this.machine && !is_unknown(&self.machine);
        // A process number is reused, but not with the same start time.
        here && this.start > 0 && start_time(self.id) != Some(self.start)
    }
}

/// Replaces an empty word.
const UNKNOWN: &str = "?";

fn is_unknown(word: &str) -> bool {
    word == UNKNOWN
}

fn word(text: &str) -> String {
    let word: String = text.split_whitespace().collect();
    if word.is_empty() { UNKNOWN.to_owned() } else { word }
}

/// The start time of a running process of this machine, in clock ticks since boot; `None` if it does not exist or has
/// ended. A process that has ended keeps its number as a zombie until its parent waits for it.
fn start_time(id: u32) -> Option<u64> {
    let stat = fs::read_to_string(format!("/proc/{id}/stat")).ok()?;
    // The second field is the name of the program in parentheses. It may contain any character.
    let mut fields = stat.rsplit_once(')')?.1.split_whitespace();
    let state = fields.next()?;
    let start = fields.nth(18)?.parse().ok()?;
    (!["Z", "X"].contains(&state)).then_some(start)
}

impl fmt::Display for Process {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} {} {}", self.host, self.machine, self.id, self.start)
    }
}

impl FromStr for Process {
    type Err = ();

    fn from_str(text: &str) -> Result<Self, ()> {
        let words: Vec<&str> = text.split(' ').collect();
        let [host, machine, id, start] = words[..] else { return Err(()) };
        let (id, start) = (id.parse().map_err(|_| ())?, start.parse().map_err(|_| ())?);
        Ok(Self { host: host.to_owned(), machine: machine.to_owned(), id, start })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn processes_are_written_and_read() {
        let this = Process::this();
        assert_eq!(this.to_string().parse(), Ok(this.clone()));
        for text in ["", "a b 1", "a b x 1", "a b 1 2 3"] {
            assert_eq!(text.parse::<Process>(), Err(()), "{text}");
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn only_local_processes_are_known_to_have_ended() {
        let this = Process::this();
        assert!(this.start > 0 && !this.has_ended());
        // An earlier process with this number, and a zombie.
        assert!(Process { start: this.start - 1, ..this.clone() }.has_ended());
        let mut child = std::process::Command::new("true").spawn().expect("a program");
        let id = child.id();
        while start_time(id).is_some() {
            std::thread::yield_now();
        }
        assert!(Process { id, start: 1, ..this.clone() }.has_ended());
        child.wait().expect("it has ended");
        assert!(!Process { host: "elsewhere".to_owned(), start: 1, ..this.clone() }.has_ended());
        assert!(!Process { machine: "another boot".to_owned(), start: 1, ..this.clone() }.has_ended());
        assert!(!Process { machine: UNKNOWN.to_owned(), start: 1, ..this }.has_ended());
    }
}

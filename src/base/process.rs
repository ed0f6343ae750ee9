//! This process as others can tell it from all that were or will be: on which machine, since when, under which number.

use std::fmt;
use std::fs;
use std::str::FromStr;

/// A process. Told as one line: `HOST MACHINE PID START`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Process {
    pub host: String,
    /// What numbers processes there: the boot of a machine, and the space of its numbers. Empty if it does not tell.
    machine: String,
    pub id: u32,
    /// When it began, in ticks since the machine's boot; 0 if it does not tell.
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
            // It stands in a line of words.
            host: word(&host.unwrap_or_default()),
            machine: word(&machine.unwrap_or_default()),
            id,
            start: running(id).unwrap_or_default(),
        }
    }

    /// Whether it has ended for certain. Of processes elsewhere nothing is certain, nor where the system does not tell.
    pub fn has_ended(&self) -> bool {
        let this = Self::this();
        let here = self.host == this.host && self.machine == this.machine && !is_unknown(&self.machine);
        // A number is given again, but not with the same beginning.
        here && this.start > 0 && running(self.id) != Some(self.start)
    }
}

/// What stands for an empty word.
const UNKNOWN: &str = "?";

fn is_unknown(word: &str) -> bool {
    word == UNKNOWN
}

fn word(text: &str) -> String {
    let word: String = text.split_whitespace().collect();
    if word.is_empty() { UNKNOWN.to_owned() } else { word }
}

/// When a process of this machine began, in ticks since its boot, if it is there and has not ended: whoever started one
/// may not have asked yet how it ended, and until then its number stays.
fn running(id: u32) -> Option<u64> {
    let stat = fs::read_to_string(format!("/proc/{id}/stat")).ok()?;
    // The name of the program comes second, in brackets, and may hold anything.
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
    fn processes_are_told_and_read() {
        let this = Process::this();
        assert_eq!(this.to_string().parse(), Ok(this.clone()));
        for text in ["", "a b 1", "a b x 1", "a b 1 2 3"] {
            assert_eq!(text.parse::<Process>(), Err(()), "{text}");
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn those_that_have_ended_are_known_here_alone() {
        let this = Process::this();
        assert!(this.start > 0 && !this.has_ended());
        // Another process that had this number before, and one that nobody has asked after yet.
        assert!(Process { start: this.start - 1, ..this.clone() }.has_ended());
        let mut child = std::process::Command::new("true").spawn().expect("a program");
        let id = child.id();
        while running(id).is_some() {
            std::thread::yield_now();
        }
        assert!(Process { id, start: 1, ..this.clone() }.has_ended());
        child.wait().expect("it has ended");
        assert!(!Process { host: "elsewhere".to_owned(), start: 1, ..this.clone() }.has_ended());
        assert!(!Process { machine: "another boot".to_owned(), start: 1, ..this.clone() }.has_ended());
        assert!(!Process { machine: UNKNOWN.to_owned(), start: 1, ..this }.has_ended());
    }
}

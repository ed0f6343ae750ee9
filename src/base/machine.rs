//! What the machine has.

use crate::base::units;
#[cfg(unix)]
use rustix::time::{ClockId, clock_gettime};
use std::io;
use std::path::Path;

mod cgroup;

/// Bytes that a machine that does not tell is taken to have free.
const UNKNOWN: u64 = 4 << 30;

/// Bytes of memory that can be had without swapping, and that the process may have, as Linux tells; elsewhere a
/// cautious guess.
pub fn free_memory() -> u64 {
    free_in(|file| std::fs::read_to_string(file).ok())
}

/// The same of a machine of which `told` gives what a file of the kernel says, if it is there.
fn free_in(told: impl Fn(&Path) -> Option<String>) -> u64 {
    let said = |file: &str| told(Path::new(file)).unwrap_or_default();
    let free = kibibytes_in(&said("/proc/meminfo"), "MemAvailable:").unwrap_or(UNKNOWN);
    let taken = kibibytes_in(&said("/proc/self/status"), "VmSize:").unwrap_or(0);
    let allowed = address_space_in(&said("/proc/self/limits")).map(|allowed| allowed.saturating_sub(taken));
    [allowed, cgroup::free_memory(told)].into_iter().flatten().fold(free, u64::min)
}

/// Refuses what would take more memory than there is, before it is taken.
pub fn check_memory(needed: u64) -> io::Result<()> {
    let free = free_memory();
    if needed <= free {
        return Ok(());
    }
    let (needed, free) = (units::bytes(needed), units::bytes(free));
    Err(io::Error::new(
        io::ErrorKind::OutOfMemory,
        format!("it would take {needed} of memory, and there are {free}"),
    ))
}

/// Seconds that this process has spent on processors, where the system tells.
#[cfg(unix)]
pub fn processor_time() -> Option<f64> {
    Some(seconds(ClockId::ProcessCPUTime))
}

/// Seconds that this thread has spent on a processor.
#[cfg(unix)]
pub fn thread_time() -> Option<f64> {
    Some(seconds(ClockId::ThreadCPUTime))
}

#[cfg(unix)]
fn seconds(clock: ClockId) -> f64 {
    let time = clock_gettime(clock);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

#[cfg(not(unix))]
pub fn processor_time() -> Option<f64> {
    None
}

#[cfg(not(unix))]
pub fn thread_time() -> Option<f64> {
    None
}

/// Bytes of addresses that a process may take, as `ulimit -v` sets them; none if there is no limit.
fn address_space_in(limits: &str) -> Option<u64> {
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    line.split_whitespace().next()?.parse().ok()
}

/// What a file of the kernel says behind `key`, in bytes.
fn kibibytes_in(told: &str, key: &str) -> Option<u64> {
    let line = told.lines().find_map(|line| line.strip_prefix(key))?;
    let kibibytes: u64 = line.split_whitespace().next()?.parse().ok()?;
    kibibytes.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_what_linux_tells() {
        let text = "MemTotal:       24000000 kB\nMemAvailable:   1000 kB\n";
        assert_eq!(kibibytes_in(text, "MemAvailable:"), Some(1_024_000));
        assert_eq!(kibibytes_in("nothing", "MemAvailable:"), None);
        let limits =
            |limit: &str| format!("Limit  Soft  Hard  Units\nMax address space  {limit}  {limit}  bytes\n");
        assert_eq!(address_space_in(&limits("3072000000")), Some(3_072_000_000));
        assert_eq!((address_space_in(&limits("unlimited")), address_space_in("")), (None, None));
        assert!(free_memory() > 0);
    }

    #[test]
    fn the_least_of_what_is_free_and_what_is_allowed_can_be_had() {
        let least = |limit: &str, group: &str| {
            free_in(|file| {
                let text = match file.to_str()? {
                    "/proc/meminfo" => "MemAvailable: 5 kB\n".to_owned(),
                    "/proc/self/status" => "VmSize: 1 kB\n".to_owned(),
                    "/proc/self/limits" => format!("Max address space  {limit}  {limit}  bytes\n"),
                    "/proc/self/cgroup" => "0::/job\n".to_owned(),
                    "/proc/self/mountinfo" => "9 8 0:26 / /groups rw - cgroup2 cgroup rw\n".to_owned(),
                    "/groups/job/memory.max" => group.to_owned(),
                    _ => return None,
                };
                Some(text)
            })
        };
        assert_eq!(least("unlimited", "max"), 5120);
        assert_eq!(least("unlimited", "4000"), 4000);
        assert_eq!(least("3024", "4000"), 2000);
        assert_eq!(free_in(|_| None), UNKNOWN);
    }

    #[test]
    fn what_does_not_fit_is_told() {
        assert!(check_memory(1).is_ok());
        let told = check_memory(u64::MAX).expect_err("more than any machine has").to_string();
        assert!(told.starts_with("it would take ") && told.contains(" of memory, and there are "), "{told}");
    }
}

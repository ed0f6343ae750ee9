//! Memory and processor time of the machine.

use crate::base::units;
#[cfg(unix)]
use rustix::time::{ClockId, clock_gettime};
use std::io;
use std::path::Path;

mod cgroup;

/// Free memory in bytes that is assumed if the system does not report it.
const UNKNOWN: u64 = 4 << 30;

/// Bytes of memory that this process can and may take without swapping, as Linux reports them. On other systems it is
/// a cautious guess.
pub fn free_memory() -> u64 {
    free_in(|file| std::fs::read_to_string(file).ok())
}

/// [`free_memory`]; `read` returns the text of a file of the kernel, if it exists.
fn free_in(read: impl Fn(&Path) -> Option<String>) -> u64 {
    let text = |file: &str| read(Path::new(file)).unwrap_or_default();
    let free = kibibytes_in(&text("/proc/meminfo"), "MemAvailable:").unwrap_or(UNKNOWN);
    let taken = kibibytes_in(&text("/proc/self/status"), "VmSize:").unwrap_or(0);
    let allowed = address_space_in(&text("/proc/self/limits")).map(|allowed| allowed.saturating_sub(taken));
    [allowed, cgroup::free_memory(read)].into_iter().flatten().fold(free, u64::min)
}

/// Smaller needs than this are not checked: reading the free memory takes longer than such work.
const LITTLE: u64 = 4096;

/// Checks that `needed` bytes of memory are free.
///
/// # Errors
/// If less memory is free. A few bytes count as free.
pub fn check_memory(needed: u64) -> io::Result<()> {
    if needed <= LITTLE {
        return Ok(());
    }
    let free = free_memory();
    if needed <= free {
        return Ok(());
    }
    let (needed, free) = (units::bytes(needed), units::bytes(free));
    Err(io::Error::new(
        io::ErrorKind::OutOfMemory,
        format!("it needs {needed} of memory, but only {free} are free"),
    ))
}

/// CPU time of this process in seconds; `None` if the system does not report it.
#[cfg(unix)]
pub fn cpu_time() -> Option<f64> {
    Some(seconds(ClockId::ProcessCPUTime))
}

/// CPU time of this thread in seconds; `None` if the system does not report it.
#[cfg(unix)]
pub fn thread_cpu_time() -> Option<f64> {
    Some(seconds(ClockId::ThreadCPUTime))
}

#[cfg(unix)]
fn seconds(clock: ClockId) -> f64 {
    let time = clock_gettime(clock);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

#[cfg(not(unix))]
pub fn cpu_time() -> Option<f64> {
    None
}

#[cfg(not(unix))]
pub fn thread_cpu_time() -> Option<f64> {
    None
}

/// The limit of the address space in bytes, as `ulimit -v` sets it; `None` if it is unlimited.
fn address_space_in(limits: &str) -> Option<u64> {
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    line.split_whitespace().next()?.parse().ok()
}

/// The value after `key` in the text of a kernel file, converted from kibibytes to bytes.
fn kibibytes_in(text: &str, key: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(key))?;
    let kibibytes: u64 = line.split_whitespace().next()?.parse().ok()?;
    kibibytes.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_linux_are_read() {
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
    fn available_memory_is_the_minimum_of_free_and_allowed() {
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
    fn too_large_needs_are_refused() {
        assert!(check_memory(1).is_ok());
        let message = check_memory(u64::MAX).expect_err("more than any machine has").to_string();
        assert!(message.starts_with("it needs ") && message.contains(" of memory, but only "), "{message}");
    }
}

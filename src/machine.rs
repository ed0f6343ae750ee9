//! What the machine has.

use crate::humane;
use std::io;

/// Bytes that a machine that does not tell is taken to have free.
const UNKNOWN: u64 = 4 << 30;

/// Bytes of memory that can be had without swapping, and that the process may have, as Linux tells; elsewhere a
/// cautious guess.
pub fn free_memory() -> u64 {
    let told = |file: &str| std::fs::read_to_string(file).unwrap_or_default();
    let free = kibibytes_in(&told("/proc/meminfo"), "MemAvailable:").unwrap_or(UNKNOWN);
    let taken = kibibytes_in(&told("/proc/self/status"), "VmSize:").unwrap_or(0);
    let allowed = address_space_in(&told("/proc/self/limits"));
    allowed.map_or(free, |allowed| free.min(allowed.saturating_sub(taken)))
}

/// Refuses what would take more memory than there is, before it is taken.
pub fn check_memory(needed: u64) -> io::Result<()> {
    let free = free_memory();
    if needed <= free {
        return Ok(());
    }
    let (needed, free) = (humane::bytes(needed), humane::bytes(free));
    Err(io::Error::new(
        io::ErrorKind::OutOfMemory,
        format!("it would take {needed} of memory, and there are {free}"),
    ))
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
    fn what_does_not_fit_is_told() {
        assert!(check_memory(1).is_ok());
        let told = check_memory(u64::MAX).expect_err("more than any machine has").to_string();
        assert!(told.starts_with("it would take ") && told.contains(" of memory, and there are "), "{told}");
    }
}

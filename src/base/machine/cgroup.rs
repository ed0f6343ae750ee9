//! Memory that the control groups of this process allow, in both versions of cgroups. Sources: cgroups(7), and
//! "Memory" in the kernel's `cgroup-v2.rst` and `cgroup-v1/memory.rst`.

use std::path::{Path, PathBuf};

/// The file names and keys of a version of cgroups.
struct Version {
    file_system: &'static str,
    /// The controller of memory. Empty in version 2, which has one hierarchy for all controllers.
    controller: &'static str,
    /// Files with the limits of a group.
    limits: &'static [&'static str],
    /// The file with the memory usage of a group and its subgroups.
    used: &'static str,
    /// Keys in `memory.stat` of memory that the kernel reclaims before it refuses an allocation.
    reclaimable: &'static [&'static str],
}

const VERSIONS: [Version; 2] = [
    Version {
        file_system: "cgroup2",
        controller: "",
        limits: &["memory.max", "memory.high"],
        used: "memory.current",
        reclaimable: &["active_file", "inactive_file", "slab_reclaimable"],
    },
    Version {
        file_system: "cgroup",
        controller: "memory",
        limits: &["memory.limit_in_bytes"],
        used: "memory.usage_in_bytes",
        reclaimable: &["total_active_file", "total_inactive_file"],
    },
];

/// Bytes that this process may still take in its group and in all parent groups; `None` if no group has a limit. `read`
/// returns the text of a file, if it exists.
pub fn free_memory(read: impl Fn(&Path) -> Option<String>) -> Option<u64> {
    let groups = read(Path::new("/proc/self/cgroup"))?;
    let mounts = read(Path::new("/proc/self/mountinfo"))?;
    let left = |version: &Version| {
        version.folders(&groups, &mounts).iter().filter_map(|folder| version.left(folder, &read)).min()
    };
    VERSIONS.iter().filter_map(left).min()
}

impl Version {
    /// Folders of the process's group and of its visible parent groups.
    fn folders(&self, groups: &str, mounts: &str) -> Vec<PathBuf> {
        let Some(group) = groups.lines().find_map(|line| self.group(line)) else { return Vec::new() };
        let folders = |(root, mount): (&str, &str)| {
            // In a container, the path of a group may start at a root that is not mounted. Then only the own group is
            // visible.
            let inside = Path::new(group).strip_prefix(root).unwrap_or(Path::new(""));
            inside.ancestors().map(|inside| Path::new(mount).join(inside)).collect::<Vec<_>>()
        };
        mounts.lines().filter_map(|line| self.mount(line)).flat_map(folders).collect()
    }

    /// The group in a line such as `4:cpu,memory:/a/b`.
    fn group<'a>(&self, line: &'a str) -> Option<&'a str> {
        let mut fields = line.splitn(3, ':').skip(1);
        let mine = fields.next()?.split(',').any(|controller| controller == self.controller);
        fields.next().filter(|_| mine)
    }

    /// The root group and the mount point in a line such as
    /// `29 24 0:26 / /sys/fs/cgroup rw shared:4 - cgroup2 cgroup2 rw`.
    fn mount<'a>(&self, line: &'a str) -> Option<(&'a str, &'a str)> {
        let (place, kind) = line.split_once(" - ")?;
        let mut kind = kind.split_whitespace();
        let mine = kind.next() == Some(self.file_system)
            && (self.controller.is_empty()
                || kind.nth(1)?.split(',').any(|option| option == self.controller));
        let mut place = place.split_whitespace().skip(3);
        place.next().zip(place.next()).filter(|_| mine)
    }

    /// Bytes left to the group of a folder; `None` if it has no limit.
    fn left(&self, folder: &Path, read: impl Fn(&Path) -> Option<String>) -> Option<u64> {
        let number = |file: &str| read(&folder.join(file))?.trim().parse::<u64>().ok();
        let limit = self.limits.iter().copied().filter_map(number).min()?;
        let stat = read(&folder.join("memory.stat")).unwrap_or_default();
        let reclaimable =
            self.reclaimable.iter().filter_map(|key| counter(&stat, key)).fold(0, u64::saturating_add);
        let used = number(self.used).unwrap_or(0);
        Some(limit.saturating_sub(used.saturating_sub(reclaimable)))
    }
}

/// A value of a file whose lines are a key and a number.
fn counter(stat: &str, key: &str) -> Option<u64> {
    let value = stat.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(' '))?;
    value.trim().parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Memory left if `files` are the only files.
    fn left(files: &[(&str, &str)]) -> Option<u64> {
        free_memory(|path| {
            let file = files.iter().find(|(name, _)| Path::new(name) == path);
            file.map(|(_, text)| (*text).to_owned())
        })
    }

    const SECOND: [(&str, &str); 2] = [
        ("/proc/self/cgroup", "0::/user.slice/job-7\n"),
        (
            "/proc/self/mountinfo",
            "22 28 0:20 / /proc rw,nosuid - proc proc rw\n\
             29 24 0:26 / /sys/fs/cgroup rw,nosuid shared:4 - cgroup2 cgroup2 rw,nsdelegate\n",
        ),
    ];

    fn second(files: &[(&str, &str)]) -> Option<u64> {
        left(&[&SECOND, files].concat())
    }

    #[test]
    fn control_groups_exclude_memory_that_cannot_be_reclaimed() {
        let job = "/sys/fs/cgroup/user.slice/job-7";
        let (max, current, stat) =
            (format!("{job}/memory.max"), format!("{job}/memory.current"), format!("{job}/memory.stat"));
        assert_eq!(second(&[(&max, "8000\n")]), Some(8000));
        assert_eq!(second(&[(&max, "8000\n"), (&current, "3000\n")]), Some(5000));
        let text =
            "anon 1200\nfile 1700\ninactive_file 1000\nactive_file 500\nslab_reclaimable 100\nslab 300\n";
        assert_eq!(second(&[(&max, "8000\n"), (&current, "3000\n"), (&stat, text)]), Some(6600));
        assert_eq!(second(&[(&max, "8000\n"), (&current, "9000\n")]), Some(0));
        let high = format!("{job}/memory.high");
        assert_eq!(second(&[(&max, "8000\n"), (&high, "7000\n"), (&current, "3000\n")]), Some(4000));
        assert_eq!(second(&[(&max, "max\n"), (&high, "max\n"), (&current, "3000\n")]), None);
        assert_eq!(second(&[]), None);
    }

    #[test]
    fn the_tightest_of_all_groups_around_counts() {
        let files = [
            ("/sys/fs/cgroup/user.slice/job-7/memory.max", "max"),
            ("/sys/fs/cgroup/user.slice/memory.max", "9000"),
            ("/sys/fs/cgroup/user.slice/memory.current", "2000"),
            ("/sys/fs/cgroup/memory.max", "7500"),
        ];
        assert_eq!(second(&files), Some(7000));
        assert_eq!(second(&files[2..]), Some(7500));
    }

    #[test]
    fn the_first_version_has_a_hierarchy_for_memory() {
        let mounts = "30 25 0:27 / /sys/fs/cgroup/cpu rw - cgroup cgroup rw,cpu\n\
                      31 25 0:28 / /sys/fs/cgroup/memory rw - cgroup cgroup rw,memory\n";
        let files = [
            ("/proc/self/cgroup", "5:cpu:/a\n4:hugetlb,memory:/a/b\n1:name=systemd:/c\n0::/d\n"),
            ("/proc/self/mountinfo", mounts),
            ("/sys/fs/cgroup/memory/a/b/memory.limit_in_bytes", "8000"),
            ("/sys/fs/cgroup/memory/a/b/memory.usage_in_bytes", "3000"),
            (
                "/sys/fs/cgroup/memory/a/b/memory.stat",
                "active_file 1\ntotal_active_file 300\ntotal_inactive_file 400",
            ),
            // This is how version 1 says "unlimited".
            ("/sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712"),
            ("/sys/fs/cgroup/cpu/a/b/memory.limit_in_bytes", "1"),
        ];
        assert_eq!(left(&files), Some(5700));
    }

    #[test]
    fn in_containers_only_their_own_part_is_mounted() {
        let files = |group: &'static str, mounts: &'static str| {
            left(&[
                ("/proc/self/cgroup", group),
                ("/proc/self/mountinfo", mounts),
                ("/sys/fs/cgroup/memory.max", "6000"),
                ("/sys/fs/cgroup/inner/memory.max", "5000"),
            ])
        };
        let bound = "9 8 0:26 /docker/abc /sys/fs/cgroup ro - cgroup2 cgroup rw\n";
        assert_eq!(files("0::/docker/abc\n", bound), Some(6000));
        assert_eq!(files("0::/docker/abc/inner\n", bound), Some(5000));
        assert_eq!(files("0::/\n", bound), Some(6000));
        assert_eq!(files("0::/\n", "22 28 0:20 / /proc rw - proc proc rw\n"), None);
        assert_eq!(files("", bound), None);
    }
}

//! How much memory this process may still take: of the machine, of its own limits (`ulimit`), and of its group
//! (cgroup, as containers and batch systems set them).

use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};

/// What limits memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Limit {
    /// What the machine could give without swapping.
    Machine,
    /// RLIMIT_AS.
    AddressSpace,
    /// RLIMIT_DATA.
    Data,
    /// A cgroup, version 1 or 2, or one that it is in.
    Group,
}

/// What a limit leaves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Room {
    /// The limit.
    pub limit: Limit,
    /// Bytes that may still be taken.
    pub free: u64,
    /// Bytes that may be taken in all.
    pub all: u64,
}

impl fmt::Display for Limit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Machine => "of memory",
            Self::AddressSpace => "of address space (ulimit -v)",
            Self::Data => "of data (ulimit -d)",
            Self::Group => "of memory in its cgroup",
        })
    }
}

/// All limits that the system states.
pub fn rooms() -> Vec<Room> {
    let mut rooms = Vec::new();
    rooms.extend(machine());
    rooms.extend(of_process("Max address space", "VmSize:", Limit::AddressSpace));
    rooms.extend(of_process("Max data size", "VmData:", Limit::Data));
    rooms.extend(groups(Path::new("/sys/fs/cgroup"), &read(Path::new("/proc/self/cgroup"))));
    rooms
}

/// Whether the process may have less than the machine has, and by what.
pub fn own() -> Option<Room> {
    let machine = machine().map_or(u64::MAX, |room| room.all);
    let tight = rooms().into_iter().filter(|room| room.limit != Limit::Machine);
    tight.filter(|room| room.all < machine).min_by_key(|room| room.free)
}

/// Whether address space is limited at all.
pub fn limits_address_space() -> bool {
    limit_of_process("Max address space").is_some()
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_default()
}

/// A number of kibibytes in a table of the system, in bytes.
fn kibibytes(table: &str, key: &str) -> Option<u64> {
    let line = table.lines().find_map(|line| line.strip_prefix(key))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
}

fn machine() -> Option<Room> {
    let table = read(Path::new("/proc/meminfo"));
    let free = kibibytes(&table, "MemAvailable:")?;
    Some(Room { limit: Limit::Machine, free, all: kibibytes(&table, "MemTotal:")? })
}

/// The soft limit, where there is one.
fn limit_of_process(name: &str) -> Option<u64> {
    let table = read(Path::new("/proc/self/limits"));
    let line = table.lines().find_map(|line| line.strip_prefix(name))?;
    line.split_whitespace().next()?.parse().ok()
}

fn of_process(name: &str, used: &str, limit: Limit) -> Option<Room> {
    let all = limit_of_process(name)?;
    let used = kibibytes(&read(Path::new("/proc/self/status")), used)?;
    Some(Room { limit, free: all.saturating_sub(used), all })
}

/// The groups that the process is in, by the lines of `/proc/self/cgroup`, and those around them, below `root`.
fn groups(root: &Path, lines: &str) -> Vec<Room> {
    let mut rooms = Vec::new();
    for line in lines.lines() {
        let mut parts = line.splitn(3, ':');
        let (_, Some(controllers), Some(path)) = (parts.next(), parts.next(), parts.next()) else {
            continue;
        };
        let (mounts, [max, current], cached) = if controllers.is_empty() {
            // The second is where both versions are mounted.
            let mounts = [root.to_path_buf(), root.join("unified")];
            (mounts, ["memory.max", "memory.current"], "inactive_file ")
        } else if controllers.split(',').any(|controller| controller == "memory") {
            let files = ["memory.limit_in_bytes", "memory.usage_in_bytes"];
            ([root.join("memory"), root.join(controllers)], files, "total_inactive_file ")
        } else {
            continue;
        };
        // Where memory is the only controller, the second is the first.
        let second = if mounts[0] == mounts[1] { 1 } else { 2 };
        for mount in &mounts[..second] {
            // In a container the path may be the host's, and the group itself is what is mounted.
            let mut folder: PathBuf = mount.join(path.trim_start_matches('/'));
            loop {
                rooms.extend(of_group(&folder, [max, current], cached));
                if folder == *mount || !folder.pop() {
                    break;
                }
            }
        }
    }
    rooms
}

fn of_group(folder: &Path, [max, current]: [&str; 2], cached: &str) -> Option<Room> {
    let number = |file: &str| read(&folder.join(file)).trim().parse::<u64>().ok();
    // Version 1 says that there is none by the largest number of pages.
    let all = number(max).filter(|&all| all < 1 << 62)?;
    let used = number(current)?;
    // What the system gives up first when a group is full.
    let table = read(&folder.join("memory.stat"));
    let cached = table.lines().find_map(|line| line.strip_prefix(cached)?.trim().parse().ok());
    let used = used.saturating_sub(cached.unwrap_or(0));
    Some(Room { limit: Limit::Group, free: all.saturating_sub(used), all })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn group(folder: &Path, files: [(&str, &str); 3]) {
        fs::create_dir_all(folder).expect("a folder");
        for (name, text) in files {
            fs::write(folder.join(name), text).expect("a file");
        }
    }

    /// The group around a group counts as much as its own.
    #[test]
    fn groups_of_both_versions_are_found_with_those_around_them() {
        let root = tempfile::tempdir().expect("a folder");
        let root = root.path();
        let stat = "anon 5\ninactive_file 300\n";
        group(
            &root.join("batch/job"),
            [("memory.max", "max\n"), ("memory.current", "700\n"), ("memory.stat", stat)],
        );
        group(
            &root.join("batch"),
            [("memory.max", "1000\n"), ("memory.current", "700\n"), ("memory.stat", stat)],
        );
        let room = Room { limit: Limit::Group, free: 600, all: 1000 };
        assert_eq!(groups(root, "0::/batch/job\n"), [room]);
        group(
            &root.join("memory/box"),
            [
                ("memory.limit_in_bytes", "2000\n"),
                ("memory.usage_in_bytes", "2500\n"),
                ("memory.stat", "total_inactive_file 100\n"),
            ],
        );
        let room = Room { limit: Limit::Group, free: 0, all: 2000 };
        assert_eq!(groups(root, "5:cpu,cpuacct:/x\n4:memory:/box\n"), [room]);
        // No limit, in the words of version 1; and a path of the host's.
        fs::write(root.join("memory/box/memory.limit_in_bytes"), "9223372036854771712\n")
            .expect("a file");
        assert_eq!(groups(root, "4:memory:/box\n"), []);
        let name = root.join("memory/memory.limit_in_bytes");
        fs::write(name, "50\n").expect("a file");
        fs::write(root.join("memory/memory.usage_in_bytes"), "20\n").expect("a file");
        let room = Room { limit: Limit::Group, free: 30, all: 50 };
        assert_eq!(groups(root, "4:memory:/docker/abc\n"), [room]);
    }

    #[test]
    fn the_machine_has_room() {
        let room = machine().expect("Linux says it");
        assert!(room.free > 0 && room.free <= room.all, "{room:?}");
    }
}

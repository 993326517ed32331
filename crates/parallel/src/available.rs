//! The memory that this process may still take: of the machine, of its group of processes, and of its own limit.

use std::fs::read_to_string;
use std::path::Path;

/// Memory that a process may still take, and who says so.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Available {
    /// Bytes.
    pub bytes: f64,
    /// Who sets the limit, as it reads behind "of which 4 GB are left".
    pub by: &'static str,
}

/// The smallest of what the system says for each of `ranks` processes of this machine; `None` where it says nothing.
pub fn available(ranks: usize) -> Option<Available> {
    let share = 1.0 / ranks.max(1) as f64;
    let found = [
        (
            of_machine().map(|b| share * b),
            "of the machine (MemAvailable)",
        ),
        (
            of_group(Path::new("/")).map(|b| share * b),
            "of the group of processes (cgroup)",
        ),
        (of_process(), "of the address space (ulimit -v)"),
    ];
    let known = found
        .into_iter()
        .filter_map(|(bytes, by)| Some(Available { bytes: bytes?, by }));
    known.min_by(|a, b| a.bytes.total_cmp(&b.bytes))
}

fn of_machine() -> Option<f64> {
    kilobytes(&read_to_string("/proc/meminfo").ok()?, "MemAvailable:")
}

/// The memory that is left of RLIMIT_AS.
fn of_process() -> Option<f64> {
    let limits = read_to_string("/proc/self/limits").ok()?;
    let line = limits
        .lines()
        .find_map(|l| l.strip_prefix("Max address space"))?;
    let limit: f64 = line.split_whitespace().next()?.parse().ok()?;
    let taken = kilobytes(&read_to_string("/proc/self/status").ok()?, "VmSize:")?;
    Some((limit - taken).max(0.0))
}

/// The memory that is left of the limits of the control groups of this process below the directory `root`, `/` in life.
fn of_group(root: &Path) -> Option<f64> {
    let groups = read_to_string(root.join("proc/self/cgroup")).ok()?;
    let mounted = root.join("sys/fs/cgroup");
    let left = groups.lines().filter_map(|line| {
        // hierarchy:controllers:path, with nothing between the colons in version 2.
        let (_, rest) = line.split_once(':')?;
        let (controllers, own) = rest.split_once(':')?;
        match controllers {
            "" => least(&mounted, own, &VERSION_2),
            _ if controllers.split(',').any(|c| c == "memory") => {
                least(&mounted.join("memory"), own, &VERSION_1)
            }
            _ => None,
        }
    });
    left.min_by(f64::total_cmp)
}

/// Names in the directory of a control group.
struct Names {
    limit: &'static str,
    taken: &'static str,
    /// The lines of memory.stat with the cache of files, which does not count as taken; of the group and those in it.
    cache: [&'static str; 2],
}

const VERSION_1: Names = Names {
    limit: "memory.limit_in_bytes",
    taken: "memory.usage_in_bytes",
    cache: ["total_inactive_file ", "total_active_file "],
};
const VERSION_2: Names = Names {
    limit: "memory.max",
    taken: "memory.current",
    cache: ["inactive_file ", "active_file "],
};

/// A number of bytes from which on a limit is none: version 1 then has a number near 2⁶³.
const NO_LIMIT: f64 = 1e18;

/// The least that is left in the group `own` and in those around it, which have limits, too. In a container the groups
/// outside are not mounted, and its own may be the directory `mounted` itself.
fn least(mounted: &Path, own: &str, names: &Names) -> Option<f64> {
    let left = |group: &Path| -> Option<f64> {
        let read = |file: &str| read_to_string(mounted.join(group).join(file)).ok();
        let number = |file: &str| -> Option<f64> { read(file)?.trim().parse().ok() };
        let limit = number(names.limit).filter(|l| *l < NO_LIMIT)?;
        let taken = number(names.taken)?;
        let statistics = read("memory.stat").unwrap_or_default();
        let cache = names.cache.map(|key| {
            let line = statistics.lines().find_map(|l| l.strip_prefix(key));
            line.and_then(|l| l.trim().parse::<f64>().ok())
                .unwrap_or(0.0)
        });
        Some((limit - taken + cache[0] + cache[1]).max(0.0))
    };
    let own = Path::new(own.trim_start_matches('/'));
    own.ancestors().filter_map(left).min_by(f64::total_cmp)
}

/// The value of a line such as `MemAvailable:   1234 kB`, in bytes.
fn kilobytes(text: &str, key: &str) -> Option<f64> {
    let line = text.lines().find_map(|l| l.strip_prefix(key))?;
    let number: f64 = line.trim().trim_end_matches("kB").trim().parse().ok()?;
    Some(1024.0 * number)
}

#[cfg(test)]
#[path = "../tests/available.rs"]
mod tests;

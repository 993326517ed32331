//! The memory that this process may still take: of the machine, of its group of processes, and of its own limit.

use std::fs::read_to_string;
use std::path::Path;

/// Memory that a process may still take, and who says so.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Available {
    /// Bytes.
    pub bytes: f64,
    /// Who sets the limit, as it reads behind "of which 4 GB are left".
    pub by: &'static str,
}

/// The smallest of what the system says for each of `ranks` processes of this machine; `None` where it says nothing.
pub(crate) fn available(ranks: usize) -> Option<Available> {
    let share = 1.0 / ranks.max(1) as f64;
    let found = [
        (
            of_machine().map(|b| share * b),
            "of the machine (MemAvailable)",
        ),
        (
            of_group().map(|b| share * b),
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

/// What is left of RLIMIT_AS.
fn of_process() -> Option<f64> {
    let limits = read_to_string("/proc/self/limits").ok()?;
    let line = limits
        .lines()
        .find_map(|l| l.strip_prefix("Max address space"))?;
    let limit: f64 = line.split_whitespace().next()?.parse().ok()?;
    let taken = kilobytes(&read_to_string("/proc/self/status").ok()?, "VmSize:")?;
    Some((limit - taken).max(0.0))
}

/// What is left of the limit of the control group, version 2; the cache of files does not count as taken.
fn of_group() -> Option<f64> {
    let groups = read_to_string("/proc/self/cgroup").ok()?;
    let own = groups.lines().find_map(|l| l.strip_prefix("0::"))?;
    let root = Path::new("/sys/fs/cgroup");
    let mut least: Option<f64> = None;
    // The groups around it have limits, too.
    for group in Path::new(own.trim_start_matches('/')).ancestors() {
        let number = |file: &str| -> Option<f64> {
            let text = read_to_string(root.join(group).join(file)).ok()?;
            text.trim().parse().ok()
        };
        let (Some(limit), Some(taken)) = (number("memory.max"), number("memory.current")) else {
            continue;
        };
        let statistics = read_to_string(root.join(group).join("memory.stat")).unwrap_or_default();
        let cache = ["inactive_file ", "active_file "].map(|key| {
            let line = statistics.lines().find_map(|l| l.strip_prefix(key));
            line.and_then(|l| l.trim().parse::<f64>().ok())
                .unwrap_or(0.0)
        });
        let left = (limit - taken + cache[0] + cache[1]).max(0.0);
        least = Some(least.map_or(left, |b| b.min(left)));
    }
    least
}

/// The value of a line such as `MemAvailable:   1234 kB`, in bytes.
fn kilobytes(text: &str, key: &str) -> Option<f64> {
    let line = text.lines().find_map(|l| l.strip_prefix(key))?;
    let number: f64 = line.trim().trim_end_matches("kB").trim().parse().ok()?;
    Some(1024.0 * number)
}

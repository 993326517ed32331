//! Unit tests of `crates/parallel/src/available.rs`: control groups in made-up trees.

use super::*;
use std::fs;

/// A case: a tree in words, its files with their texts, and the bytes that are left in it.
type Case = (
    &'static str,
    &'static [(&'static str, &'static str)],
    Option<f64>,
);

/// A directory that goes away with the value.
struct Tree(std::path::PathBuf);

impl Tree {
    fn new(name: &str, files: &[(&str, &str)]) -> Tree {
        let dir = std::env::temp_dir().join(format!("fetifeti-{name}-{}", std::process::id()));
        for (file, text) in files {
            let path = dir.join(file);
            fs::create_dir_all(path.parent().expect("a directory")).expect("it can be made");
            fs::write(path, text).expect("it can be written");
        }
        Tree(dir)
    }
}

impl Drop for Tree {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

#[test]
fn limits_of_control_groups_are_read() {
    const TWO: (&str, &str) = ("proc/self/cgroup", "0::/a/b\n");
    const ONE: (&str, &str) = (
        "proc/self/cgroup",
        "12:cpu,cpuacct:/x\n9:memory:/a/b\n0::/\n",
    );
    let cases: &[Case] = &[
        (
            "a limit of the group, the cache of files not counted",
            &[
                TWO,
                ("sys/fs/cgroup/a/b/memory.max", "1000\n"),
                ("sys/fs/cgroup/a/b/memory.current", "700\n"),
                (
                    "sys/fs/cgroup/a/b/memory.stat",
                    "anon 600\ninactive_file 30\nactive_file 70\n",
                ),
            ],
            Some(400.0),
        ),
        (
            "none of its own, one of the group around it",
            &[
                TWO,
                ("sys/fs/cgroup/a/b/memory.max", "max\n"),
                ("sys/fs/cgroup/a/b/memory.current", "700\n"),
                ("sys/fs/cgroup/a/memory.max", "2000\n"),
                ("sys/fs/cgroup/a/memory.current", "1900\n"),
            ],
            Some(100.0),
        ),
        (
            "more is taken than the limit",
            &[
                TWO,
                ("sys/fs/cgroup/memory.max", "10\n"),
                ("sys/fs/cgroup/memory.current", "20\n"),
            ],
            Some(0.0),
        ),
        ("no files", &[TWO], None),
        (
            "a limit, and not what is taken",
            &[TWO, ("sys/fs/cgroup/a/b/memory.max", "1000\n")],
            None,
        ),
        ("no groups", &[], None),
        (
            "version 1, with groups of version 2 that have no memory",
            &[
                ONE,
                ("sys/fs/cgroup/memory/a/b/memory.limit_in_bytes", "1000\n"),
                ("sys/fs/cgroup/memory/a/b/memory.usage_in_bytes", "600\n"),
                (
                    "sys/fs/cgroup/memory/a/b/memory.stat",
                    "inactive_file 1\ntotal_inactive_file 50\n",
                ),
            ],
            Some(450.0),
        ),
        (
            "version 1 in a container: its group is the one that is mounted",
            &[
                ONE,
                (
                    "sys/fs/cgroup/memory/memory.limit_in_bytes",
                    "9223372036854771712\n",
                ),
                ("sys/fs/cgroup/memory/memory.usage_in_bytes", "600\n"),
            ],
            None,
        ),
    ];
    for (k, (what, files, expected)) in cases.iter().enumerate() {
        let tree = Tree::new(&format!("groups{k}"), files);
        assert_eq!(of_group(&tree.0), *expected, "{what}");
    }
}

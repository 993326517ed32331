//! The same scene on the same ranks with the same threads has the same bits.

use crate::support::{mpi, program};
use mpi::Scratch;
use program::run_fetifeti;

/// Everything that a run writes for programs, but its seconds.
fn written(ranks: usize, scene: &str, threads: &str) -> Vec<Vec<u8>> {
    let scratch = Scratch::new(&format!("bits-{ranks}-{threads}"));
    let out = scratch.path("out");
    let args = ["solve", scene, "--out", &out, "-fetifeti_threads", threads];
    let run = run_fetifeti(ranks, &args);
    assert_eq!(run.code, 0, "{ranks} ranks, {scene}: {}", run.all());
    let read = |name: &str| std::fs::read(format!("{out}/{name}"));
    let files = ["solution.vtu", "interfaces.csv"];
    let written: Vec<Vec<u8>> = files.iter().flat_map(|name| read(name).ok()).collect();
    assert!(!written.is_empty(), "{scene}: nothing was written");
    written
}

#[test]
fn the_same_run_has_the_same_bits() {
    // Equations of many subdomains; mortar rows; a loop of many steps on many bodies.
    for name in ["poisson_2x2", "mortar_2d", "wall"] {
        let scene = format!("../../examples/scenes/{name}.toml");
        let of = |ranks, threads| written(ranks, &scene, threads);
        assert!(of(3, "2") == of(3, "2"), "{name}: two runs on 3 ranks");
        assert!(of(1, "2") == of(1, "1"), "{name}: threads matter");
    }
}

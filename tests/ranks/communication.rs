//! Messages, bytes and all-reduces of an iteration, compared with a count by hand.

use crate::support::{mpi, program};
use mpi::Scratch;
use program::run_fetifeti;
use serde_json::Value;

/// Two bodies of one subdomain each, 4 × 4 elements, held on the left: three multipliers and a half, none at the held
/// corners.
const TWO: &str =
    "[grid]\nbodies = [2, 1]\nelements = [8, 4]\nload = \"1 + x + y^2\"\ndirichlet = [\"left\"]\n";

fn solve(ranks: usize, text: &str) -> Value {
    let dir = Scratch::new(&format!("communication-{ranks}"));
    let scene = dir.file("scene.toml", text);
    let out = run_fetifeti(ranks, &["solve", &scene, "--json", "-"]);
    assert_eq!(out.code, 0, "{}", out.all());
    serde_json::from_str(&out.stdout).expect("a report")
}

#[test]
fn two_bodies_by_hand() {
    let report = solve(2, TWO);
    let multipliers = report["multipliers"]["global"].as_u64().expect("a count");
    assert_eq!(multipliers, 5, "five nodes on the common side");
    assert_eq!(report["floating_bodies"], 1);
    let sent = &report["communication"];
    let number = |name: &str, of: &str| sent[name][of].as_f64().expect("a number");
    // F λ and M⁻¹ r each fetch and sum. All rows are on the rank of the lower body, which provides them; it sends their
    // multipliers to the other rank and gets the jumps back. A body of one subdomain has no primal vertices: S_Π
    // contains only the fixing dofs of the floating body, on its own rank, and there is no Z_c.
    assert_eq!(number("messages_per_iteration", "sum"), 4.0);
    assert_eq!(number("messages_per_iteration", "max"), 2.0);
    assert_eq!(number("bytes_per_iteration", "sum"), 4.0 * 5.0 * 8.0);
    assert_eq!(number("bytes_per_iteration", "max"), 2.0 * 5.0 * 8.0);
    // P and Pᵀ around F and M⁻¹: four all-reduces of one number. CG: two inner products and a norm; the first norm is
    // known.
    let reductions = sent["reductions_per_iteration"].as_f64().expect("a number");
    // PETSc counts them; 3.26 counts some more.
    let old = report["petsc"].as_str().is_some_and(|v| v.contains("3.18"));
    let most = if old { 7.0 } else { 9.0 };
    assert!((7.0..=most).contains(&reductions), "{reductions}");
    let bytes = sent["reduced_bytes_per_iteration"]
        .as_f64()
        .expect("a number");
    assert!((bytes - 8.0 * reductions).abs() < 1e-9);
}

#[test]
fn one_rank_sends_nothing_and_the_summary_says_what_several_send() {
    let sent = &solve(1, TWO)["communication"];
    for name in ["messages_per_iteration", "bytes_per_iteration"] {
        assert_eq!(
            (&sent[name]["sum"], &sent[name]["max"]),
            (&0.0.into(), &0.0.into())
        );
    }
    assert_eq!(sent["reductions_per_iteration"], 0.0);
    let dir = Scratch::new("communication-summary");
    let scene = dir.file("scene.toml", TWO);
    for (ranks, there) in [(1, false), (2, true)] {
        let out = run_fetifeti(ranks, &["solve", &scene]);
        assert_eq!(out.code, 0, "{}", out.all());
        let line = out.stdout.lines().find(|l| l.contains("iteration sends"));
        assert_eq!(line.is_some(), there, "{}", out.stdout);
        assert!(line.is_none_or(|l| l.contains("4 messages")), "{line:?}");
    }
}

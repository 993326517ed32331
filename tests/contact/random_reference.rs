//! The random contact scenes themselves: they are varied enough, solvable often enough, and the reference decides each
//! of them.

use crate::support::{assembled, random_scene};
use assembled::compare::{compare, Candidate, Tolerances};
use random_scene::{spec, Collection, Fate};

#[test]
fn most_random_scenes_have_a_solution() {
    let all = Collection::new(0, 500);
    let (mut closed, mut open, mut degenerate, mut free, mut equations, mut floating) =
        (0, 0, 0, 0, 0, 0);
    for case in &all.solvable {
        let Fate::Solvable(s) = &case.fate else {
            unreachable!()
        };
        let answer = Candidate {
            u: &s.u,
            lambda: &s.lambda,
            energy: s.energy,
        };
        let a = compare(&case.problem, s, &answer, &Tolerances::default())
            .unwrap_or_else(|why| panic!("seed {}: {why}", case.seed));
        closed += usize::from(a.closed > 0);
        open += usize::from(a.closed > 0 && a.open > 0);
        degenerate += usize::from(a.degenerate > 0);
        free += usize::from(a.free_motions > 0);
        equations += usize::from(!case.problem.qp.equal.is_empty());
        floating += usize::from(case.problem.qp.kernel.len() > 1);
    }
    println!(
        "unbounded {}, infeasible {}, refused {}; of 500 closed somewhere {closed}, and open {open}, \
         degenerate {degenerate}, u not unique {free}, with ties {equations}, several floating bodies {floating}",
        all.unbounded.len(),
        all.infeasible.len(),
        all.refused.len()
    );
    for (seed, why) in &all.refused {
        println!("refused {seed}: {why}");
    }
    assert!(all.rejected() < 0.5, "{}", all.rejected());
    assert!(closed >= 400 && open >= 250, "{closed}, {open}");
    assert!(
        equations >= 50 && floating >= 150,
        "{equations}, {floating}"
    );
    assert!(!all.unbounded.is_empty() && !all.infeasible.is_empty());
}

#[test]
fn a_seed_is_a_scene() {
    assert_eq!(spec(17), spec(17));
    assert_ne!(spec(17), spec(18));
}

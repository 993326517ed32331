//! Turned and mirrored copies of a part share its factorisations, and nothing else changes.

use crate::support::checks::{identities, near};
use crate::support::copies::{Copies, Kind};
use crate::support::mpi::Scratch;
use crate::support::session::with_session;
use base::linalg::csr::Csr;
use fetifeti::settings::{
    Adaptive, MergeKind, MethodSettings, Operators, PcType, Precision, Scaling,
};
use fetifeti::{FetiFeti, Problem};
use scene::Scene;

const TIED: Copies = Copies {
    kind: Kind::Tetrahedra,
    n: 5,
    pairs: 2,
    moved: 0.0,
    joint: "tie",
    subdomains: 4,
};

fn scene(name: &str, copies: &Copies) -> Scene {
    let scratch = Scratch::new(name);
    Scene::load(copies.write(&scratch)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

fn problem(name: &str, copies: &Copies) -> Problem {
    scene(name, copies)
        .substructures(&|_| true)
        .expect("substructures")
}

/// What a solution is compared by.
struct Found {
    kinds: usize,
    constraints: usize,
    iterations: usize,
    kappa: f64,
    energy: f64,
    u: Vec<Vec<f64>>,
}

fn solve(problem: Problem, settings: MethodSettings, what: &str) -> Found {
    let what = what.to_string();
    with_session(move |session| {
        let mut solver = FetiFeti::new(session, problem, settings).expect("set up");
        // Vectors are rounded before a product in single precision.
        identities(&solver, if what == "mixed" { 1e-6 } else { 1e-9 }, &what);
        let solution = solver.solve().expect("solved");
        assert!(solution.converged(), "{what}: {}", solution.status);
        let spectrum = solution.estimate.expect("an estimate");
        Found {
            kinds: solver.facts().kinds,
            constraints: solver.facts().adaptive_constraints.iter().sum(),
            iterations: solution.iterations,
            kappa: spectrum.kappa(),
            energy: solution.energy,
            u: solution.u,
        }
    })
}

/// The same problem with zeros in the pattern of each matrix, at other places in each: none is like another.
fn apart(mut problem: Problem) -> Problem {
    for (j, sub) in problem.local.iter_mut().enumerate() {
        let k = &*sub.k;
        let absent = |c: &u32| !k.row(0).0.contains(c);
        let zero = (0..k.n() as u32)
            .filter(absent)
            .nth(j)
            .expect("a sparse row");
        let mut out = Csr {
            row_ptr: vec![0],
            col: Vec::new(),
            val: Vec::new(),
        };
        for i in 0..k.n() {
            let (col, val) = k.row(i);
            let mut row: Vec<(u32, f64)> = col.iter().copied().zip(val.iter().copied()).collect();
            match i as u32 {
                0 => row.push((zero, 0.0)),
                i if i == zero => row.push((0, 0.0)),
                _ => {}
            }
            row.sort_unstable_by_key(|e| e.0);
            out.col.extend(row.iter().map(|e| e.0));
            out.val.extend(row.iter().map(|e| e.1));
            out.row_ptr.push(out.col.len());
        }
        sub.k = out.into();
    }
    problem
}

#[test]
fn copies_have_the_factorisations_of_one_part() {
    let settings = || MethodSettings::default().rtol(1e-10);
    for (kind, joint) in [
        (Kind::Tetrahedra, "tie"),
        (Kind::Hexahedra, "tie"),
        (Kind::Hexahedra, ""),
    ] {
        let copies = Copies {
            kind,
            joint,
            ..TIED
        };
        let what = format!("copies {joint} {}", kind == Kind::Hexahedra);
        let problem = problem(&what, &copies);
        assert_eq!(problem.local.len(), 16);
        let shared = solve(problem.clone(), settings(), &what);
        assert_eq!(shared.kinds, 4, "{what}");
        let alone = solve(apart(problem), settings(), &what);
        assert_eq!(alone.kinds, 16, "{what}");
        same(&shared, &alone, 1e-8, &what);
    }
}

/// The same solution in as many iterations, up to one, with the same κ.
#[track_caller]
fn same(a: &Found, b: &Found, tolerance: f64, what: &str) {
    assert!(
        a.iterations.abs_diff(b.iterations) <= 1,
        "{what}: {} {}",
        a.iterations,
        b.iterations
    );
    // κ is read off CG, which knows the ends of the spectrum better after an iteration more.
    let known = if a.iterations == b.iterations {
        1e-4
    } else {
        1e-3
    };
    assert!(
        near(a.kappa, b.kappa, known),
        "{what}: {} {} in {} and {} iterations",
        a.kappa,
        b.kappa,
        a.iterations,
        b.iterations
    );
    assert!(
        near(a.energy, b.energy, 1e-12),
        "{what}: {} {}",
        a.energy,
        b.energy
    );
    let size = b.u.iter().flatten().fold(0.0f64, |s, u| s.max(u.abs()));
    let pairs = a.u.iter().flatten().zip(b.u.iter().flatten());
    let far = pairs.fold(0.0f64, |far, (a, b)| far.max((a - b).abs()));
    assert!(far < tolerance * size, "{what}: {far:.1e} of {size:.1e}");
}

#[test]
fn every_form_of_the_method_is_right_on_copies() {
    let usual = MethodSettings::default().rtol(1e-10);
    let cases = [
        ("implicit", usual.clone().operators(Operators::Implicit)),
        ("explicit", usual.clone().operators(Operators::Explicit)),
        ("lumped", usual.clone().pc_type(PcType::Lumped)),
        ("dirichlet", usual.clone().pc_type(PcType::Dirichlet)),
        ("corrected", usual.clone().pc_type(PcType::CoarseCorrected)),
        ("deluxe", usual.clone().scaling(Scaling::Deluxe)),
        ("mixed", usual.clone().precision(Precision::Mixed)),
        ("adaptive", usual.adaptive(Adaptive::Below(1.5))),
    ];
    let problem = problem("copies-forms", &TIED);
    for (what, settings) in cases {
        let shared = solve(problem.clone(), settings.clone(), what);
        let alone = solve(apart(problem.clone()), settings, what);
        // A copy with adaptive constraints has operators of its own.
        match what {
            "adaptive" => assert!(shared.kinds > 4 && shared.constraints > 0),
            _ => assert_eq!(shared.kinds, 4, "{what}"),
        }
        same(&shared, &alone, 1e-8, what);
    }
}

#[test]
fn a_copy_with_one_node_moved_is_another_part() {
    for moved in [1e-6, 1e-9] {
        let problem = problem("copies-moved", &Copies { moved, ..TIED });
        let found = solve(problem, MethodSettings::default(), "moved");
        // The node is in one subdomain or in several.
        assert!((5..=8).contains(&found.kinds), "{moved:e}: {}", found.kinds);
    }
}

#[test]
fn contact_between_copies_is_the_same_with_and_without_sharing() {
    let copies = Copies {
        joint: "contact",
        kind: Kind::Hexahedra,
        ..TIED
    };
    let settings = MethodSettings::default().rtol(1e-10);
    let problem = problem("copies-contact", &copies);
    let shared = solve(problem.clone(), settings.clone(), "contact");
    assert!(shared.kinds <= 8, "{}", shared.kinds);
    let alone = solve(apart(problem), settings, "contact alone");
    assert_eq!(alone.kinds, 16);
    same(&shared, &alone, 1e-8, "contact");
}

/// Copies that are merged are copies still, with other interfaces.
#[test]
fn copies_are_merged_on_demand_alone() {
    let problem = problem("copies-merged", &TIED);
    let settings = MethodSettings::default().rtol(1e-10);
    let rows = solve(problem.clone(), settings.clone(), "rows");
    let merged = solve(problem, settings.merge(MergeKind::Ties), "merged");
    assert!(
        rows.kinds == 4 && (4..=8).contains(&merged.kinds),
        "{}",
        merged.kinds
    );
    assert!(near(rows.energy, merged.energy, 1e-10));
}

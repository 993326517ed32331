//! 3D and elastic problems against a direct solve, with every kind of constraint, scaling and support, on one and
//! several ranks.

use crate::support::checks::identities;
use crate::support::sample::sample;
use crate::support::session::with_session;
use crate::support::{mpi, solid};
use fetifeti::settings::{MethodSettings, Primal, ProjectorKind, Scaling};
use fetifeti::{FetiFeti, Problem};
use petsc::{Options, Session};
use solid::{assembled, Held, Physics, Rows, Solid};

const ELASTIC: Physics = Physics::Elastic { nu: 0.3 };

fn tight() -> MethodSettings {
    MethodSettings::default().rtol(1e-12)
}

fn primal(text: &str) -> MethodSettings {
    tight().primal(Primal::parse(text).expect("constraints"))
}

/// Identities, λ_min, and the distance to the direct solution.
fn verify(session: &Session, solid: &Solid, settings: MethodSettings, what: &str) -> FetiFeti {
    let problem = solid.substructures(|_| true);
    let direct = assembled::solve(&problem);
    let mut solver = FetiFeti::new(session, problem, settings).expect("set up");
    identities(&solver, 1e-10, what);
    let solution = solver.solve().expect("solved");
    assert!(solution.converged(), "{what}: {}", solution.status);
    let size = direct.iter().flatten().fold(0.0f64, |a, u| a.max(u.abs()));
    let pairs = solution.u.iter().flatten().zip(direct.iter().flatten());
    let off = pairs.fold(0.0f64, |a, (u, v)| a.max((u - v).abs()));
    println!(
        "{what}: {} iterations, off by {:.1e}, {:?}",
        solution.iterations,
        off / size,
        solution.kkt
    );
    assert!(off < 1e-9 * size, "{what}: off by {:.1e}", off / size);
    assert!(
        solution.kkt.stationarity < 1e-9,
        "{what}: {:?}",
        solution.kkt
    );
    solver
}

fn lambda_min(solver: &mut FetiFeti, what: &str) {
    let s = solver.spectrum().expect("eigenvalues");
    let s = s.expect("multipliers");
    println!("{what}: {s:?}");
    assert!(s.lambda_min > 1.0 - 1e-6, "{what}: {s:?}");
}

#[test]
fn every_choice_of_constraints_solves() {
    with_session(|session| {
        for physics in [Physics::Scalar, ELASTIC] {
            let solid = Solid::new(3, [2, 2, 3], physics, Rows::Tied);
            for text in ["vertices", "edges", "faces", "vertices,edges,faces"] {
                verify(session, &solid, primal(text), text);
            }
        }
        let solid = Solid::new(3, [1, 3, 2], Physics::Scalar, Rows::Tied);
        for text in ["edges", "edges,faces", "vertices,edges"] {
            lambda_min(&mut verify(session, &solid, primal(text), text), text);
        }
    });
}

/// Six decades between neighbouring subdomains.
fn jumps(_: [usize; 3], place: [usize; 3]) -> f64 {
    [1.0, 1e6][(place[0] + place[1] + place[2]) % 2]
}

#[test]
fn every_scaling_solves_and_jumps_do_no_harm() {
    with_session(|session| {
        for rows in [Rows::Tied, Rows::Normals] {
            let solid = Solid::new(3, [2, 2, 2], ELASTIC, rows);
            for scaling in [Scaling::Rho, Scaling::Stiffness, Scaling::Deluxe] {
                let settings = tight().scaling(scaling);
                let what = format!("{scaling:?}");
                lambda_min(&mut verify(session, &solid, settings, &what), &what);
            }
        }
        for (physics, dim) in [(Physics::Scalar, 3), (ELASTIC, 2)] {
            let solid = Solid {
                stiffness: Some(jumps),
                ..Solid::new(dim, [1, 3, 4], physics, Rows::Tied)
            };
            for scaling in [Scaling::Stiffness, Scaling::Deluxe] {
                let settings = tight().scaling(scaling);
                let mut solver = verify(session, &solid, settings, "jumps");
                let s = solver.spectrum().expect("eigenvalues");
                let s = s.expect("multipliers");
                println!("{scaling:?} {dim}: {s:?}");
                assert!(
                    s.lambda_min > 1.0 - 1e-6 && s.kappa() < 12.0,
                    "{scaling:?}: {s:?}"
                );
            }
        }
    });
}

#[test]
fn floating_and_partly_held_bodies_are_found() {
    with_session(|session| {
        let cases = [
            // One body floats in the middle, with all rigid motions.
            (2, [3, 2, 2], Held::AllRound, 3),
            (3, [3, 1, 2], Held::AllRound, 6),
            (3, [3, 2, 1], Held::AllRound, 6),
            // Two of four bodies float, four of eight.
            (2, [2, 2, 3], Held::Left, 6),
            (3, [2, 2, 2], Held::Left, 24),
        ];
        for (dim, sizes, held, kernel) in cases {
            let solid = Solid {
                held,
                ..Solid::new(dim, sizes, ELASTIC, Rows::Tied)
            };
            let what = format!("{dim}D {sizes:?}");
            let solver = verify(session, &solid, tight(), &what);
            assert_eq!(solver.facts().kernel_dimension, kernel, "{what}");
            let settings = tight().projector(ProjectorKind::Preconditioner);
            verify(session, &solid, settings, &what);
        }
        // Bodies on rollers at x = 0: their kernels have dimension 1 and 3, those of the other bodies 3 and 6.
        for (dim, kernel) in [(2, 2 * (1 + 3)), (3, 4 * (3 + 6))] {
            let solid = Solid {
                held: Held::Rolling,
                ..Solid::new(dim, [2, 2, 2], ELASTIC, Rows::Tied)
            };
            let problem = solid.substructures(|_| true);
            let mut solver = FetiFeti::new(session, problem, tight()).expect("set up");
            assert_eq!(solver.facts().kernel_dimension, kernel);
            for (name, defect) in solver.check().expect("checks run") {
                assert!(
                    defect < 1e-10 || name.contains("lambda_0"),
                    "{name} {defect:.1e}"
                );
            }
            // Nothing holds the whole scene against sliding along x = 0.
            let error = solver.solve().expect_err("the load does not balance");
            assert!(error.to_string().contains("held by nothing"), "{error}");
        }
    });
}

fn refused(session: &Session, problem: Problem) -> String {
    match FetiFeti::new(session, problem, tight()) {
        Ok(_) => panic!("accepted"),
        Err(error) => error.to_string(),
    }
}

#[test]
fn wrong_entities_are_refused() {
    with_session(|session| {
        let good = || Solid::new(3, [1, 2, 3], Physics::Scalar, Rows::Tied).substructures(|_| true);
        let shared = |p: &Problem| {
            let keys = |s: usize| p.local[s].entities.iter().map(|e| e.key);
            let at = keys(0).position(|k| keys(1).any(|other| other == k));
            at.expect("neighbours share an edge or face")
        };
        let edge = |p: &Problem| {
            let is_edge =
                |e: &fetifeti::problem::Entity| e.kind == fetifeti::problem::EntityKind::Edge;
            let other: Vec<u64> = p.local[1].entities.iter().map(|e| e.key).collect();
            let mut list = p.local[0].entities.iter();
            list.position(|e| is_edge(e) && other.contains(&e.key))
                .expect("an edge")
        };
        assert!(shared(&good()) < good().local[0].entities.len());

        let mut p = good();
        let at = edge(&p);
        p.local[0].entities[at].dofs[0] = 1000;
        let text = refused(session, p);
        assert!(
            text.contains("local dof 1000, expected one below"),
            "{text}"
        );

        let mut p = good();
        let first = p.local[0].entities[at].dofs[0];
        p.local[0].entities[at].dofs.push(first);
        let text = refused(session, p);
        assert!(text.contains("listed before"), "{text}");

        let mut p = good();
        p.local[0].entities[at].dofs.pop();
        let text = refused(session, p);
        assert!(text.contains("with different dofs"), "{text}");

        let mut p = good();
        p.local[0].entities.remove(at);
        let text = refused(session, p);
        assert!(text.contains("subdomains hold"), "{text}");

        let mut p = good();
        p.local[0].entities[at].dofs.clear();
        let text = refused(session, p);
        assert!(text.contains("without dofs"), "{text}");

        let options = Options::new(session, "fetifeti_");
        options
            .set_value("primal", Some("vertices,corners"))
            .expect("set");
        let text = refused(session, good());
        options.clear_value("primal").expect("cleared");
        assert!(
            text.contains("vertices,corners") && text.contains("edges"),
            "{text}"
        );
        assert_eq!(Primal::default().name(), "vertices,edges");
    });
}

/// One rank's share of a problem; subdomains are dealt out in turn. Prints the values that must not depend on the
/// number of ranks.
fn on_a_rank(session: &Session, scaling: Scaling) {
    let solid = match scaling {
        Scaling::Deluxe => Solid::new(3, [2, 2, 3], Physics::Scalar, Rows::Tied),
        _ => Solid {
            held: Held::Left,
            plane_edges: true,
            ..Solid::new(2, [2, 3, 3], ELASTIC, Rows::Tied)
        },
    };
    let (size, rank) = (session.size(), session.rank());
    let problem = solid.substructures(|s| s % size == rank);
    let settings = tight().scaling(scaling);
    let mut solver = FetiFeti::new(session, problem, settings).expect("set up");
    identities(&solver, 1e-10, "on ranks");
    let solution = solver.solve().expect("solved");
    let kappa = solver
        .spectrum()
        .expect("eigenvalues")
        .expect("some")
        .kappa();
    if rank == 0 {
        println!(
            "RESULT {} {:.12e} {kappa:.12e} {}",
            solution.iterations,
            solution.energy,
            solver.facts().primal
        );
    }
}

#[test]
fn one_two_and_four_ranks_agree() {
    let started = mpi::as_rank(|session, case| {
        let scaling = match case {
            "deluxe" => Scaling::Deluxe,
            _ => Scaling::Stiffness,
        };
        on_a_rank(session, scaling);
        Ok(())
    });
    for case in sample(2, ["deluxe", "stiffness"]) {
        let results = [1, 2, 4].map(|ranks| started.numbers(ranks, case));
        let one = &results[0];
        for other in &results[1..] {
            assert!((one[0] - other[0]).abs() <= 1.0, "{case}: {results:?}");
            assert!(
                (one[1] / other[1] - 1.0).abs() < 1e-9,
                "{case}: {results:?}"
            );
            assert!(
                (one[2] / other[2] - 1.0).abs() < 1e-6,
                "{case}: {results:?}"
            );
            assert_eq!(one[3], other[3], "{case}: {results:?}");
        }
    }
}

//! Random contact scenes by the method, with both contact loops and on several ranks, against the assembled reference.

mod assembled;
mod mpi;
mod qp;
mod random_scene;
mod rng;

use assembled::compare::{compare, Agreement, Candidate, Tolerances};
use fetifeti::contact::ContactType;
use fetifeti::feti::exchange::gather_all;
use fetifeti::feti::{FetiFeti, Settings};
use fetifeti::petsc::testing::with_session;
use fetifeti::petsc::Session;
use fetifeti::{Error, Result};
use random_scene::{Case, Collection, Fate};
use std::collections::HashMap;

const KINDS: [ContactType; 2] = [ContactType::ActiveSet, ContactType::Smalbe];

fn settings(kind: ContactType) -> Settings {
    let mut settings = Settings {
        rtol: 1e-11,
        ..Settings::default()
    };
    settings.contact.kind = kind;
    settings
}

/// The answer of the method, on every rank the whole of it: u by unknown, λ by row of the scene, energy.
fn answer(session: &Session, case: &Case, kind: ContactType) -> Result<(Vec<f64>, Vec<f64>, f64)> {
    let (rank, size) = (session.rank(), session.size());
    // Runs of subdomains, or dealt like cards.
    let share = fetifeti::share(session, case.scene.n_subdomains());
    let mine = |s: usize| match case.seed % 2 {
        0 => share.contains(&s),
        _ => s % size == rank,
    };
    let solver = FetiFeti::new(session, case.scene.substructures(&mine)?, settings(kind))?;
    let solution = solver.solve()?;
    if !solution.converged {
        let reason = format!("not converged: {}", solution.reason);
        return Err(Error::input(reason));
    }

    let comm = session.comm();
    let all = |values: Vec<u64>| gather_all(comm, &values).concat();
    let subdomains = &solver.problem().local;
    let dofs = subdomains.iter().flat_map(|s| s.dofs.iter().copied());
    let values = solution.u.iter().flatten().map(|u| u.to_bits());
    let (dofs, values) = (all(dofs.collect()), all(values.collect()));
    let copies = dofs.iter().zip(values.into_iter().map(f64::from_bits));
    let u = case.problem.gather(copies.map(|(&d, u)| (d, u)), 1e-8);

    // The rows that a rank provides are those of the scene at its points, in the same order.
    let places = case.scene.points.iter().map(|p| (p.block, p.subdomain));
    let places: HashMap<u64, usize> = places.collect();
    let provided: Vec<u64> = (0..case.problem.rows.len())
        .filter(|&r| mine(places[&case.problem.rows[r].block]))
        .map(|r| r as u64)
        .collect();
    let dual = solver.dual();
    let jump = &dual.stiffness.jump;
    let contact = &solution.lambda[jump.n_owned_local..];
    let rows = all(jump.order.iter().map(|&k| provided[k]).collect());
    let values = all(contact.iter().map(|l| l.to_bits()).collect());
    let mut lambda = vec![f64::NAN; case.problem.rows.len()];
    for (row, value) in rows.into_iter().zip(values) {
        lambda[row as usize] = f64::from_bits(value);
    }
    Ok((u.map_err(Error::input)?, lambda, solution.energy))
}

fn judge(
    session: &Session,
    case: &Case,
    kind: ContactType,
) -> std::result::Result<Agreement, String> {
    let Fate::Solvable(reference) = &case.fate else {
        panic!("seed {} has no solution", case.seed)
    };
    let (u, lambda, energy) = answer(session, case, kind).map_err(|e| e.to_string())?;
    let answer = Candidate {
        u: &u,
        lambda: &lambda,
        energy,
    };
    compare(&case.problem, reference, &answer, &Tolerances::default())
}

/// Solves all cases and says which fail, and the worst that was let pass.
fn all_agree(
    session: &Session,
    cases: &[Case],
    kind: ContactType,
) -> std::result::Result<(), String> {
    let mut wrong = Vec::new();
    let (mut energy, mut u, mut kkt, mut degenerate) = (0.0f64, 0.0f64, 0.0f64, 0);
    for case in cases {
        match judge(session, case, kind) {
            Ok(a) => {
                energy = energy.max(a.energy);
                u = u.max(a.u);
                kkt = kkt.max(a.kkt.largest());
                degenerate += usize::from(a.degenerate > 0);
            }
            Err(why) => wrong.push(format!("seed {}: {why}", case.seed)),
        }
    }
    if session.rank() == 0 {
        println!(
            "{kind:?}: {} of {} agree; energy within {energy:.1e}, u {u:.1e}, KKT {kkt:.1e}; {degenerate} with degenerate rows",
            cases.len() - wrong.len(),
            cases.len()
        );
    }
    if wrong.is_empty() {
        Ok(())
    } else {
        Err(format!("{} scenes:\n{}", wrong.len(), wrong.join("\n")))
    }
}

fn on_one_rank(kind: ContactType) {
    with_session(move |session| {
        let cases = Collection::new(0, 500).solvable;
        if let Err(why) = all_agree(session, &cases, kind) {
            panic!("{why}");
        }
    });
}

#[test]
fn five_hundred_random_scenes_by_active_sets() {
    on_one_rank(ContactType::ActiveSet);
}

#[test]
fn five_hundred_random_scenes_by_smalbe() {
    on_one_rank(ContactType::Smalbe);
}

#[test]
fn scenes_without_a_solution_are_refused() {
    with_session(|session| {
        let cases = Collection::new(0, 500);
        let mut wrong = Vec::new();
        for kind in KINDS {
            for case in cases.unbounded.iter().chain(&cases.infeasible) {
                // The message names a body: one that moves for ever, or one whose rows contradict each other.
                let moves = |b: usize| match &case.fate {
                    Fate::Unbounded(z) => {
                        let of_body = z.iter().zip(&case.problem.body);
                        of_body.into_iter().any(|(z, &body)| body == b && *z != 0.0)
                    }
                    _ => true,
                };
                let named = |why: &str| {
                    let bodies = case.scene.bodies.iter().enumerate();
                    let mut blamed = bodies.filter(|(b, _)| moves(*b));
                    blamed.any(|(_, body)| why.contains(&body.spec.name))
                };
                match answer(session, case, kind) {
                    Err(Error::Input(why)) if named(&why) => {}
                    Err(why) => wrong.push(format!("seed {}, {kind:?}: {why}", case.seed)),
                    Ok(_) => wrong.push(format!("seed {}, {kind:?}: solved", case.seed)),
                }
            }
        }
        assert!(wrong.is_empty(), "{}:\n{}", wrong.len(), wrong.join("\n"));
    });
}

/// What runs under mpirun.
#[test]
fn on_ranks() {
    if mpi::case().is_none() {
        return;
    }
    let session = Session::new(&[], "").expect("PETSc starts");
    let code = session.run(|session| {
        let cases = Collection::new(10_000, 40).solvable;
        for kind in KINDS {
            all_agree(session, &cases, kind).map_err(Error::input)?;
        }
        Ok(())
    });
    std::process::exit(code);
}

#[test]
fn random_scenes_on_two_and_four_ranks() {
    for ranks in [2, 4] {
        let out = mpi::run_case(ranks, "scenes");
        assert_eq!(out.code, 0, "{ranks} ranks: {}", out.all());
    }
}

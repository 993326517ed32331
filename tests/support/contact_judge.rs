//! The method's answer to a scene, compared with the assembled reference.

use super::assembled::compare::{compare, Agreement, Candidate, Tolerances};
use super::assembled::{Assembled, Reference};
use base::{Error, Result};
use fetifeti::settings::{ContactType, MethodSettings, ProjectorKind};
use fetifeti::{FetiFeti, Settings};
use parallel::exchange::gather_all;
use petsc::Session;
use scene::Scene;
use std::collections::HashMap;

/// The loop, the number of rows from which a block is scaled with a sparse factorisation, and the
/// projector's weight.
#[derive(Debug, Clone, Copy)]
pub struct How {
    pub kind: ContactType,
    pub coupled: usize,
    pub projector: ProjectorKind,
}

impl From<ContactType> for How {
    fn from(kind: ContactType) -> How {
        let MethodSettings {
            coupled, projector, ..
        } = MethodSettings::default();
        How {
            kind,
            coupled,
            projector,
        }
    }
}

fn settings(how: How) -> Settings {
    let mut settings = Settings::from(
        MethodSettings::default()
            .rtol(1e-11)
            .coupled(how.coupled)
            .projector(how.projector),
    );
    settings.contact.kind = how.kind;
    settings
}

/// The whole answer of the method on every rank: u by unknown, λ by row of the scene, energy.
pub fn answer(
    session: &Session,
    scene: &Scene,
    problem: &Assembled,
    cards: bool,
    how: impl Into<How>,
) -> Result<(Vec<f64>, Vec<f64>, f64)> {
    let (rank, size) = (session.rank(), session.size());
    // Subdomains are distributed in contiguous runs, or in turn.
    let share = fetifeti::share(session, scene.n_subdomains());
    let mine = |s: usize| {
        if cards {
            s % size == rank
        } else {
            share.contains(&s)
        }
    };
    let mut solver = FetiFeti::new(session, scene.substructures(&mine)?, settings(how.into()))?;
    let solution = solver.solve()?;
    if !solution.converged() {
        let reason = format!("not converged: {}", solution.status);
        return Err(Error::input(reason));
    }

    let comm = session.comm();
    let subdomains = &solver.problem().local;
    let dofs = subdomains.iter().flat_map(|s| s.dofs.iter().copied());
    let dofs = gather_all(comm, &dofs.collect::<Vec<u64>>()).concat();
    let values = gather_all(comm, &solution.u.concat()).concat();
    let u = problem.gather(dofs.into_iter().zip(values), 1e-8);

    // The rows that a rank provides are those of the scene at its points, in the same order.
    let places = scene.points.iter().map(|p| (p.block, p.subdomain));
    let places: HashMap<u64, usize> = places.collect();
    let provided: Vec<usize> = (0..problem.rows.len())
        .filter(|&r| mine(places[&problem.rows[r].block]))
        .collect();
    let solved: Vec<f64> = solution.rows().iter().map(|r| r.multiplier).collect();
    let rows = gather_all(comm, &provided).concat();
    let values = gather_all(comm, &solved).concat();
    let mut lambda = vec![f64::NAN; problem.rows.len()];
    for (row, value) in rows.into_iter().zip(values) {
        lambda[row] = value;
    }
    Ok((u.map_err(Error::input)?, lambda, solution.energy))
}

/// Compares the answer with the reference.
pub fn judge(
    session: &Session,
    (scene, problem, reference): (&Scene, &Assembled, &Reference),
    cards: bool,
    how: impl Into<How>,
) -> std::result::Result<Agreement, String> {
    let answer = answer(session, scene, problem, cards, how);
    let (u, lambda, energy) = answer.map_err(|e| e.to_string())?;
    let answer = Candidate {
        u: &u,
        lambda: &lambda,
        energy,
    };
    compare(problem, reference, &answer, &Tolerances::default())
}

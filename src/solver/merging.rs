//! Bodies that the method has as one, and what callers are told of them: bodies and rows as they were given.

use super::FetiFeti;
use crate::feti::settings::{MergeKind, MethodSettings};
use crate::feti::FreeMotion;
use crate::substructures::merged::{Copies, Merged};
use crate::substructures::{EntityKind, Problem};
use petsc::Session;

/// The problem that the method gets, and the bodies that are one in it. Collective.
pub(super) fn merged(
    session: &Session,
    problem: Problem,
    settings: &MethodSettings,
) -> (Problem, Option<Merged>) {
    let copies = match settings.merge {
        MergeKind::Ties => Copies::Merge,
        MergeKind::Auto if problem.ragged => Copies::Stay,
        MergeKind::None | MergeKind::Auto => return (problem, None),
    };
    let edges = settings.primal.takes(EntityKind::Edge);
    let averaged = [EntityKind::Face, EntityKind::Edge][usize::from(edges)];
    Merged::new(session.comm(), problem, averaged, copies)
}

/// The names of the groups of several bodies that the method will have as one. Collective.
pub fn groups(session: &Session, problem: Problem, settings: &MethodSettings) -> Vec<String> {
    let (problem, merged) = merged(session, problem, settings);
    let several = merged.iter().flat_map(Merged::several);
    several.map(|g| problem.body_names[g].clone()).collect()
}

impl FetiFeti {
    /// The motions of bodies that the rows which hold leave free: after a solve those that no load drives. The place of
    /// the bodies along them is arbitrary, and a solution has the one nearest to the start. Collective.
    pub fn free_motions(&self) -> Vec<FreeMotion> {
        let dual = self.dual();
        let problem = &self.method.problem;
        let mut motions = { &dual.natural }.free_motions(dual.comm(), problem, &dual.stiffness);
        for motion in &mut motions {
            let given = 0..self.problem().n_bodies;
            let moved = given.filter(|b| motion.bodies.contains(&self.group(*b)));
            motion.bodies = moved.collect();
        }
        motions
    }

    /// The problem as it was given.
    pub fn problem(&self) -> &Problem {
        match &self.merged {
            Some(merged) => merged.given(),
            None => &self.method.problem,
        }
    }

    /// The number that a body has in the method: several have one where they are merged.
    pub fn group(&self, body: usize) -> usize {
        self.merged.as_ref().map_or(body, |m| m.group(body))
    }

    /// Number of bodies that the method has.
    pub fn n_groups(&self) -> usize {
        let groups = self.merged.as_ref().map(Merged::n_groups);
        groups.unwrap_or(self.method.problem.n_bodies)
    }

    /// Number of rows that this rank has provided and the method has not: those between bodies that are merged.
    pub fn n_merged_rows(&self) -> usize {
        self.problem().rows.len() - self.method.problem.rows.len()
    }

    /// The place of the row between bodies that this rank owns as number `i` among those that it
    /// has provided.
    pub fn given_row(&self, i: usize) -> usize {
        let k = self.dual().stiffness.jump.given(i);
        self.merged.as_ref().map_or(k, |m| m.given_row(k))
    }

    /// Values of the rows between bodies that this rank owns, for those that it has provided; 0 for rows that merging
    /// has left no trace of.
    pub fn in_given_order(&self, owned: &[f64]) -> Vec<f64> {
        let of_method = self.dual().stiffness.jump.in_given_order(owned);
        let Some(merged) = &self.merged else {
            return of_method;
        };
        let mut out = vec![0.0; merged.given().rows.len()];
        let all = of_method.into_iter().enumerate();
        all.for_each(|(k, value)| out[merged.given_row(k)] = value);
        out
    }
}

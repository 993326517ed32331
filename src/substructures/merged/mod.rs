//! Bodies that are tied for good become one: FETI-DP holds them together, and no row between them is left.
//!
//! A tie of a whole face whose nodes match never opens. With a row for each dof of the face its displacements are equal
//! in the solution alone; as dofs that two subdomains of one body share, they are equal at the vertices and in the
//! averages during the whole iteration. The method gets a problem of *groups* of bodies ([`Merged::problem`]), in which
//! tied dofs have one number. What a caller gave stays as it was, and after a solve the multipliers of the rows that
//! the method has not seen follow from the equilibrium of the nodes ([`Merged::rows`]):
//!
//! ```text
//!     K u + Bᵀ λ = f     ⇒     B_mᵀ λ_m = f − K u − B_oᵀ λ_o       (m: merged rows, o: others)
//! ```
//!
//! Merged are two bodies between which all rows are equations u_a − u_b = 0 that hold. Ties of a part of a face (they
//! come with rows that do not hold), of sides whose nodes do not match, with a gap, and beside contact between the same
//! two bodies stay rows.

mod forces;
mod groups;
mod interface;
mod renumbered;
mod shared;

use mpi::topology::SimpleCommunicator;

use super::{FrictionNode, Problem, Row, SolvedRow, Subdomain};
use crate::{Error, Result};
pub use groups::Copies;
use groups::Groups;
use interface::TiedDofs;

/// The bodies of a problem in groups.
pub struct Merged {
    /// As it was given.
    given: Problem,
    groups: Groups,
    dofs: TiedDofs,
    /// Whether each row of this rank is one inside a group.
    inside: Vec<bool>,
    /// The others, by their place among all.
    kept: Vec<usize>,
}

/// Rows that are to take the place of others.
pub struct NewRows {
    rows: Vec<Row>,
    friction: Vec<FrictionNode>,
    inside: Vec<bool>,
    left: (Vec<Row>, Vec<FrictionNode>),
}

impl NewRows {
    /// The rows and the friction that the method gets.
    pub fn of_method(&self) -> (Vec<Row>, Vec<FrictionNode>) {
        self.left.clone()
    }
}

impl Merged {
    /// The groups of a problem and the problem of these groups; the problem as it was where nothing is merged.
    /// `averaged` is the kind of the faces between merged bodies. Collective.
    pub fn new(
        comm: &SimpleCommunicator,
        given: Problem,
        averaged: super::EntityKind,
        copies: Copies,
    ) -> (Problem, Option<Merged>) {
        let Some(groups) = Groups::new(comm, &given, copies) else {
            return (given, None);
        };
        let dofs = TiedDofs::new(comm, &given, &groups);
        let inside: Vec<bool> = { given.rows.iter() }
            .map(|row| groups.is_inside(&dofs, row))
            .collect();
        let problem = renumbered::problem(comm, &given, &groups, &dofs, &inside, averaged);
        let merged = Merged {
            kept: kept(&inside),
            given,
            groups,
            dofs,
            inside,
        };
        (problem, Some(merged))
    }

    /// The problem as it was given.
    pub fn given(&self) -> &Problem {
        &self.given
    }

    /// The group of a body.
    pub fn group(&self, body: usize) -> usize {
        self.groups.of[body]
    }

    /// The groups of several bodies.
    pub fn several(&self) -> impl Iterator<Item = usize> + '_ {
        let members = self.groups.members.iter().enumerate();
        members.filter(|(_, m)| m.len() > 1).map(|(g, _)| g)
    }

    /// Number of groups.
    pub fn n_groups(&self) -> usize {
        self.groups.members.len()
    }

    /// Replaces the loads; returns the right-hand sides of the rows that the method has.
    ///
    /// # Panics
    /// If a length differs, or a tie of the group has got a right-hand side.
    pub fn load(&mut self, loads: &[Vec<f64>], gaps: &[f64]) -> Vec<f64> {
        assert_eq!(
            (loads.len(), gaps.len()),
            (self.given.local.len(), self.inside.len())
        );
        for (sub, f) in self.given.local.iter_mut().zip(loads) {
            sub.f.clone_from(f);
        }
        for (row, gap) in self.given.rows.iter_mut().zip(gaps) {
            row.gap = *gap;
        }
        let mut left = Vec::new();
        for (gap, inside) in gaps.iter().zip(&self.inside) {
            match inside {
                true => assert_eq!(*gap, 0.0, "bodies of one group are tied without a gap"),
                false => left.push(*gap),
            }
        }
        left
    }

    /// Other rows of this rank, with friction among them.
    ///
    /// # Errors
    /// A tie between bodies of one group that is another one than before.
    pub fn with_rows(&self, rows: Vec<Row>, friction: Vec<FrictionNode>) -> Result<NewRows> {
        let inside: Vec<bool> = { rows.iter() }
            .map(|row| self.groups.is_inside(&self.dofs, row))
            .collect();
        let ties = |inside: &[bool]| inside.iter().filter(|i| **i).count();
        if ties(&inside) != ties(&self.inside) {
            return Err(Error::input(
                "ties between bodies that are merged have changed, expected the same (-fetifeti_merge none keeps them)",
            ));
        }
        let (left, moved) = renumbered::rows(&rows, &friction, &self.dofs, &inside);
        Ok(NewRows {
            rows,
            friction,
            inside,
            left: (left, moved),
        })
    }

    /// Replaces the rows by others that the method has taken.
    pub fn take(&mut self, new: NewRows) {
        self.given.rows = new.rows;
        self.given.friction = new.friction;
        self.kept = kept(&new.inside);
        self.inside = new.inside;
    }

    /// Takes the matrices that the method has now.
    pub fn renew(&mut self, local: &[Subdomain]) {
        for (sub, of_method) in self.given.local.iter_mut().zip(local) {
            sub.k = of_method.k.clone();
            sub.f.clone_from(&of_method.f);
            sub.rho.clone_from(&of_method.rho);
        }
    }

    /// The entries of `all`, one for each given row, that belong to rows of the method.
    pub fn of_method<'a, T>(
        &'a self,
        all: impl IntoIterator<Item = T> + 'a,
    ) -> impl Iterator<Item = T> + 'a {
        let kept = all.into_iter().zip(&self.inside);
        kept.filter(|(_, inside)| !**inside).map(|(value, _)| value)
    }

    /// The place among the given rows of row `k` of those that the method has.
    pub fn given_row(&self, k: usize) -> usize {
        self.kept[k]
    }

    /// The rows as they were given, after a solve: those of the method are `solved`. `forces` are f − K u of each local
    /// subdomain. Collective.
    pub fn rows(
        &self,
        comm: &SimpleCommunicator,
        forces: &[Vec<f64>],
        solved: Vec<SolvedRow>,
    ) -> Vec<SolvedRow> {
        let multipliers = forces::multipliers(comm, self, forces, &solved);
        let mut solved = solved.into_iter();
        let mut found = multipliers.into_iter();
        let row = |(row, inside): (&Row, &bool)| match inside {
            false => solved.next().expect("the method has all others"),
            true => {
                let multiplier = found.next().expect("one for each");
                SolvedRow::new(row, multiplier, 0.0, true)
            }
        };
        self.given.rows.iter().zip(&self.inside).map(row).collect()
    }
}

/// The places of the rows that are not inside a group.
fn kept(inside: &[bool]) -> Vec<usize> {
    (0..inside.len()).filter(|&k| !inside[k]).collect()
}

//! Rows that the host adds to the assembled problem: contact between bodies, obstacles, equations.
//!
//! The host numbers global dofs, the method numbers body dofs. The method also wants rows that share a dof on the same
//! rank: the lowest dof of a block of connected rows determines the rank that takes the block.

use std::collections::HashMap;

use super::friction;
use super::known_dofs::KnownDofs;
use super::placed::LocatedRow;
use super::torn::{GivenRow, GivenRows};
use super::touched::{RankProblem, Touched};
use crate::substructures::{FrictionNode, Law, Row};
use crate::{Error, Result};
use bytemuck::{Pod, Zeroable};
use parallel::exchange::{any, exchange, exchange_by_rank, total};
use parallel::parcels::Parcels;
use petsc::Session;

/// A row on the rank that takes it.
struct AcceptedRow {
    /// The rank that gave it, and its number among the rows given there.
    from: (usize, usize),
    /// The row as the method gets it.
    row: Row,
    /// (place in the list of known dofs, coefficient) of its terms at known dofs.
    known: Vec<(usize, f64)>,
}

/// A number about a row, by the number of the row on the rank that gave it.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct RowValue {
    row: usize,
    value: f64,
}

/// The host's rows, distributed over the ranks.
#[derive(Default)]
pub struct HostContact {
    taken: Vec<AcceptedRow>,
    /// The block of every unknown of this rank's subdomains that appears in a row, by global dof. A block is named by
    /// its lowest dof.
    block: HashMap<u32, u32>,
    /// The rank that takes each row that this rank gave; `None` for rows without unknowns.
    homes: Vec<Option<usize>>,
    /// The known dofs in this rank's rows; `None` if no row on any rank has one.
    known: Option<KnownDofs>,
    /// The nodes with friction, by the places of their rows among those that this rank takes.
    pub friction: Vec<FrictionNode>,
    /// Number of rows over all ranks.
    pub n_global: usize,
    /// Whether any row on any rank is an inequality.
    pub inequalities: bool,
}

impl HostContact {
    /// Distributes the rows `given` by this rank. Collective.
    ///
    /// # Errors
    /// A row with a dof that no subdomain has, the same error on all ranks; PETSc's own.
    pub fn new(
        session: &Session,
        given: &GivenRows,
        here: &RankProblem<'_>,
    ) -> Result<HostContact> {
        let comm = session.comm();
        let n_global = total(comm, given.rows.len() as f64) as usize;
        if n_global == 0 {
            return Ok(HostContact::default());
        }
        let touched = Touched::new(session, given, here)?;
        let place = |(r, row): (usize, &GivenRow)| {
            LocatedRow::new(r, row, &touched).map_err(|dof| {
                let tangential = |node: &&FrictionNode| node.tangential.contains(&r);
                let (what, r) = match given.friction.iter().find(tangential) {
                    Some(node) => ("friction of contact row", node.normal),
                    None => ("contact row", r),
                };
                Error::input(format!(
                    "{what} {r} of rank {} has a coefficient at unknown {dof}, \
                     which no subdomain has, expected unknowns of subdomains",
                    session.rank()
                ))
            })
        };
        let placed = given.rows.iter().enumerate().map(place);
        let mut placed: Vec<Option<LocatedRow>> = session.agree(placed.collect())?;
        friction::leave_out(&given.friction, &mut placed);
        let home = |row: &LocatedRow| row.block as usize % session.size();
        let homes: Vec<Option<usize>> = placed.iter().map(|p| p.as_ref().map(home)).collect();
        let mut outgoing = Parcels::for_each_rank(comm);
        for row in placed.iter().flatten() {
            row.give(&mut outgoing[home(row)]);
        }
        let mut rows: Vec<(usize, LocatedRow)> = Vec::new();
        for (rank, sent) in exchange_by_rank(comm, outgoing).iter().enumerate() {
            rows.extend(sent.iter().map(|row| (rank, LocatedRow::received(row))));
        }
        let terms = || rows.iter().flat_map(|(_, row)| row.known());
        let known = any(comm, terms().next().is_some());
        let known = known.then(|| KnownDofs::new(session, terms().map(|t| (t.0, t.1))));
        let taken = |(rank, row): &(usize, LocatedRow)| AcceptedRow {
            from: (*rank, row.number),
            row: row.row(here.layout.global_len()),
            known: known.as_ref().map_or(Vec::new(), |known| {
                row.known()
                    .map(|(rank, dof, c)| (known.place(rank, dof), c))
                    .collect()
            }),
        };
        let places = rows.iter().enumerate();
        let places: HashMap<(usize, usize), usize> = places
            .map(|(place, (rank, row))| ((*rank, row.number), place))
            .collect();
        let nodes = friction::forth(session, &given.friction, &homes, &places);
        Ok(HostContact {
            friction: nodes,
            taken: rows.iter().map(taken).collect(),
            block: touched.here,
            homes,
            known,
            n_global,
            inequalities: any(comm, given.rows.iter().any(|r| r.law.is_inequality())),
        })
    }

    /// The block of a global dof of this rank's subdomains, if a row contains the dof.
    pub fn block(&self, dof: u32) -> Option<u32> {
        self.block.get(&dof).copied()
    }

    /// This rank's rows for the method.
    pub fn rows(&self) -> impl Iterator<Item = Row> + '_ {
        self.taken.iter().map(|t| t.row.clone())
    }

    /// The laws of this rank's rows.
    pub fn laws(&self) -> impl Iterator<Item = Law> + '_ {
        self.taken.iter().map(|t| t.row.law)
    }

    /// The nodes with friction by the places of their rows behind so many others.
    pub fn friction_behind(&self, others: usize) -> Vec<FrictionNode> {
        let nodes = self.friction.iter();
        let behind = nodes.map(|node| {
            let tangential = node.tangential.iter().map(|t| others + t);
            FrictionNode::new(others + node.normal, tangential.collect(), node.bound)
        });
        behind.collect()
    }

    /// Right-hand sides of this rank's rows, with the terms at known dofs moved there. `values` has the values of the
    /// known dofs of this rank's subdomains, by global dof. Collective.
    pub fn gaps(&self, session: &Session, values: &HashMap<u32, f64>) -> Vec<f64> {
        let values = match &self.known {
            None => Vec::new(),
            Some(known) => known.fetch(session, values),
        };
        let gap = |t: &AcceptedRow| {
            let moved: f64 = t.known.iter().map(|&(k, c)| c * values[k]).sum();
            t.row.gap - moved
        };
        self.taken.iter().map(gap).collect()
    }

    /// Passes what this rank knows of each row that it gave to the ranks that take them; returned is what is known of
    /// each row that this rank takes. Collective.
    pub fn forth<T: Pod>(&self, session: &Session, mine: &[T]) -> Vec<T> {
        let mut outgoing = vec![Vec::new(); session.size()];
        for (home, value) in self.homes.iter().zip(mine) {
            if let Some(home) = home {
                outgoing[*home].push(*value);
            }
        }
        // Rows are taken in the order of the ranks that gave them, and of their numbers there.
        exchange(session.comm(), outgoing)
    }

    /// Replaces the right-hand sides; `mine` has those of the rows that this rank gave. Collective.
    pub fn set_gaps(&mut self, session: &Session, mine: &[f64]) {
        let new = self.forth(session, mine);
        for (taken, gap) in self.taken.iter_mut().zip(new) {
            taken.row.gap = gap;
        }
    }

    /// Returns one number per row, `mine`, to the ranks that gave the rows; zero for rows without unknowns. Collective.
    pub fn back(&self, session: &Session, mine: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut outgoing: Vec<Vec<RowValue>> = vec![Vec::new(); session.size()];
        for (t, value) in self.taken.iter().zip(mine) {
            let (rank, row) = t.from;
            outgoing[rank].push(RowValue { row, value });
        }
        let mut out = vec![0.0; self.homes.len()];
        for RowValue { row, value } in exchange(session.comm(), outgoing) {
            out[row] = value;
        }
        out
    }
}

//! A solver that is set up, for other gaps, other rows or other matrices: what stays right is kept.

use std::cell::RefCell;
use std::collections::HashMap;

use super::contact::HostContact;
use super::frame::Local;
use super::rows::rows;
use super::solver::{ContactEnd, Embedded, GivenResults};
use super::torn::{GivenRow, GivenRows};
use super::touched::RankProblem;
use crate::feti::Numbers;
use crate::substructures::{BodyNode, Row, RowLabel, RowSource};
use crate::{FetiFeti, Result};
use base::linalg::csr::Csr;
use base::ErrorKind;
use parallel::exchange::any;
use petsc::Mat;

/// Rows in the place of those that a solver has.
struct Replaced {
    contact: HostContact,
    given: GivenRows,
    n_ties: usize,
    /// The rows of the solver.
    rows: Vec<Row>,
    /// `None` where nothing has been solved.
    start: Option<ContactStart>,
}

/// From where the contact loop starts.
struct ContactStart {
    /// Multipliers inside bodies.
    inside: Vec<f64>,
    /// Multiplier and state of the solver's rows.
    rows: Vec<(f64, bool)>,
    /// Multipliers and states of the rows that this rank gave.
    given: GivenResults,
}

/// The subject of a row of the host: the node of its first term, its kind, and its number among the rows with these.
type Subject = (u32, u64, usize);

impl Embedded {
    /// Whether a MATIS has the layout and the block size of the one that was set up. Collective.
    ///
    /// # Errors
    /// PETSc's own.
    pub fn fits(&self, a: &Mat) -> Result<bool> {
        if a.type_name()? != "is" || a.block_size()? != self.frame.block_size {
            return Ok(false);
        }
        let (layout, known) = (a.right_vec()?, &self.frame.layout);
        let other = layout.ownership_range() != known.ownership_range()
            || layout.global_len() != known.global_len();
        Ok(!any(self.session.comm(), other))
    }

    /// Whether a global dof of this rank's matrices is known; `None` if they do not have it.
    pub fn is_known(&self, dof: u32) -> Option<bool> {
        let there = self.frame.ghosts.binary_search(&dof).is_ok();
        there.then(|| self.frame.known.contains(&dof))
    }

    /// The right-hand sides of the rows that this rank gave.
    pub fn gaps(&self) -> impl Iterator<Item = f64> + '_ {
        self.given.rows.iter().map(|row| row.gap)
    }

    /// Replaces the right-hand sides of the rows that this rank gave; nothing is set up. Collective.
    pub fn set_gaps(&mut self, gaps: &[f64]) {
        self.contact.set_gaps(&self.session, gaps);
        for (row, &gap) in self.given.rows.iter_mut().zip(gaps) {
            row.gap = gap;
        }
    }

    /// Replaces the rows that this rank gave. Subdomains whose interface stays the same stay factored. Rows that are
    /// about the same node as an earlier one start from its multiplier. Collective.
    ///
    /// # Errors
    /// A row with a dof that no subdomain has, and what [`FetiFeti::set_rows`] says; then nothing has changed.
    pub fn set_rows(&mut self, given: GivenRows) -> Result<()> {
        let new = self.replaced(given)?;
        let friction = new.contact.friction_behind(new.n_ties);
        self.solver.get_mut().set_rows(new.rows, friction)?;
        let solver = self.solver.borrow();
        self.reached = reached(&solver, new.n_ties, new.start);
        (self.contact, self.given, self.n_ties) = (new.contact, new.given, new.n_ties);
        drop(solver);
        Ok(())
    }

    /// The solver for other matrices, with other rows if there are some. `None` if the matrices do not fit the
    /// structure that was found for the present ones: everything has to be set up anew. Collective.
    ///
    /// # Errors
    /// As [`Embedded::set_rows`]; the solver is gone.
    pub fn renewed(
        mut self,
        given: &[Local<'_>],
        rows: Option<GivenRows>,
    ) -> Result<Option<Embedded>> {
        let session = self.session.clone();
        let found = {
            let solver = self.solver.borrow();
            let patterns: Vec<&Csr> = solver.problem().local.iter().map(|s| &*s.k).collect();
            self.frame.numbers(&patterns, given)
        };
        if any(session.comm(), found.is_none()) {
            return Ok(None);
        }
        let mut found = found.expect("every rank has them");
        let new = rows.map(|rows| self.replaced(rows)).transpose()?;
        self.shares
            .renew(&self.halo, &self.frame.layout, &mut found)?;
        let numbers = found.k.into_iter().zip(found.diagonal);
        let numbers = numbers.map(|(k, rho)| Numbers { k, rho }).collect();
        let (rows, rest) = match new {
            None => (None, None),
            Some(new) => (
                Some((new.rows, new.contact.friction_behind(new.n_ties))),
                Some((new.contact, new.given, new.n_ties, new.start)),
            ),
        };
        let solver = match self.solver.into_inner().renewed(numbers, rows) {
            Ok(Some(solver)) => solver,
            // The set-up of everything says what is wrong with the matrix.
            Ok(None) => return Ok(None),
            Err(error) if error.kind() == ErrorKind::Unfit => return Ok(None),
            Err(other) => return Err(other),
        };
        let mut out = Embedded {
            solver: RefCell::new(solver),
            ..self
        };
        if let Some((contact, given, n_ties, start)) = rest {
            out.reached = reached(&out.solver.borrow(), n_ties, start);
            (out.contact, out.given, out.n_ties) = (contact, given, n_ties);
        }
        Ok(Some(out))
    }

    /// Other rows than those that this rank gave. Collective.
    fn replaced(&self, given: GivenRows) -> Result<Replaced> {
        let (session, frame) = (&self.session, &self.frame);
        let (n, parts) = (frame.n_global, &frame.parts);
        let here = RankProblem {
            layout: &frame.layout,
            ghosts: &frame.ghosts,
            halo: &self.halo,
            known: &frame.known,
            parts,
            body_of: &frame.bodies.mine,
        };
        let contact = HostContact::new(session, &given, &here)?;
        let mut all = rows(session, n, parts, &frame.sharers, &frame.bodies, &contact);
        let n_ties = all.len();
        all.extend(contact.rows());
        let some = any(session.comm(), self.reached.borrow().is_some());
        let start = some.then(|| self.start(&contact, &given.rows, &all[..n_ties]));
        Ok(Replaced {
            contact,
            given,
            n_ties,
            rows: all,
            start,
        })
    }

    /// Where the loop with other rows starts. Collective.
    fn start(&self, contact: &HostContact, given: &[GivenRow], ties: &[Row]) -> ContactStart {
        let empty = (Vec::new(), Vec::new(), GivenResults::default());
        let reached = self.reached.borrow();
        let (inside, of_ties, results) = reached.as_ref().map_or(empty, |r| {
            (r.inside.clone(), r.ties.clone(), r.given.clone())
        });
        let solver = self.solver.borrow();
        let before = solver.problem().rows[..self.n_ties].iter();
        let before = before.map(|row| label_key(&row.label)).zip(of_ties);
        let before: HashMap<_, f64> = before.collect();
        let mut rows: Vec<(f64, bool)> = ties
            .iter()
            .map(|row| {
                let known = before.get(&label_key(&row.label));
                (known.copied().unwrap_or(0.0), true)
            })
            .collect();
        let each = results.multipliers.into_iter().zip(results.holds);
        let before = subjects(&self.given.rows, self.frame.block_size).into_iter();
        let known: HashMap<Subject, (f64, bool)> = before.zip(each).collect();
        // Rows about something new hold to begin with.
        let now = subjects(given, self.frame.block_size).into_iter();
        let now = now.map(|s| known.get(&s).copied().unwrap_or((0.0, true)));
        let now: Vec<(f64, bool)> = now.collect();
        let mine = now.iter().map(|&(m, holds)| [m, f64::from(holds)]);
        let taken = contact.forth(&self.session, &mine.collect::<Vec<_>>());
        rows.extend(taken.iter().map(|&[m, holds]| (m, holds != 0.0)));
        ContactStart {
            inside,
            rows,
            given: GivenResults {
                multipliers: now.iter().map(|n| n.0).collect(),
                gaps: vec![0.0; now.len()],
                holds: now.iter().map(|n| n.1).collect(),
            },
        }
    }
}

/// The subject of each given row.
fn subjects(given: &[GivenRow], block_size: usize) -> Vec<Subject> {
    let mut seen: HashMap<(u32, u64), usize> = HashMap::new();
    let one = |row: &GivenRow| {
        let node = row.terms.first().map_or(0, |t| t.0) / block_size as u32;
        let count = seen.entry((node, row.law.kind())).or_default();
        *count += 1;
        (node, row.law.kind(), *count)
    };
    given.iter().map(one).collect()
}

/// The source of a row between bodies, and the nodes of bodies that it ties.
fn label_key(label: &RowLabel) -> (RowSource, [Option<BodyNode>; 2]) {
    (label.source, label.members)
}

/// The start as the end of a loop.
fn reached(
    solver: &FetiFeti,
    n_ties: usize,
    start: Option<ContactStart>,
) -> RefCell<Option<ContactEnd>> {
    let of = |start: ContactStart| ContactEnd {
        state: solver.start(&start.inside, &start.rows),
        ties: start.rows[..n_ties].iter().map(|r| r.0).collect(),
        inside: start.inside,
        given: start.given,
    };
    RefCell::new(start.map(of))
}

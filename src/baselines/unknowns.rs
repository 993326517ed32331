//! The unknowns of an assembled problem: those of the scene's numbering, or what an active set leaves of them.

use super::groups::Groups;
use super::rows::Rows;
use crate::feti::exchange::sum_all;
use crate::petsc::{Scatter, Session, Vec as PetscVec};
use crate::scene::Numbering;
use crate::Result;
use mpi::topology::SimpleCommunicator;
use std::collections::HashMap;
use std::ops::Range;

/// Where the value at an unknown comes from: an entry of the vector of unknowns, or none, and an offset.
pub type Place = (Option<u64>, f64);

/// Unknowns with active rows as further ties: u = T v + u₀ (see [`Groups`]).
pub struct Unknowns<'a> {
    /// The unknowns of the scene, on which u lives.
    pub numbering: &'a Numbering,
    /// Unknowns of the scene that are none here, increasing.
    gone: Vec<u64>,
    /// Unknowns in rows: the unknown that leads them, and the offset.
    led: HashMap<u64, Place>,
}

impl<'a> Unknowns<'a> {
    /// v = u.
    pub fn all(numbering: &'a Numbering) -> Unknowns<'a> {
        Unknowns {
            numbering,
            gone: Vec::new(),
            led: HashMap::new(),
        }
    }

    /// One v per group.
    pub fn merged(numbering: &'a Numbering, rows: &Rows, groups: &Groups) -> Unknowns<'a> {
        let each = rows.unknowns.iter().enumerate();
        let gone = each.clone().filter(|(k, _)| !groups.is_free(*k));
        let led = each.clone().map(|(k, &unknown)| {
            let lead = groups.lead[k].map(|lead| rows.unknowns[lead]);
            (unknown, (lead, groups.offset[k]))
        });
        Unknowns {
            numbering,
            gone: gone.map(|(_, &unknown)| unknown).collect(),
            led: led.collect(),
        }
    }

    /// Whether v = u.
    pub fn are_all(&self) -> bool {
        self.gone.is_empty() && self.led.values().all(|(_, offset)| *offset == 0.0)
    }

    /// Length of v.
    pub fn len(&self) -> usize {
        self.numbering.len() as usize - self.gone.len()
    }

    /// The entries of v that belong to subdomains `share`.
    pub fn range(&self, share: Range<usize>) -> Range<usize> {
        let all = self.numbering.range(share);
        self.after(all.start)..self.after(all.end)
    }

    /// Where u at a body dof comes from.
    pub fn place(&self, body_dof: u64) -> Place {
        self.of(self.numbering.global(body_dof))
    }

    fn of(&self, unknown: u64) -> Place {
        let (lead, offset) = self
            .led
            .get(&unknown)
            .copied()
            .unwrap_or((Some(unknown), 0.0));
        (lead.map(|u| self.after(u) as u64), offset)
    }

    fn after(&self, unknown: u64) -> usize {
        unknown as usize - self.gone.partition_point(|&g| g < unknown)
    }

    /// u = T v + u₀ in equal shares. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn spread(&self, session: &Session, v: &PetscVec) -> Result<PetscVec> {
        let n = self.numbering.len() as usize;
        let share = crate::mesh::contiguous_share(n, session.size(), session.rank());
        let u = PetscVec::mpi(session, share.len())?;
        let places: Vec<Place> = share.map(|unknown| self.of(unknown as u64)).collect();
        let known = places.iter().filter_map(|(lead, _)| *lead);
        let leads: Vec<i32> = known.map(|lead| lead as i32).collect();
        let values = PetscVec::seq(session, leads.len())?;
        Scatter::new(v, &leads, &values)?.forward(v, &values)?;
        let values = values.array()?;
        let mut next = values.iter();
        for (u, (lead, offset)) in u.array_mut()?.iter_mut().zip(&places) {
            let led = lead.map_or(0.0, |_| *next.next().expect("a value per lead"));
            *u = led + offset;
        }
        Ok(u)
    }
}

/// The entries of distributed vectors at the unknowns in rows, which every rank gets to know.
pub struct Trace {
    /// Number of them.
    len: usize,
    /// Index among them, and in this rank's part of the vector.
    mine: Vec<(usize, usize)>,
}

impl Trace {
    /// For vectors that are laid out as `like`.
    pub fn new(rows: &Rows, like: &PetscVec) -> Trace {
        let range = like.ownership_range();
        let unknowns = rows.unknowns.iter().enumerate();
        let mine = unknowns.filter(|(_, u)| range.contains(&(**u as usize)));
        Trace {
            len: rows.unknowns.len(),
            mine: mine.map(|(k, &u)| (k, u as usize - range.start)).collect(),
        }
    }

    /// (index among the unknowns in rows, index in this rank's part) of those of this rank.
    pub fn mine(&self) -> &[(usize, usize)] {
        &self.mine
    }

    /// The entries of `x`. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn get(&self, comm: &SimpleCommunicator, x: &PetscVec) -> Result<Vec<f64>> {
        let array = x.array()?;
        let mut out = vec![0.0; self.len];
        self.mine.iter().for_each(|&(k, i)| out[k] = array[i]);
        sum_all(comm, &mut out);
        Ok(out)
    }

    /// Replaces the entries of `x`.
    ///
    /// # Errors
    /// PETSc's.
    pub fn set(&self, x: &PetscVec, values: &[f64]) -> Result<()> {
        let mut array = x.array_mut()?;
        self.mine.iter().for_each(|&(k, i)| array[i] = values[k]);
        Ok(())
    }
}

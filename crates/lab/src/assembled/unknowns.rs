//! The unknowns of an assembled problem: those of the scene's layout, or those that remain for an active set.

use super::groups::ActiveGroups;
use super::layout::UnknownLayout;
use super::rows::Inequalities;
use base::Result;
use mpi::topology::SimpleCommunicator;
use parallel::exchange::sum_all;
use petsc::{PetscInt, Scatter, Session, Vec as PetscVec};
use std::collections::HashMap;
use std::ops::Range;

/// The value at an unknown: an entry of the vector of unknowns, if any, plus an offset.
pub type AffineUnknown = (Option<u64>, f64);

/// Unknowns v in which active rows are further ties: w = T v + w₀ (see [`ActiveGroups`]).
pub struct Unknowns<'a> {
    /// The unknowns w of the scene.
    pub layout: &'a UnknownLayout<'a>,
    /// Places of w that are not in v, increasing.
    gone: Vec<u64>,
    /// For unknowns in rows, the lowest unknown of their group and the offset.
    led: HashMap<u64, AffineUnknown>,
}

impl<'a> Unknowns<'a> {
    /// v = w.
    pub fn all(layout: &'a UnknownLayout<'a>) -> Unknowns<'a> {
        Unknowns {
            layout,
            gone: Vec::new(),
            led: HashMap::new(),
        }
    }

    /// The unknowns w without the void places.
    pub fn dense(layout: &'a UnknownLayout<'a>) -> Unknowns<'a> {
        Unknowns {
            layout,
            gone: layout.void().to_vec(),
            led: HashMap::new(),
        }
    }

    /// One unknown per group, and none at void places.
    pub fn merged(
        layout: &'a UnknownLayout<'a>,
        rows: &Inequalities,
        groups: &ActiveGroups,
    ) -> Unknowns<'a> {
        let each = rows.unknowns.iter().enumerate();
        let led = each.clone().filter(|(k, _)| !groups.is_free(*k));
        let mut gone: Vec<u64> = led.map(|(_, &unknown)| unknown).collect();
        gone.extend(layout.void());
        gone.sort_unstable();
        let led = each.map(|(k, &unknown)| {
            let lead = groups.lead[k].map(|lead| rows.unknowns[lead]);
            (unknown, (lead, groups.offset[k]))
        });
        Unknowns {
            layout,
            gone,
            led: led.collect(),
        }
    }

    /// Whether v = w.
    pub fn are_all(&self) -> bool {
        self.gone.is_empty() && self.led.values().all(|(_, offset)| *offset == 0.0)
    }

    /// Whether no active row has been made a tie.
    pub fn are_free(&self) -> bool {
        self.led.is_empty()
    }

    /// Length of v.
    pub fn len(&self) -> usize {
        self.layout.len() - self.gone.len()
    }

    /// The entries of v that belong to subdomains `share`.
    pub fn range(&self, share: Range<usize>) -> Range<usize> {
        let all = self.layout.range(share);
        self.after(all.start as u64)..self.after(all.end as u64)
    }

    /// The entries of v of a rank in about equal shares; no node is split.
    pub fn share(&self, ranks: usize, rank: usize) -> Range<usize> {
        let all = self.layout.share(ranks, rank);
        self.after(all.start as u64)..self.after(all.end as u64)
    }

    /// u at a body dof as Σ coefficient · v plus an offset.
    pub fn terms(&self, body_dof: u64) -> (Vec<(u64, f64)>, f64) {
        let (terms, offset) = self.layout.terms(self.layout.index(body_dof));
        let mut out = (Vec::with_capacity(terms.len()), offset);
        for (unknown, coefficient) in terms {
            let (lead, offset) = self.of(unknown);
            out.0.extend(lead.map(|lead| (lead, coefficient)));
            out.1 += coefficient * offset;
        }
        out
    }

    /// The void places of the node of a body dof, and whether the dof is one of them. The list is empty where v leaves
    /// out places of w.
    pub fn void_beside(&self, body_dof: u64) -> (&[u64], bool) {
        if !self.gone.is_empty() {
            return (&[], false);
        }
        let at = self.layout.index(body_dof);
        let void = self.layout.void_beside(at);
        (void, void.contains(&at))
    }

    fn of(&self, unknown: u64) -> AffineUnknown {
        if self.layout.void().binary_search(&unknown).is_ok() {
            return (None, 0.0);
        }
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

    /// The places in w of the entries `range` of v.
    pub fn places(&self, range: Range<usize>) -> Vec<u64> {
        let mut gone = self.gone.iter().peekable();
        let kept = (0..self.layout.len() as u64).filter(|w| gone.next_if_eq(&w).is_none());
        kept.skip(range.start).take(range.len()).collect()
    }

    /// w = T v + w₀ in equal shares. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn spread(&self, session: &Session, v: &PetscVec) -> Result<PetscVec> {
        let share = self.layout.share(session.size(), session.rank());
        let u = PetscVec::mpi(session, share.len())?;
        let places: Vec<AffineUnknown> = share.map(|unknown| self.of(unknown as u64)).collect();
        let known = places.iter().filter_map(|(lead, _)| *lead);
        let leads: Vec<PetscInt> = known.map(|lead| lead as PetscInt).collect();
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

/// Access to the entries of distributed vectors at the unknowns in rows; every rank gets all of them.
pub struct Trace {
    /// Number of them.
    len: usize,
    /// For each such unknown on this rank: its index among the unknowns in rows, and its index in this rank's part of
    /// the vector.
    mine: Vec<(usize, usize)>,
}

impl Trace {
    /// For vectors distributed like `like`.
    pub fn new(rows: &Inequalities, like: &PetscVec) -> Trace {
        let range = like.ownership_range();
        let unknowns = rows.unknowns.iter().enumerate();
        let mine = unknowns.filter(|(_, u)| range.contains(&(**u as usize)));
        Trace {
            len: rows.unknowns.len(),
            mine: mine.map(|(k, &u)| (k, u as usize - range.start)).collect(),
        }
    }

    /// For each unknown in rows on this rank: (index among the unknowns in rows, index in this rank's part).
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

    /// u ← T v + u₀. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn spread(
        &self,
        comm: &SimpleCommunicator,
        groups: &ActiveGroups,
        v: &PetscVec,
        u: &PetscVec,
    ) -> Result<()> {
        u.copy_from(v)?;
        let at = self.get(comm, v)?;
        self.set(u, &groups.spread(&at))
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

//! Global vectors to subdomains and back: splits loads, sets known dofs, assembles solutions.

use std::collections::{BTreeMap, HashMap};

use super::frame::TornValues;
use super::parts::TornSubdomain;
use super::states::States;
use super::torn::Torn;
use crate::{Error, Result};
use parallel::halo::Halo;
use petsc::{Session, Vec as PetscVec};

/// A subdomain's share in global vectors.
struct SubdomainMap {
    /// Place of each local dof among the ghosts.
    ghost: Vec<u32>,
    /// The global dofs.
    dofs: Vec<u32>,
    /// Weight of each local dof when loads are split and solutions averaged; the weights of all copies sum to one.
    weight: Vec<f64>,
    /// (local dof, ghost, value) of the entries in columns of known dofs.
    known: Vec<(u32, u32, f64)>,
}

/// A known dof: its own row or the host determines the value.
struct Fixed {
    ghost: u32,
    dof: u32,
    /// The row's diagonal entry, summed over all copies; 0 for an empty row.
    diagonal: f64,
    /// This rank's weight of the value.
    weight: f64,
    /// The weight where the diagonal is zero: one over the number of ranks that have the dof.
    equal: f64,
    /// Whether the host holds it; its row is then ignored.
    held: bool,
}

impl Fixed {
    /// Takes the diagonal entry, and this rank's part of it.
    fn weigh(&mut self, mine: f64, diagonal: f64) {
        self.diagonal = diagonal;
        self.weight = if diagonal == 0.0 {
            self.equal
        } else {
            mine / diagonal
        };
    }
}

/// The shares of this rank's subdomains, and the known dofs of its pieces.
pub struct Shares {
    n_ghosts: usize,
    shares: Vec<SubdomainMap>,
    fixed: Vec<Fixed>,
}

/// Values of known dofs, by ghost.
pub type KnownDofValues = HashMap<u32, f64>;

impl Shares {
    /// Collective.
    ///
    /// # Errors
    /// PETSc's own.
    pub fn new(
        session: &Session,
        torn: &Torn,
        parts: &[TornSubdomain],
        states: &States,
        (ghosts, halo): (&[u32], &Halo),
    ) -> Result<Shares> {
        let place = |dof: &u32| ghosts.binary_search(dof).expect("all dofs are ghosts") as u32;
        let share = |part: &TornSubdomain| SubdomainMap {
            ghost: part.dofs.iter().map(place).collect(),
            dofs: part.dofs.clone(),
            weight: (0..part.k.n())
                .map(|i| part.k.get(i, i) / states[&part.dofs[i]].diagonal())
                .collect(),
            known: part
                .known
                .iter()
                .map(|(i, dof, v)| (*i, place(dof), *v))
                .collect(),
        };
        // This rank's contribution to the diagonal of every known dof.
        let mut found: BTreeMap<u32, f64> = BTreeMap::new();
        for piece in &torn.pieces {
            for (i, &dof) in piece.dofs.iter().enumerate() {
                if !states[&dof].is_free() {
                    *found.entry(dof).or_default() += piece.k.get(i, i);
                }
            }
        }
        // Where the diagonal is zero, all ranks that have the dof get equal weights.
        let mut ranks = vec![0.0; ghosts.len()];
        found
            .keys()
            .for_each(|dof| ranks[place(dof) as usize] = 1.0);
        let counted = torn.layout.duplicate()?;
        halo.sum(&ranks, &counted)?;
        halo.fetch(&counted, &mut ranks)?;
        let fixed = |(dof, mine): (u32, f64)| {
            let ghost = place(&dof);
            let mut fixed = Fixed {
                ghost,
                dof,
                diagonal: 0.0,
                weight: 0.0,
                equal: 1.0 / ranks[ghost as usize],
                held: torn.held.contains(&dof),
            };
            fixed.weigh(mine, states[&dof].diagonal());
            fixed
        };
        let shares = Shares {
            n_ghosts: ghosts.len(),
            shares: parts.iter().map(share).collect(),
            fixed: found.into_iter().map(fixed).collect(),
        };
        session.agree(Ok(shares))
    }

    /// Takes the numbers of other matrices with the same rows. Collective.
    ///
    /// # Errors
    /// PETSc's own.
    pub fn renew(&mut self, halo: &Halo, layout: &PetscVec, new: &mut TornValues) -> Result<()> {
        let own = |f: &Fixed, new: &TornValues| new.fixed.get(&f.dof).copied().unwrap_or(0.0);
        let mut diagonal = vec![0.0; self.n_ghosts];
        for (share, d) in self.shares.iter().zip(&new.diagonal) {
            let terms = share.ghost.iter().zip(d);
            terms.for_each(|(&g, d)| diagonal[g as usize] += d);
        }
        for fixed in &self.fixed {
            diagonal[fixed.ghost as usize] += own(fixed, new);
        }
        let all = layout.duplicate()?;
        halo.sum(&diagonal, &all)?;
        halo.fetch(&all, &mut diagonal)?;
        for fixed in &mut self.fixed {
            fixed.weigh(own(fixed, new), diagonal[fixed.ghost as usize]);
        }
        let places: HashMap<u32, u32> = self.fixed.iter().map(|f| (f.dof, f.ghost)).collect();
        for (j, share) in self.shares.iter_mut().enumerate() {
            let terms = share.ghost.iter().zip(&new.diagonal[j]);
            share.weight = terms.map(|(&g, d)| d / diagonal[g as usize]).collect();
            let known = std::mem::take(&mut new.known[j]).into_iter();
            share.known = known.map(|(i, dof, v)| (i, places[&dof], v)).collect();
        }
        Ok(())
    }

    /// Returns an error if a load, by ghost, is no number.
    pub fn finite(&self, load: &[f64]) -> Result<()> {
        let dofs = self.shares.iter().flat_map(|s| s.ghost.iter().zip(&s.dofs));
        let fixed = self.fixed.iter().map(|f| (&f.ghost, &f.dof));
        let wrong = dofs
            .chain(fixed)
            .find(|(&g, _)| !load[g as usize].is_finite());
        wrong.map_or(Ok(()), |(&g, dof)| {
            Err(Error::input(format!(
                "the right-hand side is {} at global dof {dof}, expected finite numbers: \
                 look where the host's assembly of the load divides by zero, or which solver before this one failed",
                load[g as usize]
            )))
        })
    }

    /// Values of the known dofs, from a load and the values that the host gives, both by ghost.
    ///
    /// # Errors
    /// A load on an empty row.
    pub fn known(&self, load: &[f64], given: &[f64]) -> Result<KnownDofValues> {
        let value = |fixed: &Fixed| {
            let b = load[fixed.ghost as usize];
            if fixed.held {
                Ok(given[fixed.ghost as usize])
            } else if fixed.diagonal != 0.0 {
                Ok(b / fixed.diagonal)
            } else if b == 0.0 {
                Ok(0.0)
            } else {
                Err(Error::input(format!(
                    "row {} of the operator is empty but the right-hand side has {b} there, expected zero",
                    fixed.dof
                )))
            }
        };
        let pair = |fixed: &Fixed| Ok((fixed.ghost, value(fixed)?));
        self.fixed.iter().map(pair).collect()
    }

    /// The values of the known dofs by global number.
    pub fn by_dof(&self, values: &KnownDofValues) -> HashMap<u32, f64> {
        let pair = |fixed: &Fixed| (fixed.dof, values[&fixed.ghost]);
        self.fixed.iter().map(pair).collect()
    }

    /// The load of every subdomain.
    pub fn loads(&self, load: &[f64], values: &KnownDofValues) -> Vec<Vec<f64>> {
        let torn = |share: &SubdomainMap| {
            let terms = share.ghost.iter().zip(&share.weight);
            let mut f: Vec<f64> = terms.map(|(&g, w)| w * load[g as usize]).collect();
            for &(i, g, v) in &share.known {
                f[i as usize] -= v * values.get(&g).copied().unwrap_or(0.0);
            }
            f
        };
        self.shares.iter().map(torn).collect()
    }

    /// This rank's part of the solution by ghost, from the displacements of its subdomains. Within the tolerance,
    /// copies in different bodies may differ; the average weights them by stiffness.
    pub fn together(&self, u: &[Vec<f64>], values: &KnownDofValues) -> Vec<f64> {
        let mut ghost = vec![0.0; self.n_ghosts];
        for (share, u) in self.shares.iter().zip(u) {
            for ((&g, w), u) in share.ghost.iter().zip(&share.weight).zip(u) {
                ghost[g as usize] += w * u;
            }
        }
        for fixed in &self.fixed {
            ghost[fixed.ghost as usize] += fixed.weight * values[&fixed.ghost];
        }
        ghost
    }
}

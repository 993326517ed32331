//! The pattern of a partial factorisation: order of elimination, fronts, and where their entries go.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::dissection::nested_dissection;
use super::panel;
use base::linalg::csr::Csr;

/// Patterns that this process has analysed so far.
static ANALYSES: AtomicUsize = AtomicUsize::new(0);

/// Number of patterns that this process has analysed so far. Matrices with other numbers must not increase it.
pub fn analyses() -> usize {
    ANALYSES.load(Ordering::Relaxed)
}

/// Counts an analysis.
pub(super) fn analysed() {
    ANALYSES.fetch_add(1, Ordering::Relaxed);
}

/// The part of [L_II; L_ΓI] that is kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Keep {
    /// All of it: condensing a load and recovering a solution each cost half a solve.
    Boundary,
    /// L_II alone: they each cost a whole solve, in three quarters of the memory in the plane and a quarter of it in
    /// space.
    Interior,
}

/// The position of a dof whose row is not there ([`Symbolic::part`]).
pub(super) const ABSENT: u32 = u32::MAX;

/// The symbolic factorisation, which depends on the pattern alone: elimination order, fronts, index maps.
#[derive(Debug)]
pub struct Symbolic {
    /// Interior dofs in elimination order.
    pub(crate) interior: Vec<u32>,
    /// Interface dofs in the order of S.
    pub(crate) interface: Vec<u32>,
    /// Position of each dof in [interior, interface]. The factorisation needs it; empty if the factor only solves.
    pub(crate) position: Vec<u32>,
    /// The fronts, children before parents.
    pub fronts: Vec<Front>,
    /// Length of all panels together.
    pub storage: usize,
}

/// A front of the multifrontal method: pivots that are eliminated together, and the rows below them.
#[derive(Debug)]
pub struct Front {
    /// Eliminated positions `start..end`.
    pub(crate) start: usize,
    pub(crate) end: usize,
    /// Positions below the pivot block, increasing.
    pub(crate) below: Vec<u32>,
    /// The front that receives this one's update; `None`: S receives it.
    pub parent: Option<usize>,
    /// Place of each entry of `below` in the parent's front (or in S).
    pub(crate) into_parent: Vec<u32>,
    /// Start of this front's panel in the storage.
    pub(crate) panel: usize,
}

impl Front {
    /// Number of pivots.
    pub fn width(&self) -> usize {
        self.end - self.start
    }

    pub(crate) fn size(&self) -> usize {
        self.width() + self.below.len()
    }

    /// Multiplications and additions of its elimination.
    pub fn flops(&self) -> f64 {
        let (w, m) = (self.width() as f64, self.below.len() as f64);
        w.powi(3) / 3.0 + w * w * m + w * m * m
    }
}

impl Symbolic {
    /// Analyses the pattern of `k`; `interface` lists the interface dofs in the order wanted for S.
    pub fn new(k: &Csr, interface: &[u32], coordinates: Option<&[[f64; 3]]>) -> Symbolic {
        let supernodes = nested_dissection(k, &k.others(interface), coordinates);
        Symbolic::with_supernodes(k, interface, &supernodes)
    }

    /// Analyses the pattern of `k` for a given order of the interior: each set of dofs becomes one front, in the order
    /// of elimination.
    pub fn with_supernodes(k: &Csr, interface: &[u32], supernodes: &[Vec<u32>]) -> Symbolic {
        analysed();
        let n = k.n();
        let interior: Vec<u32> = supernodes.iter().flatten().copied().collect();
        let mut position = vec![0; n];
        for (p, &i) in interior.iter().chain(interface).enumerate() {
            position[i as usize] = p as u32;
        }
        let mut front_of = vec![0u32; interior.len()];
        let mut start = 0;
        for (s, set) in supernodes.iter().enumerate() {
            front_of[start..start + set.len()].fill(s as u32);
            start += set.len();
        }

        let mut fronts: Vec<Front> = Vec::with_capacity(supernodes.len());
        let mut children: Vec<Vec<usize>> = vec![Vec::new(); supernodes.len()];
        let mut seen = vec![u32::MAX; n];
        let (mut start, mut storage) = (0, 0);
        for (s, set) in supernodes.iter().enumerate() {
            let end = start + set.len();
            let mut below = Vec::new();
            let mut add = |p: u32| {
                if p as usize >= end && seen[p as usize] != s as u32 {
                    seen[p as usize] = s as u32;
                    below.push(p);
                }
            };
            for &i in set {
                k.row(i as usize)
                    .0
                    .iter()
                    .for_each(|&j| add(position[j as usize]));
            }
            for &c in &children[s] {
                fronts[c].below.iter().for_each(|&p| add(p));
            }
            below.sort_unstable();
            let parent = below
                .first()
                .filter(|&&p| (p as usize) < interior.len())
                .map(|&p| front_of[p as usize] as usize);
            if let Some(parent) = parent {
                children[parent].push(s);
            }
            let front = Front {
                start,
                end,
                below,
                parent,
                into_parent: Vec::new(),
                panel: storage,
            };
            storage += panel::length(front.width(), front.size());
            fronts.push(front);
            start = end;
        }
        for s in 0..fronts.len() {
            let map = match fronts[s].parent {
                None => fronts[s]
                    .below
                    .iter()
                    .map(|&p| p - interior.len() as u32)
                    .collect(),
                Some(t) => place_in(&fronts[s].below, &fronts[t]),
            };
            fronts[s].into_parent = map;
        }
        Symbolic {
            interior,
            interface: interface.to_vec(),
            position,
            fronts,
            storage,
        }
    }

    /// Analyses a pattern of blocks of dofs, all coupled: `blocks` has the pattern of the blocks and `dofs` their dofs,
    /// n in all. Sets of blocks become fronts; blocks in no set have no dofs.
    pub fn with_blocks(
        blocks: &Csr,
        sets: &[Vec<u32>],
        n: usize,
        dofs: impl Fn(u32) -> Range<usize>,
    ) -> Symbolic {
        let coarse = Symbolic::with_supernodes(blocks, &[], sets);
        let mut position = vec![0; n];
        let mut interior = Vec::with_capacity(n);
        let mut first = vec![0u32];
        for &block in &coarse.interior {
            for dof in dofs(block) {
                position[dof] = interior.len() as u32;
                interior.push(dof as u32);
            }
            first.push(interior.len() as u32);
        }
        let mut storage = 0;
        let fronts = coarse.fronts.into_iter().map(|front| {
            let below = front.below.iter().map(|&p| p as usize);
            let below = below.flat_map(|p| first[p]..first[p + 1]);
            let front = Front {
                start: first[front.start] as usize,
                end: first[front.end] as usize,
                below: below.collect(),
                panel: storage,
                ..front
            };
            storage += panel::length(front.width(), front.size());
            front
        });
        let mut fronts: Vec<Front> = fronts.collect();
        for s in 0..fronts.len() {
            if let Some(t) = fronts[s].parent {
                fronts[s].into_parent = place_in(&fronts[s].below, &fronts[t]);
            }
        }
        Symbolic {
            interior,
            interface: Vec::new(),
            position,
            fronts,
            storage,
        }
    }

    /// The structure of a factor that another library computed. Each front is given as (first column, number of
    /// columns, rows below); the columns of all fronts form the interior. It serves solves only.
    pub(crate) fn of_factor(
        interior: Vec<u32>,
        interface: &[u32],
        fronts: impl Iterator<Item = (usize, usize, Vec<u32>)>,
    ) -> Symbolic {
        let mut storage = 0;
        let fronts = fronts
            .map(|(start, width, below)| {
                let panel = storage;
                storage += panel::length(width, width + below.len());
                Front {
                    start,
                    end: start + width,
                    below,
                    parent: None,
                    into_parent: Vec::new(),
                    panel,
                }
            })
            .collect();
        Symbolic {
            interior,
            interface: interface.to_vec(),
            position: Vec::new(),
            fronts,
            storage,
        }
    }

    /// The part of a pattern without an interface in which some rows are left, those of `interior`, of n dofs: the
    /// fronts that a rank has and those with which they exchange something.
    pub(super) fn part(
        interior: Vec<u32>,
        n: usize,
        fronts: Vec<Front>,
        storage: usize,
    ) -> Symbolic {
        let mut position = vec![ABSENT; n];
        for (p, &dof) in (0..).zip(&interior) {
            position[dof as usize] = p;
        }
        Symbolic {
            interior,
            interface: Vec::new(),
            position,
            fronts,
            storage,
        }
    }

    /// This structure without the rows of the interface: the structure of a factor that solves with K_II alone.
    pub(crate) fn inside(&self) -> Symbolic {
        let n = self.n_interior() as u32;
        let fronts = self.fronts.iter().map(|front| {
            let inside = front.below.iter().take_while(|&&p| p < n);
            (front.start, front.width(), inside.copied().collect())
        });
        Symbolic::of_factor(self.interior.clone(), &self.interface, fronts)
    }

    /// This structure with room for the panels of these fronts alone, in this order.
    pub(crate) fn with_panels(mut self, own: &[usize]) -> Symbolic {
        self.storage = 0;
        for &f in own {
            let front = &mut self.fronts[f];
            front.panel = self.storage;
            self.storage += panel::length(front.width(), front.size());
        }
        self
    }

    /// Number of dofs.
    pub(crate) fn n(&self) -> usize {
        self.interior.len() + self.interface.len()
    }

    /// The dofs in the order [interior, interface].
    pub(crate) fn dofs(&self) -> impl Iterator<Item = u32> + '_ {
        self.interior.iter().chain(&self.interface).copied()
    }

    /// Number of interior dofs.
    pub fn n_interior(&self) -> usize {
        self.interior.len()
    }

    /// Multiplications and additions of the factorisation, S included.
    pub fn flops(&self) -> f64 {
        self.fronts.iter().map(Front::flops).sum()
    }

    /// Number of entries of the factor.
    pub fn factor_entries(&self, keep: Keep) -> usize {
        let n = self.n_interior() as u32;
        let of = |front: &Front| {
            let inside = front.below.partition_point(|&p| p < n);
            panel::length(front.width(), front.width() + inside)
        };
        match keep {
            Keep::Boundary => self.storage,
            Keep::Interior => self.fronts.iter().map(of).sum(),
        }
    }
}

/// Where the sorted positions `rows` stand in the front `t` that contains them all.
fn place_in(rows: &[u32], t: &Front) -> Vec<u32> {
    let mut next = 0;
    rows.iter()
        .map(|&p| {
            if (p as usize) < t.end {
                return p - t.start as u32;
            }
            while t.below[next] != p {
                next += 1;
            }
            (t.width() + next) as u32
        })
        .collect()
}

#[cfg(test)]
#[path = "../tests/symbolic.rs"]
mod tests;

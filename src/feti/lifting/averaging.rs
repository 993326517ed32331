//! E_D averages the copies of the dual dofs inside the bodies, with the weights of D, and is zero where bodies may
//! touch.
//!
//! ```text
//!     (E_D w)(x) = Σ_copies D w / Σ_copies D    on all copies of x
//! ```
//!
//! Most copies of a dof are on one rank. Messages contain only dofs that several ranks share.

use std::cell::RefCell;
use std::collections::{BTreeSet, HashMap};

use mpi::traits::Communicator;

use crate::feti::interface::sharing::{Copy, DofSharing};
use crate::feti::operators::stiffness::Stiffness;
use crate::substructures::Problem;
use crate::Result;
use base::linalg::sorted::distinct;
use parallel::exchange::{exchange_by_rank, offsets};
use parallel::halo::Halo;
use petsc::Vec as PetscVec;

/// A dual dof of a subdomain that other subdomains of its body share.
struct SharedDualDof {
    /// Position in Γ.
    at: u32,
    /// Index of the sum over its copies.
    slot: u32,
    /// D over the sum of D.
    weight: f64,
}

/// E_D of all bodies.
pub(crate) struct Averaging {
    /// By local subdomain.
    places: Vec<Vec<SharedDualDof>>,
    /// Positions in Γ of shared vertices where bodies do not touch: they keep their values.
    vertices: Vec<Vec<u32>>,
    /// Number of slots that several ranks add to. They come first.
    shared: usize,
    halo: Halo,
    vector: PetscVec,
    sums: RefCell<Vec<f64>>,
}

/// The operator or its transpose.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Transposition {
    /// E_D.
    Plain,
    /// E_Dᵀ.
    Transposed,
}

impl Averaging {
    /// Numbers the shared dofs. Collective.
    pub fn new(
        problem: &Problem,
        sharing: &DofSharing,
        stiffness: &Stiffness,
    ) -> Result<Averaging> {
        let (session, jump) = (&stiffness.session, &stiffness.jump);
        let comm = session.comm();
        let me = comm.rank() as usize;
        let mut found: Vec<Vec<(u64, u32, f64)>> = Vec::new();
        let mut vertices = Vec::new();
        let mut far: BTreeSet<u64> = BTreeSet::new();
        let rank_of = |c: &Copy| sharing.locations.rank(c.subdomain);
        for (j, (sub, local)) in problem.local.iter().zip(&stiffness.locals).enumerate() {
            let candidate = jump.columns.of(j).between_bodies(local.gamma().n_gamma());
            let mut here = Vec::new();
            for (i, &at) in local.gamma().interface[..local.gamma().n_delta]
                .iter()
                .enumerate()
            {
                let dof = sub.dofs[at as usize];
                let copies = sharing.shared(dof);
                let own = copies.iter().find(|c| c.subdomain as usize == sub.index);
                let Some(own) = own.filter(|_| !candidate[i]) else {
                    continue;
                };
                let total: f64 = copies.iter().map(|c| c.weight).sum();
                here.push((dof, i as u32, own.weight / total));
                if copies.iter().any(|c| rank_of(c) != me) {
                    far.insert(dof);
                }
            }
            found.push(here);
            let held = local.gamma().n_delta..local.gamma().n_delta + jump.n_shared[j];
            vertices.push(held.filter(|&i| !candidate[i]).map(|i| i as u32).collect());
        }
        // The rank of the lowest copy numbers a dof that several ranks share.
        let far: Vec<u64> = far.into_iter().collect();
        let owner = |dof: &u64| rank_of(&sharing.shared(*dof)[0]);
        let mut asked: Vec<Vec<u64>> = vec![Vec::new(); comm.size() as usize];
        far.iter().for_each(|dof| asked[owner(dof)].push(*dof));
        let received = exchange_by_rank(comm, asked);
        let own = distinct(received.concat());
        let (first, _) = offsets(comm, own.len());
        let number = |dof: &u64| (first + own.binary_search(dof).expect("it was asked for")) as u32;
        let replies = received.iter().map(|l| l.iter().map(number).collect());
        let answers: Vec<Vec<u32>> = exchange_by_rank(comm, replies.collect());
        let mut next = vec![0; answers.len()];
        let numbered = far.iter().map(|dof| {
            let from = owner(dof);
            next[from] += 1;
            (answers[from][next[from] - 1], *dof)
        });
        let mut ghosts: Vec<(u32, u64)> = numbered.collect();
        ghosts.sort_unstable();
        let mut slots: HashMap<u64, u32> = ghosts.iter().map(|g| g.1).zip(0..).collect();
        let places = found.into_iter().map(|here| {
            let place = |(dof, at, weight)| {
                let next = slots.len() as u32;
                let slot = *slots.entry(dof).or_insert(next);
                SharedDualDof { at, slot, weight }
            };
            here.into_iter().map(place).collect()
        });
        let places: Vec<Vec<SharedDualDof>> = places.collect();
        let vector = PetscVec::mpi(session, own.len())?;
        let numbers: Vec<u32> = ghosts.iter().map(|g| g.0).collect();
        Ok(Averaging {
            places,
            vertices,
            shared: ghosts.len(),
            halo: Halo::new(session, &vector, &numbers)?,
            vector,
            sums: RefCell::new(vec![0.0; slots.len()]),
        })
    }

    /// w ← E_D w or E_Dᵀ w on the interface of every local subdomain. Collective.
    pub fn apply(&self, which: Transposition, w: &mut [Vec<f64>]) -> Result<()> {
        let sums = &mut *self.sums.borrow_mut();
        sums.fill(0.0);
        for (places, w) in self.places.iter().zip(&*w) {
            for p in places {
                let weight = if which == Transposition::Plain {
                    p.weight
                } else {
                    1.0
                };
                sums[p.slot as usize] += weight * w[p.at as usize];
            }
        }
        let shared = &mut sums[..self.shared];
        self.halo.sum(shared, &self.vector)?;
        self.halo.fetch(&self.vector, shared)?;
        for ((places, vertices), w) in self.places.iter().zip(&self.vertices).zip(w) {
            let kept: Vec<f64> = vertices.iter().map(|&i| w[i as usize]).collect();
            w.fill(0.0);
            let vertices = vertices.iter().zip(kept);
            vertices.for_each(|(&i, v)| w[i as usize] = v);
            for p in places {
                let weight = if which == Transposition::Plain {
                    1.0
                } else {
                    p.weight
                };
                w[p.at as usize] = weight * sums[p.slot as usize];
            }
        }
        Ok(())
    }
}

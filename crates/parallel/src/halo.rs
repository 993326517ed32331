//! The ghost entries of a distributed vector: those that the subdomains of a rank touch.

use std::cell::RefCell;

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use super::clock::Phase;
use super::exchange::exchange;
use super::owners::Owners;
use super::traffic::Traffic;
use crate::clock;
use crate::traffic;
use base::linalg::sorted::distinct;
use base::Result;
use petsc::{PetscInt, Scatter, Session, Vec as PetscVec};

/// Moves entries between a distributed vector and this rank's ghost list, both ways.
pub struct Halo {
    scatter: Scatter,
    /// Sequential vector through which the ghost entries are sent.
    buffer: RefCell<PetscVec>,
    /// Number of ghost entries.
    pub n_ghosts: usize,
    /// The traffic of this rank in one [`fetch`](Self::fetch) and in one [`sum`](Self::sum).
    sent: (Traffic, Traffic),
}

/// The union of the lists, increasing (the ghosts), and for every list the positions of its numbers in the union.
pub fn numbered<L: AsRef<[u32]>>(lists: &[L]) -> (Vec<u32>, Vec<Vec<u32>>) {
    let each = || lists.iter().map(|l| l.as_ref());
    let ghosts = distinct(each().flatten().copied());
    let place = |g: &u32| {
        let at = ghosts.binary_search(g);
        at.expect("every number was collected") as u32
    };
    let places = each().map(|l| l.iter().map(place).collect()).collect();
    (ghosts, places)
}

impl Halo {
    /// A halo for vectors laid out like `layout`; `ghosts` lists global numbers. Collective.
    pub fn new(session: &Session, layout: &PetscVec, ghosts: &[u32]) -> Result<Halo> {
        let indices: Vec<PetscInt> = ghosts.iter().map(|&g| g as PetscInt).collect();
        let buffer = PetscVec::seq(session, ghosts.len())?;
        Ok(Halo {
            scatter: Scatter::new(layout, &indices, &buffer)?,
            buffer: RefCell::new(buffer),
            n_ghosts: ghosts.len(),
            sent: of_ghosts(session.comm(), layout.ownership_range().start, ghosts),
        })
    }

    /// `ghost` ← the entries of `x`. Collective.
    pub fn fetch(&self, x: &PetscVec, ghost: &mut [f64]) -> Result<()> {
        traffic::count(self.sent.0);
        clock::timed(Phase::Exchange, || {
            let buffer = self.buffer.borrow_mut();
            self.scatter.forward(x, &buffer)?;
            ghost.copy_from_slice(&buffer.array()?);
            Ok(())
        })
    }

    /// `y` ← the sum of every rank's `ghost` entries. Collective.
    pub fn sum(&self, ghost: &[f64], y: &PetscVec) -> Result<()> {
        self.sum_begin(ghost, y)?;
        self.sum_end(y)
    }

    /// Starts the messages of [`sum`](Self::sum), which overlap with local work. Nothing else may use this halo or `y`
    /// until [`sum_end`](Self::sum_end). Collective.
    pub fn sum_begin(&self, ghost: &[f64], y: &PetscVec) -> Result<()> {
        traffic::count(self.sent.1);
        clock::timed(Phase::Exchange, || {
            let buffer = self.buffer.borrow_mut();
            buffer.array_mut()?.copy_from_slice(ghost);
            y.set(0.0)?;
            self.scatter.reverse_add_begin(&buffer, y)
        })
    }

    /// Completes [`sum_begin`](Self::sum_begin). Collective.
    pub fn sum_end(&self, y: &PetscVec) -> Result<()> {
        clock::timed(Phase::Exchange, || {
            self.scatter.reverse_add_end(&self.buffer.borrow(), y)
        })
    }
}

/// The traffic of this rank when the ghosts are sent once: (owners to ghosts, ghosts to owners). `first` is the first
/// entry that this rank owns. Collective.
fn of_ghosts(comm: &SimpleCommunicator, first: usize, ghosts: &[u32]) -> (Traffic, Traffic) {
    let (size, rank) = (comm.size() as usize, comm.rank() as usize);
    if size == 1 {
        return Default::default();
    }
    let owners = Owners::new(comm, first);
    let mut wanted = vec![0u64; size];
    for &g in ghosts {
        wanted[owners.of(g)] += 1;
    }
    wanted[rank] = 0;
    let asked = wanted.iter().map(|&n| vec![n]).collect();
    let asking = exchange(comm, asked);
    (
        Traffic::of_counts(asking.into_iter()),
        Traffic::of_counts(wanted.into_iter()),
    )
}

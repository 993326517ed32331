//! The columns of R, G and GᵀG: those of a body follow each other, those of the next body follow them.
//!
//! The natural coarse problem is one of all floating bodies, and the ranks that factor it know its sparsity. The
//! columns of each body are a part of that knowledge.

use std::ops::Range;

use mpi::topology::SimpleCommunicator;

use crate::feti::primal::space::OwnedBody;
use parallel::exchange::gather_all;

/// The columns of all bodies, and the ranks that own the bodies.
#[derive(Debug, Clone, Default)]
pub struct KernelColumns {
    /// First column of each body, and the end; length n_bodies + 1.
    start: Vec<usize>,
    /// The rank that owns each floating body; length n_bodies.
    home: Vec<u32>,
}

impl KernelColumns {
    /// From the bodies that this rank owns, whose kernels are known. Collective.
    pub fn new(comm: &SimpleCommunicator, n_bodies: usize, owned: &[OwnedBody]) -> KernelColumns {
        let floating = owned.iter().filter(|b| b.z.cols > 0);
        let mine = floating.map(|b| [b.body, b.z.cols]);
        let (mut start, mut home) = (vec![0; n_bodies + 1], vec![0; n_bodies]);
        let all = gather_all(comm, &mine.collect::<Vec<_>>());
        for (rank, bodies) in (0..).zip(&all) {
            for &[body, columns] in bodies {
                home[body] = rank;
                start[body + 1] = columns;
            }
        }
        for body in 0..n_bodies {
            start[body + 1] += start[body];
        }
        KernelColumns { start, home }
    }

    /// Columns of bodies whose kernels have these dimensions; no rank owns any.
    pub fn of_defects(defects: impl Iterator<Item = usize>) -> KernelColumns {
        let mut start = vec![0];
        defects.for_each(|d| start.push(start[start.len() - 1] + d));
        let home = vec![0; start.len() - 1];
        KernelColumns { start, home }
    }

    /// The columns of a body: as many as its kernel has dimensions.
    pub fn of(&self, body: usize) -> Range<usize> {
        self.start[body]..self.start[body + 1]
    }

    /// The body of a column.
    pub fn body(&self, column: u32) -> u32 {
        // Of bodies that start there it is the last one: the others have no columns.
        self.start
            .partition_point(|&first| first <= column as usize) as u32
            - 1
    }

    /// First column of each body, and the end; length n_bodies + 1.
    pub fn start(&self) -> &[usize] {
        &self.start
    }

    /// The rank that owns each floating body; length n_bodies.
    pub fn home(&self) -> &[u32] {
        &self.home
    }

    /// Number of columns, r.
    pub fn n(&self) -> usize {
        self.start.last().copied().unwrap_or(0)
    }

    /// Most columns of a body.
    pub fn most(&self) -> usize {
        let sizes = self.start.windows(2).map(|w| w[1] - w[0]);
        sizes.max().unwrap_or(0)
    }

    /// Number of bodies that float.
    pub fn floating(&self) -> usize {
        self.start.windows(2).filter(|w| w[0] < w[1]).count()
    }
}

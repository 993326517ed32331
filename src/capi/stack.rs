//! Matrices of separately discretised bodies, and one numbering of all their unknowns.
//!
//! Each rank has its rows of the first matrix, then its rows of the second, and so on. This is the numbering of
//! DMComposite and the layout of nested vectors.

use std::borrow::Cow;

use crate::embed::pieces::torn_from;
use crate::embed::torn::{modes, unassembled};
use crate::embed::{Local, TornPiece};
use crate::Result;
use base::linalg::csr::Csr;
use base::Fault;
use parallel::exchange::gather_all;
use petsc::{Mat, PetscInt, Session, Vec as PetscVec};

/// A subdomain matrix from the host.
pub struct HostMatrix {
    /// The matrix in the host's order of rows and columns.
    pub k: Csr,
    /// Global number of each row; negative: the row has none.
    pub dofs: Vec<PetscInt>,
    /// The block size if a dof may be listed several times, once for each subdomain that has it.
    pub copies: Option<usize>,
    /// The body; negative: not given.
    pub body: PetscInt,
    /// The numbers of the rows in the matrix that they come from; `None` for arrays.
    pub map: Option<Vec<PetscInt>>,
}

impl HostMatrix {
    /// The matrix as it is compared with what was set up, with these numbers of its rows.
    pub fn locals<'a>(&'a self, dofs: Cow<'a, [PetscInt]>, block_size: usize) -> Vec<Local<'a>> {
        if self.copies.is_none() {
            return vec![Local {
                k: Cow::Borrowed(&self.k),
                dofs,
            }];
        }
        let local = |piece: TornPiece| Local {
            dofs: piece.dofs.iter().map(|&d| d as PetscInt).collect(),
            k: Cow::Owned(piece.k),
        };
        self.pieces(&dofs, block_size)
            .into_iter()
            .map(local)
            .collect()
    }

    /// The pieces of the matrix, with these numbers of its rows.
    pub fn pieces(&self, dofs: &[PetscInt], block_size: usize) -> Vec<TornPiece> {
        let body = u64::try_from(self.body).ok();
        torn_from(&self.k, dofs, block_size, self.copies, body)
    }
}

/// The data of a matrix besides its entries.
pub struct StackStates {
    /// A vector with the layout of the matrix.
    pub layout: PetscVec,
    pub block_size: usize,
    /// Motions without energy, if the near-null space or the null space has them.
    pub modes: Option<Vec<PetscVec>>,
}

/// A matrix with its own numbering.
struct StackedMatrix {
    /// This rank's local matrix, in the numbering of the matrix.
    given: HostMatrix,
    told: StackStates,
    /// The first row of each rank.
    starts: Vec<u32>,
}

/// The matrices in the order in which they were given.
#[derive(Default)]
pub struct Stack(Vec<StackedMatrix>);

/// The local matrix of a MATIS, and the other data of the matrix.
pub struct LocalMatrix {
    pub given: HostMatrix,
    pub told: StackStates,
}

impl LocalMatrix {
    /// Extracts the local data of the matrix. Collective.
    pub fn of(session: &Session, a: &Mat, body: PetscInt) -> Result<LocalMatrix> {
        unassembled(a).map_err(|e| Fault::Unsupported.error(e.to_string()))?;
        let (rows, cols) = a.size()?;
        if rows != cols {
            return Err(Fault::Sizes.error(format!(
                "the matrix has {rows} rows and {cols} columns, expected a square one"
            )));
        }
        let (k, dofs) = session.agree(a.local_part())?;
        let (layout, block_size) = (a.right_vec()?, a.block_size()?);
        let modes = modes(&layout, block_size, a)?;
        for mode in modes.iter().flatten() {
            session.agree(fits(
                session,
                mode,
                &layout,
                "the near-null space of the matrix",
            ))?;
        }
        Ok(LocalMatrix {
            given: HostMatrix {
                k,
                map: Some(dofs.clone()),
                dofs,
                copies: a.is_repeated()?.then_some(block_size),
                body,
            },
            told: StackStates {
                layout,
                block_size,
                modes,
            },
        })
    }
}

/// Returns an error if a vector does not have the layout of another one.
pub fn fits(session: &Session, v: &PetscVec, layout: &PetscVec, what: &str) -> Result<()> {
    let (found, wanted) = (v.ownership_range(), layout.ownership_range());
    if found == wanted {
        return Ok(());
    }
    Err(Fault::Sizes.error(format!(
        "{what} has entries {found:?} on rank {}, expected {wanted:?}",
        session.rank()
    )))
}

impl Stack {
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub fn len(&self) -> usize {
        self.0.len()
    }

    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Appends a matrix. Collective.
    pub fn push(&mut self, session: &Session, local: LocalMatrix) {
        let first = local.told.layout.ownership_range().start as u32;
        self.0.push(StackedMatrix {
            given: local.given,
            told: local.told,
            starts: gather_all(session.comm(), &[first]).concat(),
        });
    }

    /// Number of unknowns of a matrix.
    pub fn size_of(&self, matrix: usize) -> usize {
        self.0[matrix].told.layout.global_len()
    }

    /// The largest block size that fits all matrices.
    pub fn block_size(&self) -> usize {
        let common = |mut a: usize, mut b: usize| {
            while b != 0 {
                (a, b) = (b, a % b);
            }
            a
        };
        self.0.iter().fold(0, |bs, m| common(bs, m.told.block_size))
    }

    /// The number of a matrix's unknown in the numbering of all unknowns.
    pub fn number(&self, matrix: usize, dof: u32) -> u32 {
        let own = &self.0[matrix];
        // Among ranks that start at the same row, only the last one has rows.
        let rank = own.starts.partition_point(|&s| s <= dof) - 1;
        let end = |m: &StackedMatrix| match m.starts.get(rank + 1) {
            Some(&next) => next,
            None => m.told.layout.global_len() as u32,
        };
        let before: u32 = self.0.iter().map(|m| m.starts[rank]).sum();
        let above: u32 = self.0[..matrix]
            .iter()
            .map(|m| end(m) - m.starts[rank])
            .sum();
        before + above + dof - own.starts[rank]
    }

    /// A vector of all unknowns. Collective.
    pub fn vector(&self, session: &Session) -> Result<PetscVec> {
        let n = self.layouts().map(PetscVec::local_len).sum();
        PetscVec::over_ranks(session, Some(n), None)
    }

    /// A vector with the layout of each matrix.
    pub fn layouts(&self) -> impl Iterator<Item = &PetscVec> {
        self.0.iter().map(|m| &m.told.layout)
    }

    /// The local matrix of each.
    pub fn given(&mut self) -> impl Iterator<Item = &mut HostMatrix> {
        self.0.iter_mut().map(|m| &mut m.given)
    }

    /// The local matrices with the numbers of all unknowns.
    fn numbered(&self) -> Vec<(&HostMatrix, Vec<PetscInt>)> {
        let number = |k: usize, d: PetscInt| match u32::try_from(d) {
            Ok(dof) => self.number(k, dof) as PetscInt,
            Err(_) => d,
        };
        let mut out = Vec::new();
        for (k, StackedMatrix { given, .. }) in self.0.iter().enumerate() {
            out.push((given, given.dofs.iter().map(|&d| number(k, d)).collect()));
        }
        out
    }

    /// The local matrices cut into pieces, in the numbering of all unknowns.
    pub fn pieces(&self, block_size: usize) -> impl Iterator<Item = TornPiece> + '_ {
        let all = self.numbered().into_iter();
        all.flat_map(move |(given, dofs)| given.pieces(&dofs, block_size))
    }

    /// The local matrices as they are compared with what was set up.
    pub fn locals(&self, block_size: usize) -> impl Iterator<Item = Local<'_>> {
        let all = self.numbered().into_iter();
        all.flat_map(move |(given, dofs)| given.locals(Cow::Owned(dofs), block_size))
    }

    /// Vectors over all unknowns that combine the motions of the matrices; `None` if some matrix has none. Collective.
    pub fn modes(&self, whole: &PetscVec) -> Result<Option<Vec<PetscVec>>> {
        let each: Option<Vec<&Vec<PetscVec>>> =
            self.0.iter().map(|m| m.told.modes.as_ref()).collect();
        let Some(each) = each else {
            return Ok(None);
        };
        let mut out = Vec::new();
        for j in 0..each.iter().map(|list| list.len()).max().unwrap_or(0) {
            let mode = whole.duplicate()?;
            {
                let mut entries = mode.array_mut()?;
                let mut rest = &mut entries[..];
                for (layout, list) in self.layouts().zip(&each) {
                    let (mine, tail) = rest.split_at_mut(layout.local_len());
                    if let Some(part) = list.get(j) {
                        mine.copy_from_slice(&part.array()?);
                    }
                    rest = tail;
                }
            }
            out.push(mode);
        }
        Ok(Some(out))
    }
}

//! The input of a host program: subdomain matrices, not yet grouped or classified.

use super::pieces::{torn_from, TornPiece};
use crate::substructures::{FrictionNode, Law};
use crate::{Error, Result};
use base::linalg::sorted::distinct;
use parallel::exchange::exchange;
use parallel::halo::Halo;
use parallel::owners::Owners;
use petsc::{AttachedNullSpace, Mat, PetscInt, Session, Vec as PetscVec};
use std::collections::HashSet;

/// A row of the host: Σ coefficient · u(global dof) = or ≤ gap.
#[derive(Debug, Clone)]
pub struct GivenRow {
    /// (global dof, coefficient) pairs.
    pub terms: Vec<(u32, f64)>,
    /// Right-hand side.
    pub gap: f64,
    /// Which multipliers it may have.
    pub law: Law,
    /// By how much a unit force compresses what the row stands for; 0 where it is rigid.
    pub compliance: f64,
}

/// The rows that a rank of the host gives.
#[derive(Debug, Clone, Default)]
pub struct GivenRows {
    /// The rows.
    pub rows: Vec<GivenRow>,
    /// Nodes with friction, by the places of their rows here.
    pub friction: Vec<FrictionNode>,
}

/// The operator Σ Rᵀ K R as a sum of subdomain matrices.
pub struct Torn {
    /// Number of global dofs.
    pub n_global: usize,
    /// Consecutive global dofs that belong to one node: the components of the field.
    pub block_size: usize,
    /// This rank's pieces.
    pub pieces: Vec<TornPiece>,
    /// A vector of the host's layout.
    pub layout: PetscVec,
    /// Vectors that span every kernel a subdomain matrix may have without boundary conditions.
    pub modes: Option<Vec<PetscVec>>,
    /// This rank's global dofs that are held at given values; their rows are ignored.
    pub held: HashSet<u32>,
    /// This rank's global dofs that are to be primal where subdomains of a body share them.
    pub primal: HashSet<u32>,
    /// The rows that this rank adds.
    pub rows: GivenRows,
    /// The body of each global dof, if the host names bodies by dofs. A subdomain belongs to the body that most of its
    /// dofs name.
    pub named: Option<PetscVec>,
}

impl Torn {
    /// The pieces of a MATIS, one on every rank; `body` is the body of this rank's piece. Collective.
    ///
    /// # Errors
    /// A matrix of another type, or one that is not square.
    pub fn from_matis(session: &Session, a: &Mat, body: Option<u64>) -> Result<Torn> {
        unassembled(a)?;
        let (rows, cols) = a.size()?;
        if rows != cols {
            return Err(Error::input(format!(
                "the operator has {rows} rows and {cols} columns, expected a square matrix"
            )));
        }
        countable(rows)?;
        session.agree(on_the_processor(a))?;
        let (k, map) = session.agree(a.local_part())?;
        let (layout, block_size) = (a.right_vec()?, a.block_size()?);
        let copies = a.is_repeated()?.then_some(block_size);
        let pieces = torn_from(&k, &map, block_size, copies, body);
        Ok(Torn {
            n_global: rows,
            block_size,
            pieces,
            modes: modes(&layout, block_size, a)?,
            layout,
            held: HashSet::new(),
            primal: HashSet::new(),
            rows: GivenRows::default(),
            named: None,
        })
    }

    /// The component of a global dof.
    pub fn component(&self, dof: u32) -> usize {
        dof as usize % self.block_size
    }

    /// The node of a global dof.
    pub fn node(&self, dof: u32) -> u32 {
        dof / self.block_size as u32
    }

    /// The global dofs that this rank's pieces touch, increasing, and a halo for them. Collective.
    pub fn halo(&self, session: &Session) -> Result<(Vec<u32>, Halo)> {
        let ghosts = distinct(self.pieces.iter().flat_map(|p| p.dofs.clone()));
        let halo = Halo::new(session, &self.layout, &ghosts)?;
        Ok((ghosts, halo))
    }
}

/// Returns an error if entries of the matrix or of its vectors lie on a device.
fn on_the_processor(a: &Mat) -> Result<()> {
    let found = [a.vec_type_name()?, a.local_type_name()?];
    match found.iter().find(|name| is_of_device(name)) {
        None => Ok(()),
        Some(name) => Err(Error::input(format!(
            "the operator has entries or vectors of type {name}, on a device, expected host memory: \
             the method computes on the processor; take -vec_type standard and -mat_type is with local matrices aij"
        ))),
    }
}

/// Whether a type of vectors or matrices, by PETSc's name, keeps its entries on a device.
fn is_of_device(name: &str) -> bool {
    ["cuda", "cusparse", "hip", "kokkos", "viennacl"]
        .iter()
        .any(|device| name.contains(device))
}

/// Returns an error if the method cannot number so many unknowns, which PETSc with 64-bit indices can.
pub fn countable(n: usize) -> Result<()> {
    if u32::try_from(n).is_ok() {
        return Ok(());
    }
    Err(Error::input(format!(
        "there are {n} unknowns, expected at most {}: the method numbers them with 32 bits",
        u32::MAX
    )))
}

/// Returns an error if the matrix is no MATIS.
pub fn unassembled(a: &Mat) -> Result<()> {
    let kind = a.type_name()?;
    if kind == "is" {
        return Ok(());
    }
    if kind == "nest" {
        return Err(Error::input(
            "the operator is of type nest (MATNEST), expected is (MATIS): a PCFIELDSPLIT gives each block to a KSP of \
             its own, which for those with a MATIS may be of type fetifeti; several bodies are for FetiFetiAddMatIS",
        ));
    }
    Err(Error::input(format!(
        "the operator is of type {kind}, expected is (MATIS): \
         an assembled matrix cannot be torn into subdomains without its elements; \
         assemble into a MATIS instead (-dm_mat_type is, or MatSetType(A, MATIS) before assembly)"
    )))
}

/// The entries of `ghosts`, whose halo is given, that some rank lists. The numbers are those of unknowns. Collective.
pub fn marked(
    session: &Session,
    layout: &PetscVec,
    list: &[PetscInt],
    (ghosts, halo): (&[u32], &Halo),
) -> Result<HashSet<u32>> {
    let marks = layout.duplicate()?;
    marks.set(0.0)?;
    let range = marks.ownership_range();
    let owners = Owners::new(session.comm(), range.start);
    let mut outgoing = vec![Vec::new(); session.size()];
    for &dof in list {
        outgoing[owners.of(dof as u64)].push(dof as usize);
    }
    {
        let mut entries = marks.array_mut()?;
        for dof in exchange(session.comm(), outgoing) {
            entries[dof - range.start] = 1.0;
        }
    }
    let mut values = vec![0.0; ghosts.len()];
    halo.fetch(&marks, &mut values)?;
    let marked = ghosts.iter().zip(values).filter(|(_, v)| *v != 0.0);
    Ok(marked.map(|(&d, _)| d).collect())
}

/// The vectors of a null space, including the constants.
pub fn spanned(layout: &PetscVec, attached: AttachedNullSpace) -> Result<Vec<PetscVec>> {
    let mut modes = attached.vectors;
    if attached.constants {
        let ones = layout.duplicate()?;
        ones.set(1.0)?;
        modes.push(ones);
    }
    Ok(modes)
}

/// The kernel that the host attached: its near-null space, or a null space rich enough to hold all rigid motions of a
/// subdomain.
pub fn modes(layout: &PetscVec, block_size: usize, a: &Mat) -> Result<Option<Vec<PetscVec>>> {
    let attached = match a.attached_near_null_space()? {
        Some(near) => Some(near),
        None => a.attached_null_space()?,
    };
    let Some(attached) = attached else {
        return Ok(None);
    };
    let modes = spanned(layout, attached)?;
    // In elasticity the translations alone are too few: a periodic body has no others, but its subdomains have.
    let least = match block_size {
        2 => 3,
        3 => 6,
        n => n,
    };
    Ok((modes.len() >= least).then_some(modes))
}

//! A factor that ranks share, applied to vectors of columns that no rank has whole.
//!
//! A rank has entries for the columns in its own rows of G and QG. Those that belong to subtrees go to the rank of the
//! subtree, the solution comes back the same way. Only the columns of the top, which separate the subtrees, are summed
//! over all ranks.

use std::cell::RefCell;
use std::rc::Rc;

use super::gram::Gram;
use super::rows::Rows;
use crate::cholesky::team::{Place, Team};
use crate::parallel::clock::{self, Phase};
use crate::parallel::halo::Halo;
use crate::petsc::{Session, Vec as PetscVec};
use crate::Result;

/// The way from the columns of this rank's rows to those who factor them, and back.
pub struct Spread {
    team: Rc<Team>,
    /// Columns of subtrees in the order of the owners' numbers, and the way to the owners.
    below: Vec<u32>,
    halo: Halo,
    /// Columns of the top, each with its place in it.
    top: Vec<(u32, u32)>,
    /// The columns of this rank's subtrees.
    own: PetscVec,
    /// All columns of the top.
    shared: RefCell<Vec<f64>>,
    /// A number for every column; only those of this rank's rows are in use.
    work: RefCell<Vec<f64>>,
}

impl Spread {
    /// For these columns and factors that this team shares. Collective.
    pub fn new(session: &Session, team: &Rc<Team>, columns: &[u32]) -> Result<Spread> {
        let mut top = Vec::new();
        // PETSc's numbers of the columns of subtrees: rank after rank.
        let mut placed: Vec<(u32, u32)> = Vec::new();
        for &column in columns {
            match team.place(column) {
                Place::Subtree { number, .. } => placed.push((number, column)),
                Place::Top(at) => top.push((column, at)),
            }
        }
        placed.sort_unstable();
        let (numbers, below): (Vec<u32>, Vec<u32>) = placed.into_iter().unzip();
        let (n_own, n_top) = team.sizes();
        let own = PetscVec::mpi(session, n_own)?;
        Ok(Spread {
            team: team.clone(),
            halo: Halo::new(session, &own, &numbers)?,
            below,
            top,
            own,
            shared: RefCell::new(vec![0.0; n_top]),
            work: RefCell::new(vec![0.0; team.n()]),
        })
    }

    /// Whether it leads to factors of this team.
    pub fn fits(&self, team: &Rc<Team>) -> bool {
        Rc::ptr_eq(team, &self.team)
    }

    /// Whether it knows all columns of these rows.
    pub fn covers(&self, rows: &Rows) -> bool {
        let mut known = vec![false; self.team.n()];
        let of_top = self.top.iter().map(|t| &t.0);
        self.below
            .iter()
            .chain(of_top)
            .for_each(|&c| known[c as usize] = true);
        rows.columns().iter().all(|&c| known[c as usize])
    }

    /// x ← x − along A⁺ fromᵀ x for the matrix A of this factor. Collective.
    pub fn remove(&self, factor: &Gram, x: &PetscVec, from: &Rows, along: &Rows) -> Result<()> {
        let (mut work, mut shared) = (self.work.borrow_mut(), self.shared.borrow_mut());
        self.below.iter().for_each(|&c| work[c as usize] = 0.0);
        self.top.iter().for_each(|&(c, _)| work[c as usize] = 0.0);
        from.add_transpose(&x.array()?, &mut work);
        let mut ghosts: Vec<f64> = self.below.iter().map(|&c| work[c as usize]).collect();
        self.halo.sum(&ghosts, &self.own)?;
        shared.fill(0.0);
        let of_top = self.top.iter();
        of_top.for_each(|&(c, at)| shared[at as usize] = work[c as usize]);
        clock::timed(Phase::Natural, || -> Result<()> {
            factor.solve_shares(&mut self.own.array_mut()?, &mut shared);
            Ok(())
        })?;
        self.halo.fetch(&self.own, &mut ghosts)?;
        let of_subtrees = self.below.iter().zip(&ghosts);
        of_subtrees.for_each(|(&c, v)| work[c as usize] = *v);
        let of_top = self.top.iter();
        of_top.for_each(|&(c, at)| work[c as usize] = shared[at as usize]);
        along.add(-1.0, &work, &mut x.array_mut()?);
        Ok(())
    }
}

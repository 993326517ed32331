//! A factor that ranks share, applied to vectors of columns that no rank has whole.
//!
//! A rank has entries for the columns in its own rows of G and QG, and for those of its own bodies. Most belong to
//! fronts of its own or to those above them: what it has of the latter goes up the tree with what its fronts leave to
//! them, and the solution comes back the same way. The rest goes to the rank that has the front.

use std::cell::RefCell;
use std::rc::Rc;

use super::gram::Gram;
use super::rows::KernelRows;
use crate::Result;
use cholesky::team::FactorTeam;
use parallel::exchange::any;
use parallel::halo::Halo;
use petsc::{Session, Vec as PetscVec};

/// The way from the columns of this rank's rows to those who factor them, and back.
pub struct TeamFactor {
    team: Rc<FactorTeam>,
    /// Columns that this rank has or that are its ghosts, each with its place among shares.
    near: Vec<(u32, u32)>,
    /// The other columns in the order of the owners' numbers, and the way to the owners; `None` where no rank has any.
    far: Vec<u32>,
    halo: Option<Halo>,
    /// The columns that this rank has.
    own: PetscVec,
    /// Values at the columns that this rank has, and at its ghosts.
    shares: RefCell<Vec<f64>>,
    /// A number for every column that is known; only those of this rank's rows are in use.
    work: RefCell<Vec<f64>>,
}

impl TeamFactor {
    /// For these columns and factors that this team shares. Collective.
    pub fn new(session: &Session, team: &Rc<FactorTeam>, columns: &[u32]) -> Result<TeamFactor> {
        let mut near = Vec::new();
        // PETSc's numbers of columns that others have: rank after rank.
        let mut placed: Vec<(u32, u32)> = Vec::new();
        for &column in columns {
            match team.here(column) {
                Some(at) => near.push((column, at)),
                None => placed.push((team.place(column).number, column)),
            }
        }
        placed.sort_unstable();
        let (numbers, far): (Vec<u32>, Vec<u32>) = placed.into_iter().unzip();
        let (n_own, n_ghosts) = team.sizes();
        let own = PetscVec::mpi(session, n_own)?;
        let some = any(session.comm(), !far.is_empty());
        Ok(TeamFactor {
            team: team.clone(),
            halo: some
                .then(|| Halo::new(session, &own, &numbers))
                .transpose()?,
            near,
            far,
            own,
            shares: RefCell::new(vec![0.0; n_own + n_ghosts]),
            work: RefCell::new(vec![0.0; team.n()]),
        })
    }

    /// Whether it leads to factors of this team.
    pub fn fits(&self, team: &Rc<FactorTeam>) -> bool {
        Rc::ptr_eq(team, &self.team)
    }

    /// Whether it knows all columns of these rows.
    pub fn covers(&self, rows: &KernelRows) -> bool {
        let mut known = vec![false; self.team.n()];
        let near = self.near.iter().map(|n| &n.0);
        near.chain(&self.far)
            .for_each(|&c| known[c as usize] = true);
        rows.columns().iter().all(|&c| known[c as usize])
    }

    /// x ← x − along A⁺ fromᵀ x for the matrix A of this factor. Collective.
    pub fn remove(
        &self,
        factor: &Gram,
        x: &PetscVec,
        from: &KernelRows,
        along: &KernelRows,
    ) -> Result<()> {
        let mut work = self.work.borrow_mut();
        let columns = self.near.iter().map(|n| &n.0).chain(&self.far);
        columns.for_each(|&c| work[c as usize] = 0.0);
        from.add_transpose(&x.array()?, &mut work);
        self.solve(factor, &mut work, None)?;
        along.add(-1.0, &work, &mut x.array_mut()?);
        Ok(())
    }

    /// c ← A⁺ (b + Σ c), the sum over the ranks, of which each has a share in its columns here, and gets the solution
    /// there; `b` is the same wherever columns are known. Collective.
    pub fn solve(&self, factor: &Gram, work: &mut [f64], b: Option<&[f64]>) -> Result<()> {
        let mut shares = self.shares.borrow_mut();
        shares.fill(0.0);
        for &(c, at) in &self.near {
            shares[at as usize] = work[c as usize];
        }
        if let Some(b) = b {
            let own = self.team.own_dofs().zip(shares.iter_mut());
            own.for_each(|(c, s)| *s += b[c as usize]);
        }
        let mut ghosts: Vec<f64> = self.far.iter().map(|&c| work[c as usize]).collect();
        if let Some(halo) = &self.halo {
            halo.sum(&ghosts, &self.own)?;
            let from_others = self.own.array()?;
            let pairs = shares.iter_mut().zip(&*from_others);
            pairs.for_each(|(s, v)| *s += v);
        }
        factor.solve_shares(&mut shares);
        if let Some(halo) = &self.halo {
            let mut own = self.own.array_mut()?;
            let n = own.len();
            own.copy_from_slice(&shares[..n]);
            drop(own);
            halo.fetch(&self.own, &mut ghosts)?;
        }
        let far = self.far.iter().zip(&ghosts);
        far.for_each(|(&c, v)| work[c as usize] = *v);
        let near = self.near.iter();
        near.for_each(|&(c, at)| work[c as usize] = shares[at as usize]);
        Ok(())
    }
}

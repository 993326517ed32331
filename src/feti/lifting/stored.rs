//! Z_c and Y = S Z_c as matrices, for subdomains that see few columns of Z_c. In the plane they see a dozen for each
//! component, while the interface has hundreds of dofs.

use std::cell::RefCell;
use std::sync::Arc;

use crate::feti::operators::stiffness::Stiffness;
use crate::feti::operators::work::{InterfaceBuffers, InterfaceColumns};
use crate::Result;
use base::linalg::dense::Dense;
use parallel::halo::{numbered, Halo};
use petsc::{Session, Vec as PetscVec};

/// Z_c and Y = S Z_c on one subdomain, n_Γ × its columns.
pub(crate) struct LiftingColumns {
    pub z: Dense,
    pub y: Dense,
}

/// Z_c and Y on every local subdomain, with the numbers of their columns.
pub(crate) struct Stored {
    /// Z_c and Y of each local subdomain; those in the same surroundings share one pair.
    pairs: Vec<Arc<LiftingColumns>>,
    /// For each local subdomain, the ghost column behind each of its columns.
    columns: Vec<Vec<u32>>,
    /// Global number of each ghost column.
    ghosts: Vec<u32>,
    halo: Halo,
    ghost: RefCell<Vec<f64>>,
}

impl Stored {
    /// `columns` has the global numbers of the columns of each pair. Vectors of columns have the layout of `layout`.
    /// Collective.
    pub fn new(
        session: &Session,
        layout: &PetscVec,
        pairs: Vec<Arc<LiftingColumns>>,
        columns: &[&[u32]],
    ) -> Result<Stored> {
        let (ghosts, columns) = numbered(columns);
        Ok(Stored {
            pairs,
            columns,
            halo: Halo::new(session, layout, &ghosts)?,
            ghost: RefCell::new(vec![0.0; ghosts.len()]),
            ghosts,
        })
    }

    /// Z_c x on the interface of every local subdomain; x is given by global column number.
    pub fn combine(&self, x: impl Fn(u32) -> f64) -> Vec<Vec<f64>> {
        let of = |(pair, columns): (&Arc<LiftingColumns>, &Vec<u32>)| {
            let c: Vec<f64> = columns
                .iter()
                .map(|&g| x(self.ghosts[g as usize]))
                .collect();
            let mut out = vec![0.0; pair.z.rows];
            pair.z.add_mul(&c, &mut out);
            out
        };
        self.pairs.iter().zip(&self.columns).map(of).collect()
    }

    /// Starts sending Yᵀ work.v. Collective.
    pub fn begin(
        &self,
        stiffness: &Stiffness,
        work: &[InterfaceBuffers],
        vector: &PetscVec,
    ) -> Result<()> {
        let mut ghost = self.ghost.borrow_mut();
        ghost.fill(0.0);
        let mut local: Vec<Vec<f64>> = self.columns.iter().map(|c| vec![0.0; c.len()]).collect();
        let pairs = &self.pairs;
        stiffness.team.for_each(&mut local, |j, t| {
            pairs[j].y.add_mul_transpose(&work[j].v, t); /*    t ← Yᵀ v        */
        });
        for (t, places) in local.iter().zip(&self.columns) {
            for (&g, v) in places.iter().zip(t) {
                ghost[g as usize] += v;
            }
        }
        self.halo.sum_begin(&ghost, vector)
    }

    /// work.y ← work.y − Y A⁺ Yᵀ work.v, after [`begin`](Self::begin); `solve` applies A⁺. Collective.
    pub fn finish(
        &self,
        stiffness: &Stiffness,
        work: &mut [InterfaceBuffers],
        vector: &PetscVec,
        solve: impl Fn(&mut [f64]),
    ) -> Result<()> {
        let mut ghost = self.ghost.borrow_mut();
        let (pairs, columns) = (&self.pairs, &self.columns);
        self.halo.sum_end(vector)?;
        solve(&mut vector.array_mut()?); /*               c ← A⁺ t        */
        self.halo.fetch(vector, &mut ghost)?;
        let ghost = &*ghost;
        stiffness.team.for_each(work, |j, w| {
            let c: Vec<f64> = columns[j].iter().map(|&g| -ghost[g as usize]).collect();
            pairs[j].y.add_mul(&c, &mut w.y); /*               y ← y − Y c     */
        });
        Ok(())
    }

    /// y ← y − Y A⁺ Yᵀ v for several columns of every local subdomain. Collective.
    pub fn remove_many(
        &self,
        stiffness: &Stiffness,
        blocks: &mut [InterfaceColumns],
        vector: &PetscVec,
        solve: impl Fn(&mut [f64]),
    ) -> Result<()> {
        let n = blocks.first().map_or(0, |b| b.v.cols);
        let (inputs, pairs, columns) = (&*blocks, &self.pairs, &self.columns);
        let products = stiffness.team.map(blocks.len(), |j| {
            let mut t = Dense::zeros(pairs[j].y.cols, n);
            pairs[j].y.add_mul_transpose_columns(&inputs[j].v, &mut t); /*  t ← Yᵀ v        */
            t
        });
        let mut all = Dense::zeros(self.halo.n_ghosts, n);
        for (t, places) in products.iter().zip(columns) {
            for c in 0..n {
                let column = all.col_mut(c);
                for (&g, v) in places.iter().zip(t.col(c)) {
                    column[g as usize] += v;
                }
            }
        }
        for c in 0..n {
            self.halo.sum(all.col(c), vector)?;
            solve(&mut vector.array_mut()?); /*                        c ← A⁺ t        */
            self.halo.fetch(vector, all.col_mut(c))?;
        }
        let all = &all;
        stiffness.team.for_each(blocks, |j, b| {
            let mut x = Dense::zeros(columns[j].len(), n);
            for c in 0..n {
                for (x, &g) in x.col_mut(c).iter_mut().zip(&columns[j]) {
                    *x = -all.get(g as usize, c);
                }
            }
            pairs[j].y.add_mul_columns(&x, &mut b.y); /*                    y ← y − Y c     */
        });
        Ok(())
    }
}

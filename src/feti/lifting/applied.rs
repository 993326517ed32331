//! Z_c = E_D Ψ I as a product, for subdomains that see many of its columns.

use std::cell::RefCell;

use super::averaging::{Averaging, Transposition};
use super::interpolation::Functions;
use crate::feti::operators::stiffness::Stiffness;
use crate::feti::primal::space::PrimalSpace;
use crate::Result;
use parallel::halo::{numbered, Halo};
use petsc::{Session, Vec as PetscVec};

/// The parts of Z_c on this rank.
pub(crate) struct Applied {
    functions: Vec<Functions>,
    averaging: Averaging,
    /// For each local subdomain, the ghost column behind each of its functions.
    columns: Vec<Vec<u32>>,
    /// Global number of each ghost column.
    ghosts: Vec<u32>,
    halo: Halo,
    ghost: RefCell<Vec<f64>>,
}

impl Applied {
    /// Vectors of columns have the layout of `layout`. Collective.
    pub fn new(
        session: &Session,
        layout: &PetscVec,
        space: &PrimalSpace,
        functions: Vec<Functions>,
        averaging: Averaging,
    ) -> Result<Applied> {
        let global = |(f, places): (&Functions, &Vec<u32>)| -> Vec<u32> {
            let places = f.columns.iter().map(|&p| places[p]);
            places.map(|g| space.ghosts[g as usize]).collect()
        };
        let of = functions.iter().zip(&space.of_subdomain).map(global);
        let (ghosts, columns) = numbered(&of.collect::<Vec<_>>());
        Ok(Applied {
            halo: Halo::new(session, layout, &ghosts)?,
            ghost: RefCell::new(vec![0.0; ghosts.len()]),
            functions,
            averaging,
            columns,
            ghosts,
        })
    }

    /// Z_c x on the interface of every local subdomain; x is given by global column number. Collective.
    pub fn combine(&self, stiffness: &Stiffness, x: impl Fn(u32) -> f64) -> Result<Vec<Vec<f64>>> {
        let ghost: Vec<f64> = self.ghosts.iter().map(|&g| x(g)).collect();
        let mut out = vec![Vec::new(); stiffness.locals.len()];
        self.spread(stiffness, &ghost, &mut out)?;
        Ok(out)
    }

    /// w ← Z_c A⁺ Z_cᵀ w on the interface of every local subdomain; `solve` applies A⁺. Collective.
    pub fn project(
        &self,
        stiffness: &Stiffness,
        w: &mut [Vec<f64>],
        vector: &PetscVec,
        solve: impl Fn(&mut [f64]),
    ) -> Result<()> {
        let ghost = &mut *self.ghost.borrow_mut();
        self.averaging.apply(Transposition::Transposed, w)?;
        let (functions, locals) = (&self.functions, &stiffness.locals);
        stiffness.team.for_each(w, |j, w| {
            let mut p = vec![0.0; locals[j].gamma().n_pi()];
            locals[j].begin(w, &mut p); /*                p ← Ψᵀ E_Dᵀ w   */
            w.resize(functions[j].columns.len(), 0.0);
            functions[j].gather(&p, w); /*                c ← Iᵀ p        */
        });
        ghost.fill(0.0);
        for (c, places) in w.iter().zip(&self.columns) {
            for (&g, c) in places.iter().zip(c) {
                ghost[g as usize] += c;
            }
        }
        self.halo.sum(ghost, vector)?;
        solve(&mut vector.array_mut()?); /*               c ← A⁺ c        */
        self.halo.fetch(vector, ghost)?;
        self.spread(stiffness, ghost, w)
    }

    /// w ← Z_c c, with `c` given at the ghost columns.
    fn spread(&self, stiffness: &Stiffness, c: &[f64], w: &mut [Vec<f64>]) -> Result<()> {
        let (functions, locals, columns) = (&self.functions, &stiffness.locals, &self.columns);
        stiffness.team.for_each(w, |j, w| {
            let c: Vec<f64> = columns[j].iter().map(|&g| c[g as usize]).collect();
            let mut p = vec![0.0; locals[j].gamma().n_pi()];
            functions[j].spread(&c, &mut p); /*           p ← I c         */
            w.clear();
            w.resize(locals[j].gamma().n_gamma(), 0.0);
            locals[j].add_psi(&p, w); /*                  w ← Ψ p         */
        });
        self.averaging.apply(Transposition::Plain, w) /*            w ← E_D w       */
    }
}

//! Z_c: coarse functions of the bodies that vanish where bodies may touch (method section 5).
//!
//! Columns of Z_c are columns of Ψ at vertices and averages that subdomains of the body share, their copies averaged inside the body with the scaling weights, set to zero on
//! candidate contact nodes: Z_c = E_D Ψ I, with I the identity or the interpolation of averages from vertices. Removing their span S̃-orthogonally from what
//! B_Dᵀ lifts,
//!
//! ```text
//!     M_C⁻¹ = B_D S̃ ( I − Z_c A⁺ Z_cᵀ S̃ ) B_Dᵀ,      A = Z_cᵀ S̃ Z_c
//! ```
//!
//! lets a jump on a body's face decay over the whole body instead of over the layer of subdomains beside it. B Z_c = 0 for
//! every active set, so nothing here changes in a contact step.
//!
//! A subdomain in space sees hundreds of columns of Z_c, as many as its interface has dofs: there Z_c is never stored, and S is multiplied with
//! twice. In the plane it sees some 40, and Y = S Z_c is kept: S̃ ( I − Z_c A⁺ Z_cᵀ S̃ ) = S̃ − Y A⁺ Yᵀ.

use std::cell::RefCell;

use mpi::traits::Communicator;

use super::averaging::{Averaging, Way};
use super::clock::{self, Phase};
use super::coarse_functions::recipes;
use super::exchange::{exchange_words, sum_all};
use super::halo::Halo;
use super::interpolation::Functions;
use super::lifting_matrix::{BodyFactor, Sums};
use super::lifting_stored::Stored;
use super::settings::CoarseFunctions;
use super::sharing::Sharing;
use super::stiffness::{Columns, Stiffness, Work};
use crate::petsc::{Session, Vec as PetscVec};
use crate::substructures::Substructures;
use crate::Result;

/// Z_c of all bodies, with A factored. Columns carry the numbers of the primal dofs they come from.
pub struct Lifting {
    functions: Vec<Functions>,
    averaging: Averaging,
    stored: Option<Stored>,
    /// For each local subdomain, the ghost column behind each of its functions.
    columns: Vec<Vec<u32>>,
    /// Global number of each ghost column.
    ghosts: Vec<u32>,
    halo: Halo,
    bodies: Vec<BodyFactor>,
    vector: PetscVec,
    ghost: RefCell<Vec<f64>>,
    /// Rank of A and its order (columns that are not zero), over this rank's bodies.
    pub rank_and_order: (usize, usize),
    /// Σ n_Γ² · columns of Z_c over the blocks of A that this rank has made.
    pub products: f64,
}

impl Lifting {
    /// Builds Z_c; `None` if no body has a column. Collective.
    pub fn new(
        session: &Session,
        problem: &Substructures,
        sharing: &Sharing,
        stiffness: &Stiffness,
        which: CoarseFunctions,
    ) -> Result<Option<Lifting>> {
        let comm = session.comm();
        let (space, locals, jump) = (&stiffness.space, &stiffness.locals, &stiffness.jump);
        let functions = stiffness.team.map(locals.len(), |j| {
            Functions::new(which, &problem.local[j], sharing, jump, &locals[j], j)
        });
        let recipes = recipes(session, problem, sharing, stiffness, &functions);
        // What an application reads: Y twice, by itself, or S once more, which equal subdomains share.
        let mut entries = [0.0; 2];
        for (recipe, local) in recipes.iter().zip(locals) {
            let n_gamma = local.n_gamma() as f64;
            entries[0] += 4.0 * n_gamma * recipe.columns.len() as f64;
            entries[1] += n_gamma.powi(2);
        }
        sum_all(comm, &mut entries);
        let keep_y = entries[0] <= entries[1];
        let Sums { sums, products, y } =
            Sums::new(problem, stiffness, &functions, &recipes, keep_y);
        let mut outgoing: Vec<Vec<u64>> = vec![Vec::new(); comm.size() as usize];
        for sum in &sums {
            sum.pack(&mut outgoing[space.owner[sum.body] as usize]);
        }
        drop(sums);
        let received = exchange_words(comm, outgoing);
        let bodies = stiffness.team.map(space.owned.len(), |b| {
            let range = &space.owned[b].range;
            let first = (space.first + range.start) as u32;
            BodyFactor::new(&received, first..first + range.len() as u32, space.first)
        });
        let rank = bodies.iter().map(|b| b.factor.rank()).sum();
        let order = bodies.iter().map(|b| b.factor.nonzero()).sum::<usize>();
        let mut total = [order as f64];
        sum_all(comm, &mut total);
        if total[0] == 0.0 {
            return Ok(None);
        }
        let numbers = |(f, places): (&Functions, &Vec<u32>)| -> Vec<u32> {
            let places = f.columns.iter().map(|&p| places[p]);
            places.map(|g| space.ghosts[g as usize]).collect()
        };
        let of: Vec<Vec<u32>> = functions
            .iter()
            .zip(&space.of_subdomain)
            .map(numbers)
            .collect();
        let mut ghosts: Vec<u32> = of.concat();
        ghosts.sort_unstable();
        ghosts.dedup();
        let place = |g: &u32| {
            let at = ghosts.binary_search(g);
            at.expect("every column was collected") as u32
        };
        let columns = of.iter().map(|l| l.iter().map(place).collect()).collect();
        let vector = PetscVec::mpi(session, space.n_owned)?;
        let halo = Halo::new(session, &vector, &ghosts)?;
        let stored = match keep_y {
            true => {
                let columns: Vec<&[u32]> = recipes.iter().map(|r| &r.columns[..]).collect();
                Some(Stored::new(session, &vector, y, &columns)?)
            }
            false => None,
        };
        Ok(Some(Lifting {
            averaging: Averaging::new(session, problem, sharing, stiffness)?,
            stored,
            functions,
            columns,
            ghost: RefCell::new(vec![0.0; ghosts.len()]),
            ghosts,
            halo,
            bodies,
            vector,
            rank_and_order: (rank, order),
            products,
        }))
    }

    /// Z_c x on the interface of every local subdomain, x given by global column number. Collective.
    pub fn combine(&self, stiffness: &Stiffness, x: impl Fn(u32) -> f64) -> Result<Vec<Vec<f64>>> {
        let mut out: Vec<Vec<f64>> = self.room(stiffness);
        let ghost: Vec<f64> = self.ghosts.iter().map(|&g| x(g)).collect();
        self.spread(stiffness, &ghost, &mut out)?;
        Ok(out)
    }

    /// w ← Z_c A⁺ Z_cᵀ w on the interface of every local subdomain. Collective.
    pub fn remove(&self, stiffness: &Stiffness, w: &mut [Vec<f64>]) -> Result<()> {
        let ghost = &mut *self.ghost.borrow_mut();
        self.averaging.apply(Way::Transposed, w)?;
        let (functions, locals) = (&self.functions, &stiffness.locals);
        stiffness.team.for_each(w, |j, w| {
            let mut p = vec![0.0; locals[j].n_pi()];
            locals[j].psi_transpose(w, &mut p); /*        p ← Ψᵀ E_Dᵀ w   */
            w.resize(functions[j].columns.len(), 0.0);
            functions[j].gather(&p, w); /*                c ← Iᵀ p        */
        });
        ghost.fill(0.0);
        for (c, places) in w.iter().zip(&self.columns) {
            for (&g, c) in places.iter().zip(c) {
                ghost[g as usize] += c;
            }
        }
        self.halo.sum(ghost, &self.vector)?;
        {
            let mut owned = self.vector.array_mut()?;
            self.solve(&mut owned); /*                    c ← A⁺ c        */
        }
        self.halo.fetch(&self.vector, ghost)?;
        self.spread(stiffness, ghost, w)
    }

    /// w ← Z_c c, `c` at the ghost columns.
    fn spread(&self, stiffness: &Stiffness, c: &[f64], w: &mut [Vec<f64>]) -> Result<()> {
        let (functions, locals, columns) = (&self.functions, &stiffness.locals, &self.columns);
        stiffness.team.for_each(w, |j, w| {
            let c: Vec<f64> = columns[j].iter().map(|&g| c[g as usize]).collect();
            let mut p = vec![0.0; locals[j].n_pi()];
            functions[j].spread(&c, &mut p); /*           p ← I c         */
            w.clear();
            w.resize(locals[j].n_gamma(), 0.0);
            locals[j].add_psi(&p, w); /*                  w ← Ψ p         */
        });
        self.averaging.apply(Way::Plain, w) /*            w ← E_D w       */
    }

    /// x ← A⁺ x on this rank's bodies.
    fn solve(&self, x: &mut [f64]) {
        clock::timed(Phase::Lifting, || {
            self.bodies.iter().for_each(|b| b.solve(x))
        });
    }

    /// Whether Y = S Z_c is kept: then [`begin`](Self::begin) and [`finish`](Self::finish) take the place of [`remove`](Self::remove).
    pub fn keeps_y(&self) -> bool {
        self.stored.is_some()
    }

    /// Sends Yᵀ work.v on its way, where Y is kept. Collective.
    pub fn begin(&self, stiffness: &Stiffness, work: &[Work]) -> Result<()> {
        let stored = self.stored.as_ref();
        stored.map_or(Ok(()), |s| s.begin(stiffness, work, &self.vector))
    }

    /// work.y ← work.y − Y A⁺ Yᵀ work.v, after [`begin`](Self::begin), where Y is kept. Collective.
    pub fn finish(&self, stiffness: &Stiffness, work: &mut [Work]) -> Result<()> {
        let stored = self.stored.as_ref();
        stored.map_or(Ok(()), |s| {
            s.finish(stiffness, work, &self.vector, |x| self.solve(x))
        })
    }

    /// blocks.y ← blocks.y − Y A⁺ Yᵀ blocks.v, where Y is kept. Collective.
    pub fn remove_many(&self, stiffness: &Stiffness, blocks: &mut [Columns]) -> Result<()> {
        let stored = self.stored.as_ref();
        stored.map_or(Ok(()), |s| {
            s.remove_many(stiffness, blocks, &self.vector, |x| self.solve(x))
        })
    }

    /// Zeros on the interfaces of the local subdomains.
    fn room(&self, stiffness: &Stiffness) -> Vec<Vec<f64>> {
        let locals = stiffness.locals.iter();
        locals.map(|l| vec![0.0; l.n_gamma()]).collect()
    }
}

//! Z_c: coarse functions of the bodies that vanish where bodies may touch (docs/theory.md, section 4).
//!
//! Columns of Z_c come from columns of Ψ at vertices and averages that subdomains of the body share. Their copies are
//! averaged inside the body with the scaling weights and set to zero on candidate contact nodes: Z_c = E_D Ψ I, where I
//! is the identity or the interpolation of averages from vertices. Their span is removed S̃-orthogonally from the jumps
//! that B_Dᵀ lifts:
//!
//! ```text
//!     M_C⁻¹ = B_D S̃ ( I − Z_c A⁺ Z_cᵀ S̃ ) B_Dᵀ,      A = Z_cᵀ S̃ Z_c
//! ```
//!
//! A jump on a body's face then decays over the whole body instead of over the layer of subdomains beside it. B Z_c = 0
//! for every active set, so that Z_c does not change in a contact step.
//!
//! A subdomain in space sees hundreds of columns of Z_c, as many as its interface has dofs. Z_c is not stored there,
//! and M_C multiplies with S twice. In the plane a subdomain sees a dozen columns for each component, and Y = S Z_c is
//! stored: S̃ ( I − Z_c A⁺ Z_cᵀ S̃ ) = S̃ − Y A⁺ Yᵀ.

use mpi::traits::Communicator;

use super::applied::Applied;
use super::averaging::Averaging;
use super::coarse_functions::recipes;
use super::factor::{shares, BodyFactor};
use super::interpolation::Functions;
use super::matrix::LiftingSums;
use super::stored::Stored;
use crate::feti::interface::sharing::DofSharing;
use crate::feti::operators::stiffness::Stiffness;
use crate::feti::operators::work::{InterfaceBuffers, InterfaceColumns};
use crate::feti::primal::matrix::Blocks;
use crate::feti::settings::CoarseFunctions;
use crate::substructures::Problem;
use crate::Result;
use parallel::clock::{self, Phase};
use parallel::exchange::{any, sum_all};
use petsc::Vec as PetscVec;

/// Z_c of all bodies, with A factored. Columns carry the numbers of the primal dofs they come from.
pub struct Lifting {
    z: LiftingForm,
    bodies: Vec<BodyFactor>,
    vector: PetscVec,
    /// Rank of A and its order (columns that are not zero), over this rank's bodies.
    pub rank_and_order: (usize, usize),
    /// Σ n_Γ² · columns of Z_c over the blocks of A that this rank has made; a study reads it.
    pub products: f64,
}

/// The form in which Z_c is stored.
enum LiftingForm {
    /// As matrices, where there are few columns.
    Stored(Box<Stored>),
    /// As the factors of its product.
    Applied(Box<Applied>),
}

/// Time for an entry of Y, which is read for one vector, relative to an entry of S in a product with many vectors.
const ALONE: f64 = 2.0;

/// Time for E_D and its transpose per row of S, in entries of S.
const AVERAGES: f64 = 30.0;

impl Lifting {
    /// Builds Z_c; `None` if no body has a column. Collective.
    pub fn new(
        problem: &Problem,
        sharing: &DofSharing,
        stiffness: &Stiffness,
        which: CoarseFunctions,
    ) -> Result<Option<Lifting>> {
        let (session, comm) = (&stiffness.session, stiffness.comm());
        let (space, locals, jump) = (&stiffness.space, &stiffness.locals, &stiffness.jump);
        let functions = stiffness.team.map(locals.len(), |j| {
            Functions::new(which, &problem.local[j], sharing, jump, &locals[j], j)
        });
        let recipes = recipes(problem, sharing, stiffness, &functions);
        // Cost of an application: Y twice, for one vector; or S once more, in a product that equal subdomains share,
        // and E_D.
        let mut entries = [0.0; 2];
        for (recipe, local) in recipes.iter().zip(locals) {
            let n_gamma = local.gamma().n_gamma() as f64;
            entries[0] += ALONE * 2.0 * n_gamma * recipe.columns.len() as f64;
            entries[1] += n_gamma * (n_gamma + AVERAGES);
        }
        sum_all(comm, &mut entries);
        let keep = entries[0] <= entries[1];
        let LiftingSums {
            sums,
            products,
            kept,
        } = LiftingSums::new(problem, stiffness, &functions, &recipes, keep);
        let mut outgoing = vec![Blocks::default(); comm.size() as usize];
        for sum in &sums {
            sum.give(&mut outgoing[space.owner(sum.subdomain())]);
        }
        drop(sums);
        let received = Blocks::exchange(comm, outgoing);
        let owned: Vec<_> = space.owned.iter().map(|b| b.range.clone()).collect();
        let shares = shares(&received, &owned, space.first);
        let bodies = stiffness
            .team
            .map(shares.len(), |b| BodyFactor::new(&shares[b], space.first));
        let sizes = bodies.iter().map(BodyFactor::rank_and_order);
        let (rank, order) = sizes.fold((0, 0), |(r, o), (rank, order)| (r + rank, o + order));
        if !any(comm, order > 0) {
            return Ok(None);
        }
        let vector = PetscVec::mpi(session, space.n_owned)?;
        let z = if keep {
            let columns: Vec<&[u32]> = recipes.iter().map(|r| &r.columns[..]).collect();
            LiftingForm::Stored(Box::new(Stored::new(session, &vector, kept, &columns)?))
        } else {
            let averaging = Averaging::new(problem, sharing, stiffness)?;
            let applied = Applied::new(session, &vector, space, functions, averaging)?;
            LiftingForm::Applied(Box::new(applied))
        };
        Ok(Some(Lifting {
            z,
            bodies,
            vector,
            rank_and_order: (rank, order),
            products,
        }))
    }

    /// Z_c x on the interface of every local subdomain, x given by global column number. Collective.
    pub fn combine(&self, stiffness: &Stiffness, x: impl Fn(u32) -> f64) -> Result<Vec<Vec<f64>>> {
        match &self.z {
            LiftingForm::Stored(stored) => Ok(stored.combine(x)),
            LiftingForm::Applied(applied) => applied.combine(stiffness, x),
        }
    }

    /// The first half of work.y ← S̃ (I − Z_c A⁺ Z_cᵀ S̃) work.v: sends the data that does not depend on S work.v.
    /// Collective.
    pub fn begin(&self, stiffness: &Stiffness, work: &[InterfaceBuffers]) -> Result<()> {
        match &self.z {
            LiftingForm::Stored(stored) => stored.begin(stiffness, work, &self.vector),
            LiftingForm::Applied(_) => Ok(()),
        }
    }

    /// The second half; work.y ← S work.v must have been computed. `multiply` computes this product. Collective.
    pub fn finish(
        &self,
        stiffness: &Stiffness,
        work: &mut [InterfaceBuffers],
        multiply: impl Fn(&mut [InterfaceBuffers]),
    ) -> Result<()> {
        let solve = |x: &mut [f64]| self.solve(x);
        match &self.z {
            LiftingForm::Stored(stored) => stored.finish(stiffness, work, &self.vector, solve),
            LiftingForm::Applied(applied) => {
                let mut lifted: Vec<Vec<f64>> = work.iter().map(|w| w.y.clone()).collect();
                applied.project(stiffness, &mut lifted, &self.vector, solve)?;
                for (w, lifted) in work.iter_mut().zip(&lifted) {
                    subtract(&mut w.v, lifted); /*            v ← v − Z_c A⁺ Z_cᵀ y */
                }
                multiply(work); /*                            y ← S v            */
                Ok(())
            }
        }
    }

    /// Both halves for several columns of every local subdomain; blocks.y ← S blocks.v must have been computed.
    /// `multiply` computes this product. Collective.
    pub fn finish_many(
        &self,
        stiffness: &Stiffness,
        blocks: &mut [InterfaceColumns],
        multiply: impl Fn(&mut [InterfaceColumns]),
    ) -> Result<()> {
        let solve = |x: &mut [f64]| self.solve(x);
        match &self.z {
            LiftingForm::Stored(stored) => {
                stored.remove_many(stiffness, blocks, &self.vector, solve)
            }
            LiftingForm::Applied(applied) => {
                for c in 0..blocks.first().map_or(0, |b| b.v.cols) {
                    let columns = blocks.iter().map(|b| b.y.col(c).to_vec());
                    let mut lifted: Vec<Vec<f64>> = columns.collect();
                    applied.project(stiffness, &mut lifted, &self.vector, solve)?;
                    for (b, lifted) in blocks.iter_mut().zip(&lifted) {
                        subtract(b.v.col_mut(c), lifted);
                    }
                }
                multiply(blocks);
                Ok(())
            }
        }
    }

    /// x ← A⁺ x on the bodies of this rank.
    fn solve(&self, x: &mut [f64]) {
        clock::timed(Phase::Lifting, || {
            self.bodies.iter().for_each(|b| b.solve(x))
        });
    }
}

fn subtract(v: &mut [f64], what: &[f64]) {
    v.iter_mut().zip(what).for_each(|(v, w)| *v -= w);
}

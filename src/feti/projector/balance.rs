//! Forces that are balanced on every floating body, and the motions of the bodies.

use mpi::topology::SimpleCommunicator;

use super::coarse_solver::InverseSide;
use super::column_map::ColumnMap;
use super::gtg::Gtg;
use super::kernel_motion::KernelMotion;
use super::natural::NaturalCoarse;
use crate::feti::settings::ProjectorKind;
use crate::Result;
use parallel::exchange::sum_all;
use petsc::Vec as PetscVec;

/// Forces so many times as large as the smallest ones that balance the loads, and larger than the λ that they are added
/// to, are no start: the iteration would have to take them back, with the digits that they leave it
/// (docs/theory.md, section 6).
const VAST: f64 = 1e3;

/// The work of the loads on the kernels: e = Rᵀ g, and the size of the terms that may cancel in it.
#[derive(Debug, Clone, Default)]
pub struct KernelLoad {
    /// e, a vector of columns: the same wherever they are known.
    pub e: Vec<f64>,
    /// For each entry of e the largest |R| times Σ|f|. Loads inside a subdomain may cancel before they reach g.
    pub size: Vec<f64>,
    /// For each entry of e what rounding of the input may do: the size times the angle to which directions on the body
    /// are known. Zero, or empty, where they are exact.
    pub rounding: Vec<f64>,
    /// The largest of all sizes.
    pub largest: f64,
}

impl KernelLoad {
    /// Its entries at the columns of motions. The same on every rank. Collective.
    pub fn along(
        &self,
        comm: &SimpleCommunicator,
        known: &ColumnMap,
        motions: &[KernelMotion],
    ) -> LoadWork {
        let vectors = [&self.e[..], &self.size, &self.rounding];
        let (names, [e, size, rounding]) = known.at(comm, motions, vectors);
        LoadWork {
            names,
            e,
            size,
            rounding,
        }
    }
}

/// The work of the loads on some kernel vectors.
#[derive(Debug, Clone, Default)]
pub struct LoadWork {
    /// The names of their columns, increasing.
    names: Vec<u32>,
    e: Vec<f64>,
    size: Vec<f64>,
    rounding: Vec<f64>,
}

impl LoadWork {
    /// The work on a motion, if it is no rounding: more than this part of the terms that may cancel in it, and than
    /// what the digits of the input leave open.
    pub fn driving(&self, motion: &KernelMotion, part: f64) -> Option<f64> {
        let [work, size, rounding] = self.work(motion);
        (work.abs() > (part * size).max(rounding)).then_some(work)
    }

    /// The work on a motion, the size of the terms that may cancel in it, and what rounding of the input may do.
    ///
    /// # Panics
    /// If it has other columns.
    pub fn work(&self, motion: &KernelMotion) -> [f64; 3] {
        let mut sums = [0.0; 3];
        for (c, v) in &motion.0 {
            let at = self
                .names
                .binary_search(c)
                .expect("a column that was asked for");
            sums[0] += v * self.e[at];
            sums[1] += (v * self.size[at]).abs();
            sums[2] += (v * self.rounding[at]).abs();
        }
        sums
    }
}

impl NaturalCoarse {
    /// e = Rᵀ g for the condensed loads g of the loads f. Collective.
    pub fn kernel_load(
        &self,
        comm: &SimpleCommunicator,
        f: &[&[f64]],
        g: &[Vec<f64>],
    ) -> KernelLoad {
        let known = self.known();
        let (mut e, mut size) = (vec![0.0; known.n()], vec![0.0; known.n()]);
        for (j, kernel) in self.kernels.iter().enumerate() {
            let load: f64 = f[j].iter().map(|f| f.abs()).sum();
            for c in 0..kernel.cols {
                let at = self.first_column(j) + c;
                let largest = kernel.col(c).iter().fold(0.0f64, |a, r| a.max(r.abs()));
                let work = kernel.col(c).iter().zip(&g[j]).map(|(r, g)| r * g);
                e[at] += work.sum::<f64>();
                size[at] += largest * load;
            }
        }
        known.sum(comm, &mut e);
        known.sum(comm, &mut size);
        let largest = known.largest(comm, &size);
        let rounding = if self.noise.is_empty() {
            vec![0.0; size.len()]
        } else {
            size.iter()
                .zip(&self.noise)
                .map(|(s, n)| s * n.sqrt())
                .collect()
        };
        KernelLoad {
            e,
            size,
            rounding,
            largest,
        }
    }

    /// λ ← λ + Q G (Gᵀ Q G)⁻¹ (e − Gᵀ λ): balances the forces on every floating body. From λ = 0 the result is λ₀.
    /// Collective.
    pub fn balance(
        &self,
        comm: &SimpleCommunicator,
        load: &KernelLoad,
        lambda: &PetscVec,
    ) -> Result<()> {
        self.balance_with(comm, load, lambda, false)
    }

    /// λ ← λ + Q G (Gᵀ Q G)⁻¹ (e − Gᵀ λ), to begin an iteration with: balances the forces on every floating body. Where
    /// forces would be [`VAST`], Q = I takes the place of Q = M⁻¹. Collective.
    pub fn begin(
        &self,
        comm: &SimpleCommunicator,
        load: &KernelLoad,
        lambda: &PetscVec,
    ) -> Result<()> {
        let differ = self.projector == ProjectorKind::Preconditioner;
        self.balance_with(comm, load, lambda, differ)
    }

    fn balance_with(
        &self,
        comm: &SimpleCommunicator,
        load: &KernelLoad,
        lambda: &PetscVec,
        choose: bool,
    ) -> Result<()> {
        let Some(solver) = &self.gtg else {
            return Ok(());
        };
        // The second pass recovers the digits that a badly conditioned Gᵀ Q G costs.
        let passes = if solver.needs_no_second() { 1 } else { 2 };
        for _ in 0..passes {
            let mut c = vec![0.0; self.known().n()];
            self.g.add_transpose(&lambda.array()?, &mut c);
            c.iter_mut().for_each(|c| *c = -*c);
            let least = choose.then(|| self.least(comm, solver, c.clone(), &load.e));
            solver.solve_sum(comm, &mut c, Some(&load.e), InverseSide::Plain)?;
            let mut lambda = lambda.array_mut()?;
            let mut forces = vec![0.0; lambda.len()];
            self.qg().add(1.0, &c, &mut forces);
            if let Some(least) = least {
                let square = |v: &[f64]| v.iter().map(|v| v * v).sum::<f64>();
                let mut squares = [square(&forces), square(&least), square(&lambda)];
                sum_all(comm, &mut squares);
                let [of, least_of, known] = squares.map(f64::sqrt);
                if of > VAST * least_of && of > known {
                    forces = least;
                }
            }
            lambda.iter_mut().zip(&forces).for_each(|(l, f)| *l += f);
        }
        Ok(())
    }

    /// G (Gᵀ G)⁺ (e + Σ c), the sum over the ranks: the smallest forces that do this work on the motions of the bodies.
    /// Collective.
    fn least(
        &self,
        comm: &SimpleCommunicator,
        solver: &Gtg,
        mut c: Vec<f64>,
        e: &[f64],
    ) -> Vec<f64> {
        self.known().sum(comm, &mut c);
        c.iter_mut().zip(e).for_each(|(c, e)| *c += e);
        solver.gram.solve(&mut c);
        let mut forces = vec![0.0; self.g.n()];
        self.g.add(1.0, &c, &mut forces);
        forces
    }

    /// α = −(Gᵀ Q G)⁻¹ (Q G)ᵀ jump: the rigid motions that close the jump left by S̃⁺(g − Bᵀ λ), in the columns of this
    /// rank's bodies; other entries are not to be read. Collective.
    pub fn alpha(&self, comm: &SimpleCommunicator, jump: &PetscVec) -> Result<Vec<f64>> {
        let mut c = vec![0.0; self.known().n()];
        let qg = self.qg();
        qg.add_transpose(&jump.array()?, &mut c);
        c.iter_mut().for_each(|v| *v = -*v);
        if let Some(gtg) = &self.gtg {
            gtg.solve_sum(comm, &mut c, None, InverseSide::Transposed)?;
        }
        Ok(c)
    }

    /// y ← y + R α on local subdomain `j`.
    pub fn add_kernel(&self, j: usize, alpha: &[f64], y: &mut [f64]) {
        let kernel = &self.kernels[j];
        kernel.add_mul(&alpha[self.first_column(j)..][..kernel.cols], y);
    }
}

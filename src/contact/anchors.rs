//! Anchors: springs between the bodies as a whole and where they were, a proximal term on the rigid motions α.
//!
//! ```text
//!     φ(u) + ½ (α − α_k)ᵀ H (α − α_k)           u = S̃⁺(g − Bᵀ λ) + R α
//!
//!     [ F + C    0    −G ] [ λ ]   [  b   ]
//!     [   0     H⁻¹   −I ] [ y ] = [ −α_k ]      b = B S̃⁺ g − (c − C μ),      y = H (α − α_k)
//!     [  Gᵀ      I     0 ] [ α ]   [  e   ]
//! ```
//!
//! Rows may hold a motion by so little that a Newton step sends bodies far beyond the model. Then the search begins
//! anew with anchors: a body goes no further than what is left of its load stretches them. They move along and become
//! softer from one minimisation to the next: the proximal method of multipliers [Rockafellar 1976].
//!
//! y are multipliers like λ. CG runs in the space of (λ, y) with Gᵀλ + y = 0, with the projector of these two.

use std::rc::Rc;

use mpi::topology::SimpleCommunicator;

use super::force_balance::ForceBalance;
use crate::feti::krylov::residual::Iterate;
use crate::feti::operators::dual::Dual;
use crate::feti::projector::column_map::ColumnMap;
use crate::feti::projector::rows::KernelRows;
use crate::feti::LinearMethod;
use crate::Result;
use base::linalg::sorted::distinct;
use parallel::exchange::total;
use petsc::Vec as PetscVec;

/// The anchors. Vectors are of the columns that are known here.
#[derive(Debug, Clone)]
pub struct Anchors {
    /// H, a diagonal.
    stiffness: Vec<f64>,
    /// α_k.
    centre: Vec<f64>,
    known: Rc<ColumnMap>,
}

/// The result of a solve with anchors, apart from λ.
pub struct Anchored {
    /// α.
    pub place: Vec<f64>,
    /// y = e − Gᵀλ.
    pub force: Vec<f64>,
    /// Iterations.
    pub iterations: usize,
    /// ‖ρ‖ at the beginning and the end, in the norm of the preconditioner.
    pub residuals: [f64; 2],
    /// Whether it is as small as it was to be.
    pub reached: bool,
}

/// (λ, y) or its residual.
struct AnchoredMultipliers {
    rows: PetscVec,
    columns: Vec<f64>,
}

impl AnchoredMultipliers {
    fn new(rows: PetscVec, columns: Vec<f64>) -> AnchoredMultipliers {
        AnchoredMultipliers { rows, columns }
    }
}

/// The system on the rows that hold.
struct AnchoredSystem<'a> {
    method: &'a LinearMethod,
    anchors: &'a Anchors,
    /// Q on the owned rows, zero where they do not hold.
    q: Vec<f64>,
    root: Vec<f64>,
    /// G, zero where rows do not hold.
    g: KernelRows,
    /// N = GᵀQG + H, from Q^½ G.
    balance: ForceBalance,
}

impl Anchors {
    /// Anchors at the start, each `times` as stiff as a row of its body, which gives way by `nodes` (one entry for each
    /// owned row). Collective.
    pub fn new(dual: &Dual, nodes: &[f64], times: f64) -> Option<Anchors> {
        let (natural, jump) = (&dual.natural, &dual.stiffness.jump);
        let pattern = &natural.shape.as_ref()?.pattern;
        let known = natural.known().clone();
        let mut sums = [vec![0.0; known.n()], vec![0.0; known.n()]];
        for i in jump.rows_between_bodies() {
            let columns = natural.all.entries(i).0.iter();
            let bodies = distinct(columns.map(|&c| pattern.bodies()[c as usize]));
            let counts = jump.law[i].is_inequality() && nodes[i] > 0.0;
            for body in bodies.into_iter().filter(|_| counts) {
                for c in pattern.columns(body as usize) {
                    sums[0][c] += 1.0 / nodes[i];
                    sums[1][c] += 1.0;
                }
            }
        }
        sums.iter_mut().for_each(|s| known.sum(dual.comm(), s));
        // The scale of all stands in for that of bodies without rows.
        let [all, n] = known.total(dual.comm(), |k| [sums[0][k], sums[1][k]]);
        let mean = |(sum, n): (&f64, &f64)| if *n > 0.0 { sum / n } else { all };
        Some(Anchors {
            stiffness: (sums[0].iter().zip(&sums[1]))
                .map(|pair| times * mean(pair))
                .collect(),
            centre: vec![0.0; known.n()],
            known,
        })
        .filter(|_| n > 0.0)
    }

    /// Anchors of all columns.
    #[cfg(test)]
    pub fn given(stiffness: Vec<f64>, centre: Vec<f64>) -> Anchors {
        let known = ColumnMap::all(centre.len()).into();
        Anchors {
            stiffness,
            centre,
            known,
        }
    }

    /// Goes along to a place α.
    pub fn follow(&mut self, place: &[f64]) {
        self.centre.copy_from_slice(place);
    }

    /// Makes the anchors softer by this factor.
    pub fn soften(&mut self, factor: f64) {
        self.stiffness.iter_mut().for_each(|h| *h /= factor);
    }

    /// The contribution of the anchors to φ' along a segment at t, −dα (y(t) − H (α(t) − α_k)), and its derivative; α
    /// and y at both ends. Collective.
    pub fn slope(&self, comm: &SimpleCommunicator, ends: [&[Vec<f64>; 2]; 2], t: f64) -> [f64; 2] {
        let [from, to] = ends;
        self.known.total(comm, |k| {
            let [a, y] = [0, 1].map(|i| from[i][k]);
            let [da, dy] = [0, 1].map(|i| to[i][k] - from[i][k]);
            let stretch = a + t * da - self.centre[k];
            let (h, y) = (self.stiffness[k], y + t * dy);
            [da * (h * stretch - y), da * (h * da - dy)]
        })
    }

    /// The solution for the load and the set of `at`, from its λ: until the residual has fallen by `reduction`, or
    /// to `least`. `give` is the compliance of the nodes and springs on the owned rows. Collective.
    pub fn solve(
        &self,
        method: &LinearMethod,
        at: &mut Iterate,
        give: &[f64],
        [reduction, least]: [f64; 2],
    ) -> Result<Anchored> {
        let comm = method.session.comm();
        let dual = method.dual();
        let (natural, active) = (&dual.natural, &dual.stiffness.jump.active);
        let q: Vec<f64> = (give.iter().zip(active))
            .map(|(c, on)| if *on && *c > 0.0 { 1.0 / c } else { 0.0 })
            .collect();
        let root: Vec<f64> = q.iter().map(|q| q.sqrt()).collect();
        // What rows do by rounding on motions that count as free is part of the gaps, too.
        let mut g = natural.all.clone();
        let on = active.iter().map(|on| f64::from(u8::from(*on)));
        g.scale_rows(&on.collect::<Vec<f64>>());
        let mut scaled = g.clone();
        scaled.scale_rows(&root);
        let system = AnchoredSystem {
            method,
            anchors: self,
            balance: ForceBalance::raised(comm, scaled, natural, Some(&self.stiffness)),
            g,
            q,
            root,
        };
        drop(dual);
        system.run(at, [reduction, least])
    }
}

impl AnchoredSystem<'_> {
    /// Gᵀ λ. Collective.
    fn forces(&self, lambda: &PetscVec) -> Result<Vec<f64>> {
        let known = &self.anchors.known;
        let mut c = vec![0.0; known.n()];
        self.g.add_transpose(&lambda.array()?, &mut c);
        known.sum(self.method.session.comm(), &mut c);
        Ok(c)
    }

    /// β = N⁻¹(GᵀQ ρ + H ρ_y), and ρ without (G, I) β. Collective.
    fn project_transpose(&self, w: &mut AnchoredMultipliers) -> Result<Vec<f64>> {
        let scaled: Vec<f64> = (w.rows.array()?.iter())
            .zip(&self.root)
            .map(|(x, s)| x * s)
            .collect();
        let mut beta = self.balance.forces(self.method.session.comm(), &scaled);
        let of_columns = w.columns.iter().zip(&self.anchors.stiffness);
        beta.iter_mut()
            .zip(of_columns)
            .for_each(|(b, (y, h))| *b += h * y);
        self.balance.solve(&mut beta);
        self.g.add(-1.0, &beta, &mut w.rows.array_mut()?);
        w.columns.iter_mut().zip(&beta).for_each(|(y, b)| *y -= b);
        Ok(beta)
    }

    /// (λ, y) without (QG, H) N⁻¹ (Gᵀλ + y). Collective.
    fn project(&self, z: &mut AnchoredMultipliers) -> Result<()> {
        let mut gamma = self.forces(&z.rows)?;
        gamma.iter_mut().zip(&z.columns).for_each(|(c, y)| *c += y);
        self.balance.solve(&mut gamma);
        let mut along = vec![0.0; self.q.len()];
        self.g.add(1.0, &gamma, &mut along);
        let along = along.iter().zip(&self.q);
        (z.rows.array_mut()?.iter_mut())
            .zip(along)
            .for_each(|(z, (v, q))| *z -= q * v);
        let of_columns = gamma.iter().zip(&self.anchors.stiffness);
        z.columns
            .iter_mut()
            .zip(of_columns)
            .for_each(|(y, (c, h))| *y -= h * c);
        Ok(())
    }

    /// P (M⁻¹, H) ρ. Collective.
    fn precondition(&self, w: &AnchoredMultipliers) -> Result<AnchoredMultipliers> {
        let dual = self.method.dual();
        let rows = dual.multipliers()?;
        dual.m(&w.rows, &rows)?;
        let columns = w.columns.iter().zip(&self.anchors.stiffness);
        let columns = columns.map(|(y, h)| h * y).collect();
        drop(dual);
        let mut z = AnchoredMultipliers::new(rows, columns);
        self.project(&mut z)?;
        Ok(z)
    }

    /// xᵀ y. Collective.
    fn dot(&self, x: &AnchoredMultipliers, y: &AnchoredMultipliers) -> Result<f64> {
        let comm = self.method.session.comm();
        let rows: f64 = (x.rows.array()?.iter())
            .zip(y.rows.array()?.iter())
            .map(|(x, y)| x * y)
            .sum();
        let known = &self.anchors.known;
        let [columns] = known.total(comm, |k| [x.columns[k] * y.columns[k]]);
        Ok(total(comm, rows) + columns)
    }

    /// y = e − Gᵀλ, and the residual of (λ, y) without (G, I) β, and β = −α. Collective.
    fn residual(&self, at: &mut Iterate) -> Result<(Vec<f64>, AnchoredMultipliers, Vec<f64>)> {
        at.evaluate(&self.method.dual())?;
        let mut y = self.forces(&at.lambda)?;
        y.iter_mut()
            .zip(&at.loads.kernel.e)
            .for_each(|(y, e)| *y = e - *y);
        let Anchors {
            stiffness, centre, ..
        } = self.anchors;
        let columns = (y.iter().zip(stiffness).zip(centre))
            .map(|((y, h), a)| -a - y / h)
            .collect();
        let mut w = AnchoredMultipliers::new(at.residual.r.duplicate()?, columns);
        w.rows.copy_from(&at.residual.r)?;
        let beta = self.project_transpose(&mut w)?;
        Ok((y, w, beta))
    }

    fn run(&self, at: &mut Iterate, [reduction, least]: [f64; 2]) -> Result<Anchored> {
        let (_, mut w, _) = self.residual(at)?;
        let mut z = self.precondition(&w)?;
        let mut rz = self.dot(&w, &z)?;
        let first = rz.max(0.0).sqrt();
        let goal = (reduction * first).max(least);
        let limit = self.method.ksp.tolerances()?.3 as usize;
        let mut p = AnchoredMultipliers::new(z.rows.duplicate()?, z.columns.clone());
        p.rows.copy_from(&z.rows)?;
        let mut iterations = 0;
        while rz > goal * goal && iterations < limit {
            self.method.system.heed()?;
            let dual = self.method.dual();
            let mut image = AnchoredMultipliers::new(dual.multipliers()?, Vec::new());
            dual.f(&p.rows, &image.rows)?;
            drop(dual);
            let columns = p.columns.iter().zip(&self.anchors.stiffness);
            image.columns = columns.map(|(y, h)| y / h).collect();
            let curvature = self.dot(&p, &image)?;
            // NaN is no curvature either.
            if curvature > 0.0 {
                let step = rz / curvature;
                at.lambda.axpy(step, &p.rows)?;
                w.rows.axpy(-step, &image.rows)?;
                w.columns
                    .iter_mut()
                    .zip(&image.columns)
                    .for_each(|(w, q)| *w -= step * q);
            } else {
                break;
            }
            self.project_transpose(&mut w)?;
            z = self.precondition(&w)?;
            let next = self.dot(&w, &z)?;
            let ratio = next / rz;
            rz = next;
            p.rows.scale(ratio)?;
            p.rows.axpy(1.0, &z.rows)?;
            p.columns
                .iter_mut()
                .zip(&z.columns)
                .for_each(|(p, z)| *p = ratio * *p + z);
            iterations += 1;
        }
        let (force, _, beta) = self.residual(at)?;
        Ok(Anchored {
            place: beta.iter().map(|b| -b).collect(),
            force,
            iterations,
            residuals: [first, rz.max(0.0).sqrt()],
            reached: rz <= goal * goal,
        })
    }
}

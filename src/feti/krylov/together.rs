//! Several loads at once: a CG for each, whose products with F and M⁻¹ are formed together.
//!
//! A product reads the factors of every subdomain and waits for memory. With several vectors side by side one reading
//! serves them all. The iterations themselves know nothing of each other: each load takes as many as it would alone.
//! What comes before an iteration and after it, the projection of the load, the displacements and their certificate, is
//! [`LinearMethod::solve_for_host`]'s, one load after the other.

use super::iterate::{KrylovRun, Watch, NEARLY, NOISE};
use super::loads::Loads;
use super::residual::{Iterate, ROUNDING};
use super::tally::ClockReadings;
use super::target::Target;
use crate::feti::method::LinearMethod;
use crate::status::Status;
use crate::Result;
use parallel::exchange::sum_all;
use petsc::{ConvergedReason, Stopped, Vec as PetscVec};

/// A load whose iteration has been run.
pub struct Begun {
    /// λ.
    pub lambda: PetscVec,
    /// ‖Pᵀ r‖ at λ₀, to which the tolerance is relative.
    pub reference: f64,
    /// The iteration. It has reached its tolerance, or the largest number of iterations.
    pub run: KrylovRun,
}

/// CG for one of the loads.
struct Column {
    /// The number of the load.
    load: usize,
    reference: f64,
    tolerance: f64,
    /// λ at the start, and what is added to it.
    lambda: PetscVec,
    x: PetscVec,
    r: PetscVec,
    z: PetscVec,
    p: PetscVec,
    ap: PetscVec,
    /// rᵀ M⁻¹ r of the last step; 0 before the first.
    rho: f64,
    /// The largest eigenvalue, compared with the one at which an iteration is broken off.
    spectrum: LargestEigenvalue,
    residuals: Vec<f64>,
    state: State,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum State {
    Running,
    Converged,
    /// Rounding has made a direction indefinite, or an eigenvalue is large: the load is to be solved alone.
    Lost,
}

/// The last pivot of T − τ I, with T the Lanczos matrix of CG: a positive one shows an eigenvalue above τ (Sturm).
#[derive(Default)]
struct LargestEigenvalue {
    /// α and β of the last step; α is 0 before the first.
    alpha: f64,
    beta: f64,
    pivot: f64,
    /// Whether there has been a positive pivot.
    beyond: bool,
}

impl LargestEigenvalue {
    /// Adds a step of CG: `beta` led to its direction, `alpha` is its length.
    fn add(&mut self, alpha: f64, tau: f64) {
        self.pivot = match self.alpha {
            last if last > 0.0 => {
                let above = self.beta / last;
                1.0 / alpha + above - tau - above / last / self.pivot
            }
            _ => 1.0 / alpha - tau,
        };
        self.alpha = alpha;
        self.beyond |= self.pivot > 0.0;
    }
}

impl LinearMethod {
    /// Runs the iterations for several loads, one [`Begun`] for each. `None` in the place of a load that is to be
    /// solved alone, because rounding has ended its iteration, or because it has found an eigenvalue that is to be
    /// deflated; for all loads where the Krylov method is not CG, where eigenvalues are deflated already, or where rows
    /// have springs. Collective.
    ///
    /// # Errors
    /// A load that moves a body which nothing holds; PETSc's own errors.
    pub fn together(&self, loads: Vec<Loads>) -> Result<Vec<Option<Begun>>> {
        let n = loads.len();
        let plain = self.ksp.type_name()? == "cg"
            && self.system.is_undeflated()
            && !self.dual().stiffness.has_springs();
        let mut begun: Vec<Option<Begun>> = (0..n).map(|_| None).collect();
        let max_it = self.ksp.tolerances()?.3.max(0) as usize;
        if !plain || n < 2 || max_it == 0 {
            return Ok(begun);
        }
        let mut columns = Vec::new();
        for (load, loads) in loads.into_iter().enumerate() {
            columns.push(self.column(load, loads)?);
        }
        let counted = ClockReadings::now();
        let watch = self.watch();
        let mut iterations = 0;
        while iterations < max_it && columns.iter().any(|c| c.state == State::Running) {
            self.advance(&mut columns, watch)?;
            iterations += 1;
            let running = columns.iter().filter_map(|c| c.residuals.last().copied());
            self.ksp.monitor(iterations, running.fold(0.0, f64::max))?;
        }
        self.system.count(&counted.since(iterations));
        for column in columns {
            let load = column.load;
            begun[load] = column.end()?;
        }
        Ok(begun)
    }

    /// λ₀ of a load with its residual. Collective.
    fn column(&self, load: usize, loads: Loads) -> Result<Column> {
        let dual = self.dual();
        let held = &dual.natural;
        held.check_held(&self.problem, &dual.stiffness, &loads.kernel)?;
        let mut at = Iterate::new(&dual, loads)?;
        at.begin(&dual)?;
        let reference = at.evaluate_projected(&dual)?;
        let Iterate {
            lambda, residual, ..
        } = at;
        let tolerance = Target::new(self, reference)?.at_first();
        // As in a single iteration: the first projection of a large jump leaves a part outside the range of Pᵀ.
        dual.p_transpose(&residual.r)?;
        self.system.recycled_part(&residual.r, &lambda)?;
        let norm = residual.r.norm2()?;
        let nothing = norm <= tolerance.max(ROUNDING * residual.size);
        let tolerance = tolerance.max(NOISE * residual.size);
        let vector = || dual.multipliers();
        Ok(Column {
            load,
            reference,
            tolerance,
            x: vector()?,
            z: vector()?,
            p: vector()?,
            ap: vector()?,
            lambda,
            r: residual.r,
            rho: 0.0,
            spectrum: LargestEigenvalue::default(),
            residuals: vec![norm],
            state: match nothing {
                true => State::Converged,
                // Not a number: what a load alone says about that is better.
                false if !norm.is_finite() => State::Lost,
                false => State::Running,
            },
        })
    }

    /// One step of CG in all columns that run. Collective.
    fn advance(&self, columns: &mut [Column], watch: Option<Watch>) -> Result<()> {
        let mut running: Vec<&mut Column> = columns
            .iter_mut()
            .filter(|c| c.state == State::Running)
            .collect();
        self.system
            .precondition_many(&of(&running, |c| &c.r), &of(&running, |c| &c.z))?; /* z ← P M⁻¹ r  */
        let rho = self.dots(&running, |c| (&c.r, &c.z))?;
        for (column, rho) in running.iter_mut().zip(rho) {
            let beta = if column.rho > 0.0 {
                rho / column.rho
            } else {
                0.0
            };
            column.p.aypx(beta, &column.z)?; /*                                            p ← z + β p   */
            column.spectrum.beta = beta;
            column.rho = rho;
        }
        self.system
            .apply_many(&of(&running, |c| &c.p), &of(&running, |c| &c.ap))?; /*            Pᵀ F p        */
        let curvature = self.dots(&running, |c| (&c.p, &c.ap))?;
        for (column, curvature) in running.iter_mut().zip(curvature) {
            if !(column.rho > 0.0 && curvature > 0.0) {
                column.state = State::Lost;
                continue;
            }
            let alpha = column.rho / curvature;
            if let Some(watch) = watch {
                column.spectrum.add(alpha, watch.limit);
            }
            column.x.axpy(alpha, &column.p)?; /*                                           x ← x + α p   */
            column.r.axpy(-alpha, &column.ap)?; /*                                         r ← r − α A p */
        }
        let squares = self.dots(&running, |c| (&c.r, &c.r))?;
        for (column, square) in running.into_iter().zip(squares) {
            let norm = square.sqrt();
            column.residuals.push(norm);
            let late = |watch: Watch| {
                let steps = column.residuals.len() - 1;
                steps >= watch.from && norm > NEARLY * column.tolerance
            };
            if column.state == State::Running && norm <= column.tolerance {
                column.state = State::Converged;
            } else if column.spectrum.beyond && watch.is_some_and(late) {
                column.state = State::Lost;
            }
        }
        Ok(())
    }

    /// A product of two vectors of each column, by one reduction. Collective.
    fn dots<'a>(
        &self,
        columns: &'a [&mut Column],
        pair: impl Fn(&'a Column) -> (&'a PetscVec, &'a PetscVec),
    ) -> Result<Vec<f64>> {
        let each = columns.iter().map(|column| {
            let (x, y) = pair(column);
            Ok(base::linalg::dense::dot(&x.array()?, &y.array()?))
        });
        let mut sums = each.collect::<Result<Vec<f64>>>()?;
        sum_all(self.session.comm(), &mut sums);
        Ok(sums)
    }
}

/// A vector of each column.
fn of(columns: &[&mut Column], vector: impl Fn(&Column) -> &PetscVec) -> Vec<PetscVec> {
    columns.iter().map(|c| vector(c).clone()).collect()
}

impl Column {
    /// The λ that has been reached; `None` if rounding has ended the iteration.
    fn end(self) -> Result<Option<Begun>> {
        if self.state == State::Lost {
            return Ok(None);
        }
        self.lambda.axpy(1.0, &self.x)?;
        let iterations = self.residuals.len() - 1;
        let status = match (self.state, iterations) {
            (State::Converged, 0) => Status::NothingToDo,
            (State::Converged, _) => Status::Krylov(ConvergedReason::rtol()),
            _ => Status::Krylov(ConvergedReason::its()),
        };
        Ok(Some(Begun {
            lambda: self.lambda,
            reference: self.reference,
            run: KrylovRun {
                iterations,
                status,
                residuals: self.residuals,
                estimate: None,
                stopped: Stopped::No,
            },
        }))
    }
}

#[cfg(test)]
#[path = "../../../tests/inside/feti/krylov/together.rs"]
mod tests;

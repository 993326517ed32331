//! Solves that know the discretisation error: `-fetifeti_certify` and `-fetifeti_rtol auto`.

use std::time::Instant;

use super::fields::discretisation::{total, BodyError, Estimator};
use base::Result;
use fetifeti::solution::{Observer, State};
use fetifeti::{FetiFeti, Solution};
use petsc::Session;
use report::json::certified::{self, Certified, Discretisation};
use scene::Scene;

/// The estimator of the discretisation error, if somebody asked for it.
pub(super) struct Early {
    estimator: Option<Estimator>,
    /// Seconds of making it, and of its last estimate.
    seconds: [f64; 2],
    looks: usize,
    /// The last estimate of `-fetifeti_rtol auto`, which is that of its solution.
    last: Option<Vec<BodyError>>,
}

impl Early {
    /// Builds the meshes that the estimates need. Collective.
    pub fn new(session: &Session, scene: &Scene, solver: &FetiFeti) -> Result<Early> {
        let clock = Instant::now();
        let settings = &solver.settings().method;
        let estimator = if settings.certify || settings.stops_early {
            Some(Estimator::new(session, scene, solver)?)
        } else {
            None
        };
        Ok(Early {
            estimator,
            seconds: [clock.elapsed().as_secs_f64(), 0.0],
            looks: 0,
            last: None,
        })
    }

    /// Solves load step `step`: to the tolerance, or to the discretisation error. Collective.
    pub fn solve(
        &mut self,
        solver: &mut FetiFeti,
        scene: &Scene,
        step: usize,
        start: Option<&State>,
        observe: &mut Observer,
    ) -> Result<Solution> {
        if !solver.settings().method.stops_early {
            return solver.solve_from(start, observe);
        }
        let session = solver.session().clone();
        solver.solve_early(start, observe, &mut |u| {
            self.looks += 1;
            let bodies = self.estimate(&session, scene, u, step);
            let error = total(&bodies);
            self.last = Some(bodies);
            Ok(error)
        })
    }

    fn estimate(
        &mut self,
        session: &Session,
        scene: &Scene,
        u: &[Vec<f64>],
        step: usize,
    ) -> Vec<BodyError> {
        let Some(estimator) = &mut self.estimator else {
            return Vec::new();
        };
        let clock = Instant::now();
        let bodies = estimator.by_body(session, scene, u, step);
        self.seconds[1] = clock.elapsed().as_secs_f64();
        bodies
    }

    /// The record of a solution's errors; `None` if nobody asked for them. Collective.
    pub fn record(
        &mut self,
        session: &Session,
        scene: &Scene,
        solution: &Solution,
        step: usize,
    ) -> Option<Certified> {
        let mut record = Certified::new(solution.certified.as_ref()?);
        let bodies = match self.last.take() {
            Some(last) => last,
            None => self.estimate(session, scene, &solution.u, step),
        };
        let of = |(b, body): (usize, &BodyError)| certified::BodyError {
            name: scene.bodies[b].spec.name.clone(),
            error: body.error,
            relative: (body.size > 0.0).then(|| body.error / body.size),
        };
        record.discretisation = Some(Discretisation {
            total: total(&bodies),
            bodies: bodies.iter().enumerate().map(of).collect(),
            seconds: self.seconds.iter().sum(),
            looks: self.looks,
        });
        Some(record)
    }
}

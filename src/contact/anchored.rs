//! A Newton step with anchors.

use super::anchors::Anchors;
use super::judge;
use super::line_search::LineSearchPoint;
use super::semismooth_newton::SemismoothNewton;
use crate::feti::krylov::iterate::KrylovRun;
use crate::status::Status;
use crate::Result;
use petsc::{ConvergedReason, Stopped};

/// The end of a Newton step, how far to go to it, and how exact it is, relative to the reference.
pub(super) struct Arrival {
    pub run: KrylovRun,
    pub end: LineSearchPoint,
    pub length: Option<f64>,
    pub residual: f64,
    pub tolerance: f64,
}

/// The begin of a search, and the least displacements of its steps.
pub(super) struct Begin {
    stiffness: f64,
    active: Vec<bool>,
    length: f64,
}

impl Begin {
    /// With springs of this stiffness and this set.
    pub fn new(stiffness: f64, active: &[bool]) -> Begin {
        Begin {
            stiffness,
            active: active.to_vec(),
            length: f64::INFINITY,
        }
    }
}

impl SemismoothNewton<'_> {
    /// Once a step has sent bodies away that bend: begins anew with anchors. Returns the set. Collective.
    pub(super) fn anchor(&mut self) -> Option<Vec<bool>> {
        let begin = self.begin.as_mut()?;
        begin.length = begin.length.min(self.length);
        if self.length <= self.tuning.far * begin.length {
            return None;
        }
        let begin = self.begin.take()?;
        self.anchors = Anchors::new(&self.method.dual(), &self.nodes, begin.stiffness);
        self.point = None;
        self.multiplier.fill(0.0);
        self.stiffness = begin.stiffness / self.tuning.stiffer;
        self.stiffen();
        Some(begin.active)
    }

    /// The end of a step, as exact as it has to be to lead downwards. Residuals are relative to that at the beginning.
    /// Collective.
    pub(super) fn anchored(&mut self, anchors: Anchors, begins: bool) -> Result<Arrival> {
        let (method, tuning) = (self.method, self.tuning);
        let give = self.nodes.iter().zip(&self.compliance);
        let give: Vec<f64> = give.map(|(node, spring)| node + spring).collect();
        let mut goal = [
            tuning.reduction * (tuning.stiffness / self.stiffness).min(1.0),
            0.0,
        ];
        let (mut iterations, mut first) = (0, None);
        let found = loop {
            goal[1] = goal[1].max(tuning.anchored_rounding * self.largest);
            let found = anchors.solve(method, &mut self.at, &give, goal);
            self.anchors = Some(anchors.clone());
            let found = found?;
            iterations += found.iterations;
            let [before, after] = found.residuals;
            let first = *first.get_or_insert(before);
            self.largest = self.largest.max(before);
            let rounding = tuning.anchored_rounding * self.largest;
            let dual = method.dual();
            let residual = &mut self.at.residual;
            residual.shift(&dual, &found.place);
            let gap = judge::all_gaps(&dual, residual, &self.at.lambda)?;
            self.length = residual.length(&dual);
            let end = LineSearchPoint {
                gap,
                force: self.at.lambda.to_vec()?,
                motion: [found.place, found.force],
            };
            let length = self.length_to(&end, false);
            if length.is_some() || begins || after <= rounding || !found.reached {
                let relative = |r: f64| if first > 0.0 { r / first } else { r };
                break Arrival {
                    end,
                    length,
                    residual: relative(after),
                    tolerance: relative((goal[0] * before).max(goal[1])),
                    run: KrylovRun {
                        iterations,
                        status: Status::Krylov(if found.reached {
                            ConvergedReason::rtol()
                        } else {
                            ConvergedReason::its()
                        }),
                        residuals: vec![first, after],
                        estimate: None,
                        stopped: Stopped::No,
                    },
                };
            }
            goal = [0.0, tuning.reduced_again * after];
        };
        Ok(found)
    }
}

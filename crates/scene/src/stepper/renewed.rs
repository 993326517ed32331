//! Contacts that are renewed at each load step: the scene with the present ones, the rows that the solver gets, and
//! where its loop starts.

use std::collections::HashMap;
use std::rc::Rc;
use std::time::Instant;

use super::slid::{self, Forces};
use crate::checked::Scene;
use crate::displaced::Displaced;
use base::{Error, Result};
use fetifeti::inside::factorisations;
use fetifeti::problem::{BodyNode, RowLabel, RowSource};
use fetifeti::solution::{SolvedRow, State};
use fetifeti::{FetiFeti, Solution};
use parallel::exchange::{any, total};
use petsc::Session;

/// A scene whose contacts are renewed, or stay as they are.
pub(super) struct Renewed {
    /// The scene with the contacts of the present load step.
    scene: Rc<Scene>,
    /// The displacements at the end of the last step, and those for which the present contacts were made.
    end: Displaced,
    start: Displaced,
    /// The last step; `None` before its end.
    last: Option<Ended>,
}

/// The end of a load step.
struct Ended {
    rows: Vec<SolvedRow>,
    /// The rows of friction.
    tangential: Vec<SolvedRow>,
    /// The multipliers inside bodies.
    inside: Vec<f64>,
    /// The displacements of each local subdomain, by local dof.
    u: Vec<Vec<f64>>,
}

/// The cost of renewed contacts.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct RenewalCost {
    /// Seconds of the search for contacts and of the set-up of the solver.
    pub seconds: f64,
    /// Number of subdomains that were factored, over all ranks.
    pub factored: usize,
}

impl Renewed {
    pub fn new(scene: Rc<Scene>) -> Renewed {
        Renewed {
            scene,
            end: Displaced::default(),
            start: Displaced::default(),
            last: None,
        }
    }

    /// The scene with the present contacts.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Notes the end of a step with these displacements; returned are those since the present contacts were made.
    pub fn end(&mut self, u: Displaced, solution: &Solution) -> Displaced {
        let out = u.since(&self.start);
        self.end = u;
        self.last = Some(Ended {
            rows: solution.rows().to_vec(),
            tangential: solution.tangential_rows().to_vec(),
            inside: solution.inside_bodies().to_vec(),
            u: solution.u.clone(),
        });
        out
    }

    /// The displacements for which the present contacts were made.
    pub fn start(&self) -> &Displaced {
        &self.start
    }

    /// Renews the contacts for load step `step`, which a checkpoint is in, where the step before has left the bodies.
    /// Collective.
    ///
    /// # Errors
    /// As [`Renewed::renew`].
    pub fn resume(
        &mut self,
        owns: &dyn Fn(usize) -> bool,
        solver: &mut FetiFeti,
        step: usize,
        left: Displaced,
    ) -> Result<()> {
        if !self.scene.is_renewed() {
            return Ok(());
        }
        self.end = left;
        let renewed = self.renew_at_end(solver.session(), step);
        let set_up = renewed.and_then(|()| {
            let scene = self.scene();
            solver.set_rows(scene.solver_rows(owns), scene.friction_nodes(owns))
        });
        set_up.map_err(|e| self.at_step(step, e))
    }

    /// Renews the contacts at the displacements of the end of the last step. Collective.
    fn renew_at_end(&mut self, session: &Session, step: usize) -> Result<()> {
        if self.scene.is_renewed() {
            // Whoever shares the scene keeps it with the contacts that it began with.
            let scene = Rc::make_mut(&mut self.scene);
            session.agree(scene.renew(&self.end, step))?;
            self.start.clone_from(&self.end);
        }
        Ok(())
    }

    /// Renews the contacts for load step `step` after the end of the last one. Returned are the start of the contact
    /// loop and the cost; `None` where contacts stay as they are, and where no step has ended. Collective.
    ///
    /// # Errors
    /// Given values that contradict an inequality, a body that nothing holds any more.
    pub fn renew(
        &mut self,
        owns: &dyn Fn(usize) -> bool,
        solver: &mut FetiFeti,
        step: usize,
    ) -> Result<Option<(Option<State>, RenewalCost)>> {
        let Some(last) = self.last.take() else {
            return Ok(None);
        };
        let renewed = self.renew_after(&last, owns, solver, step);
        renewed.map(Some).map_err(|e| self.at_step(step, e))
    }

    fn renew_after(
        &mut self,
        last: &Ended,
        owns: &dyn Fn(usize) -> bool,
        solver: &mut FetiFeti,
        step: usize,
    ) -> Result<(Option<State>, RenewalCost)> {
        let session = solver.session().clone();
        let (clock, before) = (Instant::now(), factorisations());
        let scene = self.scene();
        let solved = SolvedRow::on_all_ranks(session.comm(), &last.rows);
        let mut known: HashMap<RowKey, (f64, bool)> = HashMap::new();
        for row in &solved {
            let value = (row.multiplier, row.holds());
            for place in places(scene, &row.label, row.is_inequality()) {
                known.insert(place, value);
            }
        }
        let mut forces = Forces::new();
        for row in SolvedRow::on_all_ranks(session.comm(), &last.tangential) {
            let first = places(scene, &row.label, true).next();
            let force = forces.entry(first.expect("a place")).or_default();
            let normal = row.normal();
            (0..3).for_each(|k| force[k] += row.multiplier * normal[k]);
        }
        self.renew_at_end(&session, step)?;
        let scene = self.scene();
        let rows = scene.solver_rows(owns);
        let start = rows.iter().map(|row| {
            let inequality = row.law.is_inequality();
            let place = places(scene, &row.label, inequality).next();
            known.get(&place?).copied()
        });
        let start: Vec<Option<(f64, bool)>> = start.collect();
        solver.set_rows(rows, scene.friction_nodes(owns))?;
        let found = start.iter().filter(|s| s.is_some()).count();
        // Rows that are new hold to begin with, as all do where nothing is known.
        let new = |s: Option<(f64, bool)>| s.unwrap_or((0.0, true));
        let start: Vec<(f64, bool)> = start.into_iter().map(new).collect();
        let some = total(session.comm(), found as f64) > 0.0;
        let slid = slid::renewed(scene, owns, (solver, &last.u), (step - 1, &forces))?;
        // With friction the loop starts from where the sides stand.
        let some = some || any(session.comm(), !slid.is_empty());
        let state = some.then(|| {
            let mut state = solver.start(&last.inside, &start);
            state.slid = slid;
            state
        });
        let factored = (factorisations() - before) as f64;
        let cost = RenewalCost {
            factored: total(session.comm(), factored) as usize,
            seconds: clock.elapsed().as_secs_f64(),
        };
        Ok((state, cost))
    }

    /// An error of load step `step`, from 0: with renewed contacts it says which step that is.
    pub fn at_step(&self, step: usize, error: Error) -> Error {
        if !self.scene.is_renewed() || step == 0 || !error.is_input() {
            return error;
        }
        Error::input(format!(
            "load step {}, with contacts between sides that face each other where the step before has left the bodies",
            step + 1
        ))
        .because(error)
    }
}

/// Where a row is: what it joins its node to, the node, and the direction of an equation.
pub(super) type RowKey = (RowSource, BodyNode, usize);

/// The places of a row: first that of the node that carries its multiplier. Interfaces are named by the other body.
pub(super) fn places(
    scene: &Scene,
    label: &RowLabel,
    inequality: bool,
) -> impl Iterator<Item = RowKey> {
    let n = label.normal.map(f64::abs);
    let direction = if inequality {
        3
    } else {
        (0..3).max_by(|&a, &b| n[a].total_cmp(&n[b])).unwrap_or(0)
    };
    let [first, second] = match label.source {
        RowSource::Interface(k) => {
            let interface = &scene.interfaces[k];
            let own = interface.mortar.as_ref().map(|m| m.multipliers);
            let [a, b] = match own {
                Some(own) if own != interface.order[0] => [label.members[1], label.members[0]],
                _ => label.members,
            };
            let place = |at: Option<BodyNode>, other: Option<BodyNode>| {
                Some((RowSource::Interface(other?.body), at?, direction))
            };
            // The other body may carry the multipliers next.
            let other = match own {
                None => place(b, a),
                Some(_) => None,
            };
            [place(a, b), other]
        }
        RowSource::Obstacle(_) => [label.members[0].map(|m| (label.source, m, direction)), None],
        RowSource::Equation(_) => [Some((label.source, BodyNode { body: 0, node: 0 }, 0)), None],
    };
    first.into_iter().chain(second)
}

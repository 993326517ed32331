//! Friction and soft contact of the assembled problem: the loop of the method's own friction (docs/theory.md, section
//! 9), around another solver of equations.
//!
//! Nodes follow the one law of [`Node`]. In a step their states stay: rows that stick are equations, a node that slips
//! has a given force, and in space a spring across its slip. The forces are renewed until they are at rest, with the
//! matrix of the step for as long as springs hardly change: the direction of a slip then turns by given forces alone.

mod pose;

use std::cell::RefCell;

use crate::assembled::course::{ActiveSetEnd, AssembledCourse, OuterEnd, OuterStep, SetState};
use crate::assembled::equations::{Equations, Manner, Solved};
use crate::assembled::groups::MultiplierSigns;
use crate::assembled::reduced::Reduced;
use crate::assembled::rows::Inequalities;
use base::Result;
use fetifeti::inside::driver::{Proposal, Strategy};
use fetifeti::inside::node::{Node, Step};
use fetifeti::inside::nodes::{Changes, Nodes};
use fetifeti::settings::FrictionTuning;
use mpi::topology::SimpleCommunicator;

/// Steps after which the loop ends without a solution.
const STEPS: usize = 200;

/// Forces of a refined solution are at rest if none moves by more than this, relative to the largest force of a row.
const AT_REST: f64 = 1e-11;

/// Springs that are stiffer or softer by more than this are others.
const STIFFER: f64 = 1.3;

/// A row that only keeps a body from coming loose may pull by this part of the largest multiplier.
const IDLE: f64 = 1e-8;

/// The strategy. Every rank has all nodes.
pub(super) struct StickAndSlip<'a, 'm> {
    equations: &'a RefCell<Equations<'m>>,
    rows: &'m Inequalities,
    tuning: FrictionTuning,
    alone: SimpleCommunicator,
    nodes: Nodes,
    /// Whether other rows hold each node along a tangent.
    held: Vec<bool>,
    /// The compliance of each row's nodes.
    give: Vec<f64>,
    state: SetState,
    /// Whether the next solve is one to the tolerance of the user.
    tight: bool,
    /// Whether a body slides away: nothing but friction beyond its bound has held it for many steps.
    slides: bool,
    steps: usize,
    last: Option<Solved>,
}

/// The states that follow from a solve.
struct Verdict {
    /// The changes of nodes.
    changes: Changes,
    /// Whether friction beyond its bound had to hold a body.
    restored: bool,
    /// Whether a normal row that holds a body pulls.
    pulls: bool,
    /// The normal rows that are to hold, and whether they are those that do.
    next: Vec<bool>,
    stays: bool,
}

impl<'a, 'm> StickAndSlip<'a, 'm> {
    /// The loop from the set of `state`, where all nodes stick unless it has multipliers. Collective.
    pub fn new(
        (rows, reduced): (&'m Inequalities, &Reduced),
        equations: &'a RefCell<Equations<'m>>,
        state: SetState,
    ) -> StickAndSlip<'a, 'm> {
        let tuning = FrictionTuning::DEFAULT;
        let give = rows.give(&reduced.diagonal());
        let (lambda, sticks) = match state.lambda.is_empty() {
            true => (vec![0.0; rows.len()], vec![true; rows.len()]),
            false => (rows.of_scene(&state.lambda), state.active.clone()),
        };
        let beside = rows.beside();
        let node = |given| {
            let at = (&lambda[..], &sticks[..]);
            Node::new(given, |r| r, beside[given.normal], at, &give, &tuning)
        };
        let list: Vec<Node> = rows.friction.iter().map(node).collect();
        let groups = list.iter().map(|node| rows.groups_of(node.normal));
        StickAndSlip {
            nodes: Nodes::new(list.clone(), groups.collect(), tuning),
            equations,
            rows,
            tuning,
            alone: SimpleCommunicator::self_comm(),
            held: Vec::new(),
            give,
            state,
            tight: false,
            slides: false,
            steps: 0,
            last: None,
        }
    }

    /// Multipliers and gaps of a solve as nodes see them: in units of the scene, along and across slips.
    fn seen(&self, solved: &Solved) -> [Vec<f64>; 2] {
        let (rows, judged) = (self.rows, &solved.judged);
        let mut lambda = rows.of_scene(&judged.lambda);
        let each = judged.gaps.iter().enumerate();
        let mut gaps: Vec<f64> = each.map(|(r, gap)| gap * rows.scale_of(r)).collect();
        for node in &self.nodes.list {
            if let [a, b] = node.tangential[..] {
                [lambda[a], lambda[b]] = node.on_rows([lambda[a], lambda[b]]);
                [gaps[a], gaps[b]] = node.on_rows([gaps[a], gaps[b]]);
                // Nodes add what their springs give way.
                gaps[b] -= node.across() * lambda[b];
            }
        }
        [lambda, gaps]
    }

    /// Takes the nodes to the states that follow from a solve.
    fn update(&mut self, solved: &Solved) -> Verdict {
        let [lambda, gaps] = self.seen(solved);
        let tangential = self.rows.tangential();
        let mut next = solved.judged.next.clone();
        let remains = |next: &[bool]| {
            let pairs = next.iter().zip(&solved.active).zip(&tangential);
            pairs.into_iter().all(|((next, now), t)| *t || next == now)
        };
        let stays = remains(&next);
        let mut holds = next.clone();
        for spring in &self.state.exerted.springs {
            let across = spring.rows.last().expect("a spring joins rows").0;
            holds[across] = true;
        }
        let rtol = self.equations.borrow().rtol().max(solved.residual);
        let step = Step {
            lambda: &lambda,
            gaps: &gaps,
            active: &holds,
            nothing: self.tuning.even * rtol * solved.judged.largest[1],
        };
        let changes = self
            .nodes
            .update(&self.alone, &step, (&solved.active, &mut next, stays));
        let [restored, pulls] = self.hold(&mut next, solved);
        Verdict {
            changes,
            restored,
            pulls,
            stays: remains(&next),
            next,
        }
    }

    /// Lets nodes stick, and normal rows hold, where nothing else holds a body. Returns whether nodes had to, and
    /// whether such a normal row pulls.
    fn hold(&mut self, next: &mut [bool], solved: &Solved) -> [bool; 2] {
        let judged = &solved.judged;
        let (mut before, mut score) = (next.to_vec(), judged.score.clone());
        Nodes::sticking(&self.nodes.list, &mut before);
        self.nodes.score(judged.largest[1], &mut score);
        let mut held = before.clone();
        let across = self.nodes.list.iter().filter_map(|node| self.across(node));
        let added = self.rows.restore(&mut held, &score, across);
        let restored = self.nodes.stick(&self.alone, &before, &held);
        self.slides = self.nodes.slides(!added.is_empty());
        let tangential = self.rows.tangential();
        let mut pulls = false;
        for r in added.into_iter().filter(|&r| !tangential[r]) {
            next[r] = true;
            pulls |= !judged.idle(r, IDLE);
        }
        [restored, pulls]
    }

    /// The manner of the next solve, the first one of a step or a later one.
    fn manner(&self, renewal: usize) -> Manner {
        Manner {
            exact: self.tight,
            finer: match renewal {
                0 => self.tuning.finer,
                _ => self.tuning.renewed,
            },
            // States ask for more digits than the user.
            digits: if self.tight { 1.0 } else { self.tuning.digits },
            ..Manner::to_the_end(MultiplierSigns::Any)
        }
    }
}

impl Strategy<AssembledCourse> for StickAndSlip<'_, '_> {
    fn state(&self) -> &SetState {
        &self.state
    }

    fn step(&mut self) -> Result<(OuterStep, Proposal<OuterEnd>)> {
        self.pose();
        self.steps += 1;
        let mut step = OuterStep {
            systems: 1,
            iterations: 0,
        };
        for renewal in 0.. {
            let manner = self.manner(renewal);
            let solved = self
                .equations
                .borrow_mut()
                .solved(&mut self.state, manner)?;
            step.iterations += solved.step.iterations;
            let (reason, failed) = solved.reason.clone();
            if failed {
                self.last = Some(solved);
                return Ok((step, Proposal::End((false, reason))));
            }
            let is_last = renewal == self.tuning.renewals;
            let [lambda, _] = self.seen(&solved);
            if !is_last && self.nodes.misled(&self.alone, &lambda) {
                self.nodes.renew(&self.alone, &lambda);
                self.tight = false;
                self.state.exerted.given = self.given();
                self.equations.borrow_mut().again(solved);
                continue;
            }
            let verdict = self.update(&solved);
            let stays = verdict.stays;
            let settled = verdict.changes.flips == 0 && !verdict.restored;
            let equations = self.equations.borrow();
            let at_rest = match equations.is_refined() {
                true => AT_REST,
                false => self.tuning.still * equations.rtol(),
            };
            drop(equations);
            let still = settled && verdict.changes.moves <= at_rest;
            let trouble = match () {
                () if self.slides => Some("DIVERGED_CONTACT_SLIDES"),
                () if still && stays && verdict.pulls => Some("DIVERGED_CONTACT_LOOSE"),
                () if self.steps >= STEPS => Some("DIVERGED_CONTACT_ITS"),
                () => None,
            };
            let end = match trouble {
                Some(trouble) => Some((false, trouble.to_string())),
                None if still && stays && solved.to_the_end => Some((solved.met, reason)),
                None => None,
            };
            if let Some(end) = end {
                self.last = Some(solved);
                return Ok((step, Proposal::End(end)));
            }
            self.tight = stays && still;
            if !(settled && stays) || is_last {
                self.nodes
                    .wander(solved.judged.count() + verdict.changes.flips);
                self.state = solved.following();
                self.state.active = verdict.next;
                return Ok((step, Proposal::GoOn));
            }
            self.renew(solved);
        }
        unreachable!("the last renewal ends a step")
    }

    fn finish(
        self: Box<Self>,
        steps: &[OuterStep],
        seconds: f64,
        end: OuterEnd,
    ) -> Result<ActiveSetEnd> {
        let last = self.last.expect("the loop ends at a solution");
        let mut end = self.equations.borrow().ended(last, (steps, seconds), end)?;
        Nodes::sticking(&self.nodes.list, &mut end.held);
        Ok(end)
    }
}

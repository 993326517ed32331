//! The augmented Lagrangian with discs: the safeguard of contact with friction (docs/theory.md, section 9).
//!
//! ```text
//!     φ(u) = ½ uᵀK u − fᵀu + Σ ½ C (s_n)₊² + Σ ½ C (|s_t|² − |s_t − Π_g s_t|²),      s = μ + (B u − c)/C
//!     μ ← Π(s),    g ← μ_f λ_n        after each minimisation
//! ```
//!
//! For given g this is the proximal method of multipliers of a convex problem: it converges whatever g and the springs
//! C are. g follows between minimisations, a contraction where friction is small. Once the states of two minimisations
//! are equal, the loop on states ([`StatesTrial`]) is tried from there: it has the digits in one or two steps.

use super::judged::nodes_at;
use super::node::Node;
use super::recovered::{at_state, recovered};
use super::trial::StatesTrial;
use crate::contact::course::DualCourse;
use crate::contact::disc::Disc;
use crate::contact::existence::Existence;
use crate::contact::line_search::LineSearchPoint;
use crate::contact::modes::{CompliantRows, TurnedRows};
use crate::contact::repairs::Repairs;
use crate::contact::settings::ContactSettings;
use crate::contact::state::{State, Step};
use crate::contact::strategy::{Proposal, Strategy};
use crate::feti::krylov::iterate::KrylovRun;
use crate::feti::krylov::loads::Loads;
use crate::feti::krylov::residual::Iterate;
use crate::feti::{LinearMethod, LinearSolution};
use crate::status::Status;
use crate::substructures::Law;
use crate::Result;
use base::ErrorKind;
use parallel::exchange::{any, max_all, total};

/// The strategy.
pub struct FrictionLagrangian<'a> {
    pub(super) method: &'a LinearMethod,
    pub(super) settings: &'a ContactSettings,
    pub(super) repairs: Repairs<'a>,
    pub(super) springs: CompliantRows<'a>,
    pub(super) turned: TurnedRows<'a>,
    pub(super) at: Iterate,
    /// The loads of the problem.
    pub(super) loads: Loads,
    pub(super) law: Vec<Law>,
    pub(super) nodes: Vec<Node>,
    /// Their discs.
    pub(super) discs: Vec<Disc>,
    /// The compliance of the nodes on the owned rows, and that of the rows themselves.
    give: Vec<f64>,
    own: Vec<f64>,
    /// The springs are as many times stiffer than the nodes.
    pub(super) stiffness: f64,
    /// C, with the compliance of the rows themselves.
    pub(super) compliance: Vec<f64>,
    /// μ, and μ less what the rows themselves give way: s is that and (B u − c)/C.
    multiplier: Vec<f64>,
    pub(super) shifted: Vec<f64>,
    /// Where the loop is; `None` before the first step.
    pub(super) point: Option<LineSearchPoint>,
    pub(super) state: State,
    /// The largest displacement in the last step.
    pub(super) length: f64,
    pub(super) n_rows: usize,
    /// No tolerance is below this: rounding of the problem's scale.
    pub(super) least: f64,
    pub(super) last: Option<KrylovRun>,
    /// The states of the rows at the last minimum, and the number of minima with these states.
    kinds: Vec<u8>,
    same: usize,
    /// Newton steps of this minimisation.
    inner: usize,
    /// Newton steps in a row for which rows had to be put back.
    pub(super) slides: usize,
    /// The loop on states that is tried from a minimum.
    trial: Option<StatesTrial<'a>>,
}

impl<'a> FrictionLagrangian<'a> {
    /// The search from where the loop on states has wandered, or from nothing: all nodes stick, as springs.
    /// Collective.
    pub fn new(
        method: &'a LinearMethod,
        settings: &'a ContactSettings,
        mut state: State,
    ) -> Result<FrictionLagrangian<'a>> {
        let dual = method.dual();
        let jump = &dual.stiffness.jump;
        let mut give = dual.stiffness.compliance_of_rows(&method.problem)?;
        let loads = Loads::new(&method.problem, &dual);
        let mut at = Iterate::new(&dual, loads.clone())?;
        if state.reference == 0.0 {
            let existence = Existence::new(method, &dual, settings);
            existence.if_few(&at.loads.kernel)?;
            state.reference = existence.reference(&mut at)?;
        }
        let law = jump.law.clone();
        let n = law.len();
        let handed = state.clone();
        let (cold, n_rows) = (State::cold(jump), jump.n_global);
        let mut own = jump.compliance.clone();
        own.resize(n, 0.0);
        drop(dual);
        let tuning = &settings.tuning.friction;
        let nodes = nodes_at(method, tuning, &cold.lambda, &cold.active)?;
        let disc = |node: &Node| Disc {
            rows: node.tangential.clone(),
            radius: f64::INFINITY,
        };
        let discs: Vec<Disc> = nodes.iter().map(disc).collect();
        // A disc is round: both rows give way alike.
        for disc in &discs {
            let most = disc.rows.iter().map(|&i| give[i]).fold(0.0, f64::max);
            disc.rows.iter().for_each(|&i| give[i] = most);
        }
        let mut search = FrictionLagrangian {
            repairs: Repairs::new(method, settings),
            springs: CompliantRows::of(method),
            turned: TurnedRows::of(method),
            at,
            loads,
            law,
            nodes,
            discs,
            give,
            own,
            stiffness: tuning.springs,
            compliance: Vec::new(),
            multiplier: vec![0.0; n],
            shifted: Vec::new(),
            point: None,
            state: State {
                lambda: cold.lambda,
                active: cold.active,
                safeguarded: true,
                ..state
            },
            length: 0.0,
            n_rows,
            least: method.least_residual(),
            last: None,
            kinds: vec![0; n],
            same: 0,
            inner: 0,
            slides: 0,
            trial: None,
            method,
            settings,
        };
        search.set_springs();
        let found = handed.lambda.iter().any(|l| *l != 0.0);
        if any(method.session.comm(), handed.safeguarded && found) {
            match search.start_from(&handed) {
                // Given forces alone may leave bodies too loose for the natural coarse problem.
                Err(e) if e.kind() == ErrorKind::NotConverged => {
                    search.at = Iterate::new(&method.dual(), search.loads.clone())?;
                }
                other => other?,
            }
        }
        Ok(search)
    }

    /// Begins where the loop on states is. Collective.
    fn start_from(&mut self, state: &State) -> Result<()> {
        self.at = at_state(self.method, self.loads.clone(), state)?;
        self.at.begin(&self.method.dual())?;
        let point = self.evaluate_point()?;
        for (node, disc) in self.nodes.iter().zip(&mut self.discs) {
            disc.radius = node.bound(&point.force);
        }
        self.multiplier = self.penalty().forces(&point.force);
        self.set_springs();
        self.point = Some(point);
        Ok(())
    }

    /// C and the shifted multipliers, from the stiffness and μ.
    fn set_springs(&mut self) {
        let springs = self.give.iter().map(|give| give / self.stiffness);
        let springs: Vec<f64> = springs.collect();
        let both = springs.iter().zip(&self.own);
        self.compliance = both.map(|(c, own)| c + own).collect();
        let parts = self
            .multiplier
            .iter()
            .zip(springs.iter().zip(&self.compliance));
        let shifted = parts.map(|(m, (c, all))| if *all > 0.0 { m * c / all } else { *m });
        self.shifted = shifted.collect();
    }

    /// The state of each row at a point with this pull.
    fn kinds(&self, pull: &[f64]) -> Vec<u8> {
        let bears = |(law, s): (&Law, &f64)| u8::from(law.is_inequality() && law.bears(*s));
        let mut out: Vec<u8> = self.law.iter().zip(pull).map(bears).collect();
        for disc in &self.discs {
            let slips = disc.direction(disc.of(pull)).is_some();
            disc.rows.iter().for_each(|&i| out[i] = u8::from(slips));
        }
        out
    }

    /// A Newton step, and at a minimum the next springs and bounds. Collective.
    fn search(&mut self) -> Result<(Step, Proposal<Status>)> {
        let (comm, tuning) = (self.method.session.comm(), &self.settings.tuning);
        let before = self.point.as_ref().map(|p| self.penalty().pull(p));
        let before = before.map(|s| self.kinds(&s));
        let newton = self.newton()?;
        let (mut step, status) = (newton.step, newton.status);
        // A step that ends early is one all the same: the line search has the word.
        let failed = !status.converged() && !status.broke_down() && !status.ran_out();
        let finite = self.point.iter().flat_map(|p| p.force.iter().chain(&p.gap));
        let failed = failed || any(comm, finite.into_iter().any(|v| !v.is_finite()));
        if failed {
            let status = match status.converged() {
                true => Status::Certificate,
                false => status,
            };
            return Ok((step, Proposal::End(status)));
        }
        let point = self.point.as_ref().expect("a step was made");
        let pull = self.penalty().pull(point);
        let kinds = self.kinds(&pull);
        let pairs = before.iter().flatten().zip(&kinds);
        step.wrong = total(comm, pairs.filter(|(a, b)| a != b).count() as f64) as usize;
        self.inner += 1;
        let whole = newton.length == 0.0 || newton.length == 1.0 && step.wrong == 0;
        let minimal = before.is_none() || whole || self.inner >= tuning.friction.newton_steps;
        if !minimal {
            return Ok((step, Proposal::GoOn));
        }
        self.inner = 0;
        let moved = self.follow_forces(&pull);
        let same = !any(comm, kinds != self.kinds);
        self.same = if same { self.same + 1 } else { 0 };
        self.kinds = kinds;
        let rtol = self.method.ksp.tolerances()?.0;
        let [gap, apart, bound] = moved;
        if gap <= rtol && apart <= rtol.sqrt() && bound <= tuning.friction.still * rtol {
            let status = match status.converged() {
                true => status,
                false => Status::Rounding,
            };
            return Ok((step, Proposal::End(status)));
        }
        // A trial in vain is repeated after twice as many minima.
        if self.same >= tuning.friction.settled && self.same.is_power_of_two() {
            self.begin_trial()?;
        }
        Ok((step, Proposal::GoOn))
    }

    /// μ ← Π(s) and g ← μ_f λ_n. Returns by how much springs give way, relative to the largest displacement; and
    /// relative to the largest force of a row, how far the forces of the displacements are from those of the springs,
    /// and by how much bounds move. Collective.
    fn follow_forces(&mut self, pull: &[f64]) -> [f64; 3] {
        let point = self.point.as_ref().expect("a step was made");
        let forces = self.penalty().forces(pull);
        let mut sizes = [0.0f64; 4];
        for (i, force) in forces.iter().enumerate() {
            let law = self.law[i];
            if !law.is_inequality() && !law.is_friction() {
                continue;
            }
            let spring = self.give[i] / self.stiffness;
            let mut gap = spring * (force - self.multiplier[i]).abs();
            if law.is_inequality() && *force == 0.0 {
                gap = point.gap[i].max(0.0);
            }
            sizes[0] = sizes[0].max(gap);
            sizes[1] = sizes[1].max((force - point.force[i]).abs());
            sizes[3] = sizes[3].max(force.abs());
        }
        for (node, disc) in self.nodes.iter().zip(&mut self.discs) {
            let g = node.bound(&forces);
            sizes[2] = sizes[2].max((g - disc.radius).abs());
            disc.radius = g;
        }
        max_all(self.method.session.comm(), &mut sizes);
        let [gap, apart, bound, force] = sizes;
        self.multiplier = forces;
        self.set_springs();
        let relative = |v: f64, size: f64| if size > 0.0 { v / size } else { v };
        [
            relative(gap, self.length),
            relative(apart, force),
            relative(bound, force),
        ]
    }

    /// Where the search is, as the loop on states has it.
    fn reached(&self) -> State {
        let mut active = self.state.active.clone();
        for (i, law) in self.law.iter().enumerate() {
            if law.is_inequality() {
                active[i] = law.bears(self.multiplier[i]);
            }
        }
        for (node, disc) in self.nodes.iter().zip(&self.discs) {
            let [a, b] = disc.of(&self.multiplier);
            let sticks = self.kinds[disc.rows[0]] == 0 && (a.hypot(b) > 0.0 || active[node.normal]);
            disc.rows.iter().for_each(|&i| active[i] = sticks);
        }
        State {
            lambda: self.multiplier.clone(),
            before: active.clone(),
            active,
            safeguarded: false,
            progress: Default::default(),
            ..self.state.clone()
        }
    }

    /// Begins a trial: rows are rigid, and have the directions that were given. Collective.
    fn begin_trial(&mut self) -> Result<()> {
        self.springs.rigid();
        let turns = self.turned.back();
        self.at.turn(&turns)?;
        self.nodes.iter_mut().for_each(Node::turned_back);
        let trial = StatesTrial::new(self.method, self.settings, &self.reached())?;
        self.trial = Some(trial);
        Ok(())
    }

    /// A step of a trial. Collective.
    fn try_states(&mut self, mut trial: StatesTrial<'a>) -> Result<(Step, Proposal<Status>)> {
        let (step, proposal) = trial.step()?;
        self.state.steps = trial.state().steps;
        self.state.before.clone_from(&trial.state().before);
        if matches!(proposal, Proposal::End(_)) || !trial.is_in_vain() {
            self.trial = Some(trial);
            return Ok((step, proposal));
        }
        drop(trial);
        let tuning = &self.settings.tuning;
        self.stiffness = (tuning.stiffer * self.stiffness).min(tuning.friction.stiffest);
        self.set_springs();
        Ok((step, Proposal::GoOn))
    }
}

impl Strategy<DualCourse> for FrictionLagrangian<'_> {
    /// Where friction cannot hold a body, φ has no minimum.
    fn asks_first(&self) -> bool {
        true
    }

    fn state(&self) -> &State {
        match &self.trial {
            Some(trial) => trial.state(),
            None => &self.state,
        }
    }

    fn step(&mut self) -> Result<(Step, Proposal<Status>)> {
        match self.trial.take() {
            Some(trial) => self.try_states(trial),
            None => self.search(),
        }
    }

    fn finish(
        mut self: Box<Self>,
        steps: &[Step],
        seconds: f64,
        status: Status,
    ) -> Result<LinearSolution> {
        if let Some(trial) = self.trial.take() {
            return trial.finish(steps, seconds, status);
        }
        let (method, state) = (self.method, self.reached());
        self.turned.back();
        self.springs.rigid();
        let last = self.last.map(|run| (run.residuals, run.estimate));
        let iterations = steps.iter().map(|s| s.iterations).sum();
        let run = KrylovRun::of_loop(iterations, status, last.unwrap_or_default());
        let tuning = &self.settings.tuning.friction;
        recovered(method, tuning, self.loads, &state, run, seconds)
    }
}

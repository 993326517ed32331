//! An outer step of SMALBE: an inner problem with its bounds, an ascent of the multipliers μ of the balance, and with
//! Coulomb's law the bounds g that follow.

use std::time::Instant;

use mpi::topology::SimpleCommunicator;

use super::active_set::ActiveSet;
use super::augmented::Augmented;
use super::existence::Existence;
use super::feasible_set::FeasibleSet;
use super::friction::{self, node::Node};
use super::mprgp::{BoundedQuadratic, Setting};
use super::settings::{ContactSettings, ContactType};
use super::state::{changes, State, Step};
use super::tuning::Tuning;
use crate::feti::krylov::loads::Loads;
use crate::feti::krylov::residual::Iterate;
use crate::feti::LinearMethod;
use crate::Result;
use parallel::exchange::{any, max_all, total};

/// The dual problem in shifted and scaled variables, and the state of the search.
pub(super) struct SmalbeIteration<'a> {
    tuning: &'a Tuning,
    /// The operator.
    pub a: Augmented<'a>,
    /// Pᵀ S (d − F λ̃).
    b: Vec<f64>,
    /// ‖b‖, or ‖Pᵀ A x‖ of the admissible x nearest to 0 where that is larger; tolerances are relative to it.
    size: f64,
    /// The bounds; its shift is λ̃.
    set: FeasibleSet,
    /// The nodes of its discs.
    nodes: Vec<Node>,
    /// By how much the last step has moved bounds g, relative to the largest force of a row.
    moved: f64,
    contact: std::ops::Range<usize>,
    x: Vec<f64>,
    /// μ, in the columns that this rank knows.
    mu: Vec<f64>,
    /// M relative to ϱ.
    m: f64,
    /// L after the last step; −∞ where the next one has nothing to compare with.
    pub lagrangian: f64,
}

impl<'a> SmalbeIteration<'a> {
    /// The search from `state`. If that has no forces yet, nodes with Coulomb's law stick at first, as far as a limit
    /// allows: without friction bodies might slide away. Collective.
    pub fn new(
        method: &'a LinearMethod,
        settings: &'a ContactSettings,
        state: &State,
    ) -> Result<SmalbeIteration<'a>> {
        let (session, problem) = (&method.session, &method.problem);
        let comm = session.comm();
        let (cold, all) = {
            let jump = &method.dual().stiffness.jump;
            let all = (0..jump.n_owned).map(|i| jump.is_candidate(i));
            (State::cold(jump), all.collect::<Vec<bool>>())
        };
        let tuning = &settings.tuning;
        let nodes = friction::nodes_at(method, &tuning.friction, &cold.lambda, &cold.active)?;
        method.set_active(&all)?;
        let mut a = Augmented::new(method, settings, &nodes)?;
        let dual = method.dual();
        let jump = &dual.stiffness.jump;
        let loads = Loads::new(problem, &dual);
        if state.reference == 0.0 {
            Existence::new(method, &dual, settings).if_few(&loads.kernel)?;
        }
        let mut c = loads.kernel.e.clone();
        a.balance.solve(&mut c);
        let mut shift = vec![0.0; jump.n_owned];
        a.balance.add(1.0, &c, &mut shift); /*            λ̃ = G N⁺ e      */
        let mut at = Iterate::new(&dual, loads)?;
        at.lambda.array_mut()?.copy_from_slice(&a.unscaled(&shift));
        at.evaluate(&dual)?;
        let mut r = at.residual.r.to_vec()?;
        // With all candidates active, rows may contradict each other and be held to other right-hand sides. The bound
        // constraints need c itself.
        for (r, (held, c)) in r.iter_mut().zip(jump.held.iter().zip(&jump.gap)) {
            *r += held - c;
        }
        let mut b = a.unscaled(&r); /*                    b = S(d − F λ̃)  */
        a.balance.project(comm, &mut b);
        let lower: Vec<f64> = (0..jump.n_owned)
            .map(|i| jump.law[i].least() - shift[i])
            .collect();
        let warm = any(comm, state.lambda.iter().any(|l| *l != 0.0));
        let disc = |node: &Node| match warm {
            true => a.disc(node, node.bound(&state.lambda)),
            false => a.disc(node, node.largest_bound()),
        };
        let set = FeasibleSet {
            discs: nodes.iter().map(disc).collect(),
            lower,
            fixed: all.iter().map(|on| !on).collect(),
            shift,
        };
        // Without bounds λ̃ may be the solution: b is rounding, and what the bounds add to it has the problem's size.
        let first = set.nearest(&set.shift);
        let mut of_bounds = vec![0.0; first.len()];
        a.apply(&first, &mut of_bounds)?;
        a.balance.project(comm, &mut of_bounds);
        let square = |v: &[f64]| total(comm, v.iter().map(|v| v * v).sum());
        let size = square(&b).max(square(&of_bounds)).sqrt();
        let x = if warm {
            set.nearest(&a.scaled(&state.lambda))
        } else {
            first
        };
        let known = a.balance.known();
        let mu = if state.mu.is_empty() {
            vec![0.0; known.n()]
        } else {
            known.part_of(&state.mu)
        };
        Ok(SmalbeIteration {
            x,
            mu,
            contact: jump.rows_between_bodies(),
            a,
            b,
            size,
            set,
            nodes,
            moved: 0.0,
            m: tuning.m_start,
            tuning,
            lagrangian: f64::NEG_INFINITY,
        })
    }

    /// Continues from the λ of an active-set step and the μ that belongs to it. With w = S (c − B u) on the rows that
    /// do not hold, the optimality of L reads G μ = (I − P) w. Collective.
    pub fn restart(&mut self, comm: &SimpleCommunicator, run: &ActiveSet) -> Result<()> {
        self.x = self.set.nearest(&self.a.scaled(&run.state.lambda));
        let w: Vec<f64> = (0..self.x.len())
            .map(|i| {
                if self.set.fixed[i] || run.held[i] {
                    0.0
                } else {
                    -run.gaps[i] * self.a.scale[i]
                }
            })
            .collect();
        self.mu = self.a.balance.forces(comm, &w);
        self.a.balance.solve(&mut self.mu);
        Ok(())
    }

    /// One inner problem and one ascent of the multipliers μ. Returns the step, and whether all residuals are within
    /// `accuracy`. Collective.
    pub fn advance(
        &mut self,
        comm: &SimpleCommunicator,
        state: &mut State,
        accuracy: f64,
    ) -> Result<(Step, bool)> {
        let clock = Instant::now();
        let (rho, size, tuning) = (self.a.rho, self.size, self.tuning);
        let mut b = self.b.clone();
        self.a.balance.add(-1.0, &self.mu, &mut b); /*    b − G μ         */
        let balance = self.a.balance.clone();
        let setting = Setting {
            comm,
            set: &self.set,
            length: 1.9 / rho,
            tuning,
        };
        let floor = accuracy * size;
        let m = self.m;
        let mut stop = |x: &[f64], gradient: f64| {
            let allowed = m * rho * balance.violation(comm, x);
            gradient <= allowed.min(tuning.eta * size) || gradient <= 0.5 * floor
        };
        let start = std::mem::take(&mut self.x);
        let run = setting.minimise(&mut self.a, &b, start, &mut stop, tuning.products)?;
        let violation = balance.violation(comm, &run.x);
        let gradient = setting.projected_gradient(&run.x, &run.g);
        // L = ½ xᵀA x − bᵀx with A x = g + b
        let terms = run.x.iter().zip(&run.g).zip(&b);
        let value = total(comm, terms.map(|((x, g), b)| 0.5 * x * (g - b)).sum());
        if value < self.lagrangian + 0.5 * rho * violation * violation {
            self.m *= tuning.m_shrink;
        }
        self.lagrangian = value;
        let mut c = balance.forces(comm, &run.x);
        balance.solve(&mut c);
        self.mu.iter_mut().zip(&c).for_each(|(m, c)| *m += rho * c);
        state.mu = balance.known().whole(comm, &self.mu);

        // Rows on their bound with a gradient that points into the feasible set.
        let [_, into] = self.set.split(&run.x, &run.g, setting.length);
        let wrong = into.iter().filter(|v| v.abs() > floor).count();
        self.x = run.x;
        state.steps += 1;
        let shifted = self.x.iter().zip(&self.set.shift);
        state.lambda = self
            .a
            .unscaled(&shifted.map(|(x, s)| x + s).collect::<Vec<f64>>());
        if any(comm, !self.nodes.is_empty()) {
            self.follow(comm, &mut state.lambda);
        }
        if self.moved > accuracy {
            self.lagrangian = f64::NEG_INFINITY;
        }
        let free = self.set.free(&self.x);
        state.before = std::mem::replace(&mut state.active, free);
        let (rows, now) = (self.contact.clone(), &state.active);
        let [active, entered, left] = changes(comm, &state.before[rows.clone()], &now[rows]);
        let residual = match size {
            size if size > 0.0 => gradient.max(rho * violation) / size,
            _ => 0.0,
        };
        let residual = residual.max(self.moved);
        let step = Step {
            method: ContactType::Smalbe,
            active,
            entered,
            left,
            iterations: run.products,
            estimate: None,
            exact: None,
            residual,
            tolerance: accuracy,
            wrong: total(comm, wrong as f64) as usize,
            seconds: clock.elapsed().as_secs_f64(),
        };
        Ok((step, residual <= accuracy))
    }

    /// g ← μ_f λ_n, and x and λ into the new discs. Collective.
    fn follow(&mut self, comm: &SimpleCommunicator, lambda: &mut [f64]) {
        let mut sizes = [0.0, lambda.iter().fold(0.0f64, |a, l| a.max(l.abs()))];
        for (node, disc) in self.nodes.iter().zip(&mut self.set.discs) {
            let now = self.a.disc(node, node.bound(lambda));
            let scale = self.a.scale[disc.rows[0]];
            sizes[0] = (scale * (now.radius - disc.radius).abs()).max(sizes[0]);
            *disc = now;
        }
        max_all(comm, &mut sizes);
        let [moved, force] = sizes;
        // At first there may have been no bounds at all.
        self.moved = if force > 0.0 { moved / force } else { moved }.min(1.0);
        self.set.enter_discs(&mut self.x);
        for &i in self.set.discs.iter().flat_map(|disc| &disc.rows) {
            lambda[i] = self.a.scale[i] * (self.x[i] + self.set.shift[i]);
        }
    }
}

//! One measurement in a process group of its own: the repeated solve of one scene, or the network.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::network::Timing;
use super::{IterationSeconds, ScalingPoint, SetupSeconds, Work};
use crate::baselines::launch;
use crate::study::scaling::network;
use base::{Error, Result};
use fetifeti::settings::MethodSettings;
use fetifeti::FetiFeti;
use parallel::clock::{self, Phase};
use parallel::contiguous_share;
use parallel::exchange::{max_all, min_all};
use parallel::meter::{memory, timed};
use petsc::Session;
use scene::Scene;

/// A measurement for a process group.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub enum ScalingTask {
    /// Messages and all-reduces.
    Network,
    /// Set-up and solve of a scene.
    Solve {
        /// The scene file.
        scene: String,
        /// Number of repetitions; the smallest seconds of every phase count.
        repeats: usize,
    },
}

/// Messages and all-reduces.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct NetworkRecord {
    /// Messages one way between two ranks.
    pub messages: Vec<Timing>,
    /// All-reduces.
    pub reductions: Vec<Timing>,
}

/// Runs the task that `file` describes. Collective.
///
/// # Errors
/// [`ErrorKind::Input`](base::ErrorKind::Input) for a file that the study has not written; those of the method;
/// [`ErrorKind::NotConverged`](base::ErrorKind::NotConverged).
pub fn run_task(session: &Session, file: &Path) -> Result<()> {
    let task: ScalingTask = launch::task(session, file, "a task that study scaling has written")?;
    match &task {
        ScalingTask::Network => {
            let (messages, reductions) = network::measure(session.comm());
            let record = NetworkRecord {
                messages,
                reductions,
            };
            launch::leave(session, file, &record)
        }
        ScalingTask::Solve { scene, repeats } => {
            let record = solve(session, scene, *repeats)?;
            launch::leave(session, file, &record)
        }
    }
}

fn solve(session: &Session, text: &str, repeats: usize) -> Result<ScalingPoint> {
    let before = memory(session) / 1e6;
    let scene = session.agree(Scene::parse("scaling.toml", text))?;
    let mine = contiguous_share(scene.n_subdomains(), session.size(), session.rank());
    let problem = session.agree(scene.substructures(&|s| mine.contains(&s)))?;
    let mut best: Option<ScalingPoint> = None;
    for _ in 0..repeats.max(1) {
        let record = once(session, problem.clone())?;
        best = Some(match best {
            None => record,
            Some(old) => old.faster(&record),
        });
    }
    let mut record = best.expect("it ran at least once");
    record.memory_mb = [memory(session) / 1e6, before];
    Ok(record)
}

impl ScalingPoint {
    /// The smaller seconds of two points, phase by phase.
    fn faster(self, other: &ScalingPoint) -> ScalingPoint {
        ScalingPoint {
            setup: SetupSeconds::from_fn(|k| self.setup.all()[k].min(other.setup.all()[k])),
            iteration: IterationSeconds::from_fn(|k| {
                self.iteration.all()[k].min(other.iteration.all()[k])
            }),
            outside: self.outside.min(other.outside),
            total: [0, 1].map(|k| self.total[k].min(other.total[k])),
            ..self
        }
    }
}

/// One set-up and solve. The seconds of a phase are those of the slowest rank; those of messages are of the rank that
/// waits least. Collective.
fn once(session: &Session, problem: fetifeti::Problem) -> Result<ScalingPoint> {
    let comm = session.comm();
    let (subdomains, start) = (problem.n_subdomains, clock::spent());
    let (mut solver, setup_total) = timed(session, || {
        FetiFeti::new(session, problem, MethodSettings::default())
    })?;
    let spent = clock::spent().since(&start);
    let phases = [
        Phase::LocalSetup,
        Phase::PrimalSetup,
        Phase::LiftingSetup,
        Phase::NaturalSetup,
    ];
    let named = phases.map(|p| spent.of(p));
    let rest = solver.facts().setup_seconds - named.iter().sum::<f64>();
    let [a, b, c, d] = named;
    let [factor, order] = [Phase::NaturalFactor, Phase::NaturalOrder].map(|p| spent.of(p));
    let natural = (d - factor - order).max(0.0);
    let mut setup = [a, b, c, natural, factor, order, rest.max(0.0)];
    max_all(comm, &mut setup);

    let (solution, solve_total) = timed(session, || solver.solve())?;
    if !solution.converged() {
        return Err(Error::not_converged(format!(
            "a measurement did not converge: {}",
            solution.status
        )));
    }
    let tally = solver.method().system().tally();
    let n = tally.iterations.max(1) as f64;
    let phases = [Phase::Primal, Phase::Lifting, Phase::Natural];
    let coarse = phases.map(|p| tally.times.of(p) / n);
    let sent = [Phase::Exchange, Phase::Reduction].map(|p| tally.times.of(p) / n);
    let local = tally.seconds / n - coarse.iter().chain(&sent).sum::<f64>();
    let [primal, lifting, natural] = coarse;
    let mut slowest = [local.max(0.0), primal, lifting, natural, tally.seconds];
    max_all(comm, &mut slowest);
    let mut least = sent;
    min_all(comm, &mut least);
    let [local, primal, lifting, natural, iterating] = slowest;
    let facts = solver.facts();
    Ok(ScalingPoint {
        subdomains,
        floating_bodies: facts.floating_bodies,
        multipliers: facts.multipliers_local + facts.multipliers_global,
        iterations: solution.iterations,
        steps: solution.steps.len().max(1),
        kappa: solution.estimate.map(|s| s.kappa()),
        setup: SetupSeconds::from_fn(|k| setup[k]),
        iteration: IterationSeconds {
            local,
            primal,
            lifting,
            natural,
            exchange: least[0],
            reduction: least[1],
        },
        outside: (solve_total - iterating).max(0.0),
        total: [setup_total, solve_total],
        work: work(session, &solver),
        communication: solver.communication().unwrap_or_default(),
        ..ScalingPoint::default()
    })
}

/// The quantities that costs depend on, each of the rank with the largest value. Collective.
fn work(session: &Session, solver: &FetiFeti) -> Work {
    let dual = solver.dual();
    let stiffness = &dual.stiffness;
    let mut own = Work {
        kernels: dual.natural.r as f64,
        ..Work::default()
    };
    for (sub, local) in solver.problem().local.iter().zip(&stiffness.locals) {
        let (gamma, delta) = (local.gamma().n_gamma() as f64, local.gamma().n_delta as f64);
        own.subdomains += 1.0;
        own.unknowns += sub.k.n() as f64;
        own.interface_squares += gamma * gamma + delta * delta;
        own.interface_cubes += gamma.powi(3);
    }
    let space = &stiffness.space;
    own.multipliers = stiffness.jump.n_owned as f64;
    own.ghosts = (4 * stiffness.jump.ghosts.len() + 2 * space.ghosts.len()) as f64;
    for body in &space.owned {
        let n = body.range.len() as f64;
        own.primal += n;
        own.primal_factor += n * (n + 1.0).log2();
    }
    if let Some(lifting) = dual.preconditioner.lifting() {
        own.ghosts += 2.0 * space.ghosts.len() as f64;
        own.lifting_products += lifting.products;
        let bodies = space.owned.len().max(1) as f64;
        let order = lifting.rank_and_order.1 as f64 / bodies;
        own.lifting = bodies * order;
        own.lifting_squares = bodies * order.powi(2);
        own.lifting_cubes = bodies * order.powi(3);
    }
    let mut all = own.all();
    max_all(session.comm(), &mut all);
    Work::from_fn(|k| all[k])
}

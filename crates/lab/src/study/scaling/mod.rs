//! `study scaling`: seconds by phase over ranks and bodies, messages, and a model for machines larger than this one.
//!
//! Every run is a process group of its own, with one thread per rank, on scenes in which no two subdomains are equal.
//! The costs of the phases are fitted, on one rank, to the amounts of work of a rank. Messages are counted, and α and β
//! are measured by ping-pong. Runs on several ranks show how accurate the model is. It then predicts problems with one
//! body per rank, on up to 100 000 ranks.

mod fit;
mod measure;
mod model;
mod network;
mod picture;
mod points;
mod predict;
mod quantities;
mod scenes;
mod tables;

pub use fit::Law;
pub use measure::run_task;
pub use model::{CostModel, Modelled};
pub use network::{MeasuredNetwork, Network, Timing};
pub use picture::{figure, model_figure};
pub use points::{ScalingPoint, ScalingProblem, ScalingSeries};
pub use predict::{PhaseLimit, PredictedRow, Prediction, RANKS};
pub use quantities::{IterationSeconds, SetupSeconds, Work};
pub use tables::{points_csv, prediction_csv, text};

use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::baselines::launch::{Launcher, Workspace};
use base::{Error, Result};
use measure::{NetworkRecord, ScalingTask};
use model::SentData;
use petsc::{Options, Session};
use predict::PredictionBasis;
use scenes::Setup;

/// α and β of a usual network between the nodes of a cluster: 1.5 µs, and 100 Gbit/s.
const USUAL: [f64; 2] = [1.5e-6, 8e-11];

/// The study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ScalingReport {
    /// "scaling".
    pub study: String,
    /// Whether the small scenes were run.
    pub quick: bool,
    /// Cores of this machine.
    pub cores: usize,
    /// Messages on this machine.
    pub network: MeasuredNetwork,
    /// All runs.
    pub points: Vec<ScalingPoint>,
    /// The fitted costs.
    pub model: CostModel,
    /// Subdomains of the predicted body, and elements of a subdomain, in each direction.
    pub body: [usize; 2],
    /// Iterations that the predictions assume: those of the run with the largest number of such bodies.
    pub iterations: usize,
    /// Number of bodies in that run.
    pub iterations_of: usize,
    /// Predictions with a body per rank: for the stated network, and for one as fast as the messages of this machine.
    pub predictions: Vec<Prediction>,
}

/// The settings of the user.
#[derive(Debug, Clone, PartialEq)]
pub struct ScalingSettings {
    /// Whether to run the small scenes.
    pub quick: bool,
    /// α and β of the network of the predictions.
    pub network: [f64; 2],
    /// Time limit of a run.
    pub limit: Duration,
    /// PETSc's arguments for every run.
    pub petsc: Vec<String>,
}

impl ScalingSettings {
    /// Reads `-scaling_alpha`, `-scaling_beta` and `-compare_time_limit`.
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) for numbers that are impossible for a network.
    pub fn from_options(
        session: &Session,
        quick: bool,
        petsc: &[String],
    ) -> Result<ScalingSettings> {
        let options = Options::new(session, "scaling_");
        let mut network = USUAL;
        let help = [
            "seconds per message of the network that study scaling predicts for",
            "seconds per byte of that network",
        ];
        for (k, name) in ["alpha", "beta"].into_iter().enumerate() {
            network[k] = options.f64(name, USUAL[k], help[k])?;
            if network[k] <= 0.0 {
                return Err(Error::input(format!(
                    "option -scaling_{name} is {}, expected seconds above 0",
                    network[k]
                )));
            }
        }
        let limit = Options::new(session, "compare_").f64(
            "time_limit",
            120.0,
            "seconds that a run of study scaling may take",
        )?;
        if limit < 1.0 {
            return Err(Error::input(format!(
                "option -compare_time_limit is {limit}, expected at least 1 second"
            )));
        }
        Ok(ScalingSettings {
            quick,
            network,
            limit: Duration::from_secs_f64(limit),
            petsc: petsc.to_vec(),
        })
    }
}

/// Runs the study, and calls `progress` before every run. It is called on one rank: the runs have ranks of their own.
///
/// # Errors
/// [`ErrorKind::Input`](base::ErrorKind::Input) on several ranks or for a case; those of the runs.
pub fn run(
    session: &Session,
    settings: &ScalingSettings,
    case: Option<&str>,
    progress: &mut dyn FnMut(&str),
) -> Result<ScalingReport> {
    super::alone(
        session,
        "scaling",
        "it starts its runs on ranks of their own",
    )?;
    if let Some(case) = case {
        return Err(Error::input(format!(
            "\"{case}\" was not expected: study scaling has no cases"
        )));
    }
    let cores = std::thread::available_parallelism().map_or(1, |n| n.get());
    let mut petsc = settings.petsc.clone();
    petsc.extend(["-fetifeti_threads".into(), "1".into()]);
    let launcher = Launcher {
        workspace: Workspace::new()?,
        limit: settings.limit,
        petsc,
        session: Some(session.clone()),
    };
    progress("messages");
    let network = messages(&launcher)?;
    let mut points = Vec::new();
    let setups = scenes::setups(settings.quick);
    for (k, setup) in setups.iter().enumerate() {
        progress(&format!("{} of {}, {}", k + 1, setups.len(), setup.name()));
        points.push(point(&launcher, setup, cores, settings.quick)?);
    }
    let model = CostModel::fit(&points);
    for p in &mut points {
        p.compare(&model, &network.network);
    }
    let body = scenes::predicted_body(settings.quick);
    let largest = largest_like(&points, body);
    let basis = PredictionBasis {
        model: &model,
        middle: middle(&points),
        iterations: largest.iterations,
    };
    let [alpha, beta] = settings.network;
    let stated = Network {
        alpha,
        beta,
        ..network.network
    };
    let predictions = vec![
        basis.predict("stated", stated),
        basis.predict("this machine", network.network),
    ];
    Ok(ScalingReport {
        study: "scaling".into(),
        quick: settings.quick,
        cores,
        body,
        iterations: largest.iterations,
        iterations_of: largest.bodies,
        network,
        model,
        points,
        predictions,
    })
}

/// The run with a body per rank.
fn middle(points: &[ScalingPoint]) -> &ScalingPoint {
    let found = points
        .iter()
        .find(|p| p.series == ScalingSeries::Neighbours);
    found.expect("it is one of the runs")
}

/// The run with the largest number of bodies of this size.
fn largest_like(points: &[ScalingPoint], [s, e]: [usize; 2]) -> &ScalingPoint {
    let like = |p: &&ScalingPoint| {
        let tied = p.problem == ScalingProblem::Tied;
        tied && p.elements == e && p.subdomains == p.bodies * s * s
    };
    let found = points.iter().filter(like).max_by_key(|p| p.bodies);
    found.expect("such bodies are run")
}

fn started<T: serde::de::DeserializeOwned>(
    launcher: &Launcher,
    name: &str,
    task: &ScalingTask,
    ranks: usize,
) -> Result<T> {
    let finished = launcher.run("run", ("measure", task), ranks)?;
    finished.record.map_err(|mut failure| {
        failure.message = format!("{name}: {}", failure.message);
        failure.into_error()
    })
}

fn messages(launcher: &Launcher) -> Result<MeasuredNetwork> {
    let [two, four]: [NetworkRecord; 2] = [
        started(launcher, "messages", &ScalingTask::Network, 2)?,
        started(launcher, "messages", &ScalingTask::Network, 4)?,
    ];
    let reductions = [two.reductions, four.reductions].concat();
    Ok(MeasuredNetwork::new(two.messages, reductions))
}

fn point(launcher: &Launcher, setup: &Setup, cores: usize, quick: bool) -> Result<ScalingPoint> {
    // To count messages, one run is enough.
    let repeats = match setup.series {
        ScalingSeries::Neighbours => 1,
        _ if quick => 2,
        _ => 3,
    };
    let task = ScalingTask::Solve {
        scene: setup.scene(),
        repeats,
    };
    let measured: ScalingPoint = started(launcher, &setup.name(), &task, setup.ranks)?;
    Ok(ScalingPoint {
        series: setup.series,
        problem: setup.problem,
        ranks: setup.ranks,
        oversubscribed: setup.ranks > cores,
        // Contact adds work in every step that the model does not have.
        fitted: setup.ranks == 1 && setup.problem == ScalingProblem::Tied,
        bodies: setup.n_bodies(),
        elements: setup.elements,
        ..measured
    })
}

impl ScalingPoint {
    /// Enters the model's seconds and their deviation from the measured ones.
    fn compare(&mut self, model: &CostModel, network: &Network) {
        let ranks = self.ranks as f64;
        self.model = model.seconds(&self.work, ranks, &SentData::of(self), network);
        self.setup_deviation = self.model.setup.sum() / self.setup.sum() - 1.0;
        self.iteration_deviation = self.model.iteration.sum() / self.iteration.sum() - 1.0;
    }
}

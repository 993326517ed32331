//! `study hertz`: half-width and peak pressure of frictionless contact compared with Hertz's theory, mesh by mesh.
//!
//! The theory is evaluated for the sum of the multipliers as force. It holds for half-spaces and parabolas, so that
//! displacements are chosen for contact zones of 5 to 10 % of the radius: the remaining difference is of the order
//! a²/R².

mod measure;
mod picture;
mod scenes;
mod theory;

pub use measure::{measure, pressures, MeasuredContact, NodalPressure};
pub use picture::{csv, figure, table, text};
pub use scenes::HertzCase;
pub use theory::{Elastic, HertzContact, HertzPair};

use serde::{Deserialize, Serialize};

use super::solved::Solved;
use base::{Error, Result};
use fetifeti::settings::MethodSettings;
use petsc::Session;
use report::json::Kkt;

/// The study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HertzReport {
    /// Its name, "hertz".
    pub study: String,
    /// One entry per problem.
    pub cases: Vec<HertzProblem>,
}

/// One problem on several meshes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HertzProblem {
    /// `cylinder`, `two_cylinders` or `sphere`.
    pub case: String,
    /// A description.
    pub title: String,
    /// Order of convergence of the pressures, see [`HertzProblem::order`].
    pub order: f64,
    /// From the coarsest to the finest.
    pub meshes: Vec<HertzMesh>,
}

/// One mesh.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HertzMesh {
    /// Elements from pole to rim, and from pole to flat side.
    pub elements: usize,
    /// Unknowns.
    pub dofs: usize,
    /// Nodes that touch.
    pub active: usize,
    /// Force on the whole body: that on both (all four) symmetric parts together.
    pub force: f64,
    /// Half-width a.
    pub half_width: HertzQuantity,
    /// Peak pressure p0.
    pub peak: HertzQuantity,
    /// Root mean square of pressure − theory over all nodes, relative to the theory's.
    pub curve: f64,
    /// Steps of the contact loop.
    pub outer_iterations: usize,
    /// Krylov iterations of all steps.
    pub iterations: usize,
    /// The largest residual of stationarity, feasibility and complementarity.
    pub kkt: f64,
    /// Whether the solver said that it converged.
    pub converged: bool,
    /// Seconds of assembly, set-up and solve.
    pub seconds: f64,
    /// The nodal pressures, by distance.
    pub pressure: Vec<HertzPressure>,
}

/// A quantity of the theory, measured in two ways.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct HertzQuantity {
    /// By Hertz's formula.
    pub theory: f64,
    /// By the fit of p² = p0² (1 − x²/a²) to the nodal pressures.
    pub fit: f64,
    /// From single nodes: the position of the last node that touches, or the largest pressure.
    pub node: f64,
    /// fit/theory − 1.
    pub error: f64,
}

/// A nodal pressure.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct HertzPressure {
    /// Distance from the middle.
    pub x: f64,
    /// Pressure.
    pub p: f64,
    /// Hertz's pressure there.
    pub theory: f64,
}

impl HertzQuantity {
    fn new(theory: f64, fit: f64, node: f64) -> HertzQuantity {
        HertzQuantity {
            theory,
            fit,
            node,
            error: fit / theory - 1.0,
        }
    }
}

/// Elements per radius of every mesh.
pub fn meshes(case: HertzCase, quick: bool) -> &'static [usize] {
    match (case, quick) {
        (HertzCase::Sphere, true) => &[6, 8, 12],
        (HertzCase::Sphere, false) => &[8, 16, 24, 32],
        (_, true) => &[16, 32, 64],
        (_, false) => &[32, 64, 128, 256],
    }
}

/// Runs the study, and calls `progress` before every mesh. Collective.
///
/// # Errors
/// Those of the method; [`ErrorKind::NotConverged`](base::ErrorKind::NotConverged) where a solution cannot be measured.
pub fn run(
    session: &Session,
    quick: bool,
    only: Option<&str>,
    progress: &mut dyn FnMut(&str),
) -> Result<HertzReport> {
    let mut cases = Vec::new();
    for (of, case) in super::numbered(super::chosen(HertzCase::ALL.to_vec(), |c| c.name(), only)?) {
        let mut list = Vec::new();
        for &n in meshes(case, quick) {
            progress(&format!("{of}, {}, {n} elements per radius", case.name()));
            list.push(mesh(session, case, n)?);
        }
        cases.push(HertzProblem {
            case: case.name().into(),
            title: case.title().into(),
            order: HertzProblem::order(&list),
            meshes: list,
        });
    }
    Ok(HertzReport {
        study: "hertz".into(),
        cases,
    })
}

/// Solves one mesh and measures. Collective.
///
/// # Errors
/// As [`run`].
pub fn mesh(session: &Session, case: HertzCase, n: usize) -> Result<HertzMesh> {
    let settings = MethodSettings::default().rtol(1e-8);
    let name = format!("hertz_{}_{n}.toml", case.name());
    let solved = Solved::new(session, &name, &case.scene(n), &settings)?;
    let rows = solved.rows(session);
    let pressures = pressures(&solved.scene, &rows);
    let measured = measure(&rows, &pressures).ok_or_else(|| {
        Error::not_converged(format!(
            "{name}: too few nodes touch for a half-width (more than three were expected)"
        ))
    })?;
    let theory = measure::theory(&case.pair(), &measured, case.share());
    let solution = &solved.solution;
    let mut squares = [0.0; 2];
    for p in &pressures {
        let hertz = theory.pressure(p.x);
        squares[0] += p.weight * (p.value - hertz).powi(2);
        squares[1] += p.weight * hertz.powi(2);
    }
    let mut pressure: Vec<HertzPressure> = pressures
        .iter()
        .filter(|p| p.x.abs() < 3.0 * theory.a)
        .map(|p| HertzPressure {
            x: p.x,
            p: p.value,
            theory: theory.pressure(p.x),
        })
        .collect();
    pressure.sort_by(|a, b| a.x.total_cmp(&b.x));
    Ok(HertzMesh {
        elements: n,
        dofs: solved.dofs(),
        active: measured.active,
        force: case.share() * measured.force,
        half_width: HertzQuantity::new(theory.a, measured.fit.a, measured.nodal.a),
        peak: HertzQuantity::new(theory.p0, measured.fit.p0, measured.nodal.p0),
        curve: (squares[0] / squares[1]).sqrt(),
        outer_iterations: solution.steps.len(),
        iterations: solution.iterations,
        kkt: Kkt::new(&solution.kkt, true).largest(),
        converged: solution.converged(),
        seconds: solved.seconds,
        pressure,
    })
}

impl HertzProblem {
    /// The finest mesh.
    pub fn finest(&self) -> &HertzMesh {
        self.meshes.last().expect("a study has meshes")
    }

    /// The largest error of half-width and peak on a mesh.
    pub fn error(mesh: &HertzMesh) -> f64 {
        mesh.half_width.error.abs().max(mesh.peak.error.abs())
    }

    /// The order of convergence of the pressures to the theory: minus the slope of log(root mean square) over
    /// log(elements), by least squares. Within one element at the edge of the contact zone the root is approximated by
    /// a straight line, so that an order of about 1 is to be expected. The gain from one mesh to the next depends on
    /// where their nodes happen to lie.
    pub fn order(meshes: &[HertzMesh]) -> f64 {
        let n = meshes.len() as f64;
        let logs = meshes
            .iter()
            .map(|m| ((m.elements as f64).ln(), m.curve.ln()));
        let mut sums = [0.0; 4];
        for (x, y) in logs {
            for (sum, term) in sums.iter_mut().zip([x, y, x * x, x * y]) {
                *sum += term / n;
            }
        }
        let [x, y, xx, xy] = sums;
        -(xy - x * y) / (xx - x * x)
    }

    /// Whether every mesh converged, the pressures converge to the theory, and half-width and peak are within 2 % of it
    /// on the finest mesh.
    pub fn holds(&self) -> bool {
        self.meshes.iter().all(|m| m.converged)
            && self.order > 0.7
            && HertzProblem::error(self.finest()) < 0.02
    }
}

//! The results of the study: cases, series of meshes, values beside their references.

use serde::{Deserialize, Serialize};

/// The study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BenchmarksReport {
    /// Its name, "benchmarks".
    pub study: String,
    /// One entry per case.
    pub cases: Vec<BenchmarkReport>,
}

/// One case.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BenchmarkReport {
    /// Its name.
    pub case: String,
    /// The problem that is solved.
    pub title: String,
    /// The reference, and its source.
    pub reference: String,
    /// Why the case, or a part of it, was not run.
    pub skipped: Vec<String>,
    /// Meshes that belong together.
    pub series: Vec<MeshSeries>,
}

/// Meshes of one kind, from the coarsest to the finest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MeshSeries {
    /// The name of the series: the property that its meshes have in common.
    pub name: String,
    /// Order of convergence of the first value: the slope of log(error) over log(mesh size), by least squares. `None`
    /// for a single mesh, and where errors are rounding.
    pub order: Option<f64>,
    /// The meshes.
    pub meshes: Vec<MeshResult>,
}

/// One mesh and its solution.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MeshResult {
    /// The name of the mesh: the property that distinguishes it.
    pub mesh: String,
    /// Mesh size relative to a length of the case: the half-width of the contact, the length of a side.
    pub size: f64,
    /// The file of the scene.
    pub scene: String,
    /// Unknowns.
    pub dofs: usize,
    /// Values beside their references.
    pub values: Vec<MeasuredValue>,
    /// The pressure along the contact.
    pub curve: Vec<ReferencePressure>,
    /// Steps of the contact loop.
    pub outer_iterations: usize,
    /// Krylov iterations of all steps.
    pub iterations: usize,
    /// The Krylov method's estimate of κ, the largest of all steps.
    pub condition: Option<f64>,
    /// The largest residual of stationarity, feasibility and complementarity.
    pub kkt: Option<f64>,
    /// Whether the solver said that it converged.
    pub converged: bool,
    /// Seconds of assembly, set-up and solve.
    pub seconds: f64,
}

/// A value beside its reference.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MeasuredValue {
    /// The name of the quantity.
    pub quantity: String,
    /// The value; `None`: the value is an error already.
    pub ours: Option<f64>,
    /// The reference.
    pub reference: Option<f64>,
    /// ours/reference − 1, or the error itself.
    pub error: f64,
    /// The tolerance: the absolute error may not be larger.
    pub limit: Option<f64>,
}

/// The pressure at a node.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ReferencePressure {
    /// Position along the contact.
    pub x: f64,
    /// Our pressure.
    pub p: f64,
    /// The reference's.
    pub reference: f64,
}

impl MeasuredValue {
    /// A value beside its reference.
    pub fn beside(quantity: &str, ours: f64, reference: f64) -> MeasuredValue {
        MeasuredValue {
            quantity: quantity.into(),
            ours: Some(ours),
            reference: Some(reference),
            error: ours / reference - 1.0,
            limit: None,
        }
    }

    /// An error.
    pub fn error(quantity: &str, error: f64) -> MeasuredValue {
        MeasuredValue {
            quantity: quantity.into(),
            ours: None,
            reference: None,
            error,
            limit: None,
        }
    }

    /// States a tolerance, if there is one.
    #[must_use]
    pub fn within(mut self, limit: Option<f64>) -> MeasuredValue {
        self.limit = limit;
        self
    }

    /// Whether it keeps its tolerance.
    pub fn holds(&self) -> bool {
        // A value that is no number keeps none.
        self.limit.is_none_or(|limit| self.error.abs() <= limit)
    }
}

impl MeshSeries {
    /// A series with its order of convergence.
    pub fn new(name: impl Into<String>, meshes: Vec<MeshResult>) -> MeshSeries {
        MeshSeries {
            name: name.into(),
            order: order(&meshes),
            meshes,
        }
    }
}

/// As [`MeshSeries::order`].
fn order(meshes: &[MeshResult]) -> Option<f64> {
    let first = |m: &MeshResult| Some((m.size, m.values.first()?.error.abs()));
    let points: Vec<(f64, f64)> = meshes.iter().filter_map(first).collect();
    let rounding = points.iter().any(|(_, error)| *error < 1e-9);
    let same = points.iter().all(|(size, _)| *size == points[0].0);
    if points.len() < 2 || rounding || same {
        return None;
    }
    let n = points.len() as f64;
    let mut sums = [0.0; 4];
    for (size, error) in points {
        let (x, y) = (size.ln(), error.ln());
        for (sum, term) in sums.iter_mut().zip([x, y, x * x, x * y]) {
            *sum += term / n;
        }
    }
    let [x, y, xx, xy] = sums;
    Some((xy - x * y) / (xx - x * x))
}

impl BenchmarkReport {
    /// All meshes.
    pub fn meshes(&self) -> impl Iterator<Item = &MeshResult> {
        self.series.iter().flat_map(|s| &s.meshes)
    }

    /// Failures, a sentence for each mesh that did not converge and each value that misses its tolerance.
    pub fn missed(&self) -> Vec<String> {
        let mut out = Vec::new();
        for series in &self.series {
            for mesh in &series.meshes {
                let name = format!("{}, {}, {}", self.case, series.name, mesh.mesh);
                if !mesh.converged {
                    out.push(format!("{name} did not converge"));
                }
                for v in mesh.values.iter().filter(|v| !v.holds()) {
                    let limit = v.limit.unwrap_or_default();
                    out.push(format!(
                        "{name}: {} is off by {:.1e}, at most {limit:.0e} was expected",
                        v.quantity,
                        v.error.abs()
                    ));
                }
            }
        }
        out
    }
}

impl BenchmarksReport {
    /// As [`BenchmarkReport::missed`], of all cases.
    pub fn missed(&self) -> Vec<String> {
        self.cases
            .iter()
            .flat_map(BenchmarkReport::missed)
            .collect()
    }
}

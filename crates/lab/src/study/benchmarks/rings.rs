//! Two rings in contact under p₀ + p₂ cos 2θ from outside, and a ring shrunk onto another one.

use serde_json::Value as Json;

use super::report::{MeasuredValue, MeshResult, MeshSeries, ReferencePressure};
use super::runner::{Runner, SolvedScene};
use base::{Error, Result};

/// The closed form: an Airy function in each ring, with no shear and equal normal displacement between them.
const TABLE: &str = include_str!("../../../../../tests/data/rings.json");

/// One of the three problems of the table.
pub struct Rings {
    /// Radii: inner, of the contact, outer.
    radii: [f64; 3],
    /// Young's modulus and Poisson's ratio of the inner and the outer ring.
    materials: [[f64; 2]; 2],
    /// p₀ and p₂.
    load: [f64; 2],
    /// Interference.
    interference: f64,
    /// The pressure between the rings: its mean and the factor of cos 2θ.
    pub pressure: [f64; 2],
}

/// Units of a scene: lengths and stresses are those of the table times these.
#[derive(Clone, Copy)]
pub struct Units {
    /// Factor of lengths.
    pub length: f64,
    /// Factor of stresses.
    pub stress: f64,
}

impl Rings {
    /// A row of the table.
    ///
    /// # Errors
    /// [`ErrorKind::Environment`](base::ErrorKind::Environment) if the program was built with another table.
    pub fn read(row: usize) -> Result<Rings> {
        let broken = |what: &str| Error::environment(format!("rings.json has no {what}"));
        let table: Json = serde_json::from_str(TABLE).map_err(|e| broken(&e.to_string()))?;
        let of = |key: &str| table[row]["case"][key].as_f64().unwrap_or(0.0);
        let at = |key: &str| {
            let value = table[row]["at_contact"][key].as_f64();
            value.ok_or_else(|| broken(key))
        };
        Ok(Rings {
            radii: ["i", "c", "o"].map(of),
            materials: [["E1", "nu1"].map(of), ["E2", "nu2"].map(of)],
            load: ["p0", "p2"].map(of),
            interference: of("delta"),
            pressure: [at("pressure_mean")?, at("pressure_cos2")?],
        })
    }

    /// A quarter of the rings, with 2n × 3n and 2n × 4n elements.
    pub fn scene(&self, n: usize, order: usize, units: Units) -> String {
        let [inner, middle, outer] = self.radii.map(|r| r * units.length);
        let ring = |name: &str, radii: [f64; 2], around: usize, [young, poisson]: [f64; 2]| {
            format!(
                "\n[[body]]\nname = \"{name}\"\n\
                 shape = {{ annulus = {{ inner = {}, outer = {}, from = 0, to = 90 }} }}\n\
                 elements = [{}, {}]\nsubdomains = [1, {}]\nyoung = {}\npoisson = {poisson}\n\
                 dirichlet = {{ bottom = {{ y = 0 }}, top = {{ x = 0 }} }}\n",
                radii[0],
                radii[1],
                2 * n,
                around * n,
                around,
                young * units.stress
            )
        };
        let [mean, wave] = self.load.map(|p| p * units.stress);
        let load = if mean == 0.0 {
            String::new()
        } else {
            format!("pressure = {{ right = \"{mean} + {wave}*(x^2 - y^2)/(x^2 + y^2)\" }}\n")
        };
        let gap = if self.interference == 0.0 {
            String::new()
        } else {
            format!("gap = {}\n", -self.interference * units.length)
        };
        format!(
            "title = \"Two rings\"\nphysics = \"elasticity\"\norder = {order}\n{}{}{load}\n\
             # The sides are polygons with different corners: gaps up to `adjust` count as none.\n\
             [[contact]]\nbodies = [\"inner\", \"outer\"]\nsides = [\"right\", \"left\"]\nadjust = {}\n{gap}",
            ring("inner", [inner, middle], 3, self.materials[0]),
            ring("outer", [middle, outer], 4, self.materials[1]),
            0.05 * middle
        )
    }

    /// The record of a mesh; without tolerances unless `finest`.
    fn measure(&self, run: &SolvedScene, n: usize, finest: Option<[f64; 2]>) -> MeshResult {
        let [mean, wave] = self.pressure;
        let (mut curve, mut squares, mut whole) = (Vec::new(), 0.0, 0.0);
        // Weighted least squares of p = m + w cos 2θ.
        let mut sums = [0.0; 5];
        for row in &run.last().rows {
            let [x, y, _] = row.label.point;
            let cos2 = (x * x - y * y) / (x * x + y * y);
            let (p, weight) = (row.pressure().unwrap_or(f64::NAN), row.label.area);
            let reference = mean + wave * cos2;
            squares += weight * (p - reference).powi(2);
            whole += weight;
            for (sum, term) in sums.iter_mut().zip([1.0, cos2, cos2 * cos2, p, p * cos2]) {
                *sum += weight * term;
            }
            curve.push(ReferencePressure {
                x: y.atan2(x).to_degrees(),
                p: p / mean,
                reference: reference / mean,
            });
        }
        let [s, c, cc, p, pc] = sums;
        let det = s * cc - c * c;
        let (m, w) = ((p * cc - pc * c) / det, (s * pc - c * p) / det);
        let rms = (squares / whole).sqrt() / mean;
        let limit = |k: usize| finest.map(|l| l[k]);
        let mut values = vec![
            MeasuredValue::error("rms of p / mean", rms).within(limit(0)),
            MeasuredValue::beside("mean p", m, mean).within(limit(1)),
        ];
        if self.load[1] != 0.0 {
            values.push(MeasuredValue::beside("p of cos 2θ", w, wave).within(limit(1)));
        }
        let label = format!("n = {n}");
        run.with_curve(label, 1.0 / n as f64, values, curve)
    }
}

/// The two problems under pressure.
pub fn pressed(runner: &mut Runner) -> Result<Vec<MeshSeries>> {
    let cases = [
        ("Code_Aster's SSNP167", "rings_ssnp167"),
        ("two materials", "rings_two_materials"),
    ];
    series(runner, &cases, [0, 1], &[4, 8, 16])
}

/// The shrink fit.
pub fn shrink(runner: &mut Runner) -> Result<Vec<MeshSeries>> {
    let meshes: &[usize] = if runner.quick {
        &[4, 8, 16]
    } else {
        &[8, 16, 32]
    };
    series(runner, &[("shrink fit", "rings_shrink")], [2, 2], meshes)
}

/// Both orders of the rows of the table that `cases` name.
fn series(
    runner: &mut Runner,
    cases: &[(&str, &str)],
    rows: [usize; 2],
    meshes: &[usize],
) -> Result<Vec<MeshSeries>> {
    let mut out = Vec::new();
    for (&(title, name), row) in cases.iter().zip(rows) {
        let rings = Rings::read(row)?;
        for order in [1, 2] {
            let mut list = Vec::new();
            for (k, &n) in meshes.iter().enumerate() {
                let units = Units {
                    length: 1.0,
                    stress: 1.0,
                };
                let file = format!("{name}_order{order}_{n}");
                let run = runner.solve(&file, &rings.scene(n, order, units))?;
                let finest = (k + 1 == meshes.len()).then_some([1.2e-3, 1e-3]);
                list.push(rings.measure(&run, n, finest));
            }
            out.push(MeshSeries::new(format!("{title}, order {order}"), list));
        }
    }
    Ok(out)
}

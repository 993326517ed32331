//! One scene in metres, millimetres and micrometres.

use super::report::{MeasuredValue, MeshSeries};
use super::rings::{Rings, Units};
use super::runner::Runner;
use base::Result;

/// Name, units in a metre, and the largest relative difference from the scene in metres.
const UNITS: [(&str, f64); 3] = [("m", 1.0), ("mm", 1e3), ("um", 1e6)];

/// The largest permitted difference of pressures and energies.
const LIMIT: f64 = 1e-12;

/// The largest permitted difference of numbers of iterations: the last one may be decided by rounding.
const ITERATIONS: f64 = 2.0;

/// The rings of SSNP167, elements of first and second order.
pub fn run(runner: &mut Runner) -> Result<Vec<MeshSeries>> {
    let rings = Rings::read(0)?;
    let mut out = Vec::new();
    for order in [1, 2] {
        let mut known: Option<(Vec<f64>, f64, [usize; 2])> = None;
        let mut list = Vec::new();
        for (name, length) in UNITS {
            let units = Units {
                length,
                stress: length.powi(-2),
            };
            let file = format!("units_{name}_order{order}");
            let run = runner.solve_to(&file, &rings.scene(8, order, units), None, 1e-13)?;
            let pressure = |p: f64| p / units.stress;
            let p: Vec<f64> = run
                .last()
                .rows
                .iter()
                .filter_map(|r| r.pressure().map(pressure))
                .collect();
            let solution = &run.last().solution;
            // Energy per thickness: N m/m.
            let energy = solution.energy;
            let counts = [solution.steps.len(), solution.iterations];
            let (p0, energy0, counts0) = known.get_or_insert_with(|| (p.clone(), energy, counts));
            let off = p.iter().zip(p0.iter()).map(|(a, b)| (a / b - 1.0).abs());
            let mut worst = off.fold(0.0, f64::max);
            if p.len() != p0.len() {
                worst = 1.0;
            }
            let steps = counts
                .iter()
                .zip(counts0.iter())
                .map(|(a, b)| a.abs_diff(*b))
                .sum::<usize>();
            let values = vec![
                MeasuredValue::error("pressures", worst).within(Some(LIMIT)),
                MeasuredValue::error("energy", energy / *energy0 - 1.0).within(Some(LIMIT)),
                MeasuredValue::error("steps and iterations", steps as f64).within(Some(ITERATIONS)),
            ];
            list.push(run.mesh(name, 1.0, values));
        }
        out.push(MeshSeries::new(format!("rings, order {order}"), list));
    }
    Ok(out)
}

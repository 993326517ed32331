//! The coefficient in words: its range, and the files it was read from.

use base::Result;
use parallel::exchange::{max_all, min_all};
use petsc::Session;
use scene::{distribution, CellGrid, Field, Scene};

/// The range of ρ (Young's modulus in elasticity).
#[derive(Debug, Clone, PartialEq)]
pub struct Coefficient {
    /// Least and greatest value in each body.
    pub bodies: Vec<[f64; 2]>,
}

impl Coefficient {
    /// Evaluates ρ in all elements. Collective.
    pub fn of(session: &Session, scene: &Scene) -> Result<Coefficient> {
        let owns = distribution::owner(session, scene)?;
        let mine = session.agree(scene.coefficient_ranges(&owns))?;
        let [mut low, mut high]: [Vec<f64>; 2] =
            [0, 1].map(|k| mine.iter().map(|r| r[k]).collect());
        min_all(session.comm(), &mut low);
        max_all(session.comm(), &mut high);
        Ok(Coefficient {
            bodies: low.into_iter().zip(high).map(|(l, h)| [l, h]).collect(),
        })
    }

    /// Least and greatest value over all bodies.
    pub fn range(&self) -> [f64; 2] {
        let wider = |a: [f64; 2], b: &[f64; 2]| [a[0].min(b[0]), a[1].max(b[1])];
        self.bodies
            .iter()
            .fold([f64::INFINITY, f64::NEG_INFINITY], wider)
    }

    /// The largest quotient of two values in one body.
    pub fn contrast(&self) -> f64 {
        let quotients = self.bodies.iter().map(|[low, high]| high / low);
        quotients.fold(1.0, f64::max)
    }

    /// A sentence such as "ρ from 0.001 to 1000, inside a body by a factor of up to 1e6; layers.bin, 24 x 24 x 12
    /// cells".
    pub fn text(&self, scene: &Scene) -> String {
        let name = ["ρ", "E"][usize::from(scene.form.is_elastic())];
        let [low, high] = self.range();
        let contrast = self.contrast();
        let (from, to) = (number(low), number(high));
        let mut out = match (low == high, contrast == 1.0) {
            (true, _) => format!("{name} = {from}"),
            (false, true) => format!("{name} from {from} to {to}, constant inside bodies"),
            (false, false) => {
                let contrast = number(contrast);
                format!("{name} from {from} to {to}, inside a body by a factor of up to {contrast}")
            }
        };
        for cells in files(scene) {
            let counts = cells.counts();
            let counts = &counts[..scene.dim()];
            let counts: Vec<String> = counts.iter().map(usize::to_string).collect();
            out += &format!("; {}, {} cells", cells.name(), counts.join(" x "));
        }
        out
    }
}

/// A number with four digits: 0.0123, 3000, 1e6.
fn number(x: f64) -> String {
    let rounded: f64 = format!("{x:.3e}").parse().unwrap_or(x);
    if (1e-4..1e5).contains(&rounded.abs()) {
        format!("{rounded}")
    } else {
        format!("{rounded:e}")
    }
}

/// The coefficient files, each once.
fn files(scene: &Scene) -> Vec<&CellGrid> {
    let mut out: Vec<&CellGrid> = Vec::new();
    for body in &scene.bodies {
        if let Field::Cells(cells) = &body.spec.rho {
            if out.iter().all(|c| c.name() != cells.name()) {
                out.push(cells);
            }
        }
    }
    out
}

#[cfg(test)]
#[path = "../tests/coefficient.rs"]
mod tests;

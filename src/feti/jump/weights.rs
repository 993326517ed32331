//! D: the weights of the copies of a dof in averages.

use crate::feti::settings::Scaling;
use crate::substructures::{Problem, Subdomain};

/// ρ is noise if ln ρ changes from dof to dof by at least this part of its standard deviation. White noise has about
/// 0.8, a field that varies over ten elements 0.2.
const NOISE: f64 = 0.4;

/// Noise must also differ from the mean over the neighbours by this part, as root mean square. White noise has 0.74, a
/// slope over three elements 0.4.
const AWAY: f64 = 0.6;

/// With fewer dofs, noise cannot be told from a slope.
const SAMPLE: usize = 100;

/// Largest ratio of ρ up to which noise is averaged. Beyond it, single stiff elements carry the stiffness of whole
/// edges.
const MODERATE: f64 = 1e3;

/// The diagonal of D for every local subdomain; γ = `gamma` is the exponent of ρ.
///
/// ρ stands for the resistance of a copy that is moved together with its neighbours. Where ρ is noise, that resistance
/// is the mean. Weights as rough as ρ itself would turn smooth jumps into rough averages, whose energy is larger by up
/// to H/h.
pub fn weights(problem: &Problem, scaling: Scaling, gamma: f64) -> Vec<Vec<f64>> {
    let of = |sub: &Subdomain| -> Vec<f64> {
        match scaling {
            Scaling::Multiplicity => vec![1.0; sub.k.n()],
            Scaling::Rho if is_noise(sub) => {
                let mean = sub.rho.iter().sum::<f64>() / sub.rho.len() as f64;
                vec![mean.powf(gamma); sub.rho.len()]
            }
            Scaling::Rho if gamma == 1.0 => sub.rho.clone(),
            Scaling::Rho => sub.rho.iter().map(|r| r.powf(gamma)).collect(),
            Scaling::Stiffness | Scaling::Deluxe => sub.k.diagonal(),
        }
    };
    problem.local.iter().map(of).collect()
}

/// Whether ρ changes from dof to dof without a pattern and by moderate factors.
pub fn is_noise(sub: &Subdomain) -> bool {
    let (low, high) = sub
        .rho
        .iter()
        .fold((f64::INFINITY, 0.0f64), |(l, h), &r| (l.min(r), h.max(r)));
    if sub.rho.len() < SAMPLE || low == high || !(low > 0.0 && high <= MODERATE * low) {
        return false;
    }
    let ln: Vec<f64> = sub.rho.iter().map(|r| r.ln()).collect();
    let n = ln.len() as f64;
    let mean = ln.iter().sum::<f64>() / n;
    let deviation = (ln.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt();
    let (mut sum, mut pairs, mut away) = (0.0, 0.0, 0.0);
    for i in 0..sub.k.n() {
        // Components of one node do not count as neighbours.
        let row = sub.k.row(i).0.iter().map(|&j| j as usize);
        let neighbours = row.filter(|&j| j != i && !same_place(sub, i, j));
        let (mut of_row, mut near, mut count) = (0.0, 0.0, 0.0);
        for j in neighbours {
            of_row += (ln[i] - ln[j]).abs();
            near += ln[j];
            count += 1.0;
        }
        if count > 0.0 {
            away += (ln[i] - near / count).powi(2);
        }
        sum += of_row;
        pairs += count;
    }
    pairs > 0.0 && sum >= NOISE * deviation * pairs && (away / n).sqrt() >= AWAY * deviation
}

fn same_place(sub: &Subdomain, i: usize, j: usize) -> bool {
    let places = sub.coordinates.as_ref();
    places.is_some_and(|x| x[i] == x[j])
}

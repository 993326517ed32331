//! Rigid motions of the floating bodies against the rows: whether the load pushes a body away for ever, and which rows must
//! stay so that none comes loose.
//!
//! A solution exists if and only if no motion v = R α that the rows allow (B_E v = 0, B_I v ≤ 0) gains energy, eᵀα ≤ 0 for all of
//! them; by Farkas' lemma, if and only if Gᵀ λ = e has a solution with λ_I ≥ 0.

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use super::nnls::nnls;
use crate::feti::dual::Dual;
use crate::feti::exchange::{gather_all, sum_all};
use crate::feti::gtg::null_vectors;
use crate::feti::jump::Jump;
use crate::feti::local::dense::Dense;
use crate::feti::local::semidefinite::Semidefinite;
use crate::feti::natural::{moving, KernelLoad};
use crate::feti::rows::Rows;
use crate::substructures::Substructures;
use crate::{Error, Result};

/// What is left of e outside the cone, relative to the loads, may be rounding below this.
const BALANCE: f64 = 1e-9;

/// An error that names the bodies if the load moves some of them away for ever. `g` is B R with all rows. Collective.
pub fn check(
    comm: &SimpleCommunicator,
    problem: &Substructures,
    dual: &Dual,
    g: &Rows,
    load: &KernelLoad,
) -> Result<()> {
    let r = dual.natural.r;
    if r == 0 {
        return Ok(());
    }
    let jump = &dual.stiffness.jump;
    let (columns, free) = directions(comm, jump, g, r);
    let (_, rest) = nnls(&columns, &load.e, &free);
    let size = load.size.iter().fold(0.0f64, |a, s| a.max(*s));
    let left = rest.iter().fold(0.0f64, |a, v| a.max(v.abs()));
    if left <= BALANCE * size {
        return Ok(());
    }
    let who = moving(problem, &dual.stiffness.space.kernel_start, &rest);
    Err(Error::input(format!(
        "{who} pushed away for ever: the load does not balance and no Dirichlet side, tie, contact or obstacle stands against it \
         (resultant {:.6e} in the direction of the motion), expected a support on that side",
        left
    )))
}

/// The different directions among the rows of G, scaled to a largest entry of 1, as columns of length r; and which of them are of
/// equations. The same on every rank. Collective.
fn directions(comm: &SimpleCommunicator, jump: &Jump, g: &Rows, r: usize) -> (Dense, Vec<bool>) {
    // [free, n, (column, value) × n] of each direction
    let mut mine: Vec<Vec<u64>> = Vec::new();
    for i in jump.n_owned_local..jump.n_owned {
        if !jump.is_candidate(i) {
            continue;
        }
        let largest = g.row(i).fold(0.0f64, |a, (_, v)| a.max(v.abs()));
        if largest == 0.0 {
            continue;
        }
        let entries: Vec<(usize, f64)> = g.row(i).filter(|e| e.1 != 0.0).collect();
        let mut words = vec![u64::from(!jump.inequality[i]), entries.len() as u64];
        for (c, v) in entries {
            // Rounded, so that the rows of one flat face count once; 1e-13 is far below what decides.
            let rounded = (v / largest * 1e13).round() / 1e13;
            words.extend([c as u64, (rounded + 0.0).to_bits()]);
        }
        mine.push(words);
    }
    mine.sort_unstable();
    mine.dedup();
    let mut all: Vec<Vec<u64>> = Vec::new();
    for words in gather_all(comm, &mine.concat()) {
        let mut rest = &words[..];
        while let [_, n, ..] = rest {
            let (one, tail) = rest.split_at(2 + 2 * *n as usize);
            all.push(one.to_vec());
            rest = tail;
        }
    }
    all.sort_unstable();
    all.dedup();
    let mut columns = Dense::zeros(r, all.len());
    for (k, words) in all.iter().enumerate() {
        for pair in words[2..].chunks_exact(2) {
            columns.set(pair[0] as usize, k, f64::from_bits(pair[1]));
        }
    }
    (columns, all.iter().map(|w| w[0] == 1).collect())
}

/// Puts rows back into `active` until the active rows hold all rigid motions that the load drives: for every loose motion that gains
/// energy the row with the largest `score` among those that see it. Returns how many were put back. Collective.
pub fn restore(
    comm: &SimpleCommunicator,
    g: &Rows,
    jump: &Jump,
    active: &mut [bool],
    score: &dyn Fn(usize) -> f64,
    load: &KernelLoad,
) -> usize {
    let r = load.e.len();
    if r == 0 {
        return 0;
    }
    let driven = |v: &Vec<f64>| {
        let work: f64 = v.iter().zip(&load.e).map(|(v, e)| v * e).sum();
        let scale: f64 = v.iter().zip(&load.size).map(|(v, s)| (v * s).abs()).sum();
        work.abs() > BALANCE * scale
    };
    let mut restored = 0;
    loop {
        let mut motions = loose(comm, g, r, &|i| active[i]);
        motions.retain(driven);
        if motions.is_empty() {
            return restored;
        }
        // The best row over all ranks that sees some loose motion.
        let sees = |i: usize| {
            motions.iter().any(|v| {
                let largest = v.iter().fold(0.0f64, |a, x| a.max(x.abs()));
                let work: f64 = g.row(i).map(|(c, x)| x * v[c]).sum();
                let size: f64 = g.row(i).map(|(_, x)| x.abs()).sum();
                work.abs() > 1e-8 * size * largest
            })
        };
        let mine = (jump.n_owned_local..jump.n_owned)
            .filter(|&i| jump.is_candidate(i) && !active[i] && sees(i))
            .max_by(|&i, &j| score(i).total_cmp(&score(j)).then(j.cmp(&i)));
        let words = mine.map_or(vec![], |i| vec![score(i).to_bits()]);
        let offers = gather_all(comm, &words);
        let best = offers
            .iter()
            .enumerate()
            .filter_map(|(rank, w)| w.first().map(|&w| (rank, f64::from_bits(w))))
            .reduce(|a, b| if b.1 > a.1 { b } else { a });
        let Some((rank, _)) = best else {
            return restored;
        };
        if rank == comm.rank() as usize {
            active[mine.expect("this rank made the offer")] = true;
        }
        restored += 1;
    }
}

/// Motions that none of the chosen rows sees. Collective.
fn loose(
    comm: &SimpleCommunicator,
    g: &Rows,
    r: usize,
    chosen: &dyn Fn(usize) -> bool,
) -> Vec<Vec<f64>> {
    let mut a = Dense::zeros(r, r);
    for i in (0..g.n()).filter(|&i| chosen(i)) {
        for (p, gp) in g.row(i) {
            for (q, gq) in g.row(i) {
                a.data[p + q * r] += gp * gq;
            }
        }
    }
    sum_all(comm, &mut a.data);
    let scale: Vec<f64> = (0..r)
        .map(|i| match a.get(i, i) {
            d if d > 0.0 => 1.0 / d.sqrt(),
            _ => 1.0,
        })
        .collect();
    for j in 0..r {
        for i in 0..r {
            a.set(i, j, a.get(i, j) * scale[i] * scale[j]);
        }
    }
    let factor = Semidefinite::new(&a);
    let vectors = null_vectors(&a, &factor).into_iter();
    vectors
        .map(|v| v.iter().zip(&scale).map(|(v, s)| v * s).collect())
        .collect()
}

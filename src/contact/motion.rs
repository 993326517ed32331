//! Rigid motions of the floating bodies and the rows: whether the load pushes a body away for ever, and which rows must
//! hold so that no body comes loose.
//!
//! Let v = R α be a motion that the rows allow: B_E v = 0, B_I v ≤ 0. A solution exists if and only if the load gains
//! no energy on any such motion: eᵀα ≤ 0 for all of them. By Farkas' lemma this holds if and only if Gᵀ λ = e has a
//! solution with λ_I ≥ 0.

use std::collections::BTreeMap;

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use super::cone;
use crate::feti::jump::operator::Jump;
use crate::feti::operators::dual::Dual;
use crate::feti::projector::gtg::null_vectors;
use crate::feti::projector::natural::{moving, KernelLoad};
use crate::feti::projector::rows::Rows;
use crate::linalg::dense::Dense;
use crate::linalg::nnls::nnls;
use crate::linalg::semidefinite::Semidefinite;
use crate::linalg::sorted::distinct;
use crate::parallel::exchange::gather_all;
use crate::substructures::Substructures;
use crate::{Error, Result};

/// Largest number of rigid motions for an exact check. Its time grows with their cube and more; beyond this number an
/// iteration decides.
const EXACT: usize = 150;

/// The iteration accepts the load as balanced if the rest of e is below this, relative to the loads.
const NEARLY: f64 = 1e-7;

/// The part of e outside the cone may be rounding if it is below this, relative to the loads.
const BALANCE: f64 = 1e-9;

/// Returns an error that names the bodies if the load moves some of them away for ever. `g` is B R with all rows.
/// Collective.
pub fn check(problem: &Substructures, dual: &Dual, g: &Rows, load: &KernelLoad) -> Result<()> {
    let r = dual.natural.r;
    if r == 0 {
        return Ok(());
    }
    let jump = &dual.stiffness.jump;
    let (columns, free) = directions(dual.comm(), jump, g, r);
    let size = load.size.iter().fold(0.0f64, |a, s| a.max(*s));
    let (rest, tolerance) = if r <= EXACT {
        (nnls(&columns, &load.e, &free).1, BALANCE)
    } else {
        let (rest, known) = cone::outside(&columns, &load.e, &free, 0.1 * NEARLY * size)?;
        // The loop, and the certificate at its end, handle the undecided cases.
        (rest, if known { NEARLY } else { f64::INFINITY })
    };
    let left = rest.iter().fold(0.0f64, |a, v| a.max(v.abs()));
    if left <= tolerance * size {
        return Ok(());
    }
    let who = moving(problem, &dual.stiffness.space.kernel_start, &rest);
    Err(Error::input(format!(
        "{who} pushed away for ever: the load does not balance and no Dirichlet side, tie, \
         contact or obstacle stands against it (resultant {:.6e} in the direction of the motion), \
         expected a support on that side",
        left
    )))
}

/// The different directions among the rows of G, scaled to a largest entry of 1, as columns of length r; and for each
/// of them whether it belongs to an equation. The same on every rank. Collective.
fn directions(comm: &SimpleCommunicator, jump: &Jump, g: &Rows, r: usize) -> (Dense, Vec<bool>) {
    // [free, n, (column, value) × n] of each direction
    let mut mine: Vec<Vec<u64>> = Vec::new();
    for i in jump.rows_between_bodies() {
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
            // Rounded, so that the rows of one flat face count once. 1e-13 is far below the differences that matter.
            let rounded = (v / largest * 1e13).round() / 1e13;
            words.extend([c as u64, (rounded + 0.0).to_bits()]);
        }
        mine.push(words);
    }
    let mut all: Vec<Vec<u64>> = Vec::new();
    for words in gather_all(comm, &distinct(mine).concat()) {
        let mut rest = &words[..];
        while let [_, n, ..] = rest {
            let (one, tail) = rest.split_at(2 + 2 * *n as usize);
            all.push(one.to_vec());
            rest = tail;
        }
    }
    let all = distinct(all);
    let mut columns = Dense::zeros(r, all.len());
    for (k, words) in all.iter().enumerate() {
        for pair in words[2..].chunks_exact(2) {
            columns.set(pair[0] as usize, k, f64::from_bits(pair[1]));
        }
    }
    (columns, all.iter().map(|w| w[0] == 1).collect())
}

/// Puts rows back into `active` until the active rows hold all rigid motions that the load drives. In each pass it
/// takes the row with the largest `score` among those that oppose a driven motion. Returns the number of rows that were
/// put back. Collective.
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
    let mut restored = 0;
    loop {
        let motions = loose(comm, g, r, &|i| active[i]);
        let driven: Vec<Vec<f64>> = motions.into_iter().filter_map(|v| along(v, load)).collect();
        if driven.is_empty() {
            return restored;
        }
        // The largest work of row i on a motion that the load drives. It is positive if the row opposes the motion.
        let against = |i: usize| {
            let size: f64 = g.row(i).map(|(_, x)| x.abs()).sum();
            let work = driven.iter().map(|v| {
                let largest = v.iter().fold(0.0f64, |a, x| a.max(x.abs()));
                let work: f64 = g.row(i).map(|(c, x)| x * v[c]).sum();
                match jump.inequality[i] {
                    true => work / (size * largest),
                    false => work.abs() / (size * largest),
                }
            });
            work.fold(f64::NEG_INFINITY, f64::max)
        };
        let mine = jump
            .rows_between_bodies()
            .filter(|&i| jump.is_candidate(i) && !active[i] && against(i) > 1e-8)
            .max_by(|&i, &j| score(i).total_cmp(&score(j)).then(j.cmp(&i)));
        let words = mine.map_or(vec![], |i| vec![score(i).to_bits()]);
        let offers = gather_all(comm, &words);
        let best = offers
            .iter()
            .enumerate()
            .filter_map(|(rank, w)| w.first().map(|&w| (rank, f64::from_bits(w))))
            .reduce(|a, b| if b.1 > a.1 { b } else { a });
        // Every driven motion has such a row, or `check` would have refused the problem.
        let Some((rank, _)) = best else {
            return restored;
        };
        if rank == comm.rank() as usize {
            active[mine.expect("this rank made the offer")] = true;
        }
        restored += 1;
    }
}

/// The motion with the sign for which the load gains energy; `None` if the load does no work on it.
fn along(v: Vec<f64>, load: &KernelLoad) -> Option<Vec<f64>> {
    let work: f64 = v.iter().zip(&load.e).map(|(v, e)| v * e).sum();
    let scale: f64 = v.iter().zip(&load.size).map(|(v, s)| (v * s).abs()).sum();
    if work.abs() <= BALANCE * scale {
        return None;
    }
    Some(v.into_iter().map(|v| v * work.signum()).collect())
}

/// The smallest rigid motion that removes all violations of inequality rows, as coefficients of the kernel vectors. It
/// is a combination of those `motions` that nothing holds or drives. `None` if there is no such motion. Collective.
pub fn settle(
    comm: &SimpleCommunicator,
    g: &Rows,
    jump: &Jump,
    gaps: &[f64],
    motions: &[Vec<f64>],
) -> Option<Vec<f64>> {
    let n = motions.len();
    if n == 0 {
        return None;
    }
    // Rows a z ≤ b with a scaled to a largest entry of 1. Of several rows with the same a only the smallest b matters.
    let mut tightest: BTreeMap<Vec<u64>, f64> = BTreeMap::new();
    let mut meet = |a: Vec<u64>, b: f64| {
        let least = tightest.entry(a).or_insert(f64::INFINITY);
        *least = least.min(b);
    };
    for i in jump.rows_between_bodies().filter(|&i| jump.inequality[i]) {
        let work = |v: &Vec<f64>| g.row(i).map(|(c, x)| x * v[c]).sum::<f64>();
        let a: Vec<f64> = motions.iter().map(work).collect();
        let largest = a.iter().fold(0.0f64, |m, x| m.max(x.abs()));
        let size: f64 = g.row(i).map(|(_, x)| x.abs()).sum();
        if largest > 1e-10 * size {
            let rounded = a.iter().map(|x| (x / largest * 1e12).round() / 1e12 + 0.0);
            meet(rounded.map(f64::to_bits).collect(), -gaps[i] / largest);
        }
    }
    let mine = tightest.iter().flat_map(|(a, b)| {
        let mut words = a.clone();
        words.push(b.to_bits());
        words
    });
    let words = gather_all(comm, &mine.collect::<Vec<u64>>()).concat();
    let mut all: BTreeMap<Vec<u64>, f64> = BTreeMap::new();
    for one in words.chunks_exact(n + 1) {
        let least = all.entry(one[..n].to_vec()).or_insert(f64::INFINITY);
        *least = least.min(f64::from_bits(one[n]));
    }
    if all.values().all(|b| *b >= 0.0) {
        return None;
    }
    // Least distance programming by NNLS (Lawson and Hanson, chapter 23): min ‖z‖ with −A z ≥ −b.
    let scale = all.values().fold(0.0f64, |m, b| m.max(b.abs()));
    let mut e = Dense::zeros(n + 1, all.len());
    for (k, (a, b)) in all.iter().enumerate() {
        for (j, &x) in a.iter().enumerate() {
            e.set(j, k, -f64::from_bits(x));
        }
        e.set(n, k, -b / scale);
    }
    let mut wanted = vec![0.0; n + 1];
    wanted[n] = 1.0;
    let (_, rest) = nnls(&e, &wanted, &vec![false; all.len()]);
    if rest[n].abs() < 1e-9 {
        return None;
    }
    let mut alpha = vec![0.0; motions[0].len()];
    for (j, v) in motions.iter().enumerate() {
        let z = -rest[j] / rest[n] * scale;
        // `rest` is b − A x here, the negative of the residual in the book. The quotient is the same.
        alpha.iter_mut().zip(v).for_each(|(a, v)| *a += z * v);
    }
    Some(alpha)
}

/// A basis of the motions on which all chosen rows vanish. Collective.
fn loose(
    comm: &SimpleCommunicator,
    g: &Rows,
    r: usize,
    chosen: &dyn Fn(usize) -> bool,
) -> Vec<Vec<f64>> {
    let mut a = g.product(comm, g, r, chosen);
    let scale = a.scale_to_unit_diagonal();
    let factor = Semidefinite::new(&a);
    let vectors = null_vectors(&a, &factor).into_iter();
    vectors
        .map(|v| v.iter().zip(&scale).map(|(v, s)| v * s).collect())
        .collect()
}

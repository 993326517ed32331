//! Motions of single bodies that nothing holds: most motions that nothing holds are such. They are found in the blocks
//! of the bodies on the diagonal of GᵀG, before it is factored.

use mpi::traits::Communicator;
use rustc_hash::FxHashMap;

use super::known::Known;
use super::motion::{Motion, NOTHING_SOLVED};
use super::pattern::Pattern;
use super::weak::weak_columns;
use base::linalg::csr::Csr;
use base::linalg::dense::Dense;
use base::linalg::semidefinite::Semidefinite;
use base::linalg::sorted::distinct;
use cholesky::team::Team;
use parallel::exchange::{exchange_words, gather_all};

/// The motions of single bodies that nothing holds, or nothing but rounding of the input, each with the name of the
/// column that is left out for it. `a` has a unit diagonal; `noise` is for the matrix without this scale.
/// The rank that has the first column of a body looks at it. Collective.
pub(super) fn alone(
    (pattern, known): (&Pattern, &Known),
    team: &Team,
    a: &Csr,
    (scale, noise): (&[f64], &[f64]),
) -> Vec<(u32, Motion)> {
    let bodies = bodies_here(pattern, team);
    let elsewhere = rows_of_others((pattern, known), team, a, &bodies);
    // [column, number of entries, (column, coefficient)…] for each motion.
    let mut words: Vec<u64> = Vec::new();
    for columns in bodies.into_iter().map(|b| pattern.columns(b as usize)) {
        if !team.has(columns.start as u32) {
            continue;
        }
        let first = columns.start;
        let block = Dense::from_fn(columns.len(), columns.len(), |i, j| {
            match elsewhere.get(&(first as u32 + i as u32)) {
                Some(row) => row[j],
                None => a.get(first + i, first + j),
            }
        });
        let noise = noise.get(first).copied().unwrap_or(0.0);
        let unscaled = |i: usize, j: usize| block.get(i, j) / (scale[first + i] * scale[first + j]);
        let weak = weak_columns(&Dense::from_fn(block.rows, block.cols, unscaled), noise);
        let mut strong = block.clone();
        for &k in &weak {
            for i in 0..block.rows {
                strong.set(i, k, 0.0);
                strong.set(k, i, 0.0);
            }
        }
        let factor = Semidefinite::new(&strong);
        for k in factor.dropped() {
            let v = null_vector(&block, &factor, k);
            // The scale of a column that is rounding is vast.
            let unit = if weak.contains(&k) {
                scale[first + k]
            } else {
                1.0
            };
            let entries = (columns.clone()).zip(&v);
            let entries = entries.map(|(c, v)| (c as u32, v * scale[c] / unit));
            let Motion(motion) = Motion::above(NOTHING_SOLVED, entries);
            let name = |c: u32| u64::from(known.name(c));
            words.extend([name((first + k) as u32), motion.len() as u64]);
            words.extend(motion.iter().flat_map(|(c, v)| [name(*c), v.to_bits()]));
        }
    }
    let all = gather_all(team.comm(), &words).concat();
    let mut rest = &all[..];
    let mut out = Vec::new();
    while let [k, n, tail @ ..] = rest {
        let (entries, tail) = tail.split_at(2 * *n as usize);
        let entries = entries.chunks_exact(2);
        let motion = entries
            .map(|e| (e[0] as u32, f64::from_bits(e[1])))
            .collect();
        out.push((*k as u32, Motion(motion)));
        rest = tail;
    }
    out
}

/// The bodies with columns that this rank has, increasing.
fn bodies_here(pattern: &Pattern, team: &Team) -> Vec<u32> {
    let bodies = team.own_dofs().map(|c| pattern.bodies()[c as usize]);
    distinct(bodies)
}

/// Of bodies whose first column this rank has: the rows of their other columns that other ranks have, in the columns
/// of the body. Collective.
fn rows_of_others(
    (pattern, known): (&Pattern, &Known),
    team: &Team,
    a: &Csr,
    bodies: &[u32],
) -> FxHashMap<u32, Vec<f64>> {
    let size = team.comm().size() as usize;
    let mut outgoing: Vec<Vec<u64>> = vec![Vec::new(); size];
    for columns in bodies.iter().map(|&b| pattern.columns(b as usize)) {
        if team.has(columns.start as u32) {
            continue;
        }
        for row in columns.clone().filter(|&c| team.has(c as u32)) {
            let to = &mut outgoing[team.place(columns.start as u32).rank as usize];
            let name = known.name(row as u32);
            to.extend([u64::from(name), columns.len() as u64]);
            to.extend(columns.clone().map(|c| a.get(row, c).to_bits()));
        }
    }
    let mut out = FxHashMap::default();
    for words in exchange_words(team.comm(), outgoing) {
        let mut rest = &words[..];
        while let [row, n, tail @ ..] = rest {
            let (values, tail) = tail.split_at(*n as usize);
            let values = values.iter().map(|&w| f64::from_bits(w));
            out.insert(known.number(*row as u32), values.collect());
            rest = tail;
        }
    }
    out
}

/// The v with A v = 0 that belongs to the dropped column `k`.
pub(super) fn null_vector(a: &Dense, factor: &Semidefinite, k: usize) -> Vec<f64> {
    let mut v: Vec<f64> = a.col(k).iter().map(|x| -x).collect();
    factor.solve(&mut v);
    v[k] = 1.0;
    v
}

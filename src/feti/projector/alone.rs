//! Motions of single bodies that nothing holds: most motions that nothing holds are such. They are found in the blocks
//! of the bodies on the diagonal of GᵀG, before it is factored.

use rustc_hash::FxHashMap;

use super::column_map::ColumnMap;
use super::kernel_motion::{Coefficient, KernelMotion, NOTHING_SOLVED};
use super::pattern::BlockPattern;
use super::weak::weak_columns;
use base::linalg::csr::Csr;
use base::linalg::dense::Dense;
use base::linalg::semidefinite::Semidefinite;
use base::linalg::sorted::distinct;
use cholesky::team::FactorTeam;
use parallel::exchange::exchange_by_rank;
use parallel::parcels::Parcels;

/// The motions of single bodies that nothing holds, or nothing but rounding of the input, each with the name of the
/// column that is left out for it. `a` has a unit diagonal; `noise` is for the matrix without this scale.
/// The rank that has the first column of a body looks at it. Collective.
pub(super) fn alone(
    (pattern, known): (&BlockPattern, &ColumnMap),
    team: &FactorTeam,
    a: &Csr,
    (scale, noise): (&[f64], &[f64]),
) -> Vec<(u32, KernelMotion)> {
    let bodies = bodies_here(pattern, team);
    let elsewhere = rows_of_others((pattern, known), team, a, &bodies);
    let mut found = Parcels::default();
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
            let KernelMotion(motion) = KernelMotion::above(NOTHING_SOLVED, entries);
            let entries = motion.iter();
            let entries = entries.map(|&(c, v)| Coefficient::new(known.name(c), v));
            found.push(known.name((first + k) as u32), entries);
        }
    }
    let all = found.gather_all(team.comm());
    let motion =
        |entries: &[Coefficient]| KernelMotion(entries.iter().map(Coefficient::pair).collect());
    let each = all.iter().flat_map(Parcels::iter);
    each.map(|(column, entries)| (column, motion(entries)))
        .collect()
}

/// The bodies with columns that this rank has, increasing.
fn bodies_here(pattern: &BlockPattern, team: &FactorTeam) -> Vec<u32> {
    let bodies = team.own_dofs().map(|c| pattern.bodies()[c as usize]);
    distinct(bodies)
}

/// Of bodies whose first column this rank has: the rows of their other columns that other ranks have, in the columns
/// of the body. Collective.
fn rows_of_others(
    (pattern, known): (&BlockPattern, &ColumnMap),
    team: &FactorTeam,
    a: &Csr,
    bodies: &[u32],
) -> FxHashMap<u32, Vec<f64>> {
    let mut outgoing = Parcels::for_each_rank(team.comm());
    for columns in bodies.iter().map(|&b| pattern.columns(b as usize)) {
        if team.has(columns.start as u32) {
            continue;
        }
        for row in columns.clone().filter(|&c| team.has(c as u32)) {
            let to = team.place(columns.start as u32).rank as usize;
            let values = columns.clone().map(|c| a.get(row, c));
            outgoing[to].push(known.name(row as u32), values);
        }
    }
    let received = exchange_by_rank(team.comm(), outgoing);
    let rows = received.iter().flat_map(Parcels::iter);
    rows.map(|(row, values)| (known.number(row), values.to_vec()))
        .collect()
}

/// The v with A v = 0 that belongs to the dropped column `k`.
pub(super) fn null_vector(a: &Dense, factor: &Semidefinite, k: usize) -> Vec<f64> {
    let mut v: Vec<f64> = a.col(k).iter().map(|x| -x).collect();
    factor.solve(&mut v);
    v[k] = 1.0;
    v
}

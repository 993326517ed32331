//! Where bodies come to rest that nothing holds.

use std::collections::BTreeMap;

use crate::feti::operators::dual::Dual;
use crate::feti::projector::by_column::ByColumn;
use crate::linalg::dense::Dense;
use crate::linalg::nnls::nnls;
use crate::linalg::union_find::UnionFind;
use crate::parallel::exchange::gather_all;

/// A row a z ≤ b: a as (motion, coefficient as bits), scaled to a largest coefficient of 1.
type Row = Vec<(u64, u64)>;

/// The smallest rigid motion that removes all violations of inequality rows, as coefficients of the kernel vectors that
/// are known here. It is a combination of those motions that nothing holds or drives. `None` if there is no such
/// motion. Collective.
pub fn settle(dual: &Dual, gaps: &[f64]) -> Option<Vec<f64>> {
    let motions = dual.natural.unheld();
    if motions.is_empty() {
        return None;
    }
    let (comm, jump, g) = (dual.comm(), &dual.stiffness.jump, &dual.natural.all);
    let by_column = ByColumn::new(dual.natural.known(), motions.iter());
    // Of several rows with the same a only the smallest b matters.
    let mut tightest: BTreeMap<Row, f64> = BTreeMap::new();
    let meet = |all: &mut BTreeMap<Row, f64>, a: Row, b: f64| {
        let least = all.entry(a).or_insert(f64::INFINITY);
        *least = least.min(b);
    };
    for i in jump.rows_between_bodies().filter(|&i| jump.inequality[i]) {
        let (columns, values) = g.entries(i);
        let a = by_column.works(columns, values);
        let largest = a.iter().fold(0.0f64, |m, x| m.max(x.1.abs()));
        let size: f64 = values.iter().map(|x| x.abs()).sum();
        if largest > 1e-10 * size {
            let rounded = a.iter().map(|&(m, x)| {
                let x = (x / largest * 1e12).round() / 1e12 + 0.0;
                (m as u64, x.to_bits())
            });
            let row = rounded.filter(|e| e.1 != 0).collect();
            meet(&mut tightest, row, -gaps[i] / largest);
        }
    }
    let mut words: Vec<u64> = Vec::new();
    for (a, b) in &tightest {
        words.extend([a.len() as u64, b.to_bits()]);
        words.extend(a.iter().flat_map(|e| [e.0, e.1]));
    }
    let mut all: BTreeMap<Row, f64> = BTreeMap::new();
    for words in gather_all(comm, &words) {
        let mut rest = &words[..];
        while let [n, b, tail @ ..] = rest {
            let (a, tail) = tail.split_at(2 * *n as usize);
            let row = a.chunks_exact(2).map(|e| (e[0], e[1])).collect();
            meet(&mut all, row, f64::from_bits(*b));
            rest = tail;
        }
    }
    // Motions that share a row are looked at together.
    let mut sets = UnionFind::new(motions.len());
    for a in all.keys() {
        a.iter()
            .for_each(|e| sets.join(a[0].0 as usize, e.0 as usize));
    }
    let mut rows: BTreeMap<usize, Vec<(&Row, f64)>> = BTreeMap::new();
    for (a, &b) in &all {
        let set = sets.find(a[0].0 as usize);
        rows.entry(set).or_default().push((a, b));
    }
    let mut members: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for m in 0..motions.len() {
        members.entry(sets.find(m)).or_default().push(m);
    }
    let mut alpha: Option<Vec<f64>> = None;
    for (set, rows) in rows {
        let members = &members[&set];
        let Some(z) = least(members, &rows) else {
            continue;
        };
        let known = dual.natural.known();
        let alpha = alpha.get_or_insert_with(|| vec![0.0; known.n()]);
        let parts = members.iter().zip(z);
        parts.for_each(|(&m, z)| known.add(z, &motions[m], alpha));
    }
    alpha
}

/// Least distance programming by NNLS (Lawson and Hanson, chapter 23): min ‖z‖ with −A z ≥ −b, for the motions
/// `members`. `None` if z = 0 does, or nothing does.
fn least(members: &[usize], rows: &[(&Row, f64)]) -> Option<Vec<f64>> {
    if rows.iter().all(|row| row.1 >= 0.0) {
        return None;
    }
    let n = members.len();
    let scale = rows.iter().fold(0.0f64, |m, row| m.max(row.1.abs()));
    let mut e = Dense::zeros(n + 1, rows.len());
    for (k, (a, b)) in rows.iter().enumerate() {
        for &(m, x) in a.iter() {
            let j = members.binary_search(&(m as usize));
            e.set(j.expect("rows of this set"), k, -f64::from_bits(x));
        }
        e.set(n, k, -b / scale);
    }
    let mut wanted = vec![0.0; n + 1];
    wanted[n] = 1.0;
    let (_, rest) = nnls(&e, &wanted, &vec![false; rows.len()]);
    if rest[n].abs() < 1e-9 {
        return None;
    }
    // `rest` is b − A x here, the negative of the residual in the book. The quotient is the same.
    Some((0..n).map(|j| -rest[j] / rest[n] * scale).collect())
}

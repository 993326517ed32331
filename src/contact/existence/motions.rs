//! Rigid motions of the floating bodies and the rows: whether the load pushes a body away for ever.
//!
//! Let v = R α be a motion that the rows allow: B_E v = 0, B_I v ≤ 0. A solution exists if and only if the load gains
//! no energy on any such motion: eᵀα ≤ 0 for all of them. By Farkas' lemma this holds if and only if Gᵀ λ = e has a
//! solution with λ_I ≥ 0.
//!
//! Few motions are asked about by the exact method of Lawson and Hanson, many by rigid bodies on springs.

use std::collections::HashSet;

use mpi::topology::SimpleCommunicator;

use super::cone::FrictionCone;
use super::springs;
use crate::contact::tuning::Tuning;
use crate::feti::jump::operator::Jump;
use crate::feti::operators::dual::Dual;
use crate::feti::projector::balance::KernelLoad;
use crate::feti::projector::gram::FEW;
use crate::feti::projector::held::{moved, moving, weakness};
use crate::feti::projector::kernel_motion::KernelMotion;
use crate::feti::projector::rows::KernelRows;
use crate::substructures::Problem;
use crate::{Error, Result};
use base::linalg::dense::Dense;
use base::linalg::nnls::nnls_within;
use base::linalg::sorted::distinct;
use parallel::parcels::Parcels;

/// Directions of rows are known to this part of the largest entry: motions of slender bodies have rounding of 1e-12.
const KNOWN: f64 = 1e-10;

/// Returns an error that names the bodies if the load moves some of them away for ever. With many motions the search
/// begins at `lambda`. Collective.
///
/// # Errors
/// Such bodies; PETSc's own errors.
pub fn check(
    problem: &Problem,
    dual: &Dual,
    (load, lambda): (&KernelLoad, &[f64]),
    tuning: &Tuning,
) -> Result<()> {
    let (natural, jump) = (&dual.natural, &dual.stiffness.jump);
    if natural.r == 0 {
        return Ok(());
    }
    let size = load.largest;
    let (rest, tolerance) = if natural.r <= FEW {
        let candidates: Vec<bool> = (0..jump.n_owned).map(|i| jump.is_candidate(i)).collect();
        let rows = natural.rows_without_noise(dual.comm(), &candidates);
        let (columns, free) = directions(dual.comm(), jump, &rows, natural.r);
        let rest = (0..).zip(nnls_within(&columns, &load.e, &free, KNOWN).1);
        let rest = rest.filter(|&(c, v)| v.abs() > load.rounding[c as usize]);
        (KernelMotion(rest.collect()), tuning.balanced)
    } else {
        let wanted = (&load.e[..], 0.1 * tuning.nearly_balanced * size);
        let found =
            springs::uncarried_load(dual.comm(), natural, (jump, &[]), (wanted, lambda), tuning);
        match found {
            Some(rest) => (rest, tuning.nearly_balanced),
            // The certificate at the end of the loop handles the undecided cases.
            None => return Ok(()),
        }
    };
    pushed_away(problem, dual, &rest, tolerance * size)
}

/// Returns an error that names the bodies and their motion if the load moves some of them away for ever against forces
/// of friction in `cones`. Collective.
///
/// # Errors
/// Such bodies; PETSc's own errors.
pub fn check_cones(
    problem: &Problem,
    dual: &Dual,
    load: &KernelLoad,
    cones: &[FrictionCone],
    tuning: &Tuning,
) -> Result<()> {
    let (comm, natural, jump) = (dual.comm(), &dual.natural, &dual.stiffness.jump);
    if natural.r == 0 {
        return Ok(());
    }
    let tolerance = tuning.nearly_balanced * load.largest;
    let (wanted, nothing) = ((&load.e[..], 0.1 * tolerance), vec![0.0; jump.n_owned]);
    let from = (wanted, &nothing[..]);
    let found = springs::uncarried_load(comm, natural, (jump, cones), from, tuning);
    match found {
        Some(away) if away.largest() > tolerance => {
            let seen = as_seen(dual, &away, cones);
            pushed_away(problem, dual, &seen, tolerance.min(0.5 * seen.largest()))
        }
        _ => Ok(()),
    }
}

/// A motion against forces of friction as one sees it. Where a node slides it opens by μ times its slip in the proof,
/// because forces lie in cones; in truth it stays closed. A proof of sliding may also have a part that tips: where most
/// of it is left with all nodes closed, this is the motion. Collective.
fn as_seen(dual: &Dual, away: &KernelMotion, cones: &[FrictionCone]) -> KernelMotion {
    let (natural, jump) = (&dual.natural, &dual.stiffness.jump);
    let size = away.largest();
    let known = natural.known();
    let mut alpha = vec![0.0; known.n()];
    known.add(1.0, away, &mut alpha);
    let along = |i: usize| -> f64 {
        let (columns, values) = natural.all.entries(i);
        let terms = columns.iter().zip(values);
        terms.map(|(&c, g)| g * alpha[c as usize]).sum()
    };
    let mut held = vec![false; jump.n_owned];
    let little = 1e-6 * size;
    for i in jump.rows_between_bodies().filter(|&i| jump.is_candidate(i)) {
        held[i] = jump.law[i].bears(0.0) || along(i).abs() <= little;
    }
    for cone in cones {
        held[cone.rows[0]] = true;
        cone.rows[1..].iter().for_each(|&i| held[i] = false);
    }
    let mut seen = part_along(dual, away, &held);
    if seen.square() < 0.5 * away.square() {
        for cone in cones {
            let [normal, first, second] =
                [0, 1, 2].map(|k| cone.rows.get(k).map_or(0.0, |&i| along(i)));
            let slip = first.hypot(second);
            let opens = -normal > cone.opening(slip) * (1.0 + 1e-3) + little;
            held[cone.rows[0]] = !opens;
            let sticks = !opens && slip <= little;
            cone.rows[1..].iter().for_each(|&i| held[i] = sticks);
        }
        seen = part_along(dual, away, &held);
    }
    if seen.largest() <= little {
        seen = away.clone();
    }
    // A name needs two digits, and the proof may have no more: a turn by δ beside a slide lengthens slips by δ²/2. More
    // of them would make a turn about a point far away of a slide.
    let least = 2e-2 * seen.largest();
    KernelMotion(seen.0.into_iter().filter(|e| e.1.abs() > least).collect())
}

/// The part of a motion along what these rows leave free. Collective.
fn part_along(dual: &Dual, motion: &KernelMotion, held: &[bool]) -> KernelMotion {
    let free = dual.natural.gram(dual.comm(), held);
    let mut basis: Vec<KernelMotion> = Vec::new();
    let mut part = KernelMotion::default();
    for free in free.unheld.iter().filter(|m| m.dot_with(motion) != 0.0) {
        let mut rest = free.clone();
        for other in &basis {
            rest = rest.plus(-rest.dot_with(other) / other.square(), other);
        }
        if rest.square() > 1e-20 * free.square() {
            part = part.plus(motion.dot_with(&rest) / rest.square(), &rest);
            basis.push(rest);
        }
    }
    part
}

/// Returns an error that names the bodies if the part of the load that nothing stands against, `rest`, is above
/// `tolerance`.
pub fn pushed_away(
    problem: &Problem,
    dual: &Dual,
    rest: &KernelMotion,
    tolerance: f64,
) -> Result<()> {
    let left = rest.largest();
    if left <= tolerance {
        return Ok(());
    }
    let who = moving(problem, &dual.natural.columns, rest);
    let way = dual.natural.way(problem, &dual.stiffness, rest);
    let weak = weakness(problem, &dual.natural.columns, rest);
    Err(Error::input(format!(
        "{who} pushed away for ever{way}: the load does not balance and no Dirichlet side, tie, \
         contact or obstacle stands against it (resultant {left:.6e} in the direction of the motion), \
         expected a support on that side{weak}"
    ))
    .at(problem.location(&moved(&dual.natural.columns, rest))))
}

/// The different directions among the rows of G, scaled to a largest entry of 1, as columns of length r; and for each
/// of them whether it belongs to an equation. The same on every rank. Collective.
fn directions(
    comm: &SimpleCommunicator,
    jump: &Jump,
    g: &KernelRows,
    r: usize,
) -> (Dense, Vec<bool>) {
    // Of each direction whether it is free, the number of its entries, and their columns and bits.
    let mut mine: Vec<(u64, usize, Vec<[u64; 2]>)> = Vec::new();
    for i in jump.rows_between_bodies() {
        if !jump.is_candidate(i) {
            continue;
        }
        let largest = g.row(i).fold(0.0f64, |a, (_, v)| a.max(v.abs()));
        if largest == 0.0 {
            continue;
        }
        let entries = g.row(i).filter(|e| e.1 != 0.0).map(|(c, v)| {
            // Rounded, so that the rows of one flat face count once. 1e-13 is far below the differences that matter.
            let rounded = (v / largest * 1e13).round() / 1e13;
            [c as u64, (rounded + 0.0).to_bits()]
        });
        let entries: Vec<[u64; 2]> = entries.collect();
        mine.push((
            u64::from(!jump.law[i].is_inequality()),
            entries.len(),
            entries,
        ));
    }
    let mut sent = Parcels::default();
    for (free, _, entries) in distinct(mine) {
        sent.push(free, entries);
    }
    let all = sent.gather_all(comm);
    let all = all.iter().flat_map(Parcels::iter);
    let mut all = distinct(all.map(|(free, entries)| (free, entries.len(), entries)));
    // Of directions that may be one, most are left out here. The edge of a cell may divide them: least squares sees to
    // those.
    let cell = |&[c, v]: &[u64; 2]| (c, (f64::from_bits(v) / KNOWN).round() as i64);
    let mut seen = HashSet::new();
    all.retain(|(free, _, entries)| {
        seen.insert((*free, entries.iter().map(cell).collect::<Vec<_>>()))
    });
    let mut columns = Dense::zeros(r, all.len());
    for (k, (_, _, entries)) in all.iter().enumerate() {
        for &[c, v] in *entries {
            columns.set(c as usize, k, f64::from_bits(v));
        }
    }
    (columns, all.iter().map(|d| d.0 == 1).collect())
}

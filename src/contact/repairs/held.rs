//! Rows that must hold so that no body comes loose.
//!
//! The motions that the rows leave free are a null space of GᵀG. A row that is put back takes one motion out of it and
//! changes the others of its group of bodies: nothing is factored again. Where no row opposes a motion that the load
//! drives, the motion proves that there is no solution (Farkas).

use mpi::traits::Communicator;

use crate::contact::existence::pushed_away;
use crate::contact::tuning::Tuning;
use crate::feti::operators::dual::Dual;
use crate::feti::projector::balance::{KernelLoad, LoadWork};
use crate::feti::projector::by_column::ByColumn;
use crate::feti::projector::columns::KernelColumns;
use crate::feti::projector::gram::FEW;
use crate::feti::projector::kernel_motion::{Coefficient, KernelMotion};
use crate::substructures::{Problem, SentLaw};
use crate::Result;
use base::linalg::sorted::distinct;
use base::linalg::union_find::UnionFind;
use bytemuck::{Pod, Zeroable};
use parallel::parcels::Parcels;

/// Puts rows back into `active` until the active rows hold all rigid motions that the load drives. For each
/// driven motion it takes the row with the largest `score` among those that oppose it, those with the largest first,
/// and none with the score −∞. Returns the number of rows that were put back. Collective.
///
/// # Errors
/// Bodies that the load pushes away for ever: no row opposes a driven motion, and the load without given forces of
/// friction, `alone`, drives it, too. Friction can hold a body, and drives none.
pub fn restore_coercivity(
    problem: &Problem,
    dual: &Dual,
    active: &mut [bool],
    score: &dyn Fn(usize) -> f64,
    (load, alone): (&KernelLoad, Option<&KernelLoad>),
    tuning: &Tuning,
) -> Result<usize> {
    let (comm, natural, jump) = (dual.comm(), &dual.natural, &dual.stiffness.jump);
    if natural.r == 0 {
        return Ok(0);
    }
    let gram = natural.gram(comm, active);
    if gram.unheld.is_empty() {
        return Ok(0);
    }
    let mut free = Free::new(gram.unheld.clone(), &natural.columns, tuning);
    drop(gram);
    let (g, known) = (&natural.all, natural.known());
    // No other columns come into motions that are combined.
    let load_along = load.along(comm, known, &free.motions);
    let (mut restored, mut rest) = (0, KernelMotion::default());
    loop {
        let driven = free.driven(&load_along);
        if driven.is_empty() {
            break;
        }
        let by_column = ByColumn::new(known, driven.iter().map(|d| &d.motion));
        // For each motion the best row on this rank.
        let mut best: Vec<Option<(f64, usize)>> = vec![None; driven.len()];
        let candidates = jump.rows_between_bodies();
        let candidates = candidates.filter(|&i| score(i) > f64::NEG_INFINITY);
        for i in candidates.filter(|&i| jump.is_candidate(i) && !active[i]) {
            let (columns, values) = g.entries(i);
            let size: f64 = values.iter().map(|x| x.abs()).sum();
            for (d, work) in by_column.works(columns, values) {
                let work = jump.law[i].resistance(work);
                let against = work > tuning.against * size * driven[d].largest;
                if against && best[d].is_none_or(|(least, _)| score(i) > least) {
                    best[d] = Some((score(i), i));
                }
            }
        }
        let mut mine = Parcels::default();
        for (motion, best) in best.iter().enumerate() {
            let Some((score, row)) = *best else {
                continue;
            };
            let offered = Offered {
                motion,
                score,
                row,
                law: jump.law[row].sent(),
            };
            let (columns, values) = g.entries(row);
            let entries = columns.iter().zip(values);
            let entries = entries.map(|(&c, &v)| Coefficient::new(known.name(c), v));
            mine.push(offered, entries);
        }
        let mut offers: Vec<Option<Offer>> = driven.iter().map(|_| None).collect();
        for (rank, list) in mine.gather_all(comm).iter().enumerate() {
            for (offered, entries) in list.iter() {
                let known = &mut offers[offered.motion];
                let better = |other: &Offer| offered.score > other.offered.score;
                if known.as_ref().is_none_or(better) {
                    let (columns, values) = entries.iter().map(Coefficient::pair).unzip();
                    *known = Some(Offer {
                        offered,
                        rank,
                        columns,
                        values,
                    });
                }
            }
        }
        // A motion that no row opposes is the proof that there is no solution, unless it is rounding.
        let mut unopposed = Vec::new();
        for (d, _) in driven
            .iter()
            .zip(&offers)
            .filter(|(_, offer)| offer.is_none())
        {
            let ([work, ..], square) = (load_along.work(&d.motion), d.motion.square());
            rest = rest.plus(work / square, &d.motion);
            unopposed.push(d.number);
        }
        free.forget(&unopposed);
        let mut offers: Vec<Offer> = offers.into_iter().flatten().collect();
        offers.sort_by(|a, b| {
            let (a, b) = (&a.offered, &b.offered);
            b.score.total_cmp(&a.score).then(a.motion.cmp(&b.motion))
        });
        // Few motions: all rows are looked at again after each. Many would take as many passes.
        if natural.r <= FEW {
            offers.truncate(1);
        }
        for offer in offers {
            // Rows before it may have taken its motion.
            if free.hold(&natural.columns, &offer, &load_along) {
                restored += 1;
                if offer.rank == comm.rank() as usize {
                    active[offer.offered.row] = true;
                }
            }
        }
    }
    if let Some(alone) = alone {
        let rest = [rest.clone()];
        if alone.along(comm, known, &rest).work(&rest[0])[0] <= 0.0 {
            return Ok(restored);
        }
    }
    pushed_away(problem, dual, &rest, tuning.nearly_balanced * load.largest)?;
    Ok(restored)
}

/// A row that a rank offers to put back against a driven motion, by its number there.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Offered {
    motion: usize,
    score: f64,
    row: usize,
    law: SentLaw,
}

/// The row, and the rank that offers it.
struct Offer {
    offered: Offered,
    rank: usize,
    /// The names of its columns, and the values.
    columns: Vec<u32>,
    values: Vec<f64>,
}

/// A motion on which the load does work, with the sign for which it gains energy.
struct Driven {
    number: usize,
    motion: KernelMotion,
    largest: f64,
}

/// A basis of the motions that nothing holds, in groups of bodies that move together.
struct Free<'a> {
    tuning: &'a Tuning,
    motions: Vec<KernelMotion>,
    /// The largest coefficient of each motion.
    largest: Vec<f64>,
    /// The bodies that move, increasing; only they have places in groups.
    bodies: Vec<u32>,
    /// The motions of each group, by the place of the lowest of its bodies.
    members: Vec<Vec<usize>>,
    groups: UnionFind,
}

impl<'a> Free<'a> {
    fn new(motions: Vec<KernelMotion>, columns: &KernelColumns, tuning: &'a Tuning) -> Free<'a> {
        let of = |motion: &KernelMotion| -> Vec<u32> {
            let mut bodies: Vec<u32> = motion.0.iter().map(|e| columns.body(e.0)).collect();
            bodies.dedup();
            bodies
        };
        let moved: Vec<Vec<u32>> = motions.iter().map(of).collect();
        let bodies = distinct(moved.iter().flatten().copied());
        let place = |b: u32| bodies.binary_search(&b).expect("a body that moves");
        let mut groups = UnionFind::new(bodies.len());
        for list in &moved {
            let joined = list.iter().skip(1);
            joined.for_each(|&b| groups.join(place(list[0]), place(b)));
        }
        let mut members = vec![Vec::new(); bodies.len()];
        for (m, list) in moved.iter().enumerate() {
            if let Some(&first) = list.first() {
                members[groups.find(place(first))].push(m);
            }
        }
        Free {
            tuning,
            largest: motions.iter().map(KernelMotion::largest).collect(),
            motions,
            bodies,
            members,
            groups,
        }
    }

    /// The work of the load on a motion; `None` if it is rounding.
    fn gain(&self, m: usize, load: &LoadWork) -> Option<f64> {
        load.driving(&self.motions[m], self.tuning.balanced)
    }

    fn driven(&self, load: &LoadWork) -> Vec<Driven> {
        let mut out = Vec::new();
        for &number in self.members.iter().flatten() {
            if let Some(work) = self.gain(number, load) {
                out.push(Driven {
                    number,
                    motion: self.motions[number].times(work.signum()),
                    largest: self.largest[number],
                });
            }
        }
        out
    }

    /// Leaves motions out.
    fn forget(&mut self, which: &[usize]) {
        if !which.is_empty() {
            let members = self.members.iter_mut();
            members.for_each(|list| list.retain(|m| !which.contains(m)));
        }
    }

    /// Lets a row hold if it opposes a motion that is still driven. Returns whether it does.
    fn hold(&mut self, columns: &KernelColumns, row: &Offer, load: &LoadWork) -> bool {
        let of_row = row.columns.iter().map(|&c| columns.body(c));
        let moved = of_row.filter_map(|b| self.bodies.binary_search(&b).ok());
        let moved: Vec<usize> = moved.collect();
        let mut touched: Vec<usize> = moved.into_iter().map(|b| self.groups.find(b)).collect();
        touched.sort_unstable();
        touched.dedup();
        let of = touched.iter().flat_map(|&g| &self.members[g]);
        let members: Vec<usize> = of.copied().collect();
        let size: f64 = row.values.iter().map(|x| x.abs()).sum();
        let against = self.tuning.against;
        // The work on each motion, and relative to the largest that it could be.
        let works: Vec<(usize, f64, f64)> = members
            .iter()
            .map(|&m| {
                let work = self.motions[m].work(&row.columns, &row.values);
                (m, work, work / (size * self.largest[m]))
            })
            .filter(|w| w.2.abs() > 1e-2 * against)
            .collect();
        let law = row.offered.law.law();
        let opposed = works.iter().any(|&(m, _, relative)| {
            relative.abs() > against
                && self
                    .gain(m, load)
                    .is_some_and(|gain| law.resistance(gain * relative) > 0.0)
        });
        if !opposed {
            return false;
        }
        let strongest = works.iter().max_by(|a, b| a.2.abs().total_cmp(&b.2.abs()));
        let &(pivot, of_pivot, _) = strongest.expect("one is opposed");
        let out = std::mem::take(&mut self.motions[pivot]);
        for &(m, work, _) in works.iter().filter(|w| w.0 != pivot) {
            self.motions[m] = self.motions[m].plus(-work / of_pivot, &out);
            self.largest[m] = self.motions[m].largest();
        }
        let mut left: Vec<usize> = members.into_iter().filter(|&m| m != pivot).collect();
        left.sort_unstable();
        // Groups that the row joins move together from now on.
        for &group in &touched {
            self.members[group].clear();
            self.groups.join(touched[0], group);
        }
        self.members[touched[0]] = left;
        true
    }
}

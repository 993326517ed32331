//! Inequalities between more than two unknowns, such as mortar rows: a change of variables makes them bounds.
//!
//! ```text
//!     w_p = B u,      u_p = (w_p − Σ b u) / b_p      the sum goes over the other terms of the row
//! ```
//!
//! Every such row has an unknown of its own, along the normal at the node that carries its multiplier, and w there is
//! what the inequality bounds. With a dual basis the row has one or a few terms on its own side, so that the change of
//! variables and its inverse are sparse. Where two rows ask for the same unknown, as where a node lies opposite two
//! bodies, one of them takes an unknown of another node.

use std::collections::{BTreeMap, BTreeSet};

use super::{LayoutTerms, UnknownLayout};
use crate::assembled::eliminated::EliminatedUnknowns;
use base::Result;
use fetifeti::problem::RowSource;
use fetifeti::Row;
use parallel::exchange::sum_all;
use petsc::{Session, Vec as PetscVec};

/// Stands for w of a row, before its place is known: larger than every place.
const ROW: u64 = 1 << 48;

/// How much rather a row takes the unknown at the node with its multiplier than any other.
const OTHERS: f64 = 1e-3;

/// The place of a row, and its terms in u by place.
type CombinedRow = (u64, Vec<(u64, f64)>);

/// The rows, and what they do to unknowns.
#[derive(Debug, Default)]
pub(super) struct Combined {
    /// For each inequality its place and terms; `None` where it is the difference of two unknowns.
    rows: Vec<Option<CombinedRow>>,
    /// The unknown that a row has taken in terms of w, and an offset.
    of: BTreeMap<u64, LayoutTerms>,
    /// Index into `rows` by place.
    at: BTreeMap<u64, usize>,
}

impl Combined {
    /// The place of w of an inequality.
    pub fn place(&self, inequality: usize) -> Option<u64> {
        let row = self.rows.get(inequality)?;
        row.as_ref().map(|row| row.0)
    }

    /// An unknown that a row has taken, in terms of w.
    pub fn get(&self, place: u64) -> Option<&LayoutTerms> {
        self.of.get(&place)
    }

    /// The terms in u of the row at a place.
    pub fn row_at(&self, place: u64) -> Option<&[(u64, f64)]> {
        let row = self.rows[*self.at.get(&place)?].as_ref()?;
        Some(&row.1)
    }

    /// The places with their terms in u.
    pub fn rows(&self) -> impl Iterator<Item = &CombinedRow> {
        self.rows.iter().flatten()
    }

    pub fn is_empty(&self) -> bool {
        self.of.is_empty()
    }
}

impl UnknownLayout<'_> {
    /// Whether an inequality is no difference of two unknowns along one direction, nor bounds a single one.
    pub(super) fn is_combined(&self, row: &Row) -> bool {
        match self.ends(row).0.as_slice() {
            [] | [_] => false,
            [a, b] => (0..3).any(|c| (a.1[c] + b.1[c]).abs() > 1e-10),
            _ => true,
        }
    }

    /// The node that carries the multiplier of a row, with the vector whose product with u the row takes.
    pub(super) fn carrier(&self, row: &Row) -> Option<(u64, [f64; 3])> {
        let own = match row.label.source {
            RowSource::Interface(k) => {
                let interface = &self.scene.interfaces[k];
                let mortar = interface.mortar.as_ref()?;
                let at = interface
                    .order
                    .iter()
                    .position(|&o| o == mortar.multipliers);
                row.label.members[at?]?
            }
            RowSource::Obstacle(_) => row.label.members[0]?,
            RowSource::Equation(_) => return None,
        };
        let (c, body) = (self.components, &self.scene.bodies[own.body]);
        let mut inside = own.node * c..own.node * c + c;
        let free = inside.find(|&k| body.prescribed_at(k).is_none())?;
        let block = self.index(body.first_dof + free as u64) / c as u64;
        let (ends, _) = self.ends(row);
        ends.into_iter().find(|e| e.0 == block)
    }

    /// Changes variables so that these inequalities are bounds; equations are eliminated and nodes turned before.
    pub(super) fn combine(&mut self, inequalities: &[&Row]) {
        let combined: Vec<bool> = inequalities.iter().map(|r| self.is_combined(r)).collect();
        if !combined.contains(&true) || self.trouble.is_some() {
            return;
        }
        // Unknowns of other inequalities stay.
        let (mut kept, mut wanted) = (BTreeSet::new(), BTreeSet::new());
        let (mut rows, mut equations) = (Vec::new(), Vec::new());
        for ((&row, k), combined) in inequalities.iter().zip(0..).zip(combined) {
            if !combined {
                rows.push(None);
                kept.extend(self.bound(row).iter().flat_map(|b| b.0).flatten());
                continue;
            }
            if let Some((block, direction)) = self.carrier(row) {
                let slot = self.frame(block).along(direction);
                wanted.insert(block * self.components as u64 + slot as u64);
            }
            let places = row.terms.iter().map(|&(dof, b)| (self.index(dof), b));
            let places: Vec<(u64, f64)> = places.collect();
            let mut sum: BTreeMap<u64, f64> = BTreeMap::from([(ROW + k, -1.0)]);
            let mut rhs = 0.0;
            for &(place, b) in &places {
                let (terms, offset) = self.terms(place);
                rhs -= b * offset;
                terms
                    .into_iter()
                    .for_each(|(v, t)| *sum.entry(v).or_default() += b * t);
            }
            equations.push((sum.into_iter().collect::<Vec<_>>(), rhs));
            rows.push(Some((0, places)));
        }
        let weight = |place: u64| match place {
            ROW.. => 0.0,
            _ if kept.contains(&place) => 0.0,
            _ if wanted.contains(&place) => 1.0,
            _ => OTHERS,
        };
        let solved = match EliminatedUnknowns::new(equations, &weight) {
            Ok(solved) => solved,
            Err(_) => {
                self.trouble = Some(self.dependent(inequalities));
                return;
            }
        };
        // Eliminated in turn: each row has given up one unknown.
        let taken: Vec<u64> = solved.order().to_vec();
        let on = rows
            .iter_mut()
            .zip(0..)
            .filter_map(|(r, k)| Some((r.as_mut()?, k)));
        let mut at = BTreeMap::new();
        for ((row, k), &place) in on.zip(&taken) {
            row.0 = place;
            at.insert(place, k);
        }
        let known = |id: u64| match id {
            ROW.. => rows[(id - ROW) as usize].as_ref().map_or(0, |r| r.0),
            place => place,
        };
        let of = taken.iter().filter_map(|&place| {
            let (terms, offset) = solved.get(place)?;
            let terms = terms.iter().map(|(&id, &t)| (known(id), t));
            Some((place, (terms.collect(), offset)))
        });
        let of = of.collect();
        self.combined = Combined { rows, of, at };
    }

    /// B u of these rows by place, from u. Collective.
    pub(super) fn jumps(&self, session: &Session, u: &PetscVec) -> Result<Vec<(u64, f64)>> {
        let rows = || self.combined.rows();
        let mut places: Vec<u64> = rows().flat_map(|r| r.1.iter().map(|t| t.0)).collect();
        places.sort_unstable();
        places.dedup();
        let range = u.ownership_range();
        let mut values = vec![0.0; places.len()];
        {
            let u = u.array()?;
            for (value, &place) in values.iter_mut().zip(&places) {
                if range.contains(&(place as usize)) {
                    *value = u[place as usize - range.start];
                }
            }
        }
        sum_all(session.comm(), &mut values);
        let value = |place: u64| places.binary_search(&place).map_or(0.0, |k| values[k]);
        let jump = |terms: &[(u64, f64)]| terms.iter().map(|&(p, b)| b * value(p)).sum();
        Ok(rows().map(|(place, terms)| (*place, jump(terms))).collect())
    }

    /// The sentence on rows that depend on each other.
    fn dependent(&self, inequalities: &[&Row]) -> String {
        let row = inequalities.iter().find(|r| self.is_combined(r));
        let x = row.map_or([0.0; 3], |r| r.label.point);
        format!(
            "some of the inequalities between sides whose nodes do not match, such as at ({}, {}, {}), depend on each \
             other, so that they are no bounds of single unknowns",
            x[0], x[1], x[2]
        )
    }
}

#[cfg(test)]
#[path = "../../../tests/assembled/combined.rs"]
mod tests;

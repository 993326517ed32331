//! The effect of the rows of a scene on w: equations leave unknowns out, inequalities turn nodes.

use std::collections::BTreeMap;

use super::UnknownLayout;
use crate::assembled::eliminated::{EliminatedUnknowns, Trouble};
use crate::assembled::frame::{parallel, NodeFrame};
use base::linalg::vec3::{norm, unit};
use fetifeti::Row;

/// The directions along which inequalities bound a node.
#[derive(Debug, Default)]
pub(super) struct Directions {
    list: Vec<[f64; 3]>,
    /// Number of the first ones that must be unknowns: differences of two nodes are taken along them.
    firm: usize,
}

impl Directions {
    /// Whether a direction has component `k`.
    pub(super) fn bounds(&self, k: usize) -> bool {
        self.list.iter().any(|d| d[k].abs() > 1e-12)
    }
}

/// Nodes whose unknowns inequalities take.
pub(super) type BoundedNodes = BTreeMap<u64, Directions>;

impl UnknownLayout<'_> {
    /// The nodes in inequalities with their directions. Where inequalities have more than two unknowns, these are the
    /// nodes that carry multipliers.
    pub(super) fn bounded(&self, rows: &[&Row]) -> BoundedNodes {
        let mut directions = BoundedNodes::new();
        let mut add = |block: u64, direction: [f64; 3], firm: bool| {
            let of = directions.entry(block).or_default();
            if !of.list.iter().any(|d| parallel(*d, direction)) {
                of.list.push(upright(direction));
                of.firm += usize::from(firm);
            }
        };
        for row in rows.iter().filter(|row| !self.is_combined(row)) {
            for (block, direction) in self.ends(row).0 {
                add(block, direction, true);
            }
        }
        for row in rows.iter().filter(|row| self.is_combined(row)) {
            if let Some((block, direction)) = self.carrier(row) {
                if let Some(n) = unit(direction) {
                    add(block, n, false);
                }
            }
        }
        directions
    }

    /// Solves the equations beside ties. What inequalities take of a node stays.
    pub(super) fn eliminate(&mut self, rows: &[Row], bounded: &BoundedNodes) {
        let equations = rows.iter().zip(&self.scene.rows);
        // Ties of two unknowns have none of their own: the numbering has joined them.
        let equations = equations
            .filter(|(row, of_scene)| !row.law.is_inequality() && of_scene.combination.is_some());
        let placed = equations.map(|(row, _)| {
            let terms = row.terms.iter().map(|&(dof, b)| (self.index(dof), b));
            (terms.collect(), row.gap)
        });
        let c = self.components as u64;
        let weight = |place: u64| {
            let taken = |d: &[f64; 3]| d[(place % c) as usize].abs() > 1e-12;
            let kept = bounded.get(&(place / c));
            f64::from(kept.is_none_or(|of| !of.list.iter().any(taken)))
        };
        match EliminatedUnknowns::new(placed, &weight) {
            Ok(eliminated) => {
                self.void.extend(eliminated.places());
                self.void.sort_unstable();
                self.eliminated = eliminated;
            }
            Err(trouble) => {
                let (Trouble::Kept(place) | Trouble::Contradicts(place)) = trouble;
                let x = self.position(place / c);
                let why = match trouble {
                    Trouble::Kept(_) => {
                        "joins only displacements that inequalities bound, so that it determines no other"
                    }
                    Trouble::Contradicts(_) => "contradicts the others",
                };
                self.trouble = Some(format!(
                    "an equation between displacements at ({}, {}, {}) {why}",
                    x[0], x[1], x[2]
                ));
            }
        }
    }

    /// Computes the frames of the nodes in inequalities.
    pub(super) fn turn(&mut self, rows: &[&Row], bounded: &BoundedNodes) {
        for (&block, Directions { list, firm }) in bounded {
            let c = self.components as u64;
            let free =
                [0, 1, 2].map(|k| k < c && self.void.binary_search(&(block * c + k)).is_err());
            // What need not be an unknown is none where it depends on the others.
            let fits = (*firm..=list.len()).rev();
            match fits
                .into_iter()
                .find_map(|n| NodeFrame::new(&list[..n], free))
            {
                Some(frame) if frame.is_identity() => {}
                Some(frame) => {
                    self.frames.insert(block, frame);
                }
                None => {
                    let x = self.position(block);
                    self.trouble.get_or_insert_with(|| {
                        format!(
                            "at ({}, {}, {}) the node is in inequalities along {} directions that \
                             are not independent, so that they are no bounds of single unknowns",
                            x[0], x[1], x[2], firm
                        )
                    });
                }
            }
        }
        for row in rows {
            if self.trouble.is_none() && !self.is_combined(row) && self.bound(row).is_none() {
                let x = self
                    .ends(row)
                    .0
                    .first()
                    .map_or([0.0; 3], |e| self.position(e.0));
                self.trouble = Some(format!(
                    "the inequality at ({}, {}, {}) is not the difference of two unknowns",
                    x[0], x[1], x[2]
                ));
            }
        }
    }

    /// The nodes of a row, each with the vector whose product with u the row takes. All vectors are divided by the
    /// length of the first, which is returned as well.
    pub fn ends(&self, row: &Row) -> (Vec<(u64, [f64; 3])>, f64) {
        let mut ends: Vec<(u64, [f64; 3])> = Vec::new();
        let c = self.components as u64;
        for &(dof, coefficient) in &row.terms {
            let at = self.index(dof);
            let (block, component) = (at / c, (at % c) as usize);
            match ends.iter_mut().find(|e| e.0 == block) {
                Some(end) => end.1[component] += coefficient,
                None => {
                    let mut end = (block, [0.0; 3]);
                    end.1[component] = coefficient;
                    ends.push(end);
                }
            }
        }
        // A row may vanish once ties are applied.
        ends.retain(|e| norm(e.1) > 1e-12);
        let scale = ends.first().map_or(1.0, |e| norm(e.1));
        ends.iter_mut().for_each(|e| e.1 = e.1.map(|v| v / scale));
        (ends, scale)
    }

    /// As [`UnknownLayout::bound`], for inequality number `k` of the scene, which may have more unknowns.
    pub fn bound_of(&self, k: usize, row: &Row) -> Option<([Option<u64>; 2], f64)> {
        match self.combined.place(k) {
            Some(place) => Some(([Some(place), None], 1.0)),
            None => self.bound(row),
        }
    }

    /// A row as w_plus − w_minus ≤ gap / scale: (plus, minus, scale). `None` if it does not have this form.
    pub fn bound(&self, row: &Row) -> Option<([Option<u64>; 2], f64)> {
        let (ends, scale) = self.ends(row);
        let mut out = [None; 2];
        for (block, direction) in ends {
            let (slot, sign) = self.frame(block).place(direction)?;
            let place = &mut out[usize::from(sign < 0.0)];
            if place.is_some() {
                return None;
            }
            *place = Some(block * self.components as u64 + slot as u64);
        }
        Some((out, scale))
    }
}

/// Of a direction and its opposite, the one whose first nonzero entry is positive.
fn upright(d: [f64; 3]) -> [f64; 3] {
    let first = d.iter().find(|v| v.abs() > 1e-6).copied().unwrap_or(1.0);
    d.map(|v| v * first.signum() + 0.0)
}

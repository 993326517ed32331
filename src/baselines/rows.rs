//! The inequalities of a scene on the unknowns of the assembled problem.
//!
//! Every row bounds a difference, u_p − u_m ≤ g, where p or m may be *ground*, on which u = 0: rows of contact pairs have two
//! nodes, rows beside an obstacle or a given value one. There are few of them, and every rank knows all.

use std::collections::BTreeMap;

use super::groups::Potentials;
use crate::scene::{Numbering, Scene};
use crate::substructures::RowKind;

/// u_plus − u_minus ≤ gap. Indices into [`Rows::unknowns`]; their number stands for ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Index of the unknown with coefficient 1.
    pub plus: usize,
    /// Index of the unknown with coefficient −1.
    pub minus: usize,
    /// Right-hand side at the last load step.
    pub gap: f64,
    /// The classes of bodies that it joins.
    pub joins: [usize; 2],
}

/// All inequalities, in the order of [`Scene::rows`].
#[derive(Debug, Clone, Default)]
pub struct Rows {
    /// Unknowns in some row, increasing.
    pub unknowns: Vec<u64>,
    /// The rows.
    pub rows: Vec<Row>,
    /// Whether each row holds to begin with.
    pub initial: Vec<bool>,
    /// Bodies that ties hold together move as one class, named by one of its bodies; the number of bodies stands for ground. Classes are
    /// below this number.
    pub(super) classes: usize,
    /// The class that cannot move.
    pub(super) still: usize,
    /// For every row of the scene its subdomain, and its place in `rows` if it is an inequality.
    pub(super) from: Vec<(usize, Option<usize>)>,
}

impl Rows {
    /// The inequalities of `scene` on the unknowns of `numbering`.
    pub fn new(scene: &Scene, numbering: &Numbering) -> Rows {
        let body_of = |dof: u64| scene.bodies.partition_point(|b| b.first_dof <= dof) - 1;
        let ground_body = scene.n_bodies();
        let mut moving = classes(scene);
        let all = scene.rows(&|_| true);
        let subdomains = scene.points.iter().flat_map(|point| {
            std::iter::repeat_n(point.subdomain, point.rows.len() + point.bounds.len())
        });
        let mut out = Rows {
            classes: ground_body + 1,
            still: moving.find(ground_body).0,
            ..Rows::default()
        };
        // (unknown, its body) with coefficient 1 and −1
        let mut ends: Vec<[Option<(u64, usize)>; 2]> = Vec::new();
        for (row, subdomain) in all.iter().zip(subdomains) {
            let inequality = row.kind == RowKind::Inequality;
            out.from.push((subdomain, inequality.then_some(ends.len())));
            if !inequality {
                continue;
            }
            let end = |sign: f64| {
                let mut terms = row.terms.iter();
                let term = terms.find(|t| t.1 == sign);
                term.map(|&(dof, _)| (numbering.global(dof), body_of(dof)))
            };
            ends.push([end(1.0), end(-1.0)]);
            out.initial.push(row.holds);
            out.rows.push(Row {
                plus: 0,
                minus: 0,
                gap: row.gap,
                joins: [0; 2],
            });
        }
        let mut unknowns: Vec<u64> = ends.iter().flatten().flatten().map(|e| e.0).collect();
        unknowns.sort_unstable();
        unknowns.dedup();
        for (row, ends) in out.rows.iter_mut().zip(&ends) {
            let [plus, minus] = ends.map(|end| match end {
                Some((unknown, body)) => {
                    let place = unknowns.binary_search(&unknown);
                    (
                        place.expect("every unknown was listed"),
                        moving.find(body).0,
                    )
                }
                None => (unknowns.len(), moving.find(ground_body).0),
            });
            (row.plus, row.minus) = (plus.0, minus.0);
            row.joins = [plus.1, minus.1];
        }
        // Ties may leave nothing of a row.
        for (initial, row) in out.initial.iter_mut().zip(&out.rows) {
            *initial &= row.plus != row.minus;
        }
        out.unknowns = unknowns;
        out
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// The set of these rows.
    pub fn set(&self, active: &[usize]) -> Vec<bool> {
        let mut set = vec![false; self.len()];
        active.iter().for_each(|&r| set[r] = true);
        set
    }

    /// The rows of a set.
    pub fn list(&self, active: &[bool]) -> Vec<usize> {
        (0..self.len()).filter(|&r| active[r]).collect()
    }

    /// The index that stands for ground.
    pub fn ground(&self) -> usize {
        self.unknowns.len()
    }

    /// For every row of the scene that the owner of the subdomains `owns` provides its place here, if it is an inequality.
    pub fn provided(&self, owns: &dyn Fn(usize) -> bool) -> Vec<Option<usize>> {
        let mine = self.from.iter().filter(|(s, _)| owns(*s));
        mine.map(|&(_, place)| place).collect()
    }

    /// B u − c from u at [`Rows::unknowns`].
    pub fn gaps(&self, u: &[f64]) -> Vec<f64> {
        let at = |k: usize| u.get(k).copied().unwrap_or(0.0);
        let gap = |r: &Row| at(r.plus) - at(r.minus) - r.gap;
        self.rows.iter().map(gap).collect()
    }

    /// Sets of unknowns that rows may join, by unknown: those of lower number and itself.
    pub fn lower_partners(&self) -> Vec<Vec<usize>> {
        let mut sets = Potentials::new(self.unknowns.len());
        for row in &self.rows {
            if row.plus.max(row.minus) < self.ground() {
                sets.join(row.plus, row.minus, 0.0);
            }
        }
        let mut members: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        let mut out = Vec::with_capacity(self.unknowns.len());
        for k in 0..self.unknowns.len() {
            let list = members.entry(sets.find(k).0).or_default();
            list.push(k);
            out.push(list.clone());
        }
        out
    }

    /// Puts rows into `active` until nothing is loose that the rows together hold: for every loose class of bodies the row with the
    /// largest score that joins it to another one. Returns the rows that were put in.
    pub fn restore(&self, active: &mut [bool], score: &[f64]) -> Vec<usize> {
        let mut restored = Vec::new();
        loop {
            let mut sets = Potentials::new(self.classes);
            for (row, _) in self.rows.iter().zip(&*active).filter(|(_, on)| **on) {
                sets.join(row.joins[0], row.joins[1], 0.0);
            }
            let still = sets.find(self.still).0;
            let mut holds = |r: &usize| {
                let [a, b] = self.rows[*r].joins.map(|class| sets.find(class).0);
                a != b && (a != still || b != still)
            };
            let useful: Vec<usize> = (0..self.len()).filter(&mut holds).collect();
            let by_score = |r: &usize, s: &usize| score[*r].total_cmp(&score[*s]).then(s.cmp(r));
            let Some(best) = useful.into_iter().max_by(by_score) else {
                return restored;
            };
            active[best] = true;
            restored.push(best);
        }
    }
}

/// Bodies, and ground behind them, joined where ties or given values hold one to the other.
fn classes(scene: &Scene) -> Potentials {
    let ground = scene.n_bodies();
    let mut sets = Potentials::new(ground + 1);
    for (b, body) in scene.bodies.iter().enumerate() {
        if !body.prescribed.is_empty() {
            sets.join(b, ground, 0.0);
        }
    }
    for point in &scene.points {
        for (member, &to) in point.members.iter().zip(&point.tied_to) {
            sets.join(member.body, point.members[to].body, 0.0);
        }
    }
    sets
}

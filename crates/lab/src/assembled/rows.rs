//! The inequalities of a scene on the unknowns of the assembled problem.
//!
//! Every row bounds a difference, w_p − w_m ≤ g, where p or m may be *ground*, at which w = 0. Rows of contact pairs
//! have two nodes, rows beside an obstacle or a prescribed value one. Along normals that are not parallel to an axis, w
//! are the coordinates of u in a frame (see [`NodeFrame`](super::frame::NodeFrame)). Mortar rows have more nodes, and
//! each has an unknown w of its own ([`UnknownLayout`]). There are few rows, and every rank has all of them.

use std::collections::BTreeMap;

use super::layout::UnknownLayout;
use super::motions::{Echelon, Functional};
use super::potentials::Potentials;
use scene::Scene;

/// u_plus − u_minus ≤ gap. Unknowns are indices into [`Inequalities::unknowns`]; the length of that list stands for
/// ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GapInequality {
    /// Index of the unknown with coefficient 1.
    pub plus: usize,
    /// Index of the unknown with coefficient −1.
    pub minus: usize,
    /// Right-hand side at the last load step.
    pub gap: f64,
}

/// All inequalities, in the order of [`Scene::solver_rows`].
#[derive(Debug, Clone, Default)]
pub struct Inequalities {
    /// Unknowns in some row, increasing.
    pub unknowns: Vec<u64>,
    /// The rows.
    pub rows: Vec<GapInequality>,
    /// Whether each row is active at the start.
    pub initial: Vec<bool>,
    /// The equations in the rigid motions that ties, equations, springs and prescribed values give.
    pub(super) held: Echelon,
    /// The linear forms of the rows in the rigid motions.
    pub(super) forms: Vec<Functional>,
    /// For every row of the scene its subdomain, and its index in `rows` if it is an inequality.
    pub(super) from: Vec<(usize, Option<usize>)>,
}

impl Inequalities {
    /// The inequalities of `scene`. The rows are meaningless where `layout.trouble` is set.
    pub fn new(scene: &Scene, layout: &UnknownLayout) -> Inequalities {
        let all = scene.solver_rows(&|_| true);
        let mut out = Inequalities {
            held: layout.held.clone(),
            forms: layout.forms.clone(),
            ..Inequalities::default()
        };
        // Unknowns with coefficient 1 and −1.
        let mut ends: Vec<[Option<u64>; 2]> = Vec::new();
        for (row, of_scene) in all.iter().zip(&scene.rows) {
            let inequality = row.law.is_inequality();
            out.from
                .push((of_scene.subdomain, inequality.then_some(ends.len())));
            if !inequality {
                continue;
            }
            let bound = layout.bound_of(ends.len(), row);
            let (places, scale) = bound.unwrap_or(([None; 2], 1.0));
            ends.push(places);
            out.initial.push(row.holds);
            out.rows.push(GapInequality {
                plus: 0,
                minus: 0,
                gap: row.gap / scale,
            });
        }
        let mut unknowns: Vec<u64> = ends.iter().flatten().flatten().copied().collect();
        unknowns.sort_unstable();
        unknowns.dedup();
        for (row, ends) in out.rows.iter_mut().zip(&ends) {
            let place = |end: Option<u64>| match end {
                Some(unknown) => unknowns
                    .binary_search(&unknown)
                    .expect("every unknown was listed"),
                None => unknowns.len(),
            };
            [row.plus, row.minus] = ends.map(place);
        }
        // A row may vanish once ties are applied.
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

    /// The set of these rows, as flags.
    pub fn set(&self, active: &[usize]) -> Vec<bool> {
        let mut set = vec![false; self.len()];
        active.iter().for_each(|&r| set[r] = true);
        set
    }

    /// The rows of a set, as a list.
    pub fn list(&self, active: &[bool]) -> Vec<usize> {
        (0..self.len()).filter(|&r| active[r]).collect()
    }

    /// The index that stands for ground.
    pub fn ground(&self) -> usize {
        self.unknowns.len()
    }

    /// For every row of the scene that the owner of the subdomains `owns` provides, its index here; `None` if it is not
    /// an inequality.
    pub fn provided(&self, owns: &dyn Fn(usize) -> bool) -> Vec<Option<usize>> {
        let mine = self.from.iter().filter(|(s, _)| owns(*s));
        mine.map(|&(_, place)| place).collect()
    }

    /// B u − c from u at [`Inequalities::unknowns`].
    pub fn gaps(&self, u: &[f64]) -> Vec<f64> {
        let at = |k: usize| u.get(k).copied().unwrap_or(0.0);
        let gap = |r: &GapInequality| at(r.plus) - at(r.minus) - r.gap;
        self.rows.iter().map(gap).collect()
    }

    /// For each unknown, the unknowns that rows may join to it: those of lower number, and itself.
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

    /// Adds rows to `active` until they hold every rigid motion that all rows together can hold. Rows are tried in the
    /// order of their scores; one is added if it removes a motion that ties, equations, springs, prescribed values and
    /// the active rows leave free. Returns the added rows.
    pub fn restore(&self, active: &mut [bool], score: &[f64]) -> Vec<usize> {
        let mut held = self.held.clone();
        let (mut on, mut off): (Vec<usize>, Vec<usize>) = (0..self.len()).partition(|&r| active[r]);
        for r in on.drain(..) {
            held.insert(&self.forms[r], 0.0);
        }
        off.sort_by(|r, s| score[*s].total_cmp(&score[*r]).then(r.cmp(s)));
        off.retain(|&r| held.insert(&self.forms[r], 0.0));
        off.iter().for_each(|&r| active[r] = true);
        off
    }
}

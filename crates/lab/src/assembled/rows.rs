//! The inequalities of a scene on the unknowns of the assembled problem.
//!
//! Every row bounds a difference, w_p − w_m ≤ g, where p or m may be *ground*, at which w = 0. Rows of contact pairs
//! have two nodes, rows beside an obstacle or a prescribed value one. Along normals that are not parallel to an axis, w
//! are the coordinates of u in a frame (see [`NodeFrame`](super::frame::NodeFrame)). Mortar rows have more nodes, and
//! each has an unknown w of its own ([`UnknownLayout`]). There are few rows, and every rank has all of them.
//!
//! Tangential rows of nodes with friction come after the inequalities: they are differences along tangents, which hold
//! as equations where the node sticks.

use std::collections::BTreeMap;

use super::layout::UnknownLayout;
use super::motions::{Echelon, Functional};
use super::potentials::Potentials;
use fetifeti::problem::FrictionNode;
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

/// All inequalities and tangential rows, in the order of [`Scene::solver_rows`].
#[derive(Debug, Clone, Default)]
pub struct Inequalities {
    /// Unknowns in some row, increasing.
    pub unknowns: Vec<u64>,
    /// The rows.
    pub rows: Vec<GapInequality>,
    /// Whether each row is active at the start.
    pub initial: Vec<bool>,
    /// The compliance of each row, 0 where it is rigid; a list shorter than `rows` stands for zeros.
    pub compliance: Vec<f64>,
    /// A unit of each row's difference in the row of the scene; a list shorter than `rows` stands for ones.
    pub scale: Vec<f64>,
    /// The contact of each row; rows beyond the list are of one contact.
    pub groups: Vec<[[usize; 2]; 3]>,
    /// The nodes with friction, by the places of their rows here.
    pub friction: Vec<FrictionNode>,
    /// The equations in the rigid motions that ties, equations, springs and prescribed values give.
    pub(super) held: Echelon,
    /// The linear forms of the rows in the rigid motions.
    pub(super) forms: Vec<Functional>,
    /// For every row of the scene its subdomain, and its index in `rows` if the contact loop decides about it.
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
        let nodes = scene.friction_nodes(&|_| true);
        let mut subdomains: Vec<usize> = scene.rows.iter().map(|row| row.subdomain).collect();
        for node in &nodes {
            let own = subdomains[node.normal];
            subdomains.extend(node.tangential.iter().map(|_| own));
        }
        for (row, subdomain) in all.iter().zip(subdomains) {
            let decided = row.law.is_decided();
            out.from.push((subdomain, decided.then_some(ends.len())));
            if !decided {
                continue;
            }
            let bound = layout.bound_of(ends.len(), row);
            let (places, scale) = bound.unwrap_or(([None; 2], 1.0));
            ends.push(places);
            out.groups.push(row.label.groups());
            out.initial.push(row.holds);
            out.compliance.push(row.compliance / (scale * scale));
            out.scale.push(scale);
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
        let place = |r: usize| out.from[r].1.expect("rows of friction are decided");
        let of_node = |node: &FrictionNode| {
            let tangential = node.tangential.iter().map(|&t| place(t)).collect();
            FrictionNode::new(place(node.normal), tangential, node.bound)
        };
        out.friction = nodes.iter().map(of_node).collect();
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

    /// For every row of the scene that the owner of the subdomains `owns` provides, its index here; `None` for an
    /// equation.
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

    /// Whether some row has a law beside hard contact without friction.
    pub fn has_laws(&self) -> bool {
        !self.friction.is_empty() || self.compliance.iter().any(|c| *c > 0.0)
    }

    /// The compliance of a row.
    pub fn softness(&self, r: usize) -> f64 {
        self.compliance.get(r).copied().unwrap_or(0.0)
    }

    /// A unit of a row's difference in the row of the scene.
    pub fn scale_of(&self, r: usize) -> f64 {
        self.scale.get(r).copied().unwrap_or(1.0)
    }

    /// Multipliers in units of the scene.
    pub fn of_scene(&self, lambda: &[f64]) -> Vec<f64> {
        let each = lambda.iter().enumerate();
        each.map(|(r, l)| l / self.scale_of(r)).collect()
    }

    /// The compliance of the nodes of each row, in units of the scene, from the diagonal of K at the unknowns.
    pub fn give(&self, diagonal: &[f64]) -> Vec<f64> {
        let at = |end: usize| diagonal.get(end).map_or(0.0, |k| 1.0 / k);
        let rows = self.rows.iter().enumerate();
        rows.map(|(r, row)| self.scale_of(r).powi(2) * (at(row.plus) + at(row.minus)))
            .collect()
    }

    /// For each row how many rows its node has: those of its own contact, and more where it shares unknowns with
    /// others.
    pub fn beside(&self) -> Vec<usize> {
        let mut users = vec![0usize; self.ground()];
        for row in &self.rows {
            for end in [row.plus, row.minus] {
                if let Some(users) = users.get_mut(end) {
                    *users += 1;
                }
            }
        }
        let most = |r: usize| {
            let row = &self.rows[r];
            let ends = [row.plus, row.minus].into_iter();
            ends.filter_map(|end| users.get(end))
                .max()
                .copied()
                .unwrap_or(0)
        };
        let mut out = vec![1; self.len()];
        for node in &self.friction {
            let own = node.tangential.iter().chain([&node.normal]);
            let shared = own.map(|&r| most(r)).max().unwrap_or(0);
            out[node.normal] = node.tangential.len() + shared;
        }
        out
    }

    /// The rows of a set that hold as equations: those that do not give way.
    pub fn rigid(&self, active: &[bool]) -> Vec<bool> {
        let each = active.iter().enumerate();
        each.map(|(r, on)| *on && self.softness(r) == 0.0).collect()
    }

    /// Whether each row is a tangential one.
    pub fn tangential(&self) -> Vec<bool> {
        let mut out = vec![false; self.len()];
        let rows = self.friction.iter().flat_map(|node| &node.tangential);
        rows.for_each(|&t| out[t] = true);
        out
    }

    /// Bᵀ λ at [`Inequalities::unknowns`].
    pub fn transposed(&self, lambda: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.ground()];
        for (row, l) in self.rows.iter().zip(lambda).filter(|(_, l)| **l != 0.0) {
            for (end, force) in [(row.plus, *l), (row.minus, -*l)] {
                if let Some(out) = out.get_mut(end) {
                    *out += force;
                }
            }
        }
        out
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

    /// The contact of a row, and its bodies.
    pub fn groups_of(&self, row: usize) -> [[usize; 2]; 3] {
        self.groups.get(row).copied().unwrap_or_default()
    }

    /// Adds rows to `active` until they hold every rigid motion that all rows together can hold. Rows are tried in the
    /// order of their scores; one is added if it removes a motion that ties, equations, springs, prescribed values and
    /// the active rows leave free; `combined` are rows with coefficients that hold together, such as springs across
    /// slips. Returns the added rows.
    pub fn restore(
        &self,
        active: &mut [bool],
        score: &[f64],
        combined: impl IntoIterator<Item = [(usize, f64); 2]>,
    ) -> Vec<usize> {
        let mut held = self.held.clone();
        for rows in combined {
            let parts = rows.iter().map(|&(r, c)| (&self.forms[r], c));
            let form = parts.flat_map(|(form, c)| form.iter().map(move |&(k, v)| (k, c * v)));
            held.insert(&form.collect(), 0.0);
        }
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

//! The unknowns w of the assembled problem of a scene: node by node, C components each.
//!
//! ```text
//!     Numbering (free dofs) ── blocks of C ──> u ── w = M u at nodes in contact ──> w, what systems and files hold
//! ```
//!
//! A node with some components prescribed keeps places for them, in which w = 0 with a row of its own (*void* places):
//! multigrid for elasticity needs all components of a node. Unknowns that equations between displacements determine
//! are void, too: there u is a combination of others and an offset. So are supports: where ties, equations, springs,
//! prescribed values and inequalities together leave rigid motions free, as many dofs are set to zero. Under a balanced
//! load these supports bear no force.

mod combined;
mod rows;
mod to_unknowns;

use std::collections::BTreeMap;

use super::eliminated::EliminatedUnknowns;
use super::frame::NodeFrame;
use super::motions::{Echelon, Functional, Motions};
use base::linalg::vec3::ball;
use fetifeti::Row;
use scene::{Numbering, Scene};
use std::ops::Range;

use combined::Combined;
use rows::BoundedNodes;

/// Σ coefficient · w and an offset.
pub type LayoutTerms = (Vec<(u64, f64)>, f64);

/// The layout of w.
pub struct UnknownLayout<'a> {
    scene: &'a Scene,
    /// The numbering of the free dofs.
    numbering: Numbering,
    components: usize,
    /// Positions in the numbering at which places for prescribed components are inserted, increasing.
    inserted: Vec<u64>,
    /// The inserted places, increasing.
    filled: Vec<u64>,
    /// The void places, increasing: those inserted, the dependent ones and the supports.
    void: Vec<u64>,
    /// The unknowns that equations between displacements determine.
    eliminated: EliminatedUnknowns,
    /// Supports with their linear forms in the rigid motions.
    supports: Vec<(u64, Functional)>,
    /// Number of rigid motions that nothing holds and for which there is no support.
    pub unsupported: usize,
    /// The frames of nodes at which w is not u.
    frames: BTreeMap<u64, NodeFrame>,
    /// The inequalities between more than two unknowns.
    combined: Combined,
    /// The rigid motions of the bodies.
    pub motions: Motions,
    /// The equations in the rigid motions that ties, equations, springs and prescribed values give.
    pub held: Echelon,
    /// The linear forms of the inequalities in the rigid motions.
    pub forms: Vec<Functional>,
    /// The equations of `held` and `forms` together, without the supports.
    all_held: Echelon,
    /// Why w cannot stand for the problem: inequalities that are no bounds in frames, or an equation that cannot be
    /// solved for an unknown. `None` where it can.
    pub trouble: Option<String>,
}

impl<'a> UnknownLayout<'a> {
    /// The layout of `scene`.
    pub fn new(scene: &'a Scene) -> UnknownLayout<'a> {
        let motions = Motions::new(scene);
        let held = motions.held(scene);
        let mut layout = UnknownLayout {
            scene,
            numbering: Numbering::new(scene),
            components: scene.components(),
            inserted: Vec::new(),
            filled: Vec::new(),
            void: Vec::new(),
            eliminated: EliminatedUnknowns::default(),
            supports: Vec::new(),
            unsupported: 0,
            frames: BTreeMap::new(),
            combined: Combined::default(),
            all_held: held.clone(),
            motions,
            held,
            forms: Vec::new(),
            trouble: None,
        };
        layout.fill();
        let rows = scene.solver_rows(&|_| true);
        let inequalities: Vec<&Row> = rows.iter().filter(|r| r.law.is_decided()).collect();
        for row in &inequalities {
            let form = layout.motions.of_terms(scene, &row.terms);
            layout.all_held.insert(&form, 0.0);
            layout.forms.push(form);
        }
        let bounded = layout.bounded(&inequalities);
        layout.eliminate(&rows, &bounded);
        layout.turn(&inequalities, &bounded);
        layout.combine(&inequalities);
        layout.support(&bounded);
        layout
    }

    /// Inserts places for the prescribed components of nodes that are only partly prescribed.
    fn fill(&mut self) {
        let c = self.components;
        if c == 1 {
            return;
        }
        // (number of a free dof of the node, its prescribed components)
        let mut nodes: Vec<(u64, Vec<usize>)> = Vec::new();
        for (b, body) in self.scene.bodies.iter().enumerate() {
            for given in body.prescribed.chunk_by(|p, q| p.0 / c == q.0 / c) {
                if given.len() == c {
                    continue;
                }
                let node = given[0].0 / c;
                let is_given = |k: usize| given.iter().any(|g| g.0 % c == k);
                let number = |k: usize| {
                    self.numbering
                        .global(body.first_dof + (node * c + k) as u64)
                };
                let free: Vec<usize> = (0..c).filter(|&k| !is_given(k)).collect();
                let first = number(free[0]);
                let (owner, of_owner, _) = self.numbering.place(first);
                // The copies of a tied node share one place.
                if (owner, of_owner) != (b, node) {
                    continue;
                }
                for k in (0..c).filter(|&k| is_given(k)) {
                    let next = free.iter().find(|&&f| f > k);
                    let before =
                        next.map_or_else(|| number(free[free.len() - 1]) + 1, |&f| number(f));
                    self.inserted.push(before);
                }
                nodes.push((first, (0..c).filter(|&k| is_given(k)).collect()));
            }
        }
        self.inserted.sort_unstable();
        for (first, given) in nodes {
            let block = self.moved(first) / c as u64;
            self.filled
                .extend(given.iter().map(|&k| block * c as u64 + k as u64));
        }
        self.filled.sort_unstable();
        self.void.clone_from(&self.filled);
    }

    /// Chooses supports for the rigid motions that nothing holds: beside the nodes in inequalities, or there along
    /// components that no inequality bounds.
    fn support(&mut self, bounded: &BoundedNodes) {
        let loose = self.motions.len() - self.all_held.rank();
        if loose == 0 {
            return;
        }
        let c = self.components as u64;
        let mut candidates: Vec<(u64, Functional)> = Vec::new();
        let mut beside_rows: Vec<(u64, Functional)> = Vec::new();
        for (b, body) in self.scene.bodies.iter().enumerate() {
            let mesh = body.mesh();
            for node in mesh.boundary() {
                for k in 0..self.components {
                    let inside = node * self.components + k;
                    if body.prescribed_at(inside).is_some() {
                        continue;
                    }
                    let at = self.index(body.first_dof + inside as u64);
                    let taken =
                        self.eliminated.get(at).is_some() || self.combined.get(at).is_some();
                    if taken {
                        continue;
                    }
                    let form = self.motions.form(b, body.spec.position(node), k);
                    match bounded.get(&(at / c)) {
                        None => candidates.push((at, form)),
                        Some(of) if self.frames.contains_key(&(at / c)) || of.bounds(k) => {}
                        Some(_) => beside_rows.push((at, form)),
                    }
                }
            }
        }
        candidates.extend(beside_rows);
        self.supports = self.all_held.complete(self.motions.len(), &candidates);
        self.unsupported = loose - self.supports.len();
        self.void.extend(self.supports.iter().map(|s| s.0));
        self.void.sort_unstable();
    }

    /// Centre and radius of a ball that contains the scene.
    pub fn ball(&self) -> ([f64; 3], f64) {
        let bounds = self.scene.bodies.iter().map(|b| b.bounds);
        let bounds = bounds.fold([[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]], |a, b| {
            let low = [0, 1, 2].map(|d| a[0][d].min(b[0][d]));
            [low, [0, 1, 2].map(|d| a[1][d].max(b[1][d]))]
        });
        ball(bounds)
    }

    /// Number of rigid motions that nothing in the scene holds.
    pub fn loose(&self) -> usize {
        self.supports.len()
    }

    /// The supports: places that are set to zero to remove free rigid motions, increasing.
    pub fn supports(&self) -> Vec<u64> {
        let mut places: Vec<u64> = self.supports.iter().map(|s| s.0).collect();
        places.sort_unstable();
        places
    }

    /// The scene.
    pub fn scene(&self) -> &'a Scene {
        self.scene
    }

    fn frame(&self, block: u64) -> &NodeFrame {
        self.frames.get(&block).unwrap_or(&NodeFrame::IDENTITY)
    }

    /// Length of w.
    pub fn len(&self) -> usize {
        self.numbering.len() as usize + self.inserted.len()
    }

    /// Number C of components.
    pub fn components(&self) -> usize {
        self.components
    }

    fn moved(&self, number: u64) -> u64 {
        number + self.inserted.partition_point(|&p| p <= number) as u64
    }

    /// The place in w of a free body dof.
    pub fn index(&self, body_dof: u64) -> u64 {
        self.moved(self.numbering.global(body_dof))
    }

    /// The places of the nodes that the subdomains `share` own.
    pub fn range(&self, share: Range<usize>) -> Range<usize> {
        let numbers = self.numbering.range(share);
        self.block_start(numbers.start)..self.block_start(numbers.end)
    }

    fn block_start(&self, number: u64) -> usize {
        if number == self.numbering.len() {
            return self.len();
        }
        self.moved(number) as usize / self.components * self.components
    }

    /// The places of a rank if nodes are dealt out in equal shares.
    pub fn share(&self, ranks: usize, rank: usize) -> Range<usize> {
        let nodes = parallel::contiguous_share(self.len() / self.components, ranks, rank);
        nodes.start * self.components..nodes.end * self.components
    }

    /// Void places, increasing.
    pub fn void(&self) -> &[u64] {
        &self.void
    }

    /// Whether a void place is none of a dof: that of a prescribed component.
    pub fn is_inserted(&self, index: u64) -> bool {
        self.filled.binary_search(&index).is_ok()
    }

    /// The void places of the node of place `index`.
    pub fn void_beside(&self, index: u64) -> &[u64] {
        let c = self.components as u64;
        let first = index / c * c;
        let at = |i: u64| self.void.partition_point(|&v| v < i);
        &self.void[at(first)..at(first + c)]
    }

    /// u at place `index` as Σ coefficient · w and an offset.
    pub fn terms(&self, index: u64) -> LayoutTerms {
        let (turned, mut offset) = match self.eliminated.get(index) {
            None => (self.turned(index), 0.0),
            Some((terms, offset)) => {
                let turned = |(&place, t): (&u64, &f64)| {
                    let list = self.turned(place).into_iter();
                    list.map(|(w, v)| (w, t * v)).collect::<Vec<_>>()
                };
                (terms.iter().flat_map(turned).collect(), offset)
            }
        };
        if turned.iter().all(|t| self.combined.get(t.0).is_none()) {
            return (turned, offset);
        }
        let mut out: BTreeMap<u64, f64> = BTreeMap::new();
        for (place, t) in turned {
            match self.combined.get(place) {
                None => *out.entry(place).or_default() += t,
                Some((terms, its)) => {
                    offset += t * its;
                    let each = terms.iter();
                    each.for_each(|&(w, v)| *out.entry(w).or_default() += t * v);
                }
            }
        }
        (out.into_iter().collect(), offset)
    }

    /// Whether u at some node is a combination of w at others.
    pub fn has_dependent(&self) -> bool {
        !self.eliminated.is_empty() || !self.combined.is_empty()
    }

    /// u at a place that is not dependent as Σ coefficient · w.
    fn turned(&self, index: u64) -> Vec<(u64, f64)> {
        let c = self.components as u64;
        let Some(frame) = self.frames.get(&(index / c)) else {
            return vec![(index, 1.0)];
        };
        let row = frame.from[(index % c) as usize];
        let entries = (0..self.components).map(|k| (index / c * c + k as u64, row[k]));
        entries.filter(|e| e.1 != 0.0).collect()
    }

    /// Position of a node.
    pub fn position(&self, block: u64) -> [f64; 3] {
        let (body, node) = self.node(block);
        self.scene.bodies[body].spec.position(node)
    }

    /// The body of a node, and its number there.
    fn node(&self, block: u64) -> (usize, usize) {
        let first = block * self.components as u64;
        let at = (first..).find(|i| self.filled.binary_search(i).is_err());
        let at = at.expect("a node has a free component");
        let before = self.filled.partition_point(|&v| v < at) as u64;
        let (body, node, _) = self.numbering.place(at - before);
        (body, node)
    }

    /// The six rigid motions of the whole scene as values of w at place `index`, void or not. `centre`, `scale`: as in
    /// `rigid_motions`.
    pub fn motions_at(&self, index: u64, centre: [f64; 3], scale: f64) -> [f64; 6] {
        let c = self.components as u64;
        let at = |block: u64| {
            let x = self.position(block);
            elements::cell::rigid_motions(self.scene.dim(), centre, scale, x)
        };
        if let Some(row) = self.combined.row_at(index) {
            let mut sum = [0.0; 6];
            for &(place, b) in row {
                let motions = at(place / c);
                sum.iter_mut()
                    .zip(motions)
                    .for_each(|(s, m)| *s += b * m[(place % c) as usize]);
            }
            return sum;
        }
        let row = self.frame(index / c).to[(index % c) as usize];
        at(index / c).map(|m| (0..3).map(|k| row[k] * m[k]).sum())
    }
}

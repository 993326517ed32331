//! The unknowns w of the assembled problem of a scene: node by node, C components each.
//!
//! ```text
//!     Numbering (free dofs) ── blocks of C ──> u ── w = M u at nodes in contact ──> w, what systems and files hold
//! ```
//!
//! A node with some components prescribed keeps places for them, in which w = 0 with a row of its own (*void* places):
//! multigrid for elasticity needs all components of a node. Supports are void, too: where ties, springs, prescribed
//! values and inequalities together leave rigid motions free, as many dofs are set to zero. Under a balanced load these
//! supports bear no force.

use std::collections::BTreeMap;

use super::frame::{parallel, Frame};
use super::motions::{Echelon, Functional, Motions};
use crate::linalg::vec3::{ball, norm};
use crate::parallel::exchange::sum_all;
use crate::petsc::{Session, Vec as PetscVec};
use crate::scene::{Numbering, Scene};
use crate::substructures::{InterfaceRow, RowKind};
use crate::Result;
use std::ops::Range;

/// The layout of w.
pub struct Layout<'a> {
    scene: &'a Scene,
    /// The numbering of the free dofs.
    numbering: Numbering,
    components: usize,
    /// Positions in the numbering at which places for prescribed components are inserted, increasing.
    inserted: Vec<u64>,
    /// The inserted places, increasing.
    filled: Vec<u64>,
    /// The void places, increasing: those inserted and the supports.
    void: Vec<u64>,
    /// Supports with their linear forms in the rigid motions.
    supports: Vec<(u64, Functional)>,
    /// The frames of nodes at which w is not u.
    frames: BTreeMap<u64, Frame>,
    /// The rigid motions of the bodies.
    pub motions: Motions,
    /// The equations in the rigid motions that ties, springs and prescribed values give.
    pub held: Echelon,
    /// The linear forms of the inequalities in the rigid motions.
    pub forms: Vec<Functional>,
    /// The equations of `held` and `forms` together, without the supports.
    all_held: Echelon,
    /// Why w cannot stand for the problem: inequalities that are no bounds in frames, or equations beside ties. `None`
    /// where it can.
    pub trouble: Option<String>,
}

impl<'a> Layout<'a> {
    /// The layout of `scene`.
    pub fn new(scene: &'a Scene) -> Layout<'a> {
        let motions = Motions::new(scene);
        let held = motions.held(scene);
        let mut layout = Layout {
            scene,
            numbering: Numbering::new(scene),
            components: scene.components(),
            inserted: Vec::new(),
            filled: Vec::new(),
            void: Vec::new(),
            supports: Vec::new(),
            frames: BTreeMap::new(),
            all_held: held.clone(),
            motions,
            held,
            forms: Vec::new(),
            trouble: trouble(scene),
        };
        layout.fill();
        let rows = scene.rows(&|_| true);
        let inequalities: Vec<&InterfaceRow> = rows
            .iter()
            .filter(|r| r.kind == RowKind::Inequality)
            .collect();
        for row in &inequalities {
            let form = layout.motions.of_terms(scene, &row.terms);
            layout.all_held.insert(&form, 0.0);
            layout.forms.push(form);
        }
        layout.turn(&inequalities);
        layout.support(&inequalities);
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

    /// Computes the frames of the nodes in inequalities.
    fn turn(&mut self, rows: &[&InterfaceRow]) {
        let mut directions: BTreeMap<u64, Vec<[f64; 3]>> = BTreeMap::new();
        for row in rows {
            for (block, direction) in self.ends(row).0 {
                let list = directions.entry(block).or_default();
                if !list.iter().any(|d| parallel(*d, direction)) {
                    list.push(upright(direction));
                }
            }
        }
        for (block, list) in directions {
            let c = self.components as u64;
            let free =
                [0, 1, 2].map(|k| k < c && self.void.binary_search(&(block * c + k)).is_err());
            match Frame::new(&list, free) {
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
                            x[0],
                            x[1],
                            x[2],
                            list.len()
                        )
                    });
                }
            }
        }
        for row in rows {
            if self.trouble.is_none() && self.bound(row).is_none() {
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

    /// Chooses supports for the rigid motions that nothing holds.
    fn support(&mut self, rows: &[&InterfaceRow]) {
        let loose = self.motions.len() - self.all_held.rank();
        if loose == 0 {
            return;
        }
        let c = self.components as u64;
        let in_rows: std::collections::HashSet<u64> = rows
            .iter()
            .flat_map(|row| self.ends(row).0)
            .map(|(block, _)| block)
            .collect();
        let mut candidates: Vec<(u64, Functional)> = Vec::new();
        for (b, body) in self.scene.bodies.iter().enumerate() {
            let mesh = body.mesh();
            for node in mesh.boundary() {
                for k in 0..self.components {
                    let inside = node * self.components + k;
                    if body.prescribed_at(inside).is_some() {
                        continue;
                    }
                    let at = self.index(body.first_dof + inside as u64);
                    if in_rows.contains(&(at / c)) {
                        continue;
                    }
                    candidates.push((at, self.motions.form(b, body.spec.position(node), k)));
                }
            }
        }
        self.supports = self.all_held.complete(self.motions.len(), &candidates);
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

    /// The nodes of a row, each with the vector whose product with u the row takes. All vectors are divided by the
    /// length of the first, which is returned as well.
    pub fn ends(&self, row: &InterfaceRow) -> (Vec<(u64, [f64; 3])>, f64) {
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

    /// A row as w_plus − w_minus ≤ gap / scale: (plus, minus, scale). `None` if it does not have this form.
    pub fn bound(&self, row: &InterfaceRow) -> Option<([Option<u64>; 2], f64)> {
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

    fn frame(&self, block: u64) -> &Frame {
        self.frames.get(&block).unwrap_or(&Frame::IDENTITY)
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
        let nodes = crate::mesh::contiguous_share(self.len() / self.components, ranks, rank);
        nodes.start * self.components..nodes.end * self.components
    }

    /// Void places, increasing.
    pub fn void(&self) -> &[u64] {
        &self.void
    }

    /// The void places of the node of place `index`.
    pub fn void_beside(&self, index: u64) -> &[u64] {
        let c = self.components as u64;
        let first = index / c * c;
        let at = |i: u64| self.void.partition_point(|&v| v < i);
        &self.void[at(first)..at(first + c)]
    }

    /// u at place `index` as Σ coefficient · w.
    pub fn terms(&self, index: u64) -> Vec<(u64, f64)> {
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
        let x = self.position(index / c);
        let motions = crate::fem::cell::rigid_motions(self.scene.dim(), centre, scale, x);
        let row = self.frame(index / c).to[(index % c) as usize];
        motions.map(|m| (0..3).map(|k| row[k] * m[k]).sum())
    }

    /// Converts u, found by a method without supports and frames, to w: subtracts the rigid motions that the supports
    /// exclude, and changes to the coordinates of the frames. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn settle(&self, session: &Session, u: &PetscVec) -> Result<()> {
        let range = u.ownership_range();
        let c = self.components;
        if !self.supports.is_empty() {
            let mut values = vec![0.0; self.supports.len()];
            {
                let u = u.array()?;
                for (value, (at, _)) in values.iter_mut().zip(&self.supports) {
                    if range.contains(&(*at as usize)) {
                        *value = u[*at as usize - range.start];
                    }
                }
            }
            sum_all(session.comm(), &mut values);
            let mut equations = self.all_held.clone();
            for ((_, form), value) in self.supports.iter().zip(&values) {
                equations.insert(form, *value);
            }
            let alpha = equations.solve(self.motions.len());
            let mut u = u.array_mut()?;
            for i in range.clone() {
                if self.filled.binary_search(&(i as u64)).is_ok() {
                    continue;
                }
                let (body, node) = self.node((i / c) as u64);
                let x = self.scene.bodies[body].spec.position(node);
                let form = self.motions.form(body, x, i % c);
                u[i - range.start] -= form.iter().map(|&(k, v)| v * alpha[k]).sum::<f64>();
            }
        }
        let mut u = u.array_mut()?;
        for (&block, frame) in &self.frames {
            let first = block as usize * c;
            if range.contains(&first) {
                let at = first - range.start;
                let old: Vec<f64> = u[at..at + c].to_vec();
                for k in 0..c {
                    u[at + k] = (0..c).map(|j| frame.to[k][j] * old[j]).sum();
                }
            }
        }
        Ok(())
    }
}

/// Equations with any number of terms tie w in a way that numbering nodes once does not.
fn trouble(scene: &Scene) -> Option<String> {
    let n = scene.equations.len();
    let named = match n {
        0 => return None,
        1 => "one equation".into(),
        n => format!("{n} equations"),
    };
    Some(format!(
        "it has {named} between displacements (*EQUATION), and the assembled problem knows ties only"
    ))
}

/// Of a direction and its opposite, the one whose first nonzero entry is positive.
fn upright(d: [f64; 3]) -> [f64; 3] {
    let first = d.iter().find(|v| v.abs() > 1e-6).copied().unwrap_or(1.0);
    d.map(|v| v * first.signum() + 0.0)
}

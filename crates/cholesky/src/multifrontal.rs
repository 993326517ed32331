//! Partial Cholesky factorisation of one subdomain: interior eliminated, interface kept.
//!
//! With K ordered [interior I, interface Γ],
//!
//! ```text
//!     K = [ L_II      ] [ I     ] [ L_IIᵀ  L_ΓIᵀ ]        S = K_ΓΓ − K_ΓI K_II⁻¹ K_IΓ
//!         [ L_ΓI   I  ] [     S ] [          I   ]
//! ```
//!
//! The multifrontal method (Duff and Reid 1983): each node of the elimination tree is a dense front, and a front's
//! Schur complement is added into its parent's front. The sum that reaches the root is S itself. S is never factored
//! here, hence a singular (floating) subdomain needs no special treatment.

use std::sync::Arc;

use super::front::{factor_front, factor_semidefinite};
use super::panel;
use super::strips::SchurUpdate;
use super::symbolic::{Symbolic, ABSENT};
use crate::strips;
use base::linalg::csr::Csr;
use base::linalg::dense::{Dense, Scratch};

/// A pivot below this fraction of the diagonal entry it came from counts as zero. Rounding leaves about 1e-16 times the
/// number of updates; a body held by a spring of 1e-8 of its stiffness has pivots of 1e-8.
pub(crate) const SINGULAR: f64 = 1e-13;

/// The interior block is singular: part of the subdomain touches neither a Dirichlet boundary nor the interface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SingularInterior {
    /// The dof whose pivot vanished.
    pub dof: u32,
}

/// The factor [L_II; L_ΓI] of one subdomain, or L_II alone.
#[derive(Debug)]
pub struct PartialCholesky {
    pub(crate) symbolic: Arc<Symbolic>,
    pub(crate) panels: Vec<f64>,
    /// The smallest pivot relative to the diagonal entry that it came from; one where nothing was eliminated.
    pub(crate) weakest: f64,
}

impl PartialCholesky {
    /// Factors the interior of `k` and returns the factor with S (both triangles), in the order of the interface.
    pub fn new(k: &Csr, symbolic: Arc<Symbolic>) -> Result<(Self, Dense), SingularInterior> {
        PartialCholesky::inside(k, &symbolic, symbolic.clone())
    }

    /// Factors the interior of `k` and returns the factor with S, but stores only the part of the factor that `inside`
    /// lists: without the rows of the interface it can [`solve`](Self::solve), but not condense.
    pub fn inside(
        k: &Csr,
        symbolic: &Symbolic,
        inside: Arc<Symbolic>,
    ) -> Result<(Self, Dense), SingularInterior> {
        factor(k, symbolic, inside, Pivots::Regular)
    }

    /// The factor of a semidefinite `k` without an interface, and the dofs that it leaves out: those with a pivot below
    /// this fraction of their diagonal entry. Such a pivot becomes so large that the solution at the dof is zero after
    /// rounding, and that of the others is the solution without the dof.
    pub fn semidefinite(k: &Csr, symbolic: Arc<Symbolic>, least: f64) -> (Self, Vec<u32>) {
        debug_assert!(symbolic.interface.is_empty());
        let mut left = Vec::new();
        let pivots = Pivots::Above(least, &mut left);
        let made = factor(k, &symbolic.clone(), symbolic, pivots);
        (made.expect("no pivot is too small").0, left)
    }

    /// Number of dofs.
    pub fn n(&self) -> usize {
        self.symbolic.n()
    }

    /// The smallest pivot relative to the diagonal entry that it came from, at most one. Of a shared factor it is that
    /// of the own fronts.
    pub fn weakest_pivot(&self) -> f64 {
        self.weakest
    }

    /// The dofs with a pivot below `bound`, relative to the diagonal entry of `k` that it came from, in the order of
    /// elimination.
    pub fn weak_dofs(&self, k: &Csr, bound: f64) -> Vec<u32> {
        let weak = self.relative_pivots(k).filter(|p| p.1 < bound);
        weak.map(|p| p.0).collect()
    }

    /// (dof, pivot relative to the diagonal entry of `k` that it came from), in the order of elimination.
    fn relative_pivots<'a>(&'a self, k: &'a Csr) -> impl Iterator<Item = (u32, f64)> + 'a {
        self.symbolic.fronts.iter().flat_map(move |front| {
            let panel = &self.panels[front.panel..];
            let (width, size) = (front.width(), front.size());
            let dofs = &self.symbolic.interior[front.start..front.end];
            dofs.iter().enumerate().map(move |(j, &dof)| {
                let d = k.get(dof as usize, dof as usize);
                (dof, panel[panel::diagonal(j, width, size)].powi(2) / d)
            })
        })
    }

    /// Bytes held by the factor.
    pub fn bytes(&self) -> usize {
        self.panels.len() * std::mem::size_of::<f64>()
    }
}

/// Pivots that vanish.
pub(super) enum Pivots<'a> {
    /// None may.
    Regular,
    /// Pivots below this fraction of the diagonal entry are replaced; the list takes their dofs.
    Above(f64, &'a mut Vec<u32>),
}

/// Returns the factor with the fronts in `kept`, and S.
fn factor(
    k: &Csr,
    sym: &Symbolic,
    kept: Arc<Symbolic>,
    mut pivots: Pivots<'_>,
) -> Result<(PartialCholesky, Dense), SingularInterior> {
    let mut elimination = Elimination::new(k, sym, &kept);
    for f in 0..sym.fronts.len() {
        elimination.front(f, &mut pivots, &mut || ())?;
    }
    let (panels, weakest, mut s) = (elimination.panels, elimination.weakest, elimination.s);
    s.mirror_lower();
    let factor = PartialCholesky {
        symbolic: kept,
        panels,
        weakest,
    };
    Ok((factor, s))
}

/// A factorisation on its way from the leaves to the root.
pub(super) struct Elimination<'a> {
    k: &'a Csr,
    sym: &'a Symbolic,
    kept: &'a Symbolic,
    /// The panels of the fronts in `kept`.
    pub panels: Vec<f64>,
    /// The smallest pivot so far, relative to the diagonal entry that it came from.
    pub weakest: f64,
    /// S so far.
    s: Dense,
    /// Updates of fronts for their parents: lower triangles of the rows below, until the parents take them.
    updates: Vec<SchurUpdate>,
    /// Memory of updates that parents have taken.
    spare: Vec<Vec<f64>>,
    children: Vec<Vec<usize>>,
    place: Vec<u32>,
    /// The panel of the front that is eliminated. It keeps its memory from front to front.
    room: Dense,
    scratch: Scratch,
}

impl<'a> Elimination<'a> {
    pub fn new(k: &'a Csr, sym: &'a Symbolic, kept: &'a Symbolic) -> Elimination<'a> {
        let largest = sym.fronts.iter().map(|f| f.width() * f.size()).max();
        let mut room = Dense::default();
        room.data.reserve_exact(largest.unwrap_or(0));
        Elimination {
            k,
            sym,
            kept,
            panels: Vec::with_capacity(kept.storage),
            weakest: 1.0,
            s: schur_start(k, sym),
            updates: sym.fronts.iter().map(|_| SchurUpdate::default()).collect(),
            spare: Vec::new(),
            children: vec![Vec::new(); sym.fronts.len()],
            place: vec![0u32; k.n()],
            room,
            scratch: Scratch::default(),
        }
    }

    /// Takes the update that front `f` leaves to its parent: the lower triangle, column by column.
    pub fn take_schur_complement(&mut self, f: usize) -> Vec<f64> {
        let front = &self.sym.fronts[f];
        let siblings = &mut self.children[front.parent.expect("there is a parent")];
        siblings.retain(|&c| c != f);
        let update = std::mem::take(&mut self.updates[f]);
        let packed = update.packed(front.below.len());
        self.spare.push(update.into_memory());
        packed
    }

    /// Gives front `f` this update, a lower triangle column by column, as if it had been eliminated here.
    pub fn put_schur_complement(&mut self, f: usize, update: Vec<f64>) {
        let parent = self.sym.fronts[f].parent;
        self.children[parent.expect("there is a parent")].push(f);
        self.updates[f] = SchurUpdate::Packed(update);
    }

    /// Eliminates front `f`, the next one in `kept`; its children have been. `pause` is called now and then if the
    /// front is large.
    pub fn front(
        &mut self,
        f: usize,
        pivots: &mut Pivots<'_>,
        pause: &mut dyn FnMut(),
    ) -> Result<(), SingularInterior> {
        let (k, sym) = (self.k, self.sym);
        let (front, place) = (&sym.fronts[f], &mut self.place);
        let (width, size) = (front.width(), front.size());
        let panel = &mut self.room;
        panel.become_zero(size, width);
        let order = size - width;
        let mut update = strips::room_for(&mut self.spare, strips::length(order));

        for (l, &p) in front.below.iter().enumerate() {
            place[p as usize] = (width + l) as u32;
        }
        let mut diagonal = vec![0.0; width];
        for (j, diagonal) in diagonal.iter_mut().enumerate() {
            let dof = sym.interior[front.start + j] as usize;
            let column = panel.col_mut(j);
            let (col, val) = k.row(dof);
            // The pattern need not have the place of an entry that vanishes.
            for (&i, &v) in col.iter().zip(val).filter(|e| *e.1 != 0.0) {
                let p = sym.position[i as usize];
                // What is not here has been eliminated before.
                if p == ABSENT {
                    continue;
                }
                let p = p as usize;
                if p >= front.end {
                    column[place[p] as usize] += v;
                } else if p >= front.start + j {
                    column[p - front.start] += v;
                }
                if i as usize == dof {
                    *diagonal = v;
                }
            }
        }
        // The order in which they are added does not depend on who has eliminated them.
        self.children[f].sort_unstable();
        for &c in &self.children[f] {
            add_to_panel(panel, &sym.fronts[c].into_parent, &self.updates[c]);
        }
        let scratch = &mut self.scratch;
        match pivots {
            Pivots::Regular => {
                let done = factor_front(panel, &mut update, &diagonal, SINGULAR, scratch, pause);
                done.map_err(|j| SingularInterior {
                    dof: sym.interior[front.start + j],
                })?;
            }
            Pivots::Above(least, left) => {
                let weak =
                    factor_semidefinite(panel, &mut update, &diagonal, *least, scratch, pause);
                left.extend(weak.iter().map(|&j| sym.interior[front.start + j]));
            }
        }
        for (j, d) in diagonal.iter().enumerate() {
            self.weakest = self.weakest.min(panel.get(j, j).powi(2) / d);
        }
        for &c in &self.children[f] {
            let left = std::mem::take(&mut self.updates[c]);
            add_to_update(
                &mut update,
                (width, order),
                &sym.fronts[c].into_parent,
                &left,
            );
            self.spare.push(left.into_memory());
        }
        let into = &self.kept.fronts[f];
        debug_assert_eq!(into.panel, self.panels.len());
        if into.width() > 0 {
            panel::append(&panel.data, size, width, into.size(), &mut self.panels);
        }
        match front.parent {
            Some(t) => {
                self.updates[f] = SchurUpdate::Strips(update);
                self.children[t].push(f);
            }
            None => {
                let update = SchurUpdate::Strips(update);
                add_to_s(&mut self.s, &front.into_parent, &update);
                self.spare.push(update.into_memory());
            }
        }
        Ok(())
    }
}

/// The lower triangle of K_ΓΓ, where S starts.
fn schur_start(k: &Csr, sym: &Symbolic) -> Dense {
    let n = sym.interface.len();
    let offset = sym.n_interior() as u32;
    let mut s = Dense::zeros(n, n);
    for (j, &dof) in sym.interface.iter().enumerate() {
        let (col, val) = k.row(dof as usize);
        for (&i, &v) in col.iter().zip(val) {
            let p = sym.position[i as usize];
            if p >= offset + j as u32 {
                s.data[(p - offset) as usize + j * n] += v;
            }
        }
    }
    s
}

/// Adds the columns of a child's update that are pivots of its parent.
fn add_to_panel(panel: &mut Dense, map: &[u32], child: &SchurUpdate) {
    let inside = map.partition_point(|&i| (i as usize) < panel.cols);
    let runs = runs(map);
    for (j, &into) in map[..inside].iter().enumerate() {
        let of_child = child.column(map.len(), j);
        add_column(panel.col_mut(into as usize), 0, &runs, (j, of_child));
    }
}

/// Adds the other columns, to the update of a parent with `width` pivots and `order` rows below them.
fn add_to_update(
    update: &mut [f64],
    (width, order): (usize, usize),
    map: &[u32],
    child: &SchurUpdate,
) {
    let inside = map.partition_point(|&i| (i as usize) < width);
    let runs = runs(map);
    for (j, &into) in map.iter().enumerate().skip(inside) {
        let of_child = child.column(map.len(), j);
        let into = into as usize;
        let column = strips::column_mut(update, order, into - width);
        add_column(column, into, &runs, (j, of_child));
    }
}

/// Adds column `j` of a child, from its diagonal entry down, to a column whose first row is row `above` of the parent.
fn add_column(
    column: &mut [f64],
    above: usize,
    runs: &[ChildRows],
    (j, of_child): (usize, &[f64]),
) {
    let first = runs.partition_point(|run| run.end <= j);
    for run in &runs[first..] {
        let start = run.start.max(j);
        let to = run.to + (start - run.start) - above;
        let source = &of_child[start - j..run.end - j];
        let sums = column[to..to + source.len()].iter_mut().zip(source);
        sums.for_each(|(sum, v)| *sum += v);
    }
}

/// Rows of a child that stand one after the other in its parent, too.
struct ChildRows {
    start: usize,
    end: usize,
    /// Where the first one stands.
    to: usize,
}

/// The places in the parent, in such parts.
fn runs(map: &[u32]) -> Vec<ChildRows> {
    let mut start = 0;
    let runs = map.chunk_by(|a, b| *b == a + 1).map(|run| {
        let (from, to) = (start, run[0] as usize);
        start += run.len();
        ChildRows {
            start: from,
            end: start,
            to,
        }
    });
    runs.collect()
}

/// Adds an update to S.
fn add_to_s(s: &mut Dense, map: &[u32], update: &SchurUpdate) {
    for (j, &into) in map.iter().enumerate() {
        let column = s.col_mut(into as usize);
        for (&i, &v) in map[j..].iter().zip(update.column(map.len(), j)) {
            column[i as usize] += v;
        }
    }
}

#[cfg(test)]
#[path = "../tests/multifrontal.rs"]
mod tests;

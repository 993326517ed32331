//! Partial Cholesky factorisation of one subdomain: interior eliminated, interface kept.
//!
//! With K ordered [interior I, interface Γ],
//!
//! ```text
//!     K = [ L_II      ] [ I     ] [ L_IIᵀ  L_ΓIᵀ ]        S = K_ΓΓ − K_ΓI K_II⁻¹ K_IΓ
//!         [ L_ΓI   I  ] [     S ] [          I   ]
//! ```
//!
//! The multifrontal method (Duff and Reid 1983): the elimination tree's nodes are dense fronts, a front's
//! Schur complement is added into its parent's front, and what reaches the root is S itself. S is never
//! factored here, so a singular (floating) subdomain needs no special treatment.

use std::sync::Arc;

use super::dense::{self, Dense, Scratch};
use super::dissection::nested_dissection;
use crate::sparse::Csr;

/// A pivot below this fraction of the diagonal entry it came from counts as zero: rounding leaves about 1e-16 times
/// the number of updates, while a body held by a spring of 1e-8 of its stiffness still shows 1e-8.
pub(super) const SINGULAR: f64 = 1e-13;

/// The interior block is singular: part of the subdomain touches neither a boundary condition nor the interface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SingularInterior {
    /// The dof whose pivot vanished.
    pub dof: u32,
}

/// What depends on the pattern alone: elimination order, fronts, index maps.
#[derive(Debug)]
pub struct Symbolic {
    /// Interior dofs in elimination order.
    interior: Vec<u32>,
    /// Interface dofs in the order of S.
    interface: Vec<u32>,
    /// Position of each dof in [interior, interface].
    position: Vec<u32>,
    pub(super) fronts: Vec<Front>,
    /// Length of all panels together.
    storage: usize,
}

#[derive(Debug)]
pub(super) struct Front {
    /// Eliminated positions `start..end`.
    pub(super) start: usize,
    pub(super) end: usize,
    /// Positions below the pivot block, increasing.
    pub(super) below: Vec<u32>,
    /// The front that takes this one's update; `None`: S does.
    parent: Option<usize>,
    /// Place of each entry of `below` in the parent's front (or in S).
    into_parent: Vec<u32>,
    /// Start of this front's panel (end − start columns of size rows) in the storage.
    pub(super) panel: usize,
}

impl Front {
    pub(super) fn width(&self) -> usize {
        self.end - self.start
    }
    pub(super) fn size(&self) -> usize {
        self.width() + self.below.len()
    }
}

impl Symbolic {
    /// Analyses the pattern of `k`; `interface` lists the dofs that are kept, in the order wanted for S.
    pub fn new(k: &Csr, interface: &[u32], coordinates: Option<&[[f64; 3]]>) -> Symbolic {
        let n = k.n();
        let mut kept = vec![false; n];
        interface.iter().for_each(|&i| kept[i as usize] = true);
        let inside: Vec<u32> = (0..n as u32).filter(|&i| !kept[i as usize]).collect();
        let supernodes = nested_dissection(k, &inside, coordinates).supernodes;
        Symbolic::with_supernodes(k, interface, &supernodes)
    }

    /// The same for a given order of the interior: sets of dofs in the order of elimination, each to be one front.
    pub fn with_supernodes(k: &Csr, interface: &[u32], supernodes: &[Vec<u32>]) -> Symbolic {
        let n = k.n();
        let interior: Vec<u32> = supernodes.iter().flatten().copied().collect();
        let mut position = vec![0; n];
        for (p, &i) in interior.iter().chain(interface).enumerate() {
            position[i as usize] = p as u32;
        }
        let mut front_of = vec![0u32; interior.len()];
        let mut start = 0;
        for (s, set) in supernodes.iter().enumerate() {
            front_of[start..start + set.len()].fill(s as u32);
            start += set.len();
        }

        let mut fronts: Vec<Front> = Vec::with_capacity(supernodes.len());
        let mut children: Vec<Vec<usize>> = vec![Vec::new(); supernodes.len()];
        let mut seen = vec![u32::MAX; n];
        let (mut start, mut storage) = (0, 0);
        for (s, set) in supernodes.iter().enumerate() {
            let end = start + set.len();
            let mut below = Vec::new();
            let mut add = |p: u32| {
                if p as usize >= end && seen[p as usize] != s as u32 {
                    seen[p as usize] = s as u32;
                    below.push(p);
                }
            };
            for &i in set {
                k.row(i as usize)
                    .0
                    .iter()
                    .for_each(|&j| add(position[j as usize]));
            }
            for &c in &children[s] {
                fronts[c].below.iter().for_each(|&p| add(p));
            }
            below.sort_unstable();
            let parent = below
                .first()
                .filter(|&&p| (p as usize) < interior.len())
                .map(|&p| front_of[p as usize] as usize);
            if let Some(parent) = parent {
                children[parent].push(s);
            }
            let front = Front {
                start,
                end,
                below,
                parent,
                into_parent: Vec::new(),
                panel: storage,
            };
            storage += front.size() * front.width();
            fronts.push(front);
            start = end;
        }
        for s in 0..fronts.len() {
            let map = match fronts[s].parent {
                None => fronts[s]
                    .below
                    .iter()
                    .map(|&p| p - interior.len() as u32)
                    .collect(),
                Some(t) => place_in(&fronts[s].below, &fronts[t]),
            };
            fronts[s].into_parent = map;
        }
        Symbolic {
            interior,
            interface: interface.to_vec(),
            position,
            fronts,
            storage,
        }
    }

    /// Of a factor that was made elsewhere: fronts as (first column, number of columns, rows below), the columns of all of them together
    /// being the interior. Good for solves alone.
    pub(super) fn of_factor(
        interior: Vec<u32>,
        interface: &[u32],
        fronts: impl Iterator<Item = (usize, usize, Vec<u32>)>,
    ) -> Symbolic {
        let mut position = vec![0; interior.len() + interface.len()];
        for (p, &i) in interior.iter().chain(interface).enumerate() {
            position[i as usize] = p as u32;
        }
        let mut storage = 0;
        let fronts = fronts
            .map(|(start, width, below)| {
                let panel = storage;
                storage += width * (width + below.len());
                Front {
                    start,
                    end: start + width,
                    below,
                    parent: None,
                    into_parent: Vec::new(),
                    panel,
                }
            })
            .collect();
        Symbolic {
            interior,
            interface: interface.to_vec(),
            position,
            fronts,
            storage,
        }
    }

    /// Number of dofs.
    pub(super) fn n(&self) -> usize {
        self.position.len()
    }

    /// The dofs in the order [interior, interface].
    pub(super) fn dofs(&self) -> impl Iterator<Item = u32> + '_ {
        self.interior.iter().chain(&self.interface).copied()
    }

    /// Number of interior dofs.
    pub fn n_interior(&self) -> usize {
        self.interior.len()
    }

    /// Multiplications and additions of the factorisation, S included.
    pub fn flops(&self) -> f64 {
        let of = |front: &Front| {
            let (w, m) = (front.width() as f64, front.below.len() as f64);
            w.powi(3) / 3.0 + w * w * m + w * m * m
        };
        self.fronts.iter().map(of).sum()
    }

    /// Entries of the factor, for memory estimates.
    pub fn factor_entries(&self) -> usize {
        self.storage
    }
}

/// Where the sorted positions `rows` stand in the front `t` that contains them all.
fn place_in(rows: &[u32], t: &Front) -> Vec<u32> {
    let mut next = 0;
    rows.iter()
        .map(|&p| {
            if (p as usize) < t.end {
                return p - t.start as u32;
            }
            while t.below[next] != p {
                next += 1;
            }
            (t.width() + next) as u32
        })
        .collect()
}

/// The factor [L_II; L_ΓI] of one subdomain.
#[derive(Debug)]
pub struct PartialCholesky {
    pub(super) symbolic: Arc<Symbolic>,
    pub(super) panels: Vec<f64>,
}

impl PartialCholesky {
    /// Factors the interior of `k` and returns the factor with S (both triangles), in the order of the interface.
    pub fn new(k: &Csr, symbolic: Arc<Symbolic>) -> Result<(Self, Dense), SingularInterior> {
        let sym = &*symbolic;
        let mut s = schur_start(k, sym);
        let mut panels = vec![0.0; sym.storage];
        let mut updates: Vec<Vec<f64>> = vec![Vec::new(); sym.fronts.len()];
        let mut children: Vec<Vec<usize>> = vec![Vec::new(); sym.fronts.len()];
        let mut place = vec![0u32; k.n()];
        let mut scratch = Scratch::default();
        for (f, front) in sym.fronts.iter().enumerate() {
            let (width, size) = (front.width(), front.size());
            let mut panel = Dense::zeros(size, width);
            let mut update = Dense::zeros(size - width, size - width);

            for (l, &p) in front.below.iter().enumerate() {
                place[p as usize] = (width + l) as u32;
            }
            for j in 0..width {
                let dof = sym.interior[front.start + j] as usize;
                let column = panel.col_mut(j);
                let (col, val) = k.row(dof);
                for (&i, &v) in col.iter().zip(val) {
                    let p = sym.position[i as usize] as usize;
                    if p >= front.end {
                        column[place[p] as usize] += v;
                    } else if p >= front.start + j {
                        column[p - front.start] += v;
                    }
                }
            }
            let diagonal: Vec<f64> = (0..width)
                .map(|j| {
                    let dof = sym.interior[front.start + j] as usize;
                    k.get(dof, dof)
                })
                .collect();
            for &c in &children[f] {
                let child = &sym.fronts[c];
                extend_add(&mut panel, &mut update, &child.into_parent, &updates[c]);
                updates[c] = Vec::new();
            }
            factor_front(&mut panel, &mut update, &diagonal, &mut scratch).map_err(|j| {
                SingularInterior {
                    dof: sym.interior[front.start + j],
                }
            })?;
            panels[front.panel..front.panel + size * width].copy_from_slice(&panel.data);
            match front.parent {
                Some(t) => {
                    updates[f] = update.data;
                    children[t].push(f);
                }
                None => add_lower(&mut s, &front.into_parent, &update.data),
            }
        }
        s.mirror_lower();
        Ok((PartialCholesky { symbolic, panels }, s))
    }

    /// Number of dofs.
    pub fn n(&self) -> usize {
        self.symbolic.n()
    }

    /// The smallest pivot relative to the diagonal entry of `k` that it came from; one where nothing was eliminated.
    pub fn weakest_pivot(&self, k: &Csr) -> f64 {
        let of = |front: &Front| {
            let panel = &self.panels[front.panel..];
            let dofs = &self.symbolic.interior[front.start..front.end];
            let relative = dofs.iter().enumerate().map(|(j, &dof)| {
                let d = k.get(dof as usize, dof as usize);
                panel[j * front.size() + j].powi(2) / d
            });
            relative.fold(1.0, f64::min)
        };
        self.symbolic.fronts.iter().map(of).fold(1.0, f64::min)
    }

    /// Bytes held by the factor.
    pub fn bytes(&self) -> usize {
        self.panels.len() * std::mem::size_of::<f64>()
    }
}

/// K_ΓΓ on the lower triangle.
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

/// Adds a child's update (lower triangle) into its parent's front, split into panel and update.
fn extend_add(panel: &mut Dense, update: &mut Dense, map: &[u32], child: &[f64]) {
    let n = map.len();
    let width = panel.cols;
    for j in 0..n {
        let target = map[j] as usize;
        let source = &child[j * n + j..(j + 1) * n];
        if target < width {
            let column = panel.col_mut(target);
            for (&i, &v) in map[j..].iter().zip(source) {
                column[i as usize] += v;
            }
        } else {
            let column = update.col_mut(target - width);
            for (&i, &v) in map[j..].iter().zip(source) {
                column[i as usize - width] += v;
            }
        }
    }
}

/// Adds an update (lower triangle) to S.
fn add_lower(s: &mut Dense, map: &[u32], update: &[f64]) {
    let n = map.len();
    for j in 0..n {
        let column = s.col_mut(map[j] as usize);
        for (&i, &v) in map[j..].iter().zip(&update[j * n + j..(j + 1) * n]) {
            column[i as usize] += v;
        }
    }
}

/// Factors the pivot block, scales the rows below it and updates the rest; `Err(j)` where pivot j vanishes.
fn factor_front(
    panel: &mut Dense,
    update: &mut Dense,
    diagonal: &[f64],
    scratch: &mut Scratch,
) -> Result<(), usize> {
    let width = panel.cols;
    let (mut pivot, mut below) = panel.view_mut().split_at_row_mut(width);
    dense::cholesky(pivot.as_mut(), scratch).map_err(|e| e.index)?;
    for (j, &d) in diagonal.iter().enumerate() {
        let l = pivot[(j, j)];
        if l * l <= SINGULAR * d || l.is_nan() {
            return Err(j);
        }
    }
    dense::solve_right_transpose(pivot.as_ref(), below.as_mut());
    dense::rank_k_update(update.view_mut(), -1.0, below.as_ref());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::feti::local::testing::{dense_of, grid_laplacian, random};

    fn rim(nx: usize, ny: usize) -> Vec<u32> {
        let on_rim = |i: &u32| {
            let (x, y) = (*i as usize % nx, *i as usize / nx);
            x == 0 || y == 0 || x == nx - 1 || y == ny - 1
        };
        (0..(nx * ny) as u32).filter(on_rim).collect()
    }

    /// K_ΓΓ − K_ΓI K_II⁻¹ K_IΓ by faer's dense LU.
    fn reference(k: &Csr, interface: &[u32]) -> faer::Mat<f64> {
        use faer::linalg::solvers::Solve;
        let a = dense_of(k);
        let inside: Vec<usize> = (0..k.n())
            .filter(|i| !interface.contains(&(*i as u32)))
            .collect();
        let pick =
            |r: &[usize], c: &[usize]| faer::Mat::from_fn(r.len(), c.len(), |i, j| a[(r[i], c[j])]);
        let outside: Vec<usize> = interface.iter().map(|&i| i as usize).collect();
        let inner = pick(&inside, &inside).partial_piv_lu();
        pick(&outside, &outside) - pick(&outside, &inside) * inner.solve(pick(&inside, &outside))
    }

    #[test]
    fn schur_complement_equals_the_dense_one_even_when_k_is_singular() {
        for shift in [0.0, 0.3] {
            let (k, x) = grid_laplacian(19, 14, shift);
            let interface = rim(19, 14);
            for coordinates in [Some(&x[..]), None] {
                let sym = Arc::new(Symbolic::new(&k, &interface, coordinates));
                let (_, s) = PartialCholesky::new(&k, sym).expect("interior is definite");
                let expected = reference(&k, &interface);
                let error = (s.view() - &expected).norm_max() / expected.norm_max();
                assert!(error < 1e-13, "relative error {error:.1e}");
            }
        }
    }

    #[test]
    fn forward_and_backward_solve_with_the_interior() {
        let (k, x) = grid_laplacian(15, 15, 0.0);
        let interface = rim(15, 15);
        let sym = Arc::new(Symbolic::new(&k, &interface, Some(&x)));
        let (factor, s) = PartialCholesky::new(&k, sym).expect("interior is definite");
        let u = random(k.n(), 3);
        let mut b = vec![0.0; k.n()];
        k.mul(&u, &mut b);
        factor.forward(&mut b);
        // The condensed load of b = K u is S u_Γ.
        let u_gamma: Vec<f64> = interface.iter().map(|&i| u[i as usize]).collect();
        let mut g = vec![0.0; u_gamma.len()];
        s.add_mul(&u_gamma, &mut g);
        for (&i, &gi) in interface.iter().zip(&g) {
            assert!((b[i as usize] - gi).abs() < 1e-12);
            b[i as usize] = u[i as usize];
        }
        factor.backward(&mut b);
        let error = b
            .iter()
            .zip(&u)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        assert!(error < 1e-12, "error {error:.1e}");
    }

    #[test]
    fn an_interior_that_nothing_holds_is_reported() {
        let (k, x) = grid_laplacian(8, 8, 0.0);
        let sym = Arc::new(Symbolic::new(&k, &[], Some(&x)));
        assert!(PartialCholesky::new(&k, sym).is_err());
    }
}

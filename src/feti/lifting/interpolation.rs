//! Coarse functions of one subdomain: columns of Ψ, or functions of vertices alone with averages interpolated from
//! them.
//!
//! A subdomain in space sees some six hundred vertices and edge averages of its neighbourhood, and two of three are
//! averages. The value of an average can be interpolated from its ends, the vertices whose subdomains include all
//! subdomains of the average. The combination is the smallest one that is exact for the kernels (constants, rigid
//! motions); for a straight edge it is half the sum of both ends. Functions of vertices are then continuous, as smooth
//! as linear ones, and a third in number. The span of Z_c shrinks: M_C comes nearer to M_D and stays above it.

use crate::feti::interface::sharing::{Copy, DofSharing};
use crate::feti::jump::operator::Jump;
use crate::feti::settings::CoarseFunctions;
use crate::feti::subdomain::scaled::ScaledSubdomain;
use crate::substructures::Subdomain;
use base::linalg::dense::Dense;
use base::linalg::semidefinite::Semidefinite;

/// An average is not interpolated if the kernels are wrong by more than this, relative to their size.
const WRONG: f64 = 1e-8;

/// Weights below this part of the largest are rounding.
const NOTHING: f64 = 1e-10;

/// Weights are rounded to multiples of one over this. Equal subdomains then have equal weights at any position.
const STEPS: f64 = (1u64 << 40) as f64;

/// Coarse functions of one subdomain.
pub(crate) struct Functions {
    /// For each column the primal dof of the subdomain that names it, vertices first.
    pub columns: Vec<usize>,
    /// (primal dof, column, weight): the values of the primal dofs as combinations of the columns' values.
    pub weights: Vec<(u32, u32, f64)>,
    /// Values on the dual dofs, n_Δ × columns.
    pub psi: Dense,
}

impl Functions {
    /// The functions of local subdomain `j` at its shared vertices and averages.
    pub fn new(
        which: CoarseFunctions,
        sub: &Subdomain,
        sharing: &DofSharing,
        jump: &Jump,
        local: &ScaledSubdomain,
        j: usize,
    ) -> Functions {
        let n_shared = jump.n_shared[j];
        let mut out = Functions {
            columns: Vec::new(),
            weights: Vec::new(),
            psi: Dense::default(),
        };
        (0..n_shared).for_each(|p| out.keep(p));
        let vertices = &local.gamma().interface[local.gamma().n_delta..][..n_shared];
        let copies = |dof: u32| sharing.shared(sub.dofs[dof as usize]);
        for (a, average) in jump.averages[j].iter().enumerate() {
            let p = local.gamma().n_vertices() + a;
            let mean = average.weights.is_none() && which == CoarseFunctions::Vertices;
            let weights = sub
                .near_kernel
                .as_deref()
                .filter(|_| mean)
                .and_then(|kernel| {
                    let around = copies(average.dofs[0]);
                    let ends = (0..n_shared).filter(|&v| includes(copies(vertices[v]), around));
                    combination(kernel, &average.dofs, vertices, ends.collect())
                });
            match weights {
                Some(weights) => {
                    let weights = weights.into_iter();
                    out.weights
                        .extend(weights.map(|(v, w)| (p as u32, v as u32, w)));
                }
                None => out.keep(p),
            }
        }
        out.psi = Dense::zeros(local.gamma().n_delta, out.columns.len());
        for &(p, c, w) in &out.weights {
            let terms = out.psi.col_mut(c as usize).iter_mut();
            let terms = terms.zip(local.psi().col(p as usize));
            terms.for_each(|(y, x)| *y += w * x);
        }
        out
    }

    fn keep(&mut self, p: usize) {
        self.weights
            .push((p as u32, self.columns.len() as u32, 1.0));
        self.columns.push(p);
    }

    /// p ← the primal values for the column values `c`.
    pub fn spread(&self, c: &[f64], p: &mut [f64]) {
        p.fill(0.0);
        for &(i, k, w) in &self.weights {
            p[i as usize] += w * c[k as usize];
        }
    }

    /// The transpose of [`spread`](Self::spread).
    pub fn gather(&self, p: &[f64], c: &mut [f64]) {
        c.fill(0.0);
        for &(i, k, w) in &self.weights {
            c[k as usize] += w * p[i as usize];
        }
    }
}

/// Whether all of `few` are among `many`; both are sorted by subdomain.
fn includes(many: &[Copy], few: &[Copy]) -> bool {
    few.iter().all(|c| {
        many.binary_search_by_key(&c.subdomain, |m| m.subdomain)
            .is_ok()
    })
}

/// The smallest weights of vertices with Σ weight · kernel(end) = mean of the kernel over `dofs`, for all kernels;
/// `None` if there are none.
fn combination(
    kernel: &[Vec<f64>],
    dofs: &[u32],
    vertices: &[u32],
    ends: Vec<usize>,
) -> Option<Vec<(usize, f64)>> {
    let k = kernel.len();
    let mean = |n: &Vec<f64>| dofs.iter().map(|&i| n[i as usize]).sum::<f64>() / dofs.len() as f64;
    let wanted: Vec<f64> = kernel.iter().map(mean).collect();
    let at = |c: usize, v: usize| kernel[c][vertices[v] as usize];
    let size = wanted.iter().fold(0.0f64, |s, n| s.max(n.abs()));
    let right = |weights: &[(usize, f64)]| {
        size > 0.0
            && (0..k).all(|c| {
                let found: f64 = weights.iter().map(|&(v, w)| w * at(c, v)).sum();
                (found - wanted[c]).abs() <= WRONG * size
            })
    };
    let rounded = |v: usize, weight: f64| (v, (weight * STEPS).round() / STEPS);
    // The smallest weights are those in the range of Nᵀ. On a straight edge they are a multiple of one column, a
    // translation.
    for (c, n) in wanted.iter().enumerate() {
        let square: f64 = ends.iter().map(|&v| at(c, v).powi(2)).sum();
        if *n != 0.0 && square > 0.0 {
            let weight = |&v: &usize| rounded(v, at(c, v) * n / square);
            let some = ends.iter().map(weight).filter(|w| w.1 != 0.0);
            let weights: Vec<(usize, f64)> = some.collect();
            if right(&weights) {
                return Some(weights);
            }
        }
    }
    // w = Nᵀ (N Nᵀ)⁺ n
    let mut gram = Dense::zeros(k, k);
    for a in 0..k {
        for b in 0..k {
            gram.set(a, b, ends.iter().map(|&v| at(a, v) * at(b, v)).sum());
        }
    }
    let mut x = wanted.clone();
    Semidefinite::new(&gram).solve(&mut x);
    let weight = |&v: &usize| rounded(v, (0..k).map(|c| at(c, v) * x[c]).sum());
    let mut weights: Vec<(usize, f64)> = ends.iter().map(weight).collect();
    let largest = weights.iter().fold(0.0f64, |s, w| s.max(w.1.abs()));
    weights.retain(|w| w.1.abs() > NOTHING * largest);
    right(&weights).then_some(weights)
}

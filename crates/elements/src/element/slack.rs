//! Motions of a cell that its stiffness does not see, and that are not rigid.
//!
//! They are found from the strains at the points of integration: a motion has no energy if it has no strain at any of
//! them. That does not depend on the material. In u' = Lᵀu, x' = L⁻¹x strains are ε' = Lᵀ ε L, so that the question may
//! be asked in coordinates in which the nodes spread alike in all directions: needles have no small strains of their
//! own there.

use super::axial::per_radius;
use super::integration::Integration;
use super::map::{by_kind, for_each_sample, relative};
use super::quadrature::Purpose;
use super::table::table;
use crate::cell::rigid_motions;
use crate::form::Form;
use crate::kind::CellKind;
use base::linalg::null_space::null_space;

/// Strains of a motion of order one that count as none, where cells have the size one. Coordinates with five digits
/// make smaller ones of a prism that has none.
const NONE: f64 = 1e-4;

/// Whether cells of this kind may have motions without energy that are not rigid: those with fewer points than full
/// integration has, and no stiffness against hourglasses.
pub fn may_slack(kind: CellKind, integration: Integration) -> bool {
    let bilinear = matches!(kind, CellKind::Quad4 | CellKind::Hex8);
    integration == Integration::Reduced && !bilinear
}

/// A basis of the motions without energy of an elastic cell that are not rigid: orthonormal, and orthogonal to the
/// rigid ones. An entry per degree of freedom, numbered node by node.
pub fn slack(
    form: &Form,
    kind: CellKind,
    points: &[[f64; 3]],
    integration: Integration,
) -> Vec<Vec<f64>> {
    if !may_slack(kind, integration) || !form.is_elastic() {
        return Vec::new();
    }
    by_kind!(kind, slack_of(form, kind, points))
}

fn slack_of<const D: usize, const N: usize>(
    form: &Form,
    kind: CellKind,
    points: &[[f64; 3]],
) -> Vec<Vec<f64>> {
    let n = D * N;
    let l = factor::<D>(points, form.is_axial());
    let rows = strains::<D, N>(form, kind, points, Purpose::Reduced, &l);
    let found = null_space(rows, std::slice::from_ref(&(0..n)), NONE);
    // Back: u = L⁻ᵀ u'.
    let back = |(_, u): (usize, Vec<f64>)| -> Vec<f64> {
        let mut out = vec![0.0; n];
        for a in 0..N {
            for i in (0..D).rev() {
                let mut v = u[D * a + i];
                (i + 1..D).for_each(|k| v -= l[k][i] * out[D * a + k]);
                out[D * a + i] = v / l[i][i];
            }
        }
        out
    };
    let found: Vec<Vec<f64>> = found.into_iter().map(back).collect();
    let rigid = rigid_of(form, D, points);
    let more = found.len().saturating_sub(rigid.len());
    beside(&rigid, found, more)
}

/// The strains at the points of a rule, in coordinates in which the nodes spread alike: a row of factors of u' for
/// each.
fn strains<const D: usize, const N: usize>(
    form: &Form,
    kind: CellKind,
    points: &[[f64; 3]],
    purpose: Purpose,
    l: &[[f64; D]; D],
) -> Vec<Vec<f64>> {
    let (table, axial, n) = (table(kind, purpose), form.is_axial(), D * N);
    let even: Vec<[f64; 3]> = points.iter().map(|p| divided::<D>(l, *p)).collect();
    let mut rows = Vec::new();
    for_each_sample::<D, N>(&relative(&even), table, |s| {
        for i in 0..D {
            for j in i..D {
                let mut row = vec![0.0; n];
                for a in 0..N {
                    row[D * a + i] += s.gradient[j][a];
                    row[D * a + j] += s.gradient[i][a];
                }
                rows.push(row);
            }
        }
        if axial {
            let around = per_radius(&even, table, s.index);
            let mut row = vec![0.0; n];
            let values = table.values(s.index).iter().enumerate();
            values.for_each(|(a, v)| row[D * a] = v * around);
            rows.push(row);
        }
    });
    rows
}

/// Whether a cell sees all motions of some of its nodes, given as places, while its other nodes are held.
pub fn sees(
    form: &Form,
    kind: CellKind,
    points: &[[f64; 3]],
    integration: Integration,
    moving: &[usize],
) -> bool {
    moving.is_empty() || {
        let purpose = purpose(kind, integration);
        by_kind!(kind, sees_all(form, kind, points, purpose, moving))
    }
}

fn sees_all<const D: usize, const N: usize>(
    form: &Form,
    kind: CellKind,
    points: &[[f64; 3]],
    purpose: Purpose,
    moving: &[usize],
) -> bool {
    let l = factor::<D>(points, form.is_axial());
    let rows = strains::<D, N>(form, kind, points, purpose, &l);
    let of_moving = |row: Vec<f64>| -> Vec<f64> {
        let dofs = moving.iter().flat_map(|&a| D * a..D * (a + 1));
        dofs.map(|dof| row[dof]).collect()
    };
    let rows = rows.into_iter().map(of_moving).collect();
    null_space(rows, std::slice::from_ref(&(0..D * moving.len())), NONE).is_empty()
}

/// The points at which a cell sees strains.
fn purpose(kind: CellKind, integration: Integration) -> Purpose {
    if may_slack(kind, integration) {
        Purpose::Reduced
    } else {
        Purpose::Full
    }
}

/// The largest strain that a cell sees of a motion, in coordinates in which its nodes spread alike, beside the largest
/// displacement there.
pub fn strain_of(
    form: &Form,
    kind: CellKind,
    points: &[[f64; 3]],
    integration: Integration,
    u: &[f64],
) -> f64 {
    let purpose = purpose(kind, integration);
    by_kind!(kind, largest_strain(form, kind, points, purpose, u))
}

fn largest_strain<const D: usize, const N: usize>(
    form: &Form,
    kind: CellKind,
    points: &[[f64; 3]],
    purpose: Purpose,
    u: &[f64],
) -> f64 {
    let l = factor::<D>(points, form.is_axial());
    // u' = Lᵀ u.
    let mut even = vec![0.0; D * N];
    for a in 0..N {
        for i in 0..D {
            even[D * a + i] = (i..D).map(|k| l[k][i] * u[D * a + k]).sum();
        }
    }
    let most = |x: f64, y: &f64| x.max(y.abs());
    let size = even.iter().fold(0.0, most);
    let rows = strains::<D, N>(form, kind, points, purpose, &l);
    let strains = rows
        .iter()
        .map(|row| row.iter().zip(&even).map(|(b, u)| b * u).sum::<f64>());
    let largest = strains.fold(0.0, |x, y| most(x, &y));
    if size > 0.0 {
        largest / size
    } else {
        0.0
    }
}

/// L of L Lᵀ = the mean of (x − m)(x − m)ᵀ over the nodes; a multiple of the identity where the radius counts.
fn factor<const D: usize>(points: &[[f64; 3]], axial: bool) -> [[f64; D]; D] {
    let n = points.len() as f64;
    let mean: [f64; D] = std::array::from_fn(|i| points.iter().map(|p| p[i]).sum::<f64>() / n);
    let entry = |i: usize, j: usize| {
        let each = points.iter().map(|p| (p[i] - mean[i]) * (p[j] - mean[j]));
        each.sum::<f64>() / n
    };
    let mut l = [[0.0; D]; D];
    if axial {
        let size = (0..D).map(|i| entry(i, i)).sum::<f64>().sqrt();
        (0..D).for_each(|i| l[i][i] = size);
        return l;
    }
    for j in 0..D {
        for i in j..D {
            let sum: f64 = (0..j).map(|k| l[i][k] * l[j][k]).sum();
            let left = entry(i, j) - sum;
            l[i][j] = if i == j { left.sqrt() } else { left / l[j][j] };
        }
    }
    l
}

/// L⁻¹ x.
fn divided<const D: usize>(l: &[[f64; D]; D], x: [f64; 3]) -> [f64; 3] {
    let mut out = [0.0; 3];
    for i in 0..D {
        let sum: f64 = (0..i).map(|k| l[i][k] * out[k]).sum();
        out[i] = (x[i] - sum) / l[i][i];
    }
    out
}

/// The rigid motions that take no energy, of the nodes of a cell or of others.
pub fn rigid_of(form: &Form, dim: usize, points: &[[f64; 3]]) -> Vec<Vec<f64>> {
    let n = points.len().max(1) as f64;
    let mean = [0, 1, 2].map(|i| points.iter().map(|p| p[i]).sum::<f64>() / n);
    let away = points
        .iter()
        .flat_map(|p| (0..3).map(|i| (p[i] - mean[i]).abs()));
    let size = away.fold(0.0, f64::max);
    let size = if size > 0.0 { size } else { 1.0 };
    let motions: Vec<[[f64; 3]; 6]> = points
        .iter()
        .map(|p| rigid_motions(dim, mean, size, *p))
        .collect();
    let column = |k: usize| motions.iter().flat_map(|m| m[k][..dim].to_vec()).collect();
    form.rigid(dim).map(column).collect()
}

/// The `more` directions in the span of `found` that are farthest from that of `basis`, orthonormal and orthogonal to
/// it.
fn beside(basis: &[Vec<f64>], mut found: Vec<Vec<f64>>, more: usize) -> Vec<Vec<f64>> {
    let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let normal = |x: &mut Vec<f64>| {
        let length = dot(x, x).sqrt();
        x.iter_mut().for_each(|v| *v /= length);
    };
    let remove = |x: &mut Vec<f64>, q: &[f64]| {
        let part = dot(x, q);
        x.iter_mut().zip(q).for_each(|(v, q)| *v -= part * q);
    };
    found.iter_mut().for_each(normal);
    let mut known: Vec<Vec<f64>> = Vec::new();
    for b in basis {
        let mut q = b.clone();
        known
            .iter()
            .chain(&known.clone())
            .for_each(|k| remove(&mut q, k));
        normal(&mut q);
        found.iter_mut().for_each(|x| remove(x, &q));
        known.push(q);
    }
    let mut out = Vec::new();
    for _ in 0..more {
        let Some(best) = (0..found.len())
            .max_by(|&a, &b| dot(&found[a], &found[a]).total_cmp(&dot(&found[b], &found[b])))
        else {
            break;
        };
        let mut q = found.swap_remove(best);
        normal(&mut q);
        known.iter().for_each(|k| remove(&mut q, k));
        normal(&mut q);
        found.iter_mut().for_each(|x| remove(x, &q));
        known.push(q.clone());
        out.push(q);
    }
    out
}

#[cfg(test)]
#[path = "../../tests/element/slack.rs"]
mod tests;

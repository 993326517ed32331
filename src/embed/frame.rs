//! The frame of a torn operator: all that follows from the patterns of the host's matrices and the numbers of its dofs,
//! and stays when only the entries of the matrices change; and the numbers of other matrices in this frame.
//!
//! Nothing is taken on trust: every entry of the new matrices has to find its place in the parts that were set up. An
//! entry that was exactly zero and no longer is, a boundary condition that comes or goes, a part that falls apart, or a
//! motion without energy that begins or ceases to be one, and the frame is no longer theirs.

use petsc::PetscInt;
use std::borrow::Cow;
use std::collections::{BTreeMap, HashSet};

use super::bodies::Bodies;
use super::kernels::KernelVectors;
use super::motions::CANCELS;
use super::nullspace::cancels;
use super::parts::{PieceRows, RowDestination, TornSubdomain, SYMMETRIC};
use super::sharing::Sharers;
use base::linalg::csr::Csr;
use petsc::Vec as PetscVec;

/// The frame of a torn operator on this rank.
pub struct TornFrame {
    pub n_global: usize,
    pub block_size: usize,
    /// A vector of the host's layout.
    pub layout: PetscVec,
    /// The global dofs of this rank's pieces, increasing.
    pub ghosts: Vec<u32>,
    /// The known dofs among the global dofs of this rank's pieces.
    pub known: HashSet<u32>,
    /// The rows of each piece.
    pub rows: Vec<PieceRows>,
    /// The parts without their matrices, which the solver has.
    pub parts: Vec<TornSubdomain>,
    pub sharers: Sharers,
    pub bodies: Bodies,
    /// Motions of every part, and whether its matrix maps each of them to zero.
    pub motions: Vec<(KernelVectors, Vec<bool>)>,
}

/// A local matrix of the host, and the global number of each of its rows; negative: none. A number that is listed
/// several times means the same dof.
pub struct Local<'a> {
    pub k: Cow<'a, Csr>,
    pub dofs: Cow<'a, [PetscInt]>,
}

/// The numbers of other matrices, by part.
pub struct TornValues {
    /// Entries of each matrix in the order of its pattern.
    pub k: Vec<Vec<f64>>,
    /// Their diagonals.
    pub diagonal: Vec<Vec<f64>>,
    /// Entries in columns of known dofs: (row, global dof, value).
    pub known: Vec<Vec<(u32, u32, f64)>>,
    /// This rank's part of the diagonal entries of known dofs.
    pub fixed: BTreeMap<u32, f64>,
}

impl TornFrame {
    /// Which motions of a part its matrix maps to zero.
    pub fn cancelled(k: &Csr, entries: &[f64], motions: &KernelVectors) -> Vec<bool> {
        let zero = |x: &Vec<f64>| cancels(k, entries, x, CANCELS);
        motions.iter().map(zero).collect()
    }

    /// The numbers of other matrices; `None` if they do not fit this frame. `patterns` has the matrices of the parts.
    pub fn numbers(&self, patterns: &[&Csr], given: &[Local<'_>]) -> Option<TornValues> {
        let zeros = |k: &&Csr| vec![0.0; k.nnz()];
        let mut out = TornValues {
            k: patterns.iter().map(zeros).collect(),
            diagonal: Vec::new(),
            known: vec![Vec::new(); patterns.len()],
            fixed: BTreeMap::new(),
        };
        let given = given.iter().filter(|l| l.dofs.iter().any(|&d| d >= 0));
        let given: Vec<&Local> = given.collect();
        if given.len() != self.rows.len() {
            return None;
        }
        for (local, rows) in given.into_iter().zip(&self.rows) {
            add(patterns, local, rows, &mut out)?;
        }
        for (j, k) in patterns.iter().enumerate() {
            let (entries, (motions, before)) = (&out.k[j], &self.motions[j]);
            let diagonal = sound(k, entries)?;
            let same = self.in_one_piece(j, k, entries)
                && TornFrame::cancelled(k, entries, motions) == *before;
            if !same {
                return None;
            }
            out.diagonal.push(diagonal);
        }
        Some(out)
    }

    /// Whether the entries of a part that are not zero still connect all of it.
    fn in_one_piece(&self, j: usize, k: &Csr, entries: &[f64]) -> bool {
        if entries.iter().all(|v| *v != 0.0) {
            return true;
        }
        let node = |i: usize| self.parts[j].dofs[i] as usize / self.block_size;
        let mut seen = vec![false; k.n()];
        let mut stack = vec![0];
        seen[0] = true;
        let mut found = 0;
        while let Some(i) = stack.pop() {
            found += 1;
            let mut visit = |j: usize| {
                if !seen[j] {
                    seen[j] = true;
                    stack.push(j);
                }
            };
            let range = k.row_ptr[i]..k.row_ptr[i + 1];
            for (&j, v) in k.col[range.clone()].iter().zip(&entries[range]) {
                if *v != 0.0 {
                    visit(j as usize);
                }
            }
            let same = |j: &usize| node(*j) == node(i);
            (i + 1..k.n()).take_while(same).for_each(&mut visit);
            (0..i).rev().take_while(same).for_each(&mut visit);
        }
        found == k.n()
    }
}

/// Adds the entries of a local matrix where the rows of its piece went; `None` if one of them has no place.
fn add(patterns: &[&Csr], local: &Local<'_>, rows: &PieceRows, out: &mut TornValues) -> Option<()> {
    let mut at = Vec::with_capacity(local.dofs.len());
    let mut seen = vec![false; rows.dofs.len()];
    for &dof in &*local.dofs {
        at.push(match u32::try_from(dof) {
            Err(_) => None,
            Ok(dof) => {
                let r = rows.dofs.binary_search(&dof).ok()?;
                seen[r] = true;
                Some(r)
            }
        });
    }
    if !seen.iter().all(|s| *s) {
        return None;
    }
    let mut coupled = vec![false; rows.dofs.len()];
    // The row in which a column of a part was marked last, and its entry there.
    let widest = patterns.iter().map(|k| k.n()).max().unwrap_or(0);
    let mut mark = vec![(usize::MAX, 0); widest];
    for (i, r) in at.iter().enumerate() {
        let Some(r) = *r else { continue };
        let place = rows.place[r];
        match place {
            RowDestination::Unknown { part, row } => {
                let (k, row) = (patterns[part as usize], row as usize);
                for e in k.row_ptr[row]..k.row_ptr[row + 1] {
                    mark[k.col[e] as usize] = (i, e);
                }
            }
            RowDestination::Known => {
                out.fixed.entry(rows.dofs[r]).or_default();
            }
            RowDestination::Empty => {}
        }
        let (col, val) = local.k.row(i);
        for (&j, &v) in col.iter().zip(val).filter(|(_, v)| **v != 0.0) {
            let Some(c) = at[j as usize] else { continue };
            if !v.is_finite() {
                return None;
            }
            coupled[r] |= c != r;
            match (place, rows.place[c]) {
                (
                    RowDestination::Unknown { part, .. },
                    RowDestination::Unknown { part: other, row },
                ) => {
                    let (marked, e) = mark[row as usize];
                    if other != part || marked != i {
                        return None;
                    }
                    out.k[part as usize][e] += v;
                }
                (RowDestination::Unknown { part, row }, RowDestination::Known) => {
                    out.known[part as usize].push((row, rows.dofs[c], v));
                }
                (RowDestination::Known, _) if c == r => {
                    *out.fixed.entry(rows.dofs[r]).or_default() += v;
                }
                (RowDestination::Known, _) => {}
                (RowDestination::Unknown { .. }, RowDestination::Empty)
                | (RowDestination::Empty, _) => return None,
            }
        }
    }
    (coupled == rows.coupled).then_some(())
}

/// The diagonal of a matrix with the pattern of `k` and these entries; `None` if an entry of it is not positive, or the
/// matrix is not symmetric.
fn sound(k: &Csr, entries: &[f64]) -> Option<Vec<f64>> {
    let mut diagonal = Vec::with_capacity(k.n());
    for i in 0..k.n() {
        let range = k.row_ptr[i]..k.row_ptr[i + 1];
        let at = k.col[range.clone()].binary_search(&(i as u32)).ok()?;
        let d = entries[range.start + at];
        if d <= 0.0 || d.is_nan() {
            return None;
        }
        diagonal.push(d);
    }
    let small =
        |i: usize, j: usize, v: f64| v.abs() <= SYMMETRIC * (diagonal[i] * diagonal[j]).sqrt();
    // Above the diagonal by rows, entries below it come in the order of their columns in every row.
    let mut next: Vec<usize> = k.row_ptr[..k.n()].to_vec();
    for i in 0..k.n() {
        for e in k.row_ptr[i]..k.row_ptr[i + 1] {
            let j = k.col[e] as usize;
            if j <= i {
                continue;
            }
            while (k.col[next[j]] as usize) < i {
                if !small(j, k.col[next[j]] as usize, entries[next[j]]) {
                    return None;
                }
                next[j] += 1;
            }
            let other = if k.col[next[j]] as usize == i {
                next[j] += 1;
                entries[next[j] - 1]
            } else {
                0.0
            };
            if !small(i, j, entries[e] - other) {
                return None;
            }
        }
    }
    for (j, first) in next.into_iter().enumerate() {
        let rest = first..k.row_ptr[j + 1];
        let mut below = rest
            .map(|e| (k.col[e] as usize, entries[e]))
            .take_while(|e| e.0 < j);
        if !below.all(|(i, v)| small(i, j, v)) {
            return None;
        }
    }
    Some(diagonal)
}

#[cfg(test)]
#[path = "../../tests/inside/embed/frame.rs"]
mod tests;

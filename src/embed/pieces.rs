//! Local matrices as the host stores them, and the subdomain matrices extracted from them.

use base::linalg::csr::Csr;
use base::linalg::sorted::distinct;
use petsc::PetscInt;
use std::collections::HashMap;

/// One subdomain matrix of the host.
#[derive(Debug, Clone)]
pub struct TornPiece {
    /// Its rows and columns. Exact zeros are left out but for those in blocks of two nodes that are coupled: with other
    /// coefficients they are none, and the pattern stays.
    pub k: Csr,
    /// Global number of each of its dofs, strictly increasing.
    pub dofs: Vec<u32>,
    /// The body that the host named, if any.
    pub body: Option<u64>,
}

impl TornPiece {
    /// Whether row `i` has more than its diagonal.
    pub fn couples(&self, i: usize) -> bool {
        self.k.row(i).0.iter().any(|&j| j as usize != i)
    }
}

/// The pieces of a local matrix with `block_size` consecutive dofs in a node. `copies` is the same of its rows if the
/// map may list a dof several times, once for each subdomain that has it.
pub fn torn_from(
    k: &Csr,
    map: &[PetscInt],
    block_size: usize,
    copies: Option<usize>,
    body: Option<u64>,
) -> Vec<TornPiece> {
    match copies {
        Some(rows) => pieces(k, map, [block_size, rows], body),
        None => piece(k, map, block_size, body).into_iter().collect(),
    }
}

/// A local matrix by increasing global dofs. Rows of the same dof are added (a periodic mesh on one rank has such
/// rows), rows without a dof are left out. `None` if no row is left.
fn piece(k: &Csr, map: &[PetscInt], block_size: usize, body: Option<u64>) -> Option<TornPiece> {
    let dofs = distinct(map.iter().filter(|&&g| g >= 0).map(|&g| g as u32));
    if dofs.is_empty() {
        return None;
    }
    let place =
        |i: usize| u32::try_from(map[i]).map(|g| dofs.binary_search(&g).unwrap_or(0) as u32);
    let mut triplets = Vec::with_capacity(k.nnz());
    for i in 0..k.n() {
        let Ok(row) = place(i) else { continue };
        let (col, val) = k.row(i);
        for (&j, &v) in col.iter().zip(val) {
            if let Ok(at) = place(j as usize) {
                triplets.push((row, at, v));
            }
        }
    }
    let k = Csr::from_triplets(dofs.len(), &triplets);
    let node = |i: usize| dofs[i] as usize / block_size;
    let k = without_zeros(&k, &node);
    Some(TornPiece { k, dofs, body })
}

/// The matrix without its exact zeros, but for those between rows that are coupled, in blocks of two nodes that have
/// something else. Rows of a node stand side by side.
fn without_zeros(k: &Csr, node: &dyn Fn(usize) -> usize) -> Csr {
    if k.val.iter().all(|v| *v != 0.0) {
        return k.clone();
    }
    let coupled = |i: usize| {
        let (col, val) = k.row(i);
        let mut entries = col.iter().zip(val);
        entries.any(|(&j, &v)| v != 0.0 && j as usize != i)
    };
    let coupled: Vec<bool> = (0..k.n()).map(coupled).collect();
    let mut out = Csr {
        row_ptr: vec![0],
        ..Csr::default()
    };
    // The first row of the node that had something last in the node of each column.
    let mut seen = vec![usize::MAX; k.n()];
    let firsts = first_rows(k.n(), node);
    for i in 0..k.n() {
        let own = firsts[i];
        if own == i {
            let rows = (i..k.n()).take_while(|&r| firsts[r] == i);
            for (&j, _) in rows.flat_map(|r| {
                let (col, val) = k.row(r);
                col.iter().zip(val).filter(|(_, v)| **v != 0.0)
            }) {
                seen[firsts[j as usize]] = own;
            }
        }
        let (col, val) = k.row(i);
        for (&j, &v) in col.iter().zip(val) {
            let both = coupled[i] && coupled[j as usize];
            if v != 0.0 || (both && seen[firsts[j as usize]] == own) {
                out.col.push(j);
                out.val.push(v);
            }
        }
        out.row_ptr.push(out.col.len());
    }
    out
}

/// The first row of the node of each row.
fn first_rows(n: usize, node: &dyn Fn(usize) -> usize) -> Vec<usize> {
    let mut out = Vec::with_capacity(n);
    for i in 0..n {
        let same = i > 0 && node(i - 1) == node(i);
        out.push(if same { out[i - 1] } else { i });
    }
    out
}

/// Splits a local matrix whose map may list a dof several times, once for each subdomain that has it. The pieces are
/// the connected parts of the matrix, where `together` consecutive rows belong together. Rows without off-diagonal
/// entries (boundary conditions) cannot be assigned to a subdomain and form a piece of their own.
fn pieces(
    k: &Csr,
    map: &[PetscInt],
    [block_size, together]: [usize; 2],
    body: Option<u64>,
) -> Vec<TornPiece> {
    let n = k.n();
    let node = |i: usize| i / together;
    let alone = |i: usize| {
        let (col, val) = k.row(i);
        col.iter()
            .zip(val)
            .all(|(&j, &v)| j as usize == i || v == 0.0)
    };
    let mut label: Vec<Option<usize>> = vec![None; n];
    let mut n_parts = 0;
    for start in 0..n {
        if label[start].is_some() || alone(start) {
            continue;
        }
        label[start] = Some(n_parts);
        let mut stack = vec![start];
        while let Some(i) = stack.pop() {
            let (col, val) = k.row(i);
            let coupled = col.iter().zip(val).filter(|(_, v)| **v != 0.0);
            let first = node(i) * together;
            let siblings = (first..(first + together).min(n)).filter(|&j| !alone(j));
            for j in coupled.map(|(&j, _)| j as usize).chain(siblings) {
                if label[j].is_none() {
                    label[j] = Some(n_parts);
                    stack.push(j);
                }
            }
        }
        n_parts += 1;
    }
    // The uncoupled rows form the last piece.
    let loose = label.iter().any(Option::is_none);
    let mut rows: Vec<Vec<usize>> = vec![Vec::new(); n_parts + usize::from(loose)];
    for (i, l) in label.iter().enumerate() {
        rows[l.unwrap_or(n_parts)].push(i);
    }
    let mut out = Vec::new();
    for rows in rows {
        let mut place = HashMap::new();
        for (new, &i) in rows.iter().enumerate() {
            place.insert(i as u32, new as u32);
        }
        let mut triplets = Vec::new();
        for (new, &i) in rows.iter().enumerate() {
            let (col, val) = k.row(i);
            for (j, &v) in col.iter().zip(val) {
                if let Some(&to) = place.get(j) {
                    triplets.push((new as u32, to, v));
                }
            }
        }
        let part = Csr::from_triplets(rows.len(), &triplets);
        let dofs: Vec<PetscInt> = rows.iter().map(|&i| map[i]).collect();
        out.extend(piece(&part, &dofs, block_size, body));
    }
    out
}

#[cfg(test)]
#[path = "../../tests/inside/embed/pieces.rs"]
mod tests;

//! Subdomains: the connected parts of the pieces, restricted to unknown dofs.

use super::pieces::TornPiece;
use super::states::States;
use super::torn::Torn;
use crate::{Error, Result};
use base::linalg::csr::Csr;

/// Largest difference of entries (i, j) and (j, i), relative to the diagonal.
pub const SYMMETRIC: f64 = 1e-9;

/// The number of a global dof as one body sees it.
pub fn body_dof(n_global: usize, body: usize, dof: u32) -> u64 {
    body as u64 * n_global as u64 + u64::from(dof)
}

/// A future subdomain.
#[derive(Debug, Clone)]
pub struct TornSubdomain {
    /// The body that the host named, if any.
    pub body: Option<u64>,
    /// Its matrix, restricted to unknowns.
    pub k: Csr,
    /// Global dof of each row, strictly increasing.
    pub dofs: Vec<u32>,
    /// Its entries in columns of known dofs: (row, global dof, value).
    pub known: Vec<(u32, u32, f64)>,
}

/// Where a row of a piece went.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RowDestination {
    /// To this row of this part of the rank.
    Unknown { part: u32, row: u32 },
    /// Nowhere: its dof is known.
    Known,
    /// Nowhere: its dof is unknown, but the piece has no stiffness there.
    Empty,
}

/// The rows of a piece.
#[derive(Debug, Clone)]
pub struct PieceRows {
    /// Global dof of each, strictly increasing.
    pub dofs: Vec<u32>,
    /// Where each went.
    pub place: Vec<RowDestination>,
    /// Whether each has more than its diagonal.
    pub coupled: Vec<bool>,
}

/// The parts of this rank's pieces, and where the rows of each piece went.
///
/// # Errors
/// A matrix that is not symmetric, or whose diagonal is not that of a stiffness matrix.
pub fn parts(torn: &Torn, states: &States) -> Result<(Vec<TornSubdomain>, Vec<PieceRows>)> {
    let (mut out, mut rows) = (Vec::new(), Vec::new());
    for piece in &torn.pieces {
        let free: Vec<bool> = piece.dofs.iter().map(|d| states[d].is_free()).collect();
        symmetric(piece, &free)?;
        let label = components(torn, piece, &free);
        let n_parts = label.iter().flatten().max().map_or(0, |&l| l as usize + 1);
        // Place of each dof in its part.
        let mut place = vec![0; piece.dofs.len()];
        let mut made: Vec<TornSubdomain> = (0..n_parts)
            .map(|_| TornSubdomain {
                body: piece.body,
                k: Csr {
                    row_ptr: vec![0],
                    ..Csr::default()
                },
                dofs: Vec::new(),
                known: Vec::new(),
            })
            .collect();
        for (i, l) in label.iter().enumerate() {
            if let Some(l) = l {
                let part = &mut made[*l as usize];
                place[i] = part.dofs.len() as u32;
                part.dofs.push(piece.dofs[i]);
            }
        }
        for (i, l) in label.iter().enumerate() {
            let Some(l) = l else { continue };
            let part = &mut made[*l as usize];
            let (col, val) = piece.k.row(i);
            for (&j, &v) in col.iter().zip(val) {
                let j = j as usize;
                if label[j].is_some() {
                    part.k.col.push(place[j]);
                    part.k.val.push(v);
                } else {
                    part.known.push((place[i], piece.dofs[j], v));
                }
            }
            part.k.row_ptr.push(part.k.col.len());
        }
        let first = out.len() as u32;
        let place = |(i, l): (usize, &Option<u32>)| match l {
            Some(l) => RowDestination::Unknown {
                part: first + l,
                row: place[i],
            },
            None if free[i] => RowDestination::Empty,
            None => RowDestination::Known,
        };
        rows.push(PieceRows {
            dofs: piece.dofs.clone(),
            place: label.iter().enumerate().map(place).collect(),
            coupled: (0..label.len()).map(|i| piece.couples(i)).collect(),
        });
        out.append(&mut made);
    }
    Ok((out, rows))
}

/// The part of each dof of a piece; parts are numbered by lowest dof. `None` for known dofs and for dofs without
/// stiffness in the piece. All components of a node belong to the same part.
fn components(torn: &Torn, piece: &TornPiece, free: &[bool]) -> Vec<Option<u32>> {
    let n = piece.dofs.len();
    let unknown = |i: usize| free[i] && !piece.k.row(i).0.is_empty();
    let mut label = vec![None; n];
    let mut next = 0;
    for start in 0..n {
        if label[start].is_some() || !unknown(start) {
            continue;
        }
        let mut stack = vec![start];
        label[start] = Some(next);
        while let Some(i) = stack.pop() {
            let mut visit = |j: usize| {
                if label[j].is_none() && unknown(j) {
                    label[j] = Some(next);
                    stack.push(j);
                }
            };
            let neighbours = piece.k.row(i).0.iter();
            neighbours.for_each(|&j| visit(j as usize));
            let node = torn.node(piece.dofs[i]);
            let same = |j: &usize| torn.node(piece.dofs[*j]) == node;
            (i + 1..n).take_while(same).for_each(&mut visit);
            (0..i).rev().take_while(same).for_each(&mut visit);
        }
        next += 1;
    }
    label
}

/// Returns an error if the matrix of the unknowns has entries that are no numbers, a diagonal that is not positive, or
/// is not symmetric. The first fault explains the others: a zero diagonal leaves nothing to compare entries with.
fn symmetric(piece: &TornPiece, free: &[bool]) -> Result<()> {
    let unknowns = || (0..piece.dofs.len()).filter(|&i| free[i]);
    let diagonal = piece.k.diagonal();
    for i in unknowns() {
        let (col, val) = piece.k.row(i);
        if let Some((&j, v)) = col.iter().zip(val).find(|(_, v)| !v.is_finite()) {
            return Err(Error::unfit(format!(
                "the local matrix of a subdomain has {v} at global dofs ({}, {}), expected finite numbers: \
                 look where the host's assembly divides by zero",
                piece.dofs[i], piece.dofs[j as usize]
            )));
        }
    }
    for i in unknowns() {
        let (dof, d) = (piece.dofs[i], piece.k.get(i, i));
        if piece.k.row(i).0.is_empty() || d > 0.0 {
            continue;
        }
        let why = if d == 0.0 {
            "a row with entries beside a zero diagonal is that of a saddle point (the pressure of Stokes, a Lagrange \
             multiplier), which this method does not solve; give the block of the displacements to it and the rest to \
             a PCFIELDSPLIT of type schur"
        } else {
            "a stiffness matrix has a positive one; change the signs of operator and right-hand side if all are \
             negative, and take the shift out if it is a Helmholtz operator"
        };
        return Err(Error::unfit(format!(
            "the local matrix of a subdomain has {d} on the diagonal at global dof {dof}, \
             expected a positive number: {why}"
        )));
    }
    for i in unknowns() {
        let (col, val) = piece.k.row(i);
        for (&j, &v) in col.iter().zip(val) {
            let j = j as usize;
            if !free[j] || j == i {
                continue;
            }
            let other = piece.k.get(j, i);
            let size = (diagonal[i] * diagonal[j]).abs().sqrt();
            let same = (v - other).abs() <= SYMMETRIC * size;
            if !same {
                return Err(Error::input(format!(
                    "the operator is not symmetric: a local matrix has {v} \
                     at global dofs ({}, {}) and {other} at ({}, {}), expected equal entries",
                    piece.dofs[i], piece.dofs[j], piece.dofs[j], piece.dofs[i]
                )));
            }
        }
    }
    Ok(())
}

//! The rows that a rank gives: their terms refer to unknowns of all bodies, or to unknowns of one matrix.

use super::laws::ContactLaw;
use super::numbering::HostNumbering;
use super::object::Object;
use super::tangential::{beside, ContactResult, NodeFriction};
use crate::embed::GivenRow;
use crate::substructures::Law;
use crate::Result;
use base::Fault;
use petsc::PetscInt;

/// The function that gave a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RowOrigin {
    /// FetiFetiSetContactRows.
    Rows,
    /// FetiFetiSetContactPairs.
    Pairs,
}

/// A row as the host gave it.
pub struct HostRow {
    pub origin: RowOrigin,
    /// Unknowns and coefficients.
    pub terms: Vec<(HostNumbering, u32, f64)>,
    pub gap: f64,
    pub law: Law,
    /// Friction and softness of an inequality.
    pub contact: ContactLaw,
    /// Where the sides stand without a slip, in the components of a node.
    pub slipped: [f64; 3],
    /// The result of the last solve.
    pub solved: ContactResult,
}

impl HostRow {
    /// A hard row without friction.
    pub fn new(
        origin: RowOrigin,
        terms: Vec<(HostNumbering, u32, f64)>,
        gap: f64,
        law: Law,
    ) -> HostRow {
        HostRow {
            origin,
            terms,
            gap,
            law,
            contact: ContactLaw::default(),
            slipped: [0.0; 3],
            solved: ContactResult::default(),
        }
    }
}

/// The law of a C FetiFetiRowKind.
pub fn law(number: PetscInt, whose: impl FnOnce() -> String) -> Result<Law> {
    let found = u64::try_from(number).ok().and_then(Law::of_kind);
    let found = found.filter(|law| !law.is_friction());
    found.ok_or_else(|| {
        Fault::OutOfRange.error(format!(
            "{} of kind {number}, expected FETIFETI_EQUALITY (0) or FETIFETI_INEQUALITY (1)",
            whose()
        ))
    })
}

/// The unknowns on one side of the pairs, and their numbering.
pub struct PairSide {
    pub numbering: HostNumbering,
    pub dofs: Vec<PetscInt>,
}

impl PairSide {
    /// `matrix` is the index from C: negative for the numbering of all unknowns.
    ///
    /// # Errors
    /// A matrix that does not exist, or a number that it does not have.
    pub fn new(o: &Object, matrix: PetscInt, dofs: Vec<PetscInt>) -> Result<PairSide> {
        let (numbering, n) = match usize::try_from(matrix) {
            Err(_) => (HostNumbering::All, None),
            Ok(k) => (
                HostNumbering::Matrix(k),
                Some(o.size_of(k, "contact pairs name")?),
            ),
        };
        let wrong = |d: &&PetscInt| **d < 0 || n.is_some_and(|n| **d as usize >= n);
        if let Some((r, dof)) = dofs.iter().enumerate().find(|(_, d)| wrong(d)) {
            let expected = match n {
                Some(n) => format!("numbers from 0 to below {n}, those of matrix {matrix}"),
                None => "at least 0".into(),
            };
            return Err(Fault::OutOfRange.error(format!(
                "contact pair {r} of rank {} has unknown {dof}, expected {expected}",
                o.session.rank()
            )));
        }
        Ok(PairSide { numbering, dofs })
    }
}

/// The rows u(first) − u(second) = or ≤ gap.
///
/// # Errors
/// Sides of different lengths, a gap that is not finite, the same unknown on both sides.
pub fn pairs(
    rank: usize,
    first: &PairSide,
    second: &PairSide,
    gap: &[f64],
    law: Law,
) -> Result<Vec<HostRow>> {
    let n = first.dofs.len();
    if second.dofs.len() != n {
        return Err(Fault::Sizes.error(format!(
            "rank {rank} gave {n} unknowns on the first side of contact pairs and {} on the second, expected as many",
            second.dofs.len()
        )));
    }
    let mut rows = Vec::with_capacity(n);
    for (r, (&a, &b)) in first.dofs.iter().zip(&second.dofs).enumerate() {
        let gap = gap.get(r).copied().unwrap_or(0.0);
        if !gap.is_finite() {
            return Err(Fault::Wrong.error(format!(
                "contact pair {r} of rank {rank} has a gap of {gap}, expected a finite one"
            )));
        }
        if a == b && first.numbering == second.numbering {
            return Err(Fault::Wrong.error(format!(
                "contact pair {r} of rank {rank} has unknown {a} on both sides, expected different ones"
            )));
        }
        let terms = vec![
            (first.numbering, a as u32, 1.0),
            (second.numbering, b as u32, -1.0),
        ];
        rows.push(HostRow::new(RowOrigin::Pairs, terms, gap, law));
    }
    Ok(rows)
}

impl Object {
    /// This rank's rows in the numbering of all unknowns, and friction at them.
    ///
    /// # Errors
    /// Rows of matrices that no longer exist; friction at rows without a normal.
    pub fn given_rows(&self) -> Result<(Vec<GivenRow>, Vec<NodeFriction>)> {
        let number = |&(whose, dof, c): &(HostNumbering, u32, f64)| {
            Ok((self.number(whose, dof, "contact pair")?, c))
        };
        let (mut rows, mut friction) = (Vec::new(), Vec::new());
        for (normal, row) in self.rows.iter().enumerate() {
            let terms: Result<Vec<(u32, f64)>> = row.terms.iter().map(number).collect();
            let terms = terms?;
            if row.contact.has_friction() {
                friction.push(NodeFriction {
                    normal,
                    tangents: beside(&terms, self.nodes(), &|| self.named(normal))?,
                    slipped: row.slipped,
                    law: row.contact,
                    area: 1.0,
                });
            }
            rows.push(GivenRow {
                terms,
                gap: row.gap,
                law: row.law,
                compliance: row.contact.compliance(1.0),
            });
        }
        Ok((rows, friction))
    }

    /// The name of a row of this rank in errors.
    pub fn named(&self, row: usize) -> String {
        format!("contact row {row} of rank {}", self.session.rank())
    }

    /// Number of unknowns of a matrix, stacked or from FetiFetiSetMatIS.
    pub fn size_of(&self, k: usize, what: &str) -> Result<usize> {
        let there = match (&self.matis, self.stack.len()) {
            (Some(matis), 0) if k == 0 => return Ok(matis.layout.global_len()),
            (matis, 0) => usize::from(matis.is_some()),
            (_, n) if k < n => return Ok(self.stack.size_of(k)),
            (_, n) => n,
        };
        Err(Fault::OutOfRange.error(format!(
            "{what} matrix {k} but {there} have been added without numbers so far, \
             expected one of these (from 0)"
        )))
    }
}

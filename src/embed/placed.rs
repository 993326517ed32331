//! A row of the host whose dofs have been found, on its way from the rank that gave it to the one that takes it.

use super::parts::body_dof;
use super::torn::GivenRow;
use super::touched::{Holder, Touched};
use crate::substructures::{BodyNode, Law, Row, RowLabel, RowSource, SentLaw};
use bytemuck::{Pod, Zeroable};
use parallel::parcels::Parcels;
use std::collections::BTreeMap;

/// A row with at least one unknown.
pub struct LocatedRow {
    /// Its number among the rows that its rank gave.
    pub number: usize,
    law: Law,
    gap: f64,
    compliance: f64,
    /// Its block of connected rows.
    pub block: u32,
    terms: Vec<LocatedTerm>,
}

/// A term of a row; the dofs of a row differ.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
pub struct LocatedTerm {
    dof: u64,
    coefficient: f64,
    /// The [`code`](Holder::code) of the holder.
    holder: [u64; 2],
}

/// A row on its way, without its terms.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
pub struct SentRow {
    number: usize,
    gap: f64,
    compliance: f64,
    law: SentLaw,
    block: u64,
}

impl LocatedTerm {
    fn holder(&self) -> Holder {
        Holder::of_code(self.holder)
    }
}

impl LocatedRow {
    /// Row `number` of this rank. A row without unknowns is left out: the solver cannot influence whether it holds.
    ///
    /// # Errors
    /// A dof that no subdomain has.
    pub fn new(
        number: usize,
        row: &GivenRow,
        touched: &Touched,
    ) -> Result<Option<LocatedRow>, u32> {
        let mut sums: BTreeMap<u32, f64> = BTreeMap::new();
        for &(dof, c) in &row.terms {
            *sums.entry(dof).or_default() += c;
        }
        let mut block = None;
        let mut terms = Vec::with_capacity(sums.len());
        for (dof, coefficient) in sums {
            let (holder, root) = touched.given[&dof];
            match holder {
                Holder::Nobody => return Err(dof),
                Holder::Body(_) => block = Some(root),
                Holder::Known(_) => {}
            }
            terms.push(LocatedTerm {
                dof: dof.into(),
                coefficient,
                holder: holder.code(),
            });
        }
        Ok(block.map(|block| LocatedRow {
            number,
            law: row.law,
            gap: row.gap,
            compliance: row.compliance,
            block,
            terms,
        }))
    }

    /// Adds the row to those that are sent.
    pub fn give(&self, to: &mut Parcels<SentRow, LocatedTerm>) {
        let row = SentRow {
            number: self.number,
            gap: self.gap,
            compliance: self.compliance,
            law: self.law.sent(),
            block: self.block.into(),
        };
        to.push(row, self.terms.iter().copied());
    }

    /// The row that another rank has sent.
    pub fn received((row, terms): (SentRow, &[LocatedTerm])) -> LocatedRow {
        LocatedRow {
            number: row.number,
            law: row.law.law(),
            gap: row.gap,
            compliance: row.compliance,
            block: row.block as u32,
            terms: terms.to_vec(),
        }
    }

    /// The terms at known dofs: the rank that has the value, the dof and the coefficient.
    pub fn known(&self) -> impl Iterator<Item = (usize, u32, f64)> + '_ {
        self.terms.iter().filter_map(|t| match t.holder() {
            Holder::Known(rank) => Some((rank, t.dof as u32, t.coefficient)),
            _ => None,
        })
    }

    /// The terms at unknowns: the body, the dof and the coefficient.
    fn unknown(&self) -> impl Iterator<Item = (u64, u32, f64)> + Clone + '_ {
        self.terms.iter().filter_map(|t| match t.holder() {
            Holder::Body(body) => Some((body, t.dof as u32, t.coefficient)),
            _ => None,
        })
    }

    /// The row as the method gets it, for a problem of `n_global` dofs. Its label has its bodies, and the first unknown
    /// on each of its two sides.
    pub fn row(&self, n_global: usize) -> Row {
        let nodes = self.unknown().map(|(body, dof, _)| BodyNode {
            body: body as usize,
            node: dof as usize,
        });
        let first = nodes.clone().next();
        let second = { nodes }.find(|n| Some(n.body) != first.map(|f| f.body));
        let source = match second {
            Some(_) => RowSource::Interface(self.number),
            None => RowSource::Obstacle(self.number),
        };
        let terms = self.unknown();
        Row {
            terms: terms
                .map(|(body, dof, c)| (body_dof(n_global, body as usize, dof), c))
                .collect(),
            gap: self.gap,
            law: self.law,
            holds: true,
            block: self.block.into(),
            compliance: self.compliance,
            rounding: 0.0,
            label: RowLabel::new(source, [first, second]),
        }
    }
}

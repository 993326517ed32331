//! A row of the host whose dofs have been found, on its way from the rank that gave it to the one that takes it.

use super::parts::body_dof;
use super::torn::GivenRow;
use super::touched::{Holder, Touched};
use crate::substructures::{BodyNode, Row, RowKind, RowLabel, RowSource};
use std::collections::BTreeMap;

/// A row with at least one unknown.
pub struct Placed {
    /// Its number among the rows that its rank gave.
    pub number: usize,
    kind: RowKind,
    gap: f64,
    /// Its block of connected rows.
    pub block: u32,
    terms: Vec<Term>,
}

/// A term of a row; the dofs of a row differ.
struct Term {
    dof: u32,
    coefficient: f64,
    holder: Holder,
}

impl Placed {
    /// Row `number` of this rank. A row without unknowns is left out: the solver cannot influence whether it holds.
    ///
    /// # Errors
    /// A dof that no subdomain has.
    pub fn new(number: usize, row: &GivenRow, touched: &Touched) -> Result<Option<Placed>, u32> {
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
            terms.push(Term {
                dof,
                coefficient,
                holder,
            });
        }
        Ok(block.map(|block| Placed {
            number,
            kind: row.kind,
            gap: row.gap,
            block,
            terms,
        }))
    }

    /// Appends the row as words.
    pub fn pack(&self, out: &mut Vec<u64>) {
        let kind = u64::from(self.kind == RowKind::Inequality);
        let (gap, n) = (self.gap.to_bits(), self.terms.len());
        out.extend([self.number as u64, kind, gap, self.block.into(), n as u64]);
        for term in &self.terms {
            let [kind, number] = term.holder.words();
            out.extend([term.dof.into(), term.coefficient.to_bits(), kind, number]);
        }
    }

    /// The rows that one rank sent.
    pub fn unpack(words: &[u64]) -> Vec<Placed> {
        let term = |w: &[u64]| Term {
            dof: w[0] as u32,
            coefficient: f64::from_bits(w[1]),
            holder: Holder::of_words(&w[2..]),
        };
        let mut out = Vec::new();
        let mut rest = words;
        while let [number, kind, gap, block, n, tail @ ..] = rest {
            let (terms, tail) = tail.split_at(4 * *n as usize);
            out.push(Placed {
                number: *number as usize,
                kind: match kind {
                    0 => RowKind::Equality,
                    _ => RowKind::Inequality,
                },
                gap: f64::from_bits(*gap),
                block: *block as u32,
                terms: terms.chunks_exact(4).map(term).collect(),
            });
            rest = tail;
        }
        out
    }

    /// The terms at known dofs: the rank that has the value, the dof and the coefficient.
    pub fn known(&self) -> impl Iterator<Item = (usize, u32, f64)> + '_ {
        self.terms.iter().filter_map(|t| match t.holder {
            Holder::Known(rank) => Some((rank, t.dof, t.coefficient)),
            _ => None,
        })
    }

    /// The terms at unknowns: the body, the dof and the coefficient.
    fn unknown(&self) -> impl Iterator<Item = (u64, u32, f64)> + Clone + '_ {
        self.terms.iter().filter_map(|t| match t.holder {
            Holder::Body(body) => Some((body, t.dof, t.coefficient)),
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
            kind: self.kind,
            holds: true,
            block: self.block.into(),
            rounding: 0.0,
            label: RowLabel::new(source, [first, second]),
        }
    }
}

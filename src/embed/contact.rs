//! Rows that the host adds to the assembled problem: contact between bodies, obstacles, equations.
//!
//! The host numbers global dofs, the method numbers body dofs. The method also wants rows that share a dof on the same
//! rank. Therefore all ranks see all rows (there are few, as they belong to surfaces) and find the blocks of connected
//! rows; the lowest dof of a block determines the rank that takes it.

use std::collections::{BTreeMap, HashMap, HashSet};

use super::parts::{body_dof, Part};
use super::torn::GivenRow;
use crate::linalg::sorted::distinct;
use crate::linalg::union_find::UnionFind;
use crate::parallel::exchange::{exchange_words, gather_all};
use crate::petsc::Session;
use crate::substructures::{BodyNode, InterfaceRow, RowKind, RowLabel, RowSource};
use crate::{Error, Result};

/// A row on the rank that takes it.
struct Taken {
    /// The rank that gave it, and its number among the rows given there.
    from: (usize, usize),
    /// The row as the method gets it.
    row: InterfaceRow,
    /// (global dof, coefficient) pairs of its terms at known dofs.
    known: Vec<(u32, f64)>,
}

/// The host's rows, distributed over the ranks.
#[derive(Default)]
pub struct Contact {
    taken: Vec<Taken>,
    /// The block of every unknown that appears in a row, by global dof. A block is named by its lowest dof.
    block: HashMap<u32, u32>,
    /// The rank that takes each row that this rank gave; `None` for rows without unknowns.
    homes: Vec<Option<usize>>,
    /// Whether a row on any rank has a term at a known dof.
    some_known: bool,
    /// Number of rows over all ranks.
    pub n_global: usize,
    /// Whether any row on any rank is an inequality.
    pub inequalities: bool,
}

/// A row as every rank sees it.
struct Seen {
    from: (usize, usize),
    kind: RowKind,
    gap: f64,
    terms: Vec<(u32, f64)>,
}

/// Marks a known dof among the dofs of rows.
const KNOWN: u64 = u64::MAX;

impl Contact {
    /// Distributes the rows `given` by this rank; `known` has the known dofs of this rank, `body_of` the body of every
    /// local part. Collective.
    ///
    /// # Errors
    /// A row with a dof that no subdomain has; the same error on all ranks.
    pub fn new(
        session: &Session,
        n_dofs: usize,
        given: &[GivenRow],
        parts: &[Part],
        known: &HashSet<u32>,
        body_of: &[usize],
    ) -> Result<Contact> {
        let seen = everywhere(session, given);
        let mut out = Contact {
            homes: vec![None; given.len()],
            n_global: seen.len(),
            inequalities: seen.iter().any(|s| s.kind == RowKind::Inequality),
            ..Contact::default()
        };
        if seen.is_empty() {
            return Ok(out);
        }
        let owner = lowest_bodies(session, &seen, parts, known, body_of);
        for row in &seen {
            if let Some((dof, _)) = row.terms.iter().find(|t| !owner.contains_key(&t.0)) {
                return Err(Error::input(format!(
                    "contact row {} of rank {} has a coefficient at unknown {dof}, \
                     which no subdomain has, expected unknowns of subdomains",
                    row.from.1, row.from.0
                )));
            }
        }
        let free = |dof: &u32| owner[dof] != KNOWN;
        out.some_known = seen.iter().flat_map(|s| &s.terms).any(|t| !free(&t.0));
        out.block = blocks(&seen, free);
        for row in seen {
            type Terms = Vec<(u32, f64)>;
            let (unknown, known): (Terms, Terms) = row.terms.iter().partition(|t| free(&t.0));
            // A row without unknowns is left out: the solver cannot influence whether it holds.
            let Some(first) = unknown.first() else {
                continue;
            };
            let root = out.block[&first.0];
            let home = root as usize % session.size();
            if row.from.0 == session.rank() {
                out.homes[row.from.1] = Some(home);
            }
            if home != session.rank() {
                continue;
            }
            let term = |&(dof, c): &(u32, f64)| (body_dof(n_dofs, owner[&dof] as usize, dof), c);
            out.taken.push(Taken {
                from: row.from,
                row: InterfaceRow {
                    terms: unknown.iter().map(term).collect(),
                    gap: row.gap,
                    kind: row.kind,
                    holds: true,
                    block: root.into(),
                    label: label(row.from.1, &unknown, &owner),
                },
                known,
            });
        }
        Ok(out)
    }

    /// The block of a global dof, if a row contains the dof.
    pub fn block(&self, dof: u32) -> Option<u32> {
        self.block.get(&dof).copied()
    }

    /// This rank's rows for the method.
    pub fn rows(&self) -> impl Iterator<Item = InterfaceRow> + '_ {
        self.taken.iter().map(|t| t.row.clone())
    }

    /// Right-hand sides of this rank's rows, with the terms at known dofs moved there. `values` has the values of the
    /// known dofs of this rank's subdomains, by global dof. Collective.
    pub fn gaps(&self, session: &Session, values: &HashMap<u32, f64>) -> Vec<f64> {
        if !self.some_known {
            return self.taken.iter().map(|t| t.row.gap).collect();
        }
        let mine: Vec<u64> = values
            .iter()
            .flat_map(|(&dof, v)| [u64::from(dof), v.to_bits()])
            .collect();
        let all: HashMap<u64, f64> = gather_all(session.comm(), &mine)
            .concat()
            .chunks_exact(2)
            .map(|w| (w[0], f64::from_bits(w[1])))
            .collect();
        let value = |dof: u32| all.get(&u64::from(dof)).copied().unwrap_or(0.0);
        let gap = |t: &Taken| {
            let moved: f64 = t.known.iter().map(|&(dof, c)| c * value(dof)).sum();
            t.row.gap - moved
        };
        self.taken.iter().map(gap).collect()
    }

    /// Passes what this rank knows of the rows that it gave, two words for each, to the ranks that take them; returned
    /// is what is known of each row that this rank takes. Collective.
    pub fn forth(&self, session: &Session, mine: &[[u64; 2]]) -> Vec<[u64; 2]> {
        let mut outgoing: Vec<Vec<u64>> = vec![Vec::new(); session.size()];
        for (r, (home, words)) in self.homes.iter().zip(mine).enumerate() {
            if let Some(home) = home {
                outgoing[*home].extend([r as u64, words[0], words[1]]);
            }
        }
        let mut known = HashMap::new();
        let received = exchange_words(session.comm(), outgoing);
        for (rank, words) in received.iter().enumerate() {
            let triples = words.chunks_exact(3);
            known.extend(triples.map(|w| ((rank, w[0] as usize), [w[1], w[2]])));
        }
        self.taken.iter().map(|t| known[&t.from]).collect()
    }

    /// Replaces the right-hand sides; `mine` has those of the rows that this rank gave. Collective.
    pub fn set_gaps(&mut self, session: &Session, mine: &[f64]) {
        let words: Vec<[u64; 2]> = mine.iter().map(|g| [g.to_bits(), 0]).collect();
        let new = self.forth(session, &words);
        for (taken, words) in self.taken.iter_mut().zip(new) {
            taken.row.gap = f64::from_bits(words[0]);
        }
    }

    /// Returns one number per row, `mine`, to the ranks that gave the rows; zero for rows without unknowns. Collective.
    pub fn back(&self, session: &Session, mine: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut outgoing: Vec<Vec<u64>> = vec![Vec::new(); session.size()];
        for (t, v) in self.taken.iter().zip(mine) {
            outgoing[t.from.0].extend([t.from.1 as u64, v.to_bits()]);
        }
        let mut out = vec![0.0; self.homes.len()];
        for w in exchange_words(session.comm(), outgoing)
            .concat()
            .chunks_exact(2)
        {
            out[w[0] as usize] = f64::from_bits(w[1]);
        }
        out
    }
}

/// The label of row `number`: its bodies and the unknowns on its two sides.
fn label(number: usize, unknown: &[(u32, f64)], owner: &HashMap<u32, u64>) -> RowLabel {
    let nodes = unknown.iter().map(|&(dof, _)| BodyNode {
        body: owner[&dof] as usize,
        node: dof as usize,
    });
    let first = nodes.clone().next();
    let second = nodes
        .clone()
        .find(|n| Some(n.body) != first.map(|f| f.body));
    let source = match second {
        Some(_) => RowSource::Interface(number),
        None => RowSource::Obstacle(number),
    };
    RowLabel::new(source, [first, second])
}

/// All rows on all ranks.
fn everywhere(session: &Session, given: &[GivenRow]) -> Vec<Seen> {
    let mut mine = Vec::new();
    for (r, row) in given.iter().enumerate() {
        let kind = u64::from(row.kind == RowKind::Inequality);
        // Terms at the same dof are added up.
        let mut terms: BTreeMap<u32, f64> = BTreeMap::new();
        for &(dof, c) in &row.terms {
            *terms.entry(dof).or_default() += c;
        }
        mine.extend([r as u64, kind, row.gap.to_bits(), terms.len() as u64]);
        mine.extend(terms.iter().flat_map(|(&d, c)| [u64::from(d), c.to_bits()]));
    }
    let mut seen = Vec::new();
    for (rank, words) in gather_all(session.comm(), &mine).iter().enumerate() {
        let mut rest = &words[..];
        while let [r, kind, gap, n, tail @ ..] = rest {
            let (terms, tail) = tail.split_at(2 * *n as usize);
            seen.push(Seen {
                from: (rank, *r as usize),
                kind: match kind {
                    0 => RowKind::Equality,
                    _ => RowKind::Inequality,
                },
                gap: f64::from_bits(*gap),
                terms: terms
                    .chunks_exact(2)
                    .map(|w| (w[0] as u32, f64::from_bits(w[1])))
                    .collect(),
            });
            rest = tail;
        }
    }
    seen
}

/// For every dof in a row, the lowest body that has it (the other bodies are tied to that one), or [`KNOWN`].
fn lowest_bodies(
    session: &Session,
    seen: &[Seen],
    parts: &[Part],
    known: &HashSet<u32>,
    body_of: &[usize],
) -> HashMap<u32, u64> {
    let touched = distinct(seen.iter().flat_map(|s| &s.terms).map(|t| t.0));
    let mut mine = Vec::new();
    for &dof in &touched {
        if known.contains(&dof) {
            mine.extend([u64::from(dof), KNOWN]);
        }
        for (part, &body) in parts.iter().zip(body_of) {
            if part.dofs.binary_search(&dof).is_ok() {
                mine.extend([u64::from(dof), body as u64]);
            }
        }
    }
    let mut lowest = HashMap::new();
    for w in gather_all(session.comm(), &mine).concat().chunks_exact(2) {
        let entry = lowest.entry(w[0] as u32).or_insert(w[1]);
        *entry = w[1].min(*entry);
    }
    lowest
}

/// Maps every unknown in a row to the lowest dof of its block of connected rows.
fn blocks(seen: &[Seen], free: impl Fn(&u32) -> bool) -> HashMap<u32, u32> {
    let unknowns = |row: &Seen| row.terms.iter().map(|t| t.0).filter(&free).collect();
    let rows: Vec<Vec<u32>> = seen.iter().map(unknowns).collect();
    let dofs = distinct(rows.concat());
    let place = |dof: &u32| dofs.binary_search(dof).expect("every dof is in the list");
    let mut sets = UnionFind::new(dofs.len());
    for row in &rows {
        for dof in row.iter().skip(1) {
            sets.join(place(&row[0]), place(dof));
        }
    }
    let lowest = |(k, &dof)| (dof, dofs[sets.find(k)]);
    dofs.iter().enumerate().map(lowest).collect()
}

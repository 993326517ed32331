//! The dofs that the host's rows touch: which body has each, and which rows they connect.
//!
//! Rows may be given on ranks that have none of their dofs. The rank that owns a dof in the host's vectors therefore
//! brings together those that gave rows with the dof and those whose subdomains have it; no rank sees other dofs.

use std::collections::{BTreeMap, HashMap, HashSet};

use super::parts::TornSubdomain;
use super::torn::GivenRows;
use crate::Result;
use base::linalg::sorted::distinct;
use base::linalg::union_find::UnionFind;
use parallel::exchange::{any, exchange, exchange_by_rank};
use parallel::halo::Halo;
use parallel::owners::Owners;
use petsc::{Session, Vec as PetscVec};

/// This rank's part of the host's problem.
pub struct RankProblem<'a> {
    /// A vector of the host's layout.
    pub layout: &'a PetscVec,
    /// The global dofs of this rank's pieces, increasing.
    pub ghosts: &'a [u32],
    pub halo: &'a Halo,
    /// The known dofs among the global dofs of this rank's pieces.
    pub known: &'a HashSet<u32>,
    /// This rank's subdomains.
    pub parts: &'a [TornSubdomain],
    /// The body of each.
    pub body_of: &'a [usize],
}

/// Who has a dof of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Holder {
    /// An unknown of this body. Where several have it, the lowest: the others are tied to that one.
    Body(u64),
    /// A known dof, whose value this rank has; the lowest of several.
    Known(usize),
    /// No subdomain has it.
    Nobody,
}

impl Holder {
    /// A number for the kind of holder, and its number, as ranks tell each other.
    pub fn code(self) -> [u64; 2] {
        match self {
            Holder::Body(body) => [0, body],
            Holder::Known(rank) => [1, rank as u64],
            Holder::Nobody => [2, 0],
        }
    }

    /// The holder with this [`code`](Self::code).
    pub fn of_code([kind, number]: [u64; 2]) -> Holder {
        match kind {
            0 => Holder::Body(number),
            1 => Holder::Known(number as usize),
            _ => Holder::Nobody,
        }
    }
}

/// The dofs that rows touch, as one rank sees them.
pub struct Touched {
    /// The holders of the dofs in the rows that this rank gave, with the block of connected rows of each unknown.
    pub given: HashMap<u32, (Holder, u32)>,
    /// The block of every unknown of this rank's subdomains that a row on any rank touches.
    pub here: HashMap<u32, u32>,
}

/// A touched dof as its owner knows it.
struct Owned {
    holder: Holder,
    /// The lowest dof of the connected rows that are known so far.
    block: u32,
    /// Ranks that gave rows with the dof.
    askers: Vec<usize>,
    /// Ranks whose pieces have it.
    holders: Vec<usize>,
}

impl Touched {
    /// Finds the dofs of the rows `given` by this rank. A block of connected rows is named by its lowest unknown; the
    /// rows of a node with friction are connected. Collective.
    ///
    /// # Errors
    /// PETSc's own.
    pub fn new(session: &Session, given: &GivenRows, here: &RankProblem<'_>) -> Result<Touched> {
        let range = here.layout.ownership_range();
        let owners = Owners::new(session.comm(), range.start);
        let dofs = distinct(given.rows.iter().flat_map(|row| &row.terms).map(|t| t.0));
        let mut owned = asked(session, &owners, &dofs);
        reported(session, &owners, here, &mut owned)?;
        let holders = report_holders(session, &owned);
        let unknown = |k: &usize| matches!(holders[*k], Holder::Body(_));
        let place = |dof: &u32| dofs.binary_search(dof).expect("every dof is in the list");
        let mut sets = UnionFind::new(dofs.len());
        let terms = |row: usize| given.rows[row].terms.iter();
        let mut join = |rows: &mut dyn Iterator<Item = usize>| {
            let places = rows.flat_map(terms).map(|t| place(&t.0));
            let mut unknowns = places.filter(unknown);
            if let Some(first) = unknowns.next() {
                unknowns.for_each(|k| sets.join(first, k));
            }
        };
        (0..given.rows.len()).for_each(|row| join(&mut std::iter::once(row)));
        for node in &given.friction {
            join(&mut node.tangential.iter().copied().chain([node.normal]));
        }
        let unknowns: Vec<usize> = (0..dofs.len()).filter(unknown).collect();
        let blocks = connect(session, &owners, (&dofs, &unknowns), &mut sets, &mut owned);
        let each = dofs.iter().zip(holders).zip(blocks);
        Ok(Touched {
            given: each
                .map(|((&dof, holder), block)| (dof, (holder, block)))
                .collect(),
            here: to_holders(session, &owned),
        })
    }
}

/// The dofs that this rank owns and some rank asks for; `dofs` has those that this one asks for. Collective.
fn asked(session: &Session, owners: &Owners, dofs: &[u32]) -> BTreeMap<u32, Owned> {
    let mut outgoing = vec![Vec::new(); session.size()];
    for &dof in dofs {
        outgoing[owners.of(dof)].push(dof);
    }
    let mut owned: BTreeMap<u32, Owned> = BTreeMap::new();
    let received = exchange_by_rank(session.comm(), outgoing);
    for (rank, dofs) in received.into_iter().enumerate() {
        for dof in dofs {
            let new = || Owned {
                holder: Holder::Nobody,
                block: dof,
                askers: Vec::new(),
                holders: Vec::new(),
            };
            owned.entry(dof).or_insert_with(new).askers.push(rank);
        }
    }
    owned
}

/// Tells the owners who has their dofs. Collective.
fn reported(
    session: &Session,
    owners: &Owners,
    here: &RankProblem<'_>,
    owned: &mut BTreeMap<u32, Owned>,
) -> Result<()> {
    let marks = here.layout.duplicate()?;
    marks.set(0.0)?;
    {
        let first = here.layout.ownership_range().start;
        let mut entries = marks.array_mut()?;
        for dof in owned.keys() {
            // The last rank is asked for numbers that no vector has, too.
            if let Some(mark) = entries.get_mut(*dof as usize - first) {
                *mark = 1.0;
            }
        }
    }
    let mut marked = vec![0.0; here.ghosts.len()];
    here.halo.fetch(&marks, &mut marked)?;
    let touched = here.ghosts.iter().zip(marked).filter(|(_, m)| *m != 0.0);
    let touched: Vec<u32> = touched.map(|(&dof, _)| dof).collect();
    let mut outgoing = vec![Vec::new(); session.size()];
    let mut report = |dof: u32, body: u64| {
        outgoing[owners.of(dof)].push([u64::from(dof), body]);
    };
    for &dof in touched.iter().filter(|d| here.known.contains(d)) {
        report(dof, KNOWN);
    }
    for (part, &body) in here.parts.iter().zip(here.body_of) {
        let [Some(first), Some(last)] = [part.dofs.first(), part.dofs.last()] else {
            continue;
        };
        let start = touched.partition_point(|d| d < first);
        let end = touched.partition_point(|d| d <= last);
        let in_part = |d: &&u32| part.dofs.binary_search(d).is_ok();
        for &dof in touched[start..end].iter().filter(in_part) {
            report(dof, body as u64);
        }
    }
    let received = exchange_by_rank(session.comm(), outgoing);
    for (rank, reports) in received.into_iter().enumerate() {
        for [dof, body] in reports {
            let dof = owned.get_mut(&(dof as u32)).expect("it was marked");
            dof.holder = match (dof.holder, body) {
                (Holder::Body(known), body) => Holder::Body(known.min(body)),
                (Holder::Known(first), KNOWN) => Holder::Known(first),
                (Holder::Nobody, KNOWN) => Holder::Known(rank),
                (_, body) => Holder::Body(body),
            };
            if dof.holders.last() != Some(&rank) {
                dof.holders.push(rank);
            }
        }
    }
    Ok(())
}

/// In the place of a body: the dof is known.
const KNOWN: u64 = u64::MAX;

/// Where the dofs are that this rank asked for, in their order. Collective.
fn report_holders(session: &Session, owned: &BTreeMap<u32, Owned>) -> Vec<Holder> {
    let mut outgoing = vec![Vec::new(); session.size()];
    for dof in owned.values() {
        for &rank in &dof.askers {
            outgoing[rank].push(dof.holder.code());
        }
    }
    // Higher ranks own higher dofs.
    let codes = exchange(session.comm(), outgoing).into_iter();
    codes.map(Holder::of_code).collect()
}

/// The block of each of the dofs, of which some are unknowns. `sets` are connected by rows that this rank gave. Owners
/// and those who gave rows tell each other the lowest dof that they know, until nobody learns of a lower one.
/// Collective.
fn connect(
    session: &Session,
    owners: &Owners,
    (dofs, unknowns): (&[u32], &[usize]),
    sets: &mut UnionFind,
    owned: &mut BTreeMap<u32, Owned>,
) -> Vec<u32> {
    // By set and by dof: the lowest one, as it is here and as the owner knows it.
    let mut lowest = dofs.to_vec();
    let mut told = dofs.to_vec();
    loop {
        let mut outgoing = vec![Vec::new(); session.size()];
        let mut news = false;
        for &k in unknowns {
            let low = lowest[sets.find(k)];
            if low < told[k] {
                news = true;
                outgoing[owners.of(dofs[k])].push([dofs[k], low]);
            }
        }
        if !any(session.comm(), news) {
            return (0..dofs.len()).map(|k| lowest[sets.find(k)]).collect();
        }
        let mut changed = Vec::new();
        for [dof, low] in exchange(session.comm(), outgoing) {
            let known = owned.get_mut(&dof).expect("it was asked for");
            if low < known.block {
                known.block = low;
                changed.push(dof);
            }
        }
        let mut outgoing = vec![Vec::new(); session.size()];
        for dof in distinct(changed) {
            for &rank in &owned[&dof].askers {
                outgoing[rank].push([dof, owned[&dof].block]);
            }
        }
        for [dof, low] in exchange(session.comm(), outgoing) {
            let k = dofs.binary_search(&dof);
            let k = k.expect("this rank asked for it");
            told[k] = low;
            let set = sets.find(k);
            lowest[set] = lowest[set].min(told[k]);
        }
    }
}

/// The block of every touched unknown of this rank's subdomains. Collective.
fn to_holders(session: &Session, owned: &BTreeMap<u32, Owned>) -> HashMap<u32, u32> {
    let mut outgoing = vec![Vec::new(); session.size()];
    let unknown = |o: &&Owned| matches!(o.holder, Holder::Body(_));
    for (&dof, it) in owned.iter().filter(|(_, o)| unknown(o)) {
        for &rank in &it.holders {
            outgoing[rank].push([dof, it.block]);
        }
    }
    let pairs = exchange(session.comm(), outgoing).into_iter();
    pairs.map(|[dof, block]| (dof, block)).collect()
}

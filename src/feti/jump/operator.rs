//! The jump operator B = [B_loc; B_gl] and the scaled jump operator B_D, distributed over the ranks.
//!
//! Rows (multipliers) are numbered rank after rank. A row of B_loc is owned by the rank of its dof's lowest subdomain,
//! a contact row by the rank that provides it. A rank also sees *ghost* rows: all rows that touch its subdomains.

use std::ops::Range;

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;
use rustc_hash::FxHashMap;

use super::blocks::{Block, JumpBlockEntry};
use super::columns::{JumpEntries, JumpEntry};
use super::coupled::slots::Slots;
use super::coupled::MANY;
use super::entry_locations::{EntryLocation, EntryPlaces};
use super::ghost_rows::GhostRows;
use super::scaling;
use crate::feti::interface::entities::Average;
use crate::feti::interface::location::Locations;
use crate::feti::interface::sharing::{Copy, DofSharing};
use crate::feti::jump::blocks;
use crate::substructures::{Law, Problem};
use parallel::exchange::{any, exchange, offsets, total};

/// The dual space and its operators.
#[derive(Debug, Default)]
pub struct Jump {
    /// First global number of the rows that this rank owns.
    pub first: usize,
    /// Number of rows that this rank owns.
    pub n_owned: usize,
    /// Number of rows over all ranks, m.
    pub n_global: usize,
    /// Number of owned rows of B_loc. They come first; the others are rows of B_gl.
    pub(in crate::feti) n_owned_local: usize,
    /// Rows of B_loc over all ranks.
    pub n_local: usize,
    /// Global number of each ghost row, increasing.
    pub ghosts: Vec<u32>,
    /// Whether each ghost row is a row of B_gl.
    pub ghost_is_contact: Vec<bool>,
    /// Right-hand side c of each owned row.
    pub gap: Vec<f64>,
    /// The right-hand side that each owned row is solved with: c, or the nearest one that the holding rows of its block
    /// can satisfy together.
    pub held: Vec<f64>,
    /// The law of each owned row; rows of B_loc are ties.
    pub law: Vec<Law>,
    /// C of each owned row; empty if all are rigid, on all ranks.
    pub compliance: Vec<f64>,
    /// Whether some row gives way, on any rank.
    pub is_soft: bool,
    /// Z⁰ on the owned rows: whether the row holds to begin with.
    pub initial: Vec<bool>,
    /// Z^k on the owned rows: whether the row holds.
    pub active: Vec<bool>,
    /// The multiplier of each owned row that does not hold and has a law with given multipliers; empty without any.
    pub given_multipliers: Vec<f64>,
    /// Blocks of the owned rows of B_gl.
    pub blocks: Vec<Block>,
    /// The scalings of blocks so far.
    pub(super) known: scaling::ScalingCache,
    /// The block of each owned row of B_gl.
    pub(super) block_of: Vec<u32>,
    /// The dofs of coupled blocks.
    pub slots: Slots,
    /// For each owned row of B_gl, its index among the rows that this rank provides.
    pub(in crate::feti) order: Vec<usize>,
    /// First owned local row of each local subdomain, and the end. A subdomain has the rows of the dofs in which it is
    /// the lowest subdomain.
    pub local_start: Vec<usize>,
    /// Where the subdomains with entries in the owned rows are.
    pub(super) locations: Locations,
    /// Global indices of the local subdomains, increasing.
    pub(crate) subdomains: Vec<u32>,
    /// Where the subdomains have the entries of B_gl.
    pub(super) places: EntryPlaces,
    /// Entries by local subdomain.
    pub columns: JumpEntries,
    /// Dual interface dofs of each local subdomain, increasing.
    pub delta: Vec<Vec<u32>>,
    /// Primal interface dofs of each local subdomain: first those shared with other subdomains of the body, then
    /// corners of the body that may touch other bodies.
    pub primal: Vec<Vec<u32>>,
    /// Number of shared primal dofs of each local subdomain.
    pub n_shared: Vec<usize>,
    /// Averages over dual dofs of each local subdomain that are primal too.
    pub averages: Vec<Vec<Average>>,
}

impl Jump {
    /// The blocks of the owned rows of B_gl: the number that the scene gave to each, and its rows among the owned ones.
    pub fn numbered_blocks<'a>(
        &'a self,
        problem: &'a Problem,
    ) -> impl Iterator<Item = (u64, Range<usize>)> + 'a {
        self.blocks.iter().map(|block| {
            let first = self.given(block.rows.start);
            (problem.rows[first].block, block.rows.clone())
        })
    }

    /// Builds Z B and Z B_D with the rows that hold to begin with. Collective.
    pub fn new(comm: &SimpleCommunicator, problem: &Problem, sharing: &DofSharing) -> Jump {
        Jump::coupling(comm, problem, sharing, MANY)
    }

    /// Builds Z B and Z B_D with the rows that hold to begin with; blocks with more than `many` rows are coupled.
    /// Collective.
    pub fn coupling(
        comm: &SimpleCommunicator,
        problem: &Problem,
        sharing: &DofSharing,
        many: usize,
    ) -> Jump {
        let mut outgoing: Vec<Vec<JumpBlockEntry>> = (0..comm.size()).map(|_| Vec::new()).collect();
        let mut send = |entry: JumpBlockEntry| {
            outgoing[sharing.locations.rank(entry.subdomain)].push(entry);
        };

        let (own_local, per_subdomain) = local_groups(problem, sharing);
        let n_owned_local = own_local.iter().map(|g| g.len() * (g.len() - 1) / 2).sum();
        let n_owned = n_owned_local + problem.rows.len();
        let (first, n_global) = offsets(comm, n_owned);

        let mut row = first as u32;
        for group in &own_local {
            let weights: Vec<f64> = group.iter().map(|c| c.weight).collect();
            for a in 0..group.len() {
                for b in a + 1..group.len() {
                    for (c, copy) in group.iter().enumerate() {
                        let bd = scaling::pair_entry(&weights, (a, b), c);
                        let sign = f64::from(u8::from(c == a)) - f64::from(u8::from(c == b));
                        send(JumpBlockEntry::new(row, copy, false, [sign, sign, bd]));
                    }
                    row += 1;
                }
            }
        }

        let (order, mut blocks) = blocks::collect(problem, sharing, (n_owned_local, many));
        let locals_hold = std::iter::repeat_n(true, n_owned_local);
        let contacts_hold = order.iter().map(|&r| problem.rows[r].holds);
        let active: Vec<bool> = locals_hold.chain(contacts_hold).collect();
        let mut known = scaling::ScalingCache::default();
        for block in &mut blocks {
            let active = &active[block.rows.clone()];
            block.start(first, active, &mut known, &mut send);
        }

        let rows: Vec<_> = order.iter().map(|&r| &problem.rows[r]).collect();
        let zeros = std::iter::repeat_n(0.0, n_owned_local);
        let ties = std::iter::repeat_n(Law::Tie, n_owned_local);
        let is_soft = any(comm, rows.iter().any(|r| r.compliance > 0.0));
        let soft = zeros.clone().chain(rows.iter().map(|r| r.compliance));
        let numbered = (0..).zip(&blocks);
        let block_of = numbered.flat_map(|(k, block)| block.rows.clone().map(move |_| k));
        let mut jump = Jump {
            block_of: block_of.collect(),
            first,
            n_owned,
            n_global,
            n_owned_local,
            n_local: total(comm, n_owned_local as f64) as usize,
            gap: zeros.clone().chain(rows.iter().map(|r| r.gap)).collect(),
            law: ties.chain(rows.iter().map(|r| r.law)).collect(),
            compliance: if is_soft { soft.collect() } else { Vec::new() },
            is_soft,
            initial: active.clone(),
            averages: sharing.averages.clone(),
            active,
            blocks,
            known,
            order,
            local_start: per_subdomain,
            locations: sharing.locations.clone(),
            subdomains: problem.local.iter().map(|s| s.index as u32).collect(),
            ..Jump::default()
        };
        jump.held = jump.gap.clone();
        jump.reconcile_all();
        jump.receive(problem, sharing, exchange(comm, outgoing));
        let (slots, places) = Slots::new(comm, &jump.blocks, &jump.locations, &jump.subdomains);
        jump.columns.couple(places);
        jump.slots = slots;
        jump
    }

    /// Replaces c; `gaps` is in the order in which this rank provides its rows.
    pub fn set_gaps(&mut self, gaps: &[f64]) {
        let rows = &mut self.gap[self.n_owned_local..];
        for (c, &r) in rows.iter_mut().zip(&self.order) {
            *c = gaps[r];
        }
        self.held.clone_from(&self.gap);
        self.reconcile_all();
    }

    /// The owned rows of B_gl. The rows before them belong to B_loc.
    pub fn rows_between_bodies(&self) -> std::ops::Range<usize> {
        self.n_owned_local..self.n_owned
    }

    /// Index of owned row `i` of B_gl among the rows that this rank provides.
    pub fn given(&self, i: usize) -> usize {
        self.order[i - self.n_owned_local]
    }

    /// The owned row of each row that this rank provides.
    pub fn places(&self) -> Vec<usize> {
        let rows = self.rows_between_bodies();
        let mut place = vec![0; rows.len()];
        for i in rows {
            place[self.given(i)] = i;
        }
        place
    }

    /// Values of `owned` on the owned rows of B_gl, in the order in which this rank provides them.
    pub fn in_given_order<T: Clone + Default>(&self, owned: &[T]) -> Vec<T> {
        let mut out = vec![T::default(); self.order.len()];
        for (&r, value) in self.order.iter().zip(&owned[self.n_owned_local..]) {
            out[r] = value.clone();
        }
        out
    }

    /// Turns B u − c on the owned rows into B u − C λ − c.
    pub fn less_compression(&self, lambda: &[f64], gaps: &mut [f64]) {
        let rows = self.compliance.iter().zip(lambda);
        gaps.iter_mut()
            .zip(rows)
            .for_each(|(g, (c, l))| *g -= c * l);
    }

    /// Whether owned row `i` may hold at all. Open rows of faces that are partly tied may not.
    pub fn is_candidate(&self, i: usize) -> bool {
        self.law[i].is_inequality() || self.initial[i]
    }

    fn receive(&mut self, problem: &Problem, sharing: &DofSharing, entries: Vec<JumpBlockEntry>) {
        let seen = GhostRows::new(self.first, self.n_owned, &entries);
        (self.ghosts, self.ghost_is_contact) = seen.all().unzip();

        // Sorted by subdomain first, then by dof and row: each sort is small.
        let numbered = problem.local.iter().zip(0..);
        let here: FxHashMap<u32, u32> = numbered.map(|(s, j)| (s.index as u32, j)).collect();
        let mut dealt: Vec<Vec<(u32, u32, u32)>> = vec![Vec::new(); problem.local.len()];
        let of_contact = entries.iter().filter(|e| e.is_contact()).count();
        let mut places: Vec<(u32, EntryLocation)> = Vec::with_capacity(of_contact);
        self.columns = JumpEntries::with_room(entries.len(), of_contact);
        for (k, e) in (0..).zip(&entries) {
            let row = seen.place(e.row);
            dealt[here[&e.subdomain] as usize].push((e.local, row, k));
        }
        for (j, sub) in problem.local.iter().enumerate() {
            let mut mine = std::mem::take(&mut dealt[j]);
            mine.sort_unstable();
            // Corners of a body with several subdomains are primal too, but not those of a solid. With ν near 1/2,
            // holding a corner makes the coarse functions stiffer than the cut that it saves.
            let scalar = sub.near_kernel.as_ref().is_none_or(|n| n.len() < 2);
            let pinned = scalar && sharing.homes[&sub.body].is_cut;
            let mut dual = Vec::new();
            let mut corners = Vec::new();
            for (_, row, k) in mine {
                let e = &entries[k as usize];
                let (at, b, bd) = (e.local, e.b, e.bd);
                let k = self.columns.push(JumpEntry { row, at, b, bd });
                if e.is_contact() {
                    self.columns.push_contact(k, e.full);
                    let (subdomain, dof) = (j as u32, e.local);
                    let place = EntryLocation {
                        subdomain,
                        dof,
                        entry: k,
                    };
                    places.push((row, place));
                }
                let vertex = sharing.vertices && sub.primal.binary_search(&e.local).is_ok();
                let alone = sharing.shared(sub.dofs[e.local as usize]).is_empty();
                if e.is_contact() && vertex && alone && pinned {
                    corners.push(e.local);
                } else {
                    dual.push(e.local);
                }
            }
            let shared = sharing.shared_dofs[j].iter().copied();
            let mut primal: Vec<u32> = shared
                .filter(|&i| DofSharing::is_primal(sharing.shared(sub.dofs[i as usize])))
                .collect();
            corners.dedup();
            dual.dedup();
            dual.retain(|i| primal.binary_search(i).is_err());
            dual.shrink_to_fit();
            self.n_shared.push(primal.len());
            primal.extend(corners);
            self.columns.end();
            self.delta.push(dual);
            self.primal.push(primal);
        }
        self.places = EntryPlaces::new(self.ghosts.len(), &places);
    }

    /// The local subdomain with this global index.
    ///
    /// # Panics
    /// If none has.
    pub fn local_index(&self, subdomain: u32) -> usize {
        let found = self.subdomains.binary_search(&subdomain);
        found.expect("the subdomain is on this rank")
    }

    /// Turns the entries' local dofs into positions in `interface` (the order of Γ) of subdomain `j`.
    pub fn place(&mut self, j: usize, interface: &[u32]) {
        let mut position: Vec<(u32, u32)> = interface.iter().copied().zip(0..).collect();
        position.sort_unstable();
        self.columns.renumber(j, |dof| {
            let found = position.binary_search_by_key(&dof, |p| p.0);
            position[found.expect("a row's dof is an interface dof")].1
        });
    }
}

/// The dual dofs shared inside a body whose lowest subdomain lives on this rank, in a reproducible order, and the start
/// (and end) of the rows of each local subdomain.
fn local_groups<'a>(problem: &Problem, sharing: &'a DofSharing) -> (Vec<&'a [Copy]>, Vec<usize>) {
    let mut groups = Vec::new();
    let mut start = vec![0];
    let mut rows = 0;
    for (sub, shared) in problem.local.iter().zip(&sharing.shared_dofs) {
        for &i in shared {
            let copies = sharing.shared(sub.dofs[i as usize]);
            let lowest = copies
                .first()
                .is_some_and(|c| c.subdomain as usize == sub.index);
            if lowest && !DofSharing::is_primal(copies) {
                groups.push(copies);
                rows += copies.len() * (copies.len() - 1) / 2;
            }
        }
        start.push(rows);
    }
    (groups, start)
}

//! The jump operator B = [B_loc; B_gl] and its scaled companion B_D, as every rank sees them.
//!
//! Rows (multipliers) are numbered rank after rank; the rank of a dof's lowest subdomain owns its local rows, the
//! rank that provides a contact row owns that. A rank also sees *ghost* rows: all those that touch
//! its subdomains. Entries are kept per subdomain on interface positions, B and B_D side by side.

use std::ops::Range;

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use super::exchange::{exchange, offsets, sum_all, Record};
use super::local::dense::Dense;
use super::scaling;
use super::sharing::{Copy, Sharing};
use crate::substructures::{RowKind, Substructures};

/// The entries of B and B_D in the columns of one subdomain.
#[derive(Debug, Clone, Default)]
pub struct JumpColumns {
    /// Ghost row of each entry.
    pub row: Vec<u32>,
    /// Interface position (index into Γ) of each entry; before [`Jump::place`], the local dof.
    pub at: Vec<u32>,
    /// Entry of Z B (zero where only B_D has one, and in rows that do not hold).
    pub b: Vec<f64>,
    /// Entry of Z B_D.
    pub bd: Vec<f64>,
}

impl JumpColumns {
    /// v ← Bᵀ λ on this subdomain's interface.
    pub fn b_transpose(&self, ghost: &[f64], v: &mut [f64]) {
        v.fill(0.0);
        for ((&r, &i), &b) in self.row.iter().zip(&self.at).zip(&self.b) {
            v[i as usize] += b * ghost[r as usize];
        }
    }

    /// v ← B_Dᵀ λ on this subdomain's interface.
    pub fn bd_transpose(&self, ghost: &[f64], v: &mut [f64]) {
        v.fill(0.0);
        for ((&r, &i), &b) in self.row.iter().zip(&self.at).zip(&self.bd) {
            v[i as usize] += b * ghost[r as usize];
        }
    }

    /// ghost ← ghost + B y.
    pub fn add_b(&self, y: &[f64], ghost: &mut [f64]) {
        for ((&r, &i), &b) in self.row.iter().zip(&self.at).zip(&self.b) {
            ghost[r as usize] += b * y[i as usize];
        }
    }

    /// ghost ← ghost + B_D y.
    pub fn add_bd(&self, y: &[f64], ghost: &mut [f64]) {
        for ((&r, &i), &b) in self.row.iter().zip(&self.at).zip(&self.bd) {
            ghost[r as usize] += b * y[i as usize];
        }
    }
}

/// Rows of B_gl that share body dofs, on the rank that owns them.
#[derive(Debug)]
pub struct Block {
    /// Owned rows of the block (indices among this rank's rows).
    pub rows: Range<usize>,
    /// Body dofs that the rows touch.
    pub dofs: Vec<u64>,
    /// B on (rows, dofs).
    pub b: Dense,
    /// D summed over the copies of each dof.
    pub weights: Vec<f64>,
}

/// The dual space and its operators.
#[derive(Debug, Default)]
pub struct Jump {
    /// Rows owned by this rank: first global number and count.
    pub first: usize,
    /// Number of rows that this rank owns.
    pub n_owned: usize,
    /// Number of rows over all ranks, m.
    pub n_global: usize,
    /// How many of the owned rows (the first ones) tie subdomains inside a body; the others are rows of B_gl.
    pub n_owned_local: usize,
    /// Rows of B_loc over all ranks.
    pub n_local: usize,
    /// Global number of each ghost row, increasing.
    pub ghosts: Vec<u32>,
    /// Which ghost rows are rows of B_gl.
    pub ghost_is_contact: Vec<bool>,
    /// Right-hand side c of each owned row.
    pub gap: Vec<f64>,
    /// Whether each owned row may be switched off by the contact loop.
    pub inequality: Vec<bool>,
    /// Z^k on the owned rows: whether the row holds.
    pub active: Vec<bool>,
    /// Blocks of the owned rows of B_gl.
    pub blocks: Vec<Block>,
    /// Entries by local subdomain.
    pub columns: Vec<JumpColumns>,
    /// Dual interface dofs of each local subdomain, increasing.
    pub delta: Vec<Vec<u32>>,
    /// Primal interface dofs of each local subdomain: those shared with other subdomains of the body, then corners of the body
    /// that may touch other bodies.
    pub primal: Vec<Vec<u32>>,
    /// How many of them are shared.
    pub n_shared: Vec<usize>,
}

/// One entry of B and B_D on its way to the rank of its subdomain.
#[derive(Clone)]
struct Entry {
    row: u64,
    subdomain: u32,
    local: u32,
    contact: bool,
    b: f64,
    bd: f64,
}

impl Record for Entry {
    const WORDS: usize = 4;
    fn pack(&self, out: &mut Vec<u64>) {
        let place = u64::from(self.subdomain) << 32 | u64::from(self.local);
        let row = self.row << 1 | u64::from(self.contact);
        out.extend([row, place, self.b.to_bits(), self.bd.to_bits()]);
    }
    fn unpack(w: &[u64]) -> Self {
        Entry {
            row: w[0] >> 1,
            subdomain: (w[1] >> 32) as u32,
            local: (w[1] & u64::from(u32::MAX)) as u32,
            contact: w[0] & 1 == 1,
            b: f64::from_bits(w[2]),
            bd: f64::from_bits(w[3]),
        }
    }
}

impl Jump {
    /// Builds Z B and Z B_D with the rows that hold to begin with. Collective.
    pub fn new(comm: &SimpleCommunicator, problem: &Substructures, sharing: &Sharing) -> Jump {
        let rank = comm.rank() as u32;
        let mut outgoing: Vec<Vec<Entry>> = (0..comm.size()).map(|_| Vec::new()).collect();
        let mut send = |entry: Entry| {
            let to = sharing.rank_of[entry.subdomain as usize];
            outgoing[to as usize].push(entry);
        };

        let own_local = local_groups(problem, sharing, rank);
        let n_owned_local = own_local.iter().map(|g| g.len() * (g.len() - 1) / 2).sum();
        let n_owned = n_owned_local + problem.rows.len();
        let (first, n_global) = offsets(comm, n_owned);

        let mut row = first as u64;
        for group in &own_local {
            let weights: Vec<f64> = group.iter().map(|c| c.weight).collect();
            for a in 0..group.len() {
                for b in a + 1..group.len() {
                    for (c, copy) in group.iter().enumerate() {
                        let bd = scaling::pair_entry(&weights, (a, b), c);
                        let sign = f64::from(u8::from(c == a)) - f64::from(u8::from(c == b));
                        send(Entry::new(row, copy, false, sign, bd));
                    }
                    row += 1;
                }
            }
        }

        let (order, blocks) = contact_blocks(problem, sharing, n_owned_local);
        let locals_hold = std::iter::repeat_n(true, n_owned_local);
        let contacts_hold = order.iter().map(|&r| problem.rows[r].holds);
        let active: Vec<bool> = locals_hold.chain(contacts_hold).collect();
        for block in &blocks {
            let holds: Vec<bool> = block.rows.clone().map(|r| active[r]).collect();
            let bd = scaling::block(&block.b, &block.weights, &holds);
            for (r, &on) in holds.iter().enumerate() {
                let row = (first + block.rows.start + r) as u64;
                for (j, dof) in block.dofs.iter().enumerate() {
                    // A row acts on the weighted average of the copies of one body (method section 3);
                    // B_Dᵀ λ is then the same on all of them, as a function in W̃ must be.
                    for copy in &sharing.copies[dof] {
                        let share = copy.weight / block.weights[j];
                        let b = if on { block.b.get(r, j) * share } else { 0.0 };
                        send(Entry::new(row, copy, true, b, bd.get(r, j)));
                    }
                }
            }
        }

        let rows = order.iter().map(|&r| &problem.rows[r]);
        let zeros = std::iter::repeat_n(0.0, n_owned_local);
        let never = std::iter::repeat_n(false, n_owned_local);
        let mut n_local = [n_owned_local as f64];
        sum_all(comm, &mut n_local);
        let mut jump = Jump {
            first,
            n_owned,
            n_global,
            n_owned_local,
            n_local: n_local[0] as usize,
            gap: zeros.chain(rows.clone().map(|r| r.gap)).collect(),
            inequality: never
                .chain(rows.map(|r| r.kind == RowKind::Inequality))
                .collect(),
            active,
            blocks,
            ..Jump::default()
        };
        jump.receive(problem, sharing, exchange(comm, &outgoing).concat());
        jump
    }

    fn receive(&mut self, problem: &Substructures, sharing: &Sharing, mut entries: Vec<Entry>) {
        let mut ghosts: Vec<(u32, bool)> =
            entries.iter().map(|e| (e.row as u32, e.contact)).collect();
        ghosts.sort_unstable();
        ghosts.dedup();
        (self.ghosts, self.ghost_is_contact) = ghosts.into_iter().unzip();

        let mut subdomains_of = vec![0; problem.n_bodies];
        for &body in &sharing.body_of {
            subdomains_of[body as usize] += 1;
        }
        entries.sort_unstable_by_key(|e| (e.subdomain, e.local, e.row));
        let mut rest = &entries[..];
        for sub in &problem.local {
            let n = rest.partition_point(|e| e.subdomain as usize == sub.index);
            let (mine, others) = rest.split_at(n);
            rest = others;
            let mut columns = JumpColumns::default();
            let mut dual = Vec::new();
            let mut corners = Vec::new();
            for e in mine {
                let row = self.ghosts.binary_search(&(e.row as u32));
                columns
                    .row
                    .push(row.expect("every entry's row was collected") as u32);
                columns.at.push(e.local);
                columns.b.push(e.b);
                columns.bd.push(e.bd);
                let vertex = sub.primal.binary_search(&e.local).is_ok();
                let alone = sharing.shared(sub.dofs[e.local as usize]).is_empty();
                if e.contact && vertex && alone && subdomains_of[sub.body] > 1 {
                    corners.push(e.local);
                } else {
                    dual.push(e.local);
                }
            }
            let shared = (0..sub.dofs.len() as u32)
                .filter(|&i| Sharing::is_primal(sharing.shared(sub.dofs[i as usize])));
            let mut primal: Vec<u32> = shared.collect();
            corners.dedup();
            dual.dedup();
            dual.retain(|i| primal.binary_search(i).is_err());
            self.n_shared.push(primal.len());
            primal.extend(corners);
            self.columns.push(columns);
            self.delta.push(dual);
            self.primal.push(primal);
        }
    }

    /// Turns the entries' local dofs into positions in `interface` (the order of Γ) of subdomain `j`.
    pub fn place(&mut self, j: usize, interface: &[u32]) {
        let mut position: Vec<(u32, u32)> = interface.iter().copied().zip(0..).collect();
        position.sort_unstable();
        for at in &mut self.columns[j].at {
            let found = position.binary_search_by_key(at, |p| p.0);
            *at = position[found.expect("a row's dof is an interface dof")].1;
        }
    }
}

impl Entry {
    fn new(row: u64, copy: &Copy, contact: bool, b: f64, bd: f64) -> Entry {
        Entry {
            row,
            subdomain: copy.subdomain,
            local: copy.local,
            contact,
            b,
            bd,
        }
    }
}

/// The dual dofs shared inside a body whose lowest subdomain lives here, in a reproducible order.
fn local_groups<'a>(problem: &Substructures, sharing: &'a Sharing, rank: u32) -> Vec<&'a [Copy]> {
    let mut groups = Vec::new();
    for sub in problem.local.iter() {
        debug_assert_eq!(sharing.rank_of[sub.index], rank);
        for &dof in &sub.dofs {
            let copies = sharing.shared(dof);
            let lowest = copies
                .first()
                .is_some_and(|c| c.subdomain as usize == sub.index);
            if lowest && !Sharing::is_primal(copies) {
                groups.push(copies);
            }
        }
    }
    groups
}

/// Sorts this rank's rows by block: (order of the rows, blocks with `rows` counted after `first` local rows).
fn contact_blocks(
    problem: &Substructures,
    sharing: &Sharing,
    first: usize,
) -> (Vec<usize>, Vec<Block>) {
    let mut order: Vec<usize> = (0..problem.rows.len()).collect();
    order.sort_by_key(|&r| problem.rows[r].block);
    let mut blocks = Vec::new();
    let mut start = first;
    for rows in order.chunk_by(|&a, &b| problem.rows[a].block == problem.rows[b].block) {
        let terms = rows.iter().flat_map(|&r| &problem.rows[r].terms);
        let mut dofs: Vec<u64> = terms.map(|t| t.0).collect();
        dofs.sort_unstable();
        dofs.dedup();
        let mut b = Dense::zeros(rows.len(), dofs.len());
        for (i, &r) in rows.iter().enumerate() {
            for (dof, coefficient) in &problem.rows[r].terms {
                let j = dofs
                    .binary_search(dof)
                    .expect("every term's dof was collected");
                b.set(i, j, b.get(i, j) + coefficient);
            }
        }
        let weights = dofs
            .iter()
            .map(|dof| sharing.copies[dof].iter().map(|c| c.weight).sum())
            .collect();
        let end = start + rows.len();
        blocks.push(Block {
            rows: start..end,
            dofs,
            b,
            weights,
        });
        start = end;
    }
    (order, blocks)
}

//! Blocks of B_gl. A block is a set of rows that share body dofs; its scaling (B D⁻¹ Bᵀ)⁺ is computed as a whole. A
//! change of Z^k is applied block by block.

use std::collections::HashMap;
use std::ops::Range;

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use super::operator::Jump;
use super::scaling;
use crate::feti::interface::sharing::{Copy, Sharing};
use crate::linalg::dense::Dense;
use crate::linalg::sorted::distinct;
use crate::parallel::exchange::{exchange, Record};
use crate::substructures::Substructures;

/// A block is large if it has more rows than this: more than meet at a point.
const LARGE: usize = 24;

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
    /// The weights in B_D: D summed over as many copies as those dofs of the same body have that have the fewest. Along
    /// a side, the nodes at which subdomains meet then weigh no more than others.
    scaling: Vec<f64>,
    /// Whether the block is large and its rows are independent: nothing has to be asked about which of them follow from
    /// others.
    pub independent: bool,
    /// Body of each dof.
    pub bodies: Vec<u32>,
    /// The copies of each dof.
    copies: Vec<Vec<Copy>>,
}

/// One entry of B and B_D on its way to the rank of its subdomain.
#[derive(Clone)]
pub(crate) struct Entry {
    pub row: u64,
    pub subdomain: u32,
    pub local: u32,
    pub contact: bool,
    /// Entry of B, whether or not the row holds.
    pub full: f64,
    /// Entry of Z B.
    pub b: f64,
    /// Entry of Z B_D.
    pub bd: f64,
}

impl Record for Entry {
    const WORDS: usize = 5;
    fn pack(&self, out: &mut Vec<u64>) {
        let place = u64::from(self.subdomain) << 32 | u64::from(self.local);
        let row = self.row << 1 | u64::from(self.contact);
        let values = [self.full, self.b, self.bd].map(f64::to_bits);
        out.extend([row, place]);
        out.extend(values);
    }
    fn unpack(w: &[u64]) -> Self {
        Entry {
            row: w[0] >> 1,
            subdomain: (w[1] >> 32) as u32,
            local: (w[1] & u64::from(u32::MAX)) as u32,
            contact: w[0] & 1 == 1,
            full: f64::from_bits(w[2]),
            b: f64::from_bits(w[3]),
            bd: f64::from_bits(w[4]),
        }
    }
}

impl Entry {
    pub fn new(row: u64, copy: &Copy, contact: bool, [full, b, bd]: [f64; 3]) -> Entry {
        Entry {
            row,
            subdomain: copy.subdomain,
            local: copy.local,
            contact,
            full,
            b,
            bd,
        }
    }
}

impl Block {
    /// The position of the block, if a subdomain of this rank knows it.
    pub fn place(&self, problem: &Substructures) -> Option<[f64; 3]> {
        self.copies.iter().flatten().find_map(|copy| {
            let index = |sub: &&crate::Subdomain| sub.index == copy.subdomain as usize;
            let sub = problem.local.iter().find(index)?;
            Some(sub.coordinates.as_ref()?[copy.local as usize])
        })
    }

    /// The entries of B and B_D for the rows in `active` (one per row of the block). `first` is the number of this
    /// rank's first row.
    pub(crate) fn entries(&self, first: usize, active: &[bool], send: &mut impl FnMut(Entry)) {
        let bd = match self.independent {
            true => scaling::independent(&self.b, &self.scaling, active),
            false => scaling::block(&self.b, &self.scaling, active),
        };
        for (r, &on) in active.iter().enumerate() {
            let row = (first + self.rows.start + r) as u64;
            for (j, copies) in self.copies.iter().enumerate() {
                // A row acts on the weighted average of the copies of one body (docs/theory.md, section 3). B_Dᵀ λ is
                // then the same on all of them, as a function in W̃ must be.
                for copy in copies {
                    let full = self.b.get(r, j) * copy.weight / self.weights[j];
                    let b = if on { full } else { 0.0 };
                    send(Entry::new(row, copy, true, [full, b, bd.get(r, j)]));
                }
            }
        }
    }
}

impl Block {
    /// B B⁺ c over the active rows, the nearest right-hand side that they can satisfy together; `c` on the others.
    /// Where all candidates hold, gaps around a cross point contradict each other, and so do both sides of an obstacle.
    fn consistent(&self, active: &[bool], c: &[f64]) -> Vec<f64> {
        let mut out = c.to_vec();
        if self.independent {
            return out;
        }
        let rows: Vec<usize> = (0..active.len()).filter(|&r| active[r]).collect();
        let largest = rows.iter().fold(0.0f64, |a, &r| a.max(c[r].abs()));
        if rows.len() < 2 || largest == 0.0 {
            return out;
        }
        let b = faer::Mat::from_fn(rows.len(), self.dofs.len(), |i, j| self.b.get(rows[i], j));
        let range = scaling::range(&b);
        if range.ncols() == rows.len() {
            return out;
        }
        let mut near = vec![0.0; rows.len()];
        for l in 0..range.ncols() {
            let along: f64 = (0..rows.len()).map(|i| range[(i, l)] * c[rows[i]]).sum();
            near.iter_mut()
                .enumerate()
                .for_each(|(i, n)| *n += along * range[(i, l)]);
        }
        for (&r, n) in rows.iter().zip(&near) {
            // A difference of the size of rounding means that both values are the same.
            if (n - c[r]).abs() > 1e-12 * largest {
                out[r] = *n;
            }
        }
        out
    }
}

impl Block {
    /// Rows that follow from the active ones: they depend on them, and their right-hand side `c` is the same
    /// combination.
    fn implied(&self, active: &[bool], c: &[f64]) -> Vec<usize> {
        let mut held = active.to_vec();
        let mut out = Vec::new();
        if self.independent {
            return out;
        }
        let rank = |on: &[bool]| {
            let rows: Vec<usize> = (0..on.len()).filter(|&r| on[r]).collect();
            let b = faer::Mat::from_fn(rows.len(), self.dofs.len(), |i, j| self.b.get(rows[i], j));
            if rows.is_empty() {
                0
            } else {
                scaling::range(&b).ncols()
            }
        };
        let known = rank(active);
        for r in (0..active.len()).filter(|&r| !active[r]) {
            held[r] = true;
            let follows = known > 0 && rank(&held) == known;
            if follows && self.consistent(&held, c) == c {
                out.push(r);
            }
            held[r] = false;
        }
        out
    }
}

/// Sorts this rank's rows by block. Returns the order of the rows and the blocks, with `rows` counted after `first`
/// local rows.
pub(crate) fn collect(
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
        let dofs = distinct(terms.map(|t| t.0));
        let mut b = Dense::zeros(rows.len(), dofs.len());
        for (i, &r) in rows.iter().enumerate() {
            for (dof, coefficient) in &problem.rows[r].terms {
                let j = dofs
                    .binary_search(dof)
                    .expect("every term's dof was collected");
                b.set(i, j, b.get(i, j) + coefficient);
            }
        }
        let copies: Vec<Vec<Copy>> = dofs.iter().map(|dof| sharing.copies[dof].clone()).collect();
        let weights: Vec<f64> = copies
            .iter()
            .map(|copies| copies.iter().map(|c| c.weight).sum())
            .collect();
        let bodies: Vec<u32> = copies
            .iter()
            .map(|copies| sharing.body_of[copies[0].subdomain as usize])
            .collect();
        let end = start + rows.len();
        blocks.push(Block {
            rows: start..end,
            independent: rows.len() > LARGE && scaling::are_independent(&b),
            dofs,
            b,
            scaling: even(&weights, &bodies, &copies),
            weights,
            bodies,
            copies,
        });
        start = end;
    }
    (order, blocks)
}

/// The weights of B_D from sums over copies.
fn even(sums: &[f64], bodies: &[u32], copies: &[Vec<Copy>]) -> Vec<f64> {
    let mut fewest: HashMap<u32, usize> = HashMap::new();
    for (body, list) in bodies.iter().zip(copies) {
        let n = fewest.entry(*body).or_insert(list.len());
        *n = list.len().min(*n);
    }
    let of_dof = sums.iter().zip(bodies).zip(copies);
    let weight = |((sum, body), list): ((&f64, &u32), &Vec<Copy>)| match fewest[body] {
        n if n == list.len() => *sum,
        n => sum * n as f64 / list.len() as f64,
    };
    of_dof.map(weight).collect()
}

impl Jump {
    /// Z^k, with the inequality rows that hold because they follow from others. Around a cross point several sets of
    /// rows are equivalent.
    pub fn implied(&self) -> Vec<bool> {
        let mut out = self.active.clone();
        for block in self.blocks.iter().filter(|b| b.rows.len() > 1) {
            let (active, c) = (
                &self.active[block.rows.clone()],
                &self.gap[block.rows.clone()],
            );
            for r in block.implied(active, c) {
                let r = block.rows.start + r;
                out[r] |= self.inequality[r];
            }
        }
        out
    }

    /// Computes right-hand sides that the rows that hold can satisfy together, from c and Z^k, for the blocks that
    /// `which` selects.
    pub(crate) fn reconcile(&mut self, which: impl Fn(&Block) -> bool) {
        for block in self.blocks.iter().filter(|b| which(b)) {
            let (active, c) = (
                &self.active[block.rows.clone()],
                &self.gap[block.rows.clone()],
            );
            self.held[block.rows.clone()].copy_from_slice(&block.consistent(active, c));
        }
    }

    /// Changes Z^k. `active` says for each owned row whether it holds (rows of B_loc always do). Only blocks with a
    /// changed row get a new B_D. Returns the number of rows that changed on this rank. Collective.
    pub fn set_active(&mut self, comm: &SimpleCommunicator, active: &[bool]) -> usize {
        debug_assert!(active[..self.n_owned_local].iter().all(|&on| on));
        let mut outgoing: Vec<Vec<Entry>> = (0..comm.size()).map(|_| Vec::new()).collect();
        let mut changed = 0;
        for block in &self.blocks {
            let (old, new) = (
                &self.active[block.rows.clone()],
                &active[block.rows.clone()],
            );
            let here = old.iter().zip(new).filter(|(a, b)| a != b).count();
            if here > 0 {
                block.entries(self.first, new, &mut |entry: Entry| {
                    let to = self.rank_of[entry.subdomain as usize];
                    outgoing[to as usize].push(entry);
                });
            }
            changed += here;
        }
        let old = std::mem::replace(&mut self.active, active.to_vec());
        self.reconcile(|block| old[block.rows.clone()] != active[block.rows.clone()]);
        for entry in exchange(comm, outgoing) {
            let j = self.subdomains.binary_search(&entry.subdomain);
            let j = j.expect("entries go to the rank of their subdomain");
            let row = self.ghosts.binary_search(&(entry.row as u32));
            let key = (
                row.expect("rows of a block are ghosts of its subdomains") as u32,
                j as u32,
                entry.local,
            );
            let at = self.places.binary_search_by_key(&key, |p| (p.0, p.1, p.2));
            let k = self.places[at.expect("the entry was there before")].3 as usize;
            self.columns[j].b[k] = entry.b;
            self.columns[j].bd[k] = entry.bd;
        }
        changed
    }
}

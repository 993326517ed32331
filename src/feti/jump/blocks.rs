//! Blocks of B_gl. A block is a set of rows that share body dofs; its scaling (B D⁻¹ Bᵀ)⁺ is computed as a whole.

use rustc_hash::FxHashMap;
use std::borrow::Cow;
use std::ops::Range;

use super::coupled::Coupled;
use super::dependent;
use super::scaling::ScalingCache;
use super::turn::Turn;
use crate::feti::interface::sharing::{Copy, DofSharing};
use crate::substructures::Problem;
use base::linalg::dense::Dense;
use base::linalg::sorted::distinct;
use bytemuck::{Pod, Zeroable};

/// B of a block.
#[derive(Debug)]
pub enum BlockForm {
    /// On (rows, dofs): the rows of a point where bodies meet. B_D has entries for all of these.
    Dense(Dense),
    /// Many rows, such as those of an interface.
    Coupled(Box<Coupled>),
}

/// Rows of B_gl that share body dofs, on the rank that owns them.
#[derive(Debug)]
pub struct Block {
    /// Owned rows of the block (indices among this rank's rows).
    pub rows: Range<usize>,
    /// B.
    pub form: BlockForm,
    /// The dofs of a coupled block among those of all coupled blocks of this rank; empty for others.
    pub slots: Range<usize>,
    /// The body dofs that the rows touch.
    dofs: Box<[Dof]>,
    /// Their copies, dof after dof. There are as many blocks as points where bodies meet: lists are few and tight.
    copies: Box<[Copy]>,
}

/// A body dof in a block.
#[derive(Debug)]
struct Dof {
    /// D summed over its copies.
    weight: f64,
    /// The weight in B_D: D summed over as many copies as those dofs of the same body have that have the fewest. Along
    /// a side, the nodes at which subdomains meet then weigh no more than others.
    scaling: f64,
    body: u32,
    /// The end of its copies, which begin where those of the dof before end.
    end: u32,
}

/// One entry of B and B_D on its way to the rank of its subdomain.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
pub(crate) struct JumpBlockEntry {
    pub row: u32,
    contact: u32,
    pub subdomain: u32,
    pub local: u32,
    /// Entry of B, whether or not the row holds.
    pub full: f64,
    /// Entry of Z B.
    pub b: f64,
    /// Entry of Z B_D.
    pub bd: f64,
}

impl JumpBlockEntry {
    pub fn new(row: u32, copy: &Copy, contact: bool, [full, b, bd]: [f64; 3]) -> JumpBlockEntry {
        JumpBlockEntry {
            row,
            contact: contact.into(),
            subdomain: copy.subdomain,
            local: copy.local,
            full,
            b,
            bd,
        }
    }

    /// Whether it is in a row of B_gl.
    pub fn is_contact(&self) -> bool {
        self.contact != 0
    }
}

impl Block {
    /// The position of the block, if a subdomain of this rank knows it; that of these rows if it is coupled.
    pub fn place(&self, problem: &Problem, rows: &[usize]) -> Option<[f64; 3]> {
        let dofs = match &self.form {
            BlockForm::Dense(_) => (0..self.dofs.len()).collect(),
            BlockForm::Coupled(coupled) => coupled.dofs(rows).iter().map(|&j| j as usize).collect(),
        };
        let dofs: Vec<usize> = dofs;
        let copies = dofs.iter().flat_map(|&j| self.copies_of(j));
        let place = |copy: &Copy| {
            let index = |sub: &&crate::Subdomain| sub.index == copy.subdomain as usize;
            let sub = problem.local.iter().find(index)?;
            Some(sub.coordinates.as_ref()?[copy.local as usize])
        };
        copies.into_iter().find_map(place)
    }

    /// The bodies with an entry in row `r`.
    pub fn bodies_of(&self, r: usize) -> Vec<u32> {
        match &self.form {
            BlockForm::Dense(b) => {
                let inside = (0..b.cols).filter(|&j| b.get(r, j) != 0.0);
                inside.map(|j| self.dofs[j].body).collect()
            }
            BlockForm::Coupled(coupled) => {
                let (dofs, values) = coupled.row(r);
                let inside = dofs.iter().zip(values).filter(|e| *e.1 != 0.0);
                inside.map(|e| self.dofs[*e.0 as usize].body).collect()
            }
        }
    }

    /// Bᵀ λ of the block, by its dofs; `lambda` has an entry per row.
    pub fn forces(&self, lambda: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.dofs.len()];
        for (r, l) in lambda.iter().enumerate().filter(|(_, l)| **l != 0.0) {
            match &self.form {
                BlockForm::Dense(b) => {
                    let row = out.iter_mut().enumerate();
                    row.for_each(|(j, f)| *f += b.get(r, j) * l);
                }
                BlockForm::Coupled(coupled) => {
                    let (dofs, values) = coupled.row(r);
                    let entries = dofs.iter().zip(values);
                    entries.for_each(|(&j, v)| out[j as usize] += v * l);
                }
            }
        }
        out
    }

    /// D of its dofs, if its rows are those of a point.
    pub fn weights(&self) -> Option<Vec<f64>> {
        let of_point = || self.dofs.iter().map(|dof| dof.weight).collect();
        matches!(self.form, BlockForm::Dense(_)).then(of_point)
    }

    /// The bodies of its dofs, increasing.
    pub fn bodies(&self) -> Vec<u32> {
        distinct(self.dofs.iter().map(|dof| dof.body))
    }

    /// The rows of `on` that may depend on each other, and B on them: all of a point; those of a coupled block that do.
    /// Multipliers without forces, Bᵀ N = 0, are zero on all other rows in `on`. `None` if no row depends on others.
    pub fn dependent(&self, on: &[bool]) -> Option<(Vec<usize>, Cow<'_, Dense>)> {
        match &self.form {
            BlockForm::Dense(b) => Some(((0..on.len()).collect(), Cow::Borrowed(b))),
            BlockForm::Coupled(coupled) => {
                let rows = coupled.dependent(on);
                let b = (!rows.is_empty()).then(|| coupled.part(&rows))?;
                Some((rows, Cow::Owned(b)))
            }
        }
    }

    /// [`dependent`](Self::dependent) as one set; of a coupled block with too many dependent rows those of each
    /// dependency by itself.
    pub fn dependent_sets(&self, on: &[bool]) -> Vec<(Vec<usize>, Cow<'_, Dense>)> {
        match &self.form {
            BlockForm::Dense(_) => self.dependent(on).into_iter().collect(),
            BlockForm::Coupled(coupled) => {
                let part = |rows: &Vec<usize>| Cow::Owned(coupled.part(rows));
                let sets = coupled.dependent_sets(on);
                sets.into_iter()
                    .map(|rows| (rows.clone(), part(&rows)))
                    .collect()
            }
        }
    }

    /// Turns two rows of this rank; B_D is that of before.
    pub fn turn(&mut self, turn: &Turn) {
        let rows = turn.rows.map(|r| r - self.rows.start);
        let b = match &mut self.form {
            BlockForm::Dense(b) => b,
            BlockForm::Coupled(coupled) => return coupled.turn(&Turn { rows, ..*turn }),
        };
        let [first, second] = rows;
        for j in 0..b.cols {
            let turned = turn.of([b.get(first, j), b.get(second, j)]);
            b.set(first, j, turned[0]);
            b.set(second, j, turned[1]);
        }
    }

    /// The copies of a dof.
    fn copies_of(&self, dof: usize) -> &[Copy] {
        copies_of(&self.dofs, &self.copies, dof)
    }

    /// The copies of each dof.
    pub(super) fn copies(&self) -> impl Iterator<Item = &[Copy]> {
        (0..self.dofs.len()).map(|dof| self.copies_of(dof))
    }

    /// The entries of all rows; those in `active` hold to begin with.
    pub(crate) fn start(
        &mut self,
        first: usize,
        active: &[bool],
        known: &mut ScalingCache,
        send: &mut impl FnMut(JumpBlockEntry),
    ) {
        self.hold(first, |_| true, active, known, send);
    }

    /// Prepares B_D for the rows in `active` (one per row of the block) and sends the entries that change with them:
    /// those of dense blocks, and of rows of coupled blocks that held before or now, but not both. `first` is the
    /// number of this rank's first row.
    pub(super) fn hold(
        &mut self,
        first: usize,
        change: impl Fn(usize) -> bool,
        active: &[bool],
        known: &mut ScalingCache,
        send: &mut impl FnMut(JumpBlockEntry),
    ) {
        // A row acts on the weighted average of the copies of one body (docs/theory.md, section 3). B_Dᵀ λ is then the
        // same on all of them, as a function in W̃ must be.
        let (start, dofs, copies) = (self.rows.start, &self.dofs, &self.copies);
        let mut send = |r: usize, j: usize, value: f64, bd: f64| {
            let row = (first + start + r) as u32;
            for copy in copies_of(dofs, copies, j) {
                let full = value * copy.weight / dofs[j].weight;
                let b = if active[r] { full } else { 0.0 };
                send(JumpBlockEntry::new(row, copy, true, [full, b, bd]));
            }
        };
        match &mut self.form {
            BlockForm::Dense(b) => {
                let scaling: Vec<f64> = dofs.iter().map(|dof| dof.scaling).collect();
                let bd = known.block(b, &scaling, active);
                for r in 0..active.len() {
                    (0..b.cols).for_each(|j| send(r, j, b.get(r, j), bd.get(r, j)));
                }
            }
            BlockForm::Coupled(coupled) => {
                coupled.hold(active);
                for r in (0..active.len()).filter(|&r| change(r)) {
                    let (dofs, values) = coupled.row(r);
                    let entries = dofs.iter().zip(values);
                    entries.for_each(|(&j, value)| send(r, j as usize, *value, 0.0));
                }
            }
        }
    }

    /// B B⁺ c over the active rows, the nearest right-hand side that they can satisfy together; `c` on the others.
    /// Where all candidates hold, gaps around a cross point contradict each other, and so do both sides of an obstacle.
    pub(super) fn consistent(&self, active: &[bool], c: &[f64]) -> Vec<f64> {
        let mut out = c.to_vec();
        if c.iter().zip(active).all(|(c, on)| !on || *c == 0.0) {
            return out;
        }
        match &self.form {
            BlockForm::Dense(b) => dependent::consistent(b, active, c),
            BlockForm::Coupled(coupled) => {
                if coupled.reconcile(active, &mut out) {
                    dependent::keep(active, c, &mut out);
                }
                out
            }
        }
    }

    /// Rows that follow from the active ones: they depend on them, and their right-hand side `c` is the same
    /// combination.
    pub(super) fn implied(&self, active: &[bool], c: &[f64]) -> Vec<usize> {
        let all = vec![true; active.len()];
        let Some((rows, b)) = self.dependent(&all) else {
            return Vec::new();
        };
        let follow = dependent::implied(&b, &pick(active, &rows), &pick(c, &rows));
        follow.into_iter().map(|i| rows[i]).collect()
    }
}

/// The copies of a dof in a block.
fn copies_of<'a>(dofs: &[Dof], copies: &'a [Copy], dof: usize) -> &'a [Copy] {
    let start = dof.checked_sub(1).map_or(0, |before| dofs[before].end);
    &copies[start as usize..dofs[dof].end as usize]
}

/// The other tangential row of each one in space.
fn partners(problem: &Problem) -> FxHashMap<usize, usize> {
    let mut out = FxHashMap::default();
    for node in &problem.friction {
        if let [a, b] = node.tangential[..] {
            out.extend([(a, b), (b, a)]);
        }
    }
    out
}

/// The values at these places.
fn pick<T: Clone>(values: &[T], at: &[usize]) -> Vec<T> {
    at.iter().map(|&i| values[i].clone()).collect()
}

/// Sorts this rank's rows by block. Returns the order of the rows and the blocks, with `rows` counted after `first`
/// local rows. Blocks with more than `many` rows are coupled.
pub(crate) fn collect(
    problem: &Problem,
    sharing: &DofSharing,
    (first, many): (usize, usize),
) -> (Vec<usize>, Vec<Block>) {
    let mut order: Vec<usize> = (0..problem.rows.len()).collect();
    order.sort_by_key(|&r| problem.rows[r].block);
    let mut blocks = Vec::new();
    let (mut start, mut slots) = (first, 0);
    let partners = partners(problem);
    for rows in order.chunk_by(|&a, &b| problem.rows[a].block == problem.rows[b].block) {
        let terms = rows.iter().flat_map(|&r| &problem.rows[r].terms);
        let dofs = distinct(terms.map(|t| t.0));
        let place = |dof| {
            let found = dofs.binary_search(dof);
            found.expect("every term's dof was collected")
        };
        let (of_block, copies) = weighed(&dofs, sharing);
        let form = if rows.len() > many {
            let row = |&r: &usize| {
                let terms = problem.rows[r].terms.iter();
                let own = terms.map(|t| (place(&t.0) as u32, t.1));
                // A row that may be turned has the dofs of its partner, too.
                let partner = partners.get(&r).map(|&p| &problem.rows[p].terms);
                let zeros = partner
                    .into_iter()
                    .flatten()
                    .map(|t| (place(&t.0) as u32, 0.0));
                own.chain(zeros).collect()
            };
            let rows: Vec<_> = rows.iter().map(row).collect();
            let scaling: Vec<f64> = of_block.iter().map(|dof| dof.scaling).collect();
            BlockForm::Coupled(Box::new(Coupled::new(&rows, &scaling)))
        } else {
            let mut b = Dense::zeros(rows.len(), dofs.len());
            for (i, &r) in rows.iter().enumerate() {
                for (dof, coefficient) in &problem.rows[r].terms {
                    let j = place(dof);
                    b.set(i, j, b.get(i, j) + coefficient);
                }
            }
            BlockForm::Dense(b)
        };
        let coupled = match &form {
            BlockForm::Dense(_) => 0,
            BlockForm::Coupled(_) => dofs.len(),
        };
        let end = start + rows.len();
        blocks.push(Block {
            rows: start..end,
            slots: slots..slots + coupled,
            form,
            dofs: of_block,
            copies,
        });
        start = end;
        slots += coupled;
    }
    (order, blocks)
}

/// These dofs with their weights, and all their copies.
fn weighed(dofs: &[u64], sharing: &DofSharing) -> (Box<[Dof]>, Box<[Copy]>) {
    let lists = dofs.iter().map(|dof| &sharing.copies[dof]);
    let copies: Box<[Copy]> = lists.clone().flatten().copied().collect();
    // The fewest copies of a dof of each body.
    let mut fewest: FxHashMap<u32, usize> = FxHashMap::default();
    let body = |list: &[Copy]| sharing.body(&list[0]);
    let most = lists.clone().map(Vec::len).max();
    let same = lists.clone().all(|list| Some(list.len()) == most);
    for list in lists.clone().filter(|_| !same) {
        let n = fewest.entry(body(list)).or_insert(list.len());
        *n = list.len().min(*n);
    }
    let mut end = 0;
    let dof = |list: &Vec<Copy>| {
        end += list.len() as u32;
        let (body, weight) = (body(list), list.iter().map(|c| c.weight).sum());
        let scaling = match fewest.get(&body) {
            Some(&n) if n < list.len() => weight * n as f64 / list.len() as f64,
            _ => weight,
        };
        Dof {
            weight,
            scaling,
            body,
            end,
        }
    };
    (lists.clone().map(dof).collect(), copies)
}

//! Products with operators that equal subdomains share. One matrix-matrix product, or one sweep through a sparse
//! factor, serves many subdomains.
//!
//! A matrix-vector product reads an n × n operator for 2 n² operations and waits for memory. With thirty vectors side
//! by side, one reading of the operator serves thirty times the operations. Vectors of turned copies are turned on the
//! way in and out.

use std::cell::{Ref, RefCell};

use super::work::InterfaceBuffers;
use crate::feti::subdomain::scaled::ScaledSubdomain;
use crate::feti::subdomain::which::Operator;
use base::linalg::dense::Dense;
use parallel::team::Team;

/// Number of vectors side by side: enough to keep the arithmetic units busy, few enough to leave work for several
/// threads.
const WIDTH: usize = 32;

/// Operators of a smaller order are applied one by one; they are in the cache anyway.
const WORTH_PACKING: usize = 48;

/// The batches of subdomains that share operators, and buffers for their vectors.
pub struct BatchedProducts {
    batches: Vec<Vec<usize>>,
    /// (batch, column) of each local subdomain that belongs to a batch.
    place: Vec<Option<(usize, usize)>>,
    panels: RefCell<Vec<BatchPanel>>,
}

/// Vectors of one batch.
#[derive(Default)]
pub struct BatchPanel {
    v: Dense,
    y: Dense,
    /// Columns that are in use; the others stay zero.
    live: Vec<bool>,
}

impl BatchedProducts {
    /// `batches(n)` returns the local subdomains in groups of at most n that share their operators.
    pub fn new(
        locals: &[ScaledSubdomain],
        batches: impl Fn(usize) -> Vec<Vec<usize>>,
    ) -> BatchedProducts {
        let worth = |l: &ScaledSubdomain| l.is_implicit() || l.gamma().n_delta >= WORTH_PACKING;
        let together = |b: &Vec<usize>| b.len() > 1 && worth(&locals[b[0]]);
        let batches: Vec<Vec<usize>> = batches(WIDTH).into_iter().filter(together).collect();
        let mut place = vec![None; locals.len()];
        for (b, members) in batches.iter().enumerate() {
            for (c, &j) in members.iter().enumerate() {
                place[j] = Some((b, c));
            }
        }
        let panels = batches.iter().map(|_| BatchPanel::default()).collect();
        BatchedProducts {
            batches,
            place,
            panels: RefCell::new(panels),
        }
    }

    /// Computes A v for all subdomains in batches, v being the leading entries of the subdomain's `v`. The products are
    /// read with [`results`](Self::results). `apply(j, v, y, n)` computes the first n columns of y ← A v with the
    /// operator that local subdomain j shares with others.
    pub fn multiply(
        &self,
        team: &Team,
        locals: &[ScaledSubdomain],
        work: &[InterfaceBuffers],
        which: Operator,
        apply: impl Fn(usize, &Dense, &mut Dense, usize) + Sync + Send,
    ) -> Ref<'_, Vec<BatchPanel>> {
        let batches = &self.batches;
        team.for_each(&mut self.panels.borrow_mut(), |b, panel| {
            let members = &batches[b];
            let kind = locals[members[0]].kind();
            let order = kind.order(which);
            panel.shape(order, members.len());
            let mut n = 0;
            for (c, &j) in members.iter().enumerate() {
                let v = &work[j].v[..order];
                panel.live[c] = v.iter().any(|v| *v != 0.0);
                if panel.live[c] {
                    panel.v.col_mut(n).copy_from_slice(v);
                    locals[j].turn_back(panel.v.col_mut(n));
                    n += 1;
                }
            }
            apply(members[0], &panel.v, &mut panel.y, n);
        });
        self.panels.borrow()
    }

    /// The products of the last [`multiply`](Self::multiply), by local subdomain.
    pub fn results<'a>(&'a self, panels: &'a [BatchPanel], which: Operator) -> BatchedResults<'a> {
        BatchedResults {
            place: &self.place,
            panels,
            which,
        }
    }
}

/// Products by local subdomain.
pub struct BatchedResults<'a> {
    place: &'a [Option<(usize, usize)>],
    panels: &'a [BatchPanel],
    which: Operator,
}

impl BatchedResults<'_> {
    /// y ← A v of local subdomain `j`. `alone` computes it if the subdomain is in no batch. Entries beyond the
    /// operator's order are set to zero.
    pub fn take(
        &self,
        j: usize,
        local: &ScaledSubdomain,
        y: &mut [f64],
        alone: impl Fn(&mut [f64]),
    ) {
        match self.place[j] {
            None => alone(y),
            Some((b, c)) if self.panels[b].live[c] => {
                let panel = &self.panels[b];
                let before = panel.live[..c].iter().filter(|l| **l).count();
                let multiple = local.multiple(self.which);
                let (head, tail) = y.split_at_mut(panel.y.rows);
                for (y, p) in head.iter_mut().zip(panel.y.col(before)) {
                    *y = multiple * p;
                }
                local.turn_forth(head);
                tail.fill(0.0);
            }
            Some(_) => y.fill(0.0),
        }
    }
}

impl BatchPanel {
    fn shape(&mut self, rows: usize, cols: usize) {
        if (self.v.rows, self.v.cols) != (rows, cols) {
            self.v = Dense::zeros(rows, cols);
            self.y = Dense::zeros(rows, cols);
            self.live = vec![false; cols];
        }
    }
}

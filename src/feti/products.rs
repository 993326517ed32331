//! Products with dense operators that equal subdomains share: one matrix-matrix product for all of them.
//!
//! A matrix-vector product reads an n × n operator to do 2 n² operations and waits for the cache; with thirty vectors side by side the same reading does thirty times
//! the work.

use std::cell::{Ref, RefCell};
use std::sync::Arc;

use super::local::dense::{multiply, Dense};
use super::local::problem::LocalProblem;
use super::stiffness::Work;
use super::team::Team;

/// Vectors side by side: enough to keep the arithmetic busy, few enough to leave work for several threads.
const WIDTH: usize = 32;

/// Operators of a smaller order are applied one by one: they are in the cache anyway.
const WORTH_PACKING: usize = 48;

/// Which subdomains go together, and room for their vectors.
pub struct Products {
    batches: Vec<Vec<usize>>,
    /// (batch, column) of each local subdomain that goes with others.
    place: Vec<Option<(usize, usize)>>,
    panels: RefCell<Vec<Panel>>,
}

/// Vectors of one batch.
#[derive(Default)]
pub struct Panel {
    v: Dense,
    y: Dense,
    /// Columns that are in use: the others are zero and stay so.
    live: Vec<bool>,
}

impl Products {
    /// `batches(n)` are the local subdomains in groups of at most n that share their operators.
    pub fn new(
        locals: &[Arc<LocalProblem>],
        batches: impl Fn(usize) -> Vec<Vec<usize>>,
    ) -> Products {
        let together = |b: &Vec<usize>| b.len() > 1 && locals[b[0]].n_delta >= WORTH_PACKING;
        let batches: Vec<Vec<usize>> = batches(WIDTH).into_iter().filter(together).collect();
        let mut place = vec![None; locals.len()];
        for (b, members) in batches.iter().enumerate() {
            for (c, &j) in members.iter().enumerate() {
                place[j] = Some((b, c));
            }
        }
        let panels = batches.iter().map(|_| Panel::default()).collect();
        Products {
            batches,
            place,
            panels: RefCell::new(panels),
        }
    }

    /// Computes A v for all that go together, `operator` being A and v the leading entries of the subdomain's `v`; [`results`](Self::results) has them.
    pub fn multiply(
        &self,
        team: &Team,
        locals: &[Arc<LocalProblem>],
        work: &[Work],
        operator: impl Fn(&LocalProblem) -> &Dense + Sync + Send,
    ) -> Ref<'_, Vec<Panel>> {
        let batches = &self.batches;
        team.for_each(&mut self.panels.borrow_mut(), |b, panel| {
            let (a, members) = (operator(&locals[batches[b][0]]), &batches[b]);
            panel.shape(a.rows, members.len());
            let mut n = 0;
            for (c, &j) in members.iter().enumerate() {
                let v = &work[j].v[..a.rows];
                panel.live[c] = v.iter().any(|v| *v != 0.0);
                if panel.live[c] {
                    panel.v.col_mut(n).copy_from_slice(v);
                    n += 1;
                }
            }
            let (v, y) = (panel.v.view(), panel.y.view_mut());
            let (v, y) = (v.subcols(0, n), y.subcols_mut(0, n));
            if n > 0 {
                multiply(y, false, 1.0, a.view(), v);
            }
        });
        self.panels.borrow()
    }

    /// What [`multiply`](Self::multiply) has computed, by local subdomain.
    pub fn results<'a>(&'a self, panels: &'a [Panel]) -> Results<'a> {
        Results {
            place: &self.place,
            panels,
        }
    }
}

/// Products by local subdomain.
pub struct Results<'a> {
    place: &'a [Option<(usize, usize)>],
    panels: &'a [Panel],
}

impl Results<'_> {
    /// y ← A v of local subdomain `j`, computed here if it goes with no other; entries beyond the operator's order are set to zero.
    pub fn take(&self, j: usize, a: &Dense, v: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        match self.place[j] {
            None => a.add_mul(&v[..a.rows], &mut y[..a.rows]),
            Some((b, c)) if self.panels[b].live[c] => {
                let panel = &self.panels[b];
                let before = panel.live[..c].iter().filter(|l| **l).count();
                y[..a.rows].copy_from_slice(panel.y.col(before));
            }
            Some(_) => {}
        }
    }
}

impl Panel {
    fn shape(&mut self, rows: usize, cols: usize) {
        if (self.v.rows, self.v.cols) != (rows, cols) {
            self.v = Dense::zeros(rows, cols);
            self.y = Dense::zeros(rows, cols);
            self.live = vec![false; cols];
        }
    }
}

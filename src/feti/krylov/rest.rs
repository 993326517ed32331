//! Where bodies come to rest along motions that nothing holds and no load drives: as near to the start as rows allow.
//!
//! ```text
//!     min ‖u + V z‖     V = R times the motions that the holding rows leave free
//! ```
//!
//! Energy, multipliers and strains are the same for every z. Without this the place along such a motion would be what
//! the generalised inverses of the bodies make of it.

use std::collections::BTreeMap;

use super::recovery::LinearSolution;
use crate::feti::method::LinearMethod;
use crate::feti::operators::dual::Dual;
use crate::feti::projector::by_column::ByColumn;
use crate::feti::projector::kernel_motion::KernelMotion;
use crate::feti::subdomain::scaled::ScaledSubdomain;
use base::linalg::dense::Dense;
use base::linalg::semidefinite::Semidefinite;
use base::linalg::sorted::distinct;
use base::linalg::union_find::UnionFind;
use parallel::exchange::{min_all, sum_all};

/// Motions of bodies that move together.
struct CoupledMotions {
    members: Vec<usize>,
    /// VᵀV of the members, and Vᵀu.
    gram: Dense,
    along: Vec<f64>,
}

impl LinearMethod {
    /// The solution with bodies moved as near to the start as possible along what the rows leave free, without closing
    /// a gap further than it is closed. Collective.
    pub(crate) fn at_rest(&self, mut found: LinearSolution) -> LinearSolution {
        let dual = self.dual();
        let motions = dual.natural.unheld();
        if motions.is_empty() {
            return found;
        }
        let sizes: Vec<usize> = self.problem.local.iter().map(|sub| sub.f.len()).collect();
        let kernels = kernels(&dual, motions, &sizes);
        let mut groups = groups(&dual, motions);
        measure(&dual, motions, &mut groups, &kernels, &found.u);
        let mut z = vec![0.0; motions.len()];
        for group in &mut groups {
            Semidefinite::new(&group.gram).solve(&mut group.along);
            let parts = group.members.iter().zip(&group.along);
            parts.for_each(|(&m, v)| z[m] = -v);
        }
        self.shorten(
            &dual,
            motions,
            &groups,
            (&mut z, &mut found.gaps),
            &found.active,
        );
        let known = dual.natural.known();
        let mut alpha = vec![0.0; known.n()];
        for (motion, &z) in motions.iter().zip(&z) {
            known.add(z, motion, &mut alpha);
        }
        for (j, kernel) in &kernels {
            let first = dual.natural.first_column(*j);
            kernel.add_mul(&alpha[first..first + kernel.cols], &mut found.u[*j]);
        }
        found
    }

    /// Takes of each group only as much as the rows that do not hold allow, and moves their gaps. Collective.
    fn shorten(
        &self,
        dual: &Dual,
        motions: &[KernelMotion],
        groups: &[CoupledMotions],
        (z, gaps): (&mut [f64], &mut [f64]),
        active: &[bool],
    ) {
        let jump = &dual.stiffness.jump;
        let by_column = ByColumn::new(dual.natural.known(), motions.iter());
        let mut group_of = vec![0; motions.len()];
        for (g, group) in groups.iter().enumerate() {
            group.members.iter().for_each(|&m| group_of[m] = g);
        }
        // How far each group closes the gap of a row.
        let closes = |i: usize, z: &[f64]| {
            let (columns, values) = dual.natural.all.entries(i);
            let mut out: BTreeMap<usize, f64> = BTreeMap::new();
            for (m, work) in by_column.works(columns, values) {
                *out.entry(group_of[m]).or_default() += z[m] * work;
            }
            out
        };
        let open = |i: &usize| jump.law[*i].is_inequality() && !active[*i];
        let mut share = vec![1.0; groups.len()];
        for i in jump.rows_between_bodies().filter(open) {
            let each = closes(i, z);
            let all: f64 = each.values().filter(|c| **c > 0.0).sum();
            let room = (-gaps[i]).max(0.0);
            if all > room {
                let part = room / all;
                for (g, _) in each.iter().filter(|c| *c.1 > 0.0) {
                    share[*g] = part.min(share[*g]);
                }
            }
        }
        min_all(dual.comm(), &mut share);
        z.iter_mut()
            .zip(&group_of)
            .for_each(|(z, &g)| *z *= share[g]);
        for i in jump.rows_between_bodies().filter(open) {
            gaps[i] += closes(i, z).values().sum::<f64>();
        }
    }
}

/// R at all dofs of the local subdomains whose bodies move.
fn kernels(dual: &Dual, motions: &[KernelMotion], sizes: &[usize]) -> Vec<(usize, Dense)> {
    let natural = &dual.natural;
    let moved = distinct(
        motions
            .iter()
            .flat_map(|m| &m.0)
            .map(|e| natural.columns.body(e.0)),
    );
    let locals = &dual.stiffness.locals;
    let moves = |j: &usize| {
        let name = || natural.known().name(natural.first_column(*j) as u32);
        let is_moved = || moved.binary_search(&natural.columns.body(name())).is_ok();
        natural.kernels[*j].cols > 0 && is_moved()
    };
    let which: Vec<usize> = (0..locals.len()).filter(moves).collect();
    let on_gamma = &natural.kernels;
    let of = |k: usize| {
        let (j, local) = (which[k], &locals[which[k]]);
        let kernel = &on_gamma[j];
        let still = ScaledSubdomain::condense_many(&[local], &[&vec![0.0; sizes[j]]]);
        let columns = (0..kernel.cols).map(|c| {
            ScaledSubdomain::recover_many(&[local], &[(&still[0].0, kernel.col(c))]).concat()
        });
        let data: Vec<f64> = columns.flatten().collect();
        let (rows, cols) = (data.len() / kernel.cols, kernel.cols);
        (j, Dense { rows, cols, data })
    };
    dual.stiffness.team.map(which.len(), of)
}

/// Motions that have bodies in common, directly or through others.
fn groups(dual: &Dual, motions: &[KernelMotion]) -> Vec<CoupledMotions> {
    let columns = &dual.natural.columns;
    let mut first: BTreeMap<u32, usize> = BTreeMap::new();
    let mut sets = UnionFind::new(motions.len());
    for (m, motion) in motions.iter().enumerate() {
        for e in &motion.0 {
            let other = *first.entry(columns.body(e.0)).or_insert(m);
            sets.join(other, m);
        }
    }
    let mut members: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for m in 0..motions.len() {
        members.entry(sets.find(m)).or_default().push(m);
    }
    let group = |members: Vec<usize>| CoupledMotions {
        gram: Dense::zeros(members.len(), members.len()),
        along: vec![0.0; members.len()],
        members,
    };
    members.into_values().map(group).collect()
}

/// VᵀV and Vᵀu of the groups. Collective.
fn measure(
    dual: &Dual,
    motions: &[KernelMotion],
    groups: &mut [CoupledMotions],
    kernels: &[(usize, Dense)],
    u: &[Vec<f64>],
) {
    let natural = &dual.natural;
    let mut place = vec![(0, 0); motions.len()];
    for (g, group) in groups.iter().enumerate() {
        group
            .members
            .iter()
            .enumerate()
            .for_each(|(p, &m)| place[m] = (g, p));
    }
    let by_column = ByColumn::new(natural.known(), motions.iter());
    for (j, kernel) in kernels {
        let first = natural.first_column(*j);
        let columns = first..first + kernel.cols;
        let of_body = |c: usize| by_column.at(c as u32).iter().map(|e| e.0 as usize);
        let here = distinct(columns.clone().flat_map(of_body));
        let v: Vec<Vec<f64>> = (here.iter())
            .map(|&m| {
                let coefficient = |c: usize| {
                    let at = by_column.at(c as u32);
                    at.iter().find(|e| e.0 as usize == m).map_or(0.0, |e| e.1)
                };
                let alpha: Vec<f64> = columns.clone().map(coefficient).collect();
                let mut v = vec![0.0; kernel.rows];
                kernel.add_mul(&alpha, &mut v);
                v
            })
            .collect();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        for (p, &m) in here.iter().enumerate() {
            let (g, row) = place[m];
            groups[g].along[row] += dot(&v[p], &u[*j]);
            for (q, &n) in here.iter().enumerate() {
                let gram = &mut groups[g].gram;
                let col = place[n].1;
                gram.set(row, col, gram.get(row, col) + dot(&v[p], &v[q]));
            }
        }
    }
    let mut all: Vec<f64> = groups
        .iter()
        .flat_map(|g| g.gram.data.iter().chain(&g.along))
        .copied()
        .collect();
    sum_all(dual.comm(), &mut all);
    let mut rest = all.into_iter();
    for group in groups {
        let numbers = group.gram.data.iter_mut().chain(&mut group.along);
        numbers.zip(&mut rest).for_each(|(to, from)| *to = from);
    }
}

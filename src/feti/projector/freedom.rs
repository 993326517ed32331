//! Motions of bodies that no row holds, gathered and named.

use mpi::topology::SimpleCommunicator;

use super::candidates::rows_of_bodies;
use super::columns::KernelColumns;
use super::gram::Gram;
use super::motion::Motion;
use super::natural::NaturalCoarse;
use super::numbers::Numbers;
use super::pattern::meeting;
use super::rounding::rounding_of_rows;
use super::shape::{Shape, Sharing};
use super::twist::{twists, Twist};
use super::words::{as_one, in_words};
use crate::feti::jump::operator::Jump;
use crate::feti::operators::stiffness::Stiffness;
use crate::linalg::dense::Dense;
use crate::linalg::sorted::distinct;
use crate::substructures::Substructures;

/// Motions that nothing holds, of one body or of bodies that move together.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeMotion {
    /// The bodies, increasing.
    pub bodies: Vec<usize>,
    /// What they do, to be continued from their names: "slides along x and turns about z through (0.5, 0, 0)".
    pub words: String,
}

impl FreeMotion {
    /// Whether it is a motion by which people would know it: not all of them, and the same of all bodies.
    pub fn is_one(&self) -> bool {
        !self.words.ends_with("freely") && !self.words.contains(':')
    }
}

/// Coefficients of a motion below this, relative to the largest, do not make a body take part.
const PART: f64 = 1e-8;

impl NaturalCoarse {
    /// The motions that the rows which hold now leave free. The same on every rank. Collective.
    pub fn free_motions(
        &self,
        comm: &SimpleCommunicator,
        problem: &Substructures,
        stiffness: &Stiffness,
    ) -> Vec<FreeMotion> {
        self.named(comm, problem, stiffness, self.unheld())
    }

    /// These motions with their names. Collective.
    pub fn named(
        &self,
        comm: &SimpleCommunicator,
        problem: &Substructures,
        stiffness: &Stiffness,
        motions: &[Motion],
    ) -> Vec<FreeMotion> {
        if motions.is_empty() {
            return Vec::new();
        }
        let owned = stiffness.space.owned.iter();
        let owned = owned.map(|body| (body.body, &body.combinations));
        let twists = twists(comm, problem, &self.columns, owned, motions);
        grouped(problem, &self.columns, motions, &twists)
    }
}

/// The motions that all candidate rows together leave free, found without a factorisation. `combinations` has the
/// kernel of each body as combinations of the candidates for it, on every rank; `jump` has its entries at local dofs.
/// Collective.
pub fn free_motions(
    comm: &SimpleCommunicator,
    problem: &Substructures,
    jump: &Jump,
    combinations: &[Dense],
) -> Vec<FreeMotion> {
    let columns = KernelColumns::of_defects(combinations.iter().map(|c| c.cols));
    if columns.n() == 0 {
        return Vec::new();
    }
    let kernels: Vec<Dense> = (problem.local.iter())
        .map(|sub| {
            let of_body = &combinations[sub.body];
            let mut kernel = Dense::zeros(sub.dofs.len(), of_body.cols);
            for c in 0..of_body.cols {
                let terms = of_body.col(c).iter().zip(sub.near_kernel.iter().flatten());
                for (factor, candidate) in terms {
                    let sums = kernel.col_mut(c).iter_mut().zip(candidate);
                    sums.for_each(|(sum, x)| *sum += factor * x);
                }
            }
            kernel
        })
        .collect();
    let rows = rows_of_bodies(comm, problem, jump, (&columns, &kernels));
    let lists = meeting(comm, &rows, &rows, columns.start());
    let shape = Shape::new(comm, &lists, columns.start(), &Sharing::any());
    let rows = rows.numbered(&shape.known);
    let candidates: Vec<bool> = (0..jump.n_owned).map(|i| jump.is_candidate(i)).collect();
    let noise = rounding_of_rows(comm, problem, jump, (&rows, &shape));
    let product = Numbers::default().renewed(comm, &shape, &rows, &candidates);
    let motions = Gram::without(&shape, product, (&[], &noise)).unheld;
    // The first rank with a subdomain of a body speaks for it.
    let first = jump.subdomains.first().copied();
    let owned = combinations.iter().enumerate();
    let owned =
        owned.filter(|(body, _)| first.is_some() && problem.local.iter().any(|s| s.body == *body));
    let mut twists = twists(comm, problem, &columns, owned, &motions);
    twists.iter_mut().for_each(|of| of.dedup_by_key(|t| t.body));
    grouped(problem, &columns, &motions, &twists)
}

/// Motions of the same bodies as one.
fn grouped(
    problem: &Substructures,
    columns: &KernelColumns,
    motions: &[Motion],
    twists: &[Vec<Twist>],
) -> Vec<FreeMotion> {
    let bodies_of = |motion: &Motion| {
        let largest = motion.largest();
        let part = motion.0.iter().filter(|e| e.1.abs() > PART * largest);
        distinct(part.map(|e| columns.body(e.0)))
    };
    let mut keyed: Vec<(Vec<u32>, usize)> = (motions.iter().enumerate())
        .map(|(m, motion)| (bodies_of(motion), m))
        .collect();
    keyed.sort();
    let mut out = Vec::new();
    for group in keyed.chunk_by(|a, b| a.0 == b.0) {
        let bodies: Vec<usize> = group[0].0.iter().map(|&b| b as usize).collect();
        let all: Vec<&[Twist]> = group.iter().map(|g| &twists[g.1][..]).collect();
        let many = bodies.len() > 1;
        let mut add = |words: String| {
            let bodies = bodies.clone();
            out.push(FreeMotion { bodies, words });
        };
        if all.iter().any(|twists| twists.len() != bodies.len()) {
            add(if many { "move freely" } else { "moves freely" }.into());
        } else if all.iter().all(|twists| as_one(twists)) {
            let first: Vec<Twist> = all.iter().map(|twists| twists[0]).collect();
            let together = if many { " together" } else { "" };
            add(in_words(&first, many) + together);
        } else {
            for twists in all {
                let each = twists.iter().take(3).map(|t| {
                    let name = &problem.body_names[t.body];
                    format!("\"{name}\" {}", in_words(&[*t], false))
                });
                let each: Vec<String> = each.collect();
                let more = if twists.len() > 3 { ", …" } else { "" };
                add(format!("move: {}{more}", each.join(", ")));
            }
        }
    }
    out
}

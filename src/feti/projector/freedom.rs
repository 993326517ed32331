//! Motions of bodies that no row holds, gathered and named.

use mpi::topology::SimpleCommunicator;

use super::columns::KernelColumns;
use super::kernel_motion::KernelMotion;
use super::natural::NaturalCoarse;
use super::rigid_motion::{twists, RigidMotion};
use super::words::{as_one, in_words};
use crate::feti::operators::stiffness::Stiffness;
use crate::substructures::Problem;
use base::linalg::sorted::distinct;

/// Motions that nothing holds, of one body or of bodies that move together.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeMotion {
    /// The bodies, increasing.
    pub bodies: Vec<usize>,
    /// The motion in words that continue the names of the bodies: "slides along x and turns about z through (0.5, 0,
    /// 0)".
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
        problem: &Problem,
        stiffness: &Stiffness,
    ) -> Vec<FreeMotion> {
        self.named(comm, problem, stiffness, self.unheld())
    }

    /// These motions with their names. Collective.
    pub fn named(
        &self,
        comm: &SimpleCommunicator,
        problem: &Problem,
        stiffness: &Stiffness,
        motions: &[KernelMotion],
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

/// Motions of the same bodies as one.
pub(super) fn grouped(
    problem: &Problem,
    columns: &KernelColumns,
    motions: &[KernelMotion],
    twists: &[Vec<RigidMotion>],
) -> Vec<FreeMotion> {
    let bodies_of = |motion: &KernelMotion| {
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
        let all: Vec<&[RigidMotion]> = group.iter().map(|g| &twists[g.1][..]).collect();
        let many = bodies.len() > 1;
        let mut add = |words: String| {
            let bodies = bodies.clone();
            out.push(FreeMotion { bodies, words });
        };
        if all.iter().any(|twists| twists.len() != bodies.len()) {
            add(if many { "move freely" } else { "moves freely" }.into());
        } else if all.iter().all(|twists| as_one(twists)) {
            let first: Vec<RigidMotion> = all.iter().map(|twists| twists[0]).collect();
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

//! The part of a scene that one rank needs: which subdomains it owns, and what their rows are made of.

use std::collections::HashSet;
use std::ops::Range;

use super::body::Body;
use super::geometry::interface::BodyInterface;
use super::interfaces::Interfaces;
use super::model::spec::SceneSpec;
use super::rows::obstacles::Obstacle;
use super::rows::row::Row;
use fetifeti::problem::RowSource;
use parallel::contiguous_share;

/// The part of one of several ranks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RankPart {
    /// Whether subdomains are dealt out one after the other in turn, and not in contiguous blocks.
    pub cyclic: bool,
    /// The number of ranks.
    pub ranks: usize,
    /// The rank.
    pub rank: usize,
}

impl RankPart {
    /// All of a scene.
    pub const WHOLE: RankPart = RankPart {
        cyclic: false,
        ranks: 1,
        rank: 0,
    };

    /// This part, or the whole where rows lead from point to point, so that their blocks and owners follow from all of
    /// them: where there are equations, or sides whose nodes do not match.
    pub fn of(
        self,
        spec: &SceneSpec,
        interfaces: &[BodyInterface],
        obstacles: &[Obstacle],
    ) -> RankPart {
        let chained = !spec.equations.is_empty()
            || interfaces.iter().any(|i| i.mortar.is_some())
            || obstacles.iter().any(|o| o.surface.is_some());
        if chained {
            RankPart::WHOLE
        } else {
            self
        }
    }

    /// For each body the ranks that own subdomains of it, increasing.
    pub fn ranks_of(self, bodies: &[Body]) -> impl Fn(usize) -> Vec<usize> + use<'_> {
        let starts = starts(bodies, self.ranks);
        let RankPart { cyclic, ranks, .. } = self;
        move |b: usize| {
            let rank_of = |s: usize| {
                if cyclic {
                    s % ranks
                } else {
                    starts[1..].partition_point(|&end| end <= s)
                }
            };
            base::linalg::sorted::distinct(bodies[b].subdomains().map(rank_of))
        }
    }

    /// A predicate: whether the rank owns a subdomain.
    pub fn owns(self, bodies: &[Body]) -> impl Fn(usize) -> bool + use<> {
        let RankPart {
            cyclic,
            ranks,
            rank,
        } = self;
        let share = share(bodies, ranks, rank);
        move |s| {
            if cyclic {
                s % ranks == rank
            } else {
                share.contains(&s)
            }
        }
    }
}

/// The interfaces that a rank needs: those of its bodies and of its rows. The first rank reports all; of
/// the others it drops what they know node by node.
pub(super) fn needed(
    mut interfaces: Vec<BodyInterface>,
    bodies: &[Body],
    rows: &[Row],
    part: RankPart,
) -> Interfaces {
    let owns = part.owns(bodies);
    let own = |body: &usize| bodies[*body].subdomains().any(&owns);
    let used: HashSet<RowSource> = rows.iter().map(|row| row.source).collect();
    let needs = |k: usize, interface: &BodyInterface| {
        interface.bodies.iter().any(own) || used.contains(&RowSource::Interface(k))
    };
    if part.rank > 0 {
        return Interfaces::part(interfaces, needs);
    }
    for (k, interface) in interfaces.iter_mut().enumerate() {
        if !needs(k, interface) {
            interface.forget_nodes();
        }
    }
    interfaces.into()
}

/// The block of subdomains of a rank: of equal work where there are meshes of cells, else of equal number. A body may
/// lie on several ranks.
fn share(bodies: &[Body], ranks: usize, rank: usize) -> Range<usize> {
    let starts = starts(bodies, ranks);
    starts[rank]..starts[rank + 1]
}

/// Where the blocks of the ranks start, and the end of the last one.
fn starts(bodies: &[Body], ranks: usize) -> Vec<usize> {
    let n = bodies.iter().map(|b| b.mesh().n_subdomains()).sum();
    if ranks == 1 || bodies.iter().all(|b| b.mesh().cells().is_none()) {
        return by_number(n, ranks);
    }
    let works = bodies.iter().flat_map(|body| {
        let nodes = |s: usize| match body.mesh().cells() {
            Some(mesh) => mesh.parts.nodes(s).len(),
            None => body.mesh().subdomain_nodes(s).len(),
        };
        let count = body.mesh().n_subdomains();
        (0..count).map(move |s| ((body.components * nodes(s)) as f64).powf(WORK))
    });
    by_work(&works.collect::<Vec<f64>>(), ranks)
}

/// The work of a subdomain grows as this power of its unknowns: solves as the power 1.2 to 1.4, factorisations as 1.5
/// in the plane and 2 in space.
const WORK: f64 = 1.5;

/// The starts of blocks of about equal number.
fn by_number(n: usize, ranks: usize) -> Vec<usize> {
    let starts = (0..ranks).map(|r| contiguous_share(n, ranks, r).start);
    starts.chain([n]).collect()
}

/// The starts of blocks of about equal work. Every rank gets an item if there are enough.
fn by_work(works: &[f64], ranks: usize) -> Vec<usize> {
    let n = works.len();
    if n <= ranks {
        return by_number(n, ranks);
    }
    let total: f64 = works.iter().sum();
    // An item belongs to the block in which its middle lies.
    let mut done = 0.0;
    let middles: Vec<f64> = works
        .iter()
        .map(|w| {
            done += w;
            (done - 0.5 * w) / total
        })
        .collect();
    let start = |r: usize| {
        let bound = r as f64 / ranks as f64;
        middles
            .partition_point(|m| *m < bound)
            .clamp(r, n - (ranks - r))
    };
    (0..=ranks).map(start).collect()
}

#[cfg(test)]
#[path = "../tests/part.rs"]
mod tests;

//! The bodies that meet in each row, and groups of bodies that do not interact.

use super::blocks::positions;
use crate::feti::operators::stiffness::Stiffness;
use crate::substructures::Problem;
use base::linalg::lists::Lists;
use base::linalg::sorted::distinct;
use parallel::exchange::gather_all;

/// The bodies and the rows between them. Neighbours are known to every rank, rows to their owner.
pub struct BodyGraph {
    /// Number of bodies.
    pub n: usize,
    /// Bodies with an entry of B in each owned row, whether or not the row holds.
    pub terms: Lists,
    /// Bodies with an entry of B_D in each owned row: those of the row's block.
    pub touched: Lists,
    /// For every body, the body itself and all bodies that it shares a block of rows with, increasing.
    pub near: Vec<Vec<u32>>,
    /// Where the bodies are, if they are known.
    pub at: Option<Vec<[f64; 3]>>,
}

impl BodyGraph {
    /// Reads the rows. Collective.
    pub fn new(problem: &Problem, stiffness: &Stiffness) -> BodyGraph {
        let jump = &stiffness.jump;
        let n = problem.n_bodies;
        let mut local = vec![0u32; jump.n_owned_local];
        for (j, sub) in problem.local.iter().enumerate() {
            local[jump.local_start[j]..jump.local_start[j + 1]].fill(sub.body as u32);
        }
        let mut terms: Vec<Vec<u32>> = local.iter().map(|&b| vec![b]).collect();
        let mut touched = terms.clone();
        let mut pairs: Vec<[u32; 2]> = Vec::new();
        for block in &jump.blocks {
            let bodies = block.bodies();
            for r in 0..block.rows.len() {
                terms.push(block.bodies_of(r));
                touched.push(bodies.clone());
            }
            for &a in &bodies {
                pairs.extend(bodies.iter().map(|&b| [a, b]));
            }
        }
        let mut near: Vec<Vec<u32>> = (0..n as u32).map(|b| vec![b]).collect();
        for [a, b] in gather_all(stiffness.comm(), &distinct(pairs)).concat() {
            near[a as usize].push(b);
        }
        BodyGraph {
            n,
            terms: sorted(terms),
            touched: sorted(touched),
            near: near.into_iter().map(distinct).collect(),
            at: positions(stiffness.comm(), problem),
        }
    }

    /// All bodies near one of `bodies`.
    pub fn around(&self, bodies: &[u32]) -> Vec<u32> {
        let lists = bodies.iter().flat_map(|&b| &self.near[b as usize]);
        distinct(lists.copied())
    }

    /// For every body those that are near a body near it, increasing.
    pub fn second(&self) -> Vec<Vec<u32>> {
        self.near.iter().map(|near| self.around(near)).collect()
    }

    /// Groups of `bodies` such that no body is near two bodies of one group. M⁻¹ applied to a jump at one body of a
    /// group then does not reach the rows of another one.
    pub fn colours(&self, bodies: &[u32]) -> Vec<Vec<u32>> {
        let mut colour = vec![usize::MAX; self.n];
        let mut groups: Vec<Vec<u32>> = Vec::new();
        for &body in bodies {
            let others = self.around(&self.near[body as usize]);
            let taken: Vec<usize> = others.iter().map(|&b| colour[b as usize]).collect();
            let free = (0..)
                .find(|c| !taken.contains(c))
                .expect("there is always one more");
            colour[body as usize] = free;
            if free == groups.len() {
                groups.push(Vec::new());
            }
            groups[free].push(body);
        }
        groups
    }
}

/// Lists of bodies, one for each owned row, each increasing.
fn sorted(lists: Vec<Vec<u32>>) -> Lists {
    let mut out = Lists::default();
    lists.into_iter().for_each(|list| out.push(distinct(list)));
    out
}

//! Additional primal constraints: enough that no subdomain can move rigidly against a neighbour in its body.
//!
//! Only motions without energy matter. If two subdomains share a face, its vertices and the averages over its edges
//! must detect all of these motions. If they do not, the average over the face becomes a constraint. If that is still
//! not enough, nodes of the face are added one by one; each is the node that moves most in the motions not yet
//! detected, which spreads the nodes.

use std::collections::BTreeSet;

use super::classes::Class;
use super::kernels::{combinations, orthogonal, Columns};
use super::parts::Part;
use super::sharing::Sharers;
use super::torn::Torn;
use crate::feti::Primal;
use crate::parallel::exchange::gather_all;
use crate::petsc::Session;
use crate::substructures::EntityKind;

/// Two subdomains that have dofs in common.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bond {
    /// The lower one.
    pub low: usize,
    /// The other one.
    pub high: usize,
    /// Dofs in common.
    pub shared: usize,
    /// Whether equality at the common dofs excludes every rigid motion between the two.
    pub holds: bool,
}

/// An average counts as a constraint if it detects at least this much of a motion (of order one) that the
/// constraints before it do not detect.
const SEEN: f64 = 0.1;

/// A motion of the face is poorly detected if no constraint sees this fraction of its largest value. Then one more node
/// is constrained.
const WELL_SEEN: f64 = 0.5;

/// Values below this count as zero.
const LOOSE: f64 = 1e-6;

/// With more motions than this, they are not taken for rigid body motions.
const MANY: usize = 12;

/// The motions without energy of the subdomains, and the number of nodes that exclude them.
pub struct Motions {
    /// An orthogonal basis in every part, entries of order one.
    bases: Vec<Columns>,
    /// Components of the field.
    components: usize,
    /// Number of nodes needed to exclude all motions: more than one where rotations are possible but not known.
    nodes: usize,
}

impl Motions {
    /// Takes the known motions, else the constants of each component.
    pub fn new(torn: &Torn, parts: &[Part], known: Option<&[Columns]>) -> Motions {
        let constants = |part: &Part| -> Columns {
            let one = |c: usize| {
                let value = |&dof: &u32| f64::from(u8::from(torn.component(dof) == c));
                part.dofs.iter().map(value).collect()
            };
            (0..torn.block_size).map(one).collect()
        };
        let bases = match known {
            Some(columns) => columns.iter().map(orthogonal).collect(),
            None => parts.iter().map(|p| orthogonal(&constants(p))).collect(),
        };
        Motions {
            bases,
            components: torn.block_size,
            nodes: match (known, torn.block_size) {
                (None, 2) => 2,
                (None, 3) => 3,
                _ => 1,
            },
        }
    }

    /// All bonds, the same on every rank. Collective.
    pub fn bonds(
        &self,
        session: &Session,
        torn: &Torn,
        parts: &[Part],
        sharers: &Sharers,
    ) -> Vec<Bond> {
        let sizes: Vec<u64> = parts
            .iter()
            .zip(&self.bases)
            .flat_map(|(part, basis)| [basis.len() as u64, n_nodes(torn, &part.dofs) as u64])
            .collect();
        let sizes = gather_all(session.comm(), &sizes).concat();
        let mut mine = Vec::new();
        for (j, part) in parts.iter().enumerate() {
            let low = sharers.first + j;
            for (high, dofs) in &sharers.neighbours[j] {
                let high = *high as usize;
                if high < low {
                    continue;
                }
                let mut span = Span::default();
                for &i in dofs {
                    span.add(self.row(j, i), LOOSE);
                }
                let least = |k: usize| sizes[2 * low + k].min(sizes[2 * high + k]) as usize;
                let global: Vec<u32> = dofs.iter().map(|&i| part.dofs[i as usize]).collect();
                let holds =
                    span.rank() >= least(0) && n_nodes(torn, &global) >= self.nodes.min(least(1));
                mine.extend([
                    (low as u64) << 32 | high as u64,
                    (dofs.len() as u64) << 1 | u64::from(holds),
                ]);
            }
        }
        let words = gather_all(session.comm(), &mine).concat();
        let bond = |w: &[u64]| Bond {
            low: (w[0] >> 32) as usize,
            high: w[0] as u32 as usize,
            shared: (w[1] >> 1) as usize,
            holds: w[1] & 1 == 1,
        };
        words.chunks_exact(2).map(bond).collect()
    }

    /// The constraints needed besides vertices and the averages of `primal`: pairs of subdomains whose common faces are
    /// averaged (the same on every rank), and dofs of every local subdomain. Collective.
    pub fn missing(
        &self,
        session: &Session,
        torn: &Torn,
        parts: &[Part],
        sharers: &Sharers,
        classes: &[Vec<Class>],
        shape: &Shape,
    ) -> (BTreeSet<(u32, u32)>, Vec<BTreeSet<u32>>) {
        let mut averaged = Vec::new();
        let mut nodes: Vec<BTreeSet<u32>> = vec![BTreeSet::new(); parts.len()];
        for (j, part) in parts.iter().enumerate() {
            let low = sharers.first + j;
            for (high, dofs) in &sharers.neighbours[j] {
                let same = shape.body_of[low] == shape.body_of[*high as usize];
                if (*high as usize) < low || !same {
                    continue;
                }
                let mut all = Span::default();
                for &i in dofs {
                    all.add(self.row(j, i), LOOSE);
                }
                let mut span = Span::default();
                let mut held: Vec<Vec<f64>> = Vec::new();
                let mut points: Vec<u32> = Vec::new();
                let common = classes[j].iter().filter(|c| c.sharers.contains(high));
                for class in common.clone() {
                    let kind = class.kind(shape.space);
                    if (class.is_vertex() && shape.primal.vertices)
                        || (!class.is_vertex() && shape.primal.takes(kind))
                    {
                        span.add(self.mean(j, &class.dofs), SEEN);
                        held.push(self.mean(j, &class.dofs));
                        points.push(class.dofs[class.dofs.len() / 2]);
                    }
                }
                let faces = common.filter(|c| c.kind(shape.space) == EntityKind::Face);
                if span.rank() < all.rank() && shape.primal.edges && !shape.primal.faces {
                    for face in faces {
                        averaged.push(u64::from(low as u32) << 32 | u64::from(*high));
                        span.add(self.mean(j, &face.dofs), SEEN);
                        held.push(self.mean(j, &face.dofs));
                        points.push(face.dofs[face.dofs.len() / 2]);
                    }
                }
                let extra = &mut nodes[j];
                while span.rank() < all.rank() {
                    let seen = |i: &u32| norm(&span.rest(self.row(j, *i)));
                    let best = dofs.iter().max_by(|a, b| seen(a).total_cmp(&seen(b)));
                    let Some(best) = best.filter(|i| seen(i) > LOOSE) else {
                        break;
                    };
                    for &i in dofs.iter().filter(|&&i| same_node(torn, part, i, *best)) {
                        span.add(self.row(j, i), LOOSE);
                        held.push(self.row(j, i));
                        extra.insert(i);
                    }
                    points.push(*best);
                }
                while let Some(best) = self.badly_seen(j, dofs, &held) {
                    for &i in dofs.iter().filter(|&&i| same_node(torn, part, i, best)) {
                        held.push(self.row(j, i));
                        extra.insert(i);
                    }
                    points.push(best);
                }
                if self.nodes > 1 {
                    for best in spread(torn, part, dofs, &points, self.nodes) {
                        let node = dofs.iter().filter(|&&i| same_node(torn, part, i, best));
                        extra.extend(node);
                    }
                }
            }
        }
        let averaged = gather_all(session.comm(), &averaged).concat();
        let pair = |w: &u64| ((w >> 32) as u32, *w as u32);
        (averaged.iter().map(pair).collect(), nodes)
    }

    /// Finds the motion that the constraints `held` detect worst. If they detect it poorly, returns the dof of `dofs`
    /// that moves most in it. Applies only if rotations are known.
    fn badly_seen(&self, j: usize, dofs: &[u32], held: &[Vec<f64>]) -> Option<u32> {
        let k = self.bases[j].len();
        if k <= self.components || k > MANY {
            return None;
        }
        let mut gram = vec![0.0; k * k];
        for &i in dofs {
            let row = self.row(j, i);
            for a in 0..k {
                for b in 0..k {
                    gram[a + b * k] += row[a] * row[b];
                }
            }
        }
        // Motions of unit size on the face, and the value of a constraint for a motion.
        let motions = combinations(&gram, k);
        let seen =
            |row: &Vec<f64>, c: &[f64]| -> f64 { row.iter().zip(c).map(|(r, c)| r * c).sum() };
        let n = motions.len();
        let entry = |a: usize, b: usize| {
            let terms = held
                .iter()
                .map(|f| seen(f, &motions[a]) * seen(f, &motions[b]));
            terms.sum::<f64>()
        };
        let eigen = faer::Mat::from_fn(n, n, entry)
            .self_adjoint_eigen(faer::Side::Lower)
            .ok()?;
        let weights = (0..n).map(|a| eigen.U()[(a, 0)]);
        let mut worst = vec![0.0; k];
        for (weight, motion) in weights.zip(&motions) {
            worst
                .iter_mut()
                .zip(motion)
                .for_each(|(w, m)| *w += weight * m);
        }
        let moves = |i: &u32| seen(&self.row(j, *i), &worst).abs();
        let best = *dofs.iter().max_by(|a, b| moves(a).total_cmp(&moves(b)))?;
        let most = held
            .iter()
            .map(|f| seen(f, &worst).abs())
            .fold(0.0, f64::max);
        (most < WELL_SEEN * moves(&best)).then_some(best)
    }

    /// The values of all motions at dof `i` of part `j`.
    fn row(&self, j: usize, i: u32) -> Vec<f64> {
        self.bases[j].iter().map(|x| x[i as usize]).collect()
    }

    fn mean(&self, j: usize, dofs: &[u32]) -> Vec<f64> {
        let one = |x: &Vec<f64>| {
            let sum: f64 = dofs.iter().map(|&i| x[i as usize]).sum();
            sum / dofs.len() as f64
        };
        self.bases[j].iter().map(one).collect()
    }
}

/// Decisions that precede the choice of constraints.
pub struct Shape {
    /// Body of every subdomain.
    pub body_of: Vec<usize>,
    /// Whether the problem is three-dimensional.
    pub space: bool,
    /// Constraints that the user wants.
    pub primal: Primal,
}

/// An orthonormal basis of the detected motions.
#[derive(Default)]
struct Span(Vec<Vec<f64>>);

impl Span {
    fn rank(&self) -> usize {
        self.0.len()
    }

    fn rest(&self, mut row: Vec<f64>) -> Vec<f64> {
        for _ in 0..2 {
            for q in &self.0 {
                let part: f64 = row.iter().zip(q).map(|(x, q)| x * q).sum();
                row.iter_mut().zip(q).for_each(|(x, q)| *x -= part * q);
            }
        }
        row
    }

    fn add(&mut self, row: Vec<f64>, least: f64) {
        if self.rank() == row.len() {
            return;
        }
        let mut rest = self.rest(row);
        let size = norm(&rest);
        if size > least {
            rest.iter_mut().for_each(|x| *x /= size);
            self.0.push(rest);
        }
    }
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|v| v * v).sum::<f64>().sqrt()
}

fn same_node(torn: &Torn, part: &Part, i: u32, j: u32) -> bool {
    torn.node(part.dofs[i as usize]) == torn.node(part.dofs[j as usize])
}

/// Number of nodes among increasing global dofs.
fn n_nodes(torn: &Torn, dofs: &[u32]) -> usize {
    dofs.chunk_by(|a, b| torn.node(*a) == torn.node(*b)).count()
}

/// Adds dofs of `dofs` to `points` until there are `wanted`. Each is as far as possible from the previous ones, in the
/// graph of the matrix.
fn spread(torn: &Torn, part: &Part, dofs: &[u32], points: &[u32], wanted: usize) -> Vec<u32> {
    let mut there: Vec<u32> = points.to_vec();
    there.dedup_by(|a, b| same_node(torn, part, *a, *b));
    let mut out = Vec::new();
    while there.len() < wanted {
        let start = match there.is_empty() {
            true => &dofs[..1],
            false => &there[..],
        };
        let distance = distances(part, start);
        let fresh = dofs
            .iter()
            .filter(|&&i| !there.iter().any(|&p| same_node(torn, part, i, p)));
        let Some(&best) = fresh.max_by_key(|&&i| (distance[i as usize], u32::MAX - i)) else {
            break;
        };
        there.push(best);
        out.push(best);
    }
    out
}

fn distances(part: &Part, start: &[u32]) -> Vec<u32> {
    let mut distance = vec![u32::MAX; part.dofs.len()];
    let mut front: Vec<u32> = start.to_vec();
    front.iter().for_each(|&i| distance[i as usize] = 0);
    let mut step = 0;
    while !front.is_empty() {
        step += 1;
        let mut next = Vec::new();
        for &i in &front {
            for &j in part.k.row(i as usize).0 {
                if distance[j as usize] == u32::MAX {
                    distance[j as usize] = step;
                    next.push(j);
                }
            }
        }
        front = next;
    }
    distance
}

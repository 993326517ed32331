//! Additional primal constraints: enough that no subdomain can move rigidly against a neighbour in its body.
//!
//! Only motions without energy matter. If two subdomains share a face, its vertices and the averages over its edges
//! must detect all of these motions. If they do not, the average over the face becomes a constraint. If that is still
//! not enough, nodes of the face are added one by one; each is the node that moves most in the motions not yet
//! detected, which spreads the nodes.

use std::collections::{BTreeMap, BTreeSet};

use super::bodies::Bodies;
use super::classes::InterfaceClass;
use super::kernels::{combinations, KernelVectors};
use super::motions::NearKernels;
use super::parts::TornSubdomain;
use super::sharing::Sharers;
use super::torn::Torn;
use crate::feti::interface::motions::beyond_means;
use crate::feti::settings::{Averages, Primal};
use crate::substructures::EntityKind;
use parallel::exchange::exchange;
use petsc::Session;

/// An average or a vertex counts as a constraint if it detects at least this much of a motion (of order one) that the
/// constraints before it do not detect.
pub(super) const SEEN: f64 = 0.1;

/// A motion of the face is poorly detected if no constraint sees this fraction of its largest value. Then one more node
/// is constrained.
const WELL_SEEN: f64 = 0.5;

/// Values below this count as zero.
pub(super) const LOOSE: f64 = 1e-6;

/// Squares of motions that differ by less than this fraction are alike.
const ALIKE: f64 = 1e-6;

/// With more motions than this, they are not taken for rigid body motions.
const MANY: usize = 12;

impl NearKernels {
    /// The constraints needed besides vertices and the averages of `primal`: pairs of subdomains whose common faces are
    /// averaged, those of which this rank has one, and dofs of every local subdomain. Collective.
    pub fn missing(
        &self,
        session: &Session,
        torn: &Torn,
        parts: &[TornSubdomain],
        sharers: &Sharers,
        classes: &[Vec<InterfaceClass>],
        shape: &ConstraintContext,
    ) -> (BTreeSet<(u32, u32)>, Vec<BTreeSet<u32>>) {
        let mut averaged = BTreeSet::new();
        let mut nodes: Vec<BTreeSet<u32>> = vec![BTreeSet::new(); parts.len()];
        for (j, part) in parts.iter().enumerate() {
            let low = sharers.first + j;
            for (high, dofs) in &sharers.neighbours[j] {
                let same = shape.bodies.of(low as u32) == shape.bodies.of(*high);
                if (*high as usize) < low || !same {
                    continue;
                }
                let motions = SharedMotions {
                    dofs,
                    rows: self.between(j, *high, dofs),
                };
                let mut all = Span::default();
                for row in &motions.rows {
                    all.add(row.clone(), LOOSE);
                }
                let mut span = Span::default();
                let mut held: Vec<Vec<f64>> = Vec::new();
                let common = classes[j].iter().filter(|c| c.sharers.contains(high));
                let mut wholes: BTreeMap<u32, Vec<&InterfaceClass>> = BTreeMap::new();
                for class in common.clone() {
                    let kind = class.kind(shape.space);
                    if class.is_vertex() && shape.primal.vertices {
                        span.add(motions.mean(&class.dofs), SEEN);
                        held.push(motions.mean(&class.dofs));
                    } else if !class.is_vertex() && shape.primal.takes(kind) {
                        wholes.entry(class.whole).or_default().push(class);
                        span.add(motions.mean(&class.dofs), SEEN);
                        held.push(motions.mean(&class.dofs));
                    }
                }
                let all_motions = shape.primal.averages == Averages::Motions && shape.space;
                if shape.primal.averages == Averages::Motions {
                    let seen = wholes.values().flat_map(|whole| motions.averages(whole));
                    seen.for_each(|row| span.add(row, LOOSE));
                }
                let faces = common.filter(|c| c.kind(shape.space) == EntityKind::Face);
                if span.rank() < all.rank() && shape.primal.edges && !shape.primal.faces {
                    for face in faces {
                        averaged.insert((low as u32, *high));
                        span.add(motions.mean(&face.dofs), SEEN);
                        held.push(motions.mean(&face.dofs));
                    }
                }
                let extra = &mut nodes[j];
                while span.rank() < all.rank() {
                    let seen = |i: u32| norm(&span.rest(motions.row(i).to_vec()));
                    let best = moves_most(torn, part, dofs, seen);
                    let Some(best) = best.filter(|node| node.iter().any(|&i| seen(i) > LOOSE))
                    else {
                        break;
                    };
                    for &i in best {
                        span.add(motions.row(i).to_vec(), LOOSE);
                        held.push(motions.row(i).to_vec());
                        extra.insert(i);
                    }
                }
                // In space what averages of motions see they see well; in the plane nodes cost little.
                let poorly = |held: &[Vec<f64>]| match all_motions {
                    true => None,
                    false => badly_seen(&motions, self.components, held),
                };
                while let Some(moves) = poorly(&held) {
                    let moves = |i: u32| moves.along(motions.row(i)).abs();
                    for &i in moves_most(torn, part, dofs, moves).unwrap_or_default() {
                        held.push(motions.row(i).to_vec());
                        extra.insert(i);
                    }
                }
            }
        }
        let mut outgoing = vec![Vec::new(); session.size()];
        for &(low, high) in &averaged {
            outgoing[sharers.owners.of(high)].push([low, high]);
        }
        let received = exchange(session.comm(), outgoing);
        averaged.extend(received.into_iter().map(|[low, high]| (low, high)));
        (averaged, nodes)
    }
}

/// The motions of two subdomains at the dofs that they share.
struct SharedMotions<'a> {
    /// Local dofs, increasing.
    dofs: &'a [u32],
    /// The values of all motions at each of them.
    rows: KernelVectors,
}

impl SharedMotions<'_> {
    /// The values of all motions at local dof `i`.
    fn row(&self, i: u32) -> &[f64] {
        let at = self.dofs.binary_search(&i);
        &self.rows[at.expect("a shared dof")]
    }

    /// The values of averages of motions over an edge or face, beyond the means of its components, for all motions.
    fn averages(&self, whole: &[&InterfaceClass]) -> KernelVectors {
        let of = |(c, class): (usize, &&InterfaceClass)| -> Vec<(u32, usize)> {
            class.dofs.iter().map(|&i| (i, c)).collect()
        };
        let mut dofs: Vec<(u32, usize)> = whole.iter().enumerate().flat_map(of).collect();
        dofs.sort_unstable();
        let k = self.rows.first().map_or(0, Vec::len);
        let column = |a: usize| dofs.iter().map(|&(i, _)| self.row(i)[a]).collect();
        let columns: KernelVectors = (0..k).map(column).collect();
        let component: Vec<usize> = dofs.iter().map(|d| d.1).collect();
        let root = (dofs.len() as f64).sqrt();
        let along =
            |w: &Vec<f64>, x: &Vec<f64>| w.iter().zip(x).map(|(w, x)| w * x).sum::<f64>() / root;
        let row = |w: &Vec<f64>| columns.iter().map(|x| along(w, x)).collect();
        let weights = beyond_means(columns.clone(), &component);
        weights.iter().map(row).collect()
    }

    /// The means of all motions over some of the dofs.
    fn mean(&self, dofs: &[u32]) -> Vec<f64> {
        let mut sum = vec![0.0; self.rows.first().map_or(0, Vec::len)];
        for &i in dofs {
            sum.iter_mut().zip(self.row(i)).for_each(|(s, x)| *s += x);
        }
        sum.iter().map(|s| s / dofs.len() as f64).collect()
    }
}

/// A combination of motions, by its coefficients.
struct Mixed(Vec<f64>);

impl Mixed {
    /// Its value where those of all motions are `row`.
    fn along(&self, row: &[f64]) -> f64 {
        row.iter().zip(&self.0).map(|(r, c)| r * c).sum()
    }
}

/// The motion that the constraints `held` detect worst, if they detect it poorly. Applies only if rotations are known.
fn badly_seen(motions: &SharedMotions, components: usize, held: &[Vec<f64>]) -> Option<Mixed> {
    let (dofs, k) = (motions.dofs, motions.rows.first().map_or(0, Vec::len));
    if k <= components || k > MANY {
        return None;
    }
    let mut gram = vec![0.0; k * k];
    for row in &motions.rows {
        for a in 0..k {
            for b in 0..k {
                gram[a + b * k] += row[a] * row[b];
            }
        }
    }
    // Motions of unit size on the face, and the value of a constraint for a motion.
    let unit = combinations(&gram, k);
    let seen = |row: &[f64], c: &[f64]| -> f64 { row.iter().zip(c).map(|(r, c)| r * c).sum() };
    let n = unit.len();
    let entry = |a: usize, b: usize| {
        let terms = held.iter().map(|f| seen(f, &unit[a]) * seen(f, &unit[b]));
        terms.sum::<f64>()
    };
    let eigen = faer::Mat::from_fn(n, n, entry)
        .self_adjoint_eigen(faer::Side::Lower)
        .ok()?;
    let weights = (0..n).map(|a| eigen.U()[(a, 0)]);
    let mut worst = vec![0.0; k];
    for (weight, motion) in weights.zip(&unit) {
        worst
            .iter_mut()
            .zip(motion)
            .for_each(|(w, m)| *w += weight * m);
    }
    let worst = Mixed(worst);
    let largest = |sizes: &mut dyn Iterator<Item = f64>| sizes.fold(0.0, f64::max);
    let most = largest(&mut held.iter().map(|f| worst.along(f).abs()));
    let moves = largest(&mut dofs.iter().map(|&i| worst.along(motions.row(i)).abs()));
    (most < WELL_SEEN * moves).then_some(worst)
}

/// The dofs of the node that moves most, of the increasing local dofs `dofs`: the last one of those that move alike.
/// `size` is the size of a dof's motion. The choice does not depend on the axes, so that copies of a subdomain in other
/// places get the same nodes.
pub(super) fn moves_most<'d>(
    torn: &Torn,
    part: &TornSubdomain,
    dofs: &'d [u32],
    size: impl Fn(u32) -> f64,
) -> Option<&'d [u32]> {
    let nodes: Vec<&[u32]> = dofs
        .chunk_by(|&i, &j| torn.node(part.dofs[i as usize]) == torn.node(part.dofs[j as usize]))
        .collect();
    let square = |node: &&[u32]| node.iter().map(|&i| size(i).powi(2)).sum::<f64>();
    let squares: Vec<f64> = nodes.iter().map(square).collect();
    let most = squares.iter().fold(0.0, |a: f64, b| a.max(*b));
    let last = squares.iter().rposition(|s| *s >= (1.0 - ALIKE) * most);
    last.map(|k| nodes[k])
}

/// Decisions that precede the choice of constraints.
pub struct ConstraintContext {
    pub bodies: Bodies,
    /// Whether the problem is three-dimensional.
    pub space: bool,
    /// Constraints that the user wants.
    pub primal: Primal,
}

/// An orthonormal basis of the detected motions.
#[derive(Default)]
pub(super) struct Span(Vec<Vec<f64>>);

impl Span {
    pub fn rank(&self) -> usize {
        self.0.len()
    }

    /// The rest of a row beside the detected motions.
    pub fn rest(&self, mut row: Vec<f64>) -> Vec<f64> {
        for _ in 0..2 {
            for q in &self.0 {
                let part: f64 = row.iter().zip(q).map(|(x, q)| x * q).sum();
                row.iter_mut().zip(q).for_each(|(x, q)| *x -= part * q);
            }
        }
        row
    }

    pub fn add(&mut self, row: Vec<f64>, least: f64) {
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

pub(super) fn norm(x: &[f64]) -> f64 {
    x.iter().map(|v| v * v).sum::<f64>().sqrt()
}

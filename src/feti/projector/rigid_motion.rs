//! Rigid motions of bodies as translations and rotations: what people call them by.

use mpi::topology::SimpleCommunicator;

use super::columns::KernelColumns;
use super::kernel_motion::KernelMotion;
use crate::substructures::{Problem, Subdomain};
use base::linalg::dense::Dense;
use base::linalg::semidefinite::Semidefinite;
use base::linalg::vec3::{cross, minus, norm};
use bytemuck::{Pod, Zeroable};
use parallel::exchange::gather_all;

/// A rigid motion of a body: the point `centre` moves by `translation`, all else turns about it by `rotation` (radians,
/// a vector along the axis; in the plane along z).
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct RigidMotion {
    /// The body.
    pub body: usize,
    /// 2 or 3.
    pub dim: usize,
    /// A point inside the body.
    pub centre: [f64; 3],
    /// How far the body reaches from there.
    pub radius: f64,
    /// The displacement of the centre.
    pub translation: [f64; 3],
    /// The rotation about it.
    pub rotation: [f64; 3],
}

/// The twist of a body in a motion, by the number of the motion.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct InMotion {
    motion: usize,
    twist: RigidMotion,
}

impl RigidMotion {
    /// The displacement that the motion has at a point, were it a point of the body.
    pub fn at(&self, point: [f64; 3]) -> [f64; 3] {
        let turned = cross(self.rotation, minus(point, self.centre));
        std::array::from_fn(|d| self.translation[d] + turned[d])
    }

    /// The largest displacement of the body, about.
    pub fn size(&self) -> f64 {
        norm(self.translation).max(norm(self.rotation) * self.radius)
    }
}

/// Motions by the twists of the bodies that take part, each by increasing body, on every rank. A body has none
/// where its kernel or the positions of its dofs are not known, and in scalar problems. `owned` are bodies with a
/// subdomain here and their kernels as combinations of candidates. Collective.
pub fn twists<'a>(
    comm: &SimpleCommunicator,
    problem: &Problem,
    columns: &KernelColumns,
    owned: impl Iterator<Item = (usize, &'a Dense)>,
    motions: &[KernelMotion],
) -> Vec<Vec<RigidMotion>> {
    let mut mine: Vec<InMotion> = Vec::new();
    for (body, combinations) in owned {
        let columns = columns.of(body);
        let sub = problem.local.iter().find(|sub| sub.body == body);
        let Some(frame) = sub.and_then(BodyFrame::new) else {
            continue;
        };
        for (m, motion) in motions.iter().enumerate() {
            let own = motion
                .0
                .iter()
                .filter(|e| columns.contains(&(e.0 as usize)));
            let mut of_candidates = vec![0.0; combinations.rows];
            for &(c, v) in own {
                let combination = combinations.col(c as usize - columns.start);
                let sums = of_candidates.iter_mut().zip(combination);
                sums.for_each(|(sum, x)| *sum += v * x);
            }
            if of_candidates
                .iter()
                .all(|v| v.abs() < 1e-8 * motion.largest())
            {
                continue;
            }
            if let Some(twist) = frame.twist(body, &of_candidates) {
                mine.push(InMotion { motion: m, twist });
            }
        }
    }
    let mut out = vec![Vec::new(); motions.len()];
    for InMotion { motion, twist } in gather_all(comm, &mine).concat() {
        out[motion].push(twist);
    }
    out.iter_mut().for_each(|of| of.sort_by_key(|t| t.body));
    out
}

/// A subdomain of a body, for reading motions off its dofs.
struct BodyFrame<'a> {
    sub: &'a Subdomain,
    dim: usize,
    centre: [f64; 3],
    radius: f64,
    /// The component of each dof.
    component: Vec<usize>,
}

impl<'a> BodyFrame<'a> {
    /// `None` where candidates for the kernel or positions are not known, or the candidates are not the translations
    /// along the axes and the rotations.
    fn new(sub: &'a Subdomain) -> Option<BodyFrame<'a>> {
        let kernel = sub.near_kernel.as_ref()?;
        let points = sub.coordinates.as_ref()?;
        let moves = |c: usize, i: usize| kernel[c][i] == 1.0;
        let (dim, component) = match kernel.len() {
            // Rings: the one motion is that along the axis. All dofs of a scalar field move with their constant.
            1 if (0..points.len()).any(|i| kernel[0][i] == 0.0) => (
                2,
                (0..points.len())
                    .map(|i| usize::from(moves(0, i)))
                    .collect(),
            ),
            3 | 6 => {
                let dim = kernel.len() / 3 + 1;
                let of = |i: usize| (0..dim).find(|&c| moves(c, i));
                let all: Option<Vec<usize>> = (0..points.len()).map(of).collect();
                (dim, all?)
            }
            _ => return None,
        };
        let n = points.len().max(1) as f64;
        let centre = std::array::from_fn(|d| points.iter().map(|p| p[d]).sum::<f64>() / n);
        let away = points.iter().map(|&p| norm(minus(p, centre)));
        Some(BodyFrame {
            sub,
            dim,
            centre,
            radius: away.fold(0.0, f64::max),
            component,
        })
    }

    /// The twist with this combination of candidates, by least squares over the dofs. `None` if they are too few.
    fn twist(&self, body: usize, of_candidates: &[f64]) -> Option<RigidMotion> {
        let kernel = self.sub.near_kernel.as_ref()?;
        let points = self.sub.coordinates.as_ref()?;
        let turns = if self.dim == 2 { 2..3 } else { 0..3 };
        let (n_turns, scale) = (
            turns.len(),
            if self.radius > 0.0 { self.radius } else { 1.0 },
        );
        let n = self.dim + n_turns;
        let (mut a, mut b) = (Dense::zeros(n, n), vec![0.0; n]);
        for (i, (&c, &p)) in self.component.iter().zip(points).enumerate() {
            let v: f64 = of_candidates
                .iter()
                .zip(kernel)
                .map(|(x, k)| x * k[i])
                .sum();
            let arm = minus(p, self.centre).map(|x| x / scale);
            let mut row = vec![0.0; n];
            row[c] = 1.0;
            for (k, axis) in turns.clone().enumerate() {
                let mut unit = [0.0; 3];
                unit[axis] = 1.0;
                row[self.dim + k] = cross(unit, arm)[c];
            }
            for (p, x) in row.iter().enumerate() {
                row.iter()
                    .enumerate()
                    .for_each(|(q, y)| a.set(p, q, a.get(p, q) + x * y));
                b[p] += x * v;
            }
        }
        Semidefinite::new(&a).solve(&mut b);
        let mut twist = RigidMotion {
            body,
            dim: self.dim,
            centre: self.centre,
            radius: self.radius,
            translation: [0.0; 3],
            rotation: [0.0; 3],
        };
        twist.translation[..self.dim].copy_from_slice(&b[..self.dim]);
        for (k, axis) in turns.enumerate() {
            twist.rotation[axis] = b[self.dim + k] / scale;
        }
        (twist.size() > 0.0).then_some(twist)
    }
}

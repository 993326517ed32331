//! Equilibrium of every body: loads, forces on interfaces and obstacles, and reactions. In elasticity it is by
//! components, and with moments.

use crate::linalg::vec3::{cross, minus, norm};
use crate::parallel::exchange::sum_all;
use crate::petsc::Session;
use crate::report::json::contact::{Amount, BodyBalance};
use crate::scene::{Body, Scene};
use crate::substructures::{BodyNode, SolvedRow};
use crate::{FetiFeti, Result};

/// The forces and moments on a body. Moments are about its centre.
#[derive(Clone, Copy, Default)]
struct Sums {
    load: [f64; 3],
    contact: [f64; 3],
    /// Σ |multiplier|.
    size: f64,
    moment: [f64; 3],
    /// Sizes of the moments of the forces on rows, and of the load.
    moment_size: [f64; 2],
}

const WORDS: usize = 12;

impl Sums {
    fn words(&self) -> [f64; WORDS] {
        let ([a, b, c], [d, e, f], [g, h, i]) = (self.load, self.contact, self.moment);
        let [j, k] = self.moment_size;
        [a, b, c, d, e, f, self.size, g, h, i, j, k]
    }

    fn from_words(w: &[f64]) -> Sums {
        let three = |k: usize| [w[k], w[k + 1], w[k + 2]];
        Sums {
            load: three(0),
            contact: three(3),
            size: w[6],
            moment: three(7),
            moment_size: [w[10], w[11]],
        }
    }
}

/// Loads, forces of contact and reactions of every body; `rows` are all rows on rank 0. Collective.
pub(super) fn bodies(
    session: &Session,
    scene: &Scene,
    solver: &FetiFeti,
    rows: &[SolvedRow],
    step: usize,
) -> Result<Vec<BodyBalance>> {
    let mut sums = vec![Sums::default(); scene.n_bodies()];
    for sub in &solver.problem().local {
        let body = &scene.bodies[sub.body];
        let (force, moment) = scene.wrench(sub.index, step, body.ball().0)?;
        let to = &mut sums[sub.body];
        for d in 0..3 {
            to.load[d] += force[d];
            to.moment[d] += moment[d];
        }
        to.moment_size[1] += norm(moment);
    }
    // Rank 0 has all rows; the lists of the other ranks are empty.
    for row in rows {
        let members = row.label.members.into_iter().flatten();
        for (sign, BodyNode { body: b, node }) in [-1.0, 1.0].into_iter().zip(members) {
            let body = &scene.bodies[b];
            let n = match body.components {
                1 => [row.normal().iter().sum(), 0.0, 0.0],
                _ => row.normal(),
            };
            let force = n.map(|n| sign * row.multiplier * n);
            let to = &mut sums[b];
            (0..3).for_each(|d| to.contact[d] += force[d]);
            to.size += norm(force);
            let at = body.spec.position(body.mesh().place(node));
            let moment = cross(minus(at, body.ball().0), force);
            (0..3).for_each(|d| to.moment[d] += moment[d]);
            to.moment_size[0] += norm(moment);
        }
    }
    let mut words: Vec<f64> = sums.iter().flat_map(Sums::words).collect();
    sum_all(session.comm(), &mut words);
    let floating = &solver.dual().stiffness.space.defect;
    let each = scene.bodies.iter().zip(words.chunks_exact(WORDS));
    let out = each.enumerate().map(|(b, (body, words))| {
        let sums = Sums::from_words(words);
        if scene.form.is_elastic() {
            elastic(body, &sums, floating[b] > 0)
        } else {
            scalar(body, &sums, floating[b] > 0)
        }
    });
    Ok(out.collect())
}

fn scalar(body: &Body, sums: &Sums, floats: bool) -> BodyBalance {
    let (load, contact) = (sums.load[0], sums.contact[0]);
    let rest = load + contact;
    let scale = load.abs().max(sums.size);
    BodyBalance {
        name: body.spec.name.clone(),
        floating: floats,
        load: load.into(),
        contact: contact.into(),
        reaction: (!floats).then_some((-rest).into()),
        imbalance: if floats && scale > 0.0 {
            rest.abs() / scale
        } else {
            0.0
        },
        moment_imbalance: None,
    }
}

/// In components that are prescribed somewhere, reactions balance the other forces. In the other components the forces
/// themselves must balance, and the moments must where nothing is prescribed at all.
fn elastic(body: &Body, sums: &Sums, floats: bool) -> BodyBalance {
    let c = body.components;
    let mut held = [false; 3];
    for &(dof, _) in &body.prescribed {
        held[dof % c] = true;
    }
    let rest = [0, 1, 2].map(|d| sums.load[d] + sums.contact[d]);
    let free = |d: usize| if held[d] { 0.0 } else { rest[d] };
    let relative = |rest: f64, scale: f64| if scale > 0.0 { rest / scale } else { 0.0 };
    let loose = body.prescribed.is_empty();
    let vector = |f: &dyn Fn(usize) -> f64| Amount((0..c).map(f).collect());
    let lever = sums.moment_size[0].max(sums.moment_size[1]);
    // Forces through the centre have no lever arm; their rounding must not count as a moment.
    let lever = lever.max(sums.size * body.ball().1 * 1e-3);
    BodyBalance {
        name: body.spec.name.clone(),
        floating: floats,
        load: vector(&|d| sums.load[d]),
        contact: vector(&|d| sums.contact[d]),
        reaction: (!loose).then(|| vector(&|d| if held[d] { -rest[d] } else { 0.0 })),
        imbalance: relative(norm([0, 1, 2].map(free)), norm(sums.load).max(sums.size)),
        moment_imbalance: loose.then(|| relative(norm(sums.moment), lever)),
    }
}

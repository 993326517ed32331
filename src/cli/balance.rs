//! Equilibrium of every body: loads, forces on interfaces and obstacles, and reactions. In elasticity it is by
//! components, and with moments.

use crate::linalg::sorted::distinct;
use crate::linalg::vec3::{cross, minus, norm};
use crate::parallel::exchange::exchange_words;
use crate::petsc::Session;
use crate::report::json::contact::{Amount, BodyBalance};
use crate::scene::{Body, Scene};
use crate::substructures::{BodyNode, SolvedRow};
use crate::{FetiFeti, Result};

/// The forces and moments on a body: its load, the forces of contact, their moments about its centre, and three sizes:
/// Σ |multiplier|, and those of the moments of the forces on rows and of the load.
type Sums = [[f64; 3]; 4];

/// Numbers in [`Sums`].
const SUMS: usize = 12;

/// Loads, forces of contact and reactions of every body on rank 0, which has all `rows`; none on the others.
/// Collective.
pub(super) fn bodies(
    session: &Session,
    scene: &Scene,
    solver: &FetiFeti,
    rows: &[SolvedRow],
    step: usize,
) -> Result<Vec<BodyBalance>> {
    let mut sums = vec![Sums::default(); scene.n_bodies()];
    let add = |to: &mut [f64; 3], v: [f64; 3]| (0..3).for_each(|d| to[d] += v[d]);
    for sub in &solver.problem().local {
        let body = &scene.bodies[sub.body];
        let (force, moment) = scene.wrench(sub.index, step, body.ball().0)?;
        let [load, _, moments, sizes] = &mut sums[sub.body];
        add(load, force);
        add(moments, moment);
        sizes[2] += norm(moment);
    }
    // Rank 0 has all rows; the lists of the other ranks are empty.
    for row in rows {
        for (BodyNode { body: b, node }, force) in row.forces() {
            let body = &scene.bodies[b];
            let force = match body.components {
                1 => [force.iter().sum(), 0.0, 0.0],
                _ => force,
            };
            let at = body.spec.position(node);
            let moment = cross(minus(at, body.ball().0), force);
            let [_, contact, moments, sizes] = &mut sums[b];
            add(contact, force);
            add(moments, moment);
            sizes[0] += norm(force);
            sizes[1] += norm(moment);
        }
    }
    // Rank 0 adds up what the others have of the bodies with a subdomain there.
    let mut outgoing = vec![Vec::new(); session.size()];
    let own = distinct(solver.problem().local.iter().map(|sub| sub.body));
    if session.rank() > 0 {
        for body in own {
            outgoing[0].push(body as u64);
            outgoing[0].extend(sums[body].as_flattened().iter().map(|v| v.to_bits()));
        }
    }
    for words in exchange_words(session.comm(), outgoing) {
        for words in words.chunks_exact(1 + SUMS) {
            let to = sums[words[0] as usize].as_flattened_mut().iter_mut();
            to.zip(&words[1..])
                .for_each(|(sum, w)| *sum += f64::from_bits(*w));
        }
    }
    if session.rank() > 0 {
        return Ok(Vec::new());
    }
    let columns = &solver.dual().natural.columns;
    let axial = scene.form.is_axial();
    let each = scene.bodies.iter().zip(&sums).enumerate();
    let balance = |(b, (body, sums)): (usize, (&Body, &Sums))| {
        let floats = !columns.of(b).is_empty();
        match scene.form.is_elastic() {
            true => elastic(body, sums, floats, axial),
            false => scalar(body, sums, floats),
        }
    };
    Ok(each.map(balance).collect())
}

fn scalar(body: &Body, sums: &Sums, floats: bool) -> BodyBalance {
    let [[load, ..], [contact, ..], _, [size, ..]] = *sums;
    let rest = load + contact;
    let scale = load.abs().max(size);
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
/// themselves must balance, and the moments must where nothing is prescribed at all. Rings bear radial forces by
/// themselves: those along the axis alone must balance.
fn elastic(body: &Body, sums: &Sums, floats: bool, axial: bool) -> BodyBalance {
    let [load, contact, moment, [size, of_rows, of_load]] = *sums;
    let c = body.components;
    let mut held = [false; 3];
    for &(dof, _) in &body.prescribed {
        held[dof % c] = true;
    }
    let rest = [0, 1, 2].map(|d| match axial && d == 0 {
        true => 0.0,
        false => load[d] + contact[d],
    });
    let free = |d: usize| if held[d] { 0.0 } else { rest[d] };
    let relative = |rest: f64, scale: f64| if scale > 0.0 { rest / scale } else { 0.0 };
    let loose = body.prescribed.is_empty();
    let vector = |f: &dyn Fn(usize) -> f64| Amount((0..c).map(f).collect());
    let lever = of_rows.max(of_load);
    // Forces through the centre have no lever arm; their rounding must not count as a moment.
    let lever = lever.max(size * body.ball().1 * 1e-3);
    BodyBalance {
        name: body.spec.name.clone(),
        floating: floats,
        load: vector(&|d| load[d]),
        contact: vector(&|d| contact[d]),
        reaction: (!loose).then(|| vector(&|d| if held[d] { -rest[d] } else { 0.0 })),
        imbalance: relative(norm([0, 1, 2].map(free)), norm(load).max(size)),
        moment_imbalance: (loose && !axial).then(|| relative(norm(moment), lever)),
    }
}

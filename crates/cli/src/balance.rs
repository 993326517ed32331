//! Equilibrium of every body: loads, springs, forces on interfaces and obstacles, and reactions. In elasticity it is by
//! components, and with moments.
//!
//! Reactions are what K u leaves at given values, as the forces that a deck prints (RF): the elements say them, not
//! what the other forces lack. So the balance of a held body tests the solution as that of a loose one does. If it
//! passes, what the iteration has left is taken from the reactions.

use super::row_forces::RowForces;
use base::linalg::sorted::distinct;
use base::linalg::vec3::{minus, norm};
use base::Result;
use bytemuck::{Pod, Zeroable};
use fetifeti::problem::BodyNode;
use fetifeti::{FetiFeti, Solution, Subdomain};
use parallel::exchange::{any, exchange, highest, total};
use petsc::Session;
use report::json::contact::{Amount, BodyBalance};
use scene::{Body, Forces, Scene, Wrench};

/// The forces on a body.
#[repr(C)]
#[derive(Clone, Copy, Default, Pod, Zeroable)]
struct ForceSums {
    load: Wrench,
    springs: Wrench,
    contact: Wrench,
    reaction: Wrench,
    /// The sizes of the terms of K u at given values.
    terms: f64,
    /// The energies of the body's motions as a whole ([`Forces::resistance`](scene::Forces::resistance)).
    resistance: [f64; 6],
}

/// The forces on a body that one rank has.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct BodySums {
    body: usize,
    sums: ForceSums,
}

impl ForceSums {
    fn all(&self) -> [&Wrench; 4] {
        [&self.load, &self.springs, &self.contact, &self.reaction]
    }

    fn add(&mut self, more: &ForceSums) {
        self.load.merge(&more.load);
        self.springs.merge(&more.springs);
        self.contact.merge(&more.contact);
        self.reaction.merge(&more.reaction);
        self.terms += more.terms;
        let each = self.resistance.iter_mut().zip(more.resistance);
        each.for_each(|(to, r)| *to += r);
    }
}

/// The balance of a body, and whether it is one.
pub(super) struct Balanced {
    /// For the report.
    pub record: BodyBalance,
    /// The larger imbalance, of forces or moments, over what the tolerance permits.
    beyond: f64,
}

/// Loads, springs, forces of contact and reactions of every body on rank 0; none on the others. `strained` is the
/// largest ‖u‖_K of the load steps so far, this one included afterwards. Collective.
pub(super) fn bodies(
    session: &Session,
    scene: &Scene,
    solver: &FetiFeti,
    solution: &Solution,
    (step, strained): (usize, &mut f64),
) -> Result<Vec<Balanced>> {
    let mut sums = vec![ForceSums::default(); scene.n_bodies()];
    let locals = solver.problem().local.iter().zip(&solution.u);
    let of_subdomains = locals.map(|(sub, u)| Ok((sub.body, of_subdomain(scene, sub, u, step)?)));
    for (body, forces) in session.agree(of_subdomains.collect::<Result<Vec<_>>>())? {
        let to = &mut sums[body];
        to.load.merge(&forces.load);
        to.springs.merge(&forces.springs);
        to.reaction.merge(&forces.held);
        to.terms += forces.terms;
        let all = to.resistance.iter_mut().zip(forces.resistance);
        all.for_each(|(to, r)| *to += r);
    }
    let mut touched = Vec::new();
    RowForces::new(session, scene)?.each(solution, |_, row, at, force| {
        let BodyNode { body: b, node } = at;
        let body = &scene.bodies[b];
        let to = &mut sums[b];
        touched.push(b);
        let arm = minus(body.spec.position(node), body.ball().0);
        if row.support {
            to.reaction.add(arm, force)
        } else {
            to.contact.add(arm, force)
        }
        // Where u is given the elements bear this force, too.
        let c = body.components;
        for d in (0..c).filter(|d| body.prescribed_at(c * node + d).is_some()) {
            let mut part = [0.0; 3];
            part[d] = -force[d];
            to.reaction.add(arm, part);
        }
    });
    // Rank 0 adds up what the others have.
    let mut outgoing = vec![Vec::new(); session.size()];
    let own = solver.problem().local.iter().map(|sub| sub.body);
    if session.rank() > 0 {
        for body in distinct(own.chain(touched)) {
            let sums = sums[body];
            outgoing[0].push(BodySums { body, sums });
        }
    }
    for more in exchange(session.comm(), outgoing) {
        sums[more.body].add(&more.sums);
    }
    let mut error = error(session, solver, solution, strained)?;
    let sizes = sums.iter().flat_map(ForceSums::all).map(|w| w.size);
    error.largest = sizes.fold(0.0, f64::max);
    if session.rank() > 0 {
        return Ok(Vec::new());
    }
    let supported = supported(scene);
    let columns = &solver.dual().natural.columns;
    let each = scene.bodies.iter().zip(&sums).enumerate();
    let of_body = |(b, (body, sums)): (usize, (&Body, &ForceSums))| {
        let floats = !columns.of(solver.group(b)).is_empty();
        let held = !body.prescribed.is_empty() || supported.binary_search(&b).is_ok();
        let free = error.free.binary_search(&b).is_ok();
        body_balance(scene, body, sums, (floats, held, free), &error)
    };
    Ok(each.map(of_body).collect())
}

/// The forces on a subdomain. Without given values and springs they are its loads, which the method has.
fn of_subdomain(scene: &Scene, sub: &Subdomain, u: &[f64], step: usize) -> Result<Forces> {
    let body = &scene.bodies[sub.body];
    let (c, centre) = (body.components, body.ball().0);
    let inside = scene.body_of(sub.index).1;
    let all = c * body.mesh().subdomain_nodes(inside).len();
    let points = sub.coordinates.as_ref();
    let Some(points) = points.filter(|_| body.spec.springs.is_empty() && all == sub.f.len()) else {
        return scene.forces(sub.index, step, u, centre);
    };
    let mut out = Forces::default();
    for (force, at) in sub.f.chunks_exact(c).zip(points.iter().step_by(c)) {
        let mut load = [0.0; 3];
        load[..c].copy_from_slice(force);
        out.load.add(minus(*at, centre), load);
    }
    Ok(out)
}

/// The bodies with a given displacement along an oblique axis, increasing.
fn supported(scene: &Scene) -> Vec<usize> {
    let equations = scene.rows.iter().filter_map(|row| row.combination.as_ref());
    let equations = equations.filter(|e| e.support);
    let dofs = equations.flat_map(|e| e.terms.iter().chain(&e.held));
    let body = |of_body: u64| scene.bodies.partition_point(|b| b.first_dof <= of_body) - 1;
    distinct(dofs.map(|t| body(t.0)))
}

/// Terms that cancel leave this part of their sizes as rounding.
const ROUNDING: f64 = 1e-12;

/// The error that the iteration leaves.
///
/// For a motion v of a body as a whole that is zero at given values, the imbalance along it is vᵀ (K u − f + Bᵀ λ):
/// with the errors of u and λ at most a few times ‖u − u*‖_K ‖v‖_K (docs/theory.md, section 8). A stiff body that bears
/// little has a large ‖v‖_K, and its reaction few digits; bodies that nothing holds have none but rounding, since the
/// iteration keeps Gᵀ λ = e.
struct IterationError {
    /// The imbalance that is permitted, relative to the forces.
    relative: f64,
    /// The largest size of the forces of a kind on a body. A body that bears nothing has rounding of it.
    largest: f64,
    /// The estimate of ‖u − u*‖_K, times [`SAFETY`].
    energy: f64,
    /// The angle to which directions of rows are known from the digits of the input: multipliers may leave so much of
    /// their moments on a body whose turn nothing else resists.
    input: f64,
    /// Bodies that take part in motions which count as free, increasing.
    free: Vec<usize>,
}

/// A motion of several bodies counts as free where rows resist it by less than this part of what they could, the root
/// of the smallest pivot: multipliers may leave so much along it.
const FREE: f64 = 1e-5;

/// The estimate of the error is one, and u and λ have errors.
const SAFETY: f64 = 10.0;

/// An imbalance that does not count as one, relative to the forces, whatever the tolerance is.
const LEAST: f64 = 1e-6;

/// Where loads return to zero, what is below this part of earlier strains is rounding of these
/// (the certificate has the same).
const SMALL: f64 = 1e-8;

/// The error of a solution. Collective.
fn error(
    session: &Session,
    solver: &FetiFeti,
    solution: &Solution,
    strained: &mut f64,
) -> Result<IterationError> {
    let mut squares = 0.0;
    for (sub, u) in solver.problem().local.iter().zip(&solution.u) {
        let mut force = vec![0.0; u.len()];
        sub.k.mul(u, &mut force);
        squares += force.iter().zip(u).map(|(f, u)| f * u).sum::<f64>();
    }
    let size = total(session.comm(), squares).max(0.0).sqrt();
    *strained = strained.max(size);
    let rtol = solver.ksp().tolerances()?.0;
    let known = solution.kkt.error.unwrap_or(rtol);
    let rows = solver.problem().rows.iter();
    let rounding = rows.map(|row| row.rounding).fold(0.0, f64::max);
    Ok(IterationError {
        relative: rtol.clamp(LEAST, 0.1),
        largest: 0.0,
        input: highest(session.comm(), rounding),
        free: distinct(solver.free_motions().into_iter().flat_map(|m| m.bodies)),
        energy: (SAFETY * known.max(rtol) * size).max(SMALL * *strained),
    })
}

/// The balance of a body that floats in the method, or that something holds.
///
/// In components along which the body cannot move as a whole nothing balances: rings bear radial forces by themselves,
/// and a scalar has one component.
fn body_balance(
    scene: &Scene,
    body: &Body,
    sums: &ForceSums,
    (floats, held, free): (bool, bool, bool),
    error: &IterationError,
) -> Balanced {
    let input = if free {
        error.input.max(FREE)
    } else {
        error.input
    };
    let c = body.components;
    let axial = scene.form.is_axial();
    let sum = |of: fn(&Wrench) -> [f64; 3]| {
        let add = |s: [f64; 3], w: &Wrench| [0, 1, 2].map(|d| s[d] + of(w)[d]);
        sums.all().into_iter().fold([0.0; 3], add)
    };
    let largest = |of: fn(&Wrench) -> f64| sums.all().into_iter().map(of).fold(0.0, f64::max);
    let mut rest = sum(|w| w.force);
    if axial {
        rest[0] = 0.0;
    }
    let nothing = ROUNDING * error.largest;
    let size = largest(|w| w.size).max(nothing);
    // Forces through the centre have no lever arm; their rounding must not count as a moment.
    let radius = body.ball().1;
    let lever = largest(|w| w.lever).max(1e-3 * size * radius);
    let turns = (scene.form.is_elastic() && !axial).then(|| norm(sum(|w| w.moment)));
    let relative = |rest: f64, scale: f64| if scale > 0.0 { rest / scale } else { 0.0 };
    let beyond = |rest: f64, (scale, largest): (f64, f64), rounding: f64, resistance: &[f64]| {
        let along: f64 = resistance.iter().sum();
        let iterated = error.energy * along.max(0.0).sqrt();
        relative(
            rest,
            error.relative * scale + input * largest + rounding + iterated,
        )
    };
    let (straight, turned) = sums.resistance.split_at(c);
    // Rings move along their axis.
    let straight = &straight[usize::from(axial)..];
    let moments = turns.map(|rest| relative(rest, lever));
    let vector = |w: &Wrench| Amount(w.force[..c].to_vec());
    let moment = |w: &Wrench| match scene.dim() {
        2 => w.moment[2].into(),
        _ => Amount(w.moment.to_vec()),
    };
    let rounding = ROUNDING * sums.terms + nothing;
    let of_forces = beyond(norm(rest), (size, size), rounding, straight);
    let of_moments = turns.map_or(0.0, |rest| {
        beyond(rest, (lever, size * radius), rounding * radius, turned)
    });
    let beyond = if (of_forces + of_moments).is_nan() {
        f64::INFINITY
    } else {
        of_forces.max(of_moments)
    };
    // What the iteration leaves is an error of u, and so of the reactions: multipliers balance the loads.
    let mut reaction = sums.reaction;
    if beyond <= 1.0 {
        let given = |d: usize| body.prescribed.iter().any(|&(dof, _)| dof % c == d);
        for d in (0..c).filter(|&d| given(d)) {
            reaction.force[d] -= rest[d];
        }
        let left = sum(|w| w.moment);
        (0..3).for_each(|d| reaction.moment[d] -= left[d]);
    }
    Balanced {
        record: BodyBalance {
            name: body.spec.name.clone(),
            floating: floats,
            load: vector(&sums.load),
            springs: (!body.spec.springs.is_empty()).then(|| vector(&sums.springs)),
            contact: vector(&sums.contact),
            reaction: held.then(|| vector(&reaction)),
            imbalance: relative(norm(rest), size),
            moment_imbalance: moments.filter(|_| !held),
            centre: turns.map(|_| body.ball().0[..scene.dim()].to_vec()),
            reaction_moment: turns.filter(|_| held).map(|_| moment(&reaction)),
            held_moment_imbalance: moments.filter(|_| held),
        },
        beyond,
    }
}

/// The body that is farthest from equilibrium, if one is beyond the tolerance: a sentence on rank 0, and whether there
/// is one. Collective.
pub(super) fn out_of_balance(session: &Session, all: &[Balanced]) -> (bool, Option<String>) {
    let worst = all.iter().max_by(|a, b| a.beyond.total_cmp(&b.beyond));
    let worst = worst.filter(|b| b.beyond > 1.0).map(|b| &b.record);
    let sentence = worst.map(|b| {
        let moments = b.moment_imbalance.or(b.held_moment_imbalance);
        format!(
            "body `{}` is not in equilibrium: what its loads, springs, contacts and reactions leave is {:.1e} of the \
             forces{}",
            b.name,
            b.imbalance,
            moments.map_or(String::new(), |m| format!(" and {m:.1e} of their moments"))
        )
    });
    (any(session.comm(), sentence.is_some()), sentence)
}

#[cfg(test)]
#[path = "../tests/balance.rs"]
mod tests;

//! Doubts about an answer, and parts of it that are arbitrary: motions that nothing holds, displacements beyond the
//! model.

use super::course::Course;
use base::linalg::vec3::{minus, norm};
use fetifeti::solution::FreeMotion;
use parallel::exchange::highest;
use petsc::Session;
use report::json::FreeMotion as Recorded;
use scene::sliding::Sliding;
use scene::Scene;

/// Motions that are told one by one.
const TOLD: usize = 5;

/// Bodies that are named one by one.
const NAMED: usize = 4;

/// Displacements of more times the size of the model are beyond what its author can mean.
const FAR: f64 = 1.0;

/// Sliding by more than this number of the side's faces is beyond what the author of a model can mean.
const FACES: f64 = 10.0;

/// A turn of a face by more than this number of degrees is beyond what the author of a model can mean.
const DEGREES: f64 = 45.0;

/// Motions for a record.
pub(super) fn recorded(scene: &Scene, free: &[FreeMotion]) -> Vec<Recorded> {
    let name = |&b: &usize| scene.bodies[b].spec.name.clone();
    let record = |motion: &FreeMotion| Recorded {
        bodies: motion.bodies.iter().map(name).collect(),
        motion: motion.words.clone(),
    };
    free.iter().map(record).collect()
}

/// Sentences on motions that nothing holds, each continued by `so`.
pub(super) fn free(motions: &[Recorded], so: &str) -> Vec<String> {
    let told = motions.iter().take(TOLD);
    let mut out: Vec<String> = told.map(|m| sentence(m, so)).collect();
    if motions.len() > TOLD {
        out.push(format!("and {} more such motions", motions.len() - TOLD));
    }
    out
}

fn sentence(motion: &Recorded, so: &str) -> String {
    let quoted: Vec<String> = motion
        .bodies
        .iter()
        .take(NAMED)
        .map(|name| format!("\"{name}\""))
        .collect();
    let more = match motion.bodies.len().saturating_sub(NAMED) {
        0 => String::new(),
        n => format!(" and {n} more"),
    };
    let (word, they) = match motion.bodies.len() {
        1 => ("body", "it"),
        _ => ("bodies", "they"),
    };
    let who = quoted.join(", ") + &more;
    format!(
        "nothing holds {word} {who} where {they} {}: {so}",
        motion.motion
    )
}

/// Warnings about a solution whose displacements, sliding or turns are far beyond the model, with likely reasons. The
/// same on every rank. Collective.
pub(super) fn beyond(session: &Session, scene: &Scene, course: &Course) -> Vec<String> {
    if !scene.form.is_elastic() {
        return Vec::new();
    }
    let all = course.solution.u.iter().flatten();
    let moved = highest(session.comm(), all.fold(0.0, |m: f64, u| m.max(u.abs())));
    let bounds = scene.bodies.iter().map(|body| body.bounds);
    let extreme = |side: usize, of: fn(f64, f64) -> f64| -> [f64; 3] {
        let corners = bounds.clone().map(|b| b[side]);
        let all = corners.reduce(|a, b| [0, 1, 2].map(|d| of(a[d], b[d])));
        all.unwrap_or_default()
    };
    let size = norm(minus(extreme(1, f64::max), extreme(0, f64::min)));
    let slides = course.slides.iter().flat_map(|all| all.values().copied());
    let slid = slides.fold(Sliding::default(), Sliding::max);
    let mut out = Vec::new();
    // What is not a number has reports of its own.
    if moved.is_finite() && moved > FAR * size {
        out.push(format!(
            "the largest displacement is {moved:.3e}, {:.3e} times the size of the model, {size:.4}: \
             look at the units of loads, moduli and lengths, and for a body that hardly anything holds",
            moved / size
        ));
    } else if slid.over_face > FACES || slid.turned > DEGREES {
        out.push(format!(
            "sides that touch slide by {:.3e} of a face and faces turn by {:.3e} degrees, far beyond what holds for \
             small displacements: look for a body that hardly anything holds, and at the units of loads and moduli",
            slid.over_face, slid.turned
        ));
    }
    out
}

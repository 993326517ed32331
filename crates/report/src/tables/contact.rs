//! The output of `solve` about contact: outer steps, certificate, forces per interface, equilibrium per body.

use super::table::{fixed, scientific, value, Table};
use crate::json::contact::{
    BodyBalance, ContactReport, InterfaceForce, LoadStep, OuterStep, SLIDING, TURN,
};
use crate::json::Kkt;

/// Number of interfaces that are listed.
const INTERFACES: usize = 12;
/// Number of bodies that are listed.
const BODIES: usize = 8;
/// Number of outer steps that are listed: the first few and the last ones.
const STEPS: usize = 24;

/// Everything about contact, after the lines of [`super::summary::solve`].
pub fn contact(r: &ContactReport) -> String {
    let mut text = format!(
        "\ncontact by {}: {} of {} candidates touch; {} for {} in all outer steps\n",
        r.method,
        r.active,
        r.candidates,
        plural(r.factorisations, "factorisation"),
        plural(r.distinct_subdomains, "distinct subdomain")
    );
    for part in [
        outer(r),
        load_steps(r),
        forces(r),
        sliding(r),
        balance_table(r),
    ] {
        if !part.is_empty() {
            text += &format!("\n{part}");
        }
    }
    text
}

/// The certificate: residuals of the four conditions of Karush, Kuhn and Tucker in one line.
pub fn certificate(kkt: &Kkt) -> String {
    let mut text = format!(
        "stationarity {}, feasibility {}",
        scientific(Some(kkt.stationarity)),
        scientific(Some(kkt.feasibility))
    );
    if let Some(least) = kkt.min_multiplier {
        // Only negative multipliers violate the sign condition.
        let wrong = if least.is_nan() {
            least
        } else {
            (-least).max(0.0)
        };
        text += &format!(
            ", complementarity {}, sign {} (smallest multiplier {})",
            scientific(Some(kkt.complementarity)),
            scientific(Some(wrong)),
            scientific(Some(least))
        );
    }
    text
}

fn plural(n: usize, what: &str) -> String {
    if n == 1 {
        format!("1 {what}")
    } else {
        format!("{n} {what}s")
    }
}

fn outer(r: &ContactReport) -> String {
    let steps = &r.steps;
    if steps.is_empty() {
        return String::new();
    }
    // The start and the end of a long run are enough here; the JSON record has all steps.
    let hidden = steps.len().saturating_sub(STEPS);
    let head = if hidden > 0 { STEPS / 3 } else { steps.len() };
    let shown = |(k, _): &(usize, &OuterStep)| *k < head || *k >= head + hidden;
    let mut text = Table::of(steps.iter().enumerate().filter(shown))
        .when(steps.iter().any(|s| s.load_step > 0), |t| {
            t.numbers("load", |(_, s)| s.load_step)
        })
        .numbers("step", |(_, s)| s.step)
        .numbers("active", |(_, s)| s.active)
        .numbers("entered", |(_, s)| s.entered)
        .numbers("left", |(_, s)| s.left)
        .numbers("it", |(_, s)| s.iterations)
        .numbers("κ est.", |(_, s)| fixed(s.estimate.map(|e| e.kappa), 3))
        .numbers("residual", |(_, s)| scientific(Some(s.residual)))
        .numbers("tolerance", |(_, s)| scientific(Some(s.tolerance)))
        .numbers("seconds", |(_, s)| fixed(Some(s.seconds), 3))
        // If all steps have the same method, the heading names it.
        .when(steps.iter().any(|s| s.method != steps[0].method), |t| {
            t.words("method", |(_, s)| &s.method)
        })
        .rules(|(k, a), (l, b)| a.load_step != b.load_step || k + 1 < *l)
        .table()
        .to_string();
    if hidden > 0 {
        text += &format!(
            "steps {} to {} of {} are not shown\n",
            head + 1,
            head + hidden,
            steps.len()
        );
    }
    text
}

fn load_steps(r: &ContactReport) -> String {
    if r.load_steps.is_empty() {
        return String::new();
    }
    let hidden = r.load_steps.len().saturating_sub(STEPS);
    let table = Table::of(&r.load_steps[hidden..])
        .numbers("t", |s| value(s.t))
        .numbers("outer", |s| s.outer_iterations)
        .numbers("it", |s| s.iterations)
        .numbers("active", |s| s.active)
        .numbers("contact force", |s| value(s.contact_force))
        .when(
            r.load_steps
                .iter()
                .any(|s| s.slid.sliding_over_face.is_some()),
            |t| t.numbers("sliding/face", |s| fixed(s.slid.sliding_over_face, 3)),
        )
        .numbers("energy", |s| value(s.energy))
        .when(r.updated, |t| {
            t.numbers("set-up", |s| fixed(s.setup_seconds, 3))
                .numbers("factored", |s| {
                    s.factored.map_or("–".into(), |n| n.to_string())
                })
        })
        .table();
    let more = if hidden > 0 {
        format!("and {} before\n", plural(hidden, "load step"))
    } else {
        String::new()
    };
    format!("{table}{more}")
}

fn forces(r: &ContactReport) -> String {
    if r.interfaces.is_empty() {
        return String::new();
    }
    let mut order: Vec<&InterfaceForce> = r.interfaces.iter().collect();
    // NaN comes first: errors must be visible.
    let size = |f: &InterfaceForce| {
        if f.force.is_nan() {
            f64::INFINITY
        } else {
            f.force.abs()
        }
    };
    order.sort_by(|a, b| size(b).total_cmp(&size(a)));
    // Pressures replace multipliers where they are known.
    let pressures = order.iter().any(|f| f.max_pressure.is_some());
    let directed = order.iter().any(|f| f.resultant.is_some());
    let known = |x: Option<f64>| x.map_or("–".into(), value);
    let resultant = |f: &InterfaceForce| f.resultant.as_deref().map_or("–".into(), vector);
    let table = Table::of(order.iter().take(INTERFACES))
        .words("interface", |f| &f.name)
        .words("kind", |f| f.kind.name())
        .numbers("rows", |f| f.candidates)
        .numbers("active", |f| f.active)
        .numbers("force", |f| value(f.force))
        .when(pressures, |t| {
            t.when(directed, |t| t.numbers("resultant", |f| resultant(f)))
                .numbers("area", |f| known(f.area))
                .numbers("largest pressure", |f| known(f.max_pressure))
        })
        .when(!pressures, |t| {
            t.numbers("least mult.", |f| value(f.min_multiplier))
                .numbers("largest mult.", |f| value(f.max_multiplier))
        })
        .numbers("least gap", |f| value(f.smallest_gap))
        .numbers("largest gap", |f| value(f.largest_gap))
        .table();
    let rest = &order[order.len().min(INTERFACES)..];
    let more = match rest {
        [] => String::new(),
        [largest, ..] => format!(
            "… and {} more with at most {} each, {} of them open\n",
            rest.len(),
            value(largest.force.abs()),
            rest.iter().filter(|f| f.active == 0).count()
        ),
    };
    format!("{table}{more}")
}

/// How far sides slide along each other, and a sentence where that is not small.
fn sliding(r: &ContactReport) -> String {
    let most = |of: fn(&InterfaceForce) -> Option<f64>| {
        let known = r.interfaces.iter().filter_map(|f| Some((of(f)?, f)));
        known.max_by(|a, b| a.0.total_cmp(&b.0))
    };
    let over = most(|f| f.slid.sliding_over_face);
    let (Some((over, at)), Some((turn, turned))) = (over, most(|f| f.slid.largest_turn)) else {
        return String::new();
    };
    // Contact may have been farther in an earlier load step.
    let of_steps = |of: fn(&LoadStep) -> Option<f64>| {
        let steps = r.load_steps.iter().filter_map(of);
        steps.fold(0.0, f64::max)
    };
    let (all, all_turn) = (
        of_steps(|s| s.slid.sliding_over_face).max(over),
        of_steps(|s| s.slid.largest_turn).max(turn),
    );
    let mut text = format!(
        "largest sliding {} of the size of a face ({}), largest turn of a face {} degrees ({})",
        value(over),
        at.name,
        value(turn),
        turned.name
    );
    if all > over || all_turn > turn {
        text += &format!(
            "; over all load steps {} and {} degrees",
            value(all),
            value(all_turn)
        );
    }
    text += "\n";
    let mut far = Vec::new();
    if all > SLIDING {
        far.push(format!("sliding of more than {SLIDING} of a face"));
    }
    if all_turn > TURN {
        far.push(format!("turns of more than {TURN} degrees"));
    }
    if !far.is_empty() {
        let what = far.join(" and ");
        // A deck has no such key, and neither has a contact on a part of a common face.
        let then = if r.renewable {
            ". `[steps] update = true` renews them at each load step"
        } else {
            ", and the answer holds for these"
        };
        text += &if r.updated {
            format!(
                "Between two load steps this is not small ({what}): normals, pairing and gaps are those at the \
                 start of a load step. More load steps make it smaller.\n"
            )
        } else {
            format!(
                "This is not small ({what}): normals, pairing and gaps are those of the undeformed bodies{then}.\n"
            )
        };
    }
    text
}

/// A number, or components in brackets; a component that is rounding compared with the others is printed as 0.
fn vector(components: &[f64]) -> String {
    if let [x] = components {
        return value(*x);
    }
    let size = components.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
    let each: Vec<String> = components
        .iter()
        .map(|&x| value(if x.abs() < 1e-9 * size { 0.0 } else { x }))
        .collect();
    format!("({})", each.join(", "))
}

fn balance_table(r: &ContactReport) -> String {
    if r.bodies.is_empty() {
        return String::new();
    }
    let size = |x: f64| if x.is_nan() { f64::INFINITY } else { x.abs() };
    let mut order: Vec<_> = r.bodies.iter().collect();
    let of_moments = |b: &BodyBalance| b.moment_imbalance.or(b.held_moment_imbalance);
    let worst = |b: &BodyBalance| size(b.imbalance).max(of_moments(b).map_or(0.0, size));
    order.sort_by(|a, b| worst(b).total_cmp(&worst(a)));
    let moments = order.iter().any(|b| of_moments(b).is_some());
    let springs = order.iter().any(|b| b.springs.is_some());
    let shown = &order[..order.len().min(BODIES)];
    let reaction = |b: &BodyBalance| match &b.reaction {
        Some(reaction) => vector(&reaction.0),
        None if b.floating => "floating".to_string(),
        None => "–".to_string(),
    };
    let table = Table::of(shown)
        .words("body", |b| &b.name)
        .numbers("load", |b| vector(&b.load.0))
        .when(springs, |t| {
            let of = |b: &BodyBalance| b.springs.as_ref().map_or("–".into(), |f| vector(&f.0));
            t.numbers("springs", move |b| of(b))
        })
        .numbers("contact", |b| vector(&b.contact.0))
        .numbers("reaction", |b| reaction(b))
        .numbers("imbalance", |b| scientific(Some(b.imbalance)))
        .when(moments, |t| {
            t.numbers("of moments", |b| scientific(of_moments(b)))
        })
        .table();
    let more = match order.len() - shown.len() {
        0 => String::new(),
        n => format!("… and {n} more, none of them with a larger imbalance\n"),
    };
    format!("{table}{more}")
}

#[cfg(test)]
#[path = "../../tests/tables/contact.rs"]
mod tests;

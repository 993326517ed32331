//! The output of `solve` about contact: outer steps, certificate, forces per interface, equilibrium per body.

use super::table::{fixed, scientific, value, Align, Table};
use crate::report::json::contact::{BodyBalance, ContactReport, InterfaceForce, OuterStep};
use crate::report::json::Kkt;

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
    for part in [outer(r), load_steps(r), forces(r), balance(r)] {
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
    let loads = steps.iter().any(|s| s.load_step > 0);
    // If all steps have the same method, the heading names it.
    let methods = steps.iter().any(|s| s.method != steps[0].method);
    let names = "step,active,entered,left,it,κ est.,residual,tolerance,seconds";
    let mut header: Vec<&str> = names.split(',').collect();
    if loads {
        header.insert(0, "load");
    }
    if methods {
        header.push("method");
    }
    let mut table = Table::new(header.clone());
    if methods {
        table = table.align(header.len() - 1, Align::Left);
    }
    let row = |s: &OuterStep| {
        let mut cells = vec![
            s.step.to_string(),
            s.active.to_string(),
            s.entered.to_string(),
            s.left.to_string(),
            s.iterations.to_string(),
            fixed(s.estimate.map(|e| e.kappa), 3),
            scientific(Some(s.residual)),
            scientific(Some(s.tolerance)),
            fixed(Some(s.seconds), 3),
        ];
        if loads {
            cells.insert(0, s.load_step.to_string());
        }
        if methods {
            cells.push(s.method.clone());
        }
        cells
    };
    // The start and the end of a long run are enough here; the JSON record has all steps.
    let hidden = steps.len().saturating_sub(STEPS);
    let head = if hidden > 0 { STEPS / 3 } else { steps.len() };
    let mut before: Option<usize> = None;
    for (k, s) in steps.iter().enumerate() {
        if k >= head && k < head + hidden {
            continue;
        }
        if before.is_some_and(|b| b != s.load_step) || (hidden > 0 && k == head + hidden) {
            table.rule();
        }
        before = Some(s.load_step);
        table.row(row(s));
    }
    let mut text = table.to_string();
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
    let mut table = Table::new(["t", "outer", "it", "active", "contact force", "energy"]);
    let hidden = r.load_steps.len().saturating_sub(STEPS);
    for s in &r.load_steps[hidden..] {
        table.row([
            value(s.t),
            s.outer_iterations.to_string(),
            s.iterations.to_string(),
            s.active.to_string(),
            value(s.contact_force),
            value(s.energy),
        ]);
    }
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
    let names = if pressures {
        "interface,kind,rows,active,force,resultant,area,largest pressure,least gap,largest gap"
    } else {
        "interface,kind,rows,active,force,least mult.,largest mult.,least gap,largest gap"
    };
    let directed = order.iter().any(|f| f.resultant.is_some());
    let shown = |name: &&str| directed || *name != "resultant";
    let mut table = Table::new(names.split(',').filter(shown))
        .align(0, Align::Left)
        .align(1, Align::Left);
    for f in order.iter().take(INTERFACES) {
        let mut cells = vec![
            f.name.clone(),
            f.kind.name().to_string(),
            f.candidates.to_string(),
            f.active.to_string(),
            value(f.force),
        ];
        if pressures {
            if directed {
                cells.push(f.resultant.as_deref().map_or("–".into(), vector));
            }
            cells.extend([f.area, f.max_pressure].map(|x| x.map_or("–".into(), value)));
        } else {
            cells.extend([f.min_multiplier, f.max_multiplier].map(value));
        }
        cells.extend([f.smallest_gap, f.largest_gap].map(value));
        table.row(cells);
    }
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

fn balance(r: &ContactReport) -> String {
    if r.bodies.is_empty() {
        return String::new();
    }
    let size = |x: f64| if x.is_nan() { f64::INFINITY } else { x.abs() };
    let mut order: Vec<_> = r.bodies.iter().collect();
    let worst = |b: &BodyBalance| size(b.imbalance).max(b.moment_imbalance.map_or(0.0, size));
    order.sort_by(|a, b| worst(b).total_cmp(&worst(a)));
    let moments = order.iter().any(|b| b.moment_imbalance.is_some());
    let shown = &order[..order.len().min(BODIES)];
    let mut header = vec!["body", "load", "contact", "reaction", "imbalance"];
    if moments {
        header.push("of moments");
    }
    let mut table = Table::new(header).align(0, Align::Left);
    for b in shown {
        let mut cells = vec![
            b.name.clone(),
            vector(&b.load.0),
            vector(&b.contact.0),
            match &b.reaction {
                Some(reaction) => vector(&reaction.0),
                None if b.floating => "floating".to_string(),
                None => "–".to_string(),
            },
            scientific(Some(b.imbalance)),
        ];
        if moments {
            cells.push(
                b.moment_imbalance
                    .map_or("–".into(), |m| scientific(Some(m))),
            );
        }
        table.row(cells);
    }
    let more = match order.len() - shown.len() {
        0 => String::new(),
        n => format!("… and {n} more, none of them with a larger imbalance\n"),
    };
    format!("{table}{more}")
}

#[cfg(test)]
#[path = "../../../tests/inside/report/tables/contact.rs"]
mod tests;

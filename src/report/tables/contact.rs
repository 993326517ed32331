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
mod tests {
    use super::*;
    use crate::report::json::contact::{InterfaceKind, LoadStep};
    use crate::report::json::Spectrum;

    /// A run with `steps` outer steps and `n` interfaces of forces 1, 2, …, n.
    fn sample(steps: usize, n: usize) -> ContactReport {
        ContactReport {
            method: "active_set".into(),
            candidates: 258,
            active: 130,
            factorisations: 1,
            distinct_subdomains: 1,
            steps: (1..=steps)
                .map(|k| OuterStep {
                    step: k,
                    method: "active_set".into(),
                    active: 200 - k,
                    entered: 2,
                    left: 3,
                    iterations: 10 + k,
                    estimate: (k > 1).then(|| Spectrum::new(1.0, 4.5)),
                    residual: 10f64.powi(-(k as i32)),
                    tolerance: 1e-2,
                    seconds: 0.25,
                    ..OuterStep::default()
                })
                .collect(),
            interfaces: (1..=n)
                .map(|k| InterfaceForce {
                    name: format!("b{}|b{k}", k - 1),
                    kind: InterfaceKind::Contact,
                    candidates: 17,
                    active: k % 2,
                    force: k as f64,
                    largest_gap: 0.0125,
                    min_multiplier: 0.0,
                    max_multiplier: 2.5e-7,
                    ..InterfaceForce::default()
                })
                .collect(),
            bodies: (0..n + 1)
                .map(|k| BodyBalance {
                    name: format!("b{k}"),
                    floating: k > 0,
                    load: (-1.0).into(),
                    contact: 1.0.into(),
                    reaction: (k == 0).then(|| 123456.0.into()),
                    imbalance: 1e-12 * k as f64,
                    moment_imbalance: None,
                })
                .collect(),
            load_steps: Vec::new(),
        }
    }

    #[test]
    fn two_interfaces_are_listed_in_full() {
        let text = contact(&sample(2, 2));
        assert!(
            text.contains("130 of 258 candidates touch; 1 factorisation for 1 distinct subdomain")
        );
        let words = |start: &str| -> Vec<String> {
            let line = text.lines().find(|l| l.trim_start().starts_with(start));
            line.expect(start)
                .split_whitespace()
                .map(String::from)
                .collect()
        };
        assert_eq!(
            words("2  "),
            ["2", "198", "2", "3", "12", "4.500", "1.0e-2", "1.0e-2", "0.250"]
        );
        assert_eq!(words("1  ")[5], "–");
        assert_eq!(
            words("b1|b2"),
            ["b1|b2", "contact", "17", "0", "2.000", "0", "2.500e-7", "0", "0.01250"]
        );
        let first = text.find("b1|b2").unwrap();
        assert!(first < text.find("b0|b1").unwrap(), "largest first");
        assert_eq!(words("b0 "), ["b0", "-1.000", "1.000", "1.235e5", "0.0e0"]);
        assert_eq!(words("b2 ")[3], "floating");
        assert!(!text.contains("more") && !text.contains("not shown"));
    }

    #[test]
    fn many_are_cut_and_counted() {
        let text = contact(&sample(40, 180));
        assert!(
            text.contains("… and 168 more with at most 168.0 each, 84 of them open"),
            "{text}"
        );
        assert!(text.contains("… and 173 more, none of them with a larger imbalance"));
        assert!(text.contains("steps 9 to 24 of 40 are not shown"));
        assert_eq!(
            text.lines().filter(|l| l.contains("contact  ")).count(),
            12 + 1
        ); // and the head of the balance
        let imbalances = text.lines().filter(|l| l.contains("floating")).count();
        assert_eq!(imbalances, 8);
        assert!(
            text.contains("\nb180 ") && !text.contains("\nb172 "),
            "the largest imbalances"
        );
        assert!(text.lines().all(|l| l.chars().count() < 120));
    }

    #[test]
    fn load_steps_and_second_method_have_columns() {
        let mut report = sample(3, 1);
        report.steps[2].method = "smalbe".into();
        for (k, s) in report.steps.iter_mut().enumerate() {
            s.load_step = 1 + k / 2;
        }
        report.load_steps = vec![LoadStep {
            t: 0.5,
            energy: f64::NAN,
            ..LoadStep::default()
        }];
        let text = contact(&report);
        let header = text.lines().find(|l| l.contains("κ est.")).unwrap();
        assert!(
            header.starts_with("load  step") && header.ends_with("method"),
            "{header}"
        );
        assert_eq!(text.matches("smalbe").count(), 1);
        let load = text.lines().find(|l| l.contains("0.5000")).unwrap();
        assert!(load.ends_with('–'), "{load}");
    }

    #[test]
    fn certificate_names_the_four_conditions() {
        let mut kkt = Kkt {
            stationarity: 1e-9,
            feasibility: 2e-10,
            complementarity: 3e-13,
            min_multiplier: Some(-4e-12),
        };
        assert_eq!(
            certificate(&kkt),
            "stationarity 1.0e-9, feasibility 2.0e-10, complementarity 3.0e-13, sign 4.0e-12 (smallest multiplier -4.0e-12)"
        );
        kkt.min_multiplier = Some(0.25);
        assert!(certificate(&kkt).ends_with("sign 0.0e0 (smallest multiplier 2.5e-1)"));
        kkt.min_multiplier = None;
        assert_eq!(
            certificate(&kkt),
            "stationarity 1.0e-9, feasibility 2.0e-10"
        );
    }

    #[test]
    fn a_number_that_is_missing_comes_first() {
        let mut report = sample(1, 20);
        report.interfaces[0].force = f64::NAN;
        report.bodies[0].imbalance = f64::NAN;
        let text = contact(&report);
        let interface = text.find("b0|b1").expect("the bad interface is shown");
        assert!(interface < text.find("b19|b20").unwrap());
        let balance = &text[text.find("imbalance").unwrap()..];
        assert!(balance.find("b0 ").unwrap() < balance.find("b20 ").unwrap());
    }
}

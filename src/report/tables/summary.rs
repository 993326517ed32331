//! The tables that the commands print, and their CSV forms.

use super::contact as contact_summary;
use super::table::{count, fixed, Table};
use crate::report::json::{Communication, SolveReport, Spectrum, Table1Row, Table1Side};

/// The result of `solve` as lines "name  value".
pub fn solve(r: &SolveReport) -> String {
    let spectrum = |s: Option<Spectrum>| {
        s.map_or_else(
            || "–".to_string(),
            |s| {
                format!(
                    "κ = {:.4}   (λ_min {:.6}, λ_max {:.4})",
                    s.kappa, s.lambda_min, s.lambda_max
                )
            },
        )
    };
    let floating = match r.floating_bodies {
        0 => "none floating".to_string(),
        n => format!("{n} floating"),
    };
    let mut lines = vec![
        ("scene", r.scene.clone()),
        (
            "bodies",
            format!(
                "{} ({floating}), {} subdomains on {}",
                r.bodies,
                r.subdomains,
                ranks(r.ranks)
            ),
        ),
        ("degrees of freedom", r.dofs.to_string()),
        (
            "multipliers",
            format!(
                "{} in bodies, {} between bodies ({} active)",
                r.multipliers.local, r.multipliers.global, r.multipliers.active
            ),
        ),
        (
            "method",
            format!(
                "{}, preconditioner {}, projector {}",
                r.ksp_type, r.preconditioner, r.projector
            ),
        ),
    ];
    // The default, a scalar problem in the plane, is not mentioned.
    if r.dimension == 3 || r.components > 1 {
        lines.insert(1, ("physics", r.form.clone()));
    }
    let inner = if r.outer_iterations > 1 {
        let each: Vec<String> = r.iterations.inner.iter().map(usize::to_string).collect();
        // For many outer steps, their table has the iterations.
        let each = if each.len() > 12 {
            String::new()
        } else {
            format!(" ({})", each.join(", "))
        };
        format!(
            "{} in {} contact steps{each}",
            r.iterations.total, r.outer_iterations
        )
    } else {
        r.iterations.total.to_string()
    };
    lines.push((
        "iterations",
        format!("{inner}, {} at rtol {:.0e}", r.converged_reason, r.rtol),
    ));
    if let Some(adaptive) = &r.adaptive {
        if adaptive.constraints.iter().any(|n| *n > 0) {
            lines.push(("adaptive primal", adaptive.constraints_text()));
        }
        if let Some(deflation) = &adaptive.deflation {
            lines.push(("deflation", deflation.text()));
        }
    }
    if r.condition.exact.is_some() {
        lines.push(("exact spectrum", spectrum(r.condition.exact)));
    }
    if r.condition.estimate.is_some() {
        lines.push(("estimate of the run", spectrum(r.condition.estimate)));
    }
    lines.push((
        if r.kkt.min_multiplier.is_some() {
            "KKT conditions"
        } else {
            "residuals"
        },
        contact_summary::certificate(&r.kkt),
    ));
    lines.push(("energy", format!("{:.12e}", r.energy)));
    if let Some(e) = r.error {
        lines.push((
            "error",
            format!(
                "L² {:.3e}, H¹ {:.3e}, energy {:.3e}",
                e.l2, e.h1, e.energy_norm
            ),
        ));
    }
    if let Some(c) = r.communication.filter(|_| r.ranks > 1) {
        lines.push(("an iteration sends", communication(&c)));
    }
    let s = &r.seconds;
    lines.push((
        "seconds",
        format!(
            "{:.3} (assemble {:.3}, set-up {:.3}, solve {:.3}, recover {:.3})",
            s.total, s.assemble, s.setup, s.solve, s.recover
        ),
    ));
    if let Some(o) = r.operators.filter(|o| o.sparse > 0) {
        let text = format!(
            "{} of {} kinds of subdomains as sparse solves ({:.0} MB), the others as dense matrices ({:.0} MB)",
            o.sparse, o.kinds, o.factor_mb, o.dense_mb
        );
        lines.push(("operators", text));
    }
    lines.push(("memory", format!("{:.0} MB", r.memory_mb)));
    let width = lines
        .iter()
        .map(|(name, _)| name.chars().count())
        .max()
        .unwrap_or(0);
    let mut text: String = lines
        .iter()
        .map(|(name, value)| format!("{name:<width$}  {value}\n"))
        .collect();
    if let Some(contact) = &r.contact {
        text += &contact_summary::contact(contact);
    }
    if let Some(identities) = &r.check {
        text += "identities (relative defects, to be about rounding)\n";
        for (name, defect) in identities {
            text += &format!("  {name:<width$}{defect:.1e}\n");
        }
    }
    text
}

pub(crate) fn ranks(n: usize) -> String {
    if n == 1 {
        "1 rank".to_string()
    } else {
        format!("{n} ranks")
    }
}

/// One line on the messages of an iteration.
fn communication(c: &Communication) -> String {
    let (messages, bytes) = (c.messages_per_iteration, c.bytes_per_iteration);
    format!(
        "{:.0} messages, {:.1} kB (most of a rank {:.0}, {:.1} kB), {:.1} all-reduces of {:.0} B",
        messages.sum,
        1e-3 * bytes.sum,
        messages.max,
        1e-3 * bytes.max,
        c.reductions_per_iteration,
        c.reduced_bytes_per_iteration / c.reductions_per_iteration.max(1.0)
    )
}

/// Table 1 for terminals: the paper's numbers, then ours with M_D and M_C, columns (I) and (II) side by side.
pub fn table1(rows: &[Table1Row]) -> Table {
    let mut header: Vec<String> = ["1/H_b", "H_b/H_s", "H_s/h"].map(String::from).to_vec();
    for column in ["I", "II"] {
        for name in ["paper κ", "it", "κ(M_D)", "CG est.", "it", "κ(M_C)", "it"] {
            header.push(if name == "paper κ" {
                format!("({column}) {name}")
            } else {
                name.to_string()
            });
        }
    }
    let mut table = Table::new(header);
    for row in rows {
        let mut cells = vec![
            row.bodies.to_string(),
            row.subdomains.to_string(),
            row.elements.to_string(),
        ];
        for side in [&row.whole_interface, &row.middle_third] {
            cells.extend([
                fixed(side.paper.map(|p| p.cond), 4),
                count(side.paper.map(|p| p.iter)),
                fixed(side.exact, 4),
                fixed(side.estimate, 4),
                side.iterations.to_string(),
                fixed(side.coarse_corrected.exact, 4),
                side.coarse_corrected.iterations.to_string(),
            ]);
        }
        table.row(cells);
    }
    table
}

/// Table 1 for programs: one line per size, full precision, empty cells for unknown values.
pub fn table1_csv(rows: &[Table1Row]) -> Table {
    const NAMES: [&str; 10] = [
        "multipliers",
        "floating_bodies",
        "paper_cond",
        "paper_iter",
        "exact",
        "estimate",
        "iterations",
        "coarse_corrected_exact",
        "coarse_corrected_estimate",
        "coarse_corrected_iterations",
    ];
    let mut header: Vec<String> = ["bodies", "subdomains", "elements"]
        .map(String::from)
        .to_vec();
    for side in ["whole_interface", "middle_third"] {
        header.extend(NAMES.iter().map(|name| format!("{side}_{name}")));
    }
    let mut table = Table::new(header);
    let cells_of = |s: &Table1Side| -> [String; 10] {
        [
            s.multipliers.to_string(),
            s.floating_bodies.to_string(),
            exactly(s.paper.map(|p| p.cond)),
            s.paper.map(|p| p.iter.to_string()).unwrap_or_default(),
            exactly(s.exact),
            exactly(s.estimate),
            s.iterations.to_string(),
            exactly(s.coarse_corrected.exact),
            exactly(s.coarse_corrected.estimate),
            s.coarse_corrected.iterations.to_string(),
        ]
    };
    for row in rows {
        let mut cells = vec![
            row.bodies.to_string(),
            row.subdomains.to_string(),
            row.elements.to_string(),
        ];
        cells.extend(cells_of(&row.whole_interface));
        cells.extend(cells_of(&row.middle_third));
        table.row(cells);
    }
    table
}

/// The shortest text that reads back as the same number; empty if the number is unknown or not finite.
pub(crate) fn exactly(x: Option<f64>) -> String {
    match x {
        Some(x) if x.is_finite() && (x == 0.0 || (1e-4..1e15).contains(&x.abs())) => format!("{x}"),
        Some(x) if x.is_finite() => format!("{x:e}"),
        _ => String::new(),
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::report::json::{CoarseCorrected, PaperSide};

    /// A row whose numbers are simple functions of the size.
    pub(crate) fn sample_row(bodies: usize, subdomains: usize, elements: usize) -> Table1Row {
        let paper = crate::report::tables::paper::lookup(bodies, subdomains, elements);
        let side = |paper: Option<PaperSide>, kappa: f64| Table1Side {
            multipliers: 34,
            local_multipliers: 16,
            floating_bodies: 0,
            iterations: 7,
            exact: Some(kappa),
            estimate: None,
            lambda_min: None,
            lambda_max: None,
            paper,
            coarse_corrected: CoarseCorrected {
                exact: Some(1.0 + 0.3 * kappa),
                estimate: Some(f64::NAN),
                lambda_min: None,
                lambda_max: None,
                iterations: 6,
            },
        };
        Table1Row {
            bodies,
            subdomains,
            elements,
            whole_interface: side(
                paper.map(|p| p.whole_interface),
                paper.map_or(9.0, |p| p.whole_interface.cond),
            ),
            middle_third: side(
                paper.map(|p| p.middle_third),
                paper.map_or(9.0, |p| p.middle_third.cond),
            ),
        }
    }

    #[test]
    fn solve_says_what_was_solved_and_leaves_out_what_is_not_known() {
        let mut report: SolveReport = serde_json::from_value(serde_json::json!({
            "scene": "four bodies", "ranks": 1, "threads": 2, "bodies": 4, "floating_bodies": 1, "subdomains": 16,
            "dofs": 225, "multipliers": {"local": 64, "global": 60, "active": 60}, "outer_iterations": 1,
            "iterations": {"inner": [9], "total": 9},
            "condition": {"exact": null, "estimate": {"lambda_min": 1.0, "lambda_max": 3.25, "kappa": 3.25}},
            "kkt": {"stationarity": 1e-9, "feasibility": 2e-10, "complementarity": 0.0, "min_multiplier": null},
            "energy": -0.25, "seconds": {"assemble": 0.1, "setup": 0.2, "solve": 0.3, "recover": 0.1, "total": 0.7},
            "memory_mb": 80.4, "converged_reason": "CONVERGED_RTOL", "ksp_type": "cg",
            "preconditioner": "coarse_corrected", "projector": "identity", "rtol": 1e-6,
        }))
        .unwrap();
        let text = solve(&report);
        let line = |name: &str| {
            text.lines()
                .find(|l| l.starts_with(name))
                .map(|l| l[name.len()..].trim())
        };
        assert_eq!(
            line("bodies"),
            Some("4 (1 floating), 16 subdomains on 1 rank")
        );
        assert_eq!(
            line("multipliers"),
            Some("64 in bodies, 60 between bodies (60 active)")
        );
        assert_eq!(line("iterations"), Some("9, CONVERGED_RTOL at rtol 1e-6"));
        assert_eq!(
            line("estimate of the run"),
            Some("κ = 3.2500   (λ_min 1.000000, λ_max 3.2500)")
        );
        assert_eq!(
            (line("exact spectrum"), line("error"), line("contact")),
            (None, None, None)
        );
        // With inequalities: the whole certificate in one line, and what is known about contact at the end.
        report.kkt.min_multiplier = Some(0.5);
        report.contact = Some(crate::report::json::contact::ContactReport::default());
        let text = solve(&report);
        assert!(
            text.contains("\nKKT conditions ") && text.contains("2.0e-10, complementarity 0.0e0")
        );
        assert!(text.find("\ncontact by ").unwrap() > text.find("\nmemory ").unwrap());
    }

    #[test]
    fn table1_shows_both_columns() {
        let text = table1(&[sample_row(2, 4, 2), sample_row(3, 3, 3)]).to_string();
        let words: Vec<&str> = text.lines().nth(2).unwrap().split_whitespace().collect();
        let expected = "2 4 2 7.1076 10 7.1076 – 7 3.1323 6 4.9790 9 4.9790 – 7 2.4937 6"
            .split(' ')
            .collect::<Vec<_>>();
        assert_eq!(words, expected);
        assert!(text.lines().nth(3).unwrap().contains('–'));
    }

    #[test]
    fn csv_leaves_unknown_cells_empty() {
        let csv = table1_csv(&[sample_row(3, 3, 3)]).to_csv();
        let mut lines = csv.lines();
        assert_eq!(lines.next().unwrap().split(',').count(), 23);
        assert_eq!(
            lines.next().unwrap(),
            "3,3,3,34,0,,,9,,7,3.6999999999999997,,6,34,0,,,9,,7,3.6999999999999997,,6"
        );
        assert_eq!(exactly(Some(1.5e-9)), "1.5e-9");
    }
}

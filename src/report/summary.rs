//! The tables that the commands print, and their CSV forms.

use super::contact_summary;
use super::json::{CompareReport, CompareRow, SolveReport, Spectrum, Table1Row, Table1Side};
use super::table::{count, fixed, scientific, Align, Table};

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
    let inner = if r.outer_iterations > 1 {
        let each: Vec<String> = r.iterations.inner.iter().map(usize::to_string).collect();
        // The table of outer steps has them where there are many.
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
            format!("L² {:.3e}, H¹ {:.3e}, energy {:.3e}", e.l2, e.h1, e.energy),
        ));
    }
    let s = &r.seconds;
    lines.push((
        "seconds",
        format!(
            "{:.3} (assemble {:.3}, set-up {:.3}, solve {:.3}, recover {:.3})",
            s.total, s.assemble, s.setup, s.solve, s.recover
        ),
    ));
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

fn ranks(n: usize) -> String {
    if n == 1 {
        "1 rank".to_string()
    } else {
        format!("{n} ranks")
    }
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

/// Table 1 for programs: one line per size, full precision, empty cells where nothing is known.
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

/// The comparison for terminals, with a caption.
pub fn compare(report: &CompareReport) -> String {
    let header = [
        "method", "parts", "ranks", "κ", "it", "set-up s", "solve s", "total s", "MB", "MB net",
        "error", "residual", "outcome",
    ];
    let mut table = Table::new(header)
        .align(0, Align::Left)
        .align(12, Align::Left);
    let mut notes = String::new();
    for r in &report.rows {
        let net = r
            .memory_mb
            .zip(r.memory_at_start_mb)
            .map(|(all, start)| all - start);
        let mut note = |text: String| {
            notes += if notes.is_empty() { "\n" } else { "" };
            notes += &format!("{} on {}: {text}\n", r.method, ranks(r.ranks));
        };
        if let Some(options) = &r.rescue {
            note(format!("second try, with {options}"));
        }
        let outcome = match &r.message {
            None => r.converged_reason.clone(),
            Some(message) => {
                note(message.clone());
                "see below".to_string()
            }
        };
        table.row([
            r.method.clone(),
            count(r.subdomains),
            match r.threads {
                0 | 1 => r.ranks.to_string(),
                n => format!("{} x {n}", r.ranks),
            },
            fixed(r.kappa, 3),
            count(r.iterations),
            fixed(r.seconds.setup, 3),
            fixed(r.seconds.solve, 3),
            fixed(r.seconds.total, 3),
            fixed(r.memory_mb, 0),
            fixed(net, 0),
            scientific(r.error),
            scientific(r.residual),
            outcome,
        ]);
    }
    format!(
        "{}: {} bodies, {} subdomains, {} unknowns, {} cores\n\n{table}{notes}\n\
         All methods were driven to ‖b − Au‖ ≤ {} ‖b‖ of the assembled problem; its assembly is not in the times.\n\
         parts: pieces of the domain that the method sees; ranks: MPI ranks (x threads); error: in the energy norm,\n\
         against a refined direct solution{}; MB: largest resident memory, summed over the ranks;\n\
         net: without what each rank holds before it has read the problem.\n",
        report.scene,
        report.bodies,
        report.subdomains,
        report.dofs,
        report.cores,
        scientific(Some(report.rtol)),
        match report.reference_residual {
            Some(r) => format!(" (residual {})", scientific(Some(r))),
            None => " (not available)".to_string(),
        },
    )
}

/// The comparison for programs: full precision, empty cells where nothing is known.
pub fn compare_csv(rows: &[CompareRow]) -> Table {
    let mut table = Table::new([
        "method",
        "subdomains",
        "ranks",
        "threads",
        "kappa",
        "iterations",
        "assemble_seconds",
        "setup_seconds",
        "solve_seconds",
        "total_seconds",
        "memory_mb",
        "memory_at_start_mb",
        "error",
        "residual",
        "rtol",
        "converged",
        "converged_reason",
        "rescue",
        "message",
    ]);
    let counted = |n: Option<usize>| n.map(|n| n.to_string()).unwrap_or_default();
    for r in rows {
        table.row([
            r.method.clone(),
            counted(r.subdomains),
            r.ranks.to_string(),
            r.threads.to_string(),
            exactly(r.kappa),
            counted(r.iterations),
            exactly(r.seconds.assemble),
            exactly(r.seconds.setup),
            exactly(r.seconds.solve),
            exactly(r.seconds.total),
            exactly(r.memory_mb),
            exactly(r.memory_at_start_mb),
            exactly(r.error),
            exactly(r.residual),
            exactly(r.rtol),
            r.converged.to_string(),
            r.converged_reason.clone(),
            r.rescue.clone().unwrap_or_default(),
            r.message.clone().unwrap_or_default(),
        ]);
    }
    table
}

/// The shortest text that reads back as the same number; empty when it is not known or not finite.
pub(super) fn exactly(x: Option<f64>) -> String {
    match x {
        Some(x) if x.is_finite() && (x == 0.0 || (1e-4..1e15).contains(&x.abs())) => format!("{x}"),
        Some(x) if x.is_finite() => format!("{x:e}"),
        _ => String::new(),
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::super::json::{CoarseCorrected, CompareSeconds, PaperSide};
    use super::*;

    /// A row whose numbers are simple functions of the size.
    pub(crate) fn sample_row(bodies: usize, subdomains: usize, elements: usize) -> Table1Row {
        let paper = super::super::paper::lookup(bodies, subdomains, elements);
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
        report.contact = Some(super::super::contact::ContactReport::default());
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

    #[test]
    fn compare_names_the_outcome() {
        let row = CompareRow {
            method: "hypre".into(),
            ranks: 2,
            threads: 1,
            kappa: Some(1.25),
            iterations: Some(8),
            seconds: CompareSeconds {
                assemble: Some(0.125),
                setup: Some(0.5),
                solve: Some(0.25),
                total: Some(0.75),
            },
            memory_mb: Some(99.6),
            memory_at_start_mb: Some(50.0),
            error: Some(1.24e-9),
            converged: true,
            converged_reason: "CONVERGED_RTOL".into(),
            ..CompareRow::default()
        };
        let mut failed = row.clone();
        failed.converged = false;
        failed.message = Some("PETSc was built without hypre".into());
        let report = CompareReport {
            scene: "four bodies".into(),
            bodies: 4,
            subdomains: 16,
            dofs: 225,
            rtol: 1e-6,
            cores: 2,
            reference_residual: None,
            rows: vec![row, failed.clone()],
        };
        let text = compare(&report);
        let line = text.lines().find(|l| l.starts_with("hypre")).unwrap();
        assert_eq!(
            line.split_whitespace().collect::<Vec<_>>(),
            "hypre – 2 1.250 8 0.500 0.250 0.750 100 50 1.2e-9 – CONVERGED_RTOL"
                .split(' ')
                .collect::<Vec<_>>()
        );
        assert!(text.contains("PETSc was built without hypre"));
        assert!(text.contains("1e-6") || text.contains("1.0e-6"), "{text}");
        let csv = compare_csv(&[failed]).to_csv();
        let end = "hypre,,2,1,1.25,8,0.125,0.5,0.25,0.75,99.6,50,1.24e-9,,,false,CONVERGED_RTOL,,PETSc was built without hypre\n";
        assert!(csv.ends_with(end), "{csv}");
    }
}

//! The output of `study kernels`: the default in milliseconds, the others as ratios.

use super::{Report, Row, WORTH_CHANGING};
use crate::cholesky::interior::{Ordering, Solver};
use crate::report::tables::table::{Align, Table};

/// A column of seconds.
struct Kernel {
    name: &'static str,
    of: fn(&Row) -> f64,
}

const KERNELS: [Kernel; 3] = [
    Kernel {
        name: "factor",
        of: |r| r.factor,
    },
    Kernel {
        name: "solve",
        of: |r| r.solve,
    },
    Kernel {
        name: "S",
        of: |r| r.schur,
    },
];

/// The rows of one case and size.
fn cases(report: &Report) -> Vec<&[Row]> {
    let same = |a: &Row, b: &Row| (&a.case, a.elements) == (&b.case, b.elements);
    report.rows.chunk_by(same).collect()
}

fn least<'a>(rows: impl Iterator<Item = &'a Row>, of: fn(&Row) -> f64) -> Option<&'a Row> {
    rows.min_by(|a, b| of(a).total_cmp(&of(b)))
}

/// A combination that is worth changing to: case, elements, kernel, solver, ordering, and its speed-up over the
/// default.
pub type Faster = (String, usize, &'static str, String, String, f64);

/// All such combinations; the fastest one for each case and kernel.
pub fn faster(report: &Report) -> Vec<Faster> {
    let mut out = Vec::new();
    for rows in cases(report) {
        let Some(ours) = rows.iter().find(|r| r.default) else {
            continue;
        };
        for kernel in &KERNELS {
            let Some(best) = least(rows.iter(), kernel.of) else {
                continue;
            };
            let factor = (kernel.of)(ours) / (kernel.of)(best);
            if factor > WORTH_CHANGING {
                out.push((
                    best.case.clone(),
                    best.elements,
                    kernel.name,
                    best.solver.clone(),
                    best.ordering.clone(),
                    factor,
                ));
            }
        }
    }
    out
}

/// One row for every case and kernel: the default in milliseconds, and every solver in its best ordering as a ratio to
/// it.
pub fn summary(report: &Report) -> Table {
    let mut header = vec!["case", "n", "n_I", "n_Γ", "kernel", "default ms"];
    header.extend(Solver::ALL.map(Solver::name));
    header.extend(["fastest", "default / fastest"]);
    let columns = header.len();
    let mut table = Table::new(header)
        .align(0, Align::Left)
        .align(4, Align::Left);
    for c in 6..columns - 1 {
        table = table.align(c, Align::Left);
    }
    for rows in cases(report) {
        let Some(ours) = rows.iter().find(|r| r.default) else {
            continue;
        };
        for kernel in &KERNELS {
            let base = (kernel.of)(ours);
            let mut cells = vec![
                ours.case.clone(),
                ours.elements.to_string(),
                ours.interior.to_string(),
                ours.interface.to_string(),
                kernel.name.to_string(),
                milliseconds(base),
            ];
            for solver in Solver::ALL {
                let of = rows.iter().filter(|r| r.solver == solver.name());
                cells.push(least(of, kernel.of).map_or(String::new(), |best| {
                    format!("{:.2} {}", (kernel.of)(best) / base, best.ordering)
                }));
            }
            let best = least(rows.iter(), kernel.of).unwrap_or(ours);
            cells.push(format!("{} {}", best.solver, best.ordering));
            cells.push(format!("{:.2}", base / (kernel.of)(best)));
            table.row(cells);
        }
        table.rule();
    }
    table
}

/// Every combination.
pub fn table(report: &Report) -> Table {
    let mut table = Table::new([
        "case",
        "n",
        "n_I",
        "n_Γ",
        "solver",
        "ordering",
        "rounds",
        "analyse ms",
        "factor ms",
        "solve ms",
        "S ms",
        "MB",
        "error",
        "error of S",
    ]);
    for c in [0, 4, 5] {
        table = table.align(c, Align::Left);
    }
    for rows in cases(report) {
        for r in rows {
            let mut cells = vec![
                r.case.clone(),
                r.elements.to_string(),
                r.interior.to_string(),
                r.interface.to_string(),
                r.solver.clone(),
                r.ordering.clone(),
                r.rounds.to_string(),
            ];
            cells.extend([r.analyse, r.factor, r.solve, r.schur].map(milliseconds));
            cells.push(format!("{:.2}", r.bytes as f64 / 1e6));
            cells.extend([r.error, r.schur_error].map(|e| format!("{e:.0e}")));
            table.row(cells);
        }
        table.rule();
    }
    table
}

/// A number of milliseconds with three digits.
fn milliseconds(seconds: f64) -> String {
    let ms = 1e3 * seconds;
    let digits = match ms {
        v if v >= 100.0 => 0,
        v if v >= 10.0 => 1,
        v if v >= 1.0 => 2,
        v if v >= 0.1 => 3,
        _ => 4,
    };
    format!("{ms:.digits$}")
}

/// Both tables, and the conclusion from them.
pub fn text(report: &Report) -> String {
    let default = (Solver::default().name(), Ordering::default().taken().name());
    let mut out = format!(
        "{}\nmedians; a solver's column: seconds in its best order over those of the default ({}, {})\n\n{}\n",
        table(report),
        default.0,
        default.1,
        summary(report)
    );
    let faster = faster(report);
    if faster.is_empty() {
        out += &format!("nothing is more than {WORTH_CHANGING} times faster than the default\n");
    }
    for (case, n, kernel, solver, ordering, factor) in faster {
        out += &format!(
            "more than {WORTH_CHANGING} times faster than the default: \
             {solver} with {ordering}, {kernel} of {case}, n = {n}: {factor:.2}\n"
        );
    }
    let worst = |of: fn(&Row) -> f64| report.rows.iter().map(of).fold(0.0, f64::max);
    out += &format!(
        "largest error of a solution {:.0e}, of S {:.0e}\n",
        worst(|r| r.error),
        worst(|r| r.schur_error)
    );
    out
}

//! The output of `study kernels`: the default in milliseconds, the others as ratios.

use super::{KernelRow, KernelsReport, WORTH_CHANGING};
use cholesky::interior::{Ordering, Solver};
use report::tables::table::Table;

/// A kernel: its name and its seconds.
type Kernel = (&'static str, fn(&KernelRow) -> f64);

const KERNELS: [Kernel; 3] = [
    ("factor", |r| r.factor),
    ("solve", |r| r.solve),
    ("S", |r| r.schur),
];

/// Whether two rows are of one case and size.
fn same(a: &KernelRow, b: &KernelRow) -> bool {
    (&a.case, a.elements) == (&b.case, b.elements)
}

/// A kernel on one case and size: all rows, the default's, the fastest, and the seconds.
struct Race<'a> {
    kernel: &'static str,
    rows: &'a [KernelRow],
    default: &'a KernelRow,
    fastest: &'a KernelRow,
    seconds: fn(&KernelRow) -> f64,
}

impl Race<'_> {
    /// The speed-up of the fastest over the default.
    fn gain(&self) -> f64 {
        (self.seconds)(self.default) / (self.seconds)(self.fastest)
    }
}

/// All kernels, by case and size.
fn races(report: &KernelsReport) -> Vec<Race<'_>> {
    let mut out = Vec::new();
    for rows in report.rows.chunk_by(same) {
        let Some(default) = rows.iter().find(|r| r.default) else {
            continue;
        };
        for (kernel, seconds) in KERNELS {
            let fastest = least(rows.iter(), seconds).unwrap_or(default);
            out.push(Race {
                kernel,
                rows,
                default,
                fastest,
                seconds,
            });
        }
    }
    out
}

fn least<'a>(
    rows: impl Iterator<Item = &'a KernelRow>,
    of: fn(&KernelRow) -> f64,
) -> Option<&'a KernelRow> {
    rows.min_by(|a, b| of(a).total_cmp(&of(b)))
}

/// A combination that is worth changing to: case, elements, kernel, solver, ordering, and its speed-up over the
/// default.
pub type Faster = (String, usize, &'static str, String, String, f64);

/// All such combinations; the fastest one for each case and kernel.
pub fn faster(report: &KernelsReport) -> Vec<Faster> {
    let races = races(report).into_iter();
    let worth = races.filter(|r| r.gain() > WORTH_CHANGING);
    let named = |r: Race| {
        let KernelRow {
            case,
            elements,
            solver,
            ordering,
            ..
        } = r.fastest.clone();
        (case, elements, r.kernel, solver, ordering, r.gain())
    };
    worth.map(named).collect()
}

/// One row for every case and kernel: the default in milliseconds, and every solver in its best ordering as a ratio to
/// it.
pub fn summary(report: &KernelsReport) -> Table {
    let mut table = Table::of(races(report))
        .words("case", |r| &r.default.case)
        .numbers("n", |r| r.default.elements)
        .numbers("n_I", |r| r.default.interior)
        .numbers("n_Γ", |r| r.default.interface)
        .words("kernel", |r| r.kernel)
        .numbers("default ms", |r| milliseconds((r.seconds)(r.default)));
    for solver in Solver::ALL.map(Solver::name) {
        table = table.words(solver, |r| {
            let best = least(r.rows.iter().filter(|r| r.solver == solver), r.seconds);
            best.map_or(String::new(), |best| {
                let ratio = (r.seconds)(best) / (r.seconds)(r.default);
                format!("{ratio:.2} {}", best.ordering)
            })
        });
    }
    table
        .words("fastest", |r| {
            format!("{} {}", r.fastest.solver, r.fastest.ordering)
        })
        .numbers("default / fastest", |r| format!("{:.2}", r.gain()))
        .rules(|a, b| !same(a.default, b.default))
        .table()
}

/// Every combination.
pub fn table(report: &KernelsReport) -> Table {
    Table::of(&report.rows)
        .words("case", |r| &r.case)
        .numbers("n", |r| r.elements)
        .numbers("n_I", |r| r.interior)
        .numbers("n_Γ", |r| r.interface)
        .words("solver", |r| &r.solver)
        .words("ordering", |r| &r.ordering)
        .numbers("rounds", |r| r.rounds)
        .numbers("analyse ms", |r| milliseconds(r.analyse))
        .numbers("factor ms", |r| milliseconds(r.factor))
        .numbers("solve ms", |r| milliseconds(r.solve))
        .numbers("S ms", |r| milliseconds(r.schur))
        .numbers("MB", |r| format!("{:.2}", r.bytes as f64 / 1e6))
        .numbers("error", |r| format!("{:.0e}", r.error))
        .numbers("error of S", |r| format!("{:.0e}", r.schur_error))
        .rules(|a, b| !same(a, b))
        .table()
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
pub fn text(report: &KernelsReport) -> String {
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
    let worst = |of: fn(&KernelRow) -> f64| report.rows.iter().map(of).fold(0.0, f64::max);
    out += &format!(
        "largest error of a solution {:.0e}, of S {:.0e}\n",
        worst(|r| r.error),
        worst(|r| r.schur_error)
    );
    out
}

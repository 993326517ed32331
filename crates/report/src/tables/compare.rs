//! The comparison of methods as a table.

use super::methods::{options, outcome, outer, ranks_and_threads, LAYOUTS};
use super::summary::ranks;
use super::table::{count, fixed, scientific, Table};
use crate::json::{CompareInequalities, CompareReport, CompareRow, CompareStep};

/// The comparison for terminals, with a caption.
pub fn text(report: &CompareReport) -> String {
    // Outer steps and the active set are shown only where there are inequalities.
    let contact = report.facts.contact.is_some();
    let laws = report.facts.contact.is_some_and(|c| c.law.is_some());
    let mut notes = String::new();
    let mut note = |r: &CompareRow, text: String| {
        notes += if notes.is_empty() { "\n" } else { "" };
        notes += &format!("{} on {}: {text}\n", r.run.method, ranks(r.run.ranks));
    };
    let net = |r: &CompareRow| Some(r.memory_mb? - r.memory_at_start_mb?);
    let set = |r: &CompareRow| set(r.run.contact.and_then(|c| c.differ));
    let several = report.facts.contact.is_some_and(|c| c.solved > 1);
    let table = Table::of(&report.rows)
        .words("method", |r| &r.run.method)
        .words("layout", |r| &r.run.layout)
        .numbers("parts", |r| count(r.run.subdomains))
        .numbers("ranks", |r| ranks_and_threads(&r.run))
        .numbers("κ", |r| fixed(r.run.kappa, 3))
        .when(contact, |t| t.numbers("outer", |r| outer(&r.run)))
        .numbers("it", |r| count(r.run.iterations))
        .numbers("set-up s", |r| fixed(r.seconds.setup, 3))
        .numbers("solve s", |r| fixed(r.seconds.solve, 3))
        .numbers("total s", |r| fixed(r.seconds.total, 3))
        .numbers("MB", |r| fixed(r.memory_mb, 0))
        .numbers("MB net", |r| fixed(net(r), 0))
        .numbers("error", |r| scientific(r.run.error))
        .when(several, |t| {
            t.numbers("ours", |r| scientific(r.run.from_ours))
        })
        .numbers("residual", |r| scientific(r.run.residual))
        .when(contact, |t| t.numbers("set", |r| set(r)))
        .when(laws, |t| {
            let of = |r: &CompareRow| r.run.contact.unwrap_or_default();
            t.numbers("forces", move |r| scientific(of(r).forces))
                .numbers("law", move |r| scientific(of(r).law))
        })
        .words("outcome", |r| outcome(&r.run, |text| note(r, text)))
        .table();
    let steps = load_steps(&report.rows);
    format!(
        "{}: {} bodies, {} subdomains, {} unknowns, {} cores\n\n{table}{notes}\n{steps}{}\n\
         All methods were driven to ‖b − Au‖ ≤ {} ‖b‖ of the assembled problem; its assembly is not in the times.\n\
         {LAYOUTS}\n\
         parts: pieces of the domain that the method sees; ranks: MPI ranks (x threads); error: in the energy norm,\n\
         against a refined direct solution{}; MB: largest resident memory, summed over the ranks;\n\
         net: without what each rank holds before it has read the problem.\n{}{}",
        report.facts.scene,
        report.facts.bodies,
        report.facts.subdomains,
        report.facts.dofs,
        report.cores,
        options(report.rows.iter().map(|r| &r.run)),
        scientific(Some(report.facts.rtol)),
        match report.facts.reference_residual {
            Some(r) => format!(" (residual {})", scientific(Some(r))),
            None => " (not available)".to_string(),
        },
        match report.supports {
            0 => String::new(),
            n => format!(
                "Nothing holds {n} rigid motion{}: \
                 the assembled problem has as many unknowns set to zero, which bear no force.\n",
                if n == 1 { "" } else { "s" }
            ),
        },
        report.facts.contact.map(|c| inequalities(&c)).unwrap_or_default(),
    )
}

/// A load step of a method in a table.
struct StepRow<'a> {
    row: &'a CompareRow,
    number: usize,
    step: &'a CompareStep,
}

fn step_rows(rows: &[CompareRow]) -> Vec<StepRow<'_>> {
    let mut out: Vec<StepRow> = Vec::new();
    for row in rows {
        let steps = row.run.load_steps.iter().enumerate();
        out.extend(steps.map(|(k, step)| StepRow {
            row,
            number: k + 1,
            step,
        }));
    }
    out.sort_by_key(|row| row.number);
    out
}

/// The load steps as a table, where several are solved.
fn load_steps(rows: &[CompareRow]) -> String {
    let rows = step_rows(rows);
    if rows.is_empty() {
        return String::new();
    }
    let table = Table::of(&rows)
        .numbers("load step", |r| r.number.to_string())
        .words("method", |r| &r.row.run.method)
        .numbers("ranks", |r| ranks_and_threads(&r.row.run))
        .numbers("outer", |r| count(r.step.contact.outer))
        .numbers("it", |r| count(r.step.iterations))
        .numbers("set-up s", |r| fixed(r.step.setup, 3))
        .numbers("solve s", |r| fixed(r.step.solve, 3))
        .numbers("error", |r| scientific(r.step.error))
        .numbers("ours", |r| scientific(r.step.from_ours))
        .numbers("residual", |r| scientific(r.step.residual))
        .numbers("set", |r| set(r.step.contact.differ))
        .numbers("forces", |r| scientific(r.step.contact.forces))
        .numbers("law", |r| scientific(r.step.contact.law))
        .table();
    format!("{table}\n")
}

/// The load steps for programs; `None` where not several are solved.
pub fn steps_csv(rows: &[CompareRow]) -> Option<Table> {
    let rows = step_rows(rows);
    let table = Table::of(&rows)
        .exact("load_step", |r| r.number)
        .exact("method", |r| r.row.run.method.as_str())
        .exact("ranks", |r| r.row.run.ranks)
        .exact("threads", |r| r.row.run.threads)
        .exact("outer_steps", |r| r.step.contact.outer)
        .exact("iterations", |r| r.step.iterations)
        .exact("setup_seconds", |r| r.step.setup)
        .exact("solve_seconds", |r| r.step.solve)
        .exact("error", |r| r.step.error)
        .exact("from_ours", |r| r.step.from_ours)
        .exact("residual", |r| r.step.residual)
        .exact("active_rows", |r| r.step.contact.active)
        .exact("active_differ", |r| r.step.contact.differ)
        .exact("feasibility", |r| r.step.contact.feasibility)
        .exact("min_multiplier", |r| r.step.contact.min_multiplier)
        .exact("force_error", |r| r.step.contact.forces)
        .exact("law_error", |r| r.step.contact.law)
        .table();
    (!rows.is_empty()).then_some(table)
}

/// How many rows hold here and not in the direct solution, or the other way round.
fn set(differ: Option<usize>) -> String {
    match differ {
        None => "–".to_string(),
        Some(0) => "same".to_string(),
        Some(n) => format!("{n} differ"),
    }
}

/// Sentences about the inequalities, below the table.
fn inequalities(c: &CompareInequalities) -> String {
    let mut text = format!(
        "Of {} inequalities {} hold with equality in the direct solution, found in {} steps of an active-set loop \
         (violation {}, smallest multiplier {}).\n\
         outer: active sets that were solved for; it: inner iterations of all of them; \
         last set: the equations of our last active set only;\n\
         set: rows that hold here and not in the direct solution, or the other way round.\n",
        c.rows,
        count(c.active),
        count(c.outer),
        scientific(c.feasibility),
        scientific(c.min_multiplier),
    );
    if let Some(law) = c.law {
        text += &format!(
            "Tangential rows count as inequalities that hold where their nodes stick. forces: the largest difference \
             of a force from the direct\nsolution; law: the largest distance of a force from the laws of friction and \
             soft contact ({} in the direct solution); both over\nthe largest force.\n",
            scientific(Some(law))
        );
    }
    if c.load_steps > 1 && c.solved > 1 {
        text += &format!(
            "All {} load steps are solved, each from the end of the one before: seconds, outer and it are sums, error, \
             residual, forces\nand law those of the worst load step; ours: the distance from the solution of the first \
             method, in the energy norm.\n",
            c.load_steps
        );
    } else if c.load_steps > 1 {
        text += &format!(
            "Of {} load steps the last one is solved, alone.\n",
            c.load_steps
        );
    }
    text
}

/// The comparison for programs: full precision, empty cells for unknown values.
pub fn csv(rows: &[CompareRow]) -> Table {
    Table::of(rows)
        .exact("method", |r| r.run.method.as_str())
        .exact("layout", |r| r.run.layout.as_str())
        .exact("subdomains", |r| r.run.subdomains)
        .exact("ranks", |r| r.run.ranks)
        .exact("threads", |r| r.run.threads)
        .exact("kappa", |r| r.run.kappa)
        .exact("iterations", |r| r.run.iterations)
        .exact("assemble_seconds", |r| r.seconds.assemble)
        .exact("setup_seconds", |r| r.seconds.setup)
        .exact("solve_seconds", |r| r.seconds.solve)
        .exact("total_seconds", |r| r.seconds.total)
        .exact("memory_mb", |r| r.memory_mb)
        .exact("memory_at_start_mb", |r| r.memory_at_start_mb)
        .exact("error", |r| r.run.error)
        .exact("residual", |r| r.run.residual)
        .exact("outer_steps", |r| r.run.contact.and_then(|c| c.outer))
        .exact("active_rows", |r| r.run.contact.map(|c| c.active))
        .exact("active_differ", |r| r.run.contact.and_then(|c| c.differ))
        .exact("feasibility", |r| r.run.contact.and_then(|c| c.feasibility))
        .exact("min_multiplier", |r| {
            r.run.contact.and_then(|c| c.min_multiplier)
        })
        .exact("from_ours", |r| r.run.from_ours)
        .exact("force_error", |r| r.run.contact.and_then(|c| c.forces))
        .exact("law_error", |r| r.run.contact.and_then(|c| c.law))
        .exact("rtol", |r| r.run.rtol)
        .exact("converged", |r| r.run.converged)
        .exact("converged_reason", |r| r.run.converged_reason.as_str())
        .exact("options", |r| r.run.options.as_str())
        .exact("given", |r| r.run.given.as_str())
        .exact("rescue", |r| r.run.rescue.as_deref())
        .exact("message", |r| r.run.message.as_deref())
        .table()
}

#[cfg(test)]
#[path = "../../tests/tables/compare.rs"]
mod tests;

//! The comparison of methods as a table.

use super::methods::{counted, outcome, outer, ranks_and_threads, without};
use super::summary::{exactly, ranks};
use super::table::{count, fixed, scientific, Align, Table};
use crate::report::json::{CompareInequalities, CompareReport, CompareRow};

/// Number of columns for scenes with inequalities only.
const OUTER: usize = 4;
const SET: usize = 13;

/// The comparison for terminals, with a caption.
pub fn text(report: &CompareReport) -> String {
    // Outer steps and the active set are shown only where there are inequalities.
    let contact = report.contact.is_some();
    let dropped: &[usize] = if contact { &[] } else { &[OUTER, SET] };
    let header = [
        "method", "parts", "ranks", "κ", "outer", "it", "set-up s", "solve s", "total s", "MB",
        "MB net", "error", "residual", "set", "outcome",
    ];
    let mut table = Table::new(without(dropped, header)).align(0, Align::Left);
    table = table.align(if contact { 14 } else { 12 }, Align::Left);
    let mut notes = String::new();
    for r in &report.rows {
        let net = r
            .memory_mb
            .zip(r.memory_at_start_mb)
            .map(|(all, start)| all - start);
        let note = |text: String| {
            notes += if notes.is_empty() { "\n" } else { "" };
            notes += &format!("{} on {}: {text}\n", r.method, ranks(r.ranks));
        };
        let (rescue, message) = (r.rescue.as_deref(), r.message.as_deref());
        let outcome = outcome(&r.converged_reason, rescue, message, note);
        let cells = [
            r.method.clone(),
            count(r.subdomains),
            ranks_and_threads(r.ranks, r.threads),
            fixed(r.kappa, 3),
            outer(r.contact),
            count(r.iterations),
            fixed(r.seconds.setup, 3),
            fixed(r.seconds.solve, 3),
            fixed(r.seconds.total, 3),
            fixed(r.memory_mb, 0),
            fixed(net, 0),
            scientific(r.error),
            scientific(r.residual),
            match r.contact.and_then(|c| c.differ) {
                None => "–".to_string(),
                Some(0) => "same".to_string(),
                Some(n) => format!("{n} differ"),
            },
            outcome,
        ];
        table.row(without(dropped, cells));
    }
    format!(
        "{}: {} bodies, {} subdomains, {} unknowns, {} cores\n\n{table}{notes}\n\
         All methods were driven to ‖b − Au‖ ≤ {} ‖b‖ of the assembled problem; its assembly is not in the times.\n\
         parts: pieces of the domain that the method sees; ranks: MPI ranks (x threads); error: in the energy norm,\n\
         against a refined direct solution{}; MB: largest resident memory, summed over the ranks;\n\
         net: without what each rank holds before it has read the problem.\n{}{}",
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
        match report.supports {
            0 => String::new(),
            n => format!(
                "Nothing holds {n} rigid motion{}: \
                 the assembled problem has as many unknowns set to zero, which bear no force.\n",
                if n == 1 { "" } else { "s" }
            ),
        },
        report.contact.map(|c| inequalities(&c)).unwrap_or_default(),
    )
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
    if c.load_steps > 1 {
        text += &format!(
            "Of {} load steps the last one is solved, alone.\n",
            c.load_steps
        );
    }
    text
}

/// The comparison for programs: full precision, empty cells for unknown values.
pub fn csv(rows: &[CompareRow]) -> Table {
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
        "outer_steps",
        "active_rows",
        "active_differ",
        "feasibility",
        "min_multiplier",
        "rtol",
        "converged",
        "converged_reason",
        "rescue",
        "message",
    ]);
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
            counted(r.contact.and_then(|c| c.outer)),
            counted(r.contact.map(|c| c.active)),
            counted(r.contact.and_then(|c| c.differ)),
            exactly(r.contact.and_then(|c| c.feasibility)),
            exactly(r.contact.and_then(|c| c.min_multiplier)),
            exactly(r.rtol),
            r.converged.to_string(),
            r.converged_reason.clone(),
            r.rescue.clone().unwrap_or_default(),
            r.message.clone().unwrap_or_default(),
        ]);
    }
    table
}

#[cfg(test)]
#[path = "../../../tests/inside/report/tables/compare.rs"]
mod tests;

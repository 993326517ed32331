//! The comparison of methods as a table.

use super::methods::{outcome, outer, ranks_and_threads};
use super::summary::ranks;
use super::table::{count, fixed, scientific, Table};
use crate::json::{CompareInequalities, CompareReport, CompareRow};

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
    let set = |r: &CompareRow| match r.run.contact.and_then(|c| c.differ) {
        None => "–".to_string(),
        Some(0) => "same".to_string(),
        Some(n) => format!("{n} differ"),
    };
    let table = Table::of(&report.rows)
        .words("method", |r| &r.run.method)
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
        .numbers("residual", |r| scientific(r.run.residual))
        .when(contact, |t| t.numbers("set", |r| set(r)))
        .when(laws, |t| {
            let of = |r: &CompareRow| r.run.contact.unwrap_or_default();
            t.numbers("forces", move |r| scientific(of(r).forces))
                .numbers("law", move |r| scientific(of(r).law))
        })
        .words("outcome", |r| outcome(&r.run, |text| note(r, text)))
        .table();
    format!(
        "{}: {} bodies, {} subdomains, {} unknowns, {} cores\n\n{table}{notes}\n\
         All methods were driven to ‖b − Au‖ ≤ {} ‖b‖ of the assembled problem; its assembly is not in the times.\n\
         parts: pieces of the domain that the method sees; ranks: MPI ranks (x threads); error: in the energy norm,\n\
         against a refined direct solution{}; MB: largest resident memory, summed over the ranks;\n\
         net: without what each rank holds before it has read the problem.\n{}{}",
        report.facts.scene,
        report.facts.bodies,
        report.facts.subdomains,
        report.facts.dofs,
        report.cores,
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
    Table::of(rows)
        .exact("method", |r| r.run.method.as_str())
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
        .exact("force_error", |r| r.run.contact.and_then(|c| c.forces))
        .exact("law_error", |r| r.run.contact.and_then(|c| c.law))
        .exact("rtol", |r| r.run.rtol)
        .exact("converged", |r| r.run.converged)
        .exact("converged_reason", |r| r.run.converged_reason.as_str())
        .exact("rescue", |r| r.run.rescue.as_deref())
        .exact("message", |r| r.run.message.as_deref())
        .table()
}

#[cfg(test)]
#[path = "../../tests/tables/compare.rs"]
mod tests;

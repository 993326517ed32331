//! The summary that `solve` prints.

use super::contact as contact_summary;
use super::table::scientific;
use crate::json::{SolveReport, Spectrum};
use fetifeti::solution::Communication;
use fetifeti::Status;

/// The result of `solve` as lines "name  value".
pub fn solve(r: &SolveReport) -> String {
    let spectrum = |s: Option<Spectrum>| {
        s.map_or_else(
            || "–".to_string(),
            |s| {
                let known = s.settled.map_or_else(String::new, |r| {
                    format!(", settled with a residual of {}", scientific(Some(r)))
                });
                format!(
                    "κ = {:.4}   (λ_min {:.6}, λ_max {:.4}{known})",
                    s.kappa, s.lambda_min, s.lambda_max
                )
            },
        )
    };
    let floating = match r.floating_bodies {
        0 => "none floating".to_string(),
        n => format!("{n} floating"),
    };
    let merged = match r.groups {
        n if n == 0 || n == r.bodies => String::new(),
        n => format!(", merged into {n}"),
    };
    let mut lines = vec![
        ("scene", r.scene.clone()),
        (
            "bodies",
            format!(
                "{}{merged} ({floating}), {} subdomains on {}",
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
    if let Some(coarse) = &r.natural_coarse {
        let how = match (coarse.iterations, coarse.rtol) {
            (Some(n), Some(rtol)) => {
                format!(
                    "{}, {n:.1} iterations of FGMRES around it to {rtol:.0e}",
                    coarse.solver
                )
            }
            _ => format!("{}, exact after rounding", coarse.solver),
        };
        lines.push(("coarse problem of bodies", how));
    }
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
    if r.converged_reason == Status::Rounding.name() {
        lines.push(("rounding", rounding(r)));
    }
    if let Some(adaptive) = &r.adaptive {
        if adaptive.constraints.iter().any(|n| *n > 0) {
            lines.push(("adaptive primal", adaptive.constraints_text()));
        }
        if let Some(deflation) = &adaptive.deflation {
            lines.push(("deflation", deflation.text()));
        }
        if let Some(declined) = &adaptive.declined {
            lines.push(("deflation", declined.text()));
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
    if let Some(certified) = &r.certified {
        lines.push(("certified error", certified.text()));
        if let Some(discretisation) = &certified.discretisation {
            lines.push(("discretisation error", discretisation.text()));
        }
    }
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
            "{:.3} (read {:.3}, assemble {:.3}, set-up {:.3}, solve {:.3}, recover {:.3}, evaluate {:.3}, write {:.3})",
            s.total, s.read, s.assemble, s.setup, s.solve, s.recover, s.evaluate, s.write
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

/// A number of ranks in words: "1 rank", "2 ranks".
pub fn ranks(n: usize) -> String {
    if n == 1 {
        "1 rank".to_string()
    } else {
        format!("{n} ranks")
    }
}

/// One line on a tolerance below rounding.
fn rounding(r: &SolveReport) -> String {
    format!(
        "the tolerance {} is below it; stationarity and feasibility reached {}",
        scientific(Some(r.rtol)),
        scientific(Some(r.kkt.stationarity.max(r.kkt.feasibility)))
    )
}

/// One line on the messages of an iteration.
fn communication(c: &Communication) -> String {
    let (messages, bytes) = (c.messages, c.bytes);
    format!(
        "{:.0} messages, {:.1} kB (most of a rank {:.0}, {:.1} kB), {:.1} all-reduces of {:.0} B",
        messages.sum,
        1e-3 * bytes.sum,
        messages.max,
        1e-3 * bytes.max,
        c.reductions,
        c.reduced_bytes / c.reductions.max(1.0)
    )
}

#[cfg(test)]
#[path = "../../tests/tables/summary.rs"]
mod tests;

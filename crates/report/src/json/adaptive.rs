//! The effect of adaptivity, in words and as JSON.

use serde::{Deserialize, Serialize};

use super::spectrum::Spectrum;

/// Constraints inside bodies, and deflation of eigenvalues above τ between them; key `adaptive` of a report.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Adaptive {
    /// Number of primal constraints that were added in every body, by its number; empty where none were searched for.
    pub constraints: Vec<usize>,
    /// Seconds of the search for constraints; part of `seconds.setup`.
    pub constraint_seconds: f64,
    /// The deflation; absent where nothing was searched for.
    pub deflation: Option<Deflation>,
    /// Eigenvalues that `auto` has left, because many bodies float and deflation would take longer than the iterations.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub declined: Option<Declined>,
}

/// Eigenvalues that are not deflated because that takes longer than the iterations.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Declined {
    /// The largest one that the iterations have seen.
    pub seen: f64,
    /// The eigenvalue from which deflation is worth its cost; absent where it never is.
    pub worth_from: Option<f64>,
}

impl Declined {
    /// One line for a summary.
    pub fn text(&self) -> String {
        let worth = match self.worth_from {
            Some(from) => {
                format!("with so many bodies it costs more than it saves below about {from:.0e}")
            }
            None => "bodies are too many for its matrices".into(),
        };
        format!(
            "none of eigenvalues up to {:.3e}: {worth} (-fetifeti_adaptive 10 asks for it)",
            self.seen
        )
    }
}

/// Deflation of eigenvalues above τ.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Deflation {
    /// τ.
    pub tau: f64,
    /// Number of vectors of all bodies.
    pub vectors: usize,
    /// Number of vectors of every body, by its number.
    pub by_body: Vec<usize>,
    /// Number of vectors that bodies share, in addition to `vectors`.
    pub shared: usize,
    /// Number of vectors that depend linearly on those of neighbours.
    pub dependent: usize,
    /// Whether the iteration broke down with the vectors and was restarted without them.
    pub given_up: bool,
    /// The largest deflated eigenvalue of a body's pencil; 0 without vectors.
    pub largest: f64,
    /// Bodies with more vectors than `-fetifeti_adaptive_max` allows.
    pub capped: Vec<String>,
    /// Seconds of the search and of the matrices; part of `seconds.solve` where the iteration started the search.
    pub seconds: f64,
    /// The exact spectrum without deflation, where it was asked for and SLEPc converged.
    pub exact_without: Option<Spectrum>,
    /// The estimate of the spectrum without deflation, from the iterations before the search.
    pub estimate_without: Option<Spectrum>,
}

impl Adaptive {
    /// A sentence with the number of added constraints, by body.
    pub fn constraints_text(&self) -> String {
        let bodies = self.constraints.iter().filter(|n| **n > 0).count();
        let count = |n: usize, one: &str, many: &str| match n {
            1 => format!("1 {one}"),
            n => format!("{n} {many}"),
        };
        format!(
            "{} added in {}, {:.3} s",
            count(self.constraints.iter().sum(), "constraint", "constraints"),
            count(bodies, "body", "bodies"),
            self.constraint_seconds
        )
    }
}

impl Deflation {
    /// One line for a summary, and a second one where a body needs more vectors than it may have.
    pub fn text(&self) -> String {
        let bodies = self.by_body.iter().filter(|n| **n > 0).count();
        let most = self.by_body.iter().max().copied().unwrap_or(0);
        let found = match self.vectors {
            0 => format!("no eigenvalue above {} in any body", self.tau),
            n => format!(
                "{n} vector{} above {} in {bodies} of {} bodies (at most {most} in one)",
                if n == 1 { "" } else { "s" },
                self.tau,
                self.by_body.len()
            ),
        };
        let without = match (self.exact_without, self.estimate_without) {
            (Some(s), _) => format!("; κ without {:.4e}", s.kappa),
            (None, Some(s)) => format!("; κ without at least {:.1e}", s.kappa),
            _ => String::new(),
        };
        let found = match self.shared {
            0 => found,
            n => format!("{found} and {n} that bodies share"),
        };
        let found = if self.given_up {
            format!("{found}, given up: the iteration broke down with them")
        } else {
            found
        };
        let mut out = format!("{found}, {:.3} s{without}", self.seconds);
        if let Some(first) = self.capped.first() {
            let more = match self.capped.len() {
                1 => String::new(),
                n => format!(" and {} more", n - 1),
            };
            out += &format!(
                "; body \"{first}\"{more} has eigenvalues above {} that are left, \
                 for want of vectors (-fetifeti_adaptive_max)",
                self.tau
            );
        }
        out
    }
}

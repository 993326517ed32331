//! The records of `table1` and `study table1`.

use serde::{Deserialize, Serialize};

/// One row of Table 1: an array of them is the JSON of `fetifeti table1`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Table1Row {
    /// 1/H_b, bodies along each side of the square.
    pub bodies: usize,
    /// H_b/H_s, subdomains along each side of a body.
    pub subdomains: usize,
    /// H_s/h, elements along each side of a subdomain.
    pub elements: usize,
    /// Column (I): continuity on all of Γ.
    pub whole_interface: Table1Side,
    /// Column (II): continuity on the middle third Γ_0 of every face.
    pub middle_third: Table1Side,
}

/// One column of a row of Table 1.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Table1Side {
    /// Rows of B, B_loc and B_gl together.
    pub multipliers: usize,
    /// Rows of B_loc.
    pub local_multipliers: usize,
    /// Bodies that touch no Dirichlet side.
    pub floating_bodies: usize,
    /// The results with M_D.
    #[serde(flatten)]
    pub dirichlet: PcResult,
    /// The paper's printed numbers; `null` in a row that the paper does not have.
    pub paper: Option<PaperSide>,
    /// The results with M_C.
    pub coarse_corrected: PcResult,
}

/// The results with one preconditioner. Every κ is a plain number.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PcResult {
    /// Exact κ; `null` where it was not asked for.
    pub exact: Option<f64>,
    /// CG's estimate of κ.
    pub estimate: Option<f64>,
    /// Exact λ_min.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lambda_min: Option<f64>,
    /// Exact λ_max.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lambda_max: Option<f64>,
    /// Iterations.
    pub iterations: usize,
}

impl PcResult {
    /// The exact κ, or else CG's estimate.
    pub fn kappa(&self) -> Option<f64> {
        self.exact.or(self.estimate)
    }
}

/// The paper's numbers for one column of one row.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PaperSide {
    /// Condition number.
    pub cond: f64,
    /// Iterations.
    pub iter: usize,
}

#[cfg(test)]
#[path = "../../../tests/study/table1/record.rs"]
mod tests;

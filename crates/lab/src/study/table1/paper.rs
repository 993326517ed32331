//! Table 1 of Lee (2010) as printed: condition numbers and iterations of the FETI-FETI method with M_D.

use serde::Deserialize;

use super::record::PaperSide;

/// One row of the printed table.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct PaperRow {
    /// 1/H_b, bodies along each side of the square.
    pub bodies: usize,
    /// H_b/H_s, subdomains along each side of a body.
    pub subdomains: usize,
    /// H_s/h, elements along each side of a subdomain.
    pub elements: usize,
    /// Column (I): continuity on all of Γ.
    pub whole_interface: PaperSide,
    /// Column (II): continuity on the middle third of every face.
    pub middle_third: PaperSide,
}

/// The 20 rows, in the paper's order.
pub fn table1() -> Vec<PaperRow> {
    serde_json::from_str(include_str!("data/lee2010_table1.json"))
        .expect("the table is part of the source and a test reads it")
}

/// The paper's numbers for one size: columns (I) and (II).
pub fn lookup(bodies: usize, subdomains: usize, elements: usize) -> Option<PaperRow> {
    table1()
        .into_iter()
        .find(|r| (r.bodies, r.subdomains, r.elements) == (bodies, subdomains, elements))
}

#[cfg(test)]
#[path = "../../../tests/study/table1/paper.rs"]
mod tests;

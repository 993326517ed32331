//! Table 1 of Lee (2010) as printed: condition numbers and iterations of the FETI-FETI method with M_D.

use crate::report::json::PaperSide;
use serde::Deserialize;

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
mod tests {
    use super::*;

    #[test]
    fn the_printed_table() {
        let rows = table1();
        assert_eq!(rows.len(), 20);
        let first = &rows[0];
        assert_eq!((first.bodies, first.subdomains, first.elements), (2, 2, 2));
        assert_eq!(
            first.whole_interface,
            PaperSide {
                cond: 2.5536,
                iter: 7
            }
        );
        let last = lookup(2, 2, 128).unwrap();
        assert_eq!(last, rows[19]);
        assert_eq!(
            last.middle_third,
            PaperSide {
                cond: 23.3692,
                iter: 17
            }
        );
        assert_eq!(lookup(3, 3, 3), None);
    }
}

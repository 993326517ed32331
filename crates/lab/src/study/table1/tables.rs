//! Table 1 for terminals and as CSV.

use super::record::{PcResult, Table1Row, Table1Side};
use report::tables::table::{count, fixed, Table};

/// Table 1 for terminals: the paper's numbers, then ours with M_D and M_C, columns (I) and (II) side by side.
pub fn table1(rows: &[Table1Row]) -> Table {
    let mut table = Table::of(rows)
        .numbers("1/H_b", |r| r.bodies)
        .numbers("H_b/H_s", |r| r.subdomains)
        .numbers("H_s/h", |r| r.elements);
    for (k, column) in ["I", "II"].into_iter().enumerate() {
        table = table
            .numbers(format!("({column}) paper κ"), |r| {
                fixed(sides(r)[k].paper.map(|p| p.cond), 4)
            })
            .numbers("it", |r| count(sides(r)[k].paper.map(|p| p.iter)))
            .numbers("κ(M_D)", |r| fixed(sides(r)[k].dirichlet.exact, 4))
            .numbers("CG est.", |r| fixed(sides(r)[k].dirichlet.estimate, 4))
            .numbers("it", |r| sides(r)[k].dirichlet.iterations)
            .numbers("κ(M_C)", |r| fixed(sides(r)[k].coarse_corrected.exact, 4))
            .numbers("it", |r| sides(r)[k].coarse_corrected.iterations);
    }
    table.table()
}

/// The columns (I) and (II) of a row.
fn sides(row: &Table1Row) -> [&Table1Side; 2] {
    [&row.whole_interface, &row.middle_third]
}

/// The results with M_D and with M_C in column `k` of a row.
fn results(row: &Table1Row, k: usize) -> [&PcResult; 2] {
    let side = sides(row)[k];
    [&side.dirichlet, &side.coarse_corrected]
}

/// Table 1 for programs: one line per size, full precision, empty cells for unknown values.
pub fn table1_csv(rows: &[Table1Row]) -> Table {
    let mut table = Table::of(rows)
        .exact("bodies", |r| r.bodies)
        .exact("subdomains", |r| r.subdomains)
        .exact("elements", |r| r.elements);
    for (k, column) in ["whole_interface", "middle_third"].into_iter().enumerate() {
        let name = |quantity: &str| format!("{column}_{quantity}");
        table = table
            .exact(name("multipliers"), |r| sides(r)[k].multipliers)
            .exact(name("floating_bodies"), |r| sides(r)[k].floating_bodies)
            .exact(name("paper_cond"), |r| sides(r)[k].paper.map(|p| p.cond))
            .exact(name("paper_iter"), |r| sides(r)[k].paper.map(|p| p.iter));
        for (pc, mark) in ["", "coarse_corrected_"].into_iter().enumerate() {
            let name = |quantity: &str| name(&format!("{mark}{quantity}"));
            table = table
                .exact(name("exact"), |r| results(r, k)[pc].exact)
                .exact(name("estimate"), |r| results(r, k)[pc].estimate)
                .exact(name("iterations"), |r| results(r, k)[pc].iterations);
        }
    }
    table.table()
}

#[cfg(test)]
#[path = "../../../tests/study/table1/tables.rs"]
pub(super) mod tests;

//! Unit tests of `crates/report/src/tables/table.rs`.

use super::*;

fn sample() -> Table {
    let rows = [
        ("fetifeti", "3.18", 9),
        ("a, \"b\"", "10", 100),
        ("mumps", "", 1),
    ];
    Table::of(rows)
        .words("method", |r| r.0)
        .numbers("κ", |r| r.1)
        .numbers("it", |r| r.2)
        .rules(|a, _| a.0 == "fetifeti")
        .table()
}

#[test]
fn text_is_aligned_by_characters() {
    let expected = "\
method       κ   it
───────────────────
fetifeti  3.18    9
───────────────────
a, \"b\"      10  100
mumps             1
";
    assert_eq!(sample().to_string(), expected);
}

#[test]
fn csv_quotes_what_needs_it() {
    assert_eq!(
        sample().to_csv(),
        "method,κ,it\nfetifeti,3.18,9\n\"a, \"\"b\"\"\",10,100\nmumps,,1\n"
    );
}

#[test]
fn columns_for_programs_are_exact() {
    let rows = [Some(0.1 + 0.2), Some(1.5e-9), Some(f64::NAN), None];
    let csv = Table::of(rows)
        .exact("x", |x| *x)
        .when(false, |t| t.exact("hidden", |_| true))
        .exact("known", Option::is_some)
        .table()
        .to_csv();
    let expected = "x,known\n0.30000000000000004,true\n1.5e-9,true\n,true\n,false\n";
    assert_eq!(csv, expected);
    let empty = Table::of([0; 0]).words("a", |n| *n).table();
    assert_eq!(empty.to_string(), "a\n─\n");
}

#[test]
fn unknown_numbers_are_dashes() {
    assert_eq!(fixed(Some(2.7549), 2), "2.75");
    assert_eq!(fixed(Some(f64::NAN), 2), "–");
    assert_eq!(scientific(Some(1.23e-9)), "1.2e-9");
    assert_eq!(value(f64::INFINITY) + &value(0.0), "–0");
    assert_eq!(value(-12.34567) + " " + &value(123456.0), "-12.35 1.235e5");
    assert_eq!(scientific(None) + &count(None) + &count(Some(3)), "––3");
}

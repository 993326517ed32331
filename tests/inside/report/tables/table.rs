//! Unit tests of `src/report/tables/table.rs`.

use super::*;

fn sample() -> Table {
    let mut t = Table::new(["method", "κ", "it"]).align(0, Align::Left);
    t.row(["fetifeti", "3.18", "9"]);
    t.rule();
    t.row(["a, \"b\"", "10", "100"]);
    t.row(["mumps"]);
    t
}

#[test]
fn text_is_aligned_by_characters() {
    let expected = "\
method       κ   it
───────────────────
fetifeti  3.18    9
───────────────────
a, \"b\"      10  100
mumps
";
    assert_eq!(sample().to_string(), expected);
}

#[test]
fn csv_quotes_what_needs_it() {
    assert_eq!(
        sample().to_csv(),
        "method,κ,it\nfetifeti,3.18,9\n\"a, \"\"b\"\"\",10,100\nmumps,,\n"
    );
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

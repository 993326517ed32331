use super::*;

#[test]
fn numbers_as_fortran_writes_them() {
    for (text, value) in [
        ("1", 1.0),
        ("-1.5", -1.5),
        (".5", 0.5),
        ("1.", 1.0),
        ("+2.", 2.0),
        ("1.e5", 1e5),
        ("1.D+5", 1e5),
        ("1d-3", 1e-3),
        ("1.5+3", 1500.0),
        ("-1.5-3", -0.0015),
        ("2100000.0E-1", 210000.0),
    ] {
        assert_eq!(real(text), Some(value), "{text}");
    }
    for text in [
        "", ".", "-", "e5", "1.e", "1..2", "1,5", "nan", "inf", "1e999", "0x10", "1 2", "--1",
        "1+2+3",
    ] {
        assert_eq!(real(text), None, "{text}");
    }
}

#[test]
fn whole_numbers() {
    assert_eq!(whole("12"), Some(12));
    assert_eq!(whole("+7"), Some(7));
    for text in ["", "-1", "1.", "1e3", "99999999999999999999", "x"] {
        assert_eq!(whole(text), None, "{text}");
    }
    assert!(is_whole("-1") && is_whole("99999999999999999999") && !is_whole("1A") && !is_whole(""));
}

#[test]
fn long_texts_are_cut_in_messages() {
    assert_eq!(clip("NALL"), "NALL");
    assert_eq!(clip(&"x".repeat(1000)).len(), 43);
}

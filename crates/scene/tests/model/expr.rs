//! Unit tests of `crates/scene/src/model/expr/mod.rs`.

use super::*;

fn at(x: f64, y: f64) -> Variables {
    Variables {
        point: [x, y, 0.0],
        body: [2, 3, 0],
        subdomain: [4, 5, 0],
    }
}

fn value(text: &str) -> f64 {
    Expr::parse(text).unwrap().eval(&at(0.5, -2.0))
}

#[test]
fn precedence_is_the_usual_one() {
    assert_eq!(value("-x^2"), -0.25);
    assert_eq!(value("2^3^2"), 512.0);
    assert_eq!(value("2^-1"), 0.5);
    assert_eq!(value("8/2*4"), 16.0);
    assert_eq!(value("1 - 2 + 3"), 2.0);
    assert_eq!(value("1e-3*1E3"), 1.0);
    assert_eq!(value("1/3"), 1.0 / 3.0);
    assert_eq!(value("2*e"), 2.0 * std::f64::consts::E);
    assert_eq!(value("1 < 2 && !(3 <= 2) || 0"), 1.0);
    assert_eq!(value("if(y < 0, 7, ln(-1))"), 7.0);
    assert_eq!(value("bi + 10*bj + 100*si + 1000*sj"), 5432.0);
    assert_eq!(value("mod(-1, 4) + min(2,3) + atan2(0, 1)"), 5.0);
}

#[test]
fn gradients_agree_with_central_differences() {
    for text in [
        "sin(pi*x)*cosh(y)",
        "x^3*y^2 - x/y",
        "exp(-x^2)*atan2(y, x) + sqrt(x + 4) + hypot(x,y)",
        "if(x > 0, x^2.5, y) + abs(y)*max(x, y) + tanh(x*y) + 2^x",
        "ln(x+3)*log10(4+x)*tan(x) + asin(x/2) + acos(x/2) + atan(y)",
    ] {
        let e = Expr::parse(text).unwrap();
        let (x, y, h) = (0.7, -1.3, 1e-5);
        let d = e.eval_gradient(&at(x, y));
        assert_eq!(d.value, e.eval(&at(x, y)), "{text}");
        let by_x = (e.eval(&at(x + h, y)) - e.eval(&at(x - h, y))) / (2.0 * h);
        let by_y = (e.eval(&at(x, y + h)) - e.eval(&at(x, y - h))) / (2.0 * h);
        assert!((d.gradient[0] - by_x).abs() < 1e-8, "{text}: {d:?} {by_x}");
        assert!((d.gradient[1] - by_y).abs() < 1e-8, "{text}: {d:?} {by_y}");
    }
}

#[test]
fn mistakes_are_named_with_their_place() {
    let message = |text: &str| Expr::parse_plane(text).unwrap_err();
    assert_eq!(
        message("sin(x"),
        "the end at character 6 where `,` or `)` was expected"
    );
    assert_eq!(
        message("x +"),
        "the end at character 4 where a number, a name or `(` was expected"
    );
    assert!(message("2*z").starts_with("unknown name `z` at character 3"));
    assert_eq!(message("foo(1)"), "unknown function `foo` at character 1");
    assert_eq!(
        message("if(1,2)"),
        "`if` at character 1 has 2 arguments where 3 were expected"
    );
    assert_eq!(message("x $ y"), "`$` at character 3 has no meaning");
    assert_eq!(
        message("1 2"),
        "`2` at character 3 where an operator or the end was expected"
    );
    assert_eq!(message("1.2.3"), "`1.2.3` at character 1 is no number");
    assert_eq!(
        message(""),
        "the end at character 1 where a number, a name or `(` was expected"
    );
    assert!(message(&"(".repeat(10_000)).contains("nesting"));
    assert!(message(&"-".repeat(10_000)).contains("nesting"));
    assert!(message(&"2^".repeat(10_000)).contains("nesting"));
}

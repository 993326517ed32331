//! Expressions in a scene: parsing and evaluation.
//!
//! The parser is written here and not taken from a library. A scene needs the usual precedence (−x² is −(x²)),
//! comparisons and `if`, numbers such as `1e-3`, and gradients of expressions.

pub(crate) mod gradient;
mod parse;
mod tokens;

use gradient::{Real, WithGradient};
use std::fmt;
use std::sync::Arc;

/// Names of the variables, in the order of [`Variables`].
const VARIABLES: [&str; 9] = ["x", "y", "z", "bi", "bj", "bk", "si", "sj", "sk"];

/// The variables at the point of evaluation.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Variables {
    /// The point (x, y, z).
    pub point: [f64; 3],
    /// Place of the body in its grid (`bi`, `bj`, `bk`); zero for a body outside a grid.
    pub body: [usize; 3],
    /// Place of the subdomain in its body (`si`, `sj`, `sk`).
    pub subdomain: [usize; 3],
}

/// An expression in x, y, z, bi, bj, bk, si, sj, sk. Copies share it.
#[derive(Debug, Clone, PartialEq)]
pub struct Expr(Arc<Written>);

#[derive(Debug, PartialEq)]
struct Written {
    text: String,
    root: Ast,
}

#[derive(Debug, Clone, PartialEq)]
enum Ast {
    Number(f64),
    Variable(usize),
    Unary(Unary, Box<Ast>),
    Binary(Binary, Box<Ast>, Box<Ast>),
    If(Box<Ast>, Box<Ast>, Box<Ast>),
}

macro_rules! functions {
    ($enum:ident: $($variant:ident = $name:literal),* $(,)?) => {
        #[derive(Debug, Clone, Copy, PartialEq)]
        enum $enum { $($variant),* }
        impl $enum {
            fn by_name(name: &str) -> Option<Self> {
                match name { $($name => Some($enum::$variant),)* _ => None }
            }
        }
    };
}

functions!(Unary:
    Neg = "neg", Not = "not", Abs = "abs", Sign = "sign", Floor = "floor", Ceil = "ceil", Round = "round",
    Sqrt = "sqrt", Exp = "exp", Ln = "ln", Log10 = "log10", Log2 = "log2",
    Sin = "sin", Cos = "cos", Tan = "tan", Asin = "asin", Acos = "acos", Atan = "atan",
    Sinh = "sinh", Cosh = "cosh", Tanh = "tanh",
);

functions!(Binary:
    Add = "add", Sub = "sub", Mul = "mul", Div = "div", Pow = "pow", Min = "min", Max = "max",
    Atan2 = "atan2", Hypot = "hypot", Mod = "mod",
    Lt = "lt", Le = "le", Gt = "gt", Ge = "ge", Eq = "eq", Ne = "ne", And = "and", Or = "or",
);

impl Expr {
    /// The expression written as `text`.
    ///
    /// # Errors
    /// One clause that says what was found, at which character, and what was expected.
    pub fn parse(text: &str) -> Result<Expr, String> {
        Expr::parse_in(text, &VARIABLES)
    }

    /// The expression written as `text` for a plane scene, where there is no z.
    pub(crate) fn parse_plane(text: &str) -> Result<Expr, String> {
        let names = VARIABLES.map(|v| {
            if ["z", "bk", "sk"].contains(&v) {
                ""
            } else {
                v
            }
        });
        Expr::parse_in(text, &names)
    }

    /// The expression written as `text`, with other names (at most nine) for the variables.
    pub(crate) fn parse_in(text: &str, variables: &[&str]) -> Result<Expr, String> {
        let root = parse::parse(text, variables)?;
        let text = text.to_string();
        Ok(Expr(Arc::new(Written { text, root })))
    }

    /// The constant `value`.
    pub fn constant(value: f64) -> Expr {
        let (text, root) = (format!("{value}"), Ast::Number(value));
        Expr(Arc::new(Written { text, root }))
    }

    /// The value, if the expression contains no variable.
    pub fn as_constant(&self) -> Option<f64> {
        fn free(ast: &Ast) -> bool {
            match ast {
                Ast::Number(_) => true,
                Ast::Variable(_) => false,
                Ast::Unary(_, a) => free(a),
                Ast::Binary(_, a, b) => free(a) && free(b),
                Ast::If(c, a, b) => free(c) && free(a) && free(b),
            }
        }
        free(&self.0.root).then(|| self.eval(&Variables::default()))
    }

    /// Whether the expression contains x, y or z.
    pub(crate) fn varies_in_space(&self) -> bool {
        fn varies(ast: &Ast) -> bool {
            match ast {
                Ast::Number(_) => false,
                Ast::Variable(k) => *k < 3,
                Ast::Unary(_, a) => varies(a),
                Ast::Binary(_, a, b) => varies(a) || varies(b),
                Ast::If(c, a, b) => varies(c) || varies(a) || varies(b),
            }
        }
        varies(&self.0.root)
    }

    /// The value at `at`.
    pub fn eval(&self, at: &Variables) -> f64 {
        if let Ast::Number(value) = self.0.root {
            return value;
        }
        self.eval_on(at, |d| at.point[d])
    }

    /// The value and the gradient by (x, y, z) at `at`.
    pub fn eval_gradient(&self, at: &Variables) -> WithGradient {
        self.eval_on(at, |d| {
            let mut gradient = [0.0; 3];
            gradient[d] = 1.0;
            WithGradient {
                value: at.point[d],
                gradient,
            }
        })
    }

    fn eval_on<T: Real>(&self, at: &Variables, coordinate: impl Fn(usize) -> T) -> T {
        let mut variables = [T::constant(0.0); 9];
        for d in 0..3 {
            variables[d] = coordinate(d);
            variables[3 + d] = T::constant(at.body[d] as f64);
            variables[6 + d] = T::constant(at.subdomain[d] as f64);
        }
        evaluate(&self.0.root, &variables)
    }
}

impl fmt::Display for Expr {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(&self.0.text)
    }
}

fn evaluate<T: Real>(ast: &Ast, variables: &[T; 9]) -> T {
    match ast {
        Ast::Number(value) => T::constant(*value),
        Ast::Variable(k) => variables[*k],
        Ast::Unary(op, a) => unary(*op, evaluate(a, variables)),
        Ast::Binary(op, a, b) => binary(*op, evaluate(a, variables), evaluate(b, variables)),
        // Only the chosen branch is evaluated, so that `if(x > 0, ln(x), 0)` is defined everywhere.
        Ast::If(condition, a, b) => {
            if evaluate(condition, variables).value() != 0.0 {
                evaluate(a, variables)
            } else {
                evaluate(b, variables)
            }
        }
    }
}

fn unary<T: Real>(op: Unary, a: T) -> T {
    let v = a.value();
    let (f, slope) = match op {
        Unary::Neg => (-v, -1.0),
        Unary::Not => (f64::from(v == 0.0), 0.0),
        Unary::Abs => (v.abs(), sign(v)),
        Unary::Sign => (sign(v), 0.0),
        Unary::Floor => (v.floor(), 0.0),
        Unary::Ceil => (v.ceil(), 0.0),
        Unary::Round => (v.round(), 0.0),
        Unary::Sqrt => (v.sqrt(), 0.5 / v.sqrt()),
        Unary::Exp => (v.exp(), v.exp()),
        Unary::Ln => (v.ln(), 1.0 / v),
        Unary::Log10 => (v.log10(), 1.0 / (v * std::f64::consts::LN_10)),
        Unary::Log2 => (v.log2(), 1.0 / (v * std::f64::consts::LN_2)),
        Unary::Sin => (v.sin(), v.cos()),
        Unary::Cos => (v.cos(), -v.sin()),
        Unary::Tan => (v.tan(), 1.0 / v.cos().powi(2)),
        Unary::Asin => (v.asin(), 1.0 / (1.0 - v * v).sqrt()),
        Unary::Acos => (v.acos(), -1.0 / (1.0 - v * v).sqrt()),
        Unary::Atan => (v.atan(), 1.0 / (1.0 + v * v)),
        Unary::Sinh => (v.sinh(), v.cosh()),
        Unary::Cosh => (v.cosh(), v.sinh()),
        Unary::Tanh => (v.tanh(), 1.0 - v.tanh().powi(2)),
    };
    a.chain(f, slope)
}

fn sign(v: f64) -> f64 {
    if v > 0.0 {
        1.0
    } else if v < 0.0 {
        -1.0
    } else {
        0.0
    }
}

fn power(v: f64, w: f64) -> f64 {
    // Small whole exponents use repeated multiplication: exact for negative bases and for squares.
    if w == w.round() && w.abs() <= 64.0 {
        v.powi(w as i32)
    } else {
        v.powf(w)
    }
}

fn binary<T: Real>(op: Binary, a: T, b: T) -> T {
    let (v, w) = (a.value(), b.value());
    let truth = |holds: bool| (f64::from(holds), 0.0, 0.0);
    let (g, by_a, by_b) = match op {
        Binary::Add => (v + w, 1.0, 1.0),
        Binary::Sub => (v - w, 1.0, -1.0),
        Binary::Mul => (v * w, w, v),
        Binary::Div => (v / w, 1.0 / w, -v / (w * w)),
        Binary::Pow => {
            let slope = if w == 0.0 { 0.0 } else { w * power(v, w - 1.0) };
            (power(v, w), slope, power(v, w) * v.ln())
        }
        Binary::Min if v <= w => (v, 1.0, 0.0),
        Binary::Min => (w, 0.0, 1.0),
        Binary::Max if v >= w => (v, 1.0, 0.0),
        Binary::Max => (w, 0.0, 1.0),
        Binary::Atan2 => {
            let r2 = v * v + w * w;
            (v.atan2(w), w / r2, -v / r2)
        }
        Binary::Hypot => {
            let r = v.hypot(w);
            (r, v / r, w / r)
        }
        Binary::Mod => (v.rem_euclid(w), 1.0, -(v / w).floor()),
        Binary::Lt => truth(v < w),
        Binary::Le => truth(v <= w),
        Binary::Gt => truth(v > w),
        Binary::Ge => truth(v >= w),
        Binary::Eq => truth(v == w),
        Binary::Ne => truth(v != w),
        Binary::And => truth(v != 0.0 && w != 0.0),
        Binary::Or => truth(v != 0.0 || w != 0.0),
    };
    a.chain2(b, g, by_a, by_b)
}

#[cfg(test)]
#[path = "../../../tests/model/expr.rs"]
mod tests;

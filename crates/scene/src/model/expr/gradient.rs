//! Numbers with gradients: forward differentiation of expressions.
//!
//! An exact solution is given as one expression; its gradient, which the error norms need, follows from
//! evaluating the same expression on [`WithGradient`] numbers, exact to rounding.

/// A number type on which expressions are evaluated.
pub trait Real: Copy {
    /// The constant `value`.
    fn constant(value: f64) -> Self;
    /// The value without its derivatives.
    fn value(self) -> f64;
    /// f(self), where `f` is the value and `slope` the derivative of f at `self.value()`.
    fn chain(self, f: f64, slope: f64) -> Self;
    /// g(self, other), with both partial derivatives of g.
    fn chain2(self, other: Self, g: f64, by_self: f64, by_other: f64) -> Self;
}

impl Real for f64 {
    fn constant(value: f64) -> Self {
        value
    }
    fn value(self) -> f64 {
        self
    }
    fn chain(self, f: f64, _slope: f64) -> Self {
        f
    }
    fn chain2(self, _other: Self, g: f64, _by_self: f64, _by_other: f64) -> Self {
        g
    }
}

/// A value with its derivatives by x, y and z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WithGradient {
    /// The value.
    pub value: f64,
    /// ∂/∂x, ∂/∂y, ∂/∂z.
    pub gradient: [f64; 3],
}

/// a·b, where 0·∞ counts as 0: a constant operand contributes no derivative, whatever the slope.
fn product(a: f64, b: f64) -> f64 {
    if b == 0.0 {
        0.0
    } else {
        a * b
    }
}

impl Real for WithGradient {
    fn constant(value: f64) -> Self {
        WithGradient {
            value,
            gradient: [0.0; 3],
        }
    }
    fn value(self) -> f64 {
        self.value
    }
    fn chain(self, f: f64, slope: f64) -> Self {
        WithGradient {
            value: f,
            gradient: self.gradient.map(|d| product(slope, d)),
        }
    }
    fn chain2(self, other: Self, g: f64, by_self: f64, by_other: f64) -> Self {
        let part =
            |k: usize| product(by_self, self.gradient[k]) + product(by_other, other.gradient[k]);
        WithGradient {
            value: g,
            gradient: [0, 1, 2].map(part),
        }
    }
}

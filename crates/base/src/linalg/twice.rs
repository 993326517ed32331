//! Sums in twice the working precision (compensated summation).

/// A sum with the rounding errors of its terms.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Twice {
    /// The rounded sum.
    pub high: f64,
    /// The accumulated rounding error.
    pub low: f64,
}

impl Twice {
    /// Adds a number.
    pub fn add(&mut self, value: f64) {
        let sum = self.high + value;
        let part = sum - self.high;
        self.low += (self.high - (sum - part)) + (value - part);
        self.high = sum;
    }

    /// Adds a·b.
    pub fn add_product(&mut self, a: f64, b: f64) {
        let product = a * b;
        self.add(product);
        self.low += a.mul_add(b, -product);
    }

    /// The sum, rounded once.
    pub fn value(self) -> f64 {
        self.high + self.low
    }
}

#[cfg(test)]
#[path = "../../tests/linalg/twice.rs"]
mod tests;

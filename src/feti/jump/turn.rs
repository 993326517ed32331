//! Rows of a node that are turned in their plane: two perpendicular directions take the place of two others.

/// Rows a and b of a block become cos a + sin b and −sin a + cos b.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turn {
    /// The owned rows a and b.
    pub rows: [usize; 2],
    /// The cosine and the sine of the angle.
    pub by: [f64; 2],
}

impl Turn {
    /// The angle `by` and that of this turn together, as cosine and sine.
    pub fn after(&self, [cos, sin]: [f64; 2]) -> [f64; 2] {
        let [c, s] = self.by;
        [c * cos - s * sin, s * cos + c * sin]
    }

    /// The values of both rows after it.
    pub fn of(&self, [a, b]: [f64; 2]) -> [f64; 2] {
        let [cos, sin] = self.by;
        [cos * a + sin * b, cos * b - sin * a]
    }
}

#[cfg(test)]
#[path = "../../../tests/inside/feti/jump/turn.rs"]
mod tests;

//! A node with friction: whether it is apart, sticks or slips, and what follows from a step.
//!
//! ```text
//!     s = λ_t + k w         stick    |s| ≤ g              slip along d = s/|s|    |s| > g
//! ```
//!
//! In space the rows of a node that slips are turned: the first one is along d and has the given force, the second one
//! is across d. It is a spring of compliance |w|/g, by which the force follows the direction of the slip.

use super::tuning::FrictionTuning;
use crate::feti::jump::turn::Turn;
use crate::substructures::{FrictionBound, FrictionNode};

/// The state of a node in the equations of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NodeState {
    /// It does not touch, and has no friction.
    Apart,
    /// Its tangential rows hold.
    Stick,
    /// The force of friction is given: g along this direction.
    Slip([f64; 2]),
}

/// A node with friction among the owned rows.
#[derive(Debug, Clone)]
pub struct Node {
    /// The normal row.
    pub normal: usize,
    /// The tangential rows.
    pub tangential: Vec<usize>,
    bound: FrictionBound,
    /// k, a force per length of the size of the diagonal of K.
    stiffness: f64,
    /// The least and the largest compliance of a spring across its slip, in terms of that of the node.
    springs: [f64; 2],
    /// Its state in the equations.
    pub state: NodeState,
    /// g in the equations.
    pub g: f64,
    /// The direction of the first tangential row, in the directions that were given.
    axis: [f64; 2],
    /// |w| along the slip of the last step.
    slipped: f64,
    /// (|s| − g)/k after the last step: how far the node slips, or would slip if it had stuck with more than its bound.
    pub excess: f64,
}

/// The solution of a step on the owned rows: multipliers, gaps B u − C λ − c, and which rows are to hold.
pub struct Step<'s> {
    /// λ.
    pub lambda: &'s [f64],
    /// The gaps.
    pub gaps: &'s [f64],
    /// Whether each row is to hold.
    pub active: &'s [bool],
    /// Slips below this are rounding, or residuals of the step.
    pub nothing: f64,
}

/// The change of a node in a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Change {
    /// Whether the node has another state, apart from its direction.
    pub flips: bool,
    /// How far its force of friction moves.
    pub moves: f64,
}

impl Node {
    /// The node of these given rows, in the state that multipliers and a set say: a row that does not hold and has a
    /// multiplier slips. `compliance` is that of the nodes, by owned row; `beside` is the number of rows of the node,
    /// its own and those of other contacts.
    pub fn new(
        given: &FrictionNode,
        place: impl Fn(usize) -> usize,
        beside: usize,
        (lambda, active): (&[f64], &[bool]),
        compliance: &[f64],
        tuning: &FrictionTuning,
    ) -> Node {
        let tangential: Vec<usize> = given.tangential.iter().map(|&r| place(r)).collect();
        let mut force = [0.0; 2];
        for (f, &t) in force.iter_mut().zip(&tangential) {
            *f = lambda[t];
        }
        let sticks = tangential.iter().all(|&t| active[t]);
        let size = length(force);
        let state = match size {
            _ if sticks => NodeState::Stick,
            size if size > 0.0 => NodeState::Slip(force.map(|f| f / size)),
            _ => NodeState::Apart,
        };
        let soft = tangential.iter().map(|&t| compliance[t]);
        let soft = soft.fold(0.0, f64::max);
        Node {
            normal: place(given.normal),
            tangential,
            bound: given.bound,
            stiffness: if soft > 0.0 { 1.0 / soft } else { 0.0 },
            springs: match beside {
                ..=3 => [tuning.rigid, tuning.soft],
                _ => [tuning.rigid, tuning.soft_at_edges],
            },
            state,
            g: size,
            axis: [1.0, 0.0],
            slipped: 0.0,
            excess: 0.0,
        }
    }

    /// The turn that brings the first row along the slip, or where the node does not slip to its given direction;
    /// `None` if it is there, and in the plane.
    pub fn turn(&mut self) -> Option<Turn> {
        let [a, b] = self.tangential[..] else {
            return None;
        };
        let to = match self.state {
            NodeState::Slip(d) => d,
            NodeState::Apart | NodeState::Stick => [1.0, 0.0],
        };
        if to == self.axis {
            return None;
        }
        let from = self.axis;
        self.axis = to;
        Some(Turn {
            rows: [a, b],
            by: [
                from[0] * to[0] + from[1] * to[1],
                from[0] * to[1] - from[1] * to[0],
            ],
        })
    }

    /// Whether each tangential row holds in the equations.
    pub fn holds(&self) -> [bool; 2] {
        match self.state {
            NodeState::Stick => [true; 2],
            NodeState::Slip(_) => [false, self.is_stiff_across()],
            NodeState::Apart => [false; 2],
        }
    }

    /// Whether the row across the slip is to hold. A spring much softer than the node costs iterations, and is not
    /// needed: its force is small, and follows the slip from step to step.
    fn is_stiff_across(&self) -> bool {
        self.tangential.len() == 2
            && self.g > 0.0
            && self.stiffness * self.slipped <= self.springs[1] * self.g
    }

    /// Notes that the rows have the directions that were given.
    pub fn turned_back(&mut self) {
        self.axis = [1.0, 0.0];
    }

    /// The bound g that follows from these multipliers.
    pub fn bound(&self, lambda: &[f64]) -> f64 {
        self.bound.at(lambda[self.normal])
    }

    /// The largest bound that any multipliers give; ∞ for Coulomb's law without a limit.
    pub fn largest_bound(&self) -> f64 {
        self.bound.at(f64::INFINITY)
    }

    /// The row across the slip; `None` in the plane, and if it does not slip.
    pub fn slips_beside(&self) -> Option<usize> {
        match (self.state, &self.tangential[..]) {
            (NodeState::Slip(_), &[_, across]) => Some(across),
            _ => None,
        }
    }

    /// The compliance of the row across the slip; 0 unless it slips in space.
    pub fn across(&self) -> f64 {
        match self.state {
            NodeState::Slip(_)
                if self.is_stiff_across()
                    && self.stiffness * self.slipped > self.springs[0] * self.g =>
            {
                self.slipped / self.g
            }
            _ => 0.0,
        }
    }

    /// Values on the rows, in the directions that were given.
    pub fn given(&self, [first, second]: [f64; 2]) -> [f64; 2] {
        let [c, s] = self.axis;
        [c * first - s * second, s * first + c * second]
    }

    /// Values in the directions that were given, on the rows.
    pub fn on_rows(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [c, s] = self.axis;
        [c * x + s * y, c * y - s * x]
    }

    /// The size of the given force of friction; zero unless the node slips.
    pub fn slipping(&self) -> f64 {
        match self.state {
            NodeState::Slip(_) => self.g,
            NodeState::Apart | NodeState::Stick => 0.0,
        }
    }

    /// The bound that follows from the multipliers of a step, if the node slips; else 0.
    pub fn following(&self, lambda: &[f64]) -> f64 {
        match self.state {
            NodeState::Slip(_) => self.bound.at(lambda[self.normal]),
            NodeState::Apart | NodeState::Stick => 0.0,
        }
    }

    /// The given force of friction in the directions that were given; zero unless the node slips.
    pub fn force(&self) -> [f64; 2] {
        match self.state {
            NodeState::Slip(d) => d.map(|d| self.g * d),
            NodeState::Apart | NodeState::Stick => [0.0; 2],
        }
    }

    /// λ_t and w after a step, in the directions that were given.
    fn tangent(&self, step: &Step<'_>) -> [[f64; 2]; 2] {
        let mut out = [[0.0; 2]; 2];
        for (k, &t) in self.tangential.iter().enumerate() {
            out[0][k] = step.lambda[t];
            out[1][k] = step.gaps[t];
        }
        if self.tangential.len() == 2 {
            // The row across the slip is a spring: its jump is what the spring gives way.
            out[1][1] += self.across() * out[0][1];
        }
        out.map(|v| self.given(v))
    }

    /// The state that follows from a step, its g, and (|s| − g)/k.
    fn next(&self, step: &Step<'_>) -> (NodeState, f64, f64) {
        let g = self.bound.at(step.lambda[self.normal]);
        if !step.active[self.normal] && !self.bound.acts_apart() {
            return (NodeState::Apart, 0.0, 0.0);
        }
        let [mut force, slip] = self.tangent(step);
        // The force along a slip is that of the next step.
        if let NodeState::Slip(d) = self.state {
            force = [0, 1].map(|k| force[k] + (g - self.g) * d[k]);
        }
        let s = [0, 1].map(|k| force[k] + self.stiffness * slip[k]);
        let size = length(s);
        // A node that would slip the other way sticks first: all nodes of a body that slides too far would turn.
        let turns = match self.state {
            NodeState::Slip(d) => d[0] * s[0] + d[1] * s[1] < 0.0,
            NodeState::Apart | NodeState::Stick => false,
        };
        // Rows of another contact may hold a node that slips: its slip vanishes, and says nothing.
        let rests = match self.state {
            NodeState::Slip(d) => (d[0] * slip[0] + d[1] * slip[1]).abs() <= step.nothing,
            NodeState::Apart | NodeState::Stick => false,
        };
        let state = if size <= g && rests {
            self.state
        } else if size <= g || turns {
            NodeState::Stick
        } else {
            // Where the row across does not hold, its multiplier says nothing of the direction.
            let w = length(slip);
            let free = self
                .slips_beside()
                .is_some_and(|across| !step.active[across]);
            match free && w > step.nothing {
                true => NodeState::Slip(slip.map(|v| v / w)),
                false => NodeState::Slip(s.map(|s| s / size)),
            }
        };
        let excess = match self.stiffness {
            k if k > 0.0 => (size - g).max(0.0) / k,
            _ => 0.0,
        };
        (state, g, excess)
    }

    /// By how much, as a force, the node is beside the state that follows from a step; 0 if that is its own. `touched`
    /// says whether its normal row held.
    pub fn wrong(&self, step: &Step<'_>, touched: bool) -> f64 {
        let (state, g, _) = self.next(step);
        let [force, slip] = self.tangent(step);
        let normal = match (touched, step.active[self.normal]) {
            (true, false) => step.lambda[self.normal].abs(),
            (false, true) => self.stiffness * step.gaps[self.normal].abs(),
            _ => 0.0,
        };
        let tangential = match (self.state, state) {
            (NodeState::Stick, NodeState::Slip(_)) => length(force) - g,
            (NodeState::Slip(_), NodeState::Stick) => self.stiffness * length(slip),
            _ => 0.0,
        };
        normal.max(tangential)
    }

    /// Takes the node to the state that follows from a step, or to its g alone if it waits.
    pub fn update(&mut self, step: &Step<'_>, waits: bool) -> Change {
        let before = self.force();
        let slip = self.tangent(step)[1];
        let (mut state, g, excess) = self.next(step);
        let kind = std::mem::discriminant(&self.state);
        let flips = kind != std::mem::discriminant(&state);
        if flips && waits {
            state = self.state;
        }
        (self.state, self.g, self.excess) = (state, g, excess);
        self.slipped = match state {
            NodeState::Slip(d) => Some(d[0] * slip[0] + d[1] * slip[1])
                .filter(|along| *along > step.nothing)
                .unwrap_or(0.0),
            NodeState::Apart | NodeState::Stick => 0.0,
        };
        let now = self.force();
        Change {
            flips,
            moves: length([now[0] - before[0], now[1] - before[1]]),
        }
    }

    /// Lets the node slip if it sticks and slips all the same, because another contact holds it elsewhere. Returns
    /// whether it does.
    pub fn gives_way(&mut self, step: &Step<'_>) -> bool {
        let slip = self.tangent(step)[1];
        let size = length(slip);
        let gives = self.state == NodeState::Stick && size > step.nothing;
        if gives {
            self.state = NodeState::Slip(slip.map(|w| w / size));
            self.slipped = size;
        }
        gives
    }

    /// How far a solution is from the law of friction, |λ_t − Π_g(λ_t + k w)| with the projection Π_g onto the disc of
    /// radius g. It is a force.
    pub fn error(&self, step: &Step<'_>) -> f64 {
        let [force, slip] = self.tangent(step);
        let g = self.bound.at(step.lambda[self.normal]);
        let told = match length(slip) {
            size if size > step.nothing => 1.0 - step.nothing / size,
            _ => 0.0,
        };
        let s = [0, 1].map(|k| force[k] + told * self.stiffness * slip[k]);
        let factor = match length(s) {
            size if size > g => g / size,
            _ => 1.0,
        };
        length([force[0] - factor * s[0], force[1] - factor * s[1]])
    }
}

fn length(v: [f64; 2]) -> f64 {
    v[0].hypot(v[1])
}

#[cfg(test)]
#[path = "../../../tests/inside/contact/friction/node.rs"]
pub(super) mod tests;

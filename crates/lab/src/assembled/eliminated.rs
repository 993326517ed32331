//! Equations between displacements, solved for as many unknowns: u = T v + g.
//!
//! Every equation gives up one unknown, its *dependent* one, which is then a combination of others and an offset. What
//! is left of the matrix, Tᵀ K T, is symmetric and positive definite as K is, so that every solver can take it. An
//! equation that follows from the others gives up nothing.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

/// Σ coefficient · u(place).
type Terms = BTreeMap<u64, f64>;

/// An equation follows from others where they leave no more than this of its largest coefficient.
const DEPENDENT: f64 = 1e-9;

/// Its right-hand side contradicts them where they leave more than this of the largest value that entered it.
const CONTRADICTS: f64 = 1e-8;

/// A dependent unknown has at least this part of the largest coefficient: the coefficients of T stay moderate.
const PIVOT: f64 = 0.01;

/// Why an equation cannot be solved for an unknown; the place is one that it has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Trouble {
    /// None of its unknowns may be given up.
    Kept(u64),
    /// The other equations ask for another value.
    Contradicts(u64),
}

/// The dependent unknowns.
#[derive(Debug, Default)]
pub struct EliminatedUnknowns {
    /// Each in terms of unknowns that are not dependent, and the offset.
    of: BTreeMap<u64, (Terms, f64)>,
    /// The dependent unknowns in the order of their equations.
    order: Vec<u64>,
}

impl EliminatedUnknowns {
    /// Solves the equations, each given as terms and right-hand side. Of its unknowns an equation gives up the one with
    /// the largest product of coefficient and `weight`; unknowns of weight 0 stay.
    ///
    /// # Errors
    /// The first equation for which that cannot be done.
    pub fn new(
        equations: impl IntoIterator<Item = (Vec<(u64, f64)>, f64)>,
        weight: &dyn Fn(u64) -> f64,
    ) -> Result<EliminatedUnknowns, Trouble> {
        let mut out = EliminatedUnknowns::default();
        // The dependent unknowns in whose terms an unknown is.
        let mut users: HashMap<u64, HashSet<u64>> = HashMap::new();
        for (terms, rhs) in equations {
            let Some((pivot, terms, offset)) = out.solved(&terms, rhs, weight)? else {
                continue;
            };
            // Earlier dependent unknowns lose the new one.
            let with_it: BTreeSet<u64> = users.remove(&pivot).into_iter().flatten().collect();
            for user in with_it {
                let (its, value) = out.of.get_mut(&user).expect("a dependent unknown");
                let factor = its.remove(&pivot).expect("it has the new one");
                *value += factor * offset;
                for (&place, t) in &terms {
                    *its.entry(place).or_default() += factor * t;
                    users.entry(place).or_default().insert(user);
                }
            }
            for &place in terms.keys() {
                users.entry(place).or_default().insert(pivot);
            }
            out.of.insert(pivot, (terms, offset));
            out.order.push(pivot);
        }
        for (terms, _) in out.of.values_mut() {
            terms.retain(|_, t| *t != 0.0);
        }
        Ok(out)
    }

    /// An equation solved for one of its unknowns; `None` where it follows from the earlier ones.
    fn solved(
        &self,
        equation: &[(u64, f64)],
        rhs: f64,
        weight: &dyn Fn(u64) -> f64,
    ) -> Result<Option<(u64, Terms, f64)>, Trouble> {
        let largest = |m: f64, v: f64| m.max(v.abs());
        let size = equation.iter().map(|t| t.1).fold(0.0, largest);
        let (mut rest, mut value, mut entered) = (Terms::new(), rhs, rhs.abs());
        for &(place, b) in equation {
            match self.of.get(&place) {
                None => *rest.entry(place).or_default() += b,
                Some((terms, offset)) => {
                    for (&other, t) in terms {
                        *rest.entry(other).or_default() += b * t;
                    }
                    value -= b * offset;
                    entered = entered.max((b * offset).abs());
                }
            }
        }
        let left = rest.values().copied().fold(0.0, largest);
        if left <= DEPENDENT * size {
            let any = equation.first().map_or(0, |t| t.0);
            return if value.abs() > CONTRADICTS * entered {
                Err(Trouble::Contradicts(any))
            } else {
                Ok(None)
            };
        }
        // Rounding would fill T.
        rest.retain(|_, b| b.abs() > 1e-14 * size);
        let fit = rest
            .iter()
            .filter(|(place, b)| weight(**place) > 0.0 && b.abs() >= PIVOT * left);
        let size = |t: &(&u64, &f64)| weight(*t.0) * t.1.abs();
        let by_size =
            |a: &(&u64, &f64), b: &(&u64, &f64)| size(a).total_cmp(&size(b)).then(b.0.cmp(a.0));
        let Some((&pivot, &b)) = fit.max_by(by_size) else {
            let first = rest.keys().next().copied();
            return Err(Trouble::Kept(first.unwrap_or_default()));
        };
        rest.remove(&pivot);
        rest.values_mut().for_each(|t| *t /= -b);
        Ok(Some((pivot, rest, value / b)))
    }

    /// The dependent unknowns, increasing.
    pub fn places(&self) -> impl Iterator<Item = u64> + '_ {
        self.of.keys().copied()
    }

    /// The dependent unknowns in the order of the equations that gave them up.
    pub fn order(&self) -> &[u64] {
        &self.order
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.of.is_empty()
    }

    /// A dependent unknown in terms of others, with the offset; `None` for any other.
    pub fn get(&self, place: u64) -> Option<(&BTreeMap<u64, f64>, f64)> {
        self.of.get(&place).map(|(terms, offset)| (terms, *offset))
    }
}

#[cfg(test)]
#[path = "../../tests/assembled/eliminated.rs"]
mod tests;

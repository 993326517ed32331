//! Solves with loads at some dofs of which the solution is wanted at the same dofs alone.
//!
//! A front takes part if it or a front below it in the tree eliminates one of the dofs: all others would multiply zeros
//! on the way forward, and compute on the way back what nobody asks for. Vectors stay in the order of elimination
//! between both ways.

use super::lanes::{Lane, LANES};
use super::multifrontal::PartialCholesky;
use super::symbolic::{Front, Symbolic};

/// Some interior dofs of a factor, and the fronts that they reach.
#[derive(Debug, Clone)]
pub struct ReachedFronts {
    /// Place of each dof in the order of elimination.
    places: Vec<u32>,
    /// The fronts, in this order.
    fronts: Vec<u32>,
}

/// Vectors between the ways forward and back, in the order of elimination: one, or up to [`LANES`].
#[derive(Debug, Clone)]
pub enum Ordered {
    /// One vector.
    One(Vec<f64>),
    /// Several vectors side by side, and their number.
    Many(Vec<Lane>, usize),
}

impl Ordered {
    /// Number of vectors.
    pub fn columns(&self) -> usize {
        match self {
            Ordered::One(_) => 1,
            Ordered::Many(_, columns) => *columns,
        }
    }
}

impl PartialCholesky {
    /// The fronts that these interior dofs reach; see [`Symbolic::reached`].
    pub fn reached(&self, dofs: &[u32]) -> ReachedFronts {
        self.symbolic.reached(dofs)
    }

    fn fronts_of<'a>(
        &'a self,
        at: &'a ReachedFronts,
    ) -> impl DoubleEndedIterator<Item = &'a Front> {
        let fronts = &self.symbolic.fronts;
        at.fronts.iter().map(|&f| &fronts[f as usize])
    }

    /// `columns` vectors of zeros, at most [`LANES`].
    pub fn zeros(&self, columns: usize) -> Ordered {
        debug_assert!(columns <= LANES);
        match columns {
            1 => Ordered::One(vec![0.0; self.symbolic.n()]),
            _ => Ordered::Many(vec![[0.0; LANES]; self.symbolic.n()], columns),
        }
    }

    /// The way forward for at most [`LANES`] loads at the dofs of `at`.
    pub fn forward_at(&self, at: &ReachedFronts, loads: &[&[f64]]) -> Ordered {
        let mut out = self.zeros(loads.len());
        match &mut out {
            Ordered::One(y) => {
                let pairs = at.places.iter().zip(loads[0]);
                pairs.for_each(|(&p, v)| y[p as usize] = *v);
                self.lower_of(self.fronts_of(at), y);
            }
            Ordered::Many(y, _) => {
                for (c, load) in loads.iter().enumerate() {
                    let pairs = at.places.iter().zip(*load);
                    pairs.for_each(|(&p, v)| y[p as usize][c] = *v);
                }
                self.lower_of(self.fronts_of(at), y);
            }
        }
        out
    }

    /// The values of a column on the interface, in its order.
    pub fn on_interface(&self, x: &Ordered, column: usize) -> Vec<f64> {
        let n = self.symbolic.n_interior();
        match x {
            Ordered::One(x) => x[n..].to_vec(),
            Ordered::Many(x, _) => x[n..].iter().map(|x| x[column]).collect(),
        }
    }

    /// Gives a column these values on the interface.
    pub fn set_interface(&self, x: &mut Ordered, column: usize, values: &[f64]) {
        let n = self.symbolic.n_interior();
        match x {
            Ordered::One(x) => x[n..].copy_from_slice(values),
            Ordered::Many(x, _) => {
                let pairs = x[n..].iter_mut().zip(values);
                pairs.for_each(|(x, v)| x[column] = *v);
            }
        }
    }

    /// The way back: the solution at the dofs of `at`, for each column.
    pub fn backward_at(&self, at: &ReachedFronts, x: Ordered) -> Vec<Vec<f64>> {
        match x {
            Ordered::One(mut x) => {
                self.upper_of(self.fronts_of(at).rev(), &mut x);
                vec![at.places.iter().map(|&p| x[p as usize]).collect()]
            }
            Ordered::Many(mut x, columns) => {
                self.upper_of(self.fronts_of(at).rev(), &mut x);
                let column = |c: usize| at.places.iter().map(|&p| x[p as usize][c]).collect();
                (0..columns).map(column).collect()
            }
        }
    }

    /// K_II⁻¹ of at most [`LANES`] loads at the dofs of `at`, there.
    pub fn solve_at(&self, at: &ReachedFronts, loads: &[&[f64]]) -> Vec<Vec<f64>> {
        let mut x = self.forward_at(at, loads);
        let n = self.symbolic.n_interior();
        match &mut x {
            Ordered::One(x) => x[n..].fill(f64::default()),
            Ordered::Many(x, _) => x[n..].fill(Lane::default()),
        }
        self.backward_at(at, x)
    }
}

impl Symbolic {
    /// The fronts that these interior dofs reach.
    ///
    /// # Panics
    /// If one of them is on the interface.
    pub fn reached(&self, dofs: &[u32]) -> ReachedFronts {
        let mut place = vec![u32::MAX; self.n()];
        let interior = self.interior.iter().zip(0..);
        interior.for_each(|(&dof, p)| place[dof as usize] = p);
        let places: Vec<u32> = dofs.iter().map(|&dof| place[dof as usize]).collect();
        let fronts = &self.fronts;
        let of = |p: u32| fronts.partition_point(|f| f.end <= p as usize);
        let mut reached = vec![false; fronts.len()];
        places.iter().for_each(|&p| reached[of(p)] = true);
        // The parent of a front eliminates the first row below it, and comes after it.
        for (f, front) in fronts.iter().enumerate() {
            let parent = front.below.first().map(|&p| of(p));
            if let (true, Some(parent)) = (reached[f], parent.filter(|&p| p < fronts.len())) {
                reached[parent] = true;
            }
        }
        let fronts = (0..).zip(reached).filter(|f| f.1).map(|f| f.0).collect();
        ReachedFronts { places, fronts }
    }

    /// The structure of a factor of which only these fronts are stored, for solves that go through them.
    pub(crate) fn only(&self, at: &ReachedFronts) -> Symbolic {
        let fronts = self.fronts.iter().enumerate().map(|(f, front)| {
            match at.fronts.binary_search(&(f as u32)) {
                Ok(_) => (front.start, front.width(), front.below.clone()),
                Err(_) => (front.start, 0, Vec::new()),
            }
        });
        Symbolic::of_factor(self.interior.clone(), &self.interface, fronts)
    }
}

#[cfg(test)]
#[path = "../tests/reached.rs"]
mod tests;

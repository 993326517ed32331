//! The rows that may exert forces: each for itself, or those of a node with friction together.

use std::collections::HashSet;

use super::cone::{FrictionCone, NodeForce};
use crate::feti::jump::operator::Jump;

/// The rows that may exert forces, and in which sets.
pub struct Carriers<'a> {
    /// The owned rows that may hold.
    pub rows: Vec<usize>,
    /// Whether each of them is alone, not one of a node with friction.
    pub alone: Vec<bool>,
    /// The nodes with friction.
    pub cones: &'a [FrictionCone],
    /// The places of each node's rows among the rows.
    places: Vec<Vec<usize>>,
}

impl<'a> Carriers<'a> {
    /// The rows of `jump` that may hold, and those of the nodes `cones`.
    pub fn new(jump: &Jump, cones: &'a [FrictionCone]) -> Carriers<'a> {
        let in_cones: HashSet<usize> = cones.iter().flat_map(|c| &c.rows).copied().collect();
        let between = jump.rows_between_bodies();
        let rows = between.filter(|&i| jump.is_candidate(i) || in_cones.contains(&i));
        let rows: Vec<usize> = rows.collect();
        let place = |i: &usize| rows.binary_search(i).expect("rows of nodes may hold");
        Carriers {
            alone: rows.iter().map(|i| !in_cones.contains(i)).collect(),
            places: (cones.iter())
                .map(|cone| cone.rows.iter().map(place).collect())
                .collect(),
            rows,
            cones,
        }
    }

    /// The nodes with friction, with their values.
    pub fn nodes<'b>(
        &'b self,
        values: &'b [f64],
    ) -> impl Iterator<Item = (&'b FrictionCone, &'b [usize], NodeForce)> + 'b {
        self.cones.iter().zip(&self.places).map(|(cone, places)| {
            let mut at = [0.0; 3];
            for (v, &k) in at.iter_mut().zip(places) {
                *v = values[k];
            }
            (cone, &places[..], at)
        })
    }
}

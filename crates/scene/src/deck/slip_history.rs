//! How far the sides of contacts with friction have slid up to the end of a step of a deck: all that a step leaves to
//! the next one.

use std::collections::HashMap;

use crate::checked::Scene;
use crate::rows::laws::NodeFriction;
use base::linalg::vec3::dot;
use fetifeti::problem::{BodyNode, RowSource};
use fetifeti::solution::SolvedRow;

/// The two sides at a node: all steps of a deck have the same.
type Sides = (RowSource, [Option<BodyNode>; 2]);

/// The slip of each node with friction, on all ranks. Elastic slip is none: it springs back.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SlipHistory(HashMap<Sides, [f64; 3]>);

impl SlipHistory {
    /// Adds the slip of a step, by its scene and the tangential rows of all ranks.
    pub fn add(&mut self, scene: &Scene, tangential: &[SolvedRow]) {
        let nodes = scene.laws.iter().filter_map(|law| {
            let row = &scene.rows[law.normal];
            Some(((row.source, row.members), law.friction.as_ref()?))
        });
        let friction: HashMap<Sides, &NodeFriction> = nodes.collect();
        for row in tangential {
            let sides = (row.label.source, row.label.members);
            let Some(friction) = friction.get(&sides) else {
                continue;
            };
            let elastic = friction.compliance(row.label.area) * row.multiplier;
            let slid = self.0.entry(sides).or_default();
            for (slid, along) in slid.iter_mut().zip(row.normal()) {
                *slid -= (row.gap + elastic) * along;
            }
        }
    }

    /// Lets the friction of the next step of the same deck begin here.
    pub(super) fn enter(&self, scene: &mut Scene) {
        for law in &mut scene.laws {
            let row = &scene.rows[law.normal];
            let Some(slid) = self.0.get(&(row.source, row.members)) else {
                continue;
            };
            for row in law.friction.iter_mut().flat_map(|f| &mut f.tangential) {
                if let Some(bound) = &mut row.bound {
                    bound.value = dot(*slid, row.direction);
                }
            }
        }
    }
}

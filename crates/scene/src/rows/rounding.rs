//! How exactly the directions of rows are known: they follow from coordinates with as many digits as the file has.

use std::cell::OnceCell;

use super::row::Row;
use crate::checked::Scene;
use crate::geometry::facing::shortest;
use base::linalg::sorted::distinct;
use mesh::Mesh;

/// Units in the last place by which both ends of an edge may be off together, twice over: the normal of a node is a
/// mean of those of the faces around it.
const UNITS: f64 = 2.0;

/// The angle by which directions on each body may be off, in radians.
pub(super) struct Rounding<'a> {
    scene: &'a Scene,
    angles: Vec<OnceCell<f64>>,
}

impl<'a> Rounding<'a> {
    pub fn new(scene: &'a Scene) -> Rounding<'a> {
        Rounding {
            angles: vec![OnceCell::new(); scene.bodies.len()],
            scene,
        }
    }

    /// That of a row: of the bodies of its members. An equation has none; its coefficients have digits, too.
    pub fn of(&self, row: &Row) -> f64 {
        let members = row.members.iter().flatten();
        let terms = match &row.combination {
            Some(combination) if row.members[0].is_none() => combination,
            _ => return self.of_bodies(members.map(|m| m.body)),
        };
        let bodies = &self.scene.bodies;
        let body = |&(dof, _): &(u64, f64)| bodies.partition_point(|b| b.first_dof <= dof) - 1;
        let largest = terms.terms.iter().fold(0.0f64, |m, t| m.max(t.1.abs()));
        let of_factors = if largest > 0.0 {
            UNITS * terms.resolution / largest
        } else {
            0.0
        };
        of_factors + self.of_bodies(distinct(terms.terms.iter().map(body)).into_iter())
    }

    fn of_bodies(&self, bodies: impl Iterator<Item = usize>) -> f64 {
        bodies
            .map(|body| *self.angles[body].get_or_init(|| self.angle(body)))
            .sum()
    }

    /// The resolution of the coordinates of a body divided by its shortest edge; 0 for boxes.
    fn angle(&self, body: usize) -> f64 {
        let spec = &self.scene.bodies[body].spec;
        match &spec.mesh {
            Mesh::Cells(mesh) if mesh.resolution > 0.0 => UNITS * mesh.resolution / shortest(spec),
            _ => 0.0,
        }
    }
}

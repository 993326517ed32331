//! How exactly the directions of rows are known: they follow from coordinates with as many digits as the file has.

use std::cell::OnceCell;

use super::equations::Equation;
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

    /// That of a row between these bodies.
    pub fn of(&self, bodies: impl Iterator<Item = usize>) -> f64 {
        bodies
            .map(|body| *self.angles[body].get_or_init(|| self.angle(body)))
            .sum()
    }

    /// That of an equation: its coefficients have digits, too.
    pub fn of_equation(&self, equation: &Equation) -> f64 {
        let bodies = &self.scene.bodies;
        let body = |&(dof, _): &(u64, f64)| bodies.partition_point(|b| b.first_dof <= dof) - 1;
        let largest = equation.terms.iter().fold(0.0f64, |m, t| m.max(t.1.abs()));
        let of_factors = if largest > 0.0 {
            UNITS * equation.resolution / largest
        } else {
            0.0
        };
        of_factors + self.of(distinct(equation.terms.iter().map(body)).into_iter())
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

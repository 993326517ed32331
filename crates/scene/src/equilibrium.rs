//! The forces on a subdomain that hold each other in balance: loads, springs, and what holds it at given values.

use super::checked::Scene;
use super::model::steps::Factors;
use crate::assembly::{self, SubdomainMesh};
use base::linalg::vec3::{cross, minus, norm};
use base::Result;
use bytemuck::{Pod, Zeroable};

/// The resultant of forces at points.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
pub struct Wrench {
    /// Their sum.
    pub force: [f64; 3],
    /// The sum of their moments.
    pub moment: [f64; 3],
    /// The sum of their sizes.
    pub size: f64,
    /// The sum of the sizes of their moments.
    pub lever: f64,
}

impl Wrench {
    /// Adds a force that acts at `arm` from the centre of the moments.
    pub fn add(&mut self, arm: [f64; 3], force: [f64; 3]) {
        let moment = cross(arm, force);
        self.merge(&Wrench {
            force,
            moment,
            size: norm(force),
            lever: norm(moment),
        });
    }

    /// Adds other forces.
    pub fn merge(&mut self, other: &Wrench) {
        for d in 0..3 {
            self.force[d] += other.force[d];
            self.moment[d] += other.moment[d];
        }
        self.size += other.size;
        self.lever += other.lever;
    }
}

/// The forces on a subdomain, or on a body.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Forces {
    /// Its loads.
    pub load: Wrench,
    /// The forces of the springs that the subdomain or body stands on.
    pub springs: Wrench,
    /// K u at given values, less loads and springs there: the reactions, if no row acts there.
    pub held: Wrench,
    /// The sum of the sizes of the terms of K u there. Their rounding is that of the reactions.
    pub terms: f64,
    /// vᵀ K v, springs included, of the motions as a whole: along the components, then about them. At given values they
    /// are zero.
    pub resistance: [f64; 6],
}

impl Scene {
    /// The forces on subdomain `index` at load step `step` with displacements `u` of its free degrees of freedom, and
    /// their moments about `centre`.
    ///
    /// # Errors
    /// As [`Scene::loads`].
    pub fn forces(&self, index: usize, step: usize, u: &[f64], centre: [f64; 3]) -> Result<Forces> {
        let factors = Factors::of(&self.steps, step)?;
        let mesh = self.mesh_with(index, factors)?;
        let load = self.nodal_load(&mesh, factors)?;
        let c = self.components();
        let single = |k: usize, value: f64| {
            let mut force = [0.0; 3];
            force[k % c] = value;
            force
        };
        let vector = |node: usize, of: &dyn Fn(usize) -> f64| -> [f64; 3] {
            std::array::from_fn(|d| if d < c { of(c * node + d) } else { 0.0 })
        };
        let arms: Vec<[f64; 3]> = mesh.points.iter().map(|x| minus(*x, centre)).collect();
        let mut out = Forces::default();
        for (node, arm) in arms.iter().enumerate() {
            out.load.add(*arm, vector(node, &|k| load[k]));
        }
        let nodal = mesh.nodal(u);
        let spring = |k: usize| -mesh.spring.get(k / c).copied().unwrap_or(0.0) * nodal[k];
        if !mesh.spring.is_empty() {
            for (node, arm) in arms.iter().enumerate() {
                out.springs.add(*arm, vector(node, &spring));
            }
        }
        let motions = self.motions(&arms);
        let given = |k: usize| mesh.dof[k] == SubdomainMesh::PRESCRIBED;
        // A motion of all degrees of freedom costs nothing: what it costs to leave some out is their own energy.
        let left_out = motions.iter().map(|v| {
            let value = |(k, v): (usize, &f64)| if given(k) { *v } else { 0.0 };
            v.iter().enumerate().map(value).collect()
        });
        let left_out: Vec<Vec<f64>> = left_out.collect();
        let held = assembly::force_at_given(&mesh, &nodal, &left_out);
        out.terms = held.terms;
        for (m, (v, energy)) in motions.iter().zip(held.energies).enumerate() {
            let springs = mesh.spring.iter().enumerate();
            let squares = springs.map(|(node, spring)| {
                let free = (c * node..c * (node + 1)).filter(|&k| !given(k));
                spring * free.map(|k| v[k] * v[k]).sum::<f64>()
            });
            out.resistance[m] = energy + squares.sum::<f64>();
        }
        for (k, force) in held.force {
            out.held
                .add(arms[k / c], single(k, force - load[k] - spring(k)));
        }
        Ok(out)
    }

    /// The motions of nodes as a whole: along the components, and in elasticity turns. Rings move along their axis
    /// alone, but all of them are there.
    fn motions(&self, arms: &[[f64; 3]]) -> Vec<Vec<f64>> {
        let c = self.components();
        let along = |d: usize, i: usize| f64::from(i == d);
        let turn = |d: usize, arm: [f64; 3], i: usize| {
            let mut axis = [0.0; 3];
            axis[d] = 1.0;
            cross(axis, arm)[i]
        };
        let turns = match c {
            1 => 0..0,
            2 => 2..3,
            _ => 0..3,
        };
        let each = |of: &dyn Fn([f64; 3], usize) -> f64| -> Vec<f64> {
            arms.iter()
                .flat_map(|arm| (0..c).map(|i| of(*arm, i)))
                .collect()
        };
        let straight = (0..c).map(|d| each(&|_, i| along(d, i)));
        let turned = turns.map(|d| each(&|arm, i| turn(d, arm, i)));
        straight.chain(turned).collect()
    }
}

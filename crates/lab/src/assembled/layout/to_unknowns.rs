//! From displacements u to the unknowns w.

use super::UnknownLayout;
use base::Result;
use parallel::exchange::sum_all;
use petsc::{Session, Vec as PetscVec};

impl UnknownLayout<'_> {
    /// Converts u, found by a method without supports and frames, to w: subtracts the rigid motions that the supports
    /// exclude, leaves out what equations determine, and changes to the coordinates of the frames. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn to_unknowns(&self, session: &Session, u: &PetscVec) -> Result<()> {
        let range = u.ownership_range();
        let c = self.components;
        if !self.supports.is_empty() {
            let mut values = vec![0.0; self.supports.len()];
            {
                let u = u.array()?;
                for (value, (at, _)) in values.iter_mut().zip(&self.supports) {
                    if range.contains(&(*at as usize)) {
                        *value = u[*at as usize - range.start];
                    }
                }
            }
            sum_all(session.comm(), &mut values);
            let mut equations = self.all_held.clone();
            for ((_, form), value) in self.supports.iter().zip(&values) {
                equations.insert(form, *value);
            }
            let alpha = equations.solve(self.motions.len());
            let mut u = u.array_mut()?;
            for i in range.clone() {
                if self.filled.binary_search(&(i as u64)).is_ok() {
                    continue;
                }
                let (body, node) = self.node((i / c) as u64);
                let x = self.scene.bodies[body].spec.position(node);
                let form = self.motions.form(body, x, i % c);
                u[i - range.start] -= form.iter().map(|&(k, v)| v * alpha[k]).sum::<f64>();
            }
        }
        let bounded = self.jumps(session, u)?;
        let mut u = u.array_mut()?;
        for place in self.eliminated.places() {
            let place = place as usize;
            if range.contains(&place) {
                u[place - range.start] = 0.0;
            }
        }
        for (&block, frame) in &self.frames {
            let first = block as usize * c;
            if range.contains(&first) {
                let at = first - range.start;
                let old: Vec<f64> = u[at..at + c].to_vec();
                for k in 0..c {
                    u[at + k] = (0..c).map(|j| frame.to[k][j] * old[j]).sum();
                }
            }
        }
        for (place, w) in bounded {
            let place = place as usize;
            if range.contains(&place) {
                u[place - range.start] = w;
            }
        }
        Ok(())
    }
}

//! The jumps of displacements that the subdomains have, and how far rows give way.

use super::stiffness::Stiffness;
use super::work::InterfaceBuffers;
use crate::substructures::Problem;
use crate::Result;
use petsc::Vec as PetscVec;

impl Stiffness {
    /// out ← B y, with the displacements y in `work`. Collective.
    pub fn jump_of(&self, work: &[InterfaceBuffers], out: &PetscVec) -> Result<()> {
        let mut sum = vec![0.0; self.jump.ghosts.len()];
        for (w, columns) in work.iter().zip(self.jump.columns.iter()) {
            columns.add_b(&w.y, &mut sum);
        }
        self.dual_halo.sum(&sum, out)
    }

    /// out ← B y with all rows of B_gl, including those that do not hold. Collective.
    pub fn jump_of_all(&self, work: &[InterfaceBuffers], out: &PetscVec) -> Result<()> {
        let mut sum = vec![0.0; self.jump.ghosts.len()];
        for (w, columns) in work.iter().zip(self.jump.columns.iter()) {
            columns.add_b(&w.y, &mut sum);
        }
        for (s, contact) in sum.iter_mut().zip(&self.jump.ghost_is_contact) {
            *s = if *contact { 0.0 } else { *s };
        }
        for (w, columns) in work.iter().zip(self.jump.columns.iter()) {
            columns.add_contact(&w.y, &mut sum);
        }
        self.dual_halo.sum(&sum, out)
    }

    /// B u on the owned rows of B_gl, for displacements of each local subdomain by local dof. Collective.
    pub fn jumps_of(&self, u: &[Vec<f64>]) -> Result<Vec<f64>> {
        let mut work = self.work();
        for (j, w) in work.iter_mut().enumerate() {
            let interface = &self.locals[j].gamma().interface;
            let at = interface.iter().map(|&i| u[j][i as usize]);
            w.y.iter_mut().zip(at).for_each(|(y, u)| *y = u);
        }
        let out = PetscVec::mpi(&self.session, self.jump.n_owned)?;
        self.jump_of_all(&work, &out)?;
        out.to_vec()
    }

    /// diag(B diag(K)⁻¹ Bᵀ) on the owned rows of B_gl, whether or not they hold, and zero on the others: by how much a
    /// row opens under a unit force if the nodes give way alone. Collective.
    pub fn compliance_of_rows(&self, problem: &Problem) -> Result<Vec<f64>> {
        let mut ghost = vec![0.0; self.jump.ghosts.len()];
        for (j, columns) in self.jump.columns.iter().enumerate() {
            let (k, interface) = (&problem.local[j].k, &self.locals[j].gamma().interface);
            for &(place, full) in columns.contact {
                let place = place as usize;
                let dof = interface[columns.at[place] as usize] as usize;
                ghost[columns.row[place] as usize] += full * full / k.get(dof, dof);
            }
        }
        let out = PetscVec::mpi(&self.session, self.jump.n_owned)?;
        self.dual_halo.sum(&ghost, &out)?;
        out.to_vec()
    }
}

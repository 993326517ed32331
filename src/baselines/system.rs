//! A u = b of a scene as PETSc's solvers take it: one unknown where tied bodies have several copies.

use crate::mesh::contiguous_share;
use crate::petsc::{Comm, Mat, MatFlag, Scatter, Session, Vec as PetscVec};
use crate::scene::{Numbering, Scene};
use crate::substructures::Subdomain;
use crate::Result;

use super::table::Format;

/// The assembled problem; N is the number of unknowns of [`Numbering`].
pub struct System {
    /// A, N × N, symmetric positive definite.
    pub a: Mat,
    /// b, length N.
    pub b: PetscVec,
    norm_b: f64,
}

impl System {
    /// Assembles the scene. Each rank holds a contiguous share of the subdomains, merged into one local matrix;
    /// the assembled format follows from the unassembled one. Collective.
    ///
    /// # Errors
    /// As [`Scene::subdomain`], and PETSc's.
    pub fn new(
        session: &Session,
        scene: &Scene,
        numbering: &Numbering,
        format: Format,
    ) -> Result<System> {
        let (ranks, rank) = (session.size(), session.rank());
        let share = contiguous_share(scene.n_subdomains(), ranks, rank);
        let mine: Result<Vec<Subdomain>> = share.clone().map(|s| scene.subdomain(s)).collect();
        let mine = session.agree(mine)?;
        let part = Part::new(session, &mine, numbering)?;
        drop(mine);
        let owned = match format {
            Format::Assembled => contiguous_share(numbering.len() as usize, ranks, rank),
            Format::Unassembled => {
                let range = numbering.range(share);
                range.start as usize..range.end as usize
            }
        };
        let b = PetscVec::mpi(session, owned.len())?;
        Scatter::new(&b, &part.unknowns, &part.f)?.reverse_add(&part.f, &b)?;
        let unassembled = Mat::unassembled(session, owned.len(), &part.unknowns, &part.k)?;
        drop(part);
        let a = match format {
            Format::Assembled => unassembled.convert("aij")?,
            Format::Unassembled => unassembled,
        };
        a.set_flag(MatFlag::Spd)?;
        let norm_b = b.norm2()?;
        Ok(System { a, b, norm_b })
    }

    /// r ← b − A u.
    ///
    /// # Errors
    /// PETSc's.
    pub fn residual(&self, u: &PetscVec, r: &PetscVec) -> Result<()> {
        self.a.mult(u, r)?;
        r.aypx(-1.0, &self.b)
    }

    /// ‖b − A u‖₂ / ‖b‖₂ (‖A u‖₂ where b = 0). Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn relative_residual(&self, u: &PetscVec) -> Result<f64> {
        let r = u.duplicate()?;
        self.residual(u, &r)?;
        let norm = r.norm2()?;
        Ok(if self.norm_b > 0.0 {
            norm / self.norm_b
        } else {
            norm
        })
    }

    /// √(uᵀ A u). Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn energy_norm(&self, u: &PetscVec) -> Result<f64> {
        let au = u.duplicate()?;
        self.a.mult(u, &au)?;
        Ok(u.dot(&au)?.max(0.0).sqrt())
    }

    /// The assembled form of subdomain vectors whose copies may differ by what the iteration has left: at each unknown the
    /// mean of the copies with weight ρ, as the method's own scaling has it. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn mean(
        &self,
        session: &Session,
        subdomains: &[Subdomain],
        u: &[Vec<f64>],
        numbering: &Numbering,
    ) -> Result<PetscVec> {
        let unknowns: Vec<i32> = subdomains
            .iter()
            .flat_map(|s| &s.dofs)
            .map(|&dof| numbering.global(dof) as i32)
            .collect();
        let rho: Vec<f64> = subdomains
            .iter()
            .flat_map(|s| s.rho.iter().copied())
            .collect();
        let weighted: Vec<f64> = u.iter().flatten().zip(&rho).map(|(u, w)| u * w).collect();
        let (sum, weight) = (self.b.duplicate()?, self.b.duplicate()?);
        let local = PetscVec::from_slice(session, &weighted)?;
        let scatter = Scatter::new(&sum, &unknowns, &local)?;
        scatter.reverse_add(&local, &sum)?;
        scatter.reverse_add(&PetscVec::from_slice(session, &rho)?, &weight)?;
        let mean = self.b.duplicate()?;
        mean.pointwise_divide(&sum, &weight)?;
        Ok(mean)
    }
}

/// The subdomains of one rank, merged: what a domain decomposition of PETSc sees as one subdomain.
struct Part {
    /// Global unknown of each local one, increasing.
    unknowns: Vec<i32>,
    k: Mat,
    f: PetscVec,
}

impl Part {
    fn new(session: &Session, subdomains: &[Subdomain], numbering: &Numbering) -> Result<Part> {
        let global = |s: &Subdomain| -> Vec<i32> {
            s.dofs
                .iter()
                .map(|&dof| numbering.global(dof) as i32)
                .collect()
        };
        let mut unknowns: Vec<i32> = subdomains.iter().flat_map(global).collect();
        unknowns.sort_unstable();
        unknowns.dedup();
        let local = |s: &Subdomain| -> Vec<i32> {
            let place = |g| {
                unknowns
                    .binary_search(&g)
                    .expect("every unknown was listed") as i32
            };
            global(s).into_iter().map(place).collect()
        };
        let n = unknowns.len();
        let mut room = vec![0; n];
        for s in subdomains {
            for (i, row) in local(s).into_iter().enumerate() {
                room[row as usize] += s.k.row(i).0.len() as i32;
            }
        }
        room.iter_mut().for_each(|r| *r = (*r).min(n as i32));
        let k = Mat::preallocated(session, Comm::Own, n, n, &room, &[])?;
        let mut f = vec![0.0; n];
        for s in subdomains {
            let local = local(s);
            for (i, &row) in local.iter().enumerate() {
                let (col, val) = s.k.row(i);
                let col: Vec<i32> = col.iter().map(|&j| local[j as usize]).collect();
                k.add_values(&[row], &col, val)?;
                f[row as usize] += s.f[i];
            }
        }
        k.assemble()?;
        k.set_flag(MatFlag::Symmetric)?;
        let f = PetscVec::from_slice(session, &f)?;
        Ok(Part { unknowns, k, f })
    }
}

//! A u = b of a scene as PETSc's solvers take it: one unknown where tied bodies have several copies.
//!
//! With inequalities A is K without them, which bodies that only contact holds make singular; or, on the unknowns of an active set,
//! Tᵀ K T v = Tᵀ(f − K u₀).

use crate::mesh::contiguous_share;
use crate::petsc::{Comm, Mat, MatFlag, Scatter, Session, Vec as PetscVec};
use crate::scene::Scene;
use crate::substructures::Subdomain;
use crate::Result;

use super::table::Format;
use super::unknowns::Unknowns;

/// The assembled problem on N unknowns.
pub struct System {
    /// A, N × N, symmetric positive definite unless bodies are held by inequalities only.
    pub a: Mat,
    /// b, length N.
    pub b: PetscVec,
    /// ‖f‖₂ over the unknowns of the scene, or ‖b‖₂ where that is zero: what residuals are relative to.
    pub reference: f64,
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
        unknowns: &Unknowns,
        format: Format,
    ) -> Result<System> {
        let (ranks, rank) = (session.size(), session.rank());
        let share = contiguous_share(scene.n_subdomains(), ranks, rank);
        let mine: Result<Vec<Subdomain>> = share.clone().map(|s| scene.subdomain(s)).collect();
        let mine = session.agree(mine)?;
        let part = Part::new(session, &mine, unknowns)?;
        let owned = match format {
            Format::Assembled => contiguous_share(unknowns.len(), ranks, rank),
            Format::Unassembled => unknowns.range(share),
        };
        let b = PetscVec::mpi(session, owned.len())?;
        Scatter::new(&b, &part.unknowns, &part.f)?.reverse_add(&part.f, &b)?;
        let mut reference = match unknowns.are_all() {
            true => b.norm2()?,
            false => norm_f(session, &mine, unknowns)?,
        };
        if reference == 0.0 {
            reference = b.norm2()?;
        }
        drop(mine);
        let unassembled = Mat::unassembled(session, owned.len(), &part.unknowns, &part.k)?;
        drop(part);
        let a = match format {
            Format::Assembled => unassembled.convert("aij")?,
            Format::Unassembled => unassembled,
        };
        let held = unknowns.are_all() && scene.has_contact();
        a.set_flag(if held {
            MatFlag::Symmetric
        } else {
            MatFlag::Spd
        })?;
        Ok(System { a, b, reference })
    }

    /// r ← b − A u.
    ///
    /// # Errors
    /// PETSc's.
    pub fn residual(&self, u: &PetscVec, r: &PetscVec) -> Result<()> {
        self.a.mult(u, r)?;
        r.aypx(-1.0, &self.b)
    }

    /// ‖b − A u‖₂ / ‖f‖₂ (‖A u‖₂ where all is zero). Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn relative_residual(&self, u: &PetscVec) -> Result<f64> {
        let r = u.duplicate()?;
        self.residual(u, &r)?;
        Ok(self.relative(r.norm2()?))
    }

    /// `norm` relative to the load.
    pub fn relative(&self, norm: f64) -> f64 {
        match self.reference {
            reference if reference > 0.0 => norm / reference,
            _ => norm,
        }
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

    /// The assembled form of subdomain vectors whose copies may differ by what the iteration has left: at each unknown of the scene the
    /// mean of the copies with weight ρ, as the method's own scaling has it; and the sum of the weights. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn mean(
        &self,
        session: &Session,
        subdomains: &[Subdomain],
        u: &[Vec<f64>],
        unknowns: &Unknowns,
    ) -> Result<(PetscVec, PetscVec)> {
        let places = places(subdomains, unknowns);
        let rho: Vec<f64> = subdomains
            .iter()
            .flat_map(|s| s.rho.iter().copied())
            .collect();
        let weighted: Vec<f64> = u.iter().flatten().zip(&rho).map(|(u, w)| u * w).collect();
        let (sum, weight) = (self.b.duplicate()?, self.b.duplicate()?);
        let local = PetscVec::from_slice(session, &weighted)?;
        let scatter = Scatter::new(&sum, &places, &local)?;
        scatter.reverse_add(&local, &sum)?;
        scatter.reverse_add(&PetscVec::from_slice(session, &rho)?, &weight)?;
        let mean = self.b.duplicate()?;
        mean.pointwise_divide(&sum, &weight)?;
        Ok((mean, weight))
    }
}

/// The unknown of the scene at every dof of the subdomains.
fn places(subdomains: &[Subdomain], unknowns: &Unknowns) -> Vec<i32> {
    let dofs = subdomains.iter().flat_map(|s| &s.dofs);
    dofs.map(|&dof| unknowns.numbering.global(dof) as i32)
        .collect()
}

/// ‖f‖₂ over the unknowns of the scene. Collective.
fn norm_f(session: &Session, subdomains: &[Subdomain], unknowns: &Unknowns) -> Result<f64> {
    let n = unknowns.numbering.len() as usize;
    let share = contiguous_share(n, session.size(), session.rank());
    let f = PetscVec::mpi(session, share.len())?;
    let local: Vec<f64> = subdomains.iter().flat_map(|s| s.f.clone()).collect();
    let local = PetscVec::from_slice(session, &local)?;
    Scatter::new(&f, &places(subdomains, unknowns), &local)?.reverse_add(&local, &f)?;
    f.norm2()
}

/// The subdomains of one rank, merged: what a domain decomposition of PETSc sees as one subdomain.
struct Part {
    /// Global unknown of each local one, increasing.
    unknowns: Vec<i32>,
    k: Mat,
    f: PetscVec,
}

impl Part {
    fn new(session: &Session, subdomains: &[Subdomain], all: &Unknowns) -> Result<Part> {
        let mut unknowns: Vec<i32> = Vec::new();
        for s in subdomains {
            unknowns.extend(
                s.dofs
                    .iter()
                    .filter_map(|&dof| all.place(dof).0)
                    .map(|g| g as i32),
            );
        }
        unknowns.sort_unstable();
        unknowns.dedup();
        // Local unknown and offset of each dof.
        let local = |s: &Subdomain| -> Vec<(Option<i32>, f64)> {
            let find = |g: u64| {
                let found = unknowns.binary_search(&(g as i32));
                found.expect("every unknown was listed") as i32
            };
            let places = s.dofs.iter().map(|&dof| all.place(dof));
            places.map(|(lead, o)| (lead.map(find), o)).collect()
        };
        let n = unknowns.len();
        let mut room = vec![0; n];
        for s in subdomains {
            for (i, (row, _)) in local(s).into_iter().enumerate() {
                if let Some(row) = row {
                    room[row as usize] += s.k.row(i).0.len() as i32;
                }
            }
        }
        room.iter_mut().for_each(|r| *r = (*r).min(n as i32));
        let k = Mat::preallocated(session, Comm::Own, n, n, &room, &[])?;
        let mut f = vec![0.0; n];
        for s in subdomains {
            let local = local(s);
            for (i, &(row, _)) in local.iter().enumerate() {
                let Some(row) = row else { continue };
                let mut cols = Vec::new();
                let mut vals = Vec::new();
                f[row as usize] += s.f[i];
                let (col, val) = s.k.row(i);
                for (&j, &v) in col.iter().zip(val) {
                    let (col, offset) = local[j as usize];
                    f[row as usize] -= v * offset;
                    if let Some(col) = col {
                        cols.push(col);
                        vals.push(v);
                    }
                }
                k.add_values(&[row], &cols, &vals)?;
            }
        }
        k.assemble()?;
        k.set_flag(MatFlag::Symmetric)?;
        let f = PetscVec::from_slice(session, &f)?;
        Ok(Part { unknowns, k, f })
    }
}

//! A u = b of a scene for PETSc's solvers: one unknown in the place of the copies of tied bodies.
//!
//! With inequalities, A is K without them; it is singular where only contact holds a body. On the unknowns of an active
//! set the system is Tᵀ K T v = Tᵀ(f − K u₀).

use base::Result;
use fetifeti::Subdomain;
use parallel::contiguous_share;
use petsc::{Comm, Mat, MatFlag, PetscInt, Scatter, Session, Vec as PetscVec};
use scene::Scene;

use super::layout::UnknownLayout;
use super::unknowns::Unknowns;

/// The format of the matrix that a method takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MatrixFormat {
    /// One assembled matrix (AIJ), rows in equal shares.
    Assembled,
    /// One matrix per part of the domain, unassembled (MATIS); a part is what a rank has.
    Unassembled,
    /// Unassembled with a part per subdomain, as many on a rank as there are (MatISSetAllowRepeated).
    Separate,
}

/// The weights in the mean of the copies of an unknown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Copies {
    /// By ρ, as in the method's own scaling.
    ByCoefficient,
    /// All equal.
    Alike,
}

/// The assembled problem on N unknowns.
pub struct AssembledSystem {
    /// A, N × N, symmetric positive definite unless bodies are held by inequalities only.
    pub a: Mat,
    /// b, length N.
    pub b: PetscVec,
    /// ‖f‖₂ over the unknowns of the scene, or ‖b‖₂ where that is zero: residuals are relative to it.
    pub reference: f64,
    /// The local unknowns of this rank in the unassembled format.
    pub local: LocalUnknowns,
}

/// The local unknowns of a rank, part after part: each has all arrays at its place.
#[derive(Debug, Default)]
pub struct LocalUnknowns {
    /// The global unknown, increasing in each part.
    pub unknowns: Vec<PetscInt>,
    /// Its component.
    pub fields: Vec<usize>,
    /// Its node in the layout.
    pub nodes: Vec<u64>,
    /// Where parts begin, and where the last one ends.
    pub starts: Vec<usize>,
}

impl AssembledSystem {
    /// Assembles the scene. Each rank holds a contiguous share of the subdomains, merged into one local matrix unless
    /// they are to be separate; the assembled format is converted from the unassembled one. Collective.
    ///
    /// # Errors
    /// As [`Scene::subdomain`], and PETSc's.
    pub fn new(
        session: &Session,
        scene: &Scene,
        unknowns: &Unknowns,
        format: MatrixFormat,
    ) -> Result<AssembledSystem> {
        let mine = subdomains(session, scene)?;
        let separate = format == MatrixFormat::Separate;
        let part = RankMatrix::new(session, &mine, unknowns, separate)?;
        let (b, reference) = part.load(session, &mine, unknowns, format)?;
        drop(mine);
        let n = b.ownership_range().len();
        let (places, k) = (&part.local.unknowns, &part.k);
        let unassembled = Mat::unassembled(session, n, places, k, separate)?;
        let local = part.local;
        let a = match format {
            MatrixFormat::Assembled => unassembled.convert("aij")?,
            MatrixFormat::Unassembled | MatrixFormat::Separate => unassembled,
        };
        let held = unknowns.are_free() && scene.has_contact();
        a.set_flag(if held {
            MatFlag::Symmetric
        } else {
            MatFlag::Spd
        })?;
        Ok(AssembledSystem {
            a,
            b,
            reference,
            local,
        })
    }

    /// Replaces the load, and the norm that residuals are relative to. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn set_load(&mut self, b: &PetscVec, reference: f64) -> Result<()> {
        self.reference = reference;
        self.b.copy_from(b)
    }

    /// r ← b − A u.
    ///
    /// # Errors
    /// PETSc's.
    pub fn residual(&self, u: &PetscVec, r: &PetscVec) -> Result<()> {
        self.a.mult(u, r)?;
        r.aypx(-1.0, &self.b)
    }

    /// ‖b − A u‖₂ / ‖f‖₂; relative to ‖A u‖₂ where f and b are zero. Collective.
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

    /// Assembles subdomain vectors whose copies may differ by the error of the iteration: at each unknown of the scene
    /// the weighted mean of the copies, converted to w; and the sum of the weights. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn mean(
        &self,
        session: &Session,
        subdomains: &[Subdomain],
        u: &[Vec<f64>],
        unknowns: &Unknowns,
        copies: Copies,
    ) -> Result<(PetscVec, PetscVec)> {
        let places = places(subdomains, unknowns.layout);
        let each = subdomains.iter().flat_map(|s| &s.rho);
        let weights: Vec<f64> = match copies {
            Copies::ByCoefficient => each.copied().collect(),
            Copies::Alike => each.map(|_| 1.0).collect(),
        };
        let weighted = u.iter().flatten().zip(&weights);
        let weighted: Vec<f64> = weighted.map(|(u, w)| u * w).collect();
        let (sum, weight) = (self.b.duplicate()?, self.b.duplicate()?);
        let local = PetscVec::from_slice(session, &weighted)?;
        let scatter = Scatter::new(&sum, &places, &local)?;
        scatter.reverse_add(&local, &sum)?;
        scatter.reverse_add(&PetscVec::from_slice(session, &weights)?, &weight)?;
        let mean = self.b.duplicate()?;
        mean.pointwise_divide(&sum, &weight)?;
        unknowns.layout.to_unknowns(session, &mean)?;
        Ok((mean, weight))
    }
}

/// This rank's contiguous share of the subdomains.
fn subdomains(session: &Session, scene: &Scene) -> Result<Vec<Subdomain>> {
    let share = contiguous_share(scene.n_subdomains(), session.size(), session.rank());
    session.agree(share.map(|s| scene.subdomain(s)).collect())
}

/// The load of a scene on the unknowns, and the norm that residuals are relative to: as in an [`AssembledSystem`] of
/// this format, without its matrix. Collective.
///
/// # Errors
/// As [`Scene::subdomain`], and PETSc's.
pub fn load(
    session: &Session,
    scene: &Scene,
    unknowns: &Unknowns,
    format: MatrixFormat,
) -> Result<(PetscVec, f64)> {
    let mine = subdomains(session, scene)?;
    let part = RankMatrix::new(session, &mine, unknowns, format == MatrixFormat::Separate)?;
    part.load(session, &mine, unknowns, format)
}

/// The place in the layout of every dof of the subdomains.
fn places(subdomains: &[Subdomain], layout: &UnknownLayout) -> Vec<PetscInt> {
    let dofs = subdomains.iter().flat_map(|s| &s.dofs);
    dofs.map(|&dof| layout.index(dof) as PetscInt).collect()
}

/// ‖f‖₂ over the components of u. Collective.
fn norm_f(session: &Session, subdomains: &[Subdomain], layout: &UnknownLayout) -> Result<f64> {
    let share = layout.share(session.size(), session.rank());
    let f = PetscVec::mpi(session, share.len())?;
    let local: Vec<f64> = subdomains.iter().flat_map(|s| s.f.clone()).collect();
    let local = PetscVec::from_slice(session, &local)?;
    Scatter::new(&f, &places(subdomains, layout), &local)?.reverse_add(&local, &f)?;
    f.norm2()
}

/// The subdomains of one rank as PETSc's domain decompositions take them: merged into one, or one after the other.
struct RankMatrix {
    local: LocalUnknowns,
    k: Mat,
    f: PetscVec,
}

/// u at the dofs of a subdomain in terms of local unknowns: (unknown, coefficient) pairs and an offset.
type RankRows = Vec<(Vec<(PetscInt, f64)>, f64)>;

impl RankMatrix {
    /// The load of all ranks, and the norm that residuals are relative to; `mine` are the subdomains of this one.
    /// Collective.
    fn load(
        &self,
        session: &Session,
        mine: &[Subdomain],
        unknowns: &Unknowns,
        format: MatrixFormat,
    ) -> Result<(PetscVec, f64)> {
        let (ranks, rank) = (session.size(), session.rank());
        let all = unknowns.layout.scene().n_subdomains();
        let owned = match format {
            MatrixFormat::Assembled => unknowns.share(ranks, rank),
            MatrixFormat::Unassembled | MatrixFormat::Separate => {
                unknowns.range(contiguous_share(all, ranks, rank))
            }
        };
        let b = PetscVec::mpi(session, owned.len())?;
        Scatter::new(&b, &self.local.unknowns, &self.f)?.reverse_add(&self.f, &b)?;
        let plain = unknowns.are_all() && !unknowns.layout.has_dependent();
        let mut reference = match plain {
            true => b.norm2()?,
            false => norm_f(session, mine, unknowns.layout)?,
        };
        if reference == 0.0 {
            reference = b.norm2()?;
        }
        Ok((b, reference))
    }

    fn new(
        session: &Session,
        subdomains: &[Subdomain],
        all: &Unknowns,
        separate: bool,
    ) -> Result<RankMatrix> {
        let size = if separate { 1 } else { subdomains.len().max(1) };
        let mut unknowns: Vec<PetscInt> = Vec::new();
        let mut starts = vec![0];
        for part in subdomains.chunks(size) {
            let mut own: Vec<PetscInt> = Vec::new();
            for &dof in part.iter().flat_map(|s| &s.dofs) {
                own.extend(all.terms(dof).0.iter().map(|t| t.0 as PetscInt));
                own.extend(all.void_beside(dof).0.iter().map(|&v| v as PetscInt));
            }
            own.sort_unstable();
            own.dedup();
            unknowns.extend(own);
            starts.push(unknowns.len());
        }
        let find = |s: usize, g: u64| {
            let first = starts[s / size];
            let found = unknowns[first..starts[s / size + 1]].binary_search(&(g as PetscInt));
            (first + found.expect("every unknown was listed")) as PetscInt
        };
        let local = |k: usize, s: &Subdomain| -> RankRows {
            let terms = s.dofs.iter().map(|&dof| all.terms(dof));
            let found = |list: Vec<(u64, f64)>| list.into_iter().map(|(g, c)| (find(k, g), c));
            terms.map(|(list, o)| (found(list).collect(), o)).collect()
        };
        let n = unknowns.len();
        let mut room = vec![1; n];
        for (number, s) in subdomains.iter().enumerate() {
            let local = local(number, s);
            for (i, (rows, _)) in local.iter().enumerate() {
                let cols = s.k.row(i).0.iter().map(|&j| local[j as usize].0.len());
                let most = cols.sum::<usize>() as PetscInt;
                rows.iter().for_each(|(row, _)| room[*row as usize] += most);
            }
        }
        room.iter_mut().for_each(|r| *r = (*r).min(n as PetscInt));
        let k = Mat::preallocated(session, Comm::Own, n, n, &room, &[])?;
        let mut f = vec![0.0; n];
        let (mut cols, mut vals) = (Vec::new(), Vec::new());
        for (number, s) in subdomains.iter().enumerate() {
            let local = local(number, s);
            for (i, (rows, _)) in local.iter().enumerate() {
                let (col, val) = s.k.row(i);
                let entries = || col.iter().zip(val).map(|(&j, &v)| (&local[j as usize], v));
                let given: f64 = entries().map(|((_, offset), v)| v * offset).sum();
                for (row, weight) in rows {
                    f[*row as usize] += weight * (s.f[i] - given);
                    cols.clear();
                    vals.clear();
                    for ((terms, _), v) in entries() {
                        cols.extend(terms.iter().map(|t| t.0));
                        vals.extend(terms.iter().map(|t| weight * v * t.1));
                    }
                    k.add_values(&[*row], &cols, &vals)?;
                }
                // The diagonal entries of void places are of the size of those of the same node.
                let (void, itself) = all.void_beside(s.dofs[i]);
                let diagonal = || entries_at(col, val, i);
                // One without a dof of its own takes those of all others, also where these are void.
                let own = all.layout.index(s.dofs[i]);
                let takes = |v: u64| !itself || v == own || all.layout.is_inserted(v);
                for &v in void.iter().filter(|v| takes(**v)) {
                    let place = [find(number, v)];
                    k.add_values(&place, &place, &[diagonal()])?;
                }
            }
        }
        k.assemble()?;
        k.set_flag(MatFlag::Symmetric)?;
        let f = PetscVec::from_slice(session, &f)?;
        let components = all.layout.components();
        let (first, last) = (unknowns.iter().min(), unknowns.iter().max());
        let range = first.map_or(0, |g| *g as usize)..last.map_or(0, |g| *g as usize + 1);
        let places = all.places(range.clone());
        let place = |g: &PetscInt| places[*g as usize - range.start] as usize;
        let local = LocalUnknowns {
            fields: unknowns.iter().map(|g| place(g) % components).collect(),
            nodes: unknowns
                .iter()
                .map(|g| (place(g) / components) as u64)
                .collect(),
            unknowns,
            starts,
        };
        Ok(RankMatrix { local, k, f })
    }
}

/// The entry in column `i` of a row.
fn entries_at(col: &[u32], val: &[f64], i: usize) -> f64 {
    let at = col.iter().position(|&j| j as usize == i);
    at.map_or(0.0, |k| val[k])
}

//! The weight Q of the projector: which one is taken, and Q G.

use mpi::topology::SimpleCommunicator;

use super::gram::FEW;
use super::natural::NaturalCoarse;
use super::rows::KernelRows;
use super::sweep;
use crate::feti::cost::variation::JUMPS;
use crate::feti::operators::preconditioner::DualPreconditioner;
use crate::feti::operators::stiffness::Stiffness;
use crate::feti::settings::ProjectorKind;
use crate::substructures::Problem;
use crate::Result;
use parallel::exchange::{any, sum_all};
use petsc::Vec as PetscVec;

/// Bodies that differ in stiffness by more than this are too far apart for all rows of M⁻¹: P would magnify rounding by
/// the ratio. Up to it Q is M⁻¹ itself.
pub(super) const APART: f64 = 1e7;

/// Resolves `Auto`: Q = M⁻¹ where bodies differ in stiffness by the ratio `spread`, or coefficients jump inside them;
/// its diagonal where rows `switch` between many bodies that slide on each other. It is called only if some body
/// floats.
pub(super) fn choose(
    preconditioner: &dyn DualPreconditioner,
    wanted: ProjectorKind,
    (spread, varies): (f64, f64),
    switch: bool,
) -> ProjectorKind {
    if wanted != ProjectorKind::Auto {
        // Without a preconditioner Q = M⁻¹ is the identity.
        let identity = wanted == ProjectorKind::Preconditioner && preconditioner.is_identity();
        return if identity {
            ProjectorKind::Identity
        } else {
            wanted
        };
    }
    // Corners and mesh sizes alone cause a factor of two.
    let differ = spread > 3.0 || varies > JUMPS;
    match (differ, switch || preconditioner.is_identity()) {
        (false, _) => ProjectorKind::Identity,
        (true, true) => ProjectorKind::Diagonal,
        (true, false) => ProjectorKind::Preconditioner,
    }
}

/// The largest ratio of the stiffnesses of bodies: means of the diagonal of K over their interfaces. Collective.
pub(super) fn spread(comm: &SimpleCommunicator, problem: &Problem, stiffness: &Stiffness) -> f64 {
    let n = problem.n_bodies;
    let mut sums = vec![0.0; 2 * n];
    for (sub, local) in problem.local.iter().zip(&stiffness.locals) {
        for &i in &local.gamma().interface {
            sums[sub.body] += sub.k.get(i as usize, i as usize);
            sums[n + sub.body] += 1.0;
        }
    }
    sum_all(comm, &mut sums);
    let means = (0..n)
        .filter(|&b| sums[n + b] > 0.0)
        .map(|b| sums[b] / sums[n + b]);
    let (low, high) = means.fold((f64::INFINITY, 0.0), |(l, h): (f64, f64), m| {
        (l.min(m), h.max(m))
    });
    high / low
}

impl NaturalCoarse {
    /// Whether rows switch between many bodies of elasticity, none of which are tied to each other. M⁻¹G then takes
    /// hundreds of products with M⁻¹ in each step of the contact loop, and saves few iterations: rows without friction
    /// carry normal forces alone (docs/theory.md, section 6). With friction rows have springs on the way, which M⁻¹
    /// does not know: P would put forces on the softest ones. Collective.
    pub(super) fn slides(&self, problem: &Problem, stiffness: &Stiffness) -> bool {
        let jump = &stiffness.jump;
        let mut rows = jump.rows_between_bodies();
        let tie = |i: usize| !jump.law[i].is_inequality() && !jump.law[i].is_friction();
        let tied = rows.any(|i| tie(i) && jump.is_candidate(i));
        let friction = any(stiffness.comm(), !problem.friction.is_empty());
        let many = self.r > FEW && self.columns.most() > 1;
        (many || friction) && !any(stiffness.comm(), tied)
    }

    /// diag(B_D diag(K) B_Dᵀ) on the owned rows, with diag(G)⁻¹ in place of G⁻¹ in coupled blocks: any positive
    /// diagonal gives a projector. Collective.
    pub fn superlumped(&self, problem: &Problem, stiffness: &Stiffness) -> Result<Vec<f64>> {
        let jump = &stiffness.jump;
        let mut ghost = vec![0.0; jump.ghosts.len()];
        for (j, columns) in jump.columns.iter().enumerate() {
            let k = &problem.local[j].k;
            for ((&row, &at), bd) in columns.row.iter().zip(columns.at).zip(columns.bd) {
                let dof = stiffness.locals[j].gamma().interface[at as usize] as usize;
                ghost[row as usize] += bd * bd * k.get(dof, dof);
            }
        }
        let q = PetscVec::mpi(&stiffness.session, jump.n_owned)?;
        stiffness.dual_halo.sum(&ghost, &q)?;
        let mut q = q.to_vec()?;
        let entry = |j: usize, at: usize| {
            let dof = stiffness.locals[j].gamma().interface[at] as usize;
            problem.local[j].k.get(dof, dof)
        };
        stiffness.add_diagonal(entry, &mut q)?;
        Ok(q)
    }

    /// The diagonal that is added to M⁻¹ in Q: the superlumped diagonal on rows of a single term, and `rest` times it
    /// on the others. A row of a single term has something rigid on its other side, which M⁻¹ does not contain. For a
    /// floating body that touches nothing else, M⁻¹ G vanishes.
    pub(super) fn rigid_rows(
        &self,
        problem: &Problem,
        stiffness: &Stiffness,
        rest: f64,
    ) -> Result<Vec<f64>> {
        let mut out = self.superlumped(problem, stiffness)?;
        let jump = &stiffness.jump;
        out[..jump.n_owned_local].fill(0.0);
        for (q, &r) in out[jump.n_owned_local..].iter_mut().zip(&jump.order) {
            if problem.rows[r].terms.len() > 1 {
                *q *= rest;
            }
        }
        Ok(out)
    }

    /// Q G with Q = M⁻¹ + diag(`rigid`). Columns of bodies that are far from each other share a product with M⁻¹.
    ///
    /// Where stiffnesses are far [`APART`], M⁻¹ becomes J M⁻¹ J, and J selects the rows of B_gl. Without J, what
    /// Gᵀ M⁻¹ G divides would come from the rows of B_loc in stiff bodies as well, and be larger by as much as bodies
    /// differ in stiffness (docs/theory.md, section 6).
    pub(super) fn probe(
        &self,
        problem: &Problem,
        stiffness: &Stiffness,
        preconditioner: &dyn DualPreconditioner,
        rigid: &[f64],
    ) -> Result<KernelRows> {
        let n = stiffness.jump.n_owned;
        let graph = self.graph(problem, stiffness);
        let columns =
            sweep::kernel_columns(&self.g, self.columns.start(), |b| graph.near[b].clone());
        let like = PetscVec::mpi(&stiffness.session, n)?;
        let apply = |x: &[PetscVec], y: &[PetscVec]| preconditioner.apply_many(stiffness, x, y);
        let mut images = sweep::images(&like, graph, &columns, apply)?;
        for column in images.iter_mut().filter(|_| self.spread > APART) {
            let global = |row: u32| row as usize >= stiffness.jump.n_owned_local;
            column.entries.retain(|e| global(e.0));
        }
        let of = |list: &[sweep::MultiplierColumn], weigh: &dyn Fn(u32) -> f64| {
            let entries = list.iter().enumerate().flat_map(|(c, column)| {
                let entries = column.entries.iter();
                entries.map(move |&(row, v)| (row, c as u32, v * weigh(row)))
            });
            entries.collect::<Vec<_>>()
        };
        let mut entries = of(&images, &|_| 1.0);
        entries.extend(of(&columns, &|row| rigid[row as usize]));
        Ok(KernelRows::from_triplets(n, entries))
    }
}

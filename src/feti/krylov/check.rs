//! Identities of the theory, as relative defects that must be of the size of rounding (`-fetifeti_check`).

use super::system::DualSystem;
use crate::feti::operators::dual::Dual;
use crate::feti::operators::work::InterfaceBuffers;
use crate::feti::subdomain::scaled::ScaledSubdomain;
use crate::feti::subdomain::which::Operator;
use crate::substructures::Problem;
use crate::Result;
use parallel::exchange::max_all;
use petsc::Vec as PetscVec;

/// (name, relative defect) of each identity that applies to the problem. Collective.
pub(crate) fn identities(
    problem: &Problem,
    system: &DualSystem,
) -> Result<Vec<(&'static str, f64)>> {
    let dual = &*system.dual();
    let check = Check {
        problem,
        system,
        dual,
    };
    let mut out = vec![
        ("S S^+ S = S", check.generalised_inverse()?),
        ("S R = 0", check.kernel()),
    ];
    if dual.stiffness.jump.n_global > 0 {
        out.push(("B B_D^T B = B", check.scaling()?));
        out.push(("F symmetric", check.symmetric(|x, y| dual.f(x, y))?));
        out.push(("M^-1 symmetric", check.symmetric(|x, y| dual.m(x, y))?));
    }
    if dual.natural.r > 0 {
        out.push(("G^T lambda_0 = e", check.start()?));
        out.push(("P P = P", check.projector(|x| dual.p(x))?));
        out.push(("P^T P^T = P^T", check.projector(|x| dual.p_transpose(x))?));
        out.push(("G^T P = 0", check.admissible()?));
    }
    if system
        .deflation()
        .as_ref()
        .is_some_and(|d| d.matrices().is_some())
    {
        out.push((
            "P_2 P_2 = P_2",
            check.projector(|x| {
                dual.p(x)?;
                system.p2(x)
            })?,
        ));
        out.push(("W^T F P_2 = 0", check.complement()?));
    }
    if dual.preconditioner.lifting().is_some() {
        out.push(("B Z_c = 0", check.lifted()?));
        out.push(("A = Z_c^T S Z_c", check.removed()?));
    }
    Ok(out)
}

struct Check<'a> {
    problem: &'a Problem,
    system: &'a DualSystem,
    dual: &'a Dual,
}

/// Numbers without pattern. They do not depend on the number of ranks if `seed` does not.
fn noise(seed: u64) -> f64 {
    let mut x = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15);
    x = (x ^ (x >> 31)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    ((x ^ (x >> 29)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

impl Check<'_> {
    /// work.y: a function in W̃, discontinuous in the dual dofs, continuous in the vertices and averages.
    fn torn(&self) -> Vec<InterfaceBuffers> {
        let stiffness = &self.dual.stiffness;
        let mut work = stiffness.work();
        for (j, w) in work.iter_mut().enumerate() {
            let (sub, local) = (&self.problem.local[j], &stiffness.locals[j]);
            for (i, &dof) in local.gamma().interface.iter().enumerate() {
                let copy = if i < local.gamma().n_delta {
                    sub.index as u64 + 1
                } else {
                    0
                };
                w.y[i] = noise(sub.dofs[dof as usize] ^ (copy << 40));
            }
            let averages = stiffness.jump.averages[j].iter();
            let values: Vec<f64> = averages.map(|a| noise(a.key)).collect();
            local.gamma().basis.set_values(&values, &mut w.y);
        }
        work
    }

    /// Part of W that P_2 leaves in F P_2 M⁻¹ x for jumps x, relative to the part that it removes.
    fn complement(&self) -> Result<f64> {
        let dual = self.dual;
        let (x, y, image) = (
            self.multipliers(7)?,
            dual.multipliers()?,
            dual.multipliers()?,
        );
        dual.p_transpose(&x)?;
        dual.m(&x, &y)?;
        dual.p(&y)?;
        let mut sizes = [0.0; 2];
        for size in &mut sizes {
            dual.f(&y, &image)?;
            *size = match self.system.deflation().as_ref().and_then(|d| d.matrices()) {
                Some(p2) => p2.part_of(&image)?,
                None => 0.0,
            };
            self.system.p2(&y)?;
        }
        Ok(self.relative(sizes[1], sizes[0]))
    }

    fn relative(&self, defect: f64, size: f64) -> f64 {
        let mut both = [defect, size];
        max_all(self.dual.comm(), &mut both);
        if both[1] > 0.0 {
            both[0] / both[1]
        } else {
            both[0]
        }
    }

    fn multipliers(&self, seed: u64) -> Result<PetscVec> {
        let x = self.dual.multipliers()?;
        let first = self.dual.stiffness.jump.first as u64;
        for (i, v) in x.array_mut()?.iter_mut().enumerate() {
            *v = noise((first + i as u64) << 8 | seed);
        }
        Ok(x)
    }

    /// S S̃⁺ (S w) = S w for w in W̃; the defect of each subdomain is relative to its own size.
    fn generalised_inverse(&self) -> Result<f64> {
        let stiffness = &self.dual.stiffness;
        let mut work = self.torn();
        for (w, local) in work.iter_mut().zip(&stiffness.locals) {
            local.apply_one(Operator::S, &w.y, &mut w.v);
        }
        stiffness.s_plus(&mut work)?;
        let mut worst = 0.0f64;
        for (w, local) in work.iter().zip(&stiffness.locals) {
            let mut back = vec![0.0; w.v.len()];
            local.apply_one(Operator::S, &w.y, &mut back);
            let defect = back
                .iter()
                .zip(&w.v)
                .fold(0.0f64, |a, (b, v)| a.max((b - v).abs()));
            let stiff = local.stiffness();
            let size = w.y.iter().fold(1.0f64, |a, y| a.max(y.abs()));
            if stiff > 0.0 {
                worst = worst.max(defect / (stiff * size));
            }
        }
        Ok(self.relative(worst, 1.0))
    }

    fn kernel(&self) -> f64 {
        let mut worst = 0.0f64;
        for (kernel, local) in self
            .dual
            .natural
            .kernels
            .iter()
            .zip(&self.dual.stiffness.locals)
        {
            for c in 0..kernel.cols {
                let mut image = vec![0.0; kernel.rows];
                local.apply_one(Operator::S, kernel.col(c), &mut image);
                let stiff = local.stiffness();
                let size = kernel.col(c).iter().fold(0.0f64, |a, v| a.max(v.abs()));
                let defect = image.iter().fold(0.0f64, |a, v| a.max(v.abs()));
                if stiff * size > 0.0 {
                    worst = worst.max(defect / (stiff * size));
                }
            }
        }
        self.relative(worst, 1.0)
    }

    fn scaling(&self) -> Result<f64> {
        let stiffness = &self.dual.stiffness;
        let columns = &stiffness.jump.columns;
        let mut work = self.torn();
        let first = self.dual.multipliers()?;
        stiffness.jump_of(&work, &first)?;
        let mut ghost = stiffness.scaled_ghosts();
        stiffness.fetch_scaled(&first, &mut ghost)?;
        for (w, columns) in work.iter_mut().zip(columns.iter()) {
            columns.bd_transpose(&ghost, &mut w.y);
        }
        let second = self.dual.multipliers()?;
        stiffness.jump_of(&work, &second)?;
        second.axpy(-1.0, &first)?;
        Ok(self.relative(second.norm_inf()?, first.norm_inf()?))
    }

    fn symmetric(&self, op: impl Fn(&PetscVec, &PetscVec) -> Result<()>) -> Result<f64> {
        let (x, y) = (self.multipliers(1)?, self.multipliers(2)?);
        let (ax, ay) = (self.dual.multipliers()?, self.dual.multipliers()?);
        op(&x, &ax)?;
        op(&y, &ay)?;
        let defect = (y.dot(&ax)? - x.dot(&ay)?).abs();
        let size = ax.norm2()? * y.norm2()?;
        Ok(if size > 0.0 { defect / size } else { defect })
    }

    fn projector(&self, p: impl Fn(&PetscVec) -> Result<()>) -> Result<f64> {
        let x = self.multipliers(3)?;
        p(&x)?;
        let twice = x.duplicate()?;
        twice.copy_from(&x)?;
        p(&twice)?;
        twice.axpy(-1.0, &x)?;
        Ok(self.relative(twice.norm2()?, x.norm2()?))
    }

    /// Rᵀ (g − Bᵀ λ₀) = 0, relative to the terms of the sum.
    fn start(&self) -> Result<f64> {
        let (stiffness, natural) = (&self.dual.stiffness, &self.dual.natural);
        let locals = self.problem.local.iter().zip(&stiffness.locals);
        let g: Vec<Vec<f64>> = locals
            .map(|(sub, local)| {
                ScaledSubdomain::condense_many(&[local], &[&sub.f])
                    .remove(0)
                    .1
            })
            .collect();
        let lambda = self.dual.multipliers()?;
        lambda.set(0.0)?;
        let comm = self.dual.comm();
        let f: Vec<&[f64]> = self.problem.local.iter().map(|s| &s.f[..]).collect();
        let load = natural.kernel_load(comm, &f, &g);
        natural.begin(comm, &load, &lambda)?;
        let mut ghost = vec![0.0; stiffness.jump.ghosts.len()];
        stiffness.dual_halo.fetch(&lambda, &mut ghost)?;
        let loads = g.iter().enumerate().map(|(j, g)| {
            let mut v = vec![0.0; g.len()];
            stiffness.jump.columns.of(j).b_transpose(&ghost, &mut v);
            v.iter_mut().zip(g).for_each(|(v, g)| *v = g - *v);
            v
        });
        let locals = self.problem.local.iter();
        let sizes = locals.map(|sub| sub.f.iter().map(|f| f.abs()).sum::<f64>());
        let scale = sizes.fold(0.0, f64::max);
        self.work_on_kernels(loads.collect(), scale)
    }

    /// Largest |Rᵀ v| relative to the terms of the sum or to `scale`, whichever is larger.
    fn work_on_kernels(&self, v: Vec<Vec<f64>>, scale: f64) -> Result<f64> {
        let natural = &self.dual.natural;
        let known = natural.known();
        let (mut work, mut size) = (vec![0.0; known.n()], vec![0.0; known.n()]);
        for (j, v) in v.iter().enumerate() {
            let start = natural.first_column(j);
            for c in 0..natural.kernels[j].cols {
                for (r, v) in natural.kernels[j].col(c).iter().zip(v) {
                    work[start + c] += r * v;
                    size[start + c] += (r * v).abs();
                }
            }
        }
        known.sum(self.dual.comm(), &mut work);
        known.sum(self.dual.comm(), &mut size);
        let largest = |s: &[f64]| s.iter().fold(0.0f64, |a, v| a.max(v.abs()));
        Ok(self.relative(largest(&work), largest(&size).max(scale)))
    }

    /// Bᵀ P λ does no work on rigid motions: Rᵀ Bᵀ P λ = 0, computed with B and not with G.
    fn admissible(&self) -> Result<f64> {
        let stiffness = &self.dual.stiffness;
        let x = self.multipliers(4)?;
        self.dual.p(&x)?;
        let mut ghost = vec![0.0; stiffness.jump.ghosts.len()];
        stiffness.dual_halo.fetch(&x, &mut ghost)?;
        let loads = stiffness.jump.columns.iter().zip(&stiffness.locals);
        let loads = loads.map(|(columns, local)| {
            let mut v = vec![0.0; local.gamma().n_gamma()];
            columns.b_transpose(&ghost, &mut v);
            v
        });
        self.work_on_kernels(loads.collect(), 0.0)
    }

    /// B Z_c x for a random x.
    fn lifted(&self) -> Result<f64> {
        let Some(lifting) = self.dual.preconditioner.lifting() else {
            return Ok(0.0);
        };
        let stiffness = &self.dual.stiffness;
        let mut work = stiffness.work();
        let mut size = 0.0f64;
        let combined = lifting.combine(stiffness, |column| noise(u64::from(column) + 17))?;
        for (w, y) in work.iter_mut().zip(combined) {
            w.y = y;
            size = w.y.iter().fold(size, |a, v| a.max(v.abs()));
        }
        let jump = self.dual.multipliers()?;
        stiffness.jump_of(&work, &jump)?;
        Ok(self.relative(jump.norm_inf()?, size))
    }

    /// Part of S Z_c x that M_C leaves for a random x. It vanishes if A is Z_cᵀ S̃ Z_c and A⁺ its inverse on its range.
    fn removed(&self) -> Result<f64> {
        let Some(lifting) = self.dual.preconditioner.lifting() else {
            return Ok(0.0);
        };
        let stiffness = &self.dual.stiffness;
        let locals = &stiffness.locals;
        let mut work = stiffness.work();
        let combined = lifting.combine(stiffness, |column| noise(u64::from(column) + 29))?;
        for (w, z) in work.iter_mut().zip(combined) {
            w.v = z;
        }
        // This product is in double precision, whatever the precision of M⁻¹.
        let multiply = |work: &mut [InterfaceBuffers]| {
            stiffness.team.for_each(work, |j, w| {
                locals[j].apply_one(Operator::S, &w.v, &mut w.y);
            });
        };
        let largest = |work: &[InterfaceBuffers]| {
            let all = work.iter().flat_map(|w| &w.y);
            all.fold(0.0f64, |a, v| a.max(v.abs()))
        };
        lifting.begin(stiffness, &work)?;
        multiply(&mut work);
        let size = largest(&work);
        lifting.finish(stiffness, &mut work, multiply)?;
        Ok(self.relative(largest(&work), size))
    }
}

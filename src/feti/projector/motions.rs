//! The motions in which all bodies move as one, as combinations of the kernel vectors of the floating bodies.

use std::ops::Range;

use super::natural::NaturalCoarse;
use crate::feti::operators::stiffness::Stiffness;
use crate::substructures::{Problem, Subdomain};
use crate::Result;
use base::linalg::dense::Dense;
use base::linalg::semidefinite::Semidefinite;
use base::linalg::sorted::distinct;
use parallel::exchange::{highest, lowest};
use parallel::halo::Halo;
use petsc::Vec as PetscVec;

impl NaturalCoarse {
    /// For each motion of space (constants, or translations and rotations about the origin) the α with R α nearest to
    /// it in every floating body, as vectors laid out like `like`, which owns the columns `own`. Empty where
    /// coordinates or kernels are not known. Collective.
    pub(super) fn motions(
        &self,
        problem: &Problem,
        stiffness: &Stiffness,
        like: &PetscVec,
        own: &Range<usize>,
    ) -> Result<Vec<PetscVec>> {
        let comm = stiffness.comm();
        let known: Vec<Option<Vec<Vec<f64>>>> = problem.local.iter().map(of_space).collect();
        let count = |motions: &Option<Vec<Vec<f64>>>| motions.as_ref().map_or(0, Vec::len) as f64;
        let n = known.iter().map(count).fold(f64::INFINITY, f64::min);
        let least = lowest(comm, n);
        if least == 0.0 || highest(comm, if n.is_finite() { n } else { 0.0 }) != least {
            return Ok(Vec::new());
        }
        let n = least as usize;
        let columns_of = |body: usize| self.columns.of(body);
        let here = distinct(problem.local.iter().flat_map(|s| columns_of(s.body)));
        let ghosts: Vec<u32> = here.iter().map(|&c| c as u32).collect();
        let halo = Halo::new(&stiffness.session, like, &ghosts)?;
        let most = self.columns.most();
        // RᵀR and Rᵀ times the motions of each body, column by column.
        let mut sums = vec![vec![0.0; here.len()]; most + n];
        for (j, (sub, motions)) in problem.local.iter().zip(&known).enumerate() {
            let (kernel, columns) = (&self.kernels[j], columns_of(sub.body));
            let Ok(first) = here.binary_search(&columns.start) else {
                continue;
            };
            let mut work = vec![0.0; kernel.cols];
            let mut add = |of: usize, v: &[f64]| {
                work.fill(0.0);
                kernel.add_mul_transpose(v, &mut work);
                let sum = &mut sums[of][first..first + work.len()];
                sum.iter_mut().zip(&work).for_each(|(s, w)| *s += w);
            };
            for p in 0..kernel.cols {
                add(p, kernel.col(p));
            }
            let interface = &stiffness.locals[j].gamma().interface;
            for (m, motion) in motions.iter().flatten().enumerate() {
                let v: Vec<f64> = interface.iter().map(|&i| motion[i as usize]).collect();
                add(most + m, &v);
            }
        }
        let of_owner = |sum: &Vec<f64>| {
            halo.sum(sum, like)?;
            like.to_vec()
        };
        let sums: Vec<Vec<f64>> = sums.iter().map(of_owner).collect::<Result<_>>()?;
        let mut out = vec![vec![0.0; own.len()]; n];
        let bodies = (0..problem.n_bodies).map(columns_of);
        for columns in bodies.filter(|c| own.contains(&c.start)) {
            let (at, d) = (columns.start - own.start, columns.len());
            let gram = Semidefinite::new(&Dense::from_fn(d, d, |i, p| sums[p][at + i]));
            for (m, out) in out.iter_mut().enumerate() {
                let alpha = &mut out[at..at + d];
                alpha.copy_from_slice(&sums[most + m][at..at + d]);
                gram.solve(alpha);
            }
        }
        let vector = |values: Vec<f64>| {
            let v = like.duplicate()?;
            v.array_mut()?.copy_from_slice(&values);
            Ok(v)
        };
        out.into_iter().map(vector).collect()
    }
}

/// The motions of space at the dofs of a subdomain: 1 for a scalar; 2 translations and 1 rotation in the plane; 3 and 3
/// in space. `None` if its kernel or the positions of its dofs are not known.
fn of_space(sub: &Subdomain) -> Option<Vec<Vec<f64>>> {
    let (kernel, points) = (sub.near_kernel.as_ref()?, sub.coordinates.as_ref()?);
    let dim = match kernel.len() {
        1 => return Some(kernel.clone()),
        3 => 2,
        6 => 3,
        _ => return None,
    };
    // A dof is the component whose translation moves it.
    let component = |i: usize| (0..dim).find(|&c| kernel[c][i] != 0.0);
    let components: Vec<usize> = (0..points.len()).map(component).collect::<Option<_>>()?;
    let mut out = kernel[..dim].to_vec();
    // The rotation from axis a to axis b: x_a moves along b, x_b against a.
    for (a, b) in [(0, 1), (1, 2), (2, 0)].into_iter().take(2 * dim - 3) {
        let at = |(&c, x): (&usize, &[f64; 3])| match c {
            c if c == b => x[a],
            c if c == a => -x[b],
            _ => 0.0,
        };
        out.push(components.iter().zip(points).map(at).collect());
    }
    Some(out)
}

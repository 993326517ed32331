//! A change of basis on Γ that makes averages coordinates.
//!
//! On the n dofs of an entity, the Householder reflection H with H e_1 = 1/√n · (1, …, 1) is symmetric and orthogonal; the first entry
//! of H u is √n times the average of u, the others are coordinates of what is left. H S H has the average as a row and column
//! that can be made primal like a vertex, and T and Ψ go back to the nodal dofs by the same H.

use super::dense::Dense;

/// The reflections of all averages of one subdomain.
#[derive(Debug, Clone, Default)]
pub struct Basis {
    /// Positions in Γ of the dofs of each average; the first one becomes the average.
    pub averages: Vec<Vec<usize>>,
}

/// v_1 and v_i (i > 1) of H = I − β v vᵀ, and β.
fn reflection(n: usize) -> (f64, f64, f64) {
    let root = 1.0 / (n as f64).sqrt();
    if n == 1 {
        return (0.0, 0.0, 0.0);
    }
    (1.0 - root, -root, 1.0 / (1.0 - root))
}

impl Basis {
    /// Positions that stand for averages after the change.
    pub fn pivots(&self) -> Vec<usize> {
        self.averages.iter().map(|a| a[0]).collect()
    }

    /// √n of each average: its coordinate is that many times the average.
    pub fn factor(&self, average: usize) -> f64 {
        (self.averages[average].len() as f64).sqrt()
    }

    /// u ← H u.
    pub fn apply(&self, u: &mut [f64]) {
        for dofs in &self.averages {
            let (first, rest, beta) = reflection(dofs.len());
            let others: f64 = dofs[1..].iter().map(|&i| u[i]).sum();
            let along = beta * (first * u[dofs[0]] + rest * others);
            u[dofs[0]] -= along * first;
            dofs[1..].iter().for_each(|&i| u[i] -= along * rest);
        }
    }

    /// A ← H A.
    pub fn apply_left(&self, a: &mut Dense) {
        if !self.averages.is_empty() {
            (0..a.cols).for_each(|j| self.apply(a.col_mut(j)));
        }
    }

    /// A ← A H.
    pub fn apply_right(&self, a: &mut Dense) {
        let mut along = vec![0.0; a.rows];
        for dofs in &self.averages {
            let (first, rest, beta) = reflection(dofs.len());
            let v = |k: usize| if k == 0 { first } else { rest };
            along.fill(0.0);
            for (k, &i) in dofs.iter().enumerate() {
                let terms = along.iter_mut().zip(a.col(i));
                terms.for_each(|(w, x)| *w += beta * v(k) * x);
            }
            for (k, &i) in dofs.iter().enumerate() {
                let terms = a.col_mut(i).iter_mut().zip(&along);
                terms.for_each(|(x, w)| *x -= v(k) * w);
            }
        }
    }

    /// The average number `k` of u.
    pub fn mean(&self, k: usize, u: &[f64]) -> f64 {
        let dofs = &self.averages[k];
        dofs.iter().map(|&i| u[i]).sum::<f64>() / dofs.len() as f64
    }

    /// u minus its averages.
    pub fn remove_means(&self, u: &mut [f64]) {
        for k in 0..self.averages.len() {
            let mean = self.mean(k, u);
            self.averages[k].iter().for_each(|&i| u[i] -= mean);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::feti::local::testing::random;

    #[test]
    fn the_reflection_is_its_own_inverse_and_shows_the_average() {
        let basis = Basis {
            averages: vec![vec![1, 4, 6], vec![5], vec![2, 3]],
        };
        let u = random(8, 3);
        let mut h = u.clone();
        basis.apply(&mut h);
        for (k, pivot) in basis.pivots().into_iter().enumerate() {
            let mean = basis.mean(k, &u);
            assert!((h[pivot] - basis.factor(k) * mean).abs() < 1e-15);
        }
        assert_eq!((h[0], h[5], h[7]), (u[0], u[5], u[7]));
        basis.apply(&mut h);
        assert!(h.iter().zip(&u).all(|(a, b)| (a - b).abs() < 1e-15));

        let mut a = Dense::zeros(8, 8);
        a.data.copy_from_slice(&random(64, 9));
        let mut au = vec![0.0; 8];
        a.add_mul(&u, &mut au);
        basis.apply(&mut au);
        basis.apply_left(&mut a);
        basis.apply_right(&mut a);
        let (mut hu, mut hau) = (u.clone(), vec![0.0; 8]);
        basis.apply(&mut hu);
        a.add_mul(&hu, &mut hau);
        assert!(au.iter().zip(&hau).all(|(x, y)| (x - y).abs() < 1e-14));
    }
}

//! Unit tests of `src/contact/friction/mixing.rs`.

use super::*;
use crate::testing::with_session;

/// Φ(g) = A g + b with |A| < 1: mixing is GMRES on it, and ends after as many steps as A has eigenvalues.
#[test]
fn an_affine_map_comes_to_rest_in_few_steps() {
    with_session(|session| {
        let comm = session.comm();
        let a = [[0.5, 0.2, 0.0], [-0.3, 0.6, 0.1], [0.0, -0.2, 0.4]];
        let b = [1.0, -2.0, 0.5];
        let phi = |g: &[f64]| -> Vec<f64> {
            (0..3)
                .map(|i| b[i] + (0..3).map(|j| a[i][j] * g[j]).sum::<f64>())
                .collect()
        };
        let after = |depth: usize| {
            let mut mixing = Mixing::default();
            let mut g = vec![0.0; 3];
            for _ in 0..5 {
                let mapped = phi(&g);
                g = mixing.mix(comm, depth, g, &mapped);
            }
            phi(&g)
                .iter()
                .zip(&g)
                .fold(0.0f64, |m, (f, g)| m.max((f - g).abs()))
        };
        assert!(after(3) < 1e-10, "{}", after(3));
        assert!(after(0) > 1e-3, "{}", after(0));
        // Steps that are forgotten do not count.
        let mut mixing = Mixing::default();
        mixing.mix(comm, 3, vec![0.0; 3], &[9.0, 9.0, 9.0]);
        mixing.restart();
        assert_eq!(
            mixing.mix(comm, 3, vec![1.0; 3], &[2.0, 3.0, 4.0]),
            [2.0, 3.0, 4.0]
        );
    });
}

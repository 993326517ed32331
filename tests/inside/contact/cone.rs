//! Unit tests of `src/contact/cone.rs`.

use super::*;
use crate::linalg::nnls::nnls;
use crate::testing::with_session;

#[test]
fn agrees_with_lawson_and_hanson() {
    with_session(|_| {
        // A chain of bodies, each pushing the next one; the load is inside or outside the cone.
        let r = 12;
        let mut g = Dense::zeros(r, r);
        for j in 0..r {
            g.set(j, j, 1.0);
            if j > 0 {
                g.set(j - 1, j, -1.0);
            }
        }
        for (pull, inside) in [(0.0, true), (20.0, false)] {
            let mut e = vec![1.0; r];
            e[3] -= pull;
            let (rest, known) = outside(&g, &e, &[false; 12], 1e-10).expect("runs");
            let (_, exact) = nnls(&g, &e, &[false; 12]);
            assert!(known);
            let far = rest.iter().zip(&exact).map(|(a, b)| (a - b).abs());
            assert!(far.fold(0.0, f64::max) < 1e-3, "{rest:?} {exact:?}");
            assert_eq!(rest.iter().all(|v| v.abs() < 1e-9), inside);
        }
    });
}

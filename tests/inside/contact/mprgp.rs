//! Unit tests of `src/contact/mprgp.rs`.

use super::*;
use crate::testing::with_session;

/// A dense matrix without a preconditioner.
struct Plain<const N: usize>([[f64; N]; N], Vec<bool>);

impl<const N: usize> BoundedQuadratic for Plain<N> {
    fn apply(&mut self, x: &[f64], y: &mut [f64]) -> Result<()> {
        for (y, row) in y.iter_mut().zip(&self.0) {
            *y = row.iter().zip(x).map(|(a, x)| a * x).sum();
        }
        Ok(())
    }

    fn enter(&mut self, free: &[bool]) -> Result<()> {
        self.1 = free.to_vec();
        Ok(())
    }

    fn precondition(&mut self, v: &[f64], z: &mut [f64]) -> Result<()> {
        for ((z, v), free) in z.iter_mut().zip(v).zip(&self.1) {
            *z = if *free { *v } else { 0.0 };
        }
        Ok(())
    }
}

/// The minimiser from `start`, and A x − b there.
fn minimised<const N: usize>(
    a: [[f64; N]; N],
    b: [f64; N],
    (lower, fixed): ([f64; N], [bool; N]),
    start: [f64; N],
) -> (Vec<f64>, Vec<f64>) {
    with_session(move |session| {
        let setting = Setting {
            comm: session.comm(),
            lower: &lower,
            fixed: &fixed,
            length: 0.475,
            tuning: &Tuning::DEFAULT,
        };
        let mut plain = Plain(a, vec![true; N]);
        let mut stop = |_: &[f64], gradient: f64| gradient < 1e-12;
        let found = setting.minimise(&mut plain, &b, start.to_vec(), &mut stop, 500);
        let run = found.expect("it runs");
        assert!(run.products < 500);
        (run.x, run.g)
    })
}

const CHAIN: [[f64; 4]; 4] = [
    [2.0, -1.0, 0.0, 0.0],
    [-1.0, 2.0, -1.0, 0.0],
    [0.0, -1.0, 2.0, -1.0],
    [0.0, 0.0, -1.0, 2.0],
];

/// Bounds, an entry without one and a fixed one: the conditions of optimality, from near and from far.
#[test]
fn the_minimum_satisfies_its_conditions() {
    let lower = [0.0, -0.5, f64::NEG_INFINITY, 0.25];
    let fixed = [false, false, false, true];
    for seed in 0..40 {
        let b = [1, 2, 3, 4].map(|k| 3.0 * (f64::from(7 * k + 13 * seed)).sin());
        for far in [0.1, 10.0] {
            let start = [far, far, -far, 0.75];
            let (x, g) = minimised(CHAIN, b, (lower, fixed), start);
            assert_eq!(x[3], 0.75);
            for i in 0..3 {
                assert!(x[i] >= lower[i], "{seed}: {x:?}");
                let free = x[i] > lower[i];
                assert!(g[i] > -1e-11 && !(free && g[i] > 1e-11), "{seed}: {g:?}");
            }
        }
    }
}

/// Along (1, 1) there is no curvature: x goes to its bounds where that lowers the function.
#[test]
fn a_direction_without_curvature_ends_at_a_bound() {
    let a = [[1.0, -1.0], [-1.0, 1.0]];
    let bounds = ([0.0, 0.0], [false; 2]);
    let (x, _) = minimised(a, [-1.0, -1.0], bounds, [3.0, 2.0]);
    assert_eq!(x, [0.0, 0.0]);
    // And stays where it does not.
    let (x, _) = minimised(a, [0.0, 0.0], bounds, [3.0, 2.0]);
    assert!(x.iter().all(|x| (x - 2.5).abs() < 1e-12), "{x:?}");
}

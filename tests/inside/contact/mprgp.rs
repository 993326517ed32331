//! Unit tests of `src/contact/mprgp.rs`.

use super::*;
use crate::contact::disc::Disc;
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

/// The minimiser over `set` from `start`, and A x − b there. ‖A‖ is at most 4.
fn minimised<const N: usize>(
    a: [[f64; N]; N],
    b: [f64; N],
    set: &FeasibleSet,
    start: [f64; N],
) -> (Vec<f64>, Vec<f64>) {
    let set = set.clone();
    with_session(move |session| {
        let setting = Setting {
            comm: session.comm(),
            set: &set,
            length: 0.475,
            tuning: &Tuning::DEFAULT,
        };
        let mut plain = Plain(a, vec![true; N]);
        let mut stop = |_: &[f64], gradient: f64| gradient < 1e-12;
        let found = setting.minimise(&mut plain, &b, start.to_vec(), &mut stop, 100);
        let run = found.expect("it runs");
        assert!(run.products < 100);
        (run.x, run.g)
    })
}

/// Half-lines alone.
fn half_lines<const N: usize>(lower: [f64; N], fixed: [bool; N]) -> FeasibleSet {
    FeasibleSet {
        lower: lower.to_vec(),
        fixed: fixed.to_vec(),
        discs: Vec::new(),
        shift: vec![0.0; N],
    }
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
            let (x, g) = minimised(CHAIN, b, &half_lines(lower, fixed), start);
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
    let bounds = &half_lines([0.0, 0.0], [false; 2]);
    let (x, _) = minimised(a, [-1.0, -1.0], bounds, [3.0, 2.0]);
    assert_eq!(x, [0.0, 0.0]);
    // And stays where it does not.
    let (x, _) = minimised(a, [0.0, 0.0], bounds, [3.0, 2.0]);
    assert!(x.iter().all(|x| (x - 2.5).abs() < 1e-12), "{x:?}");
}

const N: usize = 12;

/// Half-lines, discs, an interval, and an entry that does not change; one disc has no radius.
fn mixed(radii: [f64; 4]) -> FeasibleSet {
    let disc = |rows: &[usize], radius: f64| Disc {
        rows: rows.to_vec(),
        radius,
    };
    let mut lower = vec![f64::NEG_INFINITY; N];
    (lower[0], lower[3], lower[6]) = (0.0, -0.3, 0.1);
    FeasibleSet {
        lower,
        fixed: (0..N).map(|i| i == 11).collect(),
        discs: vec![
            disc(&[1, 2], radii[0]),
            disc(&[5, 4], radii[1]),
            disc(&[7, 8], radii[2]),
            disc(&[9], radii[3]),
        ],
        shift: (0..N).map(|i| 0.7 * (i as f64).sin()).collect(),
    }
}

/// Projected gradients from 0 with a fixed step, very many of them: another method, with its own projection.
fn reference(a: &[[f64; N]; N], b: &[f64; N], set: &FeasibleSet, held: f64) -> [f64; N] {
    let mut x = [0.0; N];
    x[11] = held;
    for _ in 0..10_000 {
        let g: Vec<f64> = (0..N)
            .map(|i| a[i].iter().zip(&x).map(|(a, x)| a * x).sum::<f64>() - b[i])
            .collect();
        (0..11).for_each(|i| x[i] = f64::max(x[i] - 0.25 * g[i], set.lower[i]));
        for disc in &set.discs {
            let centred = disc.rows.iter().map(|&i| (x[i] + set.shift[i]).powi(2));
            let size = centred.sum::<f64>().sqrt();
            if size > disc.radius {
                for &i in &disc.rows {
                    x[i] = (x[i] + set.shift[i]) / size * disc.radius - set.shift[i];
                }
            }
        }
    }
    x
}

/// Half-lines and discs, some of which bind, against another method, from near and from far.
#[test]
fn the_minimum_over_discs_is_that_of_projected_gradients() {
    let mut binding = [0; 2];
    for seed in 0..12 {
        let mut k = 100.0 * f64::from(seed);
        // In −1..1, and without order: the fractions of multiples of squares.
        let mut number = || {
            k += 1.0;
            2.0 * (0.618_033_988_749_894_9 * k * k).fract() - 1.0
        };
        let mut a = [[0.0; N]; N];
        for _ in 0..2 * N {
            let v: Vec<f64> = (0..N).map(|_| number()).collect();
            (0..N).for_each(|i| (0..N).for_each(|j| a[i][j] += v[i] * v[j]));
        }
        let sums = a.iter().map(|row| row.iter().map(|a| a.abs()).sum::<f64>());
        let most = sums.fold(0.0, f64::max);
        a.iter_mut().flatten().for_each(|a| *a *= 4.0 / most);
        let b = [0; N].map(|_| 3.0 * number());
        let radii = [0.4, 5.0, if seed % 3 == 0 { 0.0 } else { 1.0 }, 0.2];
        let set = mixed(radii);
        let wanted = reference(&a, &b, &set, 0.5);
        for far in [0.0, 10.0] {
            let mut start = [far; N];
            start[11] = 0.5 + set.shift[11];
            let start = set.nearest(&start).try_into().expect("all entries");
            let (x, _) = minimised(a, b, &set, start);
            for (x, wanted) in x.iter().zip(&wanted) {
                assert!((x - wanted).abs() < 1e-9, "{seed}: {x} and {wanted}");
            }
            let free = set.free(&x);
            for disc in set.discs.iter().filter(|disc| disc.radius > 0.0) {
                binding[usize::from(free[disc.rows[0]])] += 1;
            }
        }
    }
    assert!(binding.iter().all(|n| *n > 10), "{binding:?}");
}

/// Along the edge of a disc the curvature is 0.02 in the end: with the fixed step alone, of which 3,000 would be needed
/// (0.475 · 0.02), this would not end.
#[test]
fn steps_along_an_edge_become_longer() {
    let set = FeasibleSet {
        discs: vec![Disc {
            rows: vec![0, 1],
            radius: 1.0,
        }],
        ..half_lines([f64::NEG_INFINITY; 2], [false; 2])
    };
    let a = [[4.0, 0.0], [0.0, 0.01]];
    let (x, g) = minimised(a, [4.01, 0.0], &set, [-0.6, 0.8]);
    assert!((x[0] - 1.0).abs() < 1e-12 && x[1].abs() < 1e-9, "{x:?}");
    assert!((g[0] + 0.01).abs() < 1e-9, "{g:?}");
}

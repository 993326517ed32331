//! The reference solver for contact problems, on problems with known solutions, and compared with an enumeration of all
//! active sets.

use crate::support::{qp, rng};
use faer::{Mat, Side};
use qp::{certificate, Outcome, Qp, Row, Solved, CERTIFIED};
use rng::Rng;

/// A string of `n` inner nodes on (0, 1), held at the chosen ends: tridiagonal, entries times 1/h.
fn string(n: usize, left: bool, right: bool) -> Mat<f64> {
    let h = 1.0 / (n + 1) as f64;
    Mat::from_fn(n, n, |i, j| {
        let end = (i == 0 && !left) || (i + 1 == n && !right);
        match i.abs_diff(j) {
            0 if end => 1.0 / h,
            0 => 2.0 / h,
            1 => -1.0 / h,
            _ => 0.0,
        }
    })
}

#[test]
fn a_string_on_a_flat_obstacle() {
    // −u'' = −f, u(0) = u(1) = 0, u ≥ −g. The contact zone is |x − 1/2| ≤ 1/2 − a with f a²/2 = g, where the string
    // leaves the obstacle with slope zero. With a at a node, linear elements are exact at the nodes: the active set and
    // the reactions are known.
    let (n, f) = (99, 8.0);
    let h = 0.01;
    let a = 0.25;
    let g = f * a * a / 2.0;
    let below = (0..n).map(|i| Row::new([(i, -1.0)], g)).collect();
    let qp = Qp::dense(&string(n, true, true), &vec![-f * h; n], Vec::new(), below);
    let s = qp.solve().solved();
    let x = |i: usize| (i + 1) as f64 * h;
    for i in 0..n {
        let from_end = x(i).min(1.0 - x(i));
        let expected = if from_end >= a {
            -g
        } else {
            f * from_end * from_end / 2.0 - f * a * from_end
        };
        assert!((s.u[i] - expected).abs() < 1e-13, "{i}");
        let (first, inside) = ((from_end - a).abs() < 1e-9, from_end > a + 1e-9);
        let reaction = match (first, inside) {
            (true, _) => f * h / 2.0,
            (_, true) => f * h,
            _ => 0.0,
        };
        assert!((s.below[i] - reaction).abs() < 1e-12, "{i}");
    }
    assert_eq!(s.closed, (24..=74).collect::<Vec<_>>());
}

#[test]
fn a_degenerate_touch() {
    // The free string just reaches the obstacle at its middle: a closed row without force.
    let n = 3;
    let k = string(n, true, true);
    let f = vec![-1.0; n];
    let free = Qp::dense(&k, &f, Vec::new(), Vec::new()).solve().solved();
    let below = (0..n).map(|i| Row::new([(i, -1.0)], -free.u[1])).collect();
    let s = Qp::dense(&k, &f, Vec::new(), below).solve().solved();
    assert!((s.energy - free.energy).abs() < 1e-14);
    assert!(s.below.iter().all(|l| l.abs() < 1e-12));
}

/// Two free blocks of `n` nodes each in a row, the first pushed towards the second with `push`, the second back with
/// `back`; contact at their facing nodes with a gap, and a stop behind the second.
fn two_blocks(n: usize, push: f64, back: f64, gap: f64, stop: Option<f64>) -> Qp {
    let one = string(n, false, false);
    let k = Mat::from_fn(2 * n, 2 * n, |i, j| {
        if i / n == j / n {
            one[(i % n, j % n)]
        } else {
            0.0
        }
    });
    let mut f = vec![0.0; 2 * n];
    f[0] = push;
    f[2 * n - 1] = -back;
    let mut below = vec![Row::new([(n - 1, 1.0), (n, -1.0)], gap)];
    below.extend(stop.map(|c| Row::new([(2 * n - 1, 1.0)], c)));
    Qp::dense(&k, &f, Vec::new(), below)
}

#[test]
fn two_floating_blocks_against_a_stop() {
    let (n, push) = (5, 0.75);
    let s = two_blocks(n, push, 0.25, 0.5, Some(0.125)).solve().solved();
    assert_eq!(s.closed, [0, 1]);
    assert!((s.below[0] - push).abs() < 1e-13 && (s.below[1] - 0.5).abs() < 1e-13);
    assert!((s.u[2 * n - 1] - 0.125).abs() < 1e-13);
    // The load passes through both blocks; each is shortened by (n − 1) h times the force.
    let h = 1.0 / 6.0;
    let middle = 0.125 + 4.0 * h * push;
    assert!((s.u[n] - middle).abs() < 1e-13);
    assert!((s.u[n - 1] - middle - 0.5).abs() < 1e-13);
}

#[test]
fn two_floating_blocks_that_balance() {
    // No stop: the blocks press on each other and float together. u is known up to one motion.
    let s = two_blocks(4, 0.5, 0.5, -0.25, None).solve().solved();
    assert_eq!(s.closed, [0]);
    assert!((s.below[0] - 0.5).abs() < 1e-13);
    assert!((s.u[3] - s.u[4] + 0.25).abs() < 1e-12);
    // Without a load, any position in which the blocks do not overlap is a solution.
    let s = two_blocks(4, 0.0, 0.0, 1.0, None).solve().solved();
    assert!(s.energy.abs() < 1e-14 && s.u[3] - s.u[4] <= 1.0);
    // Loads that balance on each block alone.
    let mut qp = two_blocks(4, 1.0, 0.0, 0.0, None);
    qp.f[3] = -1.0;
    let s = qp.solve().solved();
    assert!(s.below[0].abs() < 1e-11, "{}", s.below[0]);
}

#[test]
fn bodies_without_hold_are_unbounded() {
    for qp in [
        two_blocks(4, 0.5, 0.25, 0.0, None),
        two_blocks(4, -0.5, 0.0, 0.0, Some(1.0)),
        two_blocks(4, 0.5, 0.75, 0.0, Some(1.0)),
    ] {
        let outcome = qp.solve();
        let Outcome::Unbounded(z) = outcome else {
            panic!("{outcome:?}")
        };
        certificate::check_descent(&qp, &z);
    }
}

#[test]
fn rows_that_contradict_each_other_are_infeasible() {
    let k = string(4, true, true);
    let up = |i, c: f64| Row::new([(i, -1.0)], -c);
    let down = |i, c| Row::new([(i, 1.0)], c);
    let pair = |c| Row::new([(0, 1.0), (1, -1.0)], c);
    let cases = [
        (vec![], vec![up(1, 1.0), down(1, 0.999)]),
        (vec![pair(0.0), pair(1e-3)], vec![]),
        (
            vec![pair(0.0)],
            vec![up(0, 1.0), down(1, 0.5), down(3, 7.0)],
        ),
    ];
    for (equal, below) in cases {
        let qp = Qp::dense(&k, &[1.0; 4], equal, below);
        let Outcome::Infeasible(y) = qp.solve() else {
            panic!("{qp:?}")
        };
        certificate::check_contradiction(&qp, &y);
    }
    // The same with the contradiction removed.
    let s = Qp::dense(&k, &[1.0; 4], vec![], vec![up(1, 1.0), down(1, 1.0)]);
    assert!((s.solve().solved().u[1] - 1.0).abs() < 1e-12);
}

#[test]
fn dependent_rows_share_the_force() {
    // Four floating points that meet: rows tie all six pairs, and one point is pushed onto a stop whose row occurs five
    // times.
    let k = Mat::zeros(4, 4);
    let pairs = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)];
    let rows = pairs.map(|(a, b)| Row::new([(a, 1.0), (b, -1.0)], 0.0));
    let mut below: Vec<Row> = pairs
        .iter()
        .map(|&(a, b)| Row::new([(a, 1.0), (b, -1.0)], 0.0))
        .collect();
    below.extend((0..5).map(|_| Row::new([(3, 2.0)], 4.0)));
    for (equal, below) in [
        (rows.to_vec(), below[6..].to_vec()),
        (Vec::new(), below.clone()),
        (rows.to_vec(), below.clone()),
    ] {
        let stops = below.len() - 5;
        let qp = Qp::dense(&k, &[1.0, 2.0, 0.0, 3.0], equal, below);
        let s = qp.solve().solved();
        let force: f64 = s.below[stops..].iter().sum();
        assert!((2.0 * force - 6.0).abs() < 1e-12, "{:?}", s.below);
        assert!((s.u[3] - 2.0).abs() < 1e-12);
        assert!((s.energy + 12.0).abs() < 1e-11);
    }
}

/// Tries every active set: solves its equations by a dense pseudo-inverse, then checks the signs. `None`: no set fits.
fn by_enumeration(qp: &Qp) -> Option<f64> {
    let (n, ni) = (qp.f.len(), qp.below.len());
    let unit = |i: usize| match qp.k.get(i, i) {
        v if v > 0.0 => v.powf(-0.5),
        _ => 1.0,
    };
    let d: Vec<f64> = (0..n).map(unit).collect();
    for set in 0..1usize << ni {
        let rows: Vec<&Row> = qp
            .equal
            .iter()
            .chain((0..ni).filter(|k| set >> k & 1 == 1).map(|k| &qp.below[k]))
            .collect();
        let size = n + rows.len();
        let mut a = Mat::<f64>::zeros(size, size);
        let mut b = Mat::<f64>::zeros(size, 1);
        for i in 0..n {
            b[(i, 0)] = d[i] * qp.f[i];
            (0..n).for_each(|j| a[(i, j)] = d[i] * qp.k.get(i, j) * d[j]);
        }
        for (r, row) in rows.iter().enumerate() {
            let norm = row
                .terms
                .iter()
                .map(|&(i, v)| (d[i] * v).powi(2))
                .sum::<f64>();
            let norm = norm.sqrt();
            b[(n + r, 0)] = row.rhs / norm;
            for &(i, v) in &row.terms {
                a[(i, n + r)] += d[i] * v / norm;
                a[(n + r, i)] += d[i] * v / norm;
            }
        }
        let eigen = a.self_adjoint_eigen(Side::Lower).unwrap();
        let s = eigen.S().column_vector();
        let mut y = eigen.U().transpose() * &b;
        for i in 0..size {
            y[(i, 0)] *= if s[i].abs() > 1e-10 { 1.0 / s[i] } else { 0.0 };
        }
        let x = eigen.U() * &y;
        let close = 1e-8 * (1.0 + x.norm_max());
        if (&a * &x - &b).norm_max() > close {
            continue;
        }
        let u: Vec<f64> = (0..n).map(|i| d[i] * x[(i, 0)]).collect();
        let held = qp.below.iter().all(|row| row.times(&u) <= row.rhs + close);
        let signs = (n + qp.equal.len()..size).all(|i| x[(i, 0)] >= -close);
        if held && signs {
            return Some(qp.energy(&u));
        }
    }
    None
}

/// A random problem: K has random rank; rows have few terms, some are sums or copies of others; data are from a coarse
/// lattice, so that degenerate contacts without force are frequent.
fn random(rng: &mut Rng) -> Qp {
    let n = rng.between(1, 7);
    let rank = rng.between(0, n);
    let lattice = |rng: &mut Rng| rng.between(0, 4) as f64 - 2.0;
    let l = Mat::from_fn(n, rank, |_, _| lattice(rng));
    let mut k = &l * l.transpose();
    if rng.one_in(4) {
        let d: Vec<f64> = (0..n)
            .map(|_| 10f64.powi(rng.between(0, 2) as i32))
            .collect();
        k = Mat::from_fn(n, n, |i, j| d[i] * k[(i, j)] * d[j]);
    }
    let f: Vec<f64> = (0..n).map(|_| lattice(rng)).collect();
    let mut rows: Vec<Row> = Vec::new();
    let count = rng.between(0, 8);
    for _ in 0..count {
        if !rows.is_empty() && rng.one_in(4) {
            rows.push(rng.pick(&rows).clone());
            continue;
        }
        let terms: Vec<(usize, f64)> = (0..n)
            .map(|i| (i, lattice(rng) * f64::from(u8::from(rng.one_in(2)))))
            .filter(|t| t.1 != 0.0)
            .collect();
        if !terms.is_empty() {
            rows.push(Row::new(terms, lattice(rng)));
        }
    }
    let equal = rows.split_off(rows.len() - rng.below(rows.len() / 2 + 1));
    Qp::dense(&k, &f, equal, rows)
}

#[test]
fn random_problems_against_every_active_set() {
    let mut rng = Rng::new(1);
    let mut count = [0; 3];
    for case in 0..3000 {
        let qp = random(&mut rng);
        match qp.solve() {
            Outcome::Solved(Solved { energy, kkt, .. }) => {
                count[0] += 1;
                assert!(kkt.largest() <= CERTIFIED, "{case}: {kkt:?}");
                let expected =
                    by_enumeration(&qp).expect("some set fits where there is a solution");
                let scale = expected.abs().max(1.0);
                assert!(
                    (energy - expected).abs() < 1e-8 * scale,
                    "{case}: {energy}, {expected}"
                );
            }
            Outcome::Unbounded(_) => {
                count[1] += 1;
                assert_eq!(by_enumeration(&qp), None, "{case}");
            }
            Outcome::Infeasible(_) => {
                count[2] += 1;
                assert_eq!(by_enumeration(&qp), None, "{case}");
            }
        }
    }
    println!("solved, unbounded, infeasible: {count:?}");
    assert!(count.iter().all(|&c| c >= 200), "{count:?}");
}

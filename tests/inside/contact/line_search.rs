//! Unit tests of `src/contact/line_search.rs`.

use super::*;
use crate::testing::with_session;

/// One dof: K = 2, f = 8, rows u ≤ c. Displacements u belong to the force 8 − 2 u in all rows together.
fn point(u: f64, c: &[f64]) -> LineSearchPoint {
    let force = (8.0 - 2.0 * u) / c.len() as f64;
    LineSearchPoint {
        gap: c.iter().map(|c| u - c).collect(),
        force: vec![force; c.len()],
        motion: Default::default(),
    }
}

/// φ(u) = u² − 8 u + ½ Σ C (s)₊².
fn value(u: f64, c: &[f64], penalty: &Penalty) -> f64 {
    let s = penalty.pull(&point(u, c));
    let springs = s.iter().zip(penalty.compliance);
    let springs: f64 = springs.map(|(s, d)| 0.5 * d * s.max(0.0).powi(2)).sum();
    u * u - 8.0 * u + springs
}

#[test]
fn the_minimum_along_the_step() {
    with_session(|session| {
        let gaps = [1.0, 1.5, 2.0, 3.0];
        let penalty = Penalty {
            law: &[Law::Unilateral; 4],
            multiplier: &[0.0, 0.1, 0.0, 2.0],
            compliance: &[0.5, 0.01, 1e-6, 0.3],
            discs: &[],
            anchors: None,
            tuning: &Tuning::DEFAULT,
        };
        for from in [-5.0, 0.0, 1.2] {
            let (a, b) = (point(from, &gaps), point(4.0, &gaps));
            let t = penalty.minimum(session.comm(), [&a, &b], false);
            let t = t.expect("φ falls towards the load's displacement");
            let at = |t: f64| value(from + t * (4.0 - from), &gaps, &penalty);
            for other in (0..=1000).map(|k| f64::from(k) / 1000.0) {
                assert!(
                    at(t) <= at(other) + 1e-9 * at(other).abs(),
                    "{from}: {t} {other}"
                );
                let change = penalty.change(session.comm(), [&a, &b], other);
                let known = at(other) - at(0.0);
                assert!((change - known).abs() <= 1e-12 * known.abs().max(1.0));
            }
            assert!(t > 0.0 && t < 1.0);
            // The length that is taken is no shorter, and brings a tenth of that.
            let taken = penalty.length(session.comm(), [&a, &b], false);
            let taken = taken.expect("φ falls");
            assert!(t <= taken && taken <= 1.0);
            assert!(at(0.0) - at(taken) >= 0.1 * (at(0.0) - at(t)));
        }
    });
}

#[test]
fn a_step_to_the_minimum_has_its_full_length() {
    with_session(|session| {
        let penalty = Penalty {
            law: &[Law::Unilateral],
            multiplier: &[0.0],
            compliance: &[0.5],
            discs: &[],
            anchors: None,
            tuning: &Tuning::DEFAULT,
        };
        // u² − 8u + (u − 1)₊² has its minimum at 2.5.
        let (a, b) = (point(0.0, &[1.0]), point(2.5, &[1.0]));
        assert_eq!(penalty.length(session.comm(), [&a, &b], false), Some(1.0));
        assert_eq!(penalty.length(session.comm(), [&b, &a], false), None);
        assert_eq!(penalty.length(session.comm(), [&b, &b], false), None);
    });
}

#[test]
fn a_step_may_go_beyond_its_end() {
    with_session(|session| {
        let penalty = Penalty {
            law: &[Law::Unilateral],
            multiplier: &[0.0],
            compliance: &[0.5],
            discs: &[],
            anchors: None,
            tuning: &Tuning::DEFAULT,
        };
        let start = point(0.0, &[1.0]);
        for end in [1e-6, 0.1, 1.0, 2.0, 2.5, 3.0] {
            let end = [&start, &point(end, &[1.0])];
            let t = penalty.length(session.comm(), end, true);
            let t = t.expect("φ falls");
            let u = t * (end[1].gap[0] + 1.0);
            assert!((u - 2.5).abs() < 1e-9, "{t} {u}");
        }
    });
}

#[test]
fn rows_that_do_not_count_change_nothing() {
    with_session(|session| {
        let of = |law: &[Law], compliance: &[f64]| {
            let penalty = Penalty {
                law,
                multiplier: &[0.0, 0.0],
                compliance,
                discs: &[],
                anchors: None,
                tuning: &Tuning::DEFAULT,
            };
            let from = LineSearchPoint {
                gap: vec![-1.0, 7.0],
                force: vec![8.0, 3.0],
                motion: Default::default(),
            };
            let to = LineSearchPoint {
                gap: vec![3.0, -9.0],
                force: vec![0.0, -5.0],
                motion: Default::default(),
            };
            penalty.length(session.comm(), [&from, &to], false)
        };
        assert_eq!(
            of(&[Law::Unilateral, Law::Tie], &[0.1, 0.0]),
            of(&[Law::Unilateral, Law::Tie], &[0.1, 1.0])
        );
    });
}

/// Two bodies, each with one motion α and nothing else: u = α, no K. The load e pulls, rows u ≤ c hold.
#[test]
fn anchors_count_along_the_step() {
    with_session(|session| {
        let (e, c) = ([3.0, -1.0], [0.5, 2.0]);
        let anchors = Anchors::given(vec![2.0, 0.5], vec![0.1, -0.2]);
        let penalty = Penalty {
            law: &[Law::Unilateral; 2],
            multiplier: &[0.0, 0.3],
            compliance: &[0.5, 0.1],
            discs: &[],
            anchors: Some(&anchors),
            tuning: &Tuning::DEFAULT,
        };
        // Any λ with y = e − λ has K u = f − Bᵀλ − y.
        let point = |u: [f64; 2], force: [f64; 2]| LineSearchPoint {
            gap: vec![u[0] - c[0], u[1] - c[1]],
            force: force.to_vec(),
            motion: [u.to_vec(), vec![e[0] - force[0], e[1] - force[1]]],
        };
        let value = |u: [f64; 2]| -> f64 {
            let s = penalty.pull(&point(u, [0.0; 2]));
            let of = |k: usize| {
                let stretch = u[k] - [0.1, -0.2][k];
                let spring = 0.5 * penalty.compliance[k] * s[k].max(0.0).powi(2);
                0.5 * [2.0, 0.5][k] * stretch * stretch - e[k] * u[k] + spring
            };
            of(0) + of(1)
        };
        let (a, b) = ([-1.0, 1.0], [2.0, 2.5]);
        let ends = [&point(a, [0.7, 0.0]), &point(b, [-0.4, 1.5])];
        for t in [0.1, 0.5, 1.0] {
            let at = [0, 1].map(|k| a[k] + t * (b[k] - a[k]));
            let (is, should) = (
                penalty.change(session.comm(), ends, t),
                value(at) - value(a),
            );
            assert!((is - should).abs() < 1e-13, "{t}: {is} {should}");
        }
    });
}

//! Unit tests of `src/contact/feasible_set.rs`.

use super::*;

/// A half-line, a disc beside its centre, an interval, and an entry that does not change.
fn set() -> FeasibleSet {
    FeasibleSet {
        lower: vec![
            0.5,
            f64::NEG_INFINITY,
            f64::NEG_INFINITY,
            f64::NEG_INFINITY,
            0.0,
        ],
        fixed: vec![false, false, false, false, true],
        discs: vec![
            Disc {
                rows: vec![1, 2],
                radius: 2.0,
            },
            Disc {
                rows: vec![3],
                radius: 0.25,
            },
        ],
        shift: vec![0.0, 3.0, -1.0, 0.5, 0.0],
    }
}

/// x + shift of the disc, relative to its radius.
fn size(x: &[f64]) -> f64 {
    (x[1] + 3.0).hypot(x[2] - 1.0) / 2.0
}

#[test]
fn points_come_to_their_bounds() {
    let set = set();
    let x = set.nearest(&[0.0, 3.0, 4.0, -1.0, 7.0]);
    assert!((size(&x) - 1.0).abs() < 1e-15);
    assert_eq!((x[0], x[3], x[4]), (0.5, -0.75, 7.0));
    assert_eq!(set.free(&x), [false; 5]);
    let x = set.nearest(&[1.0, 0.3, -1.9, 0.2, 7.0]);
    assert_eq!(set.free(&x), [true, true, true, true, false]);
    assert!((x[1] + 3.0 - 0.3).abs() < 1e-15 && (x[2] - 1.0 + 1.9).abs() < 1e-15);
}

/// A step as far as there is room ends at a bound, and one that is a little longer outside of the set.
#[test]
fn a_step_goes_as_far_as_there_is_room() {
    let set = set();
    let start = set.nearest(&[1.0, 0.3, -1.9, 0.2, 7.0]);
    let directions = [
        [0.2, 0.0, 0.0, 0.0, 0.0],
        [-1.0, 0.1, 0.0, 0.0, 0.0],
        [-1.0, 1.0, 2.0, 0.0, 0.0],
        [-1.0, -0.5, 1.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0, 0.1, 0.0],
        [-1.0, 0.0, 0.0, -0.1, 0.0],
    ];
    for p in directions {
        let room = set.room(&start, &p);
        assert!(room > 0.0 && room.is_finite());
        let mut x = start.clone();
        set.go(&mut x, &p, room);
        let free = set.free(&x);
        assert!(free[..4].contains(&false), "{p:?}: {x:?}");
        for (i, x) in x.iter().enumerate() {
            assert!((x - (start[i] - room * p[i])).abs() < 1e-14);
        }
        let farther: Vec<f64> = (0..5).map(|i| start[i] - 1.001 * room * p[i]).collect();
        let out = [
            0.5 - farther[0],
            size(&farther) - 1.0,
            (farther[3] + 0.5).abs() - 0.25,
        ];
        assert!(out.iter().any(|v| *v > 0.0), "{p:?}");
        let mut x = start.clone();
        set.go(&mut x, &p, 0.999 * room);
        assert_eq!(set.free(&x), set.free(&start));
    }
    assert_eq!(set.room(&start, &[-1.0, 0.0, 0.0, 0.0, 0.0]), f64::INFINITY);
}

/// On the edge β is what a gradient has along it and inwards; a gradient straight outwards is none.
#[test]
fn gradients_on_the_edge_point_into_the_set() {
    let set = set();
    let x = set.nearest(&[2.0, 3.0, 4.0, 0.1, 7.0]);
    let out = [(x[1] + 3.0) / 2.0, (x[2] - 1.0) / 2.0];
    let along = [-out[1], out[0]];
    let gradient = |a: f64, b: f64| {
        let t = [0, 1].map(|k| a * out[k] + b * along[k]);
        vec![0.0, t[0], t[1], 0.0, 0.0]
    };
    let beta = |a: f64, b: f64, alpha: f64| {
        let [phi, beta] = set.split(&x, &gradient(a, b), alpha);
        assert_eq!(phi, [0.0; 5]);
        [
            beta[1] * out[0] + beta[2] * out[1],
            beta[1] * along[0] + beta[2] * along[1],
        ]
    };
    let near = |a: [f64; 2], b: [f64; 2], by: f64| (a[0] - b[0]).hypot(a[1] - b[1]) < by;
    // −g points outwards, and the multiplier of the bound balances it.
    assert!(near(beta(-3.0, 0.0, 0.5), [0.0, 0.0], 1e-13));
    // −g points inwards.
    assert!(near(beta(1.0, 0.3, 0.5), [1.0, 0.3], 1e-13));
    // Along the edge: the tangent as the step becomes short, and never more than it.
    assert!(near(beta(0.0, 1.0, 1e-6), [0.0, 1.0], 1e-6));
    assert!(near(beta(-1.0, 1.0, 1e-6), [0.0, 1.0], 1e-5));
    let far = beta(-1.0, 1.0, 0.5);
    assert!(far[0] > 0.0 && far[1] > 0.0 && far[0].hypot(far[1]) < 1.0);
    // A step of that length along β ends on the edge.
    let v = set.split(&x, &gradient(-1.0, 1.0), 0.5)[1].clone();
    assert!((set.room(&x, &v) - 0.5).abs() < 1e-12);
}

/// A disc without a radius holds its entries, one without a bound lets them go.
#[test]
fn discs_of_any_radius() {
    let mut set = set();
    set.discs[0].radius = 0.0;
    let x = set.nearest(&[1.0, 0.3, -1.9, 0.2, 7.0]);
    let [phi, beta] = set.split(&x, &[0.0, 1.0, 2.0, 0.0, 0.0], 0.1);
    assert_eq!((phi[1], phi[2], beta[1], beta[2]), (0.0, 0.0, 0.0, 0.0));
    set.discs[0].radius = f64::INFINITY;
    let x = set.nearest(&[1.0, 300.0, -1.9, 0.2, 7.0]);
    assert!(set.free(&x)[1]);
    let g = [0.0, 1.0, 2.0, 0.0, 0.0];
    assert_eq!(set.split(&x, &g, 0.1)[0][1..3], [1.0, 2.0]);
    assert_eq!(set.reduced(&x, &g, 0.1)[1..3], [1.0, 2.0]);
    assert_eq!(set.room(&x, &g), f64::INFINITY);
}

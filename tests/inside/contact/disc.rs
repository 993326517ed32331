use super::Disc;

fn disc() -> Disc {
    Disc {
        rows: vec![2, 0],
        radius: 2.0,
    }
}

/// Points inside the disc, outside of it, and at its centre.
const POINTS: [[f64; 2]; 4] = [[0.5, -1.0], [3.0, 4.0], [-2.5, 0.1], [0.0, 0.0]];

#[test]
fn rows_are_taken_in_their_order() {
    assert_eq!(disc().of(&[1.0, 2.0, 3.0]), [3.0, 1.0]);
    let flat = Disc {
        rows: vec![1],
        radius: 1.0,
    };
    assert_eq!(flat.of(&[1.0, 2.0, 3.0]), [2.0, 0.0]);
}

#[test]
fn the_projection_is_the_nearest_point() {
    let disc = disc();
    for s in POINTS {
        let p = disc.project(s);
        assert!(p[0].hypot(p[1]) <= disc.radius * (1.0 + 1e-15));
        // (s − p)·(q − p) ≤ 0 for all q of the disc.
        for k in 0..64 {
            let (sin, cos) = (f64::from(k) / 10.0).sin_cos();
            let q = [disc.radius * cos, disc.radius * sin];
            let work = (s[0] - p[0]) * (q[0] - p[0]) + (s[1] - p[1]) * (q[1] - p[1]);
            assert!(work <= 1e-14, "{s:?}: {work}");
        }
    }
}

#[test]
fn the_projection_is_the_gradient_of_the_value() {
    let (disc, h) = (disc(), 1e-6);
    for s in POINTS {
        let p = disc.project(s);
        for k in 0..2 {
            let at = |d: f64| {
                let mut s = s;
                s[k] += d;
                s
            };
            let slope = (disc.value(at(h)) - disc.value(at(-h))) / (2.0 * h);
            assert!((slope - p[k]).abs() < 1e-9, "{s:?}: {slope}, {p:?}");
            let mut v = [0.0; 2];
            v[k] = 1.0;
            let told = disc.derivative(s, v);
            let (more, less) = (disc.project(at(h)), disc.project(at(-h)));
            for c in 0..2 {
                let slope = (more[c] - less[c]) / (2.0 * h);
                assert!((slope - told[c]).abs() < 1e-9, "{s:?}: {slope}, {told:?}");
            }
        }
    }
}

#[test]
fn a_disc_without_a_radius_has_no_force() {
    let disc = Disc {
        rows: vec![0, 1],
        radius: 0.0,
    };
    assert_eq!(disc.project([1.0, -1.0]), [0.0, 0.0]);
    assert_eq!(disc.value([1.0, -1.0]), 0.0);
    assert_eq!(disc.project([0.0, 0.0]), [0.0, 0.0]);
}

use super::{FrictionCone, NodeForce};
use crate::substructures::FrictionBound;

fn cone(bound: FrictionBound) -> FrictionCone {
    FrictionCone {
        rows: vec![0, 1, 2],
        bound,
    }
}

fn cones() -> Vec<FrictionCone> {
    let coulomb = |coefficient, limit| FrictionBound::Coulomb { coefficient, limit };
    vec![
        cone(coulomb(0.5, f64::INFINITY)),
        cone(coulomb(0.0, f64::INFINITY)),
        cone(coulomb(0.5, 1.0)),
        cone(FrictionBound::Tresca(1.5)),
        cone(FrictionBound::Tresca(0.0)),
    ]
}

/// Forces on all faces of the sets, off their edges.
fn forces() -> Vec<NodeForce> {
    let mut out = Vec::new();
    for n in [-3.0, -0.7, 0.3, 1.1, 2.9, 7.3] {
        for t in [0.11, 0.9, 2.3, 9.7] {
            for angle in [0.3f64, 2.0, 4.4] {
                out.push([n, t * angle.cos(), t * angle.sin()]);
            }
        }
    }
    out
}

fn dot(a: NodeForce, b: NodeForce) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn minus(a: NodeForce, b: NodeForce) -> NodeForce {
    [0, 1, 2].map(|k| a[k] - b[k])
}

#[test]
fn the_projection_is_the_nearest_force_of_the_set() {
    for cone in cones() {
        let inside: Vec<NodeForce> = forces().iter().map(|&s| cone.project(s)).collect();
        for p in &inside {
            assert!(p[0] >= 0.0 && p[1].hypot(p[2]) <= cone.bound.at(p[0]) * (1.0 + 1e-14));
        }
        for s in forces() {
            let p = cone.project(s);
            for &q in &inside {
                // (s − p)·(q − p) ≤ 0 for all q of the set.
                let work = dot(minus(s, p), minus(q, p));
                assert!(work <= 1e-12, "{cone:?} {s:?}: {work}");
            }
        }
    }
}

#[test]
fn the_derivative_is_that_of_the_projection() {
    let h = 1e-6;
    for (cone, s) in cones()
        .iter()
        .flat_map(|c| forces().into_iter().map(move |s| (c, s)))
    {
        for v in [
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [1.0, -2.0, 0.5],
        ] {
            let at = |d: f64| cone.project([0, 1, 2].map(|k| s[k] + d * v[k]));
            let slope = minus(at(h), at(-h)).map(|x| x / (2.0 * h));
            let off = minus(slope, cone.derivative(s, v));
            assert!(dot(off, off).sqrt() < 1e-8, "{cone:?} {s:?} {v:?}: {off:?}");
        }
    }
}

/// No force does more work on a motion than the support says, and some force does as much.
#[test]
fn the_support_is_the_most_work() {
    for cone in cones() {
        for w in forces() {
            let [most, beyond] = cone.support(w);
            // The projection of a long multiple of w is a force that does nearly the most work.
            let far = cone.project(w.map(|v| 1e6 * v));
            let work = dot(far, w);
            if beyond > 0.0 {
                assert!(work > 1e3, "{cone:?} {w:?}: {work}");
            } else {
                assert!((work - most).abs() < 1e-3, "{cone:?} {w:?}: {work}, {most}");
            }
        }
    }
}

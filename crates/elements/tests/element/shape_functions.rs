use super::super::testing::{inside, Random};
use super::*;

#[test]
fn functions_are_one_at_their_node_and_sum_to_one() {
    let mut random = Random::new(1);
    for kind in CellKind::ALL {
        let nodes = reference_nodes(kind);
        assert_eq!(nodes.len(), kind.nodes());
        for (a, &at) in nodes.iter().enumerate() {
            let value = shape(kind, at).value;
            for b in 0..nodes.len() {
                let expected = f64::from(u8::from(a == b));
                assert!(
                    (value[b] - expected).abs() < 1e-15,
                    "{kind:?} {a} {b}: {}",
                    value[b]
                );
            }
        }
        for _ in 0..20 {
            let at = inside(kind, &mut random);
            let s = shape(kind, at);
            assert!(
                (s.value.iter().sum::<f64>() - 1.0).abs() < 1e-14,
                "{kind:?}"
            );
            for j in 0..3 {
                assert!(s.slope[j].iter().sum::<f64>().abs() < 1e-13, "{kind:?}");
                // Σ N_a s_a is the point itself.
                let x: f64 = nodes.iter().zip(s.value).map(|(node, n)| node[j] * n).sum();
                assert!((x - at[j]).abs() < 1e-14, "{kind:?}");
            }
        }
    }
}

#[test]
fn slopes_are_those_of_finite_differences() {
    let (h, mut random) = (1e-5, Random::new(2));
    for kind in CellKind::ALL {
        for _ in 0..10 {
            let at = inside(kind, &mut random);
            let slope = shape(kind, at).slope;
            for j in 0..kind.dim() {
                let [before, after] = [-h, h].map(|step| {
                    let mut at = at;
                    at[j] += step;
                    shape(kind, at).value
                });
                for a in 0..kind.nodes() {
                    let difference = (after[a] - before[a]) / (2.0 * h);
                    assert!(
                        (slope[j][a] - difference).abs() < 1e-8,
                        "{kind:?} {j} {a}: {} {difference}",
                        slope[j][a]
                    );
                }
            }
        }
    }
}

#[test]
fn quadratic_functions_are_reproduced_by_cells_of_second_order() {
    let mut random = Random::new(3);
    let f = |[x, y, z]: [f64; 3]| 1.0 + x - 2.0 * y + x * x - 3.0 * x * y + y * z - 2.0 * z * z;
    for kind in CellKind::ALL.into_iter().filter(|kind| kind.order() == 2) {
        let nodes = reference_nodes(kind);
        for _ in 0..10 {
            let at = inside(kind, &mut random);
            let value = shape(kind, at).value;
            let sum: f64 = nodes.iter().zip(value).map(|(&node, n)| n * f(node)).sum();
            assert!((sum - f(at)).abs() < 1e-13, "{kind:?}");
        }
    }
}

#[test]
fn on_a_side_the_functions_are_those_of_the_side() {
    let mut random = Random::new(4);
    for kind in CellKind::ALL {
        let nodes = reference_nodes(kind);
        for side in kind.sides() {
            for _ in 0..5 {
                let on_side = shape(side.kind, inside(side.kind, &mut random)).value;
                let places: Vec<usize> = side.nodes.iter().map(|&p| usize::from(p)).collect();
                let mut at = [0.0; 3];
                for (&p, n) in places.iter().zip(on_side) {
                    for d in 0..3 {
                        at[d] += n * nodes[p][d];
                    }
                }
                let value = shape(kind, at).value;
                for a in 0..kind.nodes() {
                    let expected = places
                        .iter()
                        .position(|&p| p == a)
                        .map_or(0.0, |p| on_side[p]);
                    assert!((value[a] - expected).abs() < 1e-14, "{kind:?} {side:?} {a}");
                }
            }
        }
    }
}

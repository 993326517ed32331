//! Unit tests of `crates/cli/src/balance.rs`.

use super::*;

/// A square that is held at its left side.
fn scene() -> Scene {
    let text =
        "dimension = 2\nphysics = \"elasticity\"\n[[body]]\nname = \"a\"\nsize = 1\nelements = 2\n\
                young = 1\ndirichlet = [\"left\"]\nspring = { bottom = 1 }\n";
    Scene::parse("a.toml", text).expect("a scene")
}

/// A load of 2 downwards at the middle of the right side, a reaction at the left side with its moment, and `springs`.
fn sums(springs: f64) -> ForceSums {
    let mut sums = ForceSums::default();
    sums.load.add([0.5, 0.0, 0.0], [0.0, -2.0, 0.0]);
    sums.springs.add([0.0, -0.5, 0.0], [0.0, springs, 0.0]);
    sums.reaction.add([-0.5, 0.5, 0.0], [-1.5, 1.5, 0.0]);
    sums.reaction.add([-0.5, -0.5, 0.0], [1.5, 0.0, 0.0]);
    sums.reaction.moment[2] = 1.0;
    sums
}

#[test]
fn what_the_forces_leave_is_a_fault_beyond_the_tolerance() {
    let scene = scene();
    let body = &scene.bodies[0];
    let error = IterationError {
        input: 0.0,
        free: Vec::new(),
        relative: 1e-6,
        largest: 100.0,
        energy: 0.0,
    };
    let of = |sums: &ForceSums, error: &IterationError| {
        body_balance(&scene, body, sums, (false, true, false), error)
    };
    let good = of(&sums(0.5), &error);
    assert!(good.beyond < 1e-6, "{}", good.beyond);
    assert!(good.record.imbalance < 1e-15);
    assert_eq!(good.record.springs, Some(Amount(vec![0.0, 0.5])));
    assert_eq!(good.record.moment_imbalance, None);
    assert!(good.record.held_moment_imbalance.unwrap() < 1e-15);
    // A force that is missing.
    let bad = of(&sums(0.4), &error);
    assert!(bad.beyond > 1e4, "{}", bad.beyond);
    // 0.1 of the sum of the sizes of the reactions.
    assert!((bad.record.imbalance - 0.1 / (1.5 * 2.0_f64.sqrt() + 1.5)).abs() < 1e-12);
    // The error of the iteration explains it where the body is stiff.
    let mut stiff = sums(0.4);
    stiff.resistance[1] = 1e6;
    let loose = IterationError {
        energy: 1e-3,
        free: Vec::new(),
        ..error
    };
    assert!(of(&stiff, &loose).beyond < 0.2);
    // A body that bears nothing has rounding of the forces of others.
    let mut idle = ForceSums::default();
    idle.contact.add([0.5, 0.0, 0.0], [1e-15, 0.0, 0.0]);
    let idle = of(&idle, &error);
    assert!(idle.beyond < 1e-3 && idle.record.imbalance < 1e-3);
    // Forces that are no numbers are never in balance.
    assert!(of(&sums(f64::NAN), &error).beyond.is_infinite());
}

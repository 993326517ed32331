//! Unit tests of `crates/lab/src/baselines/attempt.rs`.

use super::*;
use crate::testing::with_session;

#[test]
fn a_loop_that_does_not_settle_is_said_with_its_load_step() {
    let step = |steps, active: &[usize]| StepOutcome {
        iterations: Some(3 * steps),
        setup: 0.25,
        solve: 0.5,
        residual: 1e-9 * steps as f64,
        contact: ContactOutcome {
            steps: Some(steps),
            active: active.to_vec(),
        },
    };
    let (sum, residual) = together(vec![step(5, &[1, 2]), step(200, &[2])], 3);
    assert_eq!(
        (sum.iterations, sum.setup, sum.solve),
        (Some(615), 0.5, 1.0)
    );
    assert!((residual - 2e-7).abs() < 1e-20);
    let contact = sum.contact.clone().expect("the contact loop");
    assert_eq!((contact.steps, contact.active), (Some(205), vec![2]));
    let outcome = Outcome {
        reason: "DIVERGED_CONTACT_ITS".into(),
        ..sum
    };
    assert_eq!(
        unsolved(&outcome),
        "did not converge in load step 2: the states of its contacts did not settle in 200 steps of the loop \
         (DIVERGED_CONTACT_ITS)"
    );
    // A scene with one load step has no number of it.
    let (alone, _) = together(vec![step(8, &[])], 1);
    let outcome = Outcome {
        reason: "DIVERGED_CONTACT_SLIDES".into(),
        ..alone
    };
    assert!(outcome.load_steps.is_empty());
    let said = unsolved(&outcome);
    assert!(
        said.starts_with("did not converge: a body slides away in 8 steps"),
        "{said}"
    );
}

/// The end of an attempt, without its vector.
#[derive(Debug)]
struct End {
    residual: f64,
    iterations: Option<usize>,
    converged: bool,
}

/// Simulates an iteration that gains a digit a step in its own residual. The assembled residual is `factor` times
/// that, but at least `floor`; tolerances from `breaks_at` down make the iteration fail.
fn drive(target: f64, factor: f64, floor: f64, breaks_at: f64) -> (End, Option<String>) {
    with_session(move |session| {
        let (end, _, message) = solve_to(target, target, |rtol| {
            let steps = (-rtol.log10() - 1e-9).ceil();
            Ok(Attempt {
                u: vec![PetscVec::seq(session, 1)?],
                residual: (factor * 10_f64.powf(-steps)).max(floor),
                converged: rtol > breaks_at,
                outcome: Outcome {
                    iterations: Some(steps as usize),
                    ..Outcome::default()
                },
            })
        })
        .expect("nothing fails");
        let end = End {
            residual: end.residual,
            iterations: end.outcome.iterations,
            converged: end.converged,
        };
        (end, message)
    })
}

#[test]
fn tolerances_shrink_until_the_assembled_residual_is_met() {
    let (end, message) = drive(1e-6, 0.9, 0.0, 0.0);
    assert_eq!((end.iterations, message), (Some(6), None));
    let (end, message) = drive(1e-6, 300.0, 0.0, 0.0);
    assert!(
        end.residual <= 1e-6 && message.is_none(),
        "{end:?} {message:?}"
    );
    assert_eq!(end.iterations, Some(9));
}

#[test]
fn tolerances_grow_where_the_residual_falls_far_below() {
    let (end, message) = drive(1e-6, 2e-3, 0.0, 0.0);
    assert_eq!((end.iterations, message), (Some(4), None));
    assert!(end.residual <= 1e-6);
    // Two larger tolerances at most, whatever the residual is.
    let (end, message) = drive(1e-6, 0.0, 1e-20, 0.0);
    assert_eq!((end.iterations, message), (Some(2), None));
    // A larger tolerance that misses the target does not count.
    let (end, message) = with_session(|session| {
        let mut solves = 0;
        let (end, rtol, message) = solve_to(1e-6, 1e-6, |_| {
            solves += 1;
            Ok(Attempt {
                u: vec![PetscVec::seq(session, 1)?],
                residual: [1e-8, 2e-6, 0.0][solves - 1],
                converged: true,
                outcome: Outcome {
                    iterations: Some(10),
                    ..Outcome::default()
                },
            })
        })
        .expect("nothing fails");
        assert_eq!(rtol, 1e-6);
        (end.residual, message)
    });
    assert_eq!((end, message), (1e-8, None));
}

/// The residual at the end of a loop of states need not be smaller where the tolerance is: one solve in vain is no end.
#[test]
fn a_solve_may_gain_nothing_once() {
    let driven = |residuals: [f64; 4]| {
        with_session(move |session| {
            let mut solves = 0;
            let (end, _, message) = solve_to(1e-6, 1e-6, |_| {
                solves += 1;
                Ok(Attempt {
                    u: vec![PetscVec::seq(session, 1)?],
                    residual: residuals[solves - 1],
                    converged: true,
                    outcome: Outcome {
                        iterations: Some(10 * solves),
                        ..Outcome::default()
                    },
                })
            })
            .expect("nothing fails");
            (end.residual, solves, message.is_some())
        })
    };
    assert_eq!(driven([1.6e-6, 2.2e-6, 1e-7, 0.0]), (1e-7, 3, false));
    assert_eq!(driven([1.6e-6, 2.2e-6, 1.7e-6, 0.0]), (1.6e-6, 3, true));
}

#[test]
fn what_cannot_be_met_is_said() {
    let (end, message) = drive(1e-6, 300.0, 1e-5, 0.0);
    assert_eq!(end.residual, 1e-5);
    assert!(message.is_some_and(|m| m.contains("stays at 1.0e-5")));
    // An attempt that fails later does not discard what was reached.
    let (end, message) = drive(1e-6, 300.0, 0.0, 1e-7);
    assert!(end.converged && end.residual < 1e-3, "{end:?}");
    assert!(message.is_some_and(|m| m.contains("stays at")));
    let (end, message) = drive(1e-6, 1.0, 0.0, 1e-3);
    assert!(!end.converged && message.is_some_and(|m| m.contains("did not converge")));
}

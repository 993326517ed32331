//! Unit tests of `src/status.rs`.

use super::*;

#[test]
fn numbers_have_the_sign_of_what_happened() {
    let krylov = |code, name: &str| {
        let name = name.into();
        Status::Krylov(ConvergedReason { code, name })
    };
    let all = [
        (krylov(3, "CONVERGED_ATOL"), 3),
        (krylov(-4, "DIVERGED_DTOL"), -4),
        (Status::NothingToDo, 2),
        (Status::Rounding, 3),
        (Status::Refinement, -11),
        (Status::Certificate, -11),
        (Status::Balance, -11),
        (Status::Stagnation, -5),
        (Status::ContactSteps, -3),
    ];
    for (status, number) in all {
        assert_eq!(status.number(), number, "{status}");
        assert_eq!(status.converged(), number > 0, "{status}");
        assert_eq!(status.name().starts_with("CONVERGED"), number > 0);
    }
}

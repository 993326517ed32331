//! Scenes of `make soak` that once were wrong (docs/reliability.md).

use crate::soak::{fate, Fate};
use crate::testing::with_session;

/// Checks the fate of the scene of each seed.
fn fates(seeds: &'static [u64], right: fn(&Fate) -> bool) {
    with_session(move |session| {
        let dir = std::env::temp_dir().join(format!("fetifeti-soak-{}", std::process::id()));
        for &seed in seeds {
            let fate = fate(session, seed, &dir);
            assert!(right(&fate), "seed {seed}: {fate:?}");
        }
        let _ = std::fs::remove_dir_all(&dir);
    });
}

fn solved(fate: &Fate) -> bool {
    matches!(fate, Fate::Right(error) if *error < 1e-7)
}

fn refused(fate: &Fate) -> bool {
    matches!(fate, Fate::NoSolution(_))
}

/// A body stands where it likes: two solutions differ by a motion of any size without energy.
#[test]
fn errors_are_those_of_the_strains() {
    fates(
        &[1346, 3903, 10930, 15292, 27749, 32850, 41492, 42823],
        solved,
    );
}

/// Asked for Q = M⁻¹ where averages of the bodies' motions are motions of the bodies: GᵀM⁻¹G is singular.
#[test]
fn motions_that_the_preconditioner_does_not_see_are_projected_out() {
    fates(
        &[
            3117, 3248, 3661, 5944, 6790, 7352, 8940, 21574, 27946, 29709,
        ],
        solved,
    );
    fates(
        &[
            32613, 34645, 35321, 43043, 45787, 46374, 47243, 47262, 50018, 102422,
        ],
        solved,
    );
}

/// Normals that rounding has turned by 1e-17: translations across them were columns of G of such entries, and scaled to
/// length 1 they counted as held.
#[test]
fn a_body_does_not_move_across_a_normal() {
    fates(&[1201588], solved);
}

/// Q = M⁻¹ and bodies that differ by 10⁵: λ₀ was 10⁵ times as large as what balances the loads.
#[test]
fn multipliers_begin_no_larger_than_the_loads() {
    fates(&[430026, 47899, 408387], solved);
}

/// Q = I and stiffnesses that jump by 10⁵ inside bodies: κ is 1.6e6, and the residual falls long before the error.
#[test]
fn errors_fall_where_residuals_say_little() {
    fates(&[201564], solved);
}

/// SMALBE where the unconstrained problem is solved at once; bodies that touch without force; contact that holds all
/// that could move; SMALBE where bodies differ by 10⁵ and μ hardly moves.
#[test]
fn contact_loops_end() {
    fates(&[12082, 38045, 502808], solved);
    // It is solved; the reference solver is not made for it.
    fates(&[717674], |fate| matches!(fate, Fate::Undecided(_)));
}

/// Averages leave nothing to iterate upon, and sparse solves leave so much rounding that CG breaks down on it.
#[test]
fn a_breakdown_on_displacements_that_are_right_is_no_failure() {
    fates(&[804412], solved);
}

/// A minimum of the augmented Lagrangian whose rows turn out to be violated once the residual is small.
#[test]
fn loops_go_on_where_the_certificate_finds_rows_on_the_wrong_side() {
    fates(&[714014], solved);
}

/// Nothing holds a body sideways, and it moves up by 10³ times its strains: forces of this motion are rounding.
#[test]
fn motions_have_no_forces() {
    fates(&[601304], solved);
}

/// Given values deform stiff bodies: their energy is 10¹⁰ times that of the jumps that are left between soft ones.
#[test]
fn jumps_are_closed_that_the_energy_does_not_see() {
    fates(&[535376], solved);
}

/// Loads move bodies sideways that nothing holds: in the first two no pivot of GᵀG showed it, in the third the direct
/// solution had no node for a support.
#[test]
fn loads_that_nothing_stands_against_are_refused() {
    fates(&[23737, 37143, 49257], refused);
}

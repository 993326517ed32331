//! The constants of the contact loop.

use super::friction::tuning::FrictionTuning;

/// The named constants of the contact loop. They decide how a loop comes to its end. Which end is a solution is the
/// matter of the certificate, which knows only those whose names begin with `certified`.
///
/// Ten times less and more: measured on the examples with inequalities, by each method from the start (`cargo test
/// --test contact -- --ignored --nocapture constants_ten`): 113 steps and 541 iterations of the active set, 110 and 924
/// of the augmented Lagrangian, 80 and 1519 of SMALBE. No constant leads to another answer, and with one of them one
/// scene is not solved. Counts are at least one. Those that change nothing there are for what the examples have not:
/// hundreds of bodies, many rows that depend on each other, loops that come to a limit.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Tuning {
    // ---- the loop
    /// Steps of a strategy after which the loop asks whether the rows can carry the load. Most loops have ended before.
    ///
    /// Ten times less or more: nothing changes.
    pub doubt_after: usize,
    /// A row of a certified solution is on the wrong side if it pulls, or is violated, by more than this many
    /// tolerances, relative to the largest force of rows on an unknown, or the largest displacement. The energy changes
    /// by the square of the pull. Multipliers of rows that depend on each other may be larger than all forces, and are
    /// no measure.
    ///
    /// Ten times less or more: nothing changes.
    pub certified_wrong: f64,
    /// Rounding of certified multipliers, beside the loads, too, and of gaps: less than this says nothing, whatever the
    /// tolerance.
    ///
    /// Ten times less or more: nothing changes.
    pub certified_rounding: f64,
    /// Factor by which the tolerance becomes smaller where the loop goes on after a certificate.
    ///
    /// Ten times less or more: nothing changes.
    pub certified_reduction: f64,
    /// How often the loop goes on after a certificate. Rows that pull after that are no solution.
    ///
    /// Ten times less or more: nothing changes.
    pub certified_rounds: usize,

    // ---- rows on the wrong side
    /// A gap counts as violated if it is above this many times the largest remaining jump on the rows that hold. A row
    /// that depends on three others inherits the sum of their jumps.
    ///
    /// Ten times less: active set +3 steps, +76 iterations; SMALBE −2 steps, −92 iterations. Ten times more: active set
    /// +7 steps, +44 iterations; SMALBE +3 steps, −27 iterations.
    pub noise: f64,
    /// Rounding of multipliers, relative to the largest one or to the loads of a subdomain, and of gaps, relative to
    /// the largest displacement.
    ///
    /// Ten times less or more: nothing changes.
    pub rounding: f64,
    /// In a trial, a gap is violated only if it is above this many tolerances, relative to the largest displacement.
    /// Rows without force come and go by rounding.
    ///
    /// Ten times less or more: nothing changes.
    pub open_in_trial: f64,

    // ---- the active set
    /// Loose inner problems may have misled the sets if there was no progress for this many steps and more than
    /// `misled_rows` rows are wrong.
    ///
    /// Ten times less: active set +5 steps, +25 iterations. Ten times more: active set +7 steps, +25 iterations.
    pub misled_after: usize,
    /// Fewer wrong rows do not mislead.
    ///
    /// Ten times less: active set +0 steps, +10 iterations. Ten times more: active set +1 steps, +8 iterations.
    pub misled_rows: usize,
    /// Factor by which inner problems are then solved more exactly. With a smaller one they take iterations that save
    /// no steps.
    ///
    /// Ten times less: active set +1 steps, +16 iterations. Ten times more: active set +7 steps, +25 iterations.
    pub misled_reduction: f64,
    /// Factor by which all inner problems are solved more exactly in a run that tries the set which the augmented
    /// Lagrangian has found.
    ///
    /// Ten times less: active set +0 steps, +1 iterations; augmented Lagrangian −7 steps, −19 iterations. Ten times
    /// more: active set +1 steps, +3 iterations; augmented Lagrangian +2 steps, +89 iterations.
    pub exact_reduction: f64,
    /// A step is solved to the end if its residual has to fall by no more than this.
    ///
    /// Ten times less: active set −2 steps, +5 iterations; augmented Lagrangian −5 steps, −38 iterations. Ten times
    /// more: active set +3 steps, +1 iterations; augmented Lagrangian +0 steps, −1 iterations.
    pub near: f64,
    /// Largest jump on the rows that hold, relative to the residual in V. That residual does not contain the part of
    /// the jump that rigid motions close.
    ///
    /// Ten times less or more: nothing changes.
    pub closed: f64,
    /// Steps without progress after which the loop hands over.
    ///
    /// Ten times less: active set +4 steps, +260 iterations; augmented Lagrangian +20 steps, +146 iterations. Ten times
    /// more: active set +2 steps, −2 iterations.
    pub patience: usize,

    // ---- rigid motions and rows that depend on each other
    /// Work of a row on a motion below this, relative to the largest that it could be, is none.
    ///
    /// Ten times less or more: nothing changes.
    pub against: f64,
    /// The load counts as balanced where an iteration has found the part that rows cannot carry, if that is below this,
    /// relative to the loads.
    ///
    /// Ten times less or more: nothing changes.
    pub nearly_balanced: f64,
    /// The part of the load outside the cone of the rows may be rounding if it is below this, relative to the loads.
    ///
    /// Ten times less or more: nothing changes.
    pub balanced: f64,
    /// The gaps of a block contradict each other if NNLS comes this close to (Bᵀλ, cᵀλ) = (0, −1).
    ///
    /// Ten times less or more: nothing changes.
    pub contradiction: f64,
    /// cᵀN counts as zero below this, relative to its terms: rounding of given gaps.
    ///
    /// Ten times less or more: nothing changes.
    pub level: f64,
    /// Where no motion removes all violations, so many motions at most are looked at together for one that leaves
    /// least.
    ///
    /// Ten times less or more: nothing changes.
    pub placed_together: usize,
    /// Largest number of Newton steps to it.
    ///
    /// Ten times less or more: nothing changes.
    pub placed_steps: usize,
    /// Rigid bodies on unilateral springs: the last ε. Rounding of the factor is 1e-16, the softest motions of a
    /// thousand bodies in a row are 1e-6.
    ///
    /// Ten times less or more: nothing changes.
    pub springs_weak: f64,
    /// ε of the first round relative to its last value. Newton's directions are long where rows let a body loose, and
    /// steps short. A large ε first keeps bodies near each other. From forces of the loop the last ε is right at once.
    ///
    /// Ten times less or more: nothing changes.
    pub springs_first: f64,
    /// The ratio of ε from round to round.
    ///
    /// Ten times less or more: nothing changes.
    pub springs_fall: f64,
    /// Largest number of times that the anchor a follows α.
    ///
    /// Ten times less or more: nothing changes.
    pub springs_rounds: usize,
    /// Largest number of Newton steps in each.
    ///
    /// Ten times less or more: nothing changes.
    pub springs_steps: usize,
    /// A row stands against a motion of the springs if its work is above this, relative to the largest that it could
    /// be.
    ///
    /// Ten times less or more: nothing changes.
    pub springs_against: f64,

    // ---- lengths of steps
    /// Largest number of evaluations of φ' along a line.
    ///
    /// Ten times less or more: nothing changes.
    pub line_evaluations: usize,
    /// Two lengths that differ by less than this part are one.
    ///
    /// Ten times less or more: nothing changes.
    pub line_same: f64,
    /// A Newton step is long enough if φ falls by this part of what the best length brings.
    ///
    /// Ten times less: nothing changes. Ten times more: augmented Lagrangian +3 steps, +16 iterations.
    pub line_enough: f64,

    // ---- the augmented Lagrangian
    /// Stiffness 1/C of the springs in the first minimisation, relative to 1/diag(B diag(K)⁻¹ Bᵀ), that of the nodes,
    /// in compact bodies. Much softer springs take more minimisations, much stiffer ones more steps in each.
    ///
    /// Ten times less: active set +8 steps, +49 iterations; augmented Lagrangian +14 steps, +97 iterations. Ten times
    /// more: active set +6 steps, +45 iterations; augmented Lagrangian +56 steps, +311 iterations.
    pub stiffness: f64,
    /// Bodies are compact if they give way at the rows by no more than this many times what the nodes alone do. The
    /// springs of bodies that bend begin as many times softer as these are.
    ///
    /// Ten times less: active set +8 steps, +37 iterations; augmented Lagrangian +10 steps, +14 iterations. Ten times
    /// more: active set +3 steps, +24 iterations; augmented Lagrangian +11 steps, +122 iterations.
    pub compact: f64,
    /// Number of vectors of signs by which that is measured. The mean is then known to a factor of two, which is what
    /// the springs need.
    ///
    /// Ten times less: augmented Lagrangian +3 steps, +13 iterations. Ten times more: active set +2 steps, +16
    /// iterations; augmented Lagrangian +0 steps, +67 iterations.
    pub compact_samples: usize,
    /// Factor by which the springs become stiffer from one minimisation to the next.
    ///
    /// Ten times less: augmented Lagrangian +196 steps, +809 iterations and `spheres` not solved. Ten times more:
    /// active set +4 steps, +30 iterations; augmented Lagrangian +8 steps, −15 iterations.
    pub stiffer: f64,
    /// Largest stiffness of the springs, relative as `stiffness` is. Beyond it C is lost in the rounding of F.
    ///
    /// Ten times less or more: nothing changes.
    pub stiffest: f64,
    /// The set hardly changes if this many rows change, or `few_of_all` of all, whichever is more.
    ///
    /// Ten times less: augmented Lagrangian +4 steps, +15 iterations. Ten times more: augmented Lagrangian +2 steps,
    /// +27 iterations.
    pub few: f64,
    /// The set hardly changes if this part of all rows changes.
    ///
    /// Ten times less: augmented Lagrangian +0 steps, +1 iterations. Ten times more: augmented Lagrangian +12 steps,
    /// +78 iterations.
    pub few_of_all: f64,
    /// Reduction of the residual in a Newton step of the first minimisation. Springs turn jumps into forces, which are
    /// less exact than the jumps by the stiffness: with stiffer springs the residual falls further.
    ///
    /// Ten times less: active set +0 steps, +7 iterations; augmented Lagrangian −5 steps, −8 iterations. Ten times
    /// more: active set +9 steps, +34 iterations; augmented Lagrangian +45 steps, +267 iterations.
    pub reduction: f64,
    /// Factor on the reduction of the residual for another attempt, if the Newton step does not lead downwards.
    ///
    /// Ten times less or more: nothing changes.
    pub reduced_again: f64,
    /// Largest number of attempts at a Newton step that leads downwards.
    ///
    /// Ten times less or more: nothing changes.
    pub attempts: usize,
    /// Number of minimisations that end where the set hardly changes any more. Later ones go to the end: then
    /// convergence is proved.
    ///
    /// Ten times less: augmented Lagrangian +0 steps, −4 iterations. Ten times more: nothing changes.
    pub early: usize,
    /// A minimisation that ends early with more wrong rows than this is not followed by a trial. A trial with no more
    /// has twice the patience.
    ///
    /// Ten times less: active set +1 steps, +8 iterations; augmented Lagrangian +2 steps, +102 iterations. Ten times
    /// more: augmented Lagrangian −4 steps, −40 iterations.
    pub close: usize,
    /// Steps without progress after which a trial ends. It also ends if more than a few rows are wrong.
    ///
    /// Ten times less or more: nothing changes.
    pub trial_patience: usize,
    /// Steps in which the number of wrong rows does not fall, after which a set with few of them is tried before the
    /// minimisation ends. Each trial that fails doubles it. Where springs are stiff, rows without force come and go by
    /// rounding.
    ///
    /// Ten times less or more: nothing changes.
    pub flicker: usize,
    /// A step of a trial that is this much more exact than the best one counts wrong rows anew: it sees more of them.
    ///
    /// Ten times less or more: nothing changes.
    pub finer: f64,
    /// Least factor on the tolerance of a trial. It falls by `finer` with each minimum whose set turns out to be wrong:
    /// short waves of multipliers need more digits for their signs than displacements.
    ///
    /// Ten times less or more: nothing changes.
    pub most_digits: f64,

    // ---- anchors of bodies that bend
    /// A step has sent bodies away if their displacements are so many times as large as those of another step.
    ///
    /// Ten times less or more: nothing changes.
    pub far: f64,
    /// Factor by which anchors become softer from one minimisation to the next.
    ///
    /// Ten times less or more: nothing changes.
    pub softer: f64,
    /// A residual below this part of the largest so far is rounding.
    ///
    /// Ten times less or more: nothing changes.
    pub anchored_rounding: f64,

    // ---- SMALBE and MPRGP
    /// Number of steps of the power method. The norm is needed to a few per cent only, and ‖A‖ is one of the outer
    /// eigenvalues.
    ///
    /// Ten times less: SMALBE −2 steps, −92 iterations. Ten times more: SMALBE +3 steps, −66 iterations.
    pub power_steps: usize,
    /// ϱ relative to the largest eigenvalue of Pᵀ F P. With a larger ϱ the ascent of μ takes fewer steps, but the
    /// number of expansion steps, of length 2/ϱ, grows.
    ///
    /// Ten times less: SMALBE +3 steps, −328 iterations. Ten times more: SMALBE −9 steps, +133 iterations.
    pub penalty: f64,
    /// Γ: a face is left if the chopped gradient is larger than this many times the free gradient.
    ///
    /// Ten times less: SMALBE −8 steps, +85 iterations. Ten times more: SMALBE +0 steps, +620 iterations.
    pub gamma: f64,
    /// Curvature below this, relative to ‖A‖, counts as zero.
    ///
    /// Ten times less or more: nothing changes.
    pub flat: f64,
    /// η: the largest projected gradient at the end of an inner problem, relative to ‖b‖.
    ///
    /// Ten times less: SMALBE −3 steps, +17 iterations. Ten times more: SMALBE −3 steps, −20 iterations.
    pub eta: f64,
    /// M₀: the projected gradient that is allowed per violated balance, relative to ϱ.
    ///
    /// Ten times less: SMALBE −1 steps, +30 iterations. Ten times more: SMALBE +17 steps, +73 iterations.
    pub m_start: f64,
    /// Factor by which M shrinks when the Lagrangian does not grow enough.
    ///
    /// Ten times less or more: nothing changes.
    pub m_shrink: f64,
    /// Largest number of products with A in one inner problem.
    ///
    /// Ten times less: SMALBE +3 steps, −27 iterations. Ten times more: nothing changes.
    pub products: usize,
    /// Number of steps without a change after which a set of SMALBE is tried.
    ///
    /// Ten times less: SMALBE −6 steps, −24 iterations. Ten times more: SMALBE +4 steps, +6 iterations.
    pub smalbe_patience: usize,
    /// Number of times that the search goes on from the end of such a trial. Later it keeps its own iterates, for which
    /// convergence is proved.
    ///
    /// Ten times less or more: nothing changes.
    pub jumps: usize,
    /// Number of steps that change no row and do not halve the residual after which SMALBE gives up. Where bodies
    /// differ in stiffness by many orders μ would take thousands.
    ///
    /// Ten times less: SMALBE −4 steps, −17 iterations. Ten times more: nothing changes.
    pub stalled: usize,
    /// Number of active-set steps after a set of SMALBE, before SMALBE goes on.
    ///
    /// Ten times less: SMALBE +529 steps, +1410 iterations. Ten times more: SMALBE −1 steps, −92 iterations.
    pub closing_steps: usize,
    /// The constants of friction.
    pub friction: FrictionTuning,
}

impl Tuning {
    /// The constants that the loop has been measured with.
    pub const DEFAULT: Tuning = Tuning {
        doubt_after: 20,
        certified_wrong: 10.0,
        certified_rounding: 1e-12,
        certified_reduction: 1e-2,
        certified_rounds: 3,
        noise: 3.0,
        rounding: 1e-14,
        open_in_trial: 0.1,
        misled_after: 2,
        misled_rows: 8,
        misled_reduction: 0.1,
        exact_reduction: 1e-2,
        near: 3e-3,
        closed: 1e3,
        patience: 4,
        against: 1e-8,
        nearly_balanced: 1e-7,
        balanced: 1e-9,
        contradiction: 1e-8,
        level: 1e-12,
        placed_together: 64,
        placed_steps: 50,
        springs_weak: 1e-8,
        springs_first: 1e8,
        springs_fall: 1e-2,
        springs_rounds: 10,
        springs_steps: 60,
        springs_against: 1e-6,
        line_evaluations: 60,
        line_same: 1e-12,
        line_enough: 0.1,
        stiffness: 30.0,
        compact: 7.0,
        compact_samples: 4,
        stiffer: 3.0,
        stiffest: 1e9,
        few: 8.0,
        few_of_all: 0.02,
        reduction: 1e-3,
        reduced_again: 1e-3,
        attempts: 3,
        early: 8,
        close: 4,
        trial_patience: 1,
        flicker: 1,
        finer: 0.1,
        most_digits: 1e-4,
        far: 1e3,
        softer: 10.0,
        anchored_rounding: 1e-11,
        power_steps: 15,
        penalty: 8.0,
        gamma: 1.0,
        flat: 1e-13,
        eta: 0.1,
        m_start: 0.1,
        m_shrink: 0.1,
        products: 2_000,
        smalbe_patience: 3,
        jumps: 4,
        stalled: 20,
        closing_steps: 5,
        friction: FrictionTuning::DEFAULT,
    };
}

impl Default for Tuning {
    fn default() -> Tuning {
        Tuning::DEFAULT
    }
}

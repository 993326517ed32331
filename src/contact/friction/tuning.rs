//! The constants of friction.

/// The constants of friction. They decide how a loop comes to its end, and not which end is a solution.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct FrictionTuning {
    /// Factor on the reduction of the residual in a step while the states of nodes change. Loose steps mislead the
    /// states.
    ///
    /// A hundred times more: iterations are a quarter fewer in most scenes, but a roller bearing with friction takes 48
    /// steps in place of 9, and a box of spheres more than 200 in place of 86.
    pub finer: f64,
    /// Factor on the tolerance of the user in a step while states change.
    pub digits: f64,
    /// The factor where states stay and forces of friction are renewed: the forces are a small change.
    pub renewed: f64,
    /// Renewals of the forces in a step at most.
    pub renewals: usize,
    /// After this many steps without fewer wrong nodes and rows, states wait until forces of friction are at rest.
    pub patience: usize,
    /// Forces are at rest there if none has to change by more than this, relative to the largest force of a row.
    pub rest: f64,
    /// Renewals from which the next forces are mixed.
    pub mixed: usize,
    /// Forces of friction are at rest if a step moves none by more than this many tolerances, relative to the largest
    /// force of a row.
    pub still: f64,
    /// A slip says nothing if it is below this many of the jumps that a step leaves on rows that hold.
    pub nothing: f64,
    /// Slips, and contradictions between where nodes stick, are nothing below this many tolerances, relative to the
    /// largest displacement.
    pub even: f64,
    /// A tangential row follows from other rows if not more than this of it lies outside their span.
    pub follows: f64,
    /// A row across a slip follows from them up to this. Nearly all of it may be held by another contact, while the
    /// slip still turns.
    pub across: f64,
    /// Springs across slips are at most this many times softer than nodes; softer ones are left out.
    pub soft: f64,
    /// As many times at nodes that share their rows with others: there M⁻¹ has rows that depend on each other, and soft
    /// springs make it a bad one. With `soft` in their place 11 of 18 walls in space do not settle; with this at all
    /// nodes a box of spheres does not.
    pub soft_at_edges: f64,
    /// Springs across slips that are stiffer than nodes by this factor are rigid.
    pub rigid: f64,
    /// After so many only the nodes that are most wrong on each body change their states. With 4 a front of slip along
    /// a belt takes twice the steps, with 15 a wall of 985 bricks takes more than 200 in place of 43.
    pub waits: usize,
    /// They are the nodes that are wrong by this much of the worst one. With 1 a front of slip that goes along a
    /// contact gets a node ahead in each step.
    pub most_wrong: f64,
    /// After this many steps without fewer wrong nodes and rows the augmented Lagrangian takes over.
    pub wanders: usize,
    /// Its springs are at first as many times stiffer than the nodes.
    pub springs: f64,
    /// They are so at most.
    pub stiffest: f64,
    /// A Newton step there reduces its residual by this. Looser steps lead along kinks of φ: a tenth of them is taken,
    /// and 50 are no minimum.
    pub reduction: f64,
    /// Springs across slips that are softer by this are left out there.
    pub softest: f64,
    /// Newton steps of a minimisation at most.
    pub newton_steps: usize,
    /// Minima with the same states before the loop on states is tried.
    pub settled: usize,
    /// Steps of the loop on states without fewer wrong nodes and rows, after which it was tried in vain.
    pub tried: usize,
    /// After so many steps in a row in which rows had to be put back, those that push come before friction.
    pub tips: usize,
    /// MPRGP's projected steps are at most as many times longer than 2/‖A‖.
    pub longer: f64,
    /// A body may slide away if nothing but friction beyond its bound has held it after this many steps in a row.
    pub slides: usize,
}

impl FrictionTuning {
    /// The constants as they are used.
    pub const DEFAULT: FrictionTuning = FrictionTuning {
        finer: 1e-4,
        digits: 1e-2,
        renewed: 0.1,
        renewals: 10,
        patience: 3,
        rest: 1e-5,
        mixed: 4,
        still: 5.0,
        nothing: 10.0,
        even: 3.0,
        follows: 1e-8,
        across: 0.3,
        soft: 100.0,
        soft_at_edges: 2.0,
        rigid: 1e-2,
        waits: 8,
        most_wrong: 0.3,
        wanders: 45,
        springs: 30.0,
        stiffest: 1e4,
        reduction: 1e-6,
        softest: 30.0,
        newton_steps: 50,
        settled: 2,
        tried: 4,
        tips: 2,
        longer: 100.0,
        slides: 8,
    };
}

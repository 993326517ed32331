//! Unit tests of `src/contact/friction/node.rs`.

use super::*;

/// A node with the normal row 0 and the tangential row 1, μ = 0.5 and k = 2.
pub fn node(state: NodeState, g: f64) -> Node {
    Node {
        normal: 0,
        tangential: vec![1],
        bound: FrictionBound::Coulomb {
            coefficient: 0.5,
            limit: 3.0,
        },
        stiffness: 2.0,
        springs: [1e-2, 100.0],
        state,
        g,
        axis: [1.0, 0.0],
        slipped: 0.0,
        excess: 0.0,
    }
}

/// The state and g that follow from λ_n, λ_t and w; whether the normal row is to hold.
fn after(
    mut node: Node,
    [normal, force, slip]: [f64; 3],
    touches: bool,
) -> (NodeState, f64, Change) {
    let change = node.update(
        &Step {
            lambda: &[normal, force],
            gaps: &[0.0, slip],
            active: &[touches, true],
            nothing: 1e-3,
        },
        false,
    );
    (node.state, node.g, change)
}

const RIGHT: NodeState = NodeState::Slip([1.0, 0.0]);
const LEFT: NodeState = NodeState::Slip([-1.0, 0.0]);

#[test]
fn a_node_sticks_up_to_its_bound() {
    let stuck = || node(NodeState::Stick, 0.0);
    for (force, state) in [(0.9, NodeState::Stick), (1.1, RIGHT), (-1.1, LEFT)] {
        let (found, g, change) = after(stuck(), [2.0, force, 0.0], true);
        assert_eq!((found, g), (state, 1.0));
        assert_eq!(change.flips, state != NodeState::Stick);
    }
    // The limit is below μ λ_n.
    assert_eq!(after(stuck(), [10.0, 3.5, 0.0], true).1, 3.0);
    // Nor does a normal row that pulls make friction.
    assert_eq!(after(stuck(), [-1.0, 0.0, 0.0], true).1, 0.0);
}

#[test]
fn a_node_slips_on_and_sticks_before_it_turns() {
    let slips = || node(RIGHT, 1.0);
    // It slips on, and its force follows λ_n.
    let (state, g, change) = after(slips(), [4.0, 1.0, 0.7], true);
    assert_eq!((state, g, change.flips), (RIGHT, 2.0, false));
    assert!((change.moves - 1.0).abs() < 1e-15);
    // It has come back a little: |λ_t + k w| ≤ g.
    assert_eq!(after(slips(), [2.0, 1.0, -0.1], true).0, NodeState::Stick);
    // It has come back far.
    assert_eq!(after(slips(), [2.0, 1.0, -9.0], true).0, NodeState::Stick);
}

#[test]
fn a_node_that_opens_has_no_friction_but_a_given_one() {
    assert_eq!(
        after(node(RIGHT, 1.0), [0.0, 1.0, 0.3], false).0,
        NodeState::Apart
    );
    // A node that begins to touch slips on where it has slid, at first without a force.
    let begins = after(node(NodeState::Apart, 0.0), [0.0, 0.0, 0.3], true);
    assert_eq!((begins.0, begins.1), (RIGHT, 0.0));
    let still = after(node(NodeState::Apart, 0.0), [0.0, 0.0, 0.0], true);
    assert_eq!(still.0, NodeState::Stick);
    let given = Node {
        bound: FrictionBound::Tresca(0.25),
        ..node(RIGHT, 0.25)
    };
    assert_eq!(given.force(), [0.25, 0.0]);
    assert_eq!(after(given, [0.0, 0.25, 0.3], false).0, RIGHT);
}

#[test]
fn the_error_is_a_force() {
    let of = |state, [normal, force, slip]: [f64; 3]| {
        node(state, 1.0).error(&Step {
            lambda: &[normal, force],
            gaps: &[0.0, slip],
            active: &[true, true],
            nothing: 0.0,
        })
    };
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-15, "{a} {b}");
    near(of(NodeState::Stick, [2.0, 0.5, 0.0]), 0.0);
    near(of(NodeState::Stick, [2.0, -1.5, 0.0]), 0.5);
    near(of(RIGHT, [2.0, 1.0, 0.3]), 0.0);
    near(of(RIGHT, [2.0, 0.75, 0.3]), 0.25);
    // It slips against its force.
    near(of(RIGHT, [2.0, 1.0, -0.3]), 0.6);
}

/// A node in space that slips along (0.6, 0.8): its rows are turned there, and the second one is a spring.
#[test]
fn rows_in_space_are_turned_along_the_slip() {
    let mut node = Node {
        tangential: vec![1, 2],
        ..node(NodeState::Slip([0.6, 0.8]), 1.0)
    };
    node.slipped = 0.25;
    assert_eq!((node.holds(), node.across()), ([false, true], 0.25));
    let turn = node.turn().expect("a turn");
    assert_eq!((turn.rows, turn.by), ([1, 2], [0.6, 0.8]));
    assert_eq!(node.turn(), None);
    let [along, across] = node.on_rows(node.force());
    assert!((along - 1.0).abs() < 1e-15 && across.abs() < 1e-15);
    // A force across of 0.1, and the slip that belongs to it: w turns towards it by as much as λ_t.
    let step = Step {
        lambda: &[2.0, 1.0, 0.1],
        gaps: &[0.0, 0.25, 0.0],
        active: &[true, false, true],
        nothing: 0.0,
    };
    let change = node.update(&step, false);
    assert!(!change.flips);
    let NodeState::Slip(d) = node.state else {
        panic!("{node:?}");
    };
    let angle = 0.1f64.atan();
    let wanted = [
        0.6 * angle.cos() - 0.8 * angle.sin(),
        0.8 * angle.cos() + 0.6 * angle.sin(),
    ];
    assert!(
        (d[0] - wanted[0]).abs() < 1e-14 && (d[1] - wanted[1]).abs() < 1e-14,
        "{d:?}"
    );
}

/// Another contact may hold a node that slips, and then its slip vanishes: it stays, and does not stick again and
/// again.
#[test]
fn a_node_that_others_hold_stays_at_its_bound() {
    let slips = || node(RIGHT, 1.0);
    for slip in [0.0, 9e-4, -9e-4] {
        assert_eq!(after(slips(), [2.0, 1.0, slip], true).0, RIGHT);
    }
    assert_eq!(after(slips(), [2.0, 1.0, -2e-3], true).0, NodeState::Stick);
    // One that sticks, and is moved all the same, gives way.
    let moved = |slip: f64| {
        let mut node = node(NodeState::Stick, 1.0);
        let gives = node.gives_way(&Step {
            lambda: &[2.0, 0.0],
            gaps: &[0.0, slip],
            active: &[true, true],
            nothing: 1e-3,
        });
        (gives, node.state)
    };
    assert_eq!(moved(-2e-3), (true, LEFT));
    assert_eq!(moved(9e-4), (false, NodeState::Stick));
}

/// Springs across a slip that are far softer than the node are left out.
#[test]
fn soft_springs_across_a_slip_do_not_hold() {
    let mut node = Node {
        tangential: vec![1, 2],
        ..node(RIGHT, 1e-3)
    };
    node.slipped = 1e-2;
    assert_eq!((node.holds(), node.across()), ([false, true], 10.0));
    node.slipped = 1.0;
    assert_eq!((node.holds(), node.across()), ([false, false], 0.0));
    node.g = 0.0;
    assert_eq!(node.holds(), [false, false]);
}

/// How wrong a node is counts as a force, and one that waits keeps its state and has the new g.
#[test]
fn a_node_that_waits_has_its_state_and_the_new_bound() {
    let step = |lambda: &'static [f64], gaps: &'static [f64], touches: bool| Step {
        lambda,
        gaps,
        active: if touches {
            &[true, true]
        } else {
            &[false, true]
        },
        nothing: 1e-3,
    };
    let stuck = node(NodeState::Stick, 0.0);
    assert_eq!(
        stuck.wrong(&step(&[2.0, 1.5], &[0.0, 0.0], true), true),
        0.5
    );
    assert_eq!(
        stuck.wrong(&step(&[2.0, 0.5], &[0.0, 0.0], true), true),
        0.0
    );
    // Normal rows leave with their pull, and enter with what nodes bear over the gap.
    assert_eq!(
        stuck.wrong(&step(&[-0.3, 0.0], &[0.0, 0.0], false), true),
        0.3
    );
    let apart = node(NodeState::Apart, 0.0);
    assert_eq!(
        apart.wrong(&step(&[0.0, 0.0], &[0.1, 0.0], true), false),
        0.2
    );
    let mut slips = node(RIGHT, 0.5);
    let back = step(&[2.0, 0.5], &[0.0, -1.0], true);
    assert_eq!(slips.wrong(&back, true), 2.0);
    assert!(slips.update(&back, true).flips);
    assert_eq!((slips.state, slips.g), (RIGHT, 1.0));
    slips.update(&back, false);
    assert_eq!(slips.state, NodeState::Stick);
}

//! Unit tests of `src/contact/friction/nodes.rs`: two nodes of one contact, and one of another.

use super::super::node::tests::node;
use super::*;
use crate::testing::with_session;

fn three() -> Nodes {
    let list = (0..3).map(|k| {
        let mut node = node(NodeState::Stick, 0.0);
        (node.normal, node.tangential) = (2 * k, vec![2 * k + 1]);
        node
    });
    let groups = [[0, 0], [0, 0], [0, 1]].map(|c| [c, [3, c[1]], c]).to_vec();
    Nodes::new(list.collect(), groups, FrictionTuning::DEFAULT)
}

/// Nodes whose forces are above their bound of 1 by `excess`.
fn step(nodes: &mut Nodes, comm: &SimpleCommunicator, excess: [f64; 3]) -> Changes {
    let lambda: Vec<f64> = excess.iter().flat_map(|e| [2.0, 1.0 + e]).collect();
    let step = Step {
        lambda: &lambda,
        gaps: &[0.0; 6],
        active: &[true; 6],
        nothing: 1e-3,
    };
    nodes.update(comm, &step, (&[true; 6], &mut [true; 6], true))
}

fn slipping(nodes: &Nodes) -> Vec<bool> {
    let slips = |n: &Node| matches!(n.state, NodeState::Slip(_));
    nodes.list.iter().map(slips).collect()
}

#[test]
fn states_that_wander_change_where_they_are_most_wrong() {
    with_session(|session| wander(session.comm()));
}

fn wander(comm: &SimpleCommunicator) {
    let excess = [1.0, 0.1, 0.2];
    let mut nodes = three();
    assert_eq!(step(&mut nodes, comm, excess).flips, 3);
    assert_eq!(slipping(&nodes), [true; 3]);
    let mut nodes = three();
    (0..=FrictionTuning::DEFAULT.waits).for_each(|_| {
        nodes.wander(5);
    });
    // Those that wait are counted: the loop is not at its end.
    assert_eq!(step(&mut nodes, comm, excess).flips, 3);
    assert_eq!(slipping(&nodes), [true, false, true]);

    // Rows are put back at the node that slips least, and later only where no other row helps.
    let scores = |nodes: &Nodes| {
        let mut scores = vec![0.0; 6];
        nodes.score(1.0, &mut scores);
        [scores[1], scores[3], scores[5]]
    };
    let [a, b, c] = scores(&nodes);
    assert!(a < c && c < b && b < 0.0, "{a} {b} {c}");
    (0..FrictionTuning::DEFAULT.tips).for_each(|_| {
        assert!(!nodes.slides(true));
    });
    let [a, b, c] = scores(&nodes);
    assert!(a < c && c < b && b < -1e100, "{a} {b} {c}");
    let mut held = vec![false; 6];
    Nodes::sticking(&nodes.list, &mut held);
    assert_eq!(held, [false, false, false, true, false, false]);
    let mut back = held.clone();
    back[1] = true;
    assert!(nodes.stick(comm, &held, &back));
    assert_eq!(slipping(&nodes), [false, false, true]);
    // A body slides away after many steps in a row.
    assert!(!nodes.slides(false));
    assert!(!(0..FrictionTuning::DEFAULT.slides).any(|_| nodes.slides(true)));
    assert!(nodes.slides(true));
}

/// Nodes of several contacts wait for each other where these share a body.
#[test]
fn the_contacts_of_a_body_change_in_turn() {
    with_session(|session| {
        let comm = session.comm();
        let mut nodes = three();
        nodes.groups[2][2] = [3, 0];
        (0..=FrictionTuning::DEFAULT.waits).for_each(|_| {
            nodes.wander(5);
        });
        step(&mut nodes, comm, [1.0, 0.1, 0.2]);
        assert_eq!(slipping(&nodes), [true, false, false]);
    });
}

//! Sums at the nodes that subdomains of several ranks share.

use std::collections::HashMap;

use bytemuck::{Pod, Zeroable};
use fetifeti::problem::BodyNode;
use parallel::exchange::exchange_by_rank;
use petsc::Session;
use scene::assembly::recovery::NodalStressSum;
use scene::Scene;

/// The sum of a rank at a node: body, node and material.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct NodeSum {
    at: [usize; 3],
    sum: NodalStressSum,
}

/// Adds to every sum those of other ranks for the same node and material. Collective.
///
/// A rank that follows from the node alone collects its sums and returns the total: no rank needs to know the others'
/// subdomains.
pub(super) fn add(
    session: &Session,
    scene: &Scene,
    nodes: &[BodyNode],
    material: &[u32],
    sums: &mut [NodalStressSum],
) {
    let size = session.size();
    if size == 1 {
        return;
    }
    let mut outgoing: Vec<Vec<NodeSum>> = vec![Vec::new(); size];
    let mut sent: Vec<Vec<usize>> = vec![Vec::new(); size];
    for (p, (&BodyNode { body, node }, sum)) in nodes.iter().zip(&*sums).enumerate() {
        if scene.bodies[body].mesh().multiplicity(node) > 1 {
            let home = (body + node) % size;
            let at = [body, node, material[p] as usize];
            outgoing[home].push(NodeSum { at, sum: *sum });
            sent[home].push(p);
        }
    }
    let received = exchange_by_rank(session.comm(), outgoing);
    let mut totals: HashMap<[usize; 3], NodalStressSum> = HashMap::new();
    for part in received.iter().flatten() {
        totals.entry(part.at).or_default().merge(&part.sum);
    }
    let total = |part: &NodeSum| totals[&part.at];
    let answers = received.iter().map(|list| list.iter().map(total).collect());
    let answers: Vec<Vec<NodalStressSum>> = exchange_by_rank(session.comm(), answers.collect());
    for (&p, total) in sent.iter().flatten().zip(answers.iter().flatten()) {
        sums[p] = *total;
    }
}

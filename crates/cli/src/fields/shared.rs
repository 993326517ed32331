//! Sums at the nodes that subdomains of several ranks share.

use std::collections::HashMap;

use fetifeti::problem::BodyNode;
use parallel::exchange::exchange_words;
use petsc::Session;
use scene::assembly::recovery::Sum;
use scene::Scene;

/// Words of a sum.
const WORDS: usize = 13;

/// Adds to every sum those of other ranks for the same node and material. Collective.
///
/// A rank that follows from the node alone collects its sums and returns the total: no rank needs to know the others'
/// subdomains.
pub(super) fn add(
    session: &Session,
    scene: &Scene,
    nodes: &[BodyNode],
    material: &[u32],
    sums: &mut [Sum],
) {
    let size = session.size();
    if size == 1 {
        return;
    }
    let mut outgoing: Vec<Vec<u64>> = vec![Vec::new(); size];
    let mut sent: Vec<Vec<usize>> = vec![Vec::new(); size];
    for (p, (&BodyNode { body, node }, sum)) in nodes.iter().zip(&*sums).enumerate() {
        if scene.bodies[body].mesh().multiplicity(node) > 1 {
            let home = (body + node) % size;
            outgoing[home].extend([body as u64, node as u64, u64::from(material[p])]);
            outgoing[home].extend(pack(sum));
            sent[home].push(p);
        }
    }
    let received = exchange_words(session.comm(), outgoing);
    let records = |words: &'_ [u64]| -> Vec<([u64; 3], Sum)> {
        let record = |w: &[u64]| ([w[0], w[1], w[2]], unpack(&w[3..]));
        words.chunks_exact(3 + WORDS).map(record).collect()
    };
    let mut totals: HashMap<[u64; 3], Sum> = HashMap::new();
    for (key, sum) in received.iter().flat_map(|words| records(words)) {
        totals.entry(key).or_default().merge(&sum);
    }
    let answer = |words: &Vec<u64>| -> Vec<u64> {
        let records = records(words);
        records
            .iter()
            .flat_map(|(key, _)| pack(&totals[key]))
            .collect()
    };
    let answers = exchange_words(session.comm(), received.iter().map(answer).collect());
    for (sent, words) in sent.iter().zip(&answers) {
        for (&p, total) in sent.iter().zip(words.chunks_exact(WORDS)) {
            sums[p] = unpack(total);
        }
    }
}

fn pack(sum: &Sum) -> impl Iterator<Item = u64> {
    let values = sum.values.into_iter().chain([sum.weight]);
    values.map(f64::to_bits)
}

fn unpack(words: &[u64]) -> Sum {
    Sum {
        values: std::array::from_fn(|k| f64::from_bits(words[k])),
        weight: f64::from_bits(words[WORDS - 1]),
    }
}

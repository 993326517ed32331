//! Which body has which cells and nodes of a deck.

use deck::Deck;
use fetifeti::problem::BodyNode;
use mesh::partition::Components;

/// The bodies of a deck, in numbers.
#[derive(Debug, Clone)]
pub(super) struct DeckNumbering {
    /// The cells of each body, increasing.
    pub parts: Vec<Vec<u32>>,
    /// Body and node of each point.
    nodes: Vec<Option<BodyNode>>,
}

impl DeckNumbering {
    pub fn new(deck: &Deck) -> DeckNumbering {
        let mesh = &deck.mesh;
        let parts = Components::by_nodes(&mesh.cells).members();
        let mut body_of = vec![usize::MAX; mesh.points.len()];
        for (b, part) in parts.iter().enumerate() {
            for &c in part {
                for &k in mesh.cells.nodes(c as usize) {
                    body_of[k as usize] = b;
                }
            }
        }
        // Bodies number their nodes in the order of the file.
        let mut next = vec![0; parts.len()];
        let number = |b: usize| {
            (b != usize::MAX).then(|| {
                next[b] += 1;
                BodyNode {
                    body: b,
                    node: next[b] - 1,
                }
            })
        };
        let nodes = body_of.into_iter().map(number).collect();
        DeckNumbering { parts, nodes }
    }

    /// Body and node of a point; `None` if no cell has it.
    pub fn node(&self, point: u32) -> Option<BodyNode> {
        self.nodes[point as usize]
    }
}

use super::*;

#[test]
fn sides_fit_the_cells() {
    for kind in CellKind::ALL {
        assert!(kind.corners() <= kind.nodes() && kind.nodes() <= CellKind::MOST_NODES);
        assert_eq!(kind.linear().nodes(), kind.corners());
        let mut counts = vec![0; kind.nodes()];
        for side in kind.sides() {
            assert_eq!(side.kind.dim() + 1, kind.dim());
            assert_eq!(side.nodes.len(), side.kind.nodes(), "{}", kind.name());
            assert_eq!(
                side.kind.order(),
                if kind.dim() == 1 { 1 } else { kind.order() }
            );
            for &node in side.nodes {
                counts[usize::from(node)] += 1;
            }
        }
        // Each edge of a solid lies on two faces; so do its middle nodes.
        if kind.dim() == 3 && kind.order() == 2 {
            let edges = kind.edges().len();
            let middles = &counts[kind.corners()..kind.corners() + edges];
            assert!(middles.iter().all(|&n| n == 2), "{}", kind.name());
        }
    }
}

/// The middle node of each edge of a side is the middle node of that edge of the cell.
#[test]
fn middles_of_sides_are_middles_of_the_cell() {
    for kind in CellKind::ALL
        .into_iter()
        .filter(|k| k.order() == 2 && k.dim() > 1)
    {
        for side in kind.sides() {
            for (e, ends) in side.kind.edges().iter().enumerate() {
                let ends = ends.map(|k| side.nodes[usize::from(k)]);
                let middle = side.nodes[side.kind.corners() + e];
                let same = |edge: &&[u8; 2]| **edge == ends || [edge[1], edge[0]] == ends;
                let edge = kind
                    .edges()
                    .iter()
                    .position(|edge| same(&edge))
                    .expect("an edge");
                assert_eq!(
                    usize::from(middle),
                    kind.corners() + edge,
                    "{}",
                    kind.name()
                );
            }
        }
    }
}

/// The faces of a solid close it: each edge is passed once in each direction.
#[test]
fn faces_are_oriented_consistently() {
    for kind in CellKind::ALL.into_iter().filter(|k| k.dim() == 3) {
        let mut passed = std::collections::BTreeSet::new();
        for side in kind.sides() {
            let n = side.kind.corners();
            for k in 0..n {
                let edge = (side.nodes[k], side.nodes[(k + 1) % n]);
                assert!(passed.insert(edge), "{}: {edge:?} twice", kind.name());
            }
        }
        assert_eq!(passed.len(), 2 * kind.edges().len());
        assert!(passed.iter().all(|&(a, b)| passed.contains(&(b, a))));
    }
}

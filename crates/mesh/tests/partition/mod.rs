use super::meshes::{
    hexes, middle, mixed, quads, second_order, tets, triangles, without, Mesh, Noise,
};
use super::*;

/// The heaviest part beside the mean.
fn heaviest(partition: &Partition, work: &[f64]) -> f64 {
    let mut sizes = vec![0.0; partition.n];
    for (&p, w) in partition.part.iter().zip(work) {
        sizes[p as usize] += w;
    }
    let mean = work.iter().sum::<f64>() / partition.n as f64;
    sizes.iter().copied().fold(0.0, f64::max) / mean
}

/// The cells of each part.
fn members(partition: &Partition) -> Vec<Vec<u32>> {
    let mut members = vec![Vec::new(); partition.n];
    for (&p, c) in partition.part.iter().zip(0..) {
        members[p as usize].push(c);
    }
    members
}

/// Number of connected pieces of all parts, by a search of its own.
fn pieces(adjacency: &Adjacency, part: &[u32]) -> usize {
    let mut seen = vec![false; part.len()];
    let mut pieces = 0;
    for start in 0..part.len() {
        if std::mem::replace(&mut seen[start], true) {
            continue;
        }
        pieces += 1;
        let mut stack = vec![start];
        while let Some(c) = stack.pop() {
            for d in adjacency.neighbours(c).map(|d| d as usize) {
                if part[d] == part[c] && !std::mem::replace(&mut seen[d], true) {
                    stack.push(d);
                }
            }
        }
    }
    pieces
}

/// Cuts a mesh and checks what holds of every partition.
fn cut(mesh: &Mesh, work: &[f64], n: usize) -> Partition {
    let adjacency = Adjacency::new(&mesh.cells);
    let partition = Partition::new(&mesh.cells, &adjacency, work, n);
    assert_eq!(partition.part.len(), mesh.cells.len());
    let members = members(&partition);
    assert!(
        members.iter().all(|m| !m.is_empty()),
        "a part of {n} is empty"
    );
    assert_eq!(
        pieces(&adjacency, &partition.part),
        partition.n,
        "parts are connected"
    );
    let again = Partition::new(&mesh.cells, &adjacency, work, n);
    assert_eq!(partition, again, "the same again");
    partition
}

fn even(mesh: &Mesh) -> Vec<f64> {
    vec![1.0; mesh.cells.len()]
}

/// The copies of nodes that the cuts make: all nodes of all parts, less the nodes of the mesh.
fn copies_of(mesh: &Mesh, part: &[u32], n: usize) -> usize {
    let sharing = Sharing::new(&mesh.cells, part, n, mesh.points.len());
    let shared = sharing.shared();
    shared.map(|node| sharing.of(node).len() - 1).sum()
}

fn copies(mesh: &Mesh, partition: &Partition) -> usize {
    copies_of(mesh, &partition.part, partition.n)
}

#[test]
fn parts_are_connected_and_balanced() {
    let meshes = [
        triangles([60, 40], |x, y| {
            (x - 20.0).hypot(y - 20.0) < 9.0 || (x - 42.0).hypot(y - 25.0) < 6.0
        }),
        quads([50, 50]),
        tets([12, 10, 9]),
        hexes([30, 8, 8]),
        mixed([8, 8, 9]),
        second_order(&tets([6, 6, 6])),
    ];
    for mesh in meshes {
        for n in [1, 2, 3, 7, 16, 50] {
            let partition = cut(&mesh, &even(&mesh), n);
            assert_eq!((partition.n, partition.pieces), (n, 1));
            let cell = n as f64 / mesh.cells.len() as f64;
            let most = heaviest(&partition, &even(&mesh));
            assert!(
                most <= 1.08 + cell,
                "{n} parts of {} cells: {most}",
                mesh.cells.len()
            );
        }
    }
}

#[test]
fn work_is_balanced_not_cells() {
    let mesh = tets([12, 12, 12]);
    let weight = |c: usize| if middle(&mesh, c)[0] < 4.0 { 10.0 } else { 1.0 };
    let work: Vec<f64> = (0..mesh.cells.len()).map(weight).collect();
    let partition = cut(&mesh, &work, 16);
    assert!(heaviest(&partition, &work) < 1.08);
    // Five sixths of the work are in a third of the cells.
    let cells: Vec<usize> = members(&partition).iter().map(Vec::len).collect();
    assert!(cells.iter().max() > cells.iter().min().map(|m| 4 * m).as_ref());
    // Random work over four orders of magnitude.
    let mut noise = Noise(3);
    let work: Vec<f64> = mesh
        .cells
        .iter()
        .map(|_| 10f64.powf(4.0 * noise.next()))
        .collect();
    assert!(heaviest(&cut(&mesh, &work, 8), &work) < 1.08);
}

/// Interfaces beside those of blocks, which no cut of a cube into as many equal parts gets far below, and beside those
/// that METIS 5.2.1 leaves on the same bricks in the same order (k-way, contiguous, seed 1). Counted are the copies of
/// nodes, Σ (subdomains − 1).
#[test]
fn interfaces_are_small() {
    let plane = triangles([100, 100], |_, _| false);
    for across in [2usize, 4, 8] {
        let blocks = (101 + across - 1).pow(2) - 101usize.pow(2);
        let ours = copies(&plane, &cut(&plane, &even(&plane), across.pow(2)));
        assert!(
            ours * 100 < blocks * 112,
            "{across}: {ours} beside {blocks}"
        );
    }
    let space = hexes([24, 24, 24]);
    for (across, metis) in [(2usize, 2496), (3, 5306), (4, 7631)] {
        let blocks = (25 + across - 1).pow(3) - 25usize.pow(3);
        let ours = copies(&space, &cut(&space, &even(&space), across.pow(3)));
        assert!(
            ours * 100 < blocks * 125 && ours < metis,
            "{across}: {ours} beside {blocks} and {metis}"
        );
    }
}

#[test]
fn neighbouring_numbers_are_near() {
    let mesh = tets([16, 16, 16]);
    let n = 64;
    let partition = cut(&mesh, &even(&mesh), n);
    // Blocks of consecutive parts, as ranks get them, beside a cut into as many parts.
    for ranks in [2, 4, 8] {
        let rank: Vec<u32> = partition
            .part
            .iter()
            .map(|p| p * ranks / n as u32)
            .collect();
        let blocks = copies_of(&mesh, &rank, ranks as usize);
        let best = copies(&mesh, &cut(&mesh, &even(&mesh), ranks as usize));
        assert!(blocks < 2 * best, "{ranks} ranks: {blocks} beside {best}");
    }
}

#[test]
fn needles_are_cut_across() {
    for mesh in [hexes([1, 1, 1000]), tets([1, 1, 300]), quads([1000, 1])] {
        for n in [2, 7, 40] {
            let partition = cut(&mesh, &even(&mesh), n);
            assert!(heaviest(&partition, &even(&mesh)) < 1.1);
            let shared = copies(&mesh, &partition);
            let across = if mesh.cells.kind(0).dim() == 2 { 2 } else { 4 };
            assert!(
                shared <= 2 * across * (n - 1),
                "{shared} copies in {n} parts"
            );
        }
    }
    // Along a chain of bricks every part has two neighbours at most.
    let mesh = hexes([1, 1, 1000]);
    assert_eq!(copies(&mesh, &cut(&mesh, &even(&mesh), 40)), 4 * 39);
}

#[test]
fn as_many_parts_as_there_can_be() {
    let one = hexes([1, 1, 1]);
    assert_eq!(cut(&one, &[3.0], 5).n, 1);
    let few = tets([2, 2, 2]);
    assert_eq!(cut(&few, &even(&few), 48).n, 48);
    assert_eq!(cut(&few, &even(&few), 1000).n, 48);
    let nearly = quads([10, 10]);
    assert_eq!(cut(&nearly, &even(&nearly), 90).n, 90);
}

/// One cell has all the work: the others still make parts.
#[test]
fn a_cell_heavier_than_a_part() {
    let mesh = quads([20, 20]);
    let mut work = even(&mesh);
    work[210] = 1e6;
    let partition = cut(&mesh, &work, 8);
    assert_eq!(partition.n, 8);
    let heavy = partition.part[210] as usize;
    assert!(members(&partition)[heavy].len() < 50);
}

/// Pieces that touch in a node, in an edge, or not at all: each has parts of its own, by its work.
#[test]
fn pieces_are_kept_apart() {
    let grid = hexes([8, 8, 8]);
    // Two cubes that share an edge, one of half the edge length; a third that is apart.
    let inside = |x: [f64; 3]| {
        let first = x[0] < 4.0 && x[1] < 4.0;
        let second = (4.0..6.0).contains(&x[0]) && (4.0..6.0).contains(&x[1]) && x[2] < 2.0;
        let third = x[0] > 7.0 && x[1] > 7.0 && x[2] > 7.0;
        first || second || third
    };
    let mesh = without(&grid, |c| !inside(middle(&grid, c)));
    let partition = cut(&mesh, &even(&mesh), 9);
    assert_eq!((partition.n, partition.pieces), (9, 3));
    let components = Components::by_sides(&Adjacency::new(&mesh.cells));
    let of_piece = |k: u32| {
        let pairs = components
            .of
            .iter()
            .zip(&partition.part)
            .filter(|(&c, _)| c == k);
        pairs
            .map(|(_, &p)| p)
            .collect::<std::collections::BTreeSet<u32>>()
    };
    // 128 cells, 8 and 1: all but two parts are in the first.
    let [a, b, c] = [0, 1, 2].map(of_piece);
    assert_eq!([a.len(), b.len(), c.len()], [7, 1, 1]);
    assert!(a.is_disjoint(&b) && b.is_disjoint(&c) && a.is_disjoint(&c));
    // Fewer parts than pieces cannot be.
    assert_eq!(cut(&mesh, &even(&mesh), 1).n, 3);
}

/// The numbering of the cells changes the parts, but not how good they are.
#[test]
fn renumbered_cells_give_as_good_parts() {
    let mesh = tets([10, 10, 10]);
    let mut order: Vec<usize> = (0..mesh.cells.len()).collect();
    let mut noise = Noise(7);
    for i in (1..order.len()).rev() {
        order.swap(i, (noise.next() * (i + 1) as f64) as usize);
    }
    let mut cells = Cells::default();
    order
        .iter()
        .for_each(|&c| cells.push(mesh.cells.kind(c), mesh.cells.nodes(c)));
    let shuffled = Mesh {
        cells,
        points: mesh.points.clone(),
    };
    let one = copies(&mesh, &cut(&mesh, &even(&mesh), 20)) as f64;
    let two = copies(&shuffled, &cut(&shuffled, &even(&mesh), 20)) as f64;
    assert!((one / two - 1.0).abs() < 0.1, "{one} and {two}");
}

#[test]
fn numbers_of_subdomains() {
    for dim in [2, 3] {
        assert_eq!(subdomains_for(0, dim), 1);
        assert_eq!(subdomains_for(100, dim), 1);
        let many = subdomains_for(1_000_000, dim);
        assert!((100..5000).contains(&many));
        assert!((2 * many).abs_diff(subdomains_for(2_000_000, dim)) <= 1);
    }
}

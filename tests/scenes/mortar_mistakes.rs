//! Surfaces that cannot be joined, and the one sentence for each.

use super::meshes::Model;
use crate::support::surface_mesh::gmsh;

/// Two plates of squares, `a` on [0, 2] × [0, 1] and `b`, whose lower left corner is `at`, with groups at their sides.
fn plates(at: [f64; 2]) -> String {
    let mut points = Vec::new();
    let mut add = |n: usize, [x, y]: [f64; 2]| {
        let first = points.len();
        for k in 0..=n {
            let right = x + 2.0 * k as f64 / n as f64;
            points.extend([[right, y, 0.0], [right, y + 1.0, 0.0]]);
        }
        let of = |k: usize| first + 2 * k;
        let cells: Vec<_> = (0..n)
            .map(|k| vec![of(k), of(k + 1), of(k + 1) + 1, of(k) + 1])
            .collect();
        let bottom: Vec<_> = (0..n).map(|k| vec![of(k), of(k + 1)]).collect();
        let top: Vec<_> = (0..n).map(|k| vec![of(k) + 1, of(k + 1) + 1]).collect();
        (cells, bottom, top)
    };
    let (a, a_bottom, a_top) = add(2, [0.0, 0.0]);
    let (b, b_bottom, b_top) = add(3, at);
    let one = vec![a_top[0].clone()];
    let dot = vec![vec![a_top[0][0]]];
    gmsh(
        &points,
        &[
            ("a", a),
            ("b", b),
            ("a_bottom", a_bottom),
            ("a_top", a_top),
            ("b_bottom", b_bottom),
            ("b_top", b_top),
            ("a_one", one),
            ("a_dot", dot),
        ],
    )
}

/// The scene of both plates with a joint of the surfaces.
fn scene(surfaces: [&str; 2], more: &str) -> String {
    format!(
        "physics = \"elasticity\"\n[mesh]\nfile = \"m.msh\"\n[[body]]\nname = \"a\"\ndirichlet = {{ a_bottom = 0 }}\n\
         [[body]]\nname = \"b\"\n[[contact]]\nsurfaces = {surfaces:?}\n{more}\n"
    )
}

#[test]
fn surfaces_that_cannot_meet_are_refused() {
    let above = Model::new("above", &plates([0.0, 1.0]));
    let refuses = |surfaces: [&str; 2], part: &str| above.refuses(&scene(surfaces, ""), part);
    refuses(
        ["a_top", "no"],
        "the boundary group `no`, which no body of the mesh has",
    );
    refuses(
        ["a_dot", "b_bottom"],
        "the boundary group `a_dot` of points alone where edges of a body were expected",
    );
    refuses(
        ["a_top", "a_top"],
        "the surface `a_top` is named twice, and only body `a` has it",
    );
    refuses(
        ["a_top", "a_bottom"],
        "side `a_top` of `a` and side `a_bottom` of `a` overlap by 1, where `a` is 1 thick",
    );
    refuses(
        ["a_bottom", "b_top"],
        "side `a_bottom` of `a` and side `b_top` of `b` do not face each other",
    );
    refuses(["a_top", "b_top"], "do not face each other");
    // One face is enough if something lies opposite.
    assert_eq!(
        above
            .scene(&scene(["a_one", "b_bottom"], ""))
            .mortar_rows()
            .count(),
        2
    );
    let beside = Model::new("beside", &plates([5.0, 1.0]));
    beside.refuses(&scene(["a_one", "b_bottom"], ""), "do not face each other");
    beside.refuses(&scene(["a_top", "b_bottom"], ""), "do not face each other");
}

#[test]
fn bodies_that_overlap_by_half_are_refused() {
    let half = Model::new("half", &plates([0.0, 0.5]));
    let told = "overlap by 0.5, where `a` is 1 thick (sides that face each other, with an overlap of a quarter of that";
    half.refuses(&scene(["a_top", "b_bottom"], ""), told);
    half.refuses(&scene(["b_bottom", "a_top"], ""), "overlap by 0.5");
    // Small overlaps are interference, larger ones may be declared to be none.
    assert_eq!(
        half.scene(&scene(["a_top", "b_bottom"], "adjust = 0.51"))
            .mortar_rows()
            .count(),
        3
    );
    let little = Model::new("little", &plates([0.0, 0.9]));
    assert_eq!(
        little
            .scene(&scene(["a_top", "b_bottom"], ""))
            .mortar_rows()
            .count(),
        3
    );
}

/// Two entries may name the same surfaces: what is tied is not in contact.
#[test]
fn the_same_surfaces_may_be_tied_and_in_contact() {
    let above = Model::new("twice", &plates([0.0, 1.0]));
    let text = scene(["a_top", "b_bottom"], "") + "[[tie]]\nsurfaces = [\"a_top\", \"b_bottom\"]\n";
    let scene = above.scene(&text);
    assert!(scene.mortar_rows().all(|r| !r.law.is_inequality()));
    assert_eq!(scene.mortar_rows().count(), 2 * 3);
    assert_eq!(
        scene.notes,
        ["Another tie holds nodes of `a` (3): they carry no multipliers of the contact with `b`."]
    );
}

/// Two tetrahedra with a face in common, and a line on one of them.
#[test]
fn an_edge_in_space_is_no_surface() {
    let nodes = [
        [0, 0, 0],
        [1, 0, 0],
        [0, 1, 0],
        [0, 0, -1],
        [0, 0, 0],
        [1, 0, 0],
        [0, 1, 0],
        [0, 0, 1],
    ];
    let nodes = nodes.iter().zip(1..);
    let nodes: String = nodes
        .map(|([x, y, z], k)| format!("{k} {x} {y} {z}\n"))
        .collect();
    let mesh = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n5\n3 1 \"a\"\n3 2 \"b\"\n2 3 \"top\"\n2 4 \"under\"\n\
         1 5 \"rim\"\n$EndPhysicalNames\n$Nodes\n8\n{nodes}$EndNodes\n$Elements\n5\n1 4 2 1 1 1 3 2 4\n\
         2 4 2 2 2 5 6 7 8\n3 2 2 3 3 1 2 3\n4 2 2 4 4 5 7 6\n5 1 2 5 5 1 2\n$EndElements\n"
    );
    let model = Model::new("edge", &mesh);
    let scene = |surfaces: [&str; 2]| {
        format!(
            "dimension = 3\nphysics = \"elasticity\"\n[mesh]\nfile = \"m.msh\"\n[[body]]\nname = \"a\"\n\
             dirichlet = {{ top = 0 }}\n[[body]]\nname = \"b\"\n[[contact]]\nsurfaces = {surfaces:?}\n"
        )
    };
    model.scene(&scene(["top", "under"]));
    model.refuses(
        &scene(["rim", "under"]),
        "the boundary group `rim` of points or edges alone where faces of a body were expected",
    );
}

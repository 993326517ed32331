//! Scenes with meshes that cannot be solved on: folded, torn, hanging, turned or of another name.

use super::meshes::{squares, Model, TWO};

/// Triangles of 6 nodes: one below an arc of 60 degrees from (-½, 0) to (½, 0), and two above it that have a common
/// node on the arc, and their middle nodes, too; they meet the other in the ends of the arc. With `more` they leave a
/// hole of that height.
fn arcs(more: f64) -> String {
    let arc = |degrees: f64, more: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        [sin, cos - 0.75f64.sqrt() + more]
    };
    let (a, b, low, high) = (arc(-30.0, 0.0), arc(30.0, 0.0), [0.0, -1.0], [0.0, 1.0]);
    let half = |p: [f64; 2], q: [f64; 2]| [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])];
    let top = arc(0.0, more);
    let nodes = [
        a,
        b,
        low,
        high,
        arc(0.0, 0.0),
        half(b, low),
        half(low, a),
        // The two above: their common node, their middle nodes.
        top,
        arc(-15.0, 0.5 * more),
        arc(15.0, 0.5 * more),
        half(top, high),
        half(high, a),
        half(b, high),
    ];
    // The node on the arc is that of the middle of the first cell, once only.
    let common = if more > 0.0 { 8 } else { 5 };
    let cells = [
        [1, 3, 2, 7, 6, 5],
        [1, common, 4, 9, 11, 12],
        [common, 2, 4, 10, 13, 11],
    ];
    let mut out = String::from("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n13\n");
    for (k, [x, y]) in nodes.iter().enumerate() {
        out += &format!("{} {x} {y} 0\n", k + 1);
    }
    out += "$EndNodes\n$Elements\n3\n";
    for (k, cell) in cells.iter().enumerate() {
        let list: Vec<String> = cell.iter().map(|n| n.to_string()).collect();
        out += &format!("{} 9 2 1 1 {}\n", k + 1, list.join(" "));
    }
    out + "$EndElements\n"
}

/// The unit cube and on its top a box of length `length`, a cell each: the groups 1 and 2.
fn layer_pair(length: f64) -> String {
    let mut nodes = String::new();
    let mut cells = String::new();
    for (k, end) in [1.0, length].into_iter().enumerate() {
        let first = 8 * k + 1;
        for (n, [x, y]) in [[0.0, 0.0], [end, 0.0], [end, 1.0], [0.0, 1.0]]
            .iter()
            .enumerate()
        {
            for z in [0, 1] {
                nodes += &format!("{} {x} {} {z}\n", first + n + 4 * z, y + k as f64);
            }
        }
        let list: Vec<String> = (first..first + 8).map(|n| n.to_string()).collect();
        cells += &format!("{0} 5 2 {0} {0} {1}\n", k + 1, list.join(" "));
    }
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n16\n{nodes}$EndNodes\n$Elements\n2\n{cells}$EndElements\n"
    )
}

#[test]
fn what_does_not_fit_gets_one_sentence() {
    let model = Model::new("mesh_mistakes", &squares(2, 3, 1));
    let with = |from: &str, to: &str| TWO.replacen(from, to, 1);
    model.refuses(
        &with("\"b0\"", "\"nothing\""),
        "has no group `nothing` of cells of dimension 2",
    );
    model.refuses(&with("\"b0\"", "\"left\""), "the group `left`");
    model.refuses(&with("left = 0", "wall = 0"), "the boundary group `wall`");
    model.refuses(&with("\"m.msh\"", "\"x.msh\""), "x.msh");
    model.refuses(&with("\"m.msh\"", "\"s.toml\""), "a mesh of Gmsh (.msh)");
    model.refuses(
        &with("subdomains = 4", "subdomains = 0"),
        "a positive whole number",
    );
    model.refuses(&format!("dimension = 3\n{TWO}"), "dimension 3");
    model.refuses(
        &format!("{TWO}[[contact]]\nsurfaces = [\"left\", \"right\"]\n"),
        "lies opposite",
    );
    // Layers of one element: all nodes of a side lie on its rim.
    let stacked =
        "dimension = 3\n[mesh]\nfile = \"m.msh\"\n[contact]\nauto = true\ndistance = 0.1\n\
                   [[body]]\nname = \"1\"\n[[body]]\nname = \"2\"\n";
    Model::new("mesh_layers", &layer_pair(1.0)).scene(stacked);
    // Sides that do not match have mortar rows.
    let rim = Model::new("mesh_rim", &layer_pair(0.4)).scene(stacked);
    assert!(rim.mortar_rows().next().is_some());
    // Every part of one file is named by its place.
    let whole = squares(2, 3, 1);
    let cut = &whole[..whole.len() / 2];
    Model::new("mesh_truncated", cut).refuses(TWO, "m.msh, line ");
    // A square that is cut along a line: its nodes there are doubled. A cell whose neighbours are cut in two.
    let quads = |cells: &[[usize; 4]], nodes: &[[f64; 2]]| {
        let mut out = format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n",
            nodes.len()
        );
        for (k, [x, y]) in nodes.iter().enumerate() {
            out += &format!("{} {x} {y} 0\n", k + 1);
        }
        out += &format!("$EndNodes\n$Elements\n{}\n", cells.len());
        for (k, [a, b, c, d]) in cells.iter().enumerate() {
            out += &format!("{} 3 2 1 1 {a} {b} {c} {d}\n", k + 1);
        }
        out + "$EndElements\n"
    };
    let one = "[mesh]\nfile = \"m.msh\"\n[[body]]\nname = \"1\"\ndirichlet = [\"all\"]\n";
    let torn = quads(
        &[[1, 2, 5, 4], [2, 3, 6, 5], [4, 7, 9, 8], [10, 6, 11, 9]],
        &[
            [0.0, 0.0],
            [1.0, 0.0],
            [2.0, 0.0],
            [0.0, 1.0],
            [1.0, 1.0],
            [2.0, 1.0],
            [1.0, 1.0],
            [0.0, 2.0],
            [1.0, 2.0],
            [1.0, 1.0],
            [2.0, 2.0],
        ],
    );
    Model::new("mesh_torn", &torn).refuses(one, "are both at");
    let hanging = quads(
        &[[1, 2, 5, 4], [2, 3, 6, 5], [4, 6, 8, 7]],
        &[
            [0.0, 0.0],
            [1.0, 0.0],
            [2.0, 0.0],
            [0.0, 1.0],
            [1.0, 1.0],
            [2.0, 1.0],
            [0.0, 2.0],
            [2.0, 2.0],
        ],
    );
    Model::new("mesh_hanging", &hanging)
        .refuses(one, "node 5 at [1.0, 1.0, 0.0] hangs on a side of cell 3");
    // The edge from node 1 to 2 is an arc of 60 degrees; on its other side two edges have their ends on the arc.
    for (more, fits) in [(0.0, false), (0.05, true)] {
        let model = Model::new("mesh_arc", &arcs(more));
        if fits {
            drop(model.scene(one))
        } else {
            model.refuses(one, "hangs on a side of cell 1")
        }
    }
    // Two cells above the edge from node 2 to 3, two tetrahedra above one triangle.
    let fold = quads(
        &[[1, 2, 3, 4], [2, 3, 6, 5]],
        &[
            [0.0, 0.0],
            [1.0, 0.0],
            [1.0, 1.0],
            [0.0, 1.0],
            [0.6, 0.1],
            [0.6, 0.9],
        ],
    );
    let on = "cells 1 and 2 lie on the same side of the side that they share (nodes ";
    Model::new("mesh_fold", &fold).refuses(one, &format!("{on}2, 3)"));
    let tetrahedra = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n\
                      5 0.2 0.2 HEIGHT\n$EndNodes\n$Elements\n2\n1 4 2 1 1 1 2 3 4\n2 4 2 1 1 CELL\n$EndElements\n";
    let solid = format!("dimension = 3\n{one}").replace("dirichlet", "# dirichlet");
    let above = tetrahedra
        .replace("HEIGHT", "0.7")
        .replace("CELL", "1 2 3 5");
    Model::new("mesh_fold_3d", &above).refuses(&solid, on);
    let below = tetrahedra
        .replace("HEIGHT", "-0.7")
        .replace("CELL", "1 3 2 5");
    Model::new("mesh_no_fold", &below).scene(&solid);
    // A triangle that is named the other way round is the same triangle.
    let mesh = squares(2, 3, 1);
    let line = mesh.lines().find(|l| l.contains(" 2 2 100 100 ")).unwrap();
    let mut words: Vec<&str> = line.split(' ').collect();
    words.swap(5, 6);
    let turned = mesh.replace(line, &words.join(" "));
    Model::new("mesh_turned", &turned).scene(TWO);
}

/// Half of a tetrahedron's neighbour ends in the middle of its edge from (0, 0, 0) to (1, 0, 0), which a middle node at
/// `bulge` below may curve. `quarter` moves the nodes of the small cells off the edge.
fn split_edge(bulge: f64, quarter: f64) -> String {
    let m = [0.5, -bulge, 0.0];
    let mut points = vec![
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
        m,
    ];
    let mut known = std::collections::HashMap::from([((0, 1), 5)]);
    let mut elements = Vec::new();
    for corners in [[0, 1, 2, 3], [0, 2, 5, 4], [5, 2, 1, 4]] {
        let mut nodes: Vec<usize> = corners.to_vec();
        // Edges in Gmsh's order.
        for (i, j) in [(0, 1), (1, 2), (2, 0), (3, 0), (2, 3), (1, 3)] {
            let (a, b) = (corners[i].min(corners[j]), corners[i].max(corners[j]));
            let place = *known.entry((a, b)).or_insert_with(|| {
                let mut p = [0, 1, 2].map(|d| 0.5 * (points[a][d] + points[b][d]));
                if b == 5 && a < 2 {
                    // On the parabola through the three nodes of the edge.
                    p[1] = -0.75 * bulge - quarter;
                }
                points.push(p);
                points.len() - 1
            });
            nodes.push(place);
        }
        let nodes: Vec<String> = nodes.iter().map(|k| (k + 1).to_string()).collect();
        elements.push(format!(" 11 2 1 1 {}", nodes.join(" ")));
    }
    let mut out = String::from("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n");
    out += &format!("3 1 \"a\"\n$EndPhysicalNames\n$Nodes\n{}\n", points.len());
    for (k, [x, y, z]) in points.iter().enumerate() {
        out += &format!("{} {x} {y} {z}\n", k + 1);
    }
    out += &format!("$EndNodes\n$Elements\n{}\n", elements.len());
    for (k, element) in elements.iter().enumerate() {
        out += &format!("{}{element}\n", k + 1);
    }
    out + "$EndElements\n"
}

#[test]
fn nodes_that_hang_on_curved_edges_of_solids_are_found() {
    let text = "dimension = 3\nphysics = \"elasticity\"\n[mesh]\nfile = \"m.msh\"\n[[body]]\nname = \"a\"\n";
    for bulge in [0.05, 0.1] {
        let model = Model::new("split_edge", &split_edge(bulge, 0.0));
        model.refuses(text, "hangs on a side of cell 1");
        // Away from the edge there is a gap, as between two parts that share some nodes.
        let apart = Model::new("split_apart", &split_edge(bulge, -0.3 * bulge));
        apart.scene(text);
    }
}

//! Meshes of Gmsh that have only surfaces: lines in the plane, triangles and quadrilaterals in space.

/// The text of a file with one group of faces for each name: each face is a list of nodes, counted from 0.
pub fn gmsh(points: &[[f64; 3]], groups: &[(&str, Vec<Vec<usize>>)]) -> String {
    let mut out = String::from("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n");
    out += &format!("{}\n", groups.len());
    let mut elements = Vec::new();
    for (k, (name, faces)) in groups.iter().enumerate() {
        let dim = match faces[0].len() {
            1 => 0,
            2 => 1,
            _ => 2,
        };
        out += &format!("{dim} {} \"{name}\"\n", k + 1);
        for face in faces {
            let kind = [15, 1, 2, 3][face.len() - 1];
            let nodes: Vec<String> = face.iter().map(|n| (n + 1).to_string()).collect();
            elements.push(format!("{kind} 2 {0} {0} {1}", k + 1, nodes.join(" ")));
        }
    }
    out += &format!("$EndPhysicalNames\n$Nodes\n{}\n", points.len());
    for (k, [x, y, z]) in points.iter().enumerate() {
        out += &format!("{} {x:?} {y:?} {z:?}\n", k + 1);
    }
    out += &format!("$EndNodes\n$Elements\n{}\n", elements.len());
    for (k, element) in elements.iter().enumerate() {
        out += &format!("{} {element}\n", k + 1);
    }
    out + "$EndElements\n"
}

/// A line through points, which are given from right to left where its normals are to point up.
pub fn line(name: &str, points: &[[f64; 2]]) -> String {
    let segments = (1..points.len()).map(|k| vec![k - 1, k]);
    let points: Vec<[f64; 3]> = points.iter().map(|[x, y]| [*x, *y, 0.0]).collect();
    gmsh(&points, &[(name, segments.collect())])
}

/// The plane y = 0 over [−1, 3] × [−1, 3] in x and z with normals up: one quadrilateral beside six triangles.
pub fn floor(name: &str) -> String {
    let points = [
        [-1.0, 0.0, -1.0],
        [0.7, 0.0, -1.0],
        [3.0, 0.0, -1.0],
        [-1.0, 0.0, 3.0],
        [1.1, 0.0, 3.0],
        [3.0, 0.0, 3.0],
        [1.6, 0.0, 0.8],
    ];
    let faces = vec![
        vec![0, 3, 4, 1],
        vec![1, 6, 2],
        vec![1, 4, 6],
        vec![6, 4, 5],
        vec![2, 6, 5],
    ];
    gmsh(&points, &[(name, faces)])
}

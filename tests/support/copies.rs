//! Meshes with copies of one part: turned and mirrored.
//!
//! The part is a bent block of hexahedra or tetrahedra without any symmetry but one plane side. It stands on the group
//! `foot_<name>`, `top_<name>` is opposite. Pair k is the part, `p<k>a`, and its mirror image behind the plane side,
//! `p<k>b`, both turned by 37° · k about an oblique axis and moved away. Their plane sides are the groups
//! `joint_<name>`; no node is shared.

use super::mpi::Scratch;

/// The cells of the part.
#[derive(Clone, Copy, PartialEq)]
pub enum Kind {
    Hexahedra,
    Tetrahedra,
}

/// How the part is repeated.
pub struct Copies {
    pub kind: Kind,
    /// Cells along each edge of the block; each is six tetrahedra.
    pub n: usize,
    pub pairs: usize,
    /// A node of body `p1b` inside the block is moved by this much.
    pub moved: f64,
    /// The table that joins each pair: `tie` or `contact`; empty: none.
    pub joint: &'static str,
    pub subdomains: usize,
}

/// The permutations of three axes, the even ones first.
const ORDERS: [[usize; 3]; 6] = [
    [0, 1, 2],
    [1, 2, 0],
    [2, 0, 1],
    [0, 2, 1],
    [1, 0, 2],
    [2, 1, 0],
];

impl Copies {
    /// Writes scene and mesh; returns the path of the scene.
    pub fn write(&self, scratch: &Scratch) -> String {
        scratch.file("m.msh", &self.mesh());
        scratch.file("s.toml", &self.scene())
    }

    fn names(&self) -> Vec<String> {
        let each = (0..self.pairs).flat_map(|k| ["a", "b"].map(|side| format!("p{k}{side}")));
        each.collect()
    }

    fn scene(&self) -> String {
        let mut out = String::from(
            "title = \"copies\"\ndimension = 3\nphysics = \"elasticity\"\n[mesh]\nfile = \"m.msh\"\n",
        );
        for (i, name) in self.names().iter().enumerate() {
            out += &format!(
                "[[body]]\nname = \"{name}\"\nyoung = {}\npoisson = 0.3\nsubdomains = {}\n\
                 dirichlet = {{ foot_{name} = 0 }}\npressure = {{ top_{name} = {} }}\n",
                10.0 / (1.0 + i as f64),
                self.subdomains,
                0.1 + 0.03 * i as f64,
            );
        }
        if !self.joint.is_empty() {
            for k in 0..self.pairs {
                out += &format!(
                    "[[{}]]\nsurfaces = [\"joint_p{k}a\", \"joint_p{k}b\"]\n",
                    self.joint
                );
            }
        }
        out
    }

    fn node(&self, [i, j, k]: [usize; 3]) -> usize {
        (k * (self.n + 1) + j) * (self.n + 1) + i
    }

    fn points(&self) -> Vec<[f64; 3]> {
        let n = self.n;
        let at = |m: usize| m as f64 / n as f64;
        let mut out = Vec::new();
        for k in 0..=n {
            for j in 0..=n {
                for i in 0..=n {
                    let (x, y, z) = (at(i), at(j), at(k));
                    out.push([
                        x * (1.0 + 0.2 * (1.3 * y + 0.7 * z).sin()),
                        y + 0.15 * (2.0 * x + z).sin(),
                        z + 0.1 * x * y + 0.12 * (2.0 * y + x).cos(),
                    ]);
                }
            }
        }
        out
    }

    fn cells(&self) -> Vec<Vec<usize>> {
        let mut out = Vec::new();
        for place in 0..self.n.pow(3) {
            let low = [
                place % self.n,
                place / self.n % self.n,
                place / self.n / self.n,
            ];
            let corner = |d: [usize; 3]| self.node([0, 1, 2].map(|a| low[a] + d[a]));
            if self.kind == Kind::Hexahedra {
                let plane = [[0, 0], [1, 0], [1, 1], [0, 1]];
                let layers = [0, 1].map(|z| plane.map(|[x, y]| corner([x, y, z])));
                out.push(layers.concat());
                continue;
            }
            for (number, order) in ORDERS.iter().enumerate() {
                let mut at = [0; 3];
                let mut cell = vec![corner(at)];
                for &axis in order {
                    at[axis] += 1;
                    cell.push(corner(at));
                }
                if number >= 3 {
                    cell.swap(1, 2);
                }
                out.push(cell);
            }
        }
        out
    }

    /// The faces of a side of the block; `at(a, b)` is a node of it.
    fn side(&self, at: impl Fn(usize, usize) -> usize) -> Vec<Vec<usize>> {
        let mut out = Vec::new();
        for place in 0..self.n.pow(2) {
            let (a, b) = (place % self.n, place / self.n);
            let q = [at(a, b), at(a + 1, b), at(a + 1, b + 1), at(a, b + 1)];
            match self.kind {
                Kind::Hexahedra => out.push(q.to_vec()),
                Kind::Tetrahedra => out.extend([vec![q[0], q[1], q[2]], vec![q[0], q[2], q[3]]]),
            }
        }
        out
    }

    fn mesh(&self) -> String {
        let (points, cells, n) = (self.points(), self.cells(), self.n);
        let sides = [
            ("foot", self.side(|a, b| self.node([a, b, 0]))),
            ("top", self.side(|a, b| self.node([a, b, n]))),
            ("joint", self.side(|a, b| self.node([0, a, b]))),
        ];
        let names = self.names();
        let (mut groups, mut nodes, mut elements) = (Vec::new(), Vec::new(), Vec::new());
        for (copy, name) in names.iter().enumerate() {
            let (turn, mirrored) = (turn(37.0 * (copy / 2) as f64), copy % 2 == 1);
            let first = nodes.len() + 1;
            for (k, &[x, y, z]) in points.iter().enumerate() {
                let mut p = if mirrored { [-x, y, z] } else { [x, y, z] };
                if name == "p1b" && k == self.node([n / 2, n / 2, n / 2]) {
                    p[1] += self.moved;
                }
                let away = [4.0, 0.3, -0.2].map(|t| t * (copy / 2) as f64);
                let place = |d: usize| (0..3).map(|e| turn[d][e] * p[e]).sum::<f64>() + away[d];
                nodes.push([0, 1, 2].map(place));
            }
            let mut add = |kind: usize, dim: usize, name: String, list: &[Vec<usize>]| {
                groups.push(format!("{dim} {} \"{name}\"", groups.len() + 1));
                for cell in list {
                    let nodes: Vec<String> = cell.iter().map(|v| (first + v).to_string()).collect();
                    let tag = groups.len();
                    elements.push(format!("{kind} 2 {tag} {tag} {}", nodes.join(" ")));
                }
            };
            let (face, solid) = match self.kind {
                Kind::Hexahedra => (3, 5),
                Kind::Tetrahedra => (2, 4),
            };
            for (side, list) in &sides {
                add(face, 2, format!("{side}_{name}"), list);
            }
            let mut cells = cells.clone();
            if mirrored {
                for cell in &mut cells {
                    match self.kind {
                        Kind::Hexahedra => [0, 1, 4, 5].iter().for_each(|&a| cell.swap(a, a ^ 3)),
                        Kind::Tetrahedra => cell.swap(1, 2),
                    }
                }
            }
            add(solid, 3, name.clone(), &cells);
        }
        let numbered = |list: Vec<String>| {
            let lines = list.into_iter().enumerate();
            let lines: Vec<String> = lines.map(|(k, l)| format!("{} {l}\n", k + 1)).collect();
            format!("{}\n{}", lines.len(), lines.concat())
        };
        let nodes = nodes
            .iter()
            .map(|[x, y, z]| format!("{x} {y} {z}"))
            .collect();
        format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n{}\n{}\n$EndPhysicalNames\n\
             $Nodes\n{}$EndNodes\n$Elements\n{}$EndElements\n",
            groups.len(),
            groups.join("\n"),
            numbered(nodes),
            numbered(elements)
        )
    }
}

/// The rotation by some degrees about an oblique axis.
fn turn(degrees: f64) -> [[f64; 3]; 3] {
    let axis = [1.0f64, 2.0, -0.7];
    let length = axis.iter().map(|a| a * a).sum::<f64>().sqrt();
    let [x, y, z] = axis.map(|a| a / length);
    let (s, c) = degrees.to_radians().sin_cos();
    let cross = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
    let axis = [x, y, z];
    let identity = |i: usize, j: usize| if i == j { c } else { 0.0 };
    let entry =
        |i: usize, j: usize| identity(i, j) + s * cross[i][j] + (1.0 - c) * axis[i] * axis[j];
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| entry(i, j)))
}

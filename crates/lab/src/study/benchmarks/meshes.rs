//! Unstructured meshes of two bodies in contact, graded towards it; each body has a mesh of its own.

use std::f64::consts::FRAC_PI_2;

use crate::delaunay::{
    along, build, graded, graded_arc, graded_line, quadratic, GroupNumbers, Planform, Solid,
};
use elements::kind::CellKind;
use mesh::MeshFile;

/// Growth of elements: at a distance of one half-width from the contact they are larger by this part.
const GROWTH: f64 = 0.5;

/// Edges of the lower body in the contact over those of the upper one.
pub const RATIO: f64 = 1.4;

/// The size of elements, as a function of the place.
pub struct ElementSize {
    /// A length of the contact: the half-width.
    pub unit: f64,
    /// Edges in the contact, relative to the unit.
    pub edge: f64,
    /// No edge is longer.
    pub most: f64,
}

impl ElementSize {
    /// The size at a distance from the middle of the contact.
    pub fn at(&self, distance: f64) -> f64 {
        let away = (distance / self.unit - 1.5).max(0.0);
        (self.edge * self.unit * (1.0 + GROWTH * away)).min(self.most)
    }
}

/// The numbers of the groups of plane meshes; those of the second body are `BODIES` places on.
const NAMES: [&str; 8] = [
    "upper",
    "lower",
    "upper_contact",
    "lower_contact",
    "upper_axis",
    "lower_axis",
    "load",
    "foot",
];

/// Two plane bodies that are being put together.
pub struct TwoBodyMesh {
    points: Vec<[f64; 3]>,
    cells: Vec<Vec<u32>>,
    of_cell: Vec<usize>,
    order: usize,
}

impl TwoBodyMesh {
    /// No body yet.
    pub fn new(order: usize) -> TwoBodyMesh {
        TwoBodyMesh {
            points: Vec::new(),
            cells: Vec::new(),
            of_cell: Vec::new(),
            order,
        }
    }

    /// Adds a body; `curve` puts the middle of an edge of the boundary onto a curve.
    pub fn add(
        &mut self,
        outline: &[[f64; 2]],
        size: &dyn Fn([f64; 2]) -> f64,
        curve: &dyn Fn([[f64; 2]; 2]) -> Option<[f64; 2]>,
        group: usize,
    ) {
        let plan = graded(outline, size);
        let (points, cells) = match self.order {
            1 => {
                let corners = |t: &[usize; 3]| t.map(|n| n as u32).to_vec();
                (
                    plan.points.clone(),
                    plan.triangles.iter().map(corners).collect(),
                )
            }
            _ => quadratic(&plan, curve),
        };
        let first = self.points.len() as u32;
        self.points.extend(points.iter().map(|&[x, y]| [x, y, 0.0]));
        self.of_cell.extend(vec![group; cells.len()]);
        let moved = |cell: Vec<u32>| cell.into_iter().map(|n| n + first).collect();
        self.cells.extend(cells.into_iter().map(moved));
    }

    /// The mesh; `side` is as in [`build`], with the number of the body.
    pub fn finish(self, name: &str, side: impl Fn([f64; 3], usize) -> usize) -> MeshFile {
        let kind = [CellKind::Triangle3, CellKind::Triangle6][self.order - 1];
        let groups = GroupNumbers {
            names: &NAMES,
            of_cell: self.of_cell,
        };
        let side = |middle, beside: [usize; 2]| side(middle, beside[0].max(beside[1]));
        build(name, self.points, kind, &self.cells, &groups, side)
    }
}

/// A cylinder on a block.
pub struct Roller {
    /// Radius of the cylinder.
    pub radius: f64,
    /// Half the width and the height of the block.
    pub block: [f64; 2],
    /// Whether the cylinder is whole, with the load on an arc at its top; else its lower half, with the load on the
    /// flat side.
    pub whole: bool,
    /// How far from the axis the load reaches.
    pub load: f64,
    /// The half-width of the contact.
    pub a: f64,
}

impl Roller {
    /// The half x ≥ 0 with edges of `edge` · a in the contact of the block, and smaller ones in the cylinder's.
    pub fn mesh(&self, name: &str, edge: f64, order: usize) -> MeshFile {
        let (r, a, load) = (self.radius, self.a, self.load);
        let [width, depth] = self.block;
        let size = |edge: f64, most: f64| {
            let size = ElementSize {
                unit: a,
                edge,
                most,
            };
            move |[x, y]: [f64; 2]| size.at(x.hypot(y))
        };
        let fine = size(edge / RATIO, r * edge.min(0.5));
        // The load at the top of a whole cylinder is resolved, too.
        let upper = |p: [f64; 2]| {
            if self.whole {
                fine(p).min(0.5 * edge.min(0.5) * ((p[0]).hypot(p[1] - 2.0 * r) + load))
            } else {
                fine(p)
            }
        };
        let centre = [0.0, r];
        let mut outline = Vec::new();
        if self.whole {
            let top = (load / r).acos();
            outline.extend(graded_arc(centre, r, [-FRAC_PI_2, top], &upper));
            outline.extend(&graded_arc(centre, r, [top, FRAC_PI_2], &upper)[1..]);
        } else {
            outline.extend(graded_arc(centre, r, [-FRAC_PI_2, 0.0], &upper));
            outline.extend(&graded_line([r, r], centre, &upper)[1..]);
        }
        let top = outline[outline.len() - 1];
        outline.extend(&graded_line(top, [0.0; 2], &upper)[1..]);
        let curve = standing_circle(r);
        let mut pair = TwoBodyMesh::new(order);
        pair.add(&outline, &upper, &curve, 1);
        let lower = size(edge, depth * edge.min(0.5));
        pair.add(&block(width, depth, &lower), &lower, &|_| None, 2);
        let whole = self.whole;
        pair.finish(name, |[x, y, _], body| match body {
            1 if x < 1e-9 * r => 5,
            1 if whole && y > r && x < load => 7,
            1 if !whole && y > r * (1.0 - 1e-9) => 7,
            1 if y < r && x < 4.0 * a => 3,
            2 if x < 1e-9 * width => 6,
            2 if y < -depth * (1.0 - 1e-9) => 8,
            2 if y > -1e-9 * depth && x < 4.0 * a => 4,
            _ => 0,
        })
    }
}

/// The middle of an edge between two points of the circle of radius r that stands on the origin: on the circle. `None`
/// for other edges, such as a chord through its inside.
pub fn standing_circle(r: f64) -> impl Fn([[f64; 2]; 2]) -> Option<[f64; 2]> {
    move |ends| {
        let on = |p: [f64; 2]| (p[0].hypot(p[1] - r) - r).abs() < 1e-9 * r;
        let middle = [0, 1].map(|d| 0.5 * (ends[0][d] + ends[1][d]));
        let out = [middle[0], middle[1] - r];
        let length = out[0].hypot(out[1]);
        let near = length > 0.9 * r && ends.into_iter().all(on);
        near.then(|| [out[0] * r / length, r + out[1] * r / length])
    }
}

/// The outline of a block below y = 0.
fn block(width: f64, depth: f64, size: &dyn Fn([f64; 2]) -> f64) -> Vec<[f64; 2]> {
    let corners = [[0.0, -depth], [width, -depth], [width, 0.0], [0.0, 0.0]];
    let mut outline = vec![corners[0]];
    for k in 0..4 {
        outline.extend(&graded_line(corners[k], corners[(k + 1) % 4], size)[1..]);
    }
    outline
}

/// A punch with a flat bottom and round edges on a block; both are `extent` wide (halves) and high.
pub struct Punch {
    /// Half the width of the flat part.
    pub flat: f64,
    /// Radius of the edges: the profile is (x − flat)²/(2 radius) beyond the flat part.
    pub radius: f64,
    /// Half the width and the height of the bodies.
    pub extent: f64,
    /// The half-width of the contact.
    pub a: f64,
}

impl Punch {
    /// The profile.
    fn bottom(&self, x: f64) -> f64 {
        (x - self.flat).max(0.0).powi(2) / (2.0 * self.radius)
    }

    /// The half x ≥ 0 with edges of `edge` · a in the contact of the block, and smaller ones in the punch's.
    pub fn mesh(&self, name: &str, edge: f64, order: usize) -> MeshFile {
        let (a, extent, flat) = (self.a, self.extent, self.flat);
        let size = |edge: f64| {
            let size = ElementSize {
                unit: a,
                edge,
                most: extent * edge.min(0.5),
            };
            move |[x, y]: [f64; 2]| size.at((x - a).max(0.0).hypot(y) + a)
        };
        let fine = size(edge / RATIO);
        let right = self.bottom(extent);
        let round = |t: f64| {
            let x = flat + (extent - flat) * t;
            [x, self.bottom(x)]
        };
        let mut outline = graded_line([0.0; 2], [flat, 0.0], &fine);
        outline.extend(&along(&round, extent - flat, &fine, [[flat, 0.0], [extent, right]])[1..]);
        let corners = [[extent, right], [extent, extent], [0.0, extent], [0.0, 0.0]];
        for pair in corners.windows(2) {
            outline.extend(&graded_line(pair[0], pair[1], &fine)[1..]);
        }
        let on = |p: [f64; 2]| (p[1] - self.bottom(p[0])).abs() < 1e-12 * extent && p[0] >= flat;
        let curve = |ends: [[f64; 2]; 2]| {
            let x = 0.5 * (ends[0][0] + ends[1][0]);
            ends.into_iter().all(on).then(|| [x, self.bottom(x)])
        };
        let mut pair = TwoBodyMesh::new(order);
        pair.add(&outline, &fine, &curve, 1);
        let coarse = size(edge);
        pair.add(&block(extent, extent, &coarse), &coarse, &|_| None, 2);
        pair.finish(name, |[x, y, _], body| match body {
            1 if x < 1e-9 * extent => 5,
            1 if y > extent * (1.0 - 1e-9) => 7,
            1 if x < 4.0 * a && y < 2.0 * self.bottom(x) + 1e-3 * a => 3,
            2 if x < 1e-9 * extent => 6,
            2 if y < -extent * (1.0 - 1e-9) => 8,
            2 if y > -1e-9 * extent && x < 4.0 * a => 4,
            _ => 0,
        })
    }
}

/// A quarter of the cap of a ball on a quarter of a round block, both as wide as `extent`.
pub struct Ball {
    /// Radius of the ball.
    pub radius: f64,
    /// Radius of cap and block, and the height of the block; the cap ends at the ball's centre.
    pub extent: f64,
    /// The radius of the contact.
    pub a: f64,
}

const SOLID_NAMES: [&str; 10] = [
    "upper",
    "lower",
    "upper_contact",
    "lower_contact",
    "upper_x",
    "upper_y",
    "lower_x",
    "lower_y",
    "load",
    "foot",
];

impl Ball {
    /// Tetrahedra over triangles that are graded around the axis, in layers that are graded from the contact.
    pub fn mesh(&self, name: &str, edge: f64, order: usize) -> MeshFile {
        let mut points = Vec::new();
        let (mut cells, mut of_cell) = (Vec::new(), Vec::new());
        for (body, edge) in [(1, edge / RATIO), (2, edge)] {
            let size = ElementSize {
                unit: self.a,
                edge,
                most: 0.3 * self.extent,
            };
            let at = |[x, y]: [f64; 2]| size.at(x.hypot(y));
            let plan = self.plan(&at);
            let layers = ((1.0 + GROWTH * self.extent / self.a).ln() / (GROWTH * edge)).ceil();
            let mut solid = Solid::over(&plan, layers as usize, |_| 1.0);
            if order == 2 {
                solid = solid.quadratic();
            }
            let first = points.len() as u32;
            // The second body hangs below, apart from the first: z from −2 to −1.
            let shift = if body == 1 { 0.0 } else { -2.0 };
            points.extend(solid.points.iter().map(|&[x, y, z]| [x, y, z + shift]));
            of_cell.extend(vec![body; solid.cells.len()]);
            let moved = |cell: Vec<u32>| cell.into_iter().map(|n| n + first).collect::<Vec<u32>>();
            cells.extend(solid.cells.into_iter().map(moved));
        }
        let kind = [CellKind::Tet4, CellKind::Tet10][order - 1];
        let groups = GroupNumbers {
            names: &SOLID_NAMES,
            of_cell,
        };
        let near = |x: f64| x.abs() < 1e-9 * self.extent;
        let mut file = build(name, points, kind, &cells, &groups, |[x, y, z], beside| {
            let contact = x.hypot(y) < 3.0 * self.a;
            match beside[0].max(beside[1]) {
                1 if near(x) => 5,
                1 if near(y) => 6,
                2 if near(x) => 7,
                2 if near(y) => 8,
                1 if z > 1.0 - 1e-9 => 9,
                2 if z < -2.0 + 1e-9 => 10,
                1 if z.abs() < 1e-9 && contact => 3,
                2 if z > -1.0 - 1e-9 && contact => 4,
                _ => 0,
            }
        });
        // Groups were found where bodies are upright; now they get their shape.
        for p in &mut file.points {
            let [x, y, t] = *p;
            p[2] = self.height([x, y], t);
        }
        file
    }

    /// The area of the loaded top: that of the triangles.
    pub fn loaded(file: &MeshFile) -> f64 {
        let load = SOLID_NAMES
            .iter()
            .position(|n| *n == "load")
            .expect("a group");
        let mesh::Members::Cells { cells, .. } = &file.groups[load].members else {
            return f64::NAN;
        };
        let area = |&c: &u32| {
            let x: Vec<[f64; 3]> = file.cells.nodes(c as usize)[..3]
                .iter()
                .map(|&n| file.points[n as usize])
                .collect();
            let [u, v] = [1, 2].map(|k| [0, 1].map(|d| x[k][d] - x[0][d]));
            0.5 * (u[0] * v[1] - u[1] * v[0]).abs()
        };
        cells.iter().map(area).sum()
    }

    fn plan(&self, size: &dyn Fn([f64; 2]) -> f64) -> Planform {
        let (o, l) = ([0.0; 2], self.extent);
        let mut outline = graded_line(o, [l, 0.0], size);
        outline.extend(&graded_arc(o, l, [0.0, FRAC_PI_2], size)[1..]);
        outline.extend(&graded_line([0.0, l], o, size)[1..]);
        graded(&outline, size)
    }

    /// Where the point at height t of the upright bodies goes: layers are thin at the contact, in proportion to the
    /// triangles above which they lie.
    fn height(&self, [x, y]: [f64; 2], t: f64) -> f64 {
        let away = (x.hypot(y) / self.a - 1.5).max(0.0);
        let unit = self.a * (1.0 + GROWTH * away);
        let graded = |t: f64, depth: f64| {
            let ratio = 1.0 + GROWTH * depth / unit;
            depth * (ratio.powf(t) - 1.0) / (ratio - 1.0)
        };
        if t < -0.5 {
            return -graded(-1.0 - t, self.extent);
        }
        let surface = self.radius - (self.radius.powi(2) - x * x - y * y).sqrt();
        surface + graded(t, self.radius - surface)
    }
}

//! A side of a body as a surface in space: what the search for the nodes opposite needs.

use super::nearest::Nearest;
use super::sweep::{bounds_of, SAME};
use crate::model::body::BodySpec;
use base::linalg::vec3::{cross, dot, minus, norm, unit};

/// Faces around a node count as one smooth piece if the cosine of the angle between their normals is above this.
const SMOOTH: f64 = 0.8;

/// Two surfaces face each other where the cosine of the angle between their normals is below this.
pub(crate) const OPPOSITE: f64 = -0.5;

/// A face: its corners in order around it, and its unit normal out of the body.
pub(crate) struct Facet {
    pub corners: Vec<[f64; 3]>,
    pub normal: [f64; 3],
}

/// A side with its nodes, edges and faces.
pub(crate) struct Surface {
    /// Its nodes, increasing.
    pub nodes: Vec<usize>,
    pub points: Vec<[f64; 3]>,
    /// The unit normals at each node: one for each smooth piece of the surface there.
    pub normals: Vec<Vec<[f64; 3]>>,
    /// The shortest edge of a face around each node.
    pub edges: Vec<f64>,
    pub facets: Vec<Facet>,
    /// The faces around each node.
    pub around: Vec<Vec<u32>>,
    /// The lowest and the highest corner of its box.
    pub bounds: [[f64; 3]; 2],
    /// The normal of all its faces, if they have one.
    pub flat: Option<[f64; 3]>,
    nearest: Nearest,
}

impl Surface {
    pub fn new(spec: &BodySpec, side: usize) -> Surface {
        let nodes = spec.mesh.side_nodes(side);
        let points: Vec<[f64; 3]> = nodes.iter().map(|&k| spec.position(k)).collect();
        let mut edges = vec![f64::INFINITY; nodes.len()];
        let mut around = vec![Vec::new(); nodes.len()];
        let mut facets = Vec::new();
        let element = elements::cell::Element::Q1;
        for face in spec.faces(side) {
            let outline = face.outline();
            let corners: Vec<[f64; 3]> = outline.iter().map(|&k| spec.position(k)).collect();
            let n = corners.len();
            let lengths = (0..n).map(|k| norm(minus(corners[k], corners[(k + 1) % n])));
            let shortest = lengths.fold(f64::INFINITY, f64::min);
            let weights = spec.face_weights(side, &face, element);
            let sum = weights
                .iter()
                .fold([0.0; 3], |s, (_, n)| [0, 1, 2].map(|d| s[d] + n[d]));
            for node in &face.nodes {
                if let Ok(i) = nodes.binary_search(node) {
                    edges[i] = f64::min(edges[i], shortest);
                    around[i].push(facets.len() as u32);
                }
            }
            facets.push(Facet {
                corners,
                normal: unit(sum).unwrap_or_default(),
            });
        }
        let normals = around.iter().map(|list| smooth(&facets, list)).collect();
        let first = facets.first().map_or([0.0; 3], |f: &Facet| f.normal);
        let same = |f: &Facet| norm(minus(f.normal, first)) < SAME;
        Surface {
            bounds: bounds_of(&points),
            flat: facets.iter().all(same).then_some(first),
            nearest: Nearest::new(&points),
            nodes,
            points,
            normals,
            edges,
            facets,
            around,
        }
    }

    /// The node (its place in `nodes`) that lies opposite a point: along one of the point's normals at a distance of
    /// `reach` at most, and across it `near` at most.
    pub fn opposite(
        &self,
        point: [f64; 3],
        normals: &[[f64; 3]],
        near: f64,
        reach: f64,
    ) -> Option<usize> {
        let i = self.nearest.find(point)?;
        let away = minus(self.points[i], point);
        let fits = |normal: &[f64; 3]| {
            let along = dot(away, *normal);
            let across = norm(minus(away, normal.map(|n| along * n)));
            let faces = self.normals[i].iter().any(|n| dot(*n, *normal) < OPPOSITE);
            // Sides do not face each other through a body: they overlap by less than an edge.
            let close = along <= reach && along >= -reach.min(self.edges[i]);
            across <= near && close && faces
        };
        normals.iter().any(fits).then_some(i)
    }

    /// Whether a point, moved along one of its normals by `reach` at most, lies inside a face or on one of its edges,
    /// farther from the corners than `margin` of the face's size.
    pub fn covers(&self, point: [f64; 3], normals: &[[f64; 3]], reach: f64, margin: f64) -> bool {
        let Some(i) = self.nearest.find(point) else {
            return false;
        };
        self.around[i].iter().any(|&f| {
            let facet = &self.facets[f as usize];
            let along = dot(minus(facet.corners[0], point), facet.normal);
            let opposite = normals.iter().any(|n| dot(*n, facet.normal) < OPPOSITE);
            opposite && along.abs() <= reach && inside(&facet.corners, point, facet.normal, margin)
        })
    }
}

/// The unit normals of the smooth pieces that some faces form.
fn smooth(facets: &[Facet], list: &[u32]) -> Vec<[f64; 3]> {
    let mut sums: Vec<[f64; 3]> = Vec::new();
    for &f in list {
        let normal = facets[f as usize].normal;
        let same = |sum: &&mut [f64; 3]| dot(**sum, normal) > SMOOTH * norm(**sum);
        match sums.iter_mut().find(same) {
            Some(sum) => (0..3).for_each(|d| sum[d] += normal[d]),
            None => sums.push(normal),
        }
    }
    let units = sums.into_iter().map(unit);
    units.map(Option::unwrap_or_default).collect()
}

/// Whether a point lies in a segment, triangle or quadrilateral, seen along its normal, and at none of its corners. A
/// point on an edge counts: bodies of one layer of elements have all nodes of a side on its rim.
fn inside(corners: &[[f64; 3]], point: [f64; 3], normal: [f64; 3], margin: f64) -> bool {
    let flat = |v: [f64; 3]| {
        let part = dot(v, normal);
        minus(v, normal.map(|n| part * n))
    };
    if let [a, b] = corners {
        let (edge, from) = (flat(minus(*b, *a)), flat(minus(point, *a)));
        let t = dot(edge, from) / dot(edge, edge);
        return (margin..=1.0 - margin).contains(&t);
    }
    // The areas of the triangles between the point and each edge have one sign inside. One of them vanishes on an edge,
    // two at a corner.
    let areas = (0..corners.len()).map(|k| {
        let [a, b] = [corners[k], corners[(k + 1) % corners.len()]].map(|c| flat(minus(c, point)));
        dot(cross(a, b), normal)
    });
    let areas: Vec<f64> = areas.collect();
    let total: f64 = areas.iter().sum();
    let least = margin * total.abs();
    let areas = areas.iter().map(|a| a * total.signum());
    areas.clone().all(|a| a > -least) && areas.filter(|a| *a <= least).count() < 2
}

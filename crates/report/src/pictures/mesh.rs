//! Meshes for pictures: cells with the body and the subdomain of each.

use base::{Error, Result};
use mesh::Cells;

/// Quadrilaterals and triangles in the plane.
#[derive(Debug, Clone, Copy)]
pub struct PlaneMesh<'a> {
    /// Positions in the undeformed bodies. A position may be listed several times: once per body, or once per
    /// subdomain.
    pub points: &'a [[f64; 2]],
    /// Positions of the points in the picture: as `points`, or displaced.
    pub shown: &'a [[f64; 2]],
    /// Corners of every cell in the order around it; a triangle repeats its last one.
    pub corners: &'a [[u32; 4]],
    /// Body of every cell.
    pub body: &'a [u32],
    /// Subdomain of every cell; numbers continue from body to body.
    pub subdomain: &'a [u32],
}

/// Solid cells of any kind.
#[derive(Debug, Clone, Copy)]
pub struct SolidMesh<'a> {
    /// Positions in the undeformed bodies. A position may be listed several times: once per body, or once per
    /// subdomain.
    pub points: &'a [[f64; 3]],
    /// Positions of the points in the picture: as `points`, or displaced.
    pub shown: &'a [[f64; 3]],
    /// The cells.
    pub cells: &'a Cells,
    /// Body of every cell.
    pub body: &'a [u32],
    /// Subdomain of every cell; numbers continue from body to body.
    pub subdomain: &'a [u32],
}

/// The arrays of a mesh, without its positions.
struct MeshArrays<'a> {
    points: usize,
    shown: usize,
    cells: usize,
    nodes: &'a [u32],
    body: &'a [u32],
    subdomain: &'a [u32],
}

impl PlaneMesh<'_> {
    /// Checks that the sizes of the arrays agree.
    pub(super) fn check(&self) -> Result<()> {
        let lists = MeshArrays {
            points: self.points.len(),
            shown: self.shown.len(),
            cells: self.corners.len(),
            nodes: self.corners.as_flattened(),
            body: self.body,
            subdomain: self.subdomain,
        };
        lists.check()
    }

    /// Rounds the positions of points to a millionth of the mesh: then all copies of a point are equal.
    pub(super) fn rounding(&self) -> impl Fn([f64; 2]) -> [i64; 2] + use<> {
        rounding(bounds(self.points.iter().copied()))
    }
}

impl SolidMesh<'_> {
    /// Checks that the sizes of the arrays agree.
    pub(super) fn check(&self) -> Result<()> {
        let lists = MeshArrays {
            points: self.points.len(),
            shown: self.shown.len(),
            cells: self.cells.len(),
            nodes: self.cells.all_nodes(),
            body: self.body,
            subdomain: self.subdomain,
        };
        lists.check()
    }

    /// Rounds the positions of points to a millionth of the mesh: then all copies of a point are equal.
    pub(super) fn rounding(&self) -> impl Fn([f64; 3]) -> [i64; 3] + use<> {
        rounding(bounds(self.points.iter().copied()))
    }
}

impl MeshArrays<'_> {
    fn check(&self) -> Result<()> {
        let (cells, points) = (self.cells, self.points);
        for (found, expected, what) in [
            (self.body.len(), cells, "bodies of cells"),
            (self.subdomain.len(), cells, "subdomains of cells"),
            (self.shown, points, "displaced points"),
        ] {
            if found != expected {
                return Err(Error::input(format!(
                    "the picture's mesh lists {found} {what}, expected {expected}"
                )));
            }
        }
        match self.nodes.iter().find(|&&p| p as usize >= points) {
            Some(bad) => Err(Error::input(format!(
                "a cell names point {bad}, but the picture's mesh has {points} points"
            ))),
            None => Ok(()),
        }
    }
}

/// Rounds positions to a millionth of the extent of the bounds.
pub(super) fn rounding<const D: usize>(
    [low, high]: [[f64; D]; 2],
) -> impl Fn([f64; D]) -> [i64; D] {
    let size = (0..D).fold(1e-300_f64, |a, d| a.max(high[d] - low[d]));
    let grid = f64::from(1 << 20) / size;
    move |p| std::array::from_fn(|d| ((p[d] - low[d]) * grid).round() as i64)
}

/// Least and greatest coordinates; those of the unit square or cube if there are no points.
pub fn bounds<const D: usize>(points: impl Iterator<Item = [f64; D]>) -> [[f64; D]; 2] {
    let nothing = [[f64::INFINITY; D], [f64::NEG_INFINITY; D]];
    let [low, high] = points.fold(nothing, |[low, high], p| {
        [
            std::array::from_fn(|d| low[d].min(p[d])),
            std::array::from_fn(|d| high[d].max(p[d])),
        ]
    });
    if (0..D).all(|d| low[d] <= high[d]) {
        [low, high]
    } else {
        [[0.0; D], [1.0; D]]
    }
}

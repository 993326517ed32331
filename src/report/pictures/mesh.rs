//! Meshes for pictures: cells with the body and the subdomain of each.

use crate::{Error, Result};

/// Cells of N corners in D dimensions.
#[derive(Debug, Clone, Copy)]
pub struct Cells<'a, const D: usize, const N: usize> {
    /// Positions in the undeformed bodies. A position may be listed several times: once per body, or once per
    /// subdomain.
    pub points: &'a [[f64; D]],
    /// Positions of the points in the picture: as `points`, or displaced.
    pub shown: &'a [[f64; D]],
    /// Corners of every cell: of a quadrilateral in the order around it, of a hexahedron in VTK's order, x, y, z
    /// right-handed.
    pub corners: &'a [[u32; N]],
    /// Body of every cell.
    pub body: &'a [u32],
    /// Subdomain of every cell; numbers continue from body to body.
    pub subdomain: &'a [u32],
}

/// Quadrilaterals.
pub type Mesh<'a> = Cells<'a, 2, 4>;
/// Hexahedra.
pub type Solid<'a> = Cells<'a, 3, 8>;

impl<const D: usize, const N: usize> Cells<'_, D, N> {
    /// Checks that the sizes of the arrays agree.
    pub(super) fn check(&self) -> Result<()> {
        let (cells, points) = (self.corners.len(), self.points.len());
        for (found, expected, what) in [
            (self.body.len(), cells, "bodies of cells"),
            (self.subdomain.len(), cells, "subdomains of cells"),
            (self.shown.len(), points, "displaced points"),
        ] {
            if found != expected {
                return Err(Error::input(format!(
                    "the picture's mesh lists {found} {what}, expected {expected}"
                )));
            }
        }
        let mut corners = self.corners.iter().flatten();
        match corners.find(|&&p| p as usize >= points) {
            Some(bad) => Err(Error::input(format!(
                "a cell names point {bad}, but the picture's mesh has {points} points"
            ))),
            None => Ok(()),
        }
    }

    /// Rounds the positions of points to a millionth of the mesh: then all copies of a point are equal.
    pub(super) fn rounding(&self) -> impl Fn([f64; D]) -> [i64; D] + use<D, N> {
        rounding(bounds(self.points.iter().copied()))
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
pub(crate) fn bounds<const D: usize>(points: impl Iterator<Item = [f64; D]>) -> [[f64; D]; 2] {
    let nothing = [[f64::INFINITY; D], [f64::NEG_INFINITY; D]];
    let [low, high] = points.fold(nothing, |[low, high], p| {
        [
            std::array::from_fn(|d| low[d].min(p[d])),
            std::array::from_fn(|d| high[d].max(p[d])),
        ]
    });
    match (0..D).all(|d| low[d] <= high[d]) {
        true => [low, high],
        false => [[0.0; D], [1.0; D]],
    }
}

//! The kinds of cells: nodes, sides, names.
//!
//! Nodes are numbered as Abaqus numbers them: corners first, then the middles of edges, then of faces, then the centre.
//! With one exception this is also VTK's order ([`CellKind::vtk_order`]). Sides are numbered as Abaqus numbers them,
//! too. The nodes of a side are ordered such that its normal points out of the cell: by the right-hand rule on faces,
//! to the right of the way from the first node to the second on the edges of plane cells.

/// The kind of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum CellKind {
    /// A point.
    Point1,
    /// A segment.
    Line2,
    /// A segment with its middle.
    Line3,
    /// A triangle.
    Triangle3,
    /// A triangle with the middles of its edges.
    Triangle6,
    /// A quadrilateral.
    Quad4,
    /// A quadrilateral with the middles of its edges (serendipity).
    Quad8,
    /// A quadrilateral with the middles of its edges and its centre.
    Quad9,
    /// A tetrahedron.
    Tet4,
    /// A tetrahedron with the middles of its edges.
    Tet10,
    /// A pyramid: its base, then its apex.
    Pyramid5,
    /// A wedge: two triangles.
    Wedge6,
    /// A wedge with the middles of its edges.
    Wedge15,
    /// A hexahedron.
    Hex8,
    /// A hexahedron with the middles of its edges (serendipity).
    Hex20,
    /// A hexahedron with the middles of its edges and faces, and its centre.
    Hex27,
}

/// A side of a cell: an edge of a plane cell, a face of a solid one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CellSide {
    /// Its kind, one dimension lower.
    pub kind: CellKind,
    /// Its nodes, as places among the nodes of the cell.
    pub nodes: &'static [u8],
}

const fn side(kind: CellKind, nodes: &'static [u8]) -> CellSide {
    CellSide { kind, nodes }
}

impl CellKind {
    /// All kinds, by increasing dimension.
    pub const ALL: [CellKind; 16] = [
        CellKind::Point1,
        CellKind::Line2,
        CellKind::Line3,
        CellKind::Triangle3,
        CellKind::Triangle6,
        CellKind::Quad4,
        CellKind::Quad8,
        CellKind::Quad9,
        CellKind::Tet4,
        CellKind::Tet10,
        CellKind::Pyramid5,
        CellKind::Wedge6,
        CellKind::Wedge15,
        CellKind::Hex8,
        CellKind::Hex20,
        CellKind::Hex27,
    ];

    /// Most nodes that a cell has.
    pub const MOST_NODES: usize = 27;

    /// Number of nodes.
    pub const fn nodes(self) -> usize {
        match self {
            CellKind::Point1 => 1,
            CellKind::Line2 => 2,
            CellKind::Line3 | CellKind::Triangle3 => 3,
            CellKind::Quad4 | CellKind::Tet4 => 4,
            CellKind::Pyramid5 => 5,
            CellKind::Triangle6 | CellKind::Wedge6 => 6,
            CellKind::Quad8 | CellKind::Hex8 => 8,
            CellKind::Quad9 => 9,
            CellKind::Tet10 => 10,
            CellKind::Wedge15 => 15,
            CellKind::Hex20 => 20,
            CellKind::Hex27 => 27,
        }
    }

    /// Number of corners, which come first among the nodes.
    pub const fn corners(self) -> usize {
        match self {
            CellKind::Point1 => 1,
            CellKind::Line2 | CellKind::Line3 => 2,
            CellKind::Triangle3 | CellKind::Triangle6 => 3,
            CellKind::Quad4 | CellKind::Quad8 | CellKind::Quad9 => 4,
            CellKind::Tet4 | CellKind::Tet10 => 4,
            CellKind::Pyramid5 => 5,
            CellKind::Wedge6 | CellKind::Wedge15 => 6,
            CellKind::Hex8 | CellKind::Hex20 | CellKind::Hex27 => 8,
        }
    }

    /// Dimension, 0 to 3.
    pub const fn dim(self) -> usize {
        match self {
            CellKind::Point1 => 0,
            CellKind::Line2 | CellKind::Line3 => 1,
            CellKind::Triangle3
            | CellKind::Triangle6
            | CellKind::Quad4
            | CellKind::Quad8
            | CellKind::Quad9 => 2,
            _ => 3,
        }
    }

    /// The order of its shape functions, 1 or 2.
    pub const fn order(self) -> usize {
        if self.nodes() > self.corners() {
            2
        } else {
            1
        }
    }

    /// The kind with the same corners and no other nodes.
    pub const fn linear(self) -> CellKind {
        match self {
            CellKind::Line3 => CellKind::Line2,
            CellKind::Triangle6 => CellKind::Triangle3,
            CellKind::Quad8 | CellKind::Quad9 => CellKind::Quad4,
            CellKind::Tet10 => CellKind::Tet4,
            CellKind::Wedge15 => CellKind::Wedge6,
            CellKind::Hex20 | CellKind::Hex27 => CellKind::Hex8,
            kind => kind,
        }
    }

    /// Its name in messages, such as "tetrahedron of 10 nodes".
    pub const fn name(self) -> &'static str {
        match self {
            CellKind::Point1 => "point",
            CellKind::Line2 => "segment of 2 nodes",
            CellKind::Line3 => "segment of 3 nodes",
            CellKind::Triangle3 => "triangle of 3 nodes",
            CellKind::Triangle6 => "triangle of 6 nodes",
            CellKind::Quad4 => "quadrilateral of 4 nodes",
            CellKind::Quad8 => "quadrilateral of 8 nodes",
            CellKind::Quad9 => "quadrilateral of 9 nodes",
            CellKind::Tet4 => "tetrahedron of 4 nodes",
            CellKind::Tet10 => "tetrahedron of 10 nodes",
            CellKind::Pyramid5 => "pyramid of 5 nodes",
            CellKind::Wedge6 => "wedge of 6 nodes",
            CellKind::Wedge15 => "wedge of 15 nodes",
            CellKind::Hex8 => "hexahedron of 8 nodes",
            CellKind::Hex20 => "hexahedron of 20 nodes",
            CellKind::Hex27 => "hexahedron of 27 nodes",
        }
    }

    /// VTK's number of the kind.
    pub const fn vtk(self) -> u8 {
        match self {
            CellKind::Point1 => 1,
            CellKind::Line2 => 3,
            CellKind::Triangle3 => 5,
            CellKind::Quad4 => 9,
            CellKind::Tet4 => 10,
            CellKind::Hex8 => 12,
            CellKind::Wedge6 => 13,
            CellKind::Pyramid5 => 14,
            CellKind::Line3 => 21,
            CellKind::Triangle6 => 22,
            CellKind::Quad8 => 23,
            CellKind::Tet10 => 24,
            CellKind::Hex20 => 25,
            CellKind::Wedge15 => 26,
            CellKind::Quad9 => 28,
            CellKind::Hex27 => 29,
        }
    }

    /// The place in our order of each node in VTK's order; `None`: the same. VTK's linear wedge has its triangles the
    /// other way round.
    pub const fn vtk_order(self) -> Option<&'static [u8]> {
        match self {
            CellKind::Wedge6 => Some(&[0, 2, 1, 3, 5, 4]),
            _ => None,
        }
    }

    /// Its sides: edges of plane cells, faces of solid ones, ends of segments.
    pub const fn sides(self) -> &'static [CellSide] {
        use CellKind::{Line2, Line3, Point1, Quad4, Quad8, Quad9, Triangle3, Triangle6};
        const ENDS: &[CellSide] = &[side(Point1, &[0]), side(Point1, &[1])];
        match self {
            CellKind::Point1 => &[],
            CellKind::Line2 | CellKind::Line3 => ENDS,
            CellKind::Triangle3 => {
                const S: &[CellSide] = &[
                    side(Line2, &[0, 1]),
                    side(Line2, &[1, 2]),
                    side(Line2, &[2, 0]),
                ];
                S
            }
            CellKind::Triangle6 => {
                const S: &[CellSide] = &[
                    side(Line3, &[0, 1, 3]),
                    side(Line3, &[1, 2, 4]),
                    side(Line3, &[2, 0, 5]),
                ];
                S
            }
            CellKind::Quad4 => {
                const S: &[CellSide] = &[
                    side(Line2, &[0, 1]),
                    side(Line2, &[1, 2]),
                    side(Line2, &[2, 3]),
                    side(Line2, &[3, 0]),
                ];
                S
            }
            CellKind::Quad8 | CellKind::Quad9 => {
                const S: &[CellSide] = &[
                    side(Line3, &[0, 1, 4]),
                    side(Line3, &[1, 2, 5]),
                    side(Line3, &[2, 3, 6]),
                    side(Line3, &[3, 0, 7]),
                ];
                S
            }
            CellKind::Tet4 => {
                const S: &[CellSide] = &[
                    side(Triangle3, &[0, 2, 1]),
                    side(Triangle3, &[0, 1, 3]),
                    side(Triangle3, &[1, 2, 3]),
                    side(Triangle3, &[0, 3, 2]),
                ];
                S
            }
            CellKind::Tet10 => {
                const S: &[CellSide] = &[
                    side(Triangle6, &[0, 2, 1, 6, 5, 4]),
                    side(Triangle6, &[0, 1, 3, 4, 8, 7]),
                    side(Triangle6, &[1, 2, 3, 5, 9, 8]),
                    side(Triangle6, &[0, 3, 2, 7, 9, 6]),
                ];
                S
            }
            CellKind::Pyramid5 => {
                const S: &[CellSide] = &[
                    side(Quad4, &[0, 3, 2, 1]),
                    side(Triangle3, &[0, 1, 4]),
                    side(Triangle3, &[1, 2, 4]),
                    side(Triangle3, &[2, 3, 4]),
                    side(Triangle3, &[3, 0, 4]),
                ];
                S
            }
            CellKind::Wedge6 => {
                const S: &[CellSide] = &[
                    side(Triangle3, &[0, 2, 1]),
                    side(Triangle3, &[3, 4, 5]),
                    side(Quad4, &[0, 1, 4, 3]),
                    side(Quad4, &[1, 2, 5, 4]),
                    side(Quad4, &[2, 0, 3, 5]),
                ];
                S
            }
            CellKind::Wedge15 => {
                const S: &[CellSide] = &[
                    side(Triangle6, &[0, 2, 1, 8, 7, 6]),
                    side(Triangle6, &[3, 4, 5, 9, 10, 11]),
                    side(Quad8, &[0, 1, 4, 3, 6, 13, 9, 12]),
                    side(Quad8, &[1, 2, 5, 4, 7, 14, 10, 13]),
                    side(Quad8, &[2, 0, 3, 5, 8, 12, 11, 14]),
                ];
                S
            }
            CellKind::Hex8 => {
                const S: &[CellSide] = &[
                    side(Quad4, &[0, 3, 2, 1]),
                    side(Quad4, &[4, 5, 6, 7]),
                    side(Quad4, &[0, 1, 5, 4]),
                    side(Quad4, &[1, 2, 6, 5]),
                    side(Quad4, &[2, 3, 7, 6]),
                    side(Quad4, &[3, 0, 4, 7]),
                ];
                S
            }
            CellKind::Hex20 => {
                const S: &[CellSide] = &[
                    side(Quad8, &[0, 3, 2, 1, 11, 10, 9, 8]),
                    side(Quad8, &[4, 5, 6, 7, 12, 13, 14, 15]),
                    side(Quad8, &[0, 1, 5, 4, 8, 17, 12, 16]),
                    side(Quad8, &[1, 2, 6, 5, 9, 18, 13, 17]),
                    side(Quad8, &[2, 3, 7, 6, 10, 19, 14, 18]),
                    side(Quad8, &[3, 0, 4, 7, 11, 16, 15, 19]),
                ];
                S
            }
            CellKind::Hex27 => {
                const S: &[CellSide] = &[
                    side(Quad9, &[0, 3, 2, 1, 11, 10, 9, 8, 24]),
                    side(Quad9, &[4, 5, 6, 7, 12, 13, 14, 15, 25]),
                    side(Quad9, &[0, 1, 5, 4, 8, 17, 12, 16, 22]),
                    side(Quad9, &[1, 2, 6, 5, 9, 18, 13, 17, 21]),
                    side(Quad9, &[2, 3, 7, 6, 10, 19, 14, 18, 23]),
                    side(Quad9, &[3, 0, 4, 7, 11, 16, 15, 19, 20]),
                ];
                S
            }
        }
    }

    /// The corners at the ends of its edges, in the order of the middle nodes of the edges. Segments have one edge.
    pub const fn edges(self) -> &'static [[u8; 2]] {
        match self.linear() {
            CellKind::Line2 => &[[0, 1]],
            CellKind::Triangle3 => &[[0, 1], [1, 2], [2, 0]],
            CellKind::Quad4 => &[[0, 1], [1, 2], [2, 3], [3, 0]],
            CellKind::Tet4 => &[[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]],
            CellKind::Pyramid5 => &[
                [0, 1],
                [1, 2],
                [2, 3],
                [3, 0],
                [0, 4],
                [1, 4],
                [2, 4],
                [3, 4],
            ],
            CellKind::Wedge6 => &[
                [0, 1],
                [1, 2],
                [2, 0],
                [3, 4],
                [4, 5],
                [5, 3],
                [0, 3],
                [1, 4],
                [2, 5],
            ],
            CellKind::Hex8 => &[
                [0, 1],
                [1, 2],
                [2, 3],
                [3, 0],
                [4, 5],
                [5, 6],
                [6, 7],
                [7, 4],
                [0, 4],
                [1, 5],
                [2, 6],
                [3, 7],
            ],
            _ => &[],
        }
    }
}

#[cfg(test)]
#[path = "../tests/kind.rs"]
mod tests;

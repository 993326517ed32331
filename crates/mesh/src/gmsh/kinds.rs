//! Gmsh's types of elements: those that are ours, and the order of their nodes.
//!
//! Gmsh lists corners first as we do, and mostly in the same order. It numbers the edges of solids in another order,
//! and with them their middle nodes; "Node ordering" in its manual has the pictures.

use elements::kind::CellKind;

/// The nodes of an element in our order, as places in Gmsh's order; `None`: the same order.
type Order = Option<&'static [u8]>;

/// Gmsh has the edge from 2 to 3 before that from 1 to 3.
const TET10: &[u8] = &[0, 1, 2, 3, 4, 5, 6, 7, 9, 8];

/// Gmsh sorts the edges by their corners: 01 02 03 12 14 25 34 35 45.
const WEDGE15: &[u8] = &[0, 1, 2, 3, 4, 5, 6, 9, 7, 12, 14, 13, 8, 10, 11];

/// Gmsh sorts the edges by their corners: 01 03 04 12 15 23 26 37 45 47 56 67.
const HEX20: &[u8] = &[
    0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15,
];

/// The edges as in [`HEX20`]; Gmsh's faces are 0321 0154 0473 1265 2376 4567.
const HEX27: &[u8] = &[
    0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15, 22, 23, 21, 24, 20, 25,
    26,
];

/// The kind of cell for an element of Gmsh's type, and the order of its nodes; `None` where we have no such cells.
pub fn known(kind: i64) -> Option<(CellKind, Order)> {
    Some(match kind {
        1 => (CellKind::Line2, None),
        2 => (CellKind::Triangle3, None),
        3 => (CellKind::Quad4, None),
        4 => (CellKind::Tet4, None),
        5 => (CellKind::Hex8, None),
        6 => (CellKind::Wedge6, None),
        7 => (CellKind::Pyramid5, None),
        8 => (CellKind::Line3, None),
        9 => (CellKind::Triangle6, None),
        10 => (CellKind::Quad9, None),
        11 => (CellKind::Tet10, Some(TET10)),
        12 => (CellKind::Hex27, Some(HEX27)),
        15 => (CellKind::Point1, None),
        16 => (CellKind::Quad8, None),
        17 => (CellKind::Hex20, Some(HEX20)),
        18 => (CellKind::Wedge15, Some(WEDGE15)),
        _ => return None,
    })
}

/// Gmsh's number of a kind, and the order of [`known`].
pub(super) fn number(kind: CellKind) -> (i32, Order) {
    let same = |number: &i64| known(*number).is_some_and(|(k, _)| k == kind);
    let number = (1..=18).find(same).expect("Gmsh has all our kinds");
    let (_, order) = known(number).expect("it was found");
    (number as i32, order)
}

/// The name of a type that is not [`known`].
pub(super) fn foreign(kind: i64) -> &'static str {
    match kind {
        13 => "a wedge of 18 nodes",
        14 => "a pyramid of 14 nodes",
        19 => "a pyramid of 13 nodes",
        26..=28 | 62..=66 => "a segment of order 3 or higher",
        20..=25 | 42..=46 | 52..=56 => "a triangle of order 3 or higher",
        36..=41 | 47..=51 | 57..=61 => "a quadrilateral of order 3 or higher",
        29..=33 | 71..=75 | 79..=83 => "a tetrahedron of order 3 or higher",
        92..=105 => "a hexahedron of order 3 or higher",
        90 | 91 | 106..=117 => "a wedge of order 3 or higher",
        118..=131 => "a pyramid of order 3 or higher",
        34 | 69 => "a polygon",
        35 => "a polyhedron",
        67 | 68 | 70 | 133..=136 => "a part of a cut element",
        84..=89 | 132 => "an element of order 0",
        137..=139 => "an element with a bubble",
        140 => "a trihedron",
        _ => "no type of Gmsh",
    }
}

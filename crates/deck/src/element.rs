//! The types of elements: those that are solved, and those that have a shape only.

use elements::kind::CellKind;

/// The mechanical model of an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ElementModel {
    /// A solid.
    Solid,
    /// A plane body without strain across.
    PlaneStrain,
    /// A plane body without stress across.
    PlaneStress,
    /// A section of a body of revolution about the y axis; x is the radius.
    Axisymmetric,
}

/// How an element is integrated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Integration {
    /// Exactly on undistorted cells, or nearly so.
    Full,
    /// With the points of the next lower order: R elements.
    Reduced,
    /// Fully, with incompatible modes besides the shape functions: I elements.
    Incompatible,
}

macro_rules! elements {
    ($($name:ident: $kind:ident, $model:ident, $integration:ident, $points:literal;)*) => {
        /// The type of an element, as the deck names it.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        #[allow(missing_docs)]
        pub enum ElementType { $($name),* }

        impl ElementType {
            /// All types.
            pub const ALL: &'static [ElementType] = &[$(ElementType::$name),*];

            /// Its name in decks.
            pub const fn name(self) -> &'static str {
                match self { $(ElementType::$name => stringify!($name)),* }
            }

            /// The kind of its cell.
            pub const fn kind(self) -> CellKind {
                match self { $(ElementType::$name => CellKind::$kind),* }
            }

            /// The mechanical model of this type.
            pub const fn model(self) -> ElementModel {
                match self { $(ElementType::$name => ElementModel::$model),* }
            }

            /// How it is integrated.
            pub const fn integration(self) -> Integration {
                match self { $(ElementType::$name => Integration::$integration),* }
            }

            /// With how many points CalculiX integrates its stiffness; in the plane for plane elements.
            pub const fn points(self) -> usize {
                match self { $(ElementType::$name => $points),* }
            }
        }
    };
}

elements! {
    C3D4: Tet4, Solid, Full, 1;
    C3D6: Wedge6, Solid, Full, 2;
    C3D8: Hex8, Solid, Full, 8;
    C3D8R: Hex8, Solid, Reduced, 1;
    C3D8I: Hex8, Solid, Incompatible, 8;
    C3D10: Tet10, Solid, Full, 4;
    C3D10T: Tet10, Solid, Full, 4;
    C3D15: Wedge15, Solid, Full, 9;
    C3D20: Hex20, Solid, Full, 27;
    C3D20R: Hex20, Solid, Reduced, 8;
    CPE3: Triangle3, PlaneStrain, Full, 1;
    CPE4: Quad4, PlaneStrain, Full, 4;
    CPE4R: Quad4, PlaneStrain, Reduced, 1;
    CPE6: Triangle6, PlaneStrain, Full, 3;
    CPE8: Quad8, PlaneStrain, Full, 9;
    CPE8R: Quad8, PlaneStrain, Reduced, 4;
    CPS3: Triangle3, PlaneStress, Full, 1;
    CPS4: Quad4, PlaneStress, Full, 4;
    CPS4R: Quad4, PlaneStress, Reduced, 1;
    CPS6: Triangle6, PlaneStress, Full, 3;
    CPS8: Quad8, PlaneStress, Full, 9;
    CPS8R: Quad8, PlaneStress, Reduced, 4;
    CAX3: Triangle3, Axisymmetric, Full, 1;
    CAX4: Quad4, Axisymmetric, Full, 4;
    CAX4R: Quad4, Axisymmetric, Reduced, 1;
    CAX6: Triangle6, Axisymmetric, Full, 3;
    CAX8: Quad8, Axisymmetric, Full, 9;
    CAX8R: Quad8, Axisymmetric, Reduced, 4;
}

impl ElementType {
    /// The type of that name, in capitals.
    pub fn named(name: &str) -> Option<ElementType> {
        Self::ALL.iter().copied().find(|e| e.name() == name)
    }

    /// The effect of its integration compared with full integration, in a sentence for reports.
    pub const fn sentence(self) -> &'static str {
        match (self.integration(), self.kind().order()) {
            (Integration::Full, _) => "is integrated fully",
            (Integration::Incompatible, _) => {
                "has incompatible modes in CalculiX, which make it softer in bending"
            }
            (Integration::Reduced, 1) => {
                "is integrated at its centre in CalculiX, with stabilised zero-energy modes"
            }
            (Integration::Reduced, _) => {
                "is integrated with the points of the linear element in CalculiX, which makes it softer"
            }
        }
    }
}

/// The kind of the cells of an element type that is read as a shape only, when a deck is read as a mesh: what Abaqus,
/// Gmsh and meshio call such shapes.
pub(super) fn shape(name: &str) -> Option<CellKind> {
    if let Some(element) = ElementType::named(name) {
        return Some(element.kind());
    }
    Some(match name {
        "MASS" | "SPRING1" | "DCOUP3D" => CellKind::Point1,
        "T2D2" | "T2D2H" | "T3D2" | "T3D2H" | "B21" | "B21H" | "B31" | "B31H" | "B31R" | "R2D2" => {
            CellKind::Line2
        }
        "SPRING2" | "SPRINGA" | "DASHPOTA" | "GAPUNI" => CellKind::Line2,
        "T2D3" | "T2D3H" | "T3D3" | "T3D3H" | "B22" | "B22H" | "B32" | "B32H" | "B32R" => {
            CellKind::Line3
        }
        "S3" | "S3R" | "S3RS" | "STRI3" | "R3D3" | "M3D3" | "SFM3D3" | "DS3" | "CPE3H"
        | "CAX3H" => CellKind::Triangle3,
        "STRI65" | "S6" | "M3D6" | "SFM3D6" | "DS6" | "CPE6H" | "CPE6M" | "CPS6M" | "CAX6H"
        | "CAX6M" => CellKind::Triangle6,
        "S4" | "S4R" | "S4RS" | "S4RSW" | "S4R5" | "R3D4" | "M3D4" | "M3D4R" | "SFM3D4" | "DS4"
        | "CPE4H" | "CPE4I" | "CPS4I" | "CAX4H" | "CAX4I" | "CAX4P" => CellKind::Quad4,
        "S8" | "S8R" | "S8R5" | "M3D8" | "M3D8R" | "SFM3D8" | "DS8" | "CPE8H" | "CPE8RH"
        | "CAX8H" | "CAX8RH" => CellKind::Quad8,
        "S9R5" | "M3D9" | "M3D9R" => CellKind::Quad9,
        "C3D4H" | "DC3D4" | "F3D4" => CellKind::Tet4,
        "C3D5" | "C3D5H" => CellKind::Pyramid5,
        "C3D6H" | "DC3D6" | "F3D6" => CellKind::Wedge6,
        "C3D8H" | "C3D8IH" | "C3D8RH" | "DC3D8" | "F3D8" | "F3D8R" => CellKind::Hex8,
        "C3D10H" | "C3D10I" | "C3D10M" | "C3D10MH" | "C3D10HS" | "DC3D10" => CellKind::Tet10,
        "C3D15H" | "DC3D15" => CellKind::Wedge15,
        "C3D20H" | "C3D20RH" | "DC3D20" => CellKind::Hex20,
        _ => return None,
    })
}

/// The sort of an element whose type is not solved, for the message.
pub(super) fn what_is(name: &str) -> &'static str {
    const BY_BEGINNING: &[(&str, &str)] = &[
        ("DC3D", "elements of heat"),
        ("DC2D", "elements of heat"),
        ("DCAX", "elements of heat"),
        ("DCOUP", "couplings"),
        ("DASHPOT", "dashpots"),
        ("DS", "elements of heat"),
        ("F3D", "fluids"),
        ("SPRING", "springs"),
        ("GAP", "gaps"),
        ("MASS", "point masses"),
        ("CONN", "connectors"),
        ("C3D", "hybrid or modified solids"),
        ("CPE", "hybrid or modified plane elements"),
        ("CPS", "modified plane elements"),
        ("CAX", "hybrid or modified axisymmetric elements"),
        ("M3D", "membranes"),
        ("R2D", "rigid elements"),
        ("R3D", "rigid elements"),
        ("S", "shells"),
        ("B", "beams"),
        ("T", "trusses"),
        ("D", "networks of fluids"),
        ("U", "elements of users"),
    ];
    let found = BY_BEGINNING
        .iter()
        .find(|(beginning, _)| name.starts_with(beginning));
    found.map_or("unknown elements", |&(_, what)| what)
}

#[cfg(test)]
#[path = "../tests/element.rs"]
mod tests;

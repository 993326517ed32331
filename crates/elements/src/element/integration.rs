//! How the stiffness of a cell is integrated, and which element of CalculiX that is.

use super::axial::is_axial;
use crate::cell::{Cure, Element, Material, Moduli};
use crate::kind::CellKind;

/// How the stiffness of a cell is integrated.
///
/// Which element of CalculiX 2.20 that is, by its stiffness matrices of distorted cells
/// (scripts/calculix_elements.py):
///
/// | CalculiX | ours | difference |
/// |---|---|---|
/// | C3D4, C3D8, C3D10, C3D20 | [`Full`](Self::Full) | none |
/// | C3D6, C3D15, C3D20R | [`Reduced`](Self::Reduced) | none |
/// | C3D8I, C3D8R | [`Incompatible`](Self::Incompatible), [`Reduced`](Self::Reduced) | none on parallelepipeds; on others CalculiX 2.20 fails the patch test, ours does not |
/// | CPE3, CPE4, CPE6, CPE8 | [`Full`](Self::Full), plane strain | none |
/// | CPE8R | [`Reduced`](Self::Reduced), plane strain | none |
/// | CPE4R | [`Reduced`](Self::Reduced), plane strain | as C3D8R; CalculiX's hourglass stiffness has a term with 1/thickness², ours has not |
/// | CPS3, CPS4, CPS6, CPS8, CPS8R | [`Full`](Self::Full), [`Reduced`](Self::Reduced), plane stress | CalculiX is stiffer, see below |
/// | CPS4R | [`Reduced`](Self::Reduced), plane stress | both of the above |
/// | CAX4, CAX6, CAX8, CAX8R | [`Full`](Self::Full), [`Reduced`](Self::Reduced), [`Plane::Axial`](crate::cell::Plane) | CalculiX's ring is 180 wedges of 2°, flat in between: forces differ by 3e-4 |
/// | CAX3 | [`Full`](Self::Full), [`Plane::Axial`](crate::cell::Plane) | also: ours has three points, with one it could turn about it |
/// | CAX4R | none | |
///
/// **Plane cells of CalculiX** are one layer of solid ones (CPE8R is a C3D20R) whose two faces move alike. In plane
/// strain nothing moves across the plane, and the layer is the plane cell. In plane stress the faces move apart by a
/// displacement with nodes of its own, which neighbours share: σ_zz = 0 holds in the mean and not at every point. That
/// makes the layer stiffer, by what vanishes as cells get small.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Integration {
    /// Every product of gradients is integrated exactly on affine cells.
    #[default]
    Full,
    /// Fewer points: those of CalculiX's C3D20R, C3D15, C3D6, CPE8R; on [`CellKind::Quad4`] and [`CellKind::Hex8`] the
    /// mean gradient with the hourglass stiffness of Flanagan and Belytschko (elastic only), as C3D8R and CPE4R.
    ///
    /// A single [`CellKind::Quad8`], [`CellKind::Hex20`] or [`CellKind::Wedge6`] then has motions without energy that
    /// are not rigid: 1, 6 and 1 of them. Mostly they do not fit together on neighbours; in columns of single wedges or
    /// hexahedra some do (`crates/scene/src/assembly/zero_energy.rs`).
    Reduced,
    /// Incompatible modes, condensed (Wilson, Taylor): bending without locking on [`CellKind::Quad4`] and
    /// [`CellKind::Hex8`], elastic only. C3D8I.
    Incompatible,
}

impl Integration {
    /// Its name in messages.
    pub const fn name(self) -> &'static str {
        match self {
            Integration::Full => "full integration",
            Integration::Reduced => "reduced integration",
            Integration::Incompatible => "incompatible modes",
        }
    }
}

/// Whether there is such an element.
///
/// # Errors
/// One clause, without a full stop, that says what was found and what was expected; the caller knows the place.
pub fn check(
    kind: CellKind,
    dim: usize,
    material: &Material,
    integration: Integration,
) -> Result<(), String> {
    if kind.dim() != dim || !(2..=3).contains(&dim) {
        return Err(format!(
            "a {} is found, expected a cell of dimension {dim}",
            kind.name()
        ));
    }
    let bilinear = matches!(kind, CellKind::Quad4 | CellKind::Hex8);
    let element = if bilinear { Element::Q1 } else { Element::P1 };
    let cure = match material {
        Material::Scalar { .. } => Cure::None,
        Material::Elastic { cure, .. } => *cure,
    };
    if cure != Cure::None && !bilinear {
        return Err(format!(
            "a cure of locking is given with a {}, expected quadrilaterals of 4 or hexahedra of 8 nodes",
            kind.name()
        ));
    }
    material.check_numbers()?;
    material.check_cure(dim, element)?;
    if cure != Cure::None && integration != Integration::Full {
        return Err(format!(
            "a cure of locking is given with {}, expected one of the two",
            integration.name()
        ));
    }
    let exists = match (integration, kind) {
        (Integration::Full, _) => true,
        (Integration::Incompatible, _) => bilinear,
        (Integration::Reduced, CellKind::Quad8 | CellKind::Hex20) => true,
        (Integration::Reduced, CellKind::Wedge6 | CellKind::Wedge15) => true,
        (Integration::Reduced, _) => bilinear,
    };
    if !exists {
        return Err(format!(
            "{} is given with a {}, expected full integration",
            integration.name(),
            kind.name()
        ));
    }
    if bilinear && integration != Integration::Full && is_axial(dim, material) {
        return Err(format!(
            "{} is given with an axisymmetric {}, expected full integration",
            integration.name(),
            kind.name()
        ));
    }
    if bilinear && integration != Integration::Full && matches!(material, Material::Scalar { .. }) {
        return Err(format!(
            "{} is given with a scalar problem, expected full integration",
            integration.name()
        ));
    }
    Ok(())
}

/// Panics when [`check`] refuses; the moduli of the material.
pub(super) fn moduli(
    kind: CellKind,
    dim: usize,
    material: &Material,
    integration: Integration,
) -> Moduli {
    if let Err(clause) = check(kind, dim, material, integration) {
        panic!("{clause}");
    }
    material.moduli(dim, Element::Q1)
}

#[cfg(test)]
#[path = "../../tests/element/integration.rs"]
mod tests;

use super::super::testing::{elastic, solid_kinds, INTEGRATIONS, STEEL};
use super::*;
use crate::cell::Plane;

const BILINEAR: [CellKind; 2] = [CellKind::Quad4, CellKind::Hex8];

#[test]
fn every_cell_takes_full_integration() {
    for kind in solid_kinds() {
        for material in [STEEL, Material::Scalar { rho: 1.0 }] {
            assert_eq!(
                check(kind, kind.dim(), &material, Integration::Full),
                Ok(())
            );
        }
    }
}

#[test]
fn cures_are_for_quadrilaterals_of_4_and_hexahedra_of_8_nodes() {
    for kind in solid_kinds() {
        for cure in [Cure::Selective, Cure::BBar] {
            let material = elastic(1.0, 0.49, Plane::Strain, cure);
            let found = check(kind, kind.dim(), &material, Integration::Full);
            assert_eq!(found.is_ok(), BILINEAR.contains(&kind), "{kind:?}");
            if let Err(clause) = found {
                assert!(clause.contains(kind.name()) && clause.contains("expected quadrilaterals"));
            }
            for integration in [Integration::Reduced, Integration::Incompatible] {
                assert!(check(kind, kind.dim(), &material, integration).is_err());
            }
        }
    }
    let stress = elastic(1.0, 0.3, Plane::Stress, Cure::BBar);
    let clause = check(CellKind::Quad4, 2, &stress, Integration::Full).expect_err("refused");
    assert!(clause.contains("plane stress"), "{clause}");
}

#[test]
fn what_there_is_not_is_refused_by_name() {
    let mut taken = Vec::new();
    for kind in solid_kinds() {
        for integration in INTEGRATIONS {
            match check(kind, kind.dim(), &STEEL, integration) {
                Ok(()) => taken.push((kind, integration)),
                Err(clause) => {
                    assert!(
                        clause.contains(integration.name()) && clause.contains(kind.name()),
                        "{clause}"
                    );
                }
            }
        }
    }
    taken.retain(|(_, integration)| *integration != Integration::Full);
    let expected = [
        (CellKind::Quad4, Integration::Reduced),
        (CellKind::Quad4, Integration::Incompatible),
        (CellKind::Quad8, Integration::Reduced),
        (CellKind::Wedge6, Integration::Reduced),
        (CellKind::Wedge15, Integration::Reduced),
        (CellKind::Hex8, Integration::Reduced),
        (CellKind::Hex8, Integration::Incompatible),
        (CellKind::Hex20, Integration::Reduced),
    ];
    assert_eq!(taken, expected);
}

#[test]
fn scalar_problems_have_no_hourglass_stiffness() {
    let scalar = Material::Scalar { rho: 1.0 };
    for kind in BILINEAR {
        for integration in [Integration::Reduced, Integration::Incompatible] {
            let clause = check(kind, kind.dim(), &scalar, integration).expect_err("refused");
            assert!(clause.contains("scalar"), "{clause}");
        }
    }
}

#[test]
fn sides_points_and_wrong_dimensions_are_no_cells() {
    for (kind, dim) in [
        (CellKind::Point1, 0),
        (CellKind::Line2, 1),
        (CellKind::Line3, 2),
        (CellKind::Quad4, 3),
        (CellKind::Hex8, 2),
    ] {
        let clause = check(kind, dim, &STEEL, Integration::Full).expect_err("refused");
        assert!(
            clause.contains(&format!("expected a cell of dimension {dim}")),
            "{clause}"
        );
    }
}

#[test]
fn bad_numbers_are_refused() {
    let bad = elastic(-1.0, 0.3, Plane::Strain, Cure::None);
    let clause = check(CellKind::Tet10, 3, &bad, Integration::Full).expect_err("refused");
    assert!(clause.contains("Young's modulus is -1"), "{clause}");
}

//! Nodal forces of single distorted cells beside those of CalculiX, which scripts/calculix_elements.py wrote.

use super::*;
use elements::cell::{Cure, Material};
use elements::element::quadrature::{rule, Purpose};
use elements::element::{check, stiffness, Integration};
use elements::law::Law;

const STEEL: Material = Material::Elastic {
    law: Law::Isotropic {
        young: 3.0,
        poisson: 0.3,
    },
    plane: Plane::Strain,
    cure: Cure::None,
};

const INTEGRATIONS: [Integration; 3] = [
    Integration::Full,
    Integration::Reduced,
    Integration::Incompatible,
];

struct Case {
    name: String,
    affine: bool,
    thickness: f64,
    points: Vec<[f64; 3]>,
    forces: Vec<f64>,
}

fn cases() -> Vec<Case> {
    let text = include_str!("../../../../tests/data/calculix_elements.txt");
    let numbers = |line: &str| -> Vec<f64> {
        let words = line.split_whitespace();
        words.map(|word| word.parse().expect("a number")).collect()
    };
    let mut lines = text.lines().skip(1);
    let mut cases = Vec::new();
    while let Some(head) = lines.next() {
        let [name, shape, thickness] = head.split(' ').collect::<Vec<_>>()[..] else {
            panic!("name, shape and thickness: {head}");
        };
        let (kind, ..) = ours(name);
        let mut point = || {
            let [x, y, z] = numbers(lines.next().expect("a node"))[..] else {
                panic!("three coordinates");
            };
            [x, y, z]
        };
        cases.push(Case {
            name: name.into(),
            affine: shape == "affine",
            thickness: thickness.parse().expect("a number"),
            points: (0..kind.nodes()).map(|_| point()).collect(),
            forces: numbers(lines.next().expect("forces")),
        });
    }
    cases
}

/// Kind and integration of an element of CalculiX, and its plane.
fn ours(name: &str) -> (CellKind, Integration, Plane) {
    let element = ElementType::named(name).expect("an element");
    let (integration, plane) = deck_element(element);
    (element.kind(), integration, plane.unwrap_or_default())
}

fn displacement(i: usize) -> f64 {
    ((i * i * 3 + i * 7 + 5) % 11) as f64 - 5.0
}

/// K u of our cell, and twice its energy.
fn forces(case: &Case, integration: Integration) -> (Vec<f64>, f64) {
    let (kind, _, plane) = ours(&case.name);
    let material = Material::Elastic {
        law: Law::Isotropic {
            young: 1000.0,
            poisson: 0.3,
        },
        plane,
        cure: Cure::None,
    };
    let n = case.points.len() * material.components(kind.dim());
    let mut k = vec![f64::NAN; n * n];
    stiffness(
        kind,
        kind.dim(),
        &case.points,
        &material,
        integration,
        &mut k,
    );
    let row = |row: &[f64]| {
        let products = row.iter().enumerate().map(|(j, k)| k * displacement(j));
        products.sum::<f64>()
    };
    let forces: Vec<f64> = k.chunks_exact(n).map(|r| case.thickness * row(r)).collect();
    let energy = energy(&forces);
    (forces, energy)
}

fn energy(forces: &[f64]) -> f64 {
    forces
        .iter()
        .enumerate()
        .map(|(i, f)| f * displacement(i))
        .sum()
}

/// The largest difference, relative to the largest force.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let largest = b.iter().fold(0.0, |most: f64, f| most.max(f.abs()));
    let differences = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    differences.fold(0.0, f64::max) / largest
}

#[test]
fn solid_and_plane_strain_cells_are_those_of_calculix() {
    let mut names = Vec::new();
    for case in cases() {
        if !case.name.starts_with("C3D") && !case.name.starts_with("CPE") {
            continue;
        }
        let (_, integration, _) = ours(&case.name);
        let (forces, _) = forces(&case, integration);
        let distance = distance(&forces, &case.forces);
        match (&case.name[..], case.affine) {
            // CalculiX 2.20 fails the patch test here.
            ("C3D8I" | "C3D8R", false) => {
                assert!(distance > 1e-4 && distance < 1e-2, "{distance:e}")
            }
            // Ours is the limit of thick layers.
            ("CPE4R", false) => assert!(distance > 1e-3 && distance < 1e-1, "{distance:e}"),
            // CalculiX writes Gauss points with 15 digits, the file has 11.
            (name, _) => assert!(distance < 1e-10, "{name}: {distance:e}"),
        }
        names.push(case.name);
    }
    assert_eq!(names.len(), 18);
}

#[test]
fn another_integration_is_not_that_of_calculix() {
    for case in cases() {
        let (kind, right, _) = ours(&case.name);
        if case.name.starts_with("CAX") {
            continue;
        }
        for integration in INTEGRATIONS {
            let exists = check(kind, kind.dim(), &STEEL, integration).is_ok();
            if integration != right && exists {
                let (forces, _) = forces(&case, integration);
                assert!(
                    distance(&forces, &case.forces) > 1e-3,
                    "{} {integration:?}",
                    case.name
                );
            }
        }
    }
}

#[test]
fn plane_stress_of_calculix_is_stiffer_unless_a_single_cell_is_thin() {
    let mut seen = 0;
    for case in cases().iter().filter(|case| case.name.starts_with("CPS")) {
        let (_, integration, _) = ours(&case.name);
        let (forces, ours) = forces(case, integration);
        let (distance, theirs) = (distance(&forces, &case.forces), energy(&case.forces));
        match (&case.name[..], case.thickness == 1.0) {
            // One strain: the faces move apart evenly.
            ("CPS3", _) => assert!(distance < 1e-10, "{distance:e}"),
            // Its hourglass stiffness grows with 1/thickness².
            ("CPS4R", true) => assert!(distance > 1e-3, "{distance:e}"),
            ("CPS4R", false) => assert!(theirs > 1000.0 * ours),
            (name, true) => assert!(distance > 1e-3 && theirs > ours, "{name} {distance:e}"),
            // More points than nodes: σ_zz = 0 in the mean.
            ("CPS8", false) => assert!(distance < 1e-3 && theirs > ours, "{distance:e}"),
            (name, false) => assert!(distance < 1e-6 && theirs > ours, "{name} {distance:e}"),
        }
        seen += 1;
    }
    assert_eq!(seen, 12);
}

#[test]
fn rings_are_those_of_calculix_but_for_its_flat_wedge() {
    let mut seen = 0;
    for mut case in cases()
        .into_iter()
        .filter(|case| case.name.starts_with("CAX"))
    {
        if case.name == "CAX4R" {
            continue;
        }
        // A wedge of 2 degrees.
        for force in &mut case.forces {
            *force *= 180.0;
        }
        let (_, integration, _) = ours(&case.name);
        let (forces, _) = forces(&case, integration);
        let distance = distance(&forces, &case.forces);
        // The wedge is flat in between: by 1 − cos 1° = 1.5e-4 nearer to the axis at its ends.
        let expected = match &case.name[..] {
            "CAX3" => 1e-3..5e-3,
            _ => 1e-5..4e-4,
        };
        assert!(expected.contains(&distance), "{} {distance:e}", case.name);
        seen += 1;
    }
    assert_eq!(seen, 5);
}

#[test]
fn every_element_of_a_deck_is_one_of_ours_but_for_one() {
    let mut refused = Vec::new();
    for &element in ElementType::ALL {
        let (integration, plane) = deck_element(element);
        let material = Material::Elastic {
            law: Law::Isotropic {
                young: 1.0,
                poisson: 0.3,
            },
            plane: plane.unwrap_or_default(),
            cure: Cure::None,
        };
        let kind = element.kind();
        if let Err(clause) = check(kind, kind.dim(), &material, integration) {
            assert!(clause.contains("axisymmetric"), "{clause}");
            refused.push(element.name());
            continue;
        }
        // As many points as CalculiX has; the mean of a bilinear cell counts as one, triangles turn about one.
        let bilinear = matches!(kind, CellKind::Quad4 | CellKind::Hex8);
        let purpose = match integration {
            Integration::Reduced if bilinear => Purpose::Centre,
            Integration::Reduced => Purpose::Reduced,
            _ => Purpose::Full,
        };
        if element != ElementType::CAX3 {
            assert_eq!(
                rule(kind, purpose).len(),
                element.points(),
                "{}",
                element.name()
            );
        }
    }
    assert_eq!(refused, ["CAX4R"]);
}

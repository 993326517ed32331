//! Exact condition numbers in 3D and of elasticity, against values measured with dense algebra.

use crate::support::checks::identities;
use crate::support::mpi::alone;
use crate::support::sample::all_cases;
use crate::support::session::with_session;
use crate::support::solid;
use fetifeti::settings::{Averages, MethodSettings, PcType, Primal};
use fetifeti::FetiFeti;
use petsc::{Options, Session};
use solid::{Physics, Rows, Solid};

const SCALAR: Physics = Physics::Scalar;
const CORRECTED: PcType = PcType::CoarseCorrected;

fn elastic(nu: f64) -> Physics {
    Physics::Elastic { nu }
}

fn kappa_with(session: &Session, solid: &Solid, settings: MethodSettings) -> f64 {
    let mut solver =
        FetiFeti::new(session, solid.substructures(|_| true), settings).expect("set up");
    identities(&solver, 1e-10, "spectra");
    // The values to compare with have three digits. λ_min ends a cluster, which is expensive to take apart.
    let options = Options::new(session, &solver.settings().method.prefix);
    options
        .set_value("eps_tol", Some("1e-5"))
        .expect("an option");
    let s = solver.spectrum().expect("eigenvalues");
    let s = s.expect("multipliers");
    println!(
        "{}D {:?}: {s:?}",
        solid.dim,
        [solid.bodies, solid.subdomains, solid.elements]
    );
    assert!(s.lambda_min > 1.0 - 1e-6, "{s:?}");
    s.kappa()
}

fn kappa(session: &Session, solid: &Solid, pc: PcType) -> f64 {
    let settings = MethodSettings::default().pc_type(pc);
    kappa_with(session, solid, settings)
}

/// `found` agrees with `wanted` to `percent` percent.
fn near(found: f64, wanted: f64, percent: f64) {
    assert!(
        (found / wanted - 1.0).abs() < percent / 100.0,
        "{found}, expected {wanted}"
    );
}

#[test]
fn scalar_in_3d() {
    alone(|| {
        with_session(|session| {
            let solid = |sizes| Solid::new(3, sizes, SCALAR, Rows::Tied);
            near(kappa(session, &solid([2, 2, 4]), CORRECTED), 2.74, 2.0);
            let plain = kappa(session, &solid([2, 3, 3]), PcType::Dirichlet);
            near(plain, 5.39, 1.0);
            if all_cases() {
                near(kappa(session, &solid([2, 3, 3]), CORRECTED), 2.92, 2.0);
            }
            // Without edge averages, vertices alone do not suffice in 3D; additional faces do no harm.
            let with = |text| {
                let settings =
                    MethodSettings::default().primal(Primal::parse(text).expect("constraints"));
                kappa_with(session, &solid([2, 2, 3]), settings)
            };
            let usual = with("vertices,edges");
            assert!(with("vertices") > 1.5 * usual);
            assert!(with("edges") < 1.2 * usual);
            assert!(with("vertices,edges,faces") < 1.05 * usual);
        })
    });
}

#[test]
fn averages_of_motions() {
    alone(|| {
        with_session(|session| {
            let solid = Solid::new(3, [1, 2, 4], elastic(0.3), Rows::Tied);
            let with = |text, averages| {
                let primal = Primal::parse(text).expect("constraints");
                let settings = MethodSettings::default().primal(primal);
                kappa_with(session, &solid, settings.averages(averages))
            };
            // Faces and vertices do not hold rotations by components alone, and by motions they do.
            let [few, all] = [Averages::Components, Averages::Motions];
            let faces = with("vertices,faces", few);
            assert!(with("vertices,faces", all) < 0.9 * faces);
            if all_cases() {
                let most = with("vertices,edges,faces", few);
                assert!(with("vertices,edges,faces", all) < most);
            }
        })
    });
}

fn plates(nu: f64, rows: Rows) -> Solid {
    Solid::new(2, [2, 8, 4], elastic(nu), rows)
}

#[test]
fn plane_strain_along_normals() {
    alone(|| {
        with_session(|session| {
            // The reference values treat whole nodes as candidates and have no rows at cross points.
            let by_node = |pc| kappa(session, &plates(0.3, Rows::NormalsByNode), pc);
            near(by_node(CORRECTED), 14.5, 1.0);
            // Ours: tangential values on the faces stay in Z_c.
            let normals = kappa(session, &plates(0.3, Rows::Normals), CORRECTED);
            assert!(normals < 14.5, "{normals}");
            if all_cases() {
                near(by_node(PcType::Dirichlet), 67.3, 1.0);
            }
        })
    });
}

#[test]
fn plane_strain() {
    alone(|| {
        with_session(|session| {
            let solid = plates;
            if all_cases() {
                let tied = kappa(session, &solid(0.3, Rows::Tied), CORRECTED);
                assert!(tied <= 24.0, "{tied}");
            }
            let stiff = kappa(session, &solid(0.49, Rows::Tied), CORRECTED);
            near(stiff, 25.3, 1.0);
            let plain = kappa(session, &solid(0.49, Rows::Tied), PcType::Dirichlet);
            near(plain, 278.0, 2.0);
            // Edge averages are constraints in 2D, too, if the substructures list them.
            let edges = Solid {
                plane_edges: true,
                ..solid(0.49, Rows::Tied)
            };
            let edges = kappa(session, &edges, CORRECTED);
            assert!(edges < 0.8 * stiff, "{edges}");
        })
    });
}

fn elastic_cubes(rows: Rows) -> Solid {
    Solid::new(3, [2, 3, 2], elastic(0.3), rows)
}

#[test]
fn elasticity_in_3d() {
    alone(|| {
        with_session(|session| {
            let tied = elastic_cubes(Rows::Tied);
            near(kappa(session, &tied, CORRECTED), 4.68, 1.0);
            if all_cases() {
                near(kappa(session, &tied, PcType::Dirichlet), 6.78, 1.0);
            }
        })
    });
}

#[test]
fn elasticity_in_3d_along_normals() {
    alone(|| {
        with_session(|session| {
            let solid = elastic_cubes;
            if all_cases() {
                let by_node = kappa(session, &solid(Rows::NormalsByNode), CORRECTED);
                near(by_node, 2.47, 1.0);
            }
            let normals = kappa(session, &solid(Rows::Normals), CORRECTED);
            assert!(normals < 2.47, "{normals}");
        })
    });
}

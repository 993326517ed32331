//! The operators with mortar rows: identities and λ_min ≥ 1 for every preconditioner, scaling and projector, in the
//! plane and in space, tied and in contact, with jumps either way.

use crate::support::checks::identities;
use crate::support::session::with_session;
use fetifeti::settings::{Adaptive, MethodSettings, PcType, ProjectorKind, Scaling};
use fetifeti::{FetiFeti, Status};
use petsc::Session;
use scene::Scene;

/// Two blocks, the lower one held and the upper one floating, with these moduli and this joint.
fn blocks(dim: usize, young: [f64; 2], joint: &str) -> String {
    let body = |name: &str, at: &str, mesh: [&str; 2], young: f64, keys: &str| {
        let size = ["[2, 1]", "[2, 1, 2]"][dim - 2];
        format!(
            "[[body]]\nname = \"{name}\"\norigin = {at}\nsize = {size}\nelements = {}\nsubdomains = {}\n\
             young = {young:e}\npoisson = 0.3\n{keys}",
            mesh[0], mesh[1]
        )
    };
    let [low, up] = match dim {
        2 => [["[9, 4]", "[3, 2]"], ["[12, 4]", "[4, 2]"]],
        _ => [["[4, 2, 4]", "[2, 1, 2]"], ["[6, 2, 5]", "[2, 1, 1]"]],
    };
    let [origin, above, force] = [
        ["[0, 0]", "[0, 1]", "[0.1, -1]"],
        ["[0, 0, 0]", "[0, 1, 0]", "[0.1, -1, 0]"],
    ][dim - 2];
    let held = ["", ", back = { z = 0 }"][dim - 2];
    let low = body("low", origin, low, young[0], "dirichlet = [\"bottom\"]\n");
    let keys =
        format!("dirichlet = {{ left = {{ x = 0 }}{held} }}\ntraction = {{ top = {force} }}\n");
    let up = body("up", above, up, young[1], &keys);
    format!(
        "dimension = {dim}\nphysics = \"elasticity\"\n{low}{up}{joint}bodies = [\"low\", \"up\"]\n"
    )
}

const TIE: &str = "[[tie]]\n";
/// Open on one half.
const CONTACT: &str = "[[contact]]\ngap = \"if(x > 1, 0.05, 0)\"\n";

/// Solves, and checks identities and λ_min with the rows that hold at the end. Returns how many do, and all. A body
/// that is 1e12 times as stiff as what carries it has strains of the size of rounding, and the certificate says so,
/// with matching nodes as well.
fn check(
    session: &Session,
    text: &str,
    settings: MethodSettings,
    limit: f64,
    what: &str,
) -> [usize; 2] {
    let scene = Scene::parse("s.toml", text).expect("a scene");
    let problem = scene.substructures(&|_| true).expect("substructures");
    let mut solver = FetiFeti::new(session, problem, settings).expect("set up");
    let solution = solver.solve().expect("a solution");
    let rounded = solution.status == Status::Certificate && text.contains("e12");
    assert!(
        solution.converged() || rounded,
        "{what}: {}",
        solution.status
    );
    identities(&solver, limit, what);
    let spectrum = solver
        .spectrum()
        .expect("eigenvalues")
        .expect("multipliers");
    let least = spectrum.lambda_min;
    assert!(least > 1.0 - 1e-8, "{what}: {least}");
    let rows = solution.rows();
    [rows.iter().filter(|r| r.holds()).count(), rows.len()]
}

#[test]
fn every_operator_keeps_its_identities() {
    with_session(|session| {
        for dim in [2, 3] {
            for joint in [TIE, CONTACT] {
                let text = blocks(dim, [100.0, 300.0], joint);
                let mut sets = Vec::new();
                for pc in [PcType::Dirichlet, PcType::CoarseCorrected] {
                    for scaling in [
                        Scaling::Multiplicity,
                        Scaling::Rho,
                        Scaling::Stiffness,
                        Scaling::Deluxe,
                    ] {
                        for projector in [
                            ProjectorKind::Identity,
                            ProjectorKind::Diagonal,
                            ProjectorKind::Preconditioner,
                        ] {
                            let settings = MethodSettings::default()
                                .pc_type(pc)
                                .scaling(scaling)
                                .projector(projector);
                            let what = format!("{dim}D {joint:?} {pc:?} {scaling:?} {projector:?}");
                            sets.push(check(session, &text, settings, 1e-13, &what));
                        }
                    }
                    let adaptive = MethodSettings::default()
                        .pc_type(pc)
                        .adaptive(Adaptive::Below(2.0));
                    let what = format!("{dim}D {joint:?} {pc:?} adaptive");
                    sets.push(check(session, &text, adaptive, 1e-12, &what));
                }
                let [hold, all] = sets[0];
                println!("{dim}D {joint:?}: {hold} of {all} rows hold");
                assert!(sets.iter().all(|set| *set == [hold, all]), "{sets:?}");
                match joint {
                    TIE => assert_eq!(hold, all),
                    _ => assert!(4 * hold > all && 4 * hold < 3 * all, "{hold} of {all}"),
                }
            }
        }
    });
}

#[test]
fn jumps_cost_no_identity() {
    with_session(|session| {
        for dim in [2, 3] {
            for joint in [TIE, CONTACT] {
                for young in [[1e12, 1.0], [1.0, 1e12], [1e6, 1.0], [1.0, 1e6]] {
                    // The load moves the softer one by the same.
                    let text = blocks(dim, young, joint);
                    let text = text.replace("-1", "-0.01").replace("[0.1,", "[0.001,");
                    for pc in [PcType::Dirichlet, PcType::CoarseCorrected] {
                        for scaling in [Scaling::Rho, Scaling::Stiffness] {
                            let settings = MethodSettings::default().pc_type(pc).scaling(scaling);
                            let what = format!("{dim}D {joint:?} {young:?} {pc:?} {scaling:?}");
                            check(session, &text, settings, 1e-12, &what);
                        }
                    }
                }
            }
        }
    });
}

//! u of the method compared with a direct solution of the assembled problem, in the energy norm.

use crate::support::direct;
use crate::support::session::with_session;
use direct::{floating_scenes, tight, with_options, Direct};
use fetifeti::settings::{MethodSettings, PcType, ProjectorKind, Scaling};
use petsc::Named;
use scene::Scene;

const PROJECTORS: [ProjectorKind; 4] = [
    ProjectorKind::Identity,
    ProjectorKind::Diagonal,
    ProjectorKind::Preconditioner,
    ProjectorKind::Auto,
];
const SCALINGS: [Scaling; 3] = [Scaling::Multiplicity, Scaling::Rho, Scaling::Stiffness];

/// The scene with default settings at rtol 1e-12.
fn agrees(name: &'static str) {
    with_session(move |session| {
        let direct = Direct::example(name);
        let (solution, distance) = direct.run(session, &tight());
        println!(
            "{name}: {distance:.1e} after {} iterations, {:?}",
            solution.iterations, solution.kkt
        );
        assert!(solution.converged(), "{name}: {}", solution.status);
        assert!(distance < 1e-8, "{name}: {distance:.1e}");
    });
}

#[test]
fn tied_bodies() {
    agrees("poisson_2x2");
}

#[test]
fn partly_tied_bodies() {
    agrees("partly_tied");
}

#[test]
fn one_body() {
    agrees("one_body");
}

#[test]
fn one_subdomain_per_body() {
    agrees("one_subdomain");
}

#[test]
fn unequal_bodies_with_boundary_values() {
    agrees("unequal_bodies");
}

#[test]
fn a_floating_body_on_one_face() {
    agrees("model_tied");
}

#[test]
fn both_columns_of_the_paper() {
    agrees("lee_column_1");
    agrees("lee_column_2");
}

#[test]
fn jumps_of_ten_thousand() {
    agrees("jump_checkerboard");
}

#[test]
fn jumps_of_a_million_each_way() {
    agrees("jump_1e6");
}

#[test]
fn every_preconditioner_with_every_projector() {
    with_session(|session| {
        for (name, direct) in floating_scenes() {
            for &(pc, _) in PcType::VALUES {
                for projector in PROJECTORS {
                    let settings = tight().pc_type(pc).projector(projector);
                    let (solution, distance) = direct.run(session, &settings);
                    println!(
                        "{name} {pc:?} {projector:?}: {distance:.1e}, {} iterations",
                        solution.iterations
                    );
                    assert!(
                        solution.converged(),
                        "{name} {pc:?} {projector:?}: {}",
                        solution.status
                    );
                    assert!(
                        distance < 1e-8,
                        "{name} {pc:?} {projector:?}: {distance:.1e}"
                    );
                }
            }
        }
    });
}

#[test]
fn every_scaling_with_every_projector() {
    with_session(|session| {
        for (name, direct) in floating_scenes() {
            for scaling in SCALINGS {
                for gamma in [0.5, 1.0, 2.0] {
                    if gamma != 1.0 && scaling != Scaling::Rho {
                        continue;
                    }
                    for projector in PROJECTORS {
                        for pc in [PcType::Dirichlet, PcType::CoarseCorrected] {
                            let what = format!("{name} {scaling:?} {gamma} {projector:?} {pc:?}");
                            let settings = tight()
                                .scaling(scaling)
                                .gamma(gamma)
                                .projector(projector)
                                .pc_type(pc);
                            let (solution, distance) = direct.run(session, &settings);
                            println!("{what}: {distance:.1e}, {} iterations", solution.iterations);
                            assert!(solution.converged(), "{what}: {}", solution.status);
                            assert!(distance < 1e-8, "{what}: {distance:.1e}");
                        }
                    }
                }
            }
        }
    });
}

#[test]
fn krylov_methods_reach_the_same_solution() {
    with_session(|session| {
        for (name, direct) in floating_scenes() {
            for method in ["cg", "fcg", "pipecg", "gmres", "fgmres"] {
                let options = [
                    ("ksp_type", method),
                    ("ksp_rtol", "1e-12"),
                    ("ksp_gmres_restart", "200"),
                ];
                let (kind, (solution, distance)) = with_options(session, &options, || {
                    let mut solver = direct.solver(session, &MethodSettings::default());
                    let solution = solver.solve().expect("solved");
                    let distance = direct.distance(&solution.u);
                    (solver.ksp().type_name().unwrap(), (solution, distance))
                });
                println!(
                    "{name} {method}: {distance:.1e}, {} iterations",
                    solution.iterations
                );
                assert_eq!(kind, method);
                assert!(solution.converged(), "{name} {method}: {}", solution.status);
                assert!(distance < 1e-8, "{name} {method}: {distance:.1e}");
            }
        }
    });
}

#[test]
fn a_run_that_stops_early_says_so() {
    with_session(|session| {
        let direct = Direct::example("poisson_2x2");
        let options = [("ksp_max_it", "2")];
        let solution = with_options(session, &options, || direct.run(session, &tight()).0);
        assert!(!solution.converged());
        assert_eq!(
            (solution.iterations, solution.status.name()),
            (2, "DIVERGED_ITS")
        );
    });
}

#[test]
fn no_iterations_may_be_asked_for_and_no_negative_number_of_them() {
    with_session(|session| {
        for name in ["poisson_2x2", "one_body"] {
            for method in ["cg", "gmres"] {
                let direct = Direct::example(name);
                let options = [("ksp_max_it", "0"), ("ksp_type", method)];
                let solution = with_options(session, &options, || direct.run(session, &tight()).0);
                let end = (solution.iterations, solution.status.name());
                assert_eq!(end, (0, "DIVERGED_ITS"), "{name}, {method}");
                assert_eq!(solution.residuals.len(), 1);
            }
        }
        let direct = Direct::example("poisson_2x2");
        for number in ["-1", "-5"] {
            let error = with_options(session, &[("ksp_max_it", number)], || {
                let problem = direct.scene.substructures(&|_| true).expect("subdomains");
                let made = fetifeti::FetiFeti::new(session, problem, tight());
                made.map(|_| ()).expect_err("bad input").to_string()
            });
            let expected = format!("option -fetifeti_ksp_max_it is {number}, expected");
            assert!(error.contains(&expected), "{error}");
        }
    });
}

#[test]
fn errors_fall_with_the_second_power_of_h() {
    with_session(|session| {
        // u is prescribed and nonzero on all sides, and the coefficient varies inside bodies: −div((1 + x) grad u) for
        // u = sin(2x) e^y is (1 + x)(4 − 1) u − 2 cos(2x) e^y.
        let norms = |n: usize| {
            let text = format!(
                "exact = \"sin(2*x)*exp(y)\"\n\
                 [grid]\nbodies = [3, 3]\nsubdomains = [2, 1]\nelements_per_subdomain = [{n}, {}]\n\
                 rho = \"1 + x\"\n\
                 dirichlet = {{ left = \"sin(2*x)*exp(y)\", right = \"sin(2*x)*exp(y)\", \
                 bottom = \"sin(2*x)*exp(y)\", top = \"sin(2*x)*exp(y)\" }}\n\
                 load = {{ value = \"3*(1 + x)*sin(2*x)*exp(y) - 2*cos(2*x)*exp(y)\", quadrature = \"gauss\" }}\n",
                2 * n
            );
            let scene = Scene::parse("exact.toml", &text).unwrap();
            let direct = Direct::new(scene);
            let (solution, distance) = direct.run(session, &MethodSettings::default().rtol(1e-10));
            assert!(solution.converged() && distance < 1e-8, "{distance:.1e}");
            let mut squares = [0.0; 3];
            for (s, u) in solution.u.iter().enumerate() {
                let mesh = direct.scene.subdomain_mesh(s).unwrap();
                let part = direct
                    .scene
                    .error_squares(&mesh, &mesh.nodal(u))
                    .expect("the solution is known");
                squares.iter_mut().zip(part).for_each(|(a, b)| *a += b);
            }
            squares.map(f64::sqrt)
        };
        let errors = [2, 4, 8].map(norms);
        println!("L2, H1, energy: {errors:?}");
        for pair in errors.windows(2) {
            let orders: Vec<f64> = (0..3).map(|k| (pair[0][k] / pair[1][k]).log2()).collect();
            assert!((orders[0] - 2.0).abs() < 0.05, "{orders:?}");
            assert!(
                (orders[1] - 1.0).abs() < 0.05 && (orders[2] - 1.0).abs() < 0.05,
                "{orders:?}"
            );
        }
    });
}

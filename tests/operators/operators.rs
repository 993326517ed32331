//! The operators compared with dense algebra, and the identities of the theory on random scenes.

use super::dense;
use crate::checks::identities;
use crate::direct;
use crate::testing::with_session;
use dense::{columns, defect, jump_of, pseudo_inverse, spectrum, Reference};
use direct::{tight, Direct};
use faer::Mat;
use fetifeti::settings::{MethodSettings, PcType, ProjectorKind};
use fetifeti::{FetiFeti, Problem, Subdomain};
use petsc::Session;
use scene::{Faces, Scene};

fn scene(text: &str) -> Scene {
    Scene::parse("s.toml", text).expect("a valid scene")
}

/// Small scenes, one for every feature.
fn scenes() -> Vec<(&'static str, Scene)> {
    let grid = |bodies: &str, subdomains: usize, elements: usize, more: &str| {
        scene(&format!(
            "[grid]\nbodies = {bodies}\nsubdomains = {subdomains}\n\
             elements_per_subdomain = {elements}\nload = \"1 + x\"\n{more}\n"
        ))
    };
    let all = "dirichlet = \"all\"\n";
    vec![
        ("(2,2,2) I", Scene::lee(2, 2, 2, Faces::Whole).expect("valid")),
        ("(2,2,2) II", Scene::lee(2, 2, 2, Faces::MiddleThird).expect("valid")),
        ("one floats", grid("3", 2, 2, all)),
        ("one floats, jumps", grid("3", 2, 2, &format!("{all}rho = {{ checkerboard = [1, 100], by = \"body\" }}"))),
        ("jumps inside bodies", grid("2", 2, 3, &format!("{all}rho = \"1 + 20*si + 3*sj + x\""))),
        ("all but two float", grid("[2, 3]", 2, 2, "dirichlet = [\"bottom\"]\nrho = \"10^bj\"")),
        ("one-level FETI", grid("3", 1, 3, all)),
        ("FETI-DP", grid("1", 3, 2, "dirichlet = [\"left\"]")),
        ("slits", scene(
            "[grid]\nbodies = 3\nsubdomains = 2\nelements_per_subdomain = 2\nload = 1\ndirichlet = \"all\"\n\
             rho = { checkerboard = [1, 10], by = \"body\" }\n[interface]\ndefault = \"free\"\n\
             [[tie]]\nbodies = \"all\"\nrange = [0.2, 0.8]\n",
        )),
    ]
}

fn set_up(session: &Session, scene: &Scene, settings: MethodSettings) -> FetiFeti {
    let problem = scene.substructures(&|_| true).expect("assembled");
    FetiFeti::new(session, problem, settings).expect("set up")
}

#[test]
fn rows_of_b_tie_what_they_should() {
    with_session(|session| {
        for (name, scene) in scenes() {
            let solver = set_up(session, &scene, MethodSettings::default());
            let (b, bd) = jump_of(&solver);
            let problem = solver.problem();
            let dofs: Vec<u64> = problem.local.iter().flat_map(|s| s.dofs.clone()).collect();
            let n_local = solver.facts().multipliers_local;
            let mut pairs = std::collections::BTreeSet::new();
            let mut ties = Vec::new();
            for i in 0..b.nrows() {
                let entries: Vec<(usize, f64)> = (0..b.ncols())
                    .map(|c| (c, b[(i, c)]))
                    .filter(|e| e.1 != 0.0)
                    .collect();
                if i < n_local {
                    // +1 and −1 on two copies of one body dof.
                    assert_eq!(
                        entries.iter().map(|e| e.1).collect::<Vec<_>>(),
                        [1.0, -1.0],
                        "{name}"
                    );
                    assert_eq!(dofs[entries[0].0], dofs[entries[1].0], "{name}");
                    assert!(pairs.insert((entries[0].0, entries[1].0)), "{name}: twice");
                } else {
                    // Averages of the copies of two dofs; zero where the row does not hold.
                    let mut sums = std::collections::BTreeMap::new();
                    entries
                        .iter()
                        .for_each(|(c, v)| *sums.entry(dofs[*c]).or_insert(0.0) += v);
                    ties.push(sums);
                }
            }
            let holds: Vec<_> = problem.rows.iter().filter(|r| r.holds).collect();
            assert_eq!(
                ties.iter().filter(|t| !t.is_empty()).count(),
                holds.len(),
                "{name}"
            );
            assert_eq!(ties.len(), problem.rows.len(), "{name}");
            for row in holds {
                let found = ties.iter().filter(|t| {
                    t.len() == row.terms.len()
                        && row
                            .terms
                            .iter()
                            .all(|(d, v)| t.get(d).is_some_and(|w| (v - w).abs() < 1e-14))
                });
                assert_eq!(found.count(), 1, "{name}");
            }
            // B B_Dᵀ B = B, and B_D agrees with its general definition.
            assert!(defect(&(&b * bd.transpose() * &b), &b) < 1e-13, "{name}");
            let reference = Reference::new(problem, b);
            assert!(
                defect(&bd, &reference.bd) < 1e-12,
                "{name}: {:.1e}",
                defect(&bd, &reference.bd)
            );
        }
    });
}

#[test]
fn f_m_and_p_equal_their_dense_definitions() {
    with_session(|session| {
        for (name, scene) in scenes() {
            for pc in [PcType::Lumped, PcType::Dirichlet, PcType::CoarseCorrected] {
                for projector in [
                    ProjectorKind::Identity,
                    ProjectorKind::Diagonal,
                    ProjectorKind::Preconditioner,
                ] {
                    let what = format!("{name}, {pc:?}, {projector:?}");
                    let settings = MethodSettings::default().pc_type(pc).projector(projector);
                    let mut solver = set_up(session, &scene, settings);
                    let dual = solver.dual();
                    let reference = Reference::new(solver.problem(), jump_of(&solver).0);
                    let m = columns(&solver, |x, y| dual.m(x, y).unwrap());
                    let f = columns(&solver, |x, y| dual.f(x, y).unwrap());
                    let p = columns(&solver, |x, y| {
                        y.copy_from(x).and_then(|()| dual.p(y)).unwrap()
                    });
                    let pt = columns(&solver, |x, y| {
                        y.copy_from(x).and_then(|()| dual.p_transpose(y)).unwrap()
                    });

                    let expected_m = match pc {
                        PcType::Lumped => &reference.m_lumped,
                        _ if dual.preconditioner.lifting().is_some() => &reference.m_corrected,
                        _ => &reference.m_dirichlet,
                    };
                    assert!(
                        defect(&m, expected_m) < 1e-11,
                        "{what}: M off by {:.1e}",
                        defect(&m, expected_m)
                    );
                    assert!(
                        defect(&m.transpose().to_owned(), &m) < 1e-12,
                        "{what}: M not symmetric"
                    );
                    assert!(
                        defect(&f.transpose().to_owned(), &f) < 1e-12,
                        "{what}: F not symmetric"
                    );

                    // P is the projector along Q G onto ker Gᵀ.
                    let g = &reference.g;
                    assert_eq!(g.ncols(), solver.facts().kernel_dimension, "{what}");
                    let identity = Mat::<f64>::identity(p.nrows(), p.ncols());
                    let qg = match projector {
                        ProjectorKind::Diagonal => {
                            let q = superlumped(solver.problem(), &reference.bd);
                            Mat::from_fn(g.nrows(), g.ncols(), |i, j| q[i] * g[(i, j)])
                        }
                        ProjectorKind::Preconditioner => &m * g,
                        _ => g.clone(),
                    };
                    let expected = if g.ncols() == 0 {
                        identity
                    } else {
                        let gtqg = g.transpose() * &qg;
                        &identity - &qg * pseudo_inverse(&gtqg) * g.transpose()
                    };
                    assert!(
                        defect(&p, &expected) < 1e-11,
                        "{what}: P off by {:.1e}",
                        defect(&p, &expected)
                    );
                    assert!(defect(&(&p * &p), &p) < 1e-12, "{what}: P P");
                    assert!(defect(&pt, &p.transpose().to_owned()) < 1e-12, "{what}: Pᵀ");
                    if g.ncols() > 0 {
                        let zero = (g.transpose() * &p).norm_max() / g.norm_max();
                        assert!(zero < 1e-12, "{what}: Gᵀ P = {zero:.1e}");
                    }

                    // Pᵀ F P does not depend on the generalised inverse.
                    let (ours, dense) =
                        (p.transpose() * &f * &p, p.transpose() * &reference.f * &p);
                    assert!(
                        defect(&ours, &dense) < 1e-10,
                        "{what}: F off by {:.1e}",
                        defect(&ours, &dense)
                    );

                    let values = spectrum(&dense, &(&p * expected_m * p.transpose()));
                    let (low, high) = (values[0], values[values.len() - 1]);
                    drop(dual);
                    let exact = solver
                        .spectrum()
                        .expect("eigenvalues")
                        .expect("multipliers");
                    // K_ΓΓ ≥ S gives the bound for M_L, too.
                    assert!(low > 1.0 - 1e-8, "{what}: {low}");
                    let wrong = (exact.lambda_max / high - 1.0)
                        .abs()
                        .max((exact.lambda_min / low - 1.0).abs());
                    assert!(wrong < 1e-6, "{what}: {exact:?} for {low} {high}");
                    // The Lanczos estimate of a solve lies inside the exact spectrum.
                    let solution = solver.solve().expect("solved");
                    let estimate = solution.estimate.expect("CG estimates");
                    assert!(
                        estimate.lambda_min > low * (1.0 - 1e-8),
                        "{what}: {estimate:?}"
                    );
                    assert!(
                        estimate.lambda_max < high * (1.0 + 1e-8),
                        "{what}: {estimate:?}"
                    );
                }
            }
        }
    });
}

/// The diagonal of B_D diag(K) B_Dᵀ.
fn superlumped(problem: &Problem, bd: &Mat<f64>) -> Vec<f64> {
    let entry = |s: &Subdomain, i: usize| {
        let (columns, values) = s.k.row(i);
        let mut row = columns.iter().zip(values);
        row.find(|(&j, _)| j as usize == i).map_or(0.0, |e| *e.1)
    };
    let all = problem.local.iter();
    let k: Vec<f64> = all
        .flat_map(|s| (0..s.k.n()).map(move |i| entry(s, i)))
        .collect();
    (0..bd.nrows())
        .map(|i| (0..k.len()).map(|c| bd[(i, c)].powi(2) * k[c]).sum())
        .collect()
}

/// Pseudo-random numbers in [0, 1), the same in every run.
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn below(&mut self, n: usize) -> usize {
        (self.roll() * n as f64) as usize
    }
}

#[test]
fn identities_hold_on_random_scenes() {
    with_session(|session| {
        let mut dice = Dice(2010);
        for round in 0..40 {
            let bodies = [1 + dice.below(4), 1 + dice.below(4)];
            let subdomains = [1 + dice.below(3), 1 + dice.below(3)];
            let elements = [1 + dice.below(4), 1 + dice.below(4)];
            let table: Vec<String> = (0..bodies[1])
                .map(|_| {
                    let row: Vec<String> = (0..bodies[0])
                        .map(|_| format!("{:e}", 10f64.powf(6.0 * dice.roll() - 3.0)))
                        .collect();
                    format!("[{}]", row.join(", "))
                })
                .collect();
            let held = [
                "[\"left\"]",
                "[\"top\", \"right\"]",
                "\"all\"",
                "{ bottom = \"x\" }",
            ][dice.below(4)];
            let load = ["1", "\"x - y\"", "\"sin(9*x)*y\""][dice.below(3)];
            let tie = [
                "",
                "[interface]\ndefault = \"free\"\n[[tie]]\nbodies = \"all\"\nrange = [0, 1]\n",
            ][dice.below(2)];
            let tie = if bodies == [1, 1] { "" } else { tie };
            let text = format!(
                "[grid]\nbodies = {bodies:?}\nsubdomains = {subdomains:?}\nelements_per_subdomain = {elements:?}\n\
                 rho = {{ per_body = [{}] }}\nload = {load}\ndirichlet = {held}\n{tie}",
                table.join(", ")
            );
            let direct = Direct::new(scene(&text));
            for pc in [PcType::Dirichlet, PcType::CoarseCorrected] {
                let mut solver = direct.solver(session, &tight().pc_type(pc));
                let what = format!("round {round}, {pc:?}:\n{text}");
                // One body without cuts has no operators.
                if bodies != [1, 1] || subdomains != [1, 1] {
                    identities(&solver, 1e-10, &what);
                }
                if let Some(s) = solver.spectrum().expect("eigenvalues") {
                    assert!(s.lambda_min >= 1.0 - 1e-8, "{s:?} in {what}");
                    assert!(s.kappa() < 60.0, "{s:?} in {what}");
                }
                let solution = solver.solve().expect("solved");
                assert!(solution.converged(), "{} in {what}", solution.status);
                let distance = direct.distance(&solution.u);
                assert!(distance < 1e-8, "{distance:.1e} in {what}");
            }
        }
    });
}

#[test]
fn jumps_by_body_do_not_hurt() {
    with_session(|session| {
        // 4 × 4 bodies of 4 × 4 subdomains of 4 × 4 elements, ρ alternately 1 and 10⁴.
        let scene = Scene::load("examples/scenes/jump_checkerboard.toml").expect("valid");
        let kappa = |projector, pc_type| {
            let settings = MethodSettings::default()
                .projector(projector)
                .pc_type(pc_type);
            let mut solver = set_up(session, &scene, settings);
            assert_eq!(solver.facts().floating_bodies, 4);
            let s = solver
                .spectrum()
                .expect("eigenvalues")
                .expect("multipliers");
            assert!(s.lambda_min > 1.0 - 1e-8, "{s:?}");
            s.kappa()
        };
        let ours = kappa(ProjectorKind::Auto, None);
        println!("auto: {ours}");
        assert!(ours <= 6.0, "{ours}");
        let corrected = kappa(ProjectorKind::Auto, Some(PcType::CoarseCorrected));
        assert!((corrected / ours - 1.0).abs() < 1e-6);
        // The benefit of Q = M⁻¹: κ of the same problem with Q = I and M_D, as measured with dense algebra.
        let plain = kappa(ProjectorKind::Identity, Some(PcType::Dirichlet));
        assert!((plain / 4343.0 - 1.0).abs() < 5e-3, "{plain}");
        let weighted = kappa(ProjectorKind::Preconditioner, Some(PcType::Dirichlet));
        println!("{plain} {weighted}");
        assert!((weighted / 24.0 - 1.0).abs() < 0.05, "{weighted}");
    });
}

//! The exact spectrum of F + C beside dense algebra, where rows with springs depend on each other.

use super::dense::{columns, spectrum};
use crate::testing::with_session;
use fetifeti::problem::Law;
use fetifeti::settings::{Adaptive, MethodSettings, PcType};
use fetifeti::solution::RowState;
use fetifeti::{FetiFeti, Problem, Solution};
use scene::Scene;
use std::collections::BTreeMap;

/// Two bricks side by side on a third one: rows around the point where they meet depend on each other.
fn bricks(law: &str) -> String {
    let brick = |name: &str, at: [usize; 2], width: usize, more: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\norigin = {at:?}\nsize = [{width}, 1]\nelements = [{}, 2]\n\
             subdomains = [{width}, 1]\nyoung = 1.0\npoisson = 0.2\nload = [0, -0.01]\n{more}\n",
            2 * width
        )
    };
    [
        "dimension = 2\nphysics = \"elasticity\"\n",
        &brick("below", [0, 0], 2, "dirichlet = { bottom = 0 }"),
        &brick("left", [0, 1], 1, "pressure = { left = 0.02 }"),
        &brick("right", [1, 1], 1, "dirichlet = { right = { x = 0 } }"),
        "[[contact]]\nbodies = \"all\"\nfriction = 0.4\n",
        law,
    ]
    .concat()
}

#[test]
fn the_exact_spectrum_with_springs_is_that_of_dense_algebra() {
    with_session(|session| {
        let laws = [
            "",
            "stiffness = 1.0",
            "stiffness = 1.0\nstick_stiffness = 1.0",
            "stiffness = 0.01\nstick_stiffness = 2.0",
        ];
        let each = |law| [PcType::Dirichlet, PcType::CoarseCorrected].map(|pc| (law, pc));
        for (law, pc) in laws.into_iter().flat_map(each) {
            let scene = Scene::parse("s.toml", &bricks(law)).expect("a valid scene");
            let problem = scene.substructures(&|_| true).expect("a problem");
            let settings = MethodSettings::default()
                .pc_type(pc)
                .adaptive(Adaptive::Off);
            let mut solver = FetiFeti::new(session, problem, settings).expect("set up");
            let a = solver.ksp().operator().expect("an operator");
            let a = columns(&solver, |x, y| a.mult(x, y).expect("a product"));
            let c = columns(&solver, |x, y| {
                let (dual, z) = (solver.dual(), x.duplicate().expect("a vector"));
                z.copy_from(x).expect("a copy");
                dual.p_transpose(&z).expect("a projection");
                dual.m(&z, y).expect("a product");
                dual.p(y).expect("a projection");
            });
            let dense = spectrum(&a, &c);
            let (least, largest) = (dense[0], dense[dense.len() - 1]);
            let exact = solver
                .spectrum()
                .expect("eigenvalues")
                .expect("multipliers");
            let what = format!("{law:?}, {pc:?}: {exact:?}, dense {least} to {largest}");
            println!("{what}");
            assert!((exact.lambda_min / least - 1.0).abs() < 1e-6, "{what}");
            assert!((exact.lambda_max / largest - 1.0).abs() < 1e-6, "{what}");
            assert!(least > 1.0 - 1e-8, "{what}");
        }
    });
}

/// A block that is pressed on the ground and pushed, in space.
const PUSH: &str = "dimension = 3\nphysics = \"elasticity\"\n\
    [[body]]\nname = \"block\"\norigin = [0, 0, 0]\nsize = [1.0, 1.0, 1.0]\nelements = [4, 4, 4]\n\
    subdomains = [2, 2, 2]\nyoung = 1.0\npoisson = 0.3\ntraction = { top = [0.015, -0.1, 0.01] }\n\
    dirichlet = { left = { x = 0 }, back = { z = 0 } }\n\
    [[obstacle]]\nbody = \"block\"\nside = \"bottom\"\n\
    plane = { point = [0.0, 0.0, 0.0], normal = [0.0, 1.0, 0.0] }\nfriction = 0.25\n";

/// The rows of a solution as a problem of their own: at nodes that slip the row along the slip is off, and the row
/// across it is a spring of compliance |w|/g.
fn turned(problem: &Problem, solution: &Solution) -> Problem {
    let mut out = problem.clone();
    let mut solved = vec![None; out.rows.len()];
    let (mut normal, mut tangential) = (solution.rows().iter(), solution.tangential_rows().iter());
    for (row, solved) in out.rows.iter_mut().zip(&mut solved) {
        *solved = match row.law {
            Law::Friction => tangential.next(),
            _ => normal.next(),
        };
        let state = solved.expect("a row of the solution").state;
        row.holds = matches!(state, RowState::Holds | RowState::Tied | RowState::Sticks);
    }
    for node in &problem.friction {
        // A wall holds some nodes along one tangent.
        let [a, b] = node.tangential[..] else {
            continue;
        };
        let [of_a, of_b] = [a, b].map(|r| solved[r].expect("a row of the solution"));
        if of_a.state != RowState::Slips {
            continue;
        }
        let g = of_a.multiplier.hypot(of_b.multiplier);
        let (c, s) = (of_a.multiplier / g, of_b.multiplier / g);
        let sum = |[p, q]: [f64; 2]| -> Vec<(u64, f64)> {
            let mut terms = BTreeMap::new();
            for (row, by) in [(a, p), (b, q)] {
                for &(dof, v) in &problem.rows[row].terms {
                    *terms.entry(dof).or_insert(0.0) += by * v;
                }
            }
            terms.into_iter().collect()
        };
        (out.rows[a].terms, out.rows[b].terms) = (sum([c, s]), sum([-s, c]));
        out.rows[b].holds = true;
        out.rows[b].compliance = of_a.gap.hypot(of_b.gap) / g;
    }
    out
}

#[test]
fn a_step_with_turned_rows_reports_the_spectrum_of_its_rows() {
    with_session(|session| {
        let scene = Scene::parse("s.toml", PUSH).expect("a valid scene");
        let problem = scene.substructures(&|_| true).expect("a problem");
        let mut settings = MethodSettings::default().adaptive(Adaptive::Off).rtol(1e-9);
        settings.spectrum = true;
        let mut solver = FetiFeti::new(session, problem.clone(), settings.clone()).expect("set up");
        let solution = solver.solve().expect("solved");
        assert!(solution.converged(), "{}", solution.status);
        let slipping = solution
            .tangential_rows()
            .iter()
            .filter(|r| r.state == RowState::Slips);
        assert!(slipping.count() > 10);
        let last = solution
            .steps
            .last()
            .and_then(|s| s.exact)
            .expect("asked for");
        let mut fresh =
            FetiFeti::new(session, turned(&problem, &solution), settings).expect("set up");
        let exact = fresh.spectrum().expect("eigenvalues").expect("multipliers");
        let what = format!("{last:?}, rows turned by hand {exact:?}");
        println!("{what}");
        assert!(
            (last.lambda_min / exact.lambda_min - 1.0).abs() < 1e-5,
            "{what}"
        );
        assert!(
            (last.lambda_max / exact.lambda_max - 1.0).abs() < 1e-5,
            "{what}"
        );
    });
}

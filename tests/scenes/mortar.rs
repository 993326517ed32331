//! Sides whose nodes do not match: patch tests, the side with the multipliers, mistakes.

use crate::support::scene_message::message;
use crate::support::session::with_session;
use fetifeti::settings::MethodSettings;
use fetifeti::{FetiFeti, Solution};
use scene::Scene;

/// Two blocks, one on the other, under a pressure of 1 on all sides: −1 is the stress everywhere, also on an inclined
/// common face. `more` are the keys of the joint.
fn blocks(dim: usize, order: usize, slope: f64, joint: &str) -> String {
    blocks_of("q1", dim, order, slope, joint)
}

/// As [`blocks`], of these elements.
fn blocks_of(element: &str, dim: usize, order: usize, slope: f64, joint: &str) -> String {
    let map = match dim {
        2 => format!("shape = {{ y = \"y + {slope}*x*y*(2 - y)\" }}"),
        _ => format!("shape = {{ y = \"y + {slope}*(x + 0.5*z)*y*(2 - y)\" }}"),
    };
    let list = |v: [usize; 3]| format!("{:?}", &v[..dim]);
    let (held, pressed, back) = match dim {
        2 => ("", "", ""),
        _ => (", back = { z = 0 }", ", front = 1", ", 0"),
    };
    let body = |name: &str, y: usize, elements: [usize; 3], sides: &str, pressed: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\norigin = [0, {y}{back}]\nsize = {}\n{map}\nelements = {}\n\
             subdomains = {}\nyoung = 10\npoisson = 0.3\ndirichlet = {{ left = {{ x = 0 }}{held}{sides} }}\n\
             pressure = {{ right = 1{pressed} }}\n",
            list([2, 1, 1]),
            list(elements),
            list([2, 1, 1])
        )
    };
    let low = body("low", 0, [4, 2, 3], ", bottom = { y = 0 }", pressed);
    let up = body("up", 1, [6, 3, 2], "", &format!(", top = 1{pressed}"));
    format!(
        "dimension = {dim}\nphysics = \"elasticity\"\nelement = \"{element}\"\norder = {order}\n{low}{up}{joint}"
    )
}

/// The scene's solution, to rounding, and its scene.
fn solve(text: &str) -> (Scene, Solution) {
    let scene = Scene::parse("s.toml", text).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let problem = scene.substructures(&|_| true).expect("substructures");
    let solution = with_session(move |session| {
        let settings = MethodSettings::default().rtol(1e-12);
        let mut solver = FetiFeti::new(session, problem, settings).expect("set up");
        let solution = solver.solve().expect("a solution");
        assert!(solution.converged(), "{:?}", solution.status);
        solution
    });
    (scene, solution)
}

#[test]
fn a_constant_pressure_passes() {
    for dim in [2, 3] {
        for order in [1, 2] {
            for (element, slope) in [("q1", 0.0), ("q1", 0.1), ("p1", 0.0), ("p1", 0.1)] {
                for multipliers in ["low", "up"] {
                    let joint = format!(
                        "[[contact]]\nbodies = [\"low\", \"up\"]\n\
                         multipliers = \"{multipliers}\"\n"
                    );
                    let what =
                        format!("{dim}D, {element}, order {order}, slope {slope}, {multipliers}");
                    let (scene, solution) = solve(&blocks_of(element, dim, order, slope, &joint));
                    assert_eq!(
                        scene.interfaces[0].shared.len(),
                        scene.mortar_rows().count(),
                        "{what}"
                    );
                    let rows = solution.rows();
                    let pressures = rows.iter().filter_map(|r| r.pressure());
                    let worst = pressures.map(|p| (p - 1.0).abs()).fold(0.0, f64::max);
                    assert!(worst < 1e-10, "{what}: {worst:e}");
                    assert!(rows.len() > 4 && rows.iter().all(|r| r.holds()), "{what}");
                }
            }
        }
    }
}

/// A tie transmits any constant stress, and nodes whose values are given carry no multipliers.
#[test]
fn ties_leave_no_trace_in_a_constant_stress() {
    for dim in [2, 3] {
        for slope in [0.0, 0.1] {
            let (scene, solution) = solve(&blocks(dim, 1, slope, ""));
            assert!(scene.mortar_rows().all(|r| !r.law.is_inequality()));
            let rows: usize = solution.rows().len();
            let nodes = scene.interfaces[0].shared.len();
            assert!(rows < dim * nodes, "{rows} rows at {nodes} nodes");
            // u = −c x with c = (1 − 2ν)/E of a pressure of 1 on all sides; in plane strain c = (1 + ν)(1 − 2ν)/E.
            let c = 0.4 / 10.0 * if dim == 2 { 1.3 } else { 1.0 };
            let problem = scene.substructures(&|_| true).expect("substructures");
            let mut worst = 0.0_f64;
            for (sub, u) in problem.local.iter().zip(&solution.u) {
                let x = sub.coordinates.as_ref().expect("coordinates");
                for ((&dof, x), u) in sub.dofs.iter().zip(x).zip(u) {
                    let body = scene.body_of(sub.index).0;
                    let component = ((dof - scene.bodies[body].first_dof) as usize) % dim;
                    worst = worst.max((u + c * x[component]).abs());
                }
            }
            assert!(worst < 1e-11, "{dim}D, slope {slope}: {worst:e}");
        }
    }
}

/// Half of the upper block reaches beyond the lower one.
#[test]
fn a_side_may_reach_beyond_the_other() {
    let text = "physics = \"elasticity\"\n\
        [[body]]\nname = \"low\"\nsize = [2, 1]\nelements = [7, 3]\nyoung = 10\npoisson = 0\n\
        dirichlet = { left = { x = 0 }, bottom = { y = 0 } }\n\
        [[body]]\nname = \"up\"\norigin = [0, 1]\nsize = [3, 1]\nelements = [9, 3]\nyoung = 1e6\npoisson = 0\n\
        dirichlet = { left = { x = 0 }, top = { y = -0.01 } }\n\
        [[contact]]\nbodies = [\"up\", \"low\"]\n";
    let (_, solution) = solve(text);
    let rows = solution.rows();
    let force: f64 = rows.iter().map(|r| r.multiplier).sum();
    let area: f64 = rows.iter().map(|r| r.label.area).sum();
    assert!((area - 2.0).abs() < 1e-12, "{area}");
    // A rigid punch: a stress of 10 · 0.01 on a length of 2, up to what the soft block bends it.
    assert!((force - 0.2).abs() < 1e-5, "{force}");
    assert!(rows.iter().all(|r| r.label.point[0] < 2.5));
}

#[test]
fn mistakes_get_a_sentence() {
    let text = |joint: &str| blocks(2, 1, 0.0, joint);
    let wrong = text("[[contact]]\nbodies = [\"low\", \"up\"]\nmultipliers = \"middle\"\n");
    let told = message(&wrong);
    assert!(told.contains("`low` or `up`"), "{told}");
    let all = text("[[contact]]\nbodies = \"all\"\nmultipliers = \"low\"\n");
    assert!(message(&all).contains("where two names were expected"));
    let apart = text("[[contact]]\nbodies = [\"low\", \"up\"]\nsides = [\"bottom\", \"top\"]\n");
    let told = message(&apart);
    assert!(told.contains("do not face each other"), "{told}");
}

/// Two blocks side by side, one with a fine common face and one with a coarse one, and given values at their far sides.
#[test]
fn a_joint_may_have_thousands_of_rows() {
    for multipliers in ["a", "b"] {
        let wall = |name: &str, x: usize, n: usize, given: &str| {
            format!(
                "[[body]]\nname = \"{name}\"\norigin = [{x}, 0, 0]\nsize = 1\nelements = [2, {n}, {n}]\n\
                 subdomains = [1, 3, 3]\ndirichlet = {{ {given} }}\n"
            )
        };
        let text = format!(
            "dimension = 3\n{}{}[[tie]]\nbodies = [\"a\", \"b\"]\nmultipliers = \"{multipliers}\"\n",
            wall("a", 0, 54, "left = 0"),
            wall("b", 1, 42, "right = 1"),
        );
        let (scene, solution) = solve(&text);
        assert!(
            scene.mortar_rows().count() > 1800,
            "{}",
            scene.mortar_rows().count()
        );
        let problem = scene.substructures(&|_| true).expect("substructures");
        for (sub, u) in problem.local.iter().zip(&solution.u) {
            let x = sub.coordinates.as_ref().expect("coordinates");
            for (x, u) in x.iter().zip(u) {
                assert!((u - x[0] / 2.0).abs() < 1e-9, "{multipliers}: {x:?} {u}");
            }
        }
    }
}

/// Four plates that meet at a point, all with different meshes: linear displacements pass, and no row is too much.
#[test]
fn four_tied_plates_may_meet_at_a_point() {
    let plate = |name: &str, x: usize, y: usize, n: usize| {
        format!(
            "[[body]]\nname = \"{name}\"\norigin = [{x}, {y}]\nsize = 1\nelements = {n}\nyoung = 10\n\
             poisson = 0.3\n{}{}",
            if x == 0 { "dirichlet = { left = { x = 0 }" } else { "dirichlet = { right = { x = 0.02 }" },
            if y == 0 { ", bottom = { y = 0 } }\n" } else { " }\n" }
        )
    };
    let text = format!(
        "physics = \"elasticity\"\n{}{}{}{}",
        plate("a", 0, 0, 4),
        plate("b", 1, 0, 5),
        plate("c", 0, 1, 6),
        plate("d", 1, 1, 7)
    );
    let (scene, solution) = solve(&text);
    let elsewhere = |n: &&String| n.starts_with("Another tie holds nodes of");
    let (known, more) = (
        scene.notes.iter().filter(elsewhere).count(),
        scene.notes.len(),
    );
    // Three nodes of common faces have given values, too.
    assert_eq!((known, more), (4, 7), "{:?}", scene.notes);
    let problem = scene.substructures(&|_| true).expect("substructures");
    // u = (0.01 x, −ν/(1 − ν) 0.01 y) in plane strain.
    for (sub, u) in problem.local.iter().zip(&solution.u) {
        let x = sub.coordinates.as_ref().expect("coordinates");
        let body = scene.body_of(sub.index).0;
        for ((&dof, x), u) in sub.dofs.iter().zip(x).zip(u) {
            let exact = match (dof - scene.bodies[body].first_dof) % 2 {
                0 => 0.01 * x[0],
                _ => -0.3 / 0.7 * 0.01 * x[1],
            };
            assert!((u - exact).abs() < 1e-12, "{u}, not {exact}");
        }
    }
}

//! Bodies whose stiffness differs by many powers of ten.

use crate::support::session::with_session;
use fetifeti::settings::MethodSettings;
use fetifeti::{FetiFeti, Solution};
use scene::Scene;

fn solve(text: &str) -> Solution {
    let scene = Scene::parse("scene.toml", text).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let problem = scene.substructures(&|_| true).expect("substructures");
    let solution = with_session(move |session| {
        let settings = MethodSettings::default().rtol(1e-8);
        let mut solver = FetiFeti::new(session, problem, settings).expect("set up");
        solver.solve().expect("a solution")
    });
    assert!(solution.converged(), "{:?}\n{text}", solution.status);
    solution
}

/// A stiff plate that only a soft one holds. As it is rigid beside it, its mesh plays no part.
#[test]
fn a_stiff_body_floats_beside_a_soft_one() {
    let plates = |stiff: f64, n: usize| {
        format!(
            "physics = \"elasticity\"\n[[body]]\nname = \"soft\"\nsize = [1, 1]\nelements = [4, 4]\n\
             subdomains = [2, 2]\nyoung = 1\ndirichlet = [\"left\"]\n\
             [[body]]\nname = \"stiff\"\norigin = [1, 0]\nsize = [1, 1]\nelements = [{n}, {n}]\n\
             subdomains = [2, 2]\nyoung = {stiff:e}\ntraction = {{ right = [0.1, 0.05] }}\n"
        )
    };
    // With nodes that match, and with others.
    let energy = |stiff: f64, n: usize| solve(&plates(stiff, n)).energy;
    let rigid = energy(1e12, 4);
    // What a plate of 10⁶ strains is a part of 10⁻⁶.
    let strained = energy(1e6, 4);
    assert!((strained / rigid - 1.0).abs() < 1e-6, "{strained} {rigid}");
    assert!(strained != rigid);
    for other in [energy(1e12, 6), energy(1e10, 6)] {
        assert!((other / rigid - 1.0).abs() < 1e-8, "{other} {rigid}");
    }
}

/// A soft block that floats on a stiff plate of another mesh, tied or in contact, with multipliers on the side of
/// `multipliers`.
fn block_on_plate(stiff: f64, joint: &str, multipliers: &str) -> String {
    let held = match joint {
        "tie" => "",
        _ => "dirichlet = { left = { x = 0 }, back = { z = 0 } }\n",
    };
    let push = if joint == "tie" { 0.01 } else { 0.0 };
    format!(
        "dimension = 3\nphysics = \"elasticity\"\n[[body]]\nname = \"plate\"\nsize = [2, 1, 2]\n\
         elements = [6, 3, 6]\nsubdomains = [2, 1, 2]\nyoung = {stiff:e}\ndirichlet = [\"bottom\"]\n\
         {}{held}[[{joint}]]\nbodies = [\"plate\", \"block\"]\nmultipliers = \"{multipliers}\"\n",
        block(push)
    )
}

/// The block alone.
fn block(push: f64) -> String {
    format!(
        "[[body]]\nname = \"block\"\norigin = [0.3, 1, 0.4]\nsize = 1\nelements = [4, 4, 4]\nsubdomains = 2\n\
         young = 1\ntraction = {{ top = [{push}, \"-0.01*(1 + 0.2*(x - 0.5))\", 0] }}\n"
    )
}

/// The stiffer the plate, the less it gives: at last the block stands on something rigid, and takes no more iterations.
#[test]
fn a_soft_body_floats_on_a_stiff_one() {
    for joint in ["tie", "contact"] {
        let rigid = match joint {
            "tie" => "dirichlet = [\"bottom\"]\n",
            _ => "dirichlet = { bottom = { y = 0 }, left = { x = 0 }, back = { z = 0 } }\n",
        };
        let push = if joint == "tie" { 0.01 } else { 0.0 };
        let head = "dimension = 3\nphysics = \"elasticity\"\n";
        let rigid = solve(&format!("{head}{}{rigid}", block(push))).energy;
        for multipliers in ["block", "plate"] {
            let [some, most] =
                [1e4, 1e12].map(|stiff| solve(&block_on_plate(stiff, joint, multipliers)));
            println!(
                "{joint} {multipliers}: {} and {} iterations",
                some.iterations, most.iterations
            );
            assert!(most.iterations <= some.iterations + 1);
            // With multipliers of the plate, faces of the block touch it in the mean.
            let like = if multipliers == "block" { 1e-9 } else { 0.1 };
            let ratio = most.energy / rigid;
            assert!((ratio - 1.0).abs() < like, "{joint} {multipliers}: {ratio}");
        }
    }
}

/// One subdomain for each body: the interface moves by 10⁻¹² of what the inside moves, less than rounding of forces.
#[test]
fn gaps_below_rounding_are_closed() {
    let whole = |text: String| {
        let text = text.replace("subdomains = [2, 1, 2]", "subdomains = 1");
        text.replace("subdomains = 2", "subdomains = 1")
    };
    let solution = solve(&whole(block_on_plate(1e12, "contact", "block")));
    assert!(solution.steps.len() < 10, "{}", solution.steps.len());
}

//! `[steps] update = true` with obstacles that move, with `adjust`, with ties and elements of second order.

use super::renewal::{interface, near, probe, run};
use crate::support::checks::number;
use crate::support::mpi::Scratch;
use crate::support::surface_mesh::line;
use serde_json::Value;

/// Solves a scene that may name the mesh `MESH`.
fn solved(name: &str, scene: &str, mesh: &str, ranks: usize) -> Value {
    let scratch = Scratch::new(&format!("renewal-obstacle-{name}-{ranks}"));
    scratch.file("die.msh", mesh);
    let scene = scene.replace("MESH", &scratch.path("die.msh"));
    let (out, report) = run(name, &scene, ranks, &[]);
    assert_eq!(out.code, 0, "{name}: {}", out.all());
    report.expect("a report")
}

/// A stiff block whose left lower corner lies on top of a disc of radius 2: either the block is pushed by 1, or the
/// disc.
fn beside_a_disc(order: usize, block: f64, obstacle: &str) -> String {
    format!(
        "title = \"disc\"\nphysics = \"elasticity\"\norder = {order}\n[[body]]\nname = \"block\"\norigin = [0, 2]\n\
         size = [1, 1]\nelements = [4, 4]\nsubdomains = [2, 2]\nyoung = 1e7\npoisson = 0\n\
         dirichlet = {{ left = {{ x = {block} }}, right = {{ x = {block} }} }}\ntraction = {{ top = [0, -1] }}\n\
         [[obstacle]]\nbody = \"block\"\nside = \"bottom\"\n{obstacle}\n\
         [[probe]]\nname = \"corner\"\npoint = [0, 2]\n\
         [steps]\ncount = 8\ndirichlet = \"t\"\nupdate = true\n"
    )
}

#[test]
fn an_obstacle_that_moves_is_a_body_that_moves_the_other_way() {
    let disc = "cylinder = { centre = [0, 0], radius = 2 }";
    let surface = "surface = \"die\"\nmesh = \"MESH\"";
    // The upper part of the disc, from right to left.
    let at = |k: usize| {
        let turn = (30.0 + 3.0 * k as f64).to_radians();
        [2.0 * turn.cos(), 2.0 * turn.sin()]
    };
    let mesh = line("die", &(0..=40).map(at).collect::<Vec<_>>());
    for (order, obstacle) in [(1, disc), (1, surface), (2, disc), (2, surface)] {
        let name = format!("disc{order}");
        let pushed = solved(&name, &beside_a_disc(order, 1.0, obstacle), &mesh, 1);
        let moves = format!("{obstacle}\nmove = [-1, 0]\nramp = \"t\"");
        let moved = solved(&name, &beside_a_disc(order, 0.0, &moves), &mesh, 2);
        let (a, b) = (probe(&pushed, 0), probe(&moved, 0));
        near("u of the corner", a[0] - b[0], 1.0, 1e-9);
        near("fall", b[1], a[1], 1e-8);
        assert!(a[1] < -0.19, "{a:?}");
        for key in ["force", "max_pressure", "largest_sliding"] {
            near(
                key,
                interface(&moved, 0, key),
                interface(&pushed, 0, key),
                1e-6,
            );
        }
    }
}

/// A layer of second order on a base with another mesh, to which mortar rows tie it, and a die whose lower side is a
/// parabola around `x`. It moves by `way`, and rests in the last steps.
fn under_a_die(x: f64, way: [f64; 2], more: &str) -> (String, String) {
    let at = |k: usize| {
        let s = -0.5 + 0.05 * k as f64;
        [x + s, 1.001 + 0.2 * s * s]
    };
    let mesh = line("die", &(0..=20).map(at).collect::<Vec<_>>());
    let scene = format!(
        "title = \"layer\"\nphysics = \"elasticity\"\norder = 2\n[[body]]\nname = \"layer\"\nsize = [6, 1]\n\
         elements = [48, 8]\nsubdomains = [6, 1]\nyoung = 10\npoisson = 0.3\n\
         [[body]]\nname = \"base\"\norigin = [0, -1]\nsize = [6, 1]\nelements = [30, 5]\nsubdomains = [3, 1]\n\
         young = 20\npoisson = 0.3\ndirichlet = [\"bottom\"]\n\
         [[obstacle]]\nbody = \"layer\"\nside = \"top\"\nsurface = \"die\"\nmesh = \"MESH\"\nmove = {way:?}\n\
         ramp = \"min(t, 1)\"\n\
         [[probe]]\nname = \"there\"\nbody = \"layer\"\npoint = [4, 1]\n\
         [[probe]]\nname = \"here\"\nbody = \"layer\"\npoint = [1, 1]\n{more}"
    );
    (scene, mesh)
}

#[test]
fn a_die_that_moves_dents_the_layer_where_it_ends() {
    let steps = "[steps]\ntimes = [0.25, 0.5, 0.75, 1, 2, 3]\nupdate = true\n";
    let (scene, mesh) = under_a_die(1.0, [3.0, -0.02], steps);
    let [one, two, four] = [1, 2, 4].map(|ranks| solved("die", &scene, &mesh, ranks));
    // The same die that is there from the beginning.
    let (rests, its) = under_a_die(
        4.0,
        [0.0, -0.02],
        "[steps]\ntimes = [1, 2, 3]\nupdate = true\n",
    );
    let there = solved("there", &rests, &its, 1);
    // Interface 0 is the tie.
    for key in ["force", "max_pressure", "area"] {
        near(
            key,
            interface(&one, 1, key),
            interface(&there, 1, key),
            1e-2,
        );
        for other in [&two, &four] {
            near(key, interface(other, 1, key), interface(&one, 1, key), 1e-7);
        }
    }
    let depth = |r: &Value, k: usize| probe(r, k)[1];
    near("depth", depth(&one, 0), depth(&there, 0), 1e-2);
    assert!(depth(&one, 0) < -0.015 && depth(&one, 1).abs() < 2e-3);
    for other in [&two, &four] {
        for k in 0..6 {
            let active = |r: &Value| r["contact"]["load_steps"][k]["active"].clone();
            assert_eq!(active(other), active(&one));
        }
    }
    // Within a step the die slides by a quarter of its way, and by nothing in the last ones.
    let steps = one["contact"]["load_steps"].as_array().expect("steps");
    let slid: Vec<f64> = steps
        .iter()
        .map(|s| number(&s["largest_sliding"]))
        .collect();
    assert!(
        slid[1..4].iter().all(|s| (s - 0.75).abs() < 0.01),
        "{slid:?}"
    );
    assert!(slid[5] < 0.01, "{slid:?}");
    // Without renewal it dents the layer where it was.
    let (left, mesh) = under_a_die(1.0, [3.0, -0.02], "[steps]\ncount = 2\n");
    let left = solved("left", &left, &mesh, 1);
    assert!(depth(&left, 1) < -0.015 && depth(&left, 0).abs() < 2e-3);
}

/// A block at `y` on a layer that is pushed along it, with an obstacle below the layer.
fn on_a_layer(n: usize, y: f64, below: f64, contact: &str, obstacle: &str) -> String {
    format!(
        "title = \"layer\"\nphysics = \"elasticity\"\n[[body]]\nname = \"low\"\norigin = [0, {below}]\nsize = [6, 1]\n\
         elements = [24, 4]\nsubdomains = [6, 1]\nyoung = 1e5\npoisson = 0\ndirichlet = {{ left = {{ x = 0 }} }}\n\
         [[body]]\nname = \"high\"\norigin = [1, {y}]\nsize = [1, 1]\nelements = [{n}, 4]\nsubdomains = [2, 2]\n\
         young = 1000\npoisson = 0\ndirichlet = {{ left = {{ x = 2.15 }} }}\ntraction = {{ top = [0, -0.1] }}\n\
         [[contact]]\nbodies = [\"high\", \"low\"]\nsides = [\"bottom\", \"top\"]\n{contact}\n\
         [[obstacle]]\nbody = \"low\"\nside = \"bottom\"\nplane = {{ point = [0, 0], normal = [0, 1] }}\n{obstacle}\n\
         [[probe]]\nname = \"high\"\nbody = \"high\"\npoint = [1, {y}]\n\
         [[probe]]\nname = \"low\"\nbody = \"low\"\npoint = [3.5, {}]\n\
         [steps]\ncount = 4\ndirichlet = \"t\"\nupdate = true\n",
        below + 1.0
    )
}

#[test]
fn what_is_adjusted_stays_so_when_it_slides() {
    // With 4 elements nodes match at the start: then the sides are joined by mortar rows once they have slid.
    for n in [6, 4] {
        let solved = |scene: &str, ranks| solved("adjust", scene, "", ranks);
        let flush = solved(&on_a_layer(n, 1.0, 0.0, "", ""), 1);
        // Distances of 0.003 between the bodies and of 0.002 above the plane.
        let apart = |contact: &str, obstacle: &str| on_a_layer(n, 1.005, 0.002, contact, obstacle);
        let closed = solved(&apart("adjust = 0.01", "adjust = 0.01"), 2);
        let open = solved(&apart("", ""), 1);
        let fall = |r: &Value, k: usize| probe(r, k)[1];
        for k in [0, 1] {
            // Without `adjust` they fall by the distances.
            let way = [0.005, 0.002][k];
            assert!((fall(&closed, k) - fall(&flush, k)).abs() < 1e-9);
            assert!((fall(&open, k) - fall(&flush, k) + way).abs() < 1e-6);
        }
        for key in ["force", "max_pressure"] {
            near(
                key,
                interface(&closed, 0, key),
                interface(&flush, 0, key),
                1e-6,
            );
        }
        near("force", interface(&closed, 0, "force"), 0.1, 1e-8);
    }
}

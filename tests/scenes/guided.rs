//! Bodies of which every node has one component given, as layers of one element between smooth plates: the motions that
//! move no free node are none, and hold or drive nothing.

use crate::support::session::with_session;
use fetifeti::settings::MethodSettings;
use fetifeti::FetiFeti;
use scene::Scene;

/// Bars of unit length, of 2 subdomains each: `a` held at x = 0, `b` from x = 1 on, which a load of 1 by volume pushes
/// against `a`. `guided` are the sides with one component given.
fn bars(dim: usize, guided: &str) -> Scene {
    let (size, elements, load, subdomains) = match dim {
        2 => ("1, 0.2", "4, 1", "-1, 0", "2, 1"),
        _ => ("1, 0.2, 0.1", "4, 2, 1", "-1, 0, 0", "2, 1, 1"),
    };
    let bar = |name: &str, x: &str, more: &str| {
        let origin = format!("{x}{}", &", 0, 0"[..3 * dim - 3]);
        format!(
            "[[body]]\nname = \"{name}\"\norigin = [{origin}]\nsize = [{size}]\nelements = [{elements}]\n\
             subdomains = [{subdomains}]\nyoung = 100\npoisson = 0\n{more}\n"
        )
    };
    let text =
        format!(
        "dimension = {dim}\nphysics = \"elasticity\"\n{}{}[[contact]]\nbodies = [\"a\", \"b\"]\n",
        bar("a", "0", &format!("dirichlet = {{ left = 0, {guided} }}")),
        bar("b", "1", &format!("dirichlet = {{ {guided} }}\nload = [{load}]")),
    );
    Scene::parse("bars.toml", &text).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

#[test]
fn motions_that_move_no_free_node_do_not_count() {
    const Y: &str = "bottom = { y = 0 }, top = { y = 0 }";
    const Z: &str = "back = { z = 0 }, front = { z = 0 }";
    with_session(|session| {
        // What `b` is free to do: slide along x, and where y is free, along y and turn about z, too.
        for (dim, guided, free) in [
            (2, Y.to_string(), 1),
            (3, Z.to_string(), 3),
            (3, format!("{Y}, {Z}"), 1),
        ] {
            let what = format!("{dim}D, {guided}");
            let scene = bars(dim, &guided);
            let problem = scene.substructures(&|_| true).expect("substructures");
            let settings = MethodSettings::default().rtol(1e-10);
            let mut solver = FetiFeti::new(session, problem, settings).expect("set up");
            let facts = solver.facts();
            assert_eq!(
                (facts.floating_bodies, facts.kernel_dimension),
                (1, free),
                "{what}"
            );
            let solution = solver.solve().expect("solved");
            assert!(solution.converged(), "{what}: {}", solution.status);
            // The contact carries the load; both bars are rods: E u(2) = −1 − 1/2.
            let force: f64 = solution.rows().iter().map(|r| r.multiplier).sum();
            let volume = [0.2, 0.02][dim - 2];
            assert!((force - volume).abs() < 1e-8 * volume, "{what}: {force}");
            let least = solution.u.iter().flatten().fold(0.0f64, |a, u| a.min(*u));
            if free == 1 {
                assert!((least + 0.015).abs() < 1e-8, "{what}: {least}");
            }
        }
    });
}

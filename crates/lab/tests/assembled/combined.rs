//! Unit tests of `crates/lab/src/assembled/layout/combined.rs`: mortar contact as bounds of single unknowns.

use super::*;
use crate::assembled::reference::{Reference, ResidualPrecision};
use crate::assembled::rows::Inequalities;
use crate::testing::with_session;
use fetifeti::problem::Law;
use fetifeti::Subdomain;
use scene::Scene;

/// An elastic block on another one with other elements, a gap between them, the common face inclined; `order` and more
/// keys of the upper block, with what follows the joint.
fn blocks(dim: usize, order: usize, keys: &str, more: &str) -> Scene {
    let cut = |v: [&str; 3]| format!("[{}]", v[..dim].join(", "));
    let map = match dim {
        2 => "shape = { y = \"y + 0.1*x*y*(2 - y)\" }",
        _ => "shape = { y = \"y + 0.1*(x + 0.5*z)*y*(2 - y)\" }",
    };
    let body = |name: &str, y: &str, elements: [&str; 3], keys: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\norigin = {}\nsize = {}\nelements = {}\nsubdomains = {}\n\
             young = 10\npoisson = 0.3\n{map}\n{keys}\n",
            cut(["0", y, "0"]),
            cut(["2", "1", "1"]),
            cut(elements),
            cut(["2", "1", "1"]),
        )
    };
    let back = if dim == 3 { ", back = { z = 0 }" } else { "" };
    let text = format!(
        "dimension = {dim}\nphysics = \"elasticity\"\norder = {order}\n{}{}[[contact]]\n\
         bodies = [\"low\", \"up\"]\ngap = \"0.05*x^2\"\nmultipliers = \"up\"\n{more}",
        body("low", "0", ["4", "2", "2"], "dirichlet = [\"bottom\"]"),
        body(
            "up",
            "1",
            ["6", "2", "3"],
            &format!("dirichlet = {{ left = {{ x = 0 }}{back} }}\n{keys}")
        ),
    );
    Scene::parse("blocks.toml", &text).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// The load of the upper block in the plane and in space.
fn load(dim: usize) -> &'static str {
    ["load = [0.1, -1]", "load = [0.1, -1, 0]"][dim - 2]
}

/// A third block beside the upper one, tied to it along a face with other nodes.
fn tied(dim: usize) -> Scene {
    let cut = |v: [&str; 3]| format!("[{}]", v[..dim].join(", "));
    let third = format!(
        "[[body]]\nname = \"third\"\norigin = {}\nsize = {}\nelements = {}\nyoung = 5\npoisson = 0.2\n\
         load = {}\n",
        cut(["0", "2.6", "0"]),
        cut(["2", "1", "1"]),
        cut(["5", "2", "2"]),
        cut(["0", "-1", "0"]),
    );
    let joint = "[[tie]]\nbodies = [\"up\", \"third\"]\nsides = [\"top\", \"bottom\"]\n";
    blocks(dim, 1, load(dim), &(third + joint))
}

fn scenes() -> Vec<(String, Scene)> {
    let mut out = Vec::new();
    for dim in [2, 3] {
        for order in [1, 2] {
            let scene = blocks(dim, order, load(dim), "");
            out.push((format!("{dim}D, order {order}"), scene));
        }
    }
    out.push(("tied in the plane".into(), tied(2)));
    out
}

/// u at body dofs from w, and what inequalities say of it.
#[test]
fn inequalities_bound_single_unknowns() {
    for (what, scene) in scenes() {
        let layout = UnknownLayout::new(&scene);
        assert_eq!(layout.trouble, None, "{what}");
        let rows = Inequalities::new(&scene, &layout);
        let value = |w: u64| match layout.void().binary_search(&w) {
            Ok(_) => 0.0,
            Err(_) => (7.3 * w as f64).sin(),
        };
        let u = |dof: u64| {
            let (terms, offset) = layout.terms(layout.index(dof));
            terms.iter().map(|&(w, c)| c * value(w)).sum::<f64>() + offset
        };
        let all = scene.solver_rows(&|_| true);
        let jump = |row: &Row| row.terms.iter().map(|&(dof, b)| b * u(dof)).sum::<f64>();
        let inequalities = all.iter().filter(|r| r.law == Law::Unilateral);
        let mut combined = 0;
        for (row, bound) in inequalities.zip(&rows.rows) {
            let w = |k: usize| rows.unknowns.get(k).map_or(0.0, |&w| value(w));
            let is = w(bound.plus) - w(bound.minus);
            assert!((jump(row) - is).abs() < 1e-12, "{what}: {} {is}", jump(row));
            combined += usize::from(layout.is_combined(row));
        }
        assert!(combined > 4, "{what}: {combined}");
        for row in all.iter().filter(|r| r.law == Law::Tie) {
            assert!((jump(row) - row.gap).abs() < 1e-12, "{what}");
        }
        // A rigid motion of everything, as multigrid is given it.
        if all.iter().any(|r| r.law == Law::Tie) {
            continue;
        }
        let (centre, scale) = layout.ball();
        let rotation = scene.dim();
        for (body, part) in (0..scene.n_subdomains())
            .map(|s| (scene.body_of(s).0, scene.subdomain(s).expect("a subdomain")))
        {
            for &dof in &part.dofs {
                let (terms, _) = layout.terms(layout.index(dof));
                let motion = |w: u64| layout.motions_at(w, centre, scale)[rotation];
                let is: f64 = terms.iter().map(|&(w, c)| c * motion(w)).sum();
                let inside = (dof - scene.bodies[body].first_dof) as usize;
                let c = scene.components();
                let x = scene.bodies[body].spec.position(inside / c);
                let motions = elements::cell::rigid_motions(scene.dim(), centre, scale, x);
                assert!((is - motions[rotation][inside % c]).abs() < 1e-12, "{what}");
            }
        }
    }
}

/// K u + Bᵀ λ = f on the dofs of bodies, and B u = g, for the rows of a set.
#[test]
fn the_equations_of_a_set_are_the_saddle_point_problem() {
    with_session(|session| {
        for (what, scene) in scenes() {
            let layout = UnknownLayout::new(&scene);
            let all = scene.solver_rows(&|_| true);
            let inequalities: Vec<&Row> = all.iter().filter(|r| r.law == Law::Unilateral).collect();
            let count = inequalities.len();
            for set in [
                vec![true; count],
                (0..count).map(|k| k % 3 != 1).collect::<Vec<_>>(),
            ] {
                let solved = Reference::new(
                    session,
                    &scene,
                    &layout,
                    ResidualPrecision::Working,
                    Some(&set),
                );
                let solved = solved.expect("a solution");
                let parts: Vec<Subdomain> = (0..scene.n_subdomains())
                    .map(|s| scene.subdomain(s).expect("a subdomain"))
                    .collect();
                let values = solved.values(&parts).expect("values");
                let mut force: BTreeMap<u64, f64> = BTreeMap::new();
                let mut u: BTreeMap<u64, f64> = BTreeMap::new();
                let mut size = 0.0_f64;
                for (part, values) in parts.iter().zip(&values) {
                    for (i, &dof) in part.dofs.iter().enumerate() {
                        let (cols, vals) = part.k.row(i);
                        let ku = cols.iter().zip(vals).map(|(&j, v)| v * values[j as usize]);
                        let ku: f64 = ku.sum();
                        size = size.max(ku.abs());
                        *force.entry(dof).or_default() += part.f[i] - ku;
                        u.insert(dof, values[i]);
                    }
                }
                for ((row, on), lambda) in inequalities.iter().zip(&set).zip(&solved.found.lambda) {
                    assert!(*on || *lambda == 0.0, "{what}");
                    for &(dof, b) in &row.terms {
                        *force.entry(dof).or_default() -= b * lambda;
                    }
                    let jump: f64 = row.terms.iter().map(|&(dof, b)| b * u[&dof]).sum();
                    assert!(!on || (jump - row.gap).abs() < 1e-11, "{what}: {jump}");
                }
                // Ties have multipliers that the assembled problem does not know.
                for row in all.iter().filter(|r| r.law == Law::Tie) {
                    row.terms.iter().for_each(|t| {
                        force.remove(&t.0);
                    });
                }
                let worst = force.values().fold(0.0_f64, |m, f| m.max(f.abs()));
                assert!(worst < 1e-10 * size, "{what}: {worst:e} of {size:e}");
            }
        }
    });
}

/// A node opposite two bodies has a row with each: one of them takes an unknown of another node.
#[test]
fn a_node_opposite_two_bodies_has_two_bounds() {
    let text = "physics = \"elasticity\"\n".to_string();
    let body = |name: &str, x: f64, y: f64, size: [f64; 2], n: [usize; 2], keys: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\norigin = [{x}, {y}]\nsize = {size:?}\nelements = {n:?}\nyoung = 1\n\
             poisson = 0.3\n{keys}\n"
        )
    };
    let text =
        text + &body(
            "a",
            0.0,
            0.0,
            [1.0, 1.0],
            [4, 3],
            "dirichlet = [\"bottom\"]",
        ) + &body(
            "b",
            1.04,
            0.0,
            [1.0, 1.0],
            [4, 3],
            "dirichlet = [\"bottom\"]",
        ) + &body(
            "top",
            0.0,
            1.0,
            [2.04, 1.0],
            [6, 3],
            "dirichlet = { left = { x = 0 } }\nload = [0, -1]",
        ) + "[[contact]]\nbodies = [\"a\", \"top\"]\nmultipliers = \"top\"\n"
            + "[[contact]]\nbodies = [\"b\", \"top\"]\nmultipliers = \"top\"\n";
    with_session(move |session| {
        let scene = Scene::parse("two.toml", &text).unwrap_or_else(|e| panic!("{e}\n{text}"));
        let layout = UnknownLayout::new(&scene);
        assert_eq!(layout.trouble, None);
        let rows = Inequalities::new(&scene, &layout);
        let mut places: Vec<usize> = rows.rows.iter().map(|r| r.plus).collect();
        places.sort_unstable();
        places.dedup();
        assert_eq!(places.len(), rows.len());
        let carriers = scene.solver_rows(&|_| true);
        let mut carriers: Vec<u64> = carriers
            .iter()
            .filter_map(|r| Some(layout.carrier(r)?.0))
            .collect();
        carriers.sort_unstable();
        let all = carriers.len();
        carriers.dedup();
        assert!(carriers.len() < all, "{all}");
        let direct = Reference::certified(session, &scene, &layout).expect("a solution");
        let pressed: f64 = direct.found.lambda.iter().sum();
        // The weight of the upper block.
        assert!((pressed - 2.04).abs() < 1e-10, "{pressed}");
    });
}

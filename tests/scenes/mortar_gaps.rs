//! Gaps between sides whose nodes do not match: clearance, interference, `adjust`, the search for pairs, against
//! uniaxial strain: σ = E (1 − ν)/((1 + ν)(1 − 2ν)) · (way − clearance) / height.

use crate::support::session::with_session;
use fetifeti::settings::MethodSettings;
use fetifeti::FetiFeti;
use scene::Scene;

/// The way of the upper block's top, and the height of both blocks.
const WAY: f64 = 0.05;
const HEIGHT: f64 = 2.0;

/// Two blocks, one above the other at a distance, that move along y only, and `joint`.
fn blocks(dim: usize, order: usize, apart: f64, joint: &str) -> String {
    let list = |v: [String; 3]| format!("[{}]", v[..dim].join(", "));
    let numbers = |v: [usize; 3]| list(v.map(|n| n.to_string()));
    let across = match dim {
        2 => "left = { x = 0 }, right = { x = 0 }",
        _ => "left = { x = 0 }, right = { x = 0 }, back = { z = 0 }, front = { z = 0 }",
    };
    // Boxes may not overlap, bent ones may.
    let shape = if apart < 0.0 {
        "shape = { x = \"x\" }\n"
    } else {
        ""
    };
    let body = |name: &str, y: f64, elements: [usize; 3], held: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\norigin = {}\nsize = {}\nelements = {}\nyoung = 10\npoisson = 0.3\n\
             {shape}dirichlet = {{ {across}, {held} }}\n",
            list(["0".into(), format!("{y}"), "0".into()]),
            numbers([2, 1, 1]),
            numbers(elements)
        )
    };
    format!(
        "dimension = {dim}\nphysics = \"elasticity\"\norder = {order}\n{}{}{joint}",
        body("low", 0.0, [4, 2, 3], "bottom = { y = 0 }"),
        body(
            "up",
            1.0 + apart,
            [6, 3, 2],
            &format!("top = {{ y = -{WAY} }}")
        ),
    )
}

/// The pressures at the nodes of a scene's contact.
fn pressures(text: &str) -> Vec<f64> {
    let scene = Scene::parse("s.toml", text).unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert!(scene.mortar_rows().count() > 4, "mortar rows");
    let problem = scene.substructures(&|_| true).expect("substructures");
    with_session(move |session| {
        let settings = MethodSettings::default().rtol(1e-12);
        let mut solver = FetiFeti::new(session, problem, settings).expect("set up");
        let solution = solver.solve().expect("a solution");
        assert!(solution.converged());
        let rows = solution.rows();
        rows.iter().filter_map(|r| r.pressure()).collect()
    })
}

#[track_caller]
fn expect(text: &str, clearance: f64) {
    let modulus = 10.0 * 0.7 / (1.3 * 0.4);
    let sigma = modulus * (WAY - clearance).max(0.0) / HEIGHT;
    let found = pressures(text);
    assert!(found.len() > 4);
    for p in found {
        assert!((p - sigma).abs() < 1e-10, "{p}, not {sigma}\n{text}");
    }
}

#[test]
fn clearance_and_interference_are_exact() {
    for dim in [2, 3] {
        for order in [1, 2] {
            for multipliers in ["low", "up"] {
                let with = |apart: f64, more: &str| {
                    let joint = format!(
                        "[[contact]]\nbodies = [\"low\", \"up\"]\nsides = [\"top\", \"bottom\"]\n\
                         multipliers = \"{multipliers}\"\n{more}\n"
                    );
                    blocks(dim, order, apart, &joint)
                };
                // The geometry, a number, an expression, and their sum; a table along the side.
                expect(&with(0.01, ""), 0.01);
                expect(&with(0.0, "gap = 0.02"), 0.02);
                expect(&with(0.01, "gap = \"0.03 - 0.01*(x - x) - 0.01\""), 0.03);
                if dim == 2 {
                    expect(&with(0.0, "gap = [[0, 0.015], [1, 0.015]]"), 0.015);
                }
                // Interference, as a gap and by the geometry; a clearance that stays open.
                expect(&with(0.0, "gap = -0.04"), -0.04);
                expect(&with(-0.03, ""), -0.03);
                expect(&with(0.0, "gap = 0.06"), 0.06);
                // What counts as touching does, whatever its sign; the given gap stays.
                expect(&with(0.01, "adjust = 0.011"), 0.0);
                expect(&with(-0.01, "adjust = 0.011"), 0.0);
                expect(&with(0.01, "adjust = 0.011\ngap = 0.02"), 0.02);
                expect(&with(0.01, "adjust = 0.009"), 0.01);
            }
        }
    }
}

#[test]
fn pairs_are_found_within_a_distance() {
    for dim in [2, 3] {
        for order in [1, 2] {
            let with = |more: &str| {
                blocks(
                    dim,
                    order,
                    0.01,
                    &format!("[contact]\nauto = true\n{more}\n"),
                )
            };
            // A tenth of an edge is more than the distance.
            expect(&with(""), 0.01);
            expect(&with("distance = 0.011"), 0.01);
            expect(&with("distance = 0.011\nadjust = 0.011"), 0.0);
            let told = Scene::parse("s.toml", &with("distance = 0.009")).expect_err("refused");
            assert!(
                told.to_string()
                    .contains("no two bodies are near each other"),
                "{told}"
            );
        }
    }
}

/// A gap that opens linearly along the side is that of the nodes: the rows of flat sides are those of their own nodes.
#[test]
fn a_table_is_linear_between_its_rows() {
    let joint = "[[contact]]\nbodies = [\"low\", \"up\"]\nsides = [\"top\", \"bottom\"]\n\
        gap = [[0, 0], [0.5, 0.1], [1, 0.1]]\n";
    let scene = Scene::parse("s.toml", &blocks(2, 1, 0.25, joint)).expect("a scene");
    let gaps = scene.gaps(&|_| true, 0).expect("a step");
    let expected = [0.25, 0.3, 0.35, 0.35, 0.35];
    assert_eq!(gaps.len(), expected.len());
    for (gap, expected) in gaps.iter().zip(expected) {
        assert!((gap - expected).abs() < 1e-14, "{gaps:?}");
    }
}

/// The shortest edge of both sides is 1/3.
#[test]
fn an_overlap_of_much_of_an_edge_is_said() {
    let notes = |apart: f64, joint: &str| {
        let pair = "bodies = [\"low\", \"up\"]\nsides = [\"top\", \"bottom\"]\n";
        let text = blocks(2, 1, apart, &joint.replace("PAIR", pair));
        Scene::parse("s.toml", &text).expect("a scene").notes
    };
    let contact = "[[contact]]\nPAIR";
    let said = notes(-0.05, contact);
    let names = "Side `top` of `low` and side `bottom` of `up` overlap by 5.000e-2 to begin with, more than a tenth";
    assert!(said.len() == 1 && said[0].starts_with(names), "{said:?}");
    assert!(said[0].contains("contact presses them apart"), "{said:?}");
    let tied = notes(-0.05, "[[tie]]\nPAIR");
    assert!(
        tied.iter()
            .any(|t| t.ends_with("the tie keeps the overlap.")),
        "{tied:?}"
    );
    for (apart, joint) in [(-0.03, ""), (-0.05, "adjust = 0.06\n"), (0.05, "")] {
        let said = notes(apart, &format!("{contact}{joint}"));
        assert!(said.is_empty(), "{apart} {joint}: {said:?}");
    }
}

//! Bodies that touch without a common node and that nothing joins: one sentence, with what to write.

use super::meshes::Model;
use crate::support::mpi::Scratch;
use crate::support::surface_mesh::gmsh;
use scene::Scene;

const START: &str = "touch over";

/// The notes on bodies that nothing joins.
fn loose(scene: &Scene) -> Vec<&String> {
    let about = |n: &&String| n.contains(START);
    scene.notes.iter().filter(about).collect()
}

/// Two plates of squares, `a` on [0, 2] × [0, 1] and `b` of the same size, whose lower left corner is `at`.
fn plates(at: [f64; 2], groups: bool) -> String {
    let mut points = Vec::new();
    let mut add = |n: usize, [x, y]: [f64; 2]| {
        let first = points.len();
        for k in 0..=n {
            let right = x + 2.0 * k as f64 / n as f64;
            points.extend([[right, y, 0.0], [right, y + 1.0, 0.0]]);
        }
        let of = move |k: usize| first + 2 * k;
        let cells = (0..n).map(|k| vec![of(k), of(k + 1), of(k + 1) + 1, of(k) + 1]);
        let line = |up: usize| -> Vec<Vec<usize>> {
            (0..n).map(|k| vec![of(k) + up, of(k + 1) + up]).collect()
        };
        (cells.collect::<Vec<_>>(), line(0), line(1))
    };
    let (a, a_bottom, a_top) = add(2, [0.0, 0.0]);
    let (b, b_bottom, _) = add(3, at);
    let mut all = vec![("a", a), ("b", b), ("a_bottom", a_bottom)];
    if groups {
        all.extend([("a_top", a_top), ("b_bottom", b_bottom)]);
    }
    gmsh(&points, &all)
}

fn scene(more: &str) -> String {
    format!(
        "{more}\nphysics = \"elasticity\"\n[mesh]\nfile = \"m.msh\"\n[[body]]\nname = \"a\"\n\
         dirichlet = {{ a_bottom = 0 }}\n[[body]]\nname = \"b\"\n"
    )
}

#[test]
fn plates_that_touch_are_named_with_what_joins_them() {
    // They lie on each other along a length of 1.7; nodes of `b` are at 0.3, 0.967, 1.633.
    let model = Model::new("loose", &plates([0.3, 1.0], true));
    let found = model.scene(&scene(""));
    assert_eq!(
        loose(&found),
        [
            "Bodies `a` and `b` touch over a length of 1.700e0 (surfaces `a_top` and `b_bottom`) without a common \
             node, and nothing joins them: [[tie]] or [[contact]] with `surfaces = [\"a_top\", \"b_bottom\"]` joins \
             them, and `[contact] auto = true` finds them."
        ]
    );
    // What the sentence says joins them, and it is gone.
    for joint in [
        "[[tie]]\nsurfaces = [\"a_top\", \"b_bottom\"]",
        "[[contact]]\nsurfaces = [\"a_top\", \"b_bottom\"]",
        "[contact]\nauto = true",
    ] {
        let joined = model.scene(&format!("{}{joint}", scene("")));
        assert_eq!(joined.interfaces.len(), 1, "{joint}");
        assert!(loose(&joined).is_empty(), "{joint}: {:?}", joined.notes);
    }
    // Who writes "free" knows.
    let free = format!("{}[interface]\ndefault = \"free\"\n", scene(""));
    assert!(loose(&model.scene(&free)).is_empty());
    // Without groups there are no surfaces to name.
    let bare = Model::new("loose-bare", &plates([0.3, 1.0], false));
    let bare = bare.scene(&scene(""));
    let said = loose(&bare);
    assert_eq!(said.len(), 1);
    assert!(
        said[0].contains("`surfaces` names a boundary group of the mesh on each"),
        "{said:?}"
    );
}

#[test]
fn plates_that_do_not_touch_are_not_named() {
    // A gap of a fifth of the shortest edge; beside each other with a corner in common; common nodes.
    for (name, at) in [
        ("gap", [0.3, 1.0 + 0.2 * 2.0 / 3.0]),
        ("corner", [2.0 + 1e-9, 1.0 + 1e-9]),
        ("common", [0.0, 1.0]),
    ] {
        let model = Model::new(&format!("loose-{name}"), &plates(at, true));
        let found = model.scene(&scene(""));
        assert!(loose(&found).is_empty(), "{name}: {:?}", found.notes);
    }
    // A gap below a tenth of it counts as touching, as for `auto`.
    let model = Model::new("loose-near", &plates([0.3, 1.01], true));
    assert_eq!(loose(&model.scene(&scene(""))).len(), 1);
}

#[test]
fn boxes_in_space_are_named_with_their_sides() {
    let body = |name: &str, at: [f64; 3], n: usize, more: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\norigin = {at:?}\nsize = [1, 1, 1]\nelements = {n}\nsubdomains = 1\n{more}\n"
        )
    };
    let pair = |at: [f64; 3]| {
        let bent = "shape = { x = \"x + 0.1*y*0\" }";
        let text = format!(
            "dimension = 3\nphysics = \"elasticity\"\n{}{}",
            body("low", [0.0; 3], 2, "dirichlet = { bottom = 0 }"),
            body("up", at, 3, bent)
        );
        Scene::parse("boxes.toml", &text).expect("a scene")
    };
    let found = pair([0.2, 1.0, 0.3]);
    let said = loose(&found);
    assert_eq!(said.len(), 1, "{:?}", found.notes);
    assert!(
        said[0].contains("touch over an area of 5.600e-1 (surfaces `top` and `bottom`)")
            && said[0].contains("`bodies = [\"low\", \"up\"]` and `sides = [\"top\", \"bottom\"]`"),
        "{said:?}"
    );
    assert!(loose(&pair([1.0 + 1e-9, 1.0, 0.3])).is_empty());
    assert!(loose(&pair([0.2, 1.1, 0.3])).is_empty());
}

#[test]
fn a_deck_in_space_says_it_in_its_own_words() {
    // A brick on [0, 1]³ and one on it, shifted by 0.2 and 0.3.
    let mut text = String::from("*NODE\n");
    for (first, at) in [(1, [0.0, 0.0, 0.0]), (11, [0.2, 0.3, 1.0])] {
        for (k, [x, y]) in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
            .iter()
            .enumerate()
        {
            let (x, y) = (x + at[0], y + at[1]);
            text += &format!("{}, {x}, {y}, {}\n", first + k, at[2]);
            text += &format!("{}, {x}, {y}, {}\n", first + k + 4, at[2] + 1.0);
        }
    }
    text += "*ELEMENT, TYPE=C3D8, ELSET=E\n1, 1, 2, 3, 4, 5, 6, 7, 8\n2, 11, 12, 13, 14, 15, 16, 17, 18\n";
    text += "*MATERIAL, NAME=M\n*ELASTIC\n210, 0.3\n*SOLID SECTION, ELSET=E, MATERIAL=M\n";
    text += "*SURFACE, NAME=UNDER\n1, S2\n*SURFACE, NAME=OVER\n2, S1\n";
    let step = "*STEP\n*STATIC\n*BOUNDARY\n1, 1, 3\n2, 1, 3\n3, 1, 3\n4, 1, 3\n11, 1, 3\n12, 1, 3\n13, 1, 3\n\
                *END STEP\n";
    let scratch = Scratch::new("loose-deck");
    let load = |name: &str, more: &str| {
        Scene::load(scratch.file(name, &format!("{text}{more}{step}"))).expect("a deck")
    };
    let apart = load("apart.inp", "");
    let said = loose(&apart);
    assert_eq!(said.len(), 1, "{:?}", apart.notes);
    assert!(
        said[0].contains("touch over an area of 5.600e-1")
            && said[0].contains("*TIE or *CONTACT PAIR")
            && !said[0].contains("auto"),
        "{said:?}"
    );
    let tied = load("tied.inp", "*TIE, NAME=T\nOVER, UNDER\n");
    assert_eq!(tied.interfaces.len(), 1);
    assert!(loose(&tied).is_empty(), "{:?}", tied.notes);
}

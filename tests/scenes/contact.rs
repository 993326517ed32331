//! Rows of contacts and obstacles: at faces, cross points, prescribed values; labels; load steps.

use fetifeti::problem::{Law, RowLabel, RowSource};
use fetifeti::Row;
use parallel::contiguous_share;
use scene::{Link, Scene};

fn body(name: &str, origin: &str, more: &str) -> String {
    format!("[[body]]\nname = \"{name}\"\norigin = {origin}\nsize = [1, 1]\nelements = 4\n{more}\n")
}

/// Two unit squares side by side, 4 × 4 elements each: body dofs 0..25 and 25..50.
fn pair(more: &str) -> Scene {
    let text = body("a", "[0, 0]", "") + &body("b", "[1, 0]", "") + more;
    Scene::parse("s.toml", &text).unwrap()
}

fn contact(more: &str) -> String {
    format!("[[contact]]\nbodies = [\"a\", \"b\"]\n{more}\n")
}

fn labels(scene: &Scene) -> Vec<RowLabel> {
    scene
        .solver_rows(&|_| true)
        .iter()
        .map(|r| r.label)
        .collect()
}

fn gaps(scene: &Scene) -> Vec<f64> {
    scene.solver_rows(&|_| true).iter().map(|r| r.gap).collect()
}

#[test]
fn a_row_says_that_the_second_body_stays_above_the_first() {
    for (order, sign) in [("[\"a\", \"b\"]", 1.0), ("[\"b\", \"a\"]", -1.0)] {
        let scene = pair(&format!("[[contact]]\nbodies = {order}\ngap = 0.5\n"));
        let rows = scene.solver_rows(&|_| true);
        assert_eq!(rows.len(), 5);
        for (k, row) in rows.iter().enumerate() {
            let k = k as u64;
            // u_first − u_second ≤ gap, the first body with +1.
            let mut terms = row.terms.clone();
            terms.sort_by_key(|t| t.0);
            assert_eq!(terms, [(4 + 5 * k, sign), (25 + 5 * k, -sign)]);
            assert_eq!(row.terms[0].1, 1.0);
            assert_eq!((row.gap, row.law, row.holds), (0.5, Law::Unilateral, true));
            assert_eq!(row.block, 4 + 5 * k);
        }
        let interface = &scene.interfaces[0];
        assert!(interface.has_contact() && scene.has_contact());
        assert_eq!(interface.order, if sign > 0.0 { [0, 1] } else { [1, 0] });
        let at_gap = |l: Link| l == Link::Contact { gap: 0.5 };
        assert!(interface.shared.iter().all(|s| at_gap(s.link)));
        let labels = labels(&scene);
        let first = labels[1].members.map(|m| m.unwrap().body);
        assert_eq!(first, interface.order);
        assert_eq!(
            (labels[1].point, labels[1].t),
            ([1.0, 0.25, 0.0], [0.25, 0.0])
        );
        assert_eq!(labels[1].source, RowSource::Interface(0));
    }
}

#[test]
fn gaps_have_three_forms() {
    let of = |gap: &str| gaps(&pair(&contact(&format!("gap = {gap}"))));
    assert_eq!(gaps(&pair(&contact(""))), [0.0; 5]);
    assert_eq!(of("-0.25"), [-0.25; 5]);
    assert_eq!(of("\"x + y\""), [1.0, 1.25, 1.5, 1.75, 2.0]);
    assert_eq!(of("[[0.25, 1], [0.75, 2]]"), [1.0, 1.0, 1.5, 2.0, 2.0]);
    assert_eq!(of("[[0, 3]]"), [3.0; 5]);
    // Of several gaps the smallest one counts.
    let two = contact("range = [0, 0.5]\ngap = 0.1") + &contact("range = [0.5, 1]\ngap = 0.2");
    assert_eq!(gaps(&pair(&two)), [0.1, 0.1, 0.1, 0.2, 0.2]);
    // bi is the column of the first body.
    let grid = "[grid]\nbodies = [3, 1]\nsize = [3, 1]\nelements = 1\n";
    for (bodies, expected) in [("\"b0_0\", \"b1_0\"", 0.0), ("\"b2_0\", \"b1_0\"", 2.0)] {
        let text = format!("{grid}[interface]\ndefault = \"free\"\n[[contact]]\nbodies = [{bodies}]\ngap = \"bi\"\n");
        assert_eq!(gaps(&Scene::parse("g.toml", &text).unwrap()), [expected; 2]);
    }
}

/// (holds, inequality) of every row.
fn kinds(scene: &Scene) -> Vec<(bool, bool)> {
    let kind = |r: &Row| (r.holds, r.law == Law::Unilateral);
    scene.solver_rows(&|_| true).iter().map(kind).collect()
}

#[test]
fn ties_and_contacts_share_a_face() {
    let tie = |more: &str| format!("[[tie]]\nbodies = [\"a\", \"b\"]\n{more}\n");
    const TIED: (bool, bool) = (true, false);
    const CONTACT: (bool, bool) = (true, true);
    const OPEN: (bool, bool) = (false, false);
    let both = tie("range = [0, 0.5]") + &contact("range = [0.5, 1]");
    assert_eq!(kinds(&pair(&both)), [TIED, TIED, TIED, CONTACT, CONTACT]);
    // On a partly tied face the remaining nodes are open; on a face partly in contact they are free.
    let some = tie("range = [0, 0.25]") + &contact("nodes = [3]");
    assert_eq!(kinds(&pair(&some)), [TIED, TIED, OPEN, CONTACT, OPEN]);
    assert_eq!(kinds(&pair(&contact("points = [0.5, 0.75]"))), [CONTACT; 2]);
    let plan = pair(&both).plan();
    assert_eq!((plan.contact_pairs, plan.contact_rows), (1, 2));
    assert_eq!(
        (plan.interfaces[0].tied, plan.interfaces[0].contact),
        (3, 2)
    );
}

#[test]
fn an_entry_that_names_the_pair_beats_all() {
    let all = "[[contact]]\nbodies = \"all\"\ngap = 1\n";
    assert_eq!(gaps(&pair(all)), [1.0; 5]);
    assert_eq!(
        gaps(&pair(&(all.to_string() + &contact("gap = 2")))),
        [2.0; 5]
    );
    let none = "[[tie]]\nbodies = [\"a\", \"b\"]\nwhere = \"none\"\n";
    let more = body("c", "[2, 0]", "");
    let rows = pair(&format!("{more}{all}{none}")).solver_rows(&|_| true);
    assert_eq!(rows.len(), 5);
    assert!(rows.iter().all(|r| r.block >= 25));
    // A contact by name overrides a tie of all pairs; ties and contacts of all pairs coexist.
    let tied = "[[tie]]\nbodies = \"all\"\n";
    let scene = pair(&format!("{tied}{}", contact("gap = 2")));
    assert_eq!(gaps(&scene), [2.0; 5]);
    let halves = "[[tie]]\nbodies = \"all\"\nrange = [0, 0.5]\n[[contact]]\nbodies = \"all\"\nrange = [0.5, 1]\n";
    let holding = kinds(&pair(halves)).iter().filter(|k| k.1).count();
    assert_eq!(holding, 2);
    let scene = pair("[interface]\ndefault = \"contact\"\n");
    assert_eq!(kinds(&scene), [(true, true); 5]);
    let tied = pair("[interface]\ndefault = \"contact\"\n[[tie]]\nbodies = [0, 1]\n");
    assert!(!tied.has_contact());
}

/// Rows at the cross point of 2 × 2 bodies, as (bodies, inequality).
fn cross(entries: &str) -> Vec<([usize; 2], bool)> {
    let text = format!("[grid]\nbodies = 2\nsize = 2\nelements = 2\n{entries}");
    let scene = Scene::parse("c.toml", &text).unwrap();
    let rows = scene.solver_rows(&|_| true);
    let labels = labels(&scene);
    let here = labels
        .iter()
        .zip(&rows)
        .filter(|(l, _)| l.point == [1.0, 1.0, 0.0]);
    here.map(|(l, r)| (l.members.map(|m| m.unwrap().body), r.law == Law::Unilateral))
        .collect()
}

#[test]
fn every_face_in_contact_has_its_row_at_a_cross_point() {
    let entry = |kind: &str, a: usize, b: usize| format!("[[{kind}]]\nbodies = [{a}, {b}]\n");
    let all = "[interface]\ndefault = \"contact\"\n";
    let faces = [[0, 1], [0, 2], [1, 3], [2, 3]].map(|p| (p, true));
    assert_eq!(cross(all), faces);
    assert_eq!(cross("[[contact]]\nbodies = \"all\"\n"), faces);
    // Contact at a corner exists only by name.
    let named = cross(&(all.to_string() + &entry("contact", 0, 3)));
    assert_eq!(named.len(), 5);
    assert!(named.contains(&([0, 3], true)));
    // Columns are tied by default, with contact between them; ties along diagonals would defeat it.
    let columns = entry("contact", 0, 1) + &entry("contact", 2, 3);
    let expected = [
        ([0, 1], true),
        ([0, 2], false),
        ([1, 3], false),
        ([2, 3], true),
    ];
    assert_eq!(cross(&columns), expected);
    let by_all = format!("[[tie]]\nbodies = \"all\"\n{columns}");
    assert_eq!(cross(&by_all), expected);
    // One face in contact among tied ones has no row at the cross point: the other bodies tie the two.
    let one = cross(&entry("contact", 0, 1));
    assert_eq!(one.len(), 5);
    assert!(one.iter().all(|r| !r.1));
}

#[test]
fn given_values_go_to_the_right_hand_side() {
    let two = |a: &str, b: &str, gap: &str| {
        let text = body("a", "[0, 0]", a) + &body("b", "[1, 0]", b) + &contact(gap);
        Scene::parse("d.toml", &text).unwrap()
    };
    // u_a ≤ g + v_b
    let scene = two("", "dirichlet = { left = \"2 + y\" }", "gap = 0.5");
    let rows = scene.solver_rows(&|_| true);
    assert_eq!(rows.len(), 5);
    assert_eq!(rows[2].terms, [(14, 1.0)]);
    assert_eq!(gaps(&scene), [2.5, 2.75, 3.0, 3.25, 3.5]);
    let label = scene.solver_rows(&|_| true)[2].label;
    assert_eq!(label.members.map(|m| m.unwrap().node), [14, 10]);
    // −u_b ≤ g − v_a
    let scene = two("dirichlet = { right = 3 }", "", "gap = 0.5");
    let rows = scene.solver_rows(&|_| true);
    assert_eq!(rows[2].terms, [(35, -1.0)]);
    assert_eq!(rows[2].gap, -2.5);
    // Both values are prescribed and compatible: no row is left.
    let scene = two("dirichlet = [\"bottom\"]", "dirichlet = { bottom = 1 }", "");
    assert_eq!(scene.solver_rows(&|_| true).len(), 4);
    assert_eq!(scene.plan().contact_rows, 4);
}

#[test]
fn obstacles_bound_the_nodes_of_a_side() {
    let more = "[[obstacle]]\nbody = \"a\"\nside = \"top\"\nrange = [0, 0.5]\nbelow = \"x - 1\"\nabove = 0.2\n\
                [[obstacle]]\nbody = 1\nside = [\"right\", \"top\"]\nabove = [[0, 1], [1, 2]]\n";
    let scene = pair(&format!("[interface]\ndefault = \"free\"\n{more}"));
    let names: Vec<&str> = scene.obstacles.iter().map(|o| o.name.as_str()).collect();
    assert_eq!(
        names,
        ["a.top below", "a.top above", "b.right above", "b.top above"]
    );
    assert!(!scene.obstacles[0].upper && scene.obstacles[1].upper);
    let rows = scene.solver_rows(&|_| true);
    let labels = labels(&scene);
    // Nodes 20, 21, 22 of `a` twice; nine nodes of `b`, the corner once.
    assert_eq!(rows.len(), 6 + 9);
    let of = |dof: u64| -> Vec<(&Row, &RowLabel)> {
        let both = rows.iter().zip(&labels);
        both.filter(|(r, _)| r.terms[0].0 == dof).collect()
    };
    let at = of(21);
    assert_eq!((at[0].0.terms[0], at[0].0.gap), ((21, -1.0), 0.75));
    assert_eq!((at[1].0.terms[0], at[1].0.gap), ((21, 1.0), 0.2));
    // Of two bounds at a node only one is active at the start.
    assert!(at[0].0.holds && !at[1].0.holds);
    assert_eq!(at[1].1.source, RowSource::Obstacle(1));
    assert_eq!((at[1].1.t, at[1].1.point), ([0.25, 0.0], [0.25, 1.0, 0.0]));
    assert_eq!(at[1].1.members[0].unwrap().node, 21);
    assert_eq!(at[1].1.members[1], None);
    assert_eq!(at[1].0.block, 21);
    assert_eq!(of(25 + 4)[0].0.gap, 1.0);
    // At the corner both sides bound u by 2; at the left end of the top the bound is 1.
    assert_eq!(of(49).len(), 1);
    assert_eq!(of(49)[0].0.gap, 2.0);
    assert_eq!(of(45)[0].0.gap, 1.0);
    let plan = scene.plan();
    assert_eq!(
        (plan.obstacles, plan.obstacle_rows, plan.contact_rows),
        (4, 15, 0)
    );
    assert!(plan.steps.is_none() && scene.has_contact());
}

#[test]
fn obstacles_meet_ties_and_given_values() {
    let obstacle = "[[obstacle]]\nbody = \"all\"\nside = \"bottom\"\nbelow = -1\nabove = 3\n";
    let scene = pair(obstacle);
    // (1, 0) belongs to both bodies: one tie and four bounds share the block of the point.
    let rows = scene.solver_rows(&|_| true);
    let here: Vec<&Row> = rows.iter().filter(|r| r.block == 4).collect();
    assert_eq!(here.len(), 5);
    assert_eq!(here[0].terms.len(), 2);
    assert_eq!(rows.len(), 5 + 20);
    // A prescribed node has no row.
    let text = body("a", "[0, 0]", "dirichlet = [\"left\"]") + obstacle;
    let rows = Scene::parse("o.toml", &text)
        .unwrap()
        .solver_rows(&|_| true);
    assert_eq!(rows.len(), 8);
    assert!(rows.iter().all(|r| r.terms[0].0 != 0));
    // A side that is prescribed everywhere has no inequality.
    let text = body("a", "[0, 0]", "dirichlet = [\"bottom\"]") + obstacle;
    assert!(!Scene::parse("o.toml", &text).unwrap().has_contact());
}

#[test]
fn every_row_is_provided_once_and_blocks_stay_together() {
    for name in [
        "contact_row_16",
        "contact_grid_100",
        "obstacle",
        "press_ramp",
    ] {
        let scene = Scene::load(format!("../../examples/scenes/{name}.toml")).unwrap();
        let whole = scene.solver_rows(&|_| true);
        assert_eq!(
            scene.gaps(&|_| true, scene.n_steps() - 1).unwrap(),
            gaps(&scene)
        );
        let n = scene.n_subdomains();
        for ranks in [2, 3, 7] {
            let share = |s: usize, rank: usize| contiguous_share(n, ranks, rank).contains(&s);
            let cyclic = |s: usize, rank: usize| s % ranks == rank;
            for owns in [&share as &dyn Fn(usize, usize) -> bool, &cyclic] {
                let mut found = Vec::new();
                for rank in 0..ranks {
                    let mine = |s: usize| owns(s, rank);
                    let rows = scene.solver_rows(&mine);
                    assert_eq!(scene.gaps(&mine, 0).unwrap().len(), rows.len());
                    found.extend(rows.into_iter().map(|r| (r, rank)));
                }
                assert_eq!(found.len(), whole.len(), "{name}");
                // Points are visited in the order of their blocks.
                found.sort_by_key(|(r, _)| r.block);
                for ((row, _), r) in found.iter().zip(&whole) {
                    assert_eq!((&row.terms, row.gap, row.block), (&r.terms, r.gap, r.block));
                    assert_eq!(row.label, r.label);
                }
                let split = found
                    .windows(2)
                    .any(|w| w[0].0.block == w[1].0.block && w[0].1 != w[1].1);
                assert!(!split, "{name}");
            }
        }
        // Rows that share a dof share the block.
        let mut block = std::collections::HashMap::new();
        for row in &whole {
            for (dof, _) in &row.terms {
                assert_eq!(*block.entry(*dof).or_insert(row.block), row.block, "{name}");
            }
        }
    }
}

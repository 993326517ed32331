//! Numbers of rows, dofs and vertices of scenes, compared with independently computed ones.

use crate::support::common;
use fetifeti::problem::Law;
use fetifeti::Problem;
use parallel::contiguous_share;
use scene::{Faces, Scene};
use std::collections::{HashMap, HashSet};

/// Rows of B_loc: a fully redundant pair for every two copies of a dof that is not primal.
fn local_rows(problem: &Problem) -> usize {
    let mut copies: HashMap<u64, usize> = HashMap::new();
    let mut primal: HashSet<u64> = HashSet::new();
    for s in &problem.local {
        for &dof in &s.dofs {
            *copies.entry(dof).or_default() += 1;
        }
        primal.extend(s.primal.iter().map(|&p| s.dofs[p as usize]));
    }
    copies
        .iter()
        .filter(|(dof, _)| !primal.contains(dof))
        .map(|(_, n)| n * (n - 1) / 2)
        .sum()
}

#[test]
fn multipliers_of_table_1_agree_with_the_reference() {
    let text = include_str!("../data/grid2d_spectra.json");
    let rows: serde_json::Value = serde_json::from_str(text).unwrap();
    let rows = rows.as_array().unwrap();
    assert!(rows.len() >= 10);
    for row in rows {
        let number = |key: &str| row[key].as_u64().unwrap() as usize;
        let (bodies, subdomains, elements) =
            (number("bodies"), number("subdomains"), number("elements"));
        for (key, faces) in [
            ("whole_interface", Faces::Whole),
            ("middle_third", Faces::MiddleThird),
        ] {
            let expected = &row[key];
            let scene = Scene::lee(bodies, subdomains, elements, faces).unwrap();
            let problem = scene.substructures(&|_| true).unwrap();
            let local = local_rows(&problem);
            let holding = problem.rows.iter().filter(|r| r.holds).count();
            let case = format!("({bodies}, {subdomains}, {elements}) {key}");
            assert_eq!(
                local,
                expected["local_multipliers"].as_u64().unwrap() as usize,
                "{case}"
            );
            assert_eq!(
                local + holding,
                expected["multipliers"].as_u64().unwrap() as usize,
                "{case}"
            );
            let plan = scene.plan();
            assert_eq!(plan.local_multipliers, local, "{case}");
            assert_eq!(plan.global_multipliers, holding, "{case}");
            // Both columns have the same candidate contact nodes.
            let candidates = Scene::lee(bodies, subdomains, elements, Faces::Whole)
                .unwrap()
                .solver_rows(&|_| true);
            assert_eq!(problem.rows.len(), candidates.len(), "{case}");
            assert_eq!(plan.open_rows, candidates.len() - holding, "{case}");
            // Corners of bodies are vertices, too, but a dof with a single copy has no constraint.
            let mut vertices: HashMap<u64, usize> = HashMap::new();
            for s in &problem.local {
                for &p in &s.primal {
                    *vertices.entry(s.dofs[p as usize]).or_default() += 1;
                }
            }
            let primal = vertices.values().filter(|&&copies| copies > 1).count();
            assert_eq!(plan.primal, primal, "{case}");
            let dofs: HashSet<u64> = problem.local.iter().flat_map(|s| s.dofs.clone()).collect();
            assert_eq!(plan.dofs, dofs.len(), "{case}");
        }
    }
}

#[test]
fn every_row_is_provided_once_whatever_the_distribution() {
    let scene = Scene::lee(4, 2, 3, Faces::Whole).unwrap();
    let whole = scene.substructures(&|_| true).unwrap();
    let key = |r: &fetifeti::Row| (r.terms[0].0, r.terms[1].0, r.block);
    let expected: HashSet<_> = whole.rows.iter().map(key).collect();
    assert_eq!(expected.len(), whole.rows.len());
    for ranks in [2, 3, 7, 100] {
        let mut seen = HashSet::new();
        let mut subdomains = 0;
        let mut blocks: HashMap<u64, usize> = HashMap::new();
        for rank in 0..ranks {
            // Subdomains are dealt out in turn, the hardest case: neighbours are never on the same rank.
            let part = scene.substructures(&|s| s % ranks == rank).unwrap();
            subdomains += part.local.len();
            for row in &part.rows {
                assert_eq!(row.law, Law::Tie);
                assert!(seen.insert(key(row)));
                assert_eq!(*blocks.entry(row.block).or_insert(rank), rank);
            }
            let share = contiguous_share(scene.n_subdomains(), ranks, rank);
            for s in scene.substructures(&|s| share.contains(&s)).unwrap().local {
                assert!(share.contains(&s.index));
                assert_eq!(s.dofs, whole.local[s.index].dofs);
            }
        }
        assert_eq!(seen, expected);
        assert_eq!(subdomains, scene.n_subdomains());
    }
}

#[test]
fn rows_that_share_a_dof_share_a_block() {
    let scene = Scene::load("../../examples/scenes/unequal_bodies.toml").unwrap();
    let problem = scene.substructures(&|_| true).unwrap();
    let mut block_of: HashMap<u64, u64> = HashMap::new();
    for row in &problem.rows {
        for &(dof, _) in &row.terms {
            assert_eq!(*block_of.entry(dof).or_insert(row.block), row.block);
        }
    }
    // post-block 19 nodes, post-lid 13, block-lid 25; at (1, 1) all three pairs meet; (0, 1) is given by both.
    let blocks: HashSet<u64> = problem.rows.iter().map(|r| r.block).collect();
    assert_eq!(problem.rows.len(), 19 + 12 + 25);
    assert_eq!(blocks.len(), 19 + 12 + 25 - 2);
}

#[test]
fn coefficients_at_dofs_are_the_largest_around() {
    let scene = Scene::parse(
        "t.toml",
        "[[body]]\nname = \"a\"\nsize = [2, 1]\nelements = [4, 2]\nsubdomains = [2, 1]\nrho = \"1 + floor(2*x)\"\n",
    )
    .unwrap();
    let s = scene.subdomain(0).unwrap();
    assert_eq!(s.rho, [1.0, 2.0, 2.0].repeat(3));
    let s = scene.subdomain(1).unwrap();
    assert_eq!(s.rho, [3.0, 4.0, 4.0].repeat(3));
    assert_eq!(s.primal, [0, 2, 6, 8]);
    assert_eq!(s.dofs, [2, 3, 4, 7, 8, 9, 12, 13, 14]);
    assert_eq!(s.coordinates.unwrap()[5], [2.0, 0.5, 0.0]);
    assert_eq!(s.near_kernel.unwrap(), vec![vec![1.0; 9]]);
}

/// Number of rows that hold at the point (x, y) of 2 × 2 unit bodies of 2 × 2 elements with the given interface
/// entries.
fn rows_at(point: [f64; 2], entries: &str) -> usize {
    let text =
        format!("[grid]\nbodies = 2\nsize = 2\nelements = 2\ndirichlet = [\"left\"]\n{entries}");
    let scene = Scene::parse("t.toml", &text).unwrap();
    let at = |p: &&scene::InterfacePoint| {
        let first = p.members[0];
        let [x, y, _] = scene.bodies[first.body].mesh().position(first.node);
        [x, y] == point
    };
    let points: Vec<_> = scene.points.iter().filter(at).collect();
    assert!(points.len() <= 1);
    let of = |p: &&scene::InterfacePoint| {
        let rows = scene.rows.iter();
        rows.filter(|r| r.block == p.block && r.holds).count()
    };
    points.first().map_or(0, of)
}

#[test]
fn cross_points_are_fully_redundant_where_all_is_tied() {
    let cross = [1.0, 1.0];
    let tie =
        |a: &str, b: &str, more: &str| format!("[[tie]]\nbodies = [\"{a}\", \"{b}\"]\n{more}\n");
    let free = "[interface]\ndefault = \"free\"\n";
    assert_eq!(rows_at(cross, ""), 6);
    assert_eq!(rows_at(cross, free), 0);
    assert_eq!(rows_at(cross, "[[tie]]\nbodies = \"all\"\n"), 6);
    assert_eq!(
        rows_at(cross, "[[tie]]\nbodies = \"all\"\nrange = [0.25, 0.75]\n"),
        0
    );
    // The four faces by name join the two diagonal pairs as well.
    let faces = [
        tie("b0_0", "b1_0", ""),
        tie("b0_0", "b0_1", ""),
        tie("b1_0", "b1_1", ""),
        tie("b0_1", "b1_1", ""),
    ];
    assert_eq!(rows_at(cross, &format!("{free}{}", faces.concat())), 6);
    // Three faces still join all four bodies; the free face gets no row of its own.
    assert_eq!(rows_at(cross, &format!("{free}{}", faces[..3].concat())), 5);
    // Two faces join three bodies, one diagonal pair among them.
    assert_eq!(rows_at(cross, &format!("{free}{}", faces[..2].concat())), 3);
    assert_eq!(rows_at(cross, &tie("b0_0", "b1_0", "where = \"none\"")), 5);
    // Entries for one pair add up: an end of the face and its middle.
    let both = tie("b0_0", "b1_0", "nodes = [0]") + &tie("b0_0", "b1_0", "points = [0.5]");
    assert_eq!(rows_at([1.0, 0.0], &format!("{free}{both}")), 1);
    assert_eq!(rows_at([1.0, 0.5], &format!("{free}{both}")), 1);
    assert_eq!(rows_at(cross, &format!("{free}{both}")), 0);
    // On the held side there is no tie.
    assert_eq!(rows_at([0.0, 1.0], ""), 0);
    assert_eq!(rows_at([0.5, 1.0], ""), 1);
}

#[test]
fn three_bodies_at_a_junction_and_two_at_a_corner() {
    // A wide body over two narrow ones: at (1, 1) every pair shares a face end.
    let text = "
[[body]]
name = \"lid\"
origin = [0, 1]
size = [2, 1]
elements = [4, 2]
[[body]]
name = \"a\"
size = 1
elements = 2
[[body]]
name = \"b\"
origin = [1, 0]
size = 1
elements = 2
";
    let scene = Scene::parse("t.toml", text).unwrap();
    let points = scene.rows.chunk_by(|a, b| a.block == b.block);
    let rows: Vec<usize> = points.map(|of_point| of_point.len()).collect();
    assert_eq!(rows.iter().sum::<usize>(), 2 + 3 + 2 + 2);
    assert_eq!(rows.iter().filter(|&&r| r == 3).count(), 1);
    // Two bodies that meet in one corner only.
    let text = "
[[body]]
name = \"a\"
size = 1
elements = 2
[[body]]
name = \"b\"
origin = [1, 1]
size = 1
elements = 3
";
    let scene = Scene::parse("t.toml", text).unwrap();
    let rows = scene.solver_rows(&|_| true);
    assert_eq!(rows.len(), 1);
    assert_eq!(rows[0].terms, [(8, 1.0), (9, -1.0)]);
    assert_eq!(rows[0].block, 8);
}

#[test]
fn ten_thousand_bodies_are_no_trouble() {
    let scene = Scene::lee(100, 2, 2, Faces::Whole).unwrap();
    let plan = scene.plan();
    // 99² cross points with six rows; 2 · 99 · 100 faces with three more nodes each.
    assert_eq!(plan.global_multipliers, 6 * 99 * 99 + 3 * 2 * 99 * 100);
    assert_eq!(plan.assembled, 399 * 399);
}

#[test]
fn the_rest_of_a_partly_tied_face_is_open() {
    let scene = Scene::load("../../examples/scenes/partly_tied.toml").unwrap();
    let rows = scene.solver_rows(&|_| true);
    // 17 nodes on each face, nothing given on them; nine and three are tied.
    assert_eq!(rows.len(), 34);
    assert_eq!(rows.iter().filter(|r| r.holds).count(), 12);
    // Where the default is "free", a face without an entry has no candidates, and neither has one with "none".
    let grid =
        "[grid]\nbodies = [3, 1]\nsize = [3, 1]\nelements = 4\n[interface]\ndefault = \"free\"\n";
    let tie = "[[tie]]\nbodies = [\"b0_0\", \"b1_0\"]\nnodes = [2]\n";
    let none = "[[tie]]\nbodies = [\"b1_0\", \"b2_0\"]\nwhere = \"none\"\n";
    for more in ["", none] {
        let scene = Scene::parse("t.toml", &format!("{grid}{tie}{more}")).unwrap();
        let rows = scene.solver_rows(&|_| true);
        assert_eq!((rows.len(), scene.plan().open_rows), (5, 4));
        assert!(rows.iter().all(|r| r.terms[1].0 < 50));
    }
}

#[test]
fn lees_experiment_agrees_with_a_second_implementation() {
    for (bodies, subdomains, elements) in [(2, 2, 2), (3, 2, 4), (2, 3, 6)] {
        for (third, faces) in [(false, Faces::Whole), (true, Faces::MiddleThird)] {
            let ours = Scene::lee(bodies, subdomains, elements, faces)
                .unwrap()
                .substructures(&|_| true)
                .unwrap();
            let other =
                common::Grid::lee(bodies, subdomains, elements, third).substructures(|_| true);
            for (a, b) in ours.local.iter().zip(&other.local) {
                assert_eq!((a.index, a.body), (b.index, b.body));
                assert_eq!((&a.primal, &a.rho), (&b.primal, &b.rho));
                assert_eq!((&a.k.row_ptr, &a.k.col), (&b.k.row_ptr, &b.k.col));
                let close =
                    |x: &[f64], y: &[f64]| x.iter().zip(y).all(|(x, y)| (x - y).abs() < 1e-14);
                assert!(close(&a.k.val, &b.k.val) && close(&a.f, &b.f));
            }
            assert_eq!(named_rows(&ours), named_rows(&other));
        }
    }
}

/// Terms as (subdomain, local dof, coefficient), and whether the row holds.
type NamedRow = (Vec<(usize, usize, i32)>, bool);

/// The rows, with every dof given as (lowest subdomain that has it, local dof there), sorted.
fn named_rows(problem: &Problem) -> Vec<NamedRow> {
    let mut name: HashMap<u64, (usize, usize)> = HashMap::new();
    for s in &problem.local {
        for (k, &dof) in s.dofs.iter().enumerate() {
            name.entry(dof).or_insert((s.index, k));
        }
    }
    let mut rows: Vec<_> = problem
        .rows
        .iter()
        .map(|r| {
            let terms = r
                .terms
                .iter()
                .map(|&(dof, c)| (name[&dof].0, name[&dof].1, c as i32));
            (terms.collect(), r.holds)
        })
        .collect();
    rows.sort();
    rows
}

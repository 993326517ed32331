//! Unit tests of `crates/scene/src/part.rs`.

use super::*;
use crate::Scene;
use std::path::Path;

/// The blocks of all ranks.
fn blocks(works: &[f64], ranks: usize) -> Vec<Range<usize>> {
    let starts = by_work(works, ranks);
    starts.windows(2).map(|ends| ends[0]..ends[1]).collect()
}

#[test]
fn blocks_follow_each_other_and_weigh_about_the_same() {
    let mut state = 12345u64;
    let mut draw = || {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (state >> 33) as f64 / 2f64.powi(31)
    };
    for n in [5, 17, 100] {
        let works: Vec<f64> = (0..n).map(|_| 1.0 + 20.0 * draw()).collect();
        let total: f64 = works.iter().sum();
        for ranks in [1, 2, 4, 5] {
            let found = blocks(&works, ranks);
            assert_eq!((found[0].start, found[ranks - 1].end), (0, n));
            assert!(
                found.windows(2).all(|w| w[0].end == w[1].start),
                "{found:?}"
            );
            for block in &found {
                assert!(!block.is_empty(), "{found:?}");
                let work: f64 = works[block.clone()].iter().sum();
                // Both ends lie within half an item of where they should.
                let fair = total / ranks as f64;
                assert!(
                    (work - fair).abs() <= 21.0 || block.len() == 1,
                    "{work} beside {fair}"
                );
            }
        }
    }
    // One item of most of the work does not leave ranks without any.
    let heavy = [1.0, 1.0, 100.0, 1.0];
    assert_eq!(blocks(&heavy, 4), [0..1, 1..2, 2..3, 3..4]);
    assert_eq!(blocks(&heavy, 2), [0..2, 2..4]);
    // Few items, many ranks.
    assert_eq!(blocks(&[1.0, 5.0], 4), [0..1, 1..2, 2..2, 2..2]);
}

#[test]
fn bodies_of_a_mesh_are_dealt_out_by_work() {
    let scene = Scene::load("../../examples/gallery/roller_bearing.toml").expect("a scene");
    let works = |s: usize| {
        let (body, inside) = scene.body_of(s);
        let body = &scene.bodies[body];
        ((body.components * body.mesh().subdomain_nodes(inside).len()) as f64).powf(WORK)
    };
    let all: Vec<f64> = (0..scene.n_subdomains()).map(works).collect();
    let largest = all.iter().copied().fold(0.0, f64::max);
    let fair = all.iter().sum::<f64>() / 2.0;
    let first: f64 = all[share(&scene.bodies, 2, 0)].iter().sum();
    assert!(
        (first - fair).abs() <= 0.5 * largest,
        "{first} of {}",
        2.0 * fair
    );
    // Boxes are dealt out by number, as programs expect that use `fetifeti::share`.
    let boxes = Scene::load("../../examples/scenes/unequal_bodies.toml").expect("a scene");
    let n = boxes.n_subdomains();
    for rank in 0..3 {
        assert_eq!(share(&boxes.bodies, 3, rank), contiguous_share(n, 3, rank));
    }
}

#[test]
fn ranks_of_a_body_are_those_that_own_a_subdomain_of_it() {
    for file in [
        "../../examples/gallery/roller_bearing.toml",
        "../../examples/scenes/unequal_bodies.toml",
    ] {
        let scene = Scene::load(file).expect("a scene");
        for (ranks, cyclic) in [(1, false), (3, false), (3, true), (40, false)] {
            let part = |rank| RankPart {
                cyclic,
                ranks,
                rank,
            };
            let owners: Vec<_> = (0..ranks).map(|r| part(r).owns(&scene.bodies)).collect();
            let ranks_of = part(0).ranks_of(&scene.bodies);
            for (b, body) in scene.bodies.iter().enumerate() {
                let first = body.first_subdomain;
                let mut own = first..first + body.mesh().n_subdomains();
                let has = |r: &usize| own.clone().any(&owners[*r]);
                let expected: Vec<usize> = (0..ranks).filter(has).collect();
                assert_eq!(ranks_of(b), expected, "{file}: {b} on {ranks}");
                assert!(own.next().is_some());
            }
        }
    }
}

#[test]
fn parts_have_the_rows_of_the_whole() {
    let files = [
        "../../examples/scenes/poisson_2x2.toml",
        "../../examples/scenes/partly_tied.toml",
        "../../examples/scenes/unequal_bodies.toml",
        "../../examples/scenes/obstacle.toml",
        "../../examples/scenes/blocks_3d.toml",
        "../../examples/scenes/spheres.toml",
        "../../examples/scenes/mortar_2d.toml",
    ];
    for file in files {
        let whole = Scene::load(file).expect(file);
        assert!(whole.is_whole);
        for ranks in [2, 3, 5] {
            for cyclic in [false, true] {
                let mut rows = 0;
                for rank in 0..ranks {
                    let wanted = RankPart {
                        cyclic,
                        ranks,
                        rank,
                    };
                    let part = Scene::load_if(Path::new(file), false, |_| Ok(wanted)).expect(file);
                    let owns = wanted.owns(&whole.bodies);
                    let written = |s: &Scene| format!("{:?}", s.solver_rows(&owns));
                    assert_eq!(written(&part), written(&whole), "{file}");
                    assert_eq!(part.dofs(), whole.dofs(), "{file}");
                    let given = |s: &Scene| -> Vec<_> {
                        s.bodies.iter().map(|b| b.prescribed.clone()).collect()
                    };
                    assert_eq!(given(&part), given(&whole), "{file}");
                    assert_eq!(part.notes, whole.notes);
                    let own = |b: usize| {
                        let first = whole.bodies[b].first_subdomain;
                        (first..first + whole.bodies[b].mesh().n_subdomains()).any(&owns)
                    };
                    let contact = |s: &Scene| s.sides_that_may_touch(own);
                    assert_eq!(contact(&part), contact(&whole), "{file}");
                    rows += part.solver_rows(&owns).len();
                    // Rows that lead from point to point need all points.
                    assert_eq!(part.is_whole, file.contains("mortar"), "{file}");
                    let all = part.solver_rows(&|_| true).len();
                    assert!(part.is_whole || all == part.solver_rows(&owns).len());
                }
                assert_eq!(rows, whole.solver_rows(&|_| true).len(), "{file}");
            }
        }
    }
}

/// Four squares around a point, with gaps between them. Entries lead from `a` to `b`, to `c` and to `d`, but not from
/// `d` to `a`; the side of `d` on which u is given has the corner at the point.
fn around_a_point(kind: &str) -> String {
    let mut text = String::from("physics = \"scalar\"\n");
    let squares = [
        ("a", [0.0, 0.0]),
        ("b", [1.25, 0.0]),
        ("c", [1.25, 1.25]),
        ("d", [0.0, 1.25]),
    ];
    for (name, [x, y]) in squares {
        let held = if name == "d" {
            "dirichlet = [\"right\"]\n"
        } else {
            ""
        };
        text += &format!("[[body]]\nname = \"{name}\"\norigin = [{x}, {y}]\nsize = [1, 1]\n");
        text += &format!("elements = [2, 2]\nsubdomains = [2, 1]\n{held}");
    }
    for (bodies, sides) in [
        (["a", "b"], ["right", "left"]),
        (["b", "c"], ["top", "bottom"]),
        (["d", "c"], ["right", "left"]),
    ] {
        text += &format!("[[{kind}]]\nbodies = {bodies:?}\nsides = {sides:?}\n");
    }
    text
}

#[test]
fn points_and_given_values_are_found_by_way_of_bodies_in_between() {
    for kind in ["tie", "contact"] {
        let name = format!("fetifeti-{kind}-{}.toml", std::process::id());
        let path = std::env::temp_dir().join(name);
        std::fs::write(&path, around_a_point(kind)).expect("a file");
        let whole = Scene::load(&path).expect("a scene");
        let most = whole.points.iter().map(|p| p.members.len()).max();
        assert_eq!(most, Some(4), "{kind}");
        let given =
            |s: &Scene| -> Vec<_> { s.bodies.iter().map(|b| b.prescribed.clone()).collect() };
        assert_eq!(given(&whole)[0].len(), usize::from(kind == "tie"));
        for ranks in [2, 3, 4, 8] {
            for rank in 0..ranks {
                let wanted = RankPart {
                    cyclic: false,
                    ranks,
                    rank,
                };
                let part = Scene::load_if(&path, false, |_| Ok(wanted)).expect("a part");
                let owns = wanted.owns(&whole.bodies);
                let points = whole.points.iter().filter(|p| owns(p.subdomain));
                assert!(part.points.iter().eq(points), "{kind}: {rank} of {ranks}");
                let rows = whole.rows_of(&owns);
                assert!(part.rows.iter().eq(rows), "{kind}: {rank} of {ranks}");
                assert_eq!(given(&part), given(&whole), "{kind}: {rank} of {ranks}");
            }
        }
        std::fs::remove_file(&path).expect("it was there");
    }
}

#[test]
fn parts_know_the_interfaces_of_their_bodies_and_rows() {
    let file = "../../examples/scenes/arch_stands.toml";
    let whole = Scene::load(file).expect(file);
    assert!(whole.interfaces.len() > 10);
    let ranks = 4;
    for rank in 0..ranks {
        let part = RankPart {
            cyclic: false,
            ranks,
            rank,
        };
        let scene = Scene::load_if(Path::new(file), false, |_| Ok(part)).expect(file);
        assert_eq!(scene.interfaces.len(), whole.interfaces.len());
        let known: Vec<(usize, &BodyInterface)> = scene.interfaces.numbered().collect();
        // The first rank reports all.
        assert_eq!(known.len() == whole.interfaces.len(), rank == 0, "{rank}");
        let rows = scene.rows.iter();
        let used: HashSet<RowSource> = rows.map(|row| row.source).collect();
        let share = share(&scene.bodies, ranks, rank);
        let own = |&body: &usize| share.contains(&scene.bodies[body].first_subdomain);
        for (k, interface) in whole.interfaces.numbered() {
            let needs = interface.bodies.iter().any(own) || used.contains(&RowSource::Interface(k));
            if needs {
                assert_eq!(&scene.interfaces[k], interface, "{rank}: {k}");
            }
            assert!(rank == 0 || needs == known.iter().any(|(n, _)| *n == k));
        }
    }
}

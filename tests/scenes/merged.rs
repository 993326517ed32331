//! Bodies that are tied for good are one body of the method. They keep their names, rows and forces, and the answer is
//! that of the rows.

use std::collections::HashMap;

use super::meshes::Model;
use crate::support::checks::identities;
use crate::support::session::with_session;
use fetifeti::problem::Numbers;
use fetifeti::settings::{MergeKind, MethodSettings};
use fetifeti::{FetiFeti, Problem, Solution};
use petsc::Session;
use scene::{Scene, Stepper};

fn settings(merge: MergeKind) -> MethodSettings {
    MethodSettings::default().rtol(1e-11).merge(merge)
}

fn example(name: &str) -> Scene {
    Scene::load(format!("../../examples/scenes/{name}.toml")).expect("a scene")
}

fn solver(session: &Session, scene: &Scene, merge: MergeKind) -> FetiFeti {
    let problem = scene.substructures(&|_| true).expect("substructures");
    FetiFeti::new(session, problem, settings(merge)).expect("set up")
}

/// ‖f − K u − Bᵀ λ‖ over the body dofs, relative to ‖Bᵀ λ‖: the multipliers that come back are those of the problem as
/// it was given.
fn unbalanced(problem: &Problem, solution: &Solution) -> f64 {
    let mut left: HashMap<u64, f64> = HashMap::new();
    for (sub, u) in problem.local.iter().zip(&solution.u) {
        let mut ku = vec![0.0; u.len()];
        sub.k.mul(u, &mut ku);
        for (dof, (f, ku)) in sub.dofs.iter().zip(sub.f.iter().zip(ku)) {
            *left.entry(*dof).or_default() += f - ku;
        }
    }
    let mut forces: HashMap<u64, f64> = HashMap::new();
    for (row, solved) in problem.rows.iter().zip(solution.rows()) {
        for (dof, value) in &row.terms {
            *forces.entry(*dof).or_default() += value * solved.multiplier;
        }
    }
    let size: f64 = forces.values().map(|v| v * v).sum();
    forces
        .into_iter()
        .for_each(|(dof, v)| *left.entry(dof).or_default() -= v);
    let rest: f64 = left.values().map(|v| v * v).sum();
    (rest / size).sqrt()
}

/// The largest distance of two vectors, relative to the second.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let size = b.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    let away = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    away.fold(0.0, f64::max) / size
}

/// Scenes in the plane and in space, scalar and elastic, with jumps of coefficients, and beside contact. The last
/// number is that of the groups.
#[test]
fn tied_boxes_are_one_and_keep_their_forces() {
    for (name, groups) in [
        ("unequal_bodies", 1),
        ("beam_2d", 1),
        ("cube_3d", 1),
        ("coefficients_channels", 1),
        ("contact_grid_100", 90),
        ("wall", 189),
    ] {
        with_session(move |session| {
            let scene = example(name);
            let found = [MergeKind::None, MergeKind::Ties].map(|merge| {
                let mut solver = solver(session, &scene, merge);
                identities(&solver, 1e-6, name);
                let solution = solver.solve().expect("solved");
                assert!(solution.converged(), "{name}: {}", solution.status);
                let left = unbalanced(solver.problem(), &solution);
                // Stiffnesses of 1 and 10⁶ side by side have forces that cancel.
                let bound = [1e-7, 1e-5][usize::from(name == "coefficients_channels")];
                assert!(left < bound, "{name}: {left}");
                (solution, solver.n_groups())
            });
            let [(rows, n), (merged, m)] = found;
            assert_eq!((n, m), (scene.n_bodies(), groups), "{name}");
            assert_eq!(rows.rows().len(), merged.rows().len(), "{name}");
            let away = apart(&merged.u.concat(), &rows.u.concat());
            assert!(away < 1e-7, "{name}: {away}");
            let energies = [merged.energy, rows.energy];
            let away = (energies[0] - energies[1]).abs() / energies[1].abs();
            assert!(away < 1e-10, "{name}: {energies:?}");
            // Fewer jumps are left to iterate on.
            let iterations = [merged.iterations, rows.iterations];
            assert!(iterations[0] <= iterations[1], "{name}: {iterations:?}");
        });
    }
}

/// Lines in the plane between all subdomains of a group are averaged, which rows of bodies in the plane have not.
#[test]
fn the_spectrum_is_that_of_one_body() {
    with_session(|session| {
        for (name, bound) in [
            ("unequal_bodies", 1.5),
            ("model_tied", 1.6),
            ("cube_3d", 1.6),
        ] {
            let scene = example(name);
            let kappa = [MergeKind::None, MergeKind::Ties].map(|merge| {
                let spectrum = solver(session, &scene, merge).spectrum().expect("solved");
                spectrum.expect("it has multipliers").kappa()
            });
            assert!(kappa[1] < bound && bound < kappa[0], "{name}: {kappa:?}");
        }
    });
}

/// Ties of a part of a face, of sides whose nodes do not match, and contact stay rows.
#[test]
fn other_joints_stay_rows() {
    with_session(|session| {
        for name in ["partly_tied", "mortar_2d", "model_contact", "press_ramp"] {
            let scene = example(name);
            let solver = solver(session, &scene, MergeKind::Ties);
            assert_eq!(solver.n_groups(), scene.n_bodies(), "{name}");
            assert_eq!(solver.n_merged_rows(), 0, "{name}");
        }
    });
}

/// Three bars of cells in a row, each a group of 2 × 2 × 3 cells; nodes inside are moved, so that nothing repeats.
fn bars() -> String {
    const N: [usize; 3] = [2, 2, 3];
    let (nx, bars) = (N[0] * 3, 3);
    let node = |i: usize, j: usize, k: usize| 1 + i + (nx + 1) * (j + (N[1] + 1) * k);
    let mut out = String::from("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n5\n");
    out += "2 1 \"left\"\n2 2 \"right\"\n";
    (0..bars).for_each(|b| out += &format!("3 {} \"b{b}\"\n", 10 + b));
    let nodes = (nx + 1) * (N[1] + 1) * (N[2] + 1);
    out += &format!("$EndPhysicalNames\n$Nodes\n{nodes}\n");
    for k in 0..=N[2] {
        for j in 0..=N[1] {
            for i in 0..=nx {
                let at = [(i, nx), (j, N[1]), (k, N[2])];
                let inside = at.iter().all(|(i, n)| (1..*n).contains(i)) && i % N[0] != 0;
                let shift =
                    [0.0, 0.1 * ((3 * i + 5 * j + 7 * k) as f64).sin()][usize::from(inside)];
                let at = [i, j, k].map(|i| 0.5 * i as f64 + shift);
                out += &format!("{} {} {} {}\n", node(i, j, k), at[0], at[1], at[2]);
            }
        }
    }
    let ring = [[0, 0], [1, 0], [1, 1], [0, 1]];
    let mut elements = Vec::new();
    for (k, j) in (0..N[2]).flat_map(|k| (0..N[1]).map(move |j| (k, j))) {
        for (tag, i) in [(1, 0), (2, nx)] {
            let list = ring.map(|[a, b]| node(i, j + a, k + b).to_string());
            elements.push(format!("3 2 {tag} {tag} {}", list.join(" ")));
        }
        for i in 0..nx {
            let tag = 10 + i / N[0];
            let corner = |c: usize| ring.map(|[a, b]| node(i + a, j + b, k + c).to_string());
            let list = [corner(0), corner(1)].concat().join(" ");
            elements.push(format!("5 2 {tag} {tag} {list}"));
        }
    }
    out += &format!("$EndNodes\n$Elements\n{}\n", elements.len());
    for (k, element) in elements.iter().enumerate() {
        out += &format!("{} {element}\n", k + 1);
    }
    out + "$EndElements\n"
}

fn of_bars(more: &str) -> String {
    let body = |b: usize, more: &str| {
        let young = [10.0, 1000.0, 30.0][b];
        format!(
            "[[body]]\nname = \"b{b}\"\nyoung = {young}\npoisson = 0.3\nsubdomains = {}\n{more}\n",
            b + 2
        )
    };
    format!(
        "dimension = 3\nphysics = \"elasticity\"\n[mesh]\nfile = \"m.msh\"\n{}{}{}{more}",
        body(0, "dirichlet = { left = 0 }"),
        body(1, "load = [0, 0, -0.1]"),
        body(2, "traction = { right = [0.1, 0, 0.3] }"),
    )
}

/// Meshes in space are merged without an option; the plug-in's bodies, of which no positions are known, are not.
#[test]
fn meshes_are_merged_by_default() {
    let scene = Model::new("merged-bars", &bars()).scene(&of_bars(""));
    with_session(move |session| {
        let found = [MergeKind::Auto, MergeKind::Ties, MergeKind::None].map(|merge| {
            let mut solver = solver(session, &scene, merge);
            identities(&solver, 1e-7, "bars");
            let solution = solver.solve().expect("solved");
            assert!(solution.converged(), "{}", solution.status);
            let left = unbalanced(solver.problem(), &solution);
            assert!(left < 1e-7, "{left}");
            (solution, solver.n_groups(), solver.facts().kernel_dimension)
        });
        let [(auto, 1, 0), (merged, 1, 0), (rows, 3, 12)] = &found else {
            panic!("{:?}", found.each_ref().map(|f| (f.1, f.2)));
        };
        assert_eq!(auto.iterations, merged.iterations);
        for (row, other) in auto.rows().iter().zip(rows.rows()) {
            assert_eq!(row.label.source, other.label.source);
        }
        let away = apart(&auto.u.concat(), &rows.u.concat());
        assert!(away < 1e-7, "{away}");
        let mut problem = scene.substructures(&|_| true).expect("substructures");
        problem.local.iter_mut().for_each(|s| s.coordinates = None);
        let solver = FetiFeti::new(session, problem, settings(MergeKind::Ties));
        assert_eq!(solver.expect("set up").n_groups(), 3);
    });
}

/// Other loads, rows and matrices on a set-up with merged bodies have the answer of a new one.
#[test]
fn what_changes_reaches_merged_bodies() {
    let scene = Model::new("merged-again", &bars()).scene(&of_bars(""));
    with_session(move |session| {
        let problem = scene.substructures(&|_| true).expect("substructures");
        let keeping = settings(MergeKind::Ties).keeps_analyses(true);
        let mut solver = FetiFeti::new(session, problem.clone(), keeping).expect("set up");
        let first = solver.solve().expect("solved");
        let gaps: Vec<f64> = problem.rows.iter().map(|r| r.gap).collect();
        let twice = problem
            .local
            .iter()
            .map(|s| s.f.iter().map(|f| 2.0 * f).collect());
        solver.set_loads(twice.collect(), &gaps);
        let second = solver.solve().expect("solved");
        let half: Vec<f64> = second.u.concat().iter().map(|u| 0.5 * u).collect();
        assert!(apart(&half, &first.u.concat()) < 1e-8);
        assert!(unbalanced(solver.problem(), &second) < 1e-7);

        // One tie of three components fewer: what is merged cannot come apart on a set-up.
        let all = problem.rows.clone();
        let some = all[3..].to_vec();
        let refused = solver.set_rows(some, Vec::new()).expect_err("refused");
        let message = refused.to_string();
        assert!(message.contains("-fetifeti_merge none"), "{message}");
        solver.set_rows(all, Vec::new()).expect("the same rows");

        let stiffer: Vec<_> = { problem.local.iter() }
            .map(|s| {
                let entries = (0..s.k.n()).flat_map(|i| s.k.row(i).1);
                Numbers::new(entries.map(|v| 2.0 * v).collect(), s.rho.clone())
            })
            .collect();
        let renewed = solver.renewed(stiffer, None).expect("set up");
        let mut solver = renewed.expect("no new motions");
        let third = solver.solve().expect("solved");
        assert!(apart(&third.u.concat(), &half) < 1e-8);
        assert!(unbalanced(solver.problem(), &third) < 1e-7);
    });
}

/// Two blocks on a plate, tied to it and in contact with each other: where the three meet, the row of the contact is
/// between dofs that the ties make one.
#[test]
fn contact_beside_two_ties() {
    let block = |name: &str, x: f64, more: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\norigin = [{x}, 0.5]\nsize = [1, 1]\nelements = 4\nyoung = 1\n\
             poisson = 0.3\n{more}\n[[tie]]\nbodies = [\"plate\", \"{name}\"]\n"
        )
    };
    for friction in ["", "friction = 0.3\n"] {
        let text = format!(
            "physics = \"elasticity\"\n[[body]]\nname = \"plate\"\nsize = [2, 0.5]\nelements = [8, 2]\nyoung = 1\n\
             poisson = 0.3\ndirichlet = {{ bottom = 0 }}\n{}{}[[contact]]\nbodies = [\"a\", \"c\"]\n{friction}",
            block("a", 0.0, "traction = { left = [0.1, 0] }"),
            block("c", 1.0, ""),
        );
        with_session(move |session| {
            let scene = Scene::parse("merged.toml", &text).expect("a scene");
            let [rows, merged] = [MergeKind::None, MergeKind::Ties].map(|merge| {
                let mut solver = solver(session, &scene, merge);
                assert_eq!(
                    solver.n_groups(),
                    [3, 1][usize::from(merge == MergeKind::Ties)]
                );
                let solution = solver.solve().expect("solved");
                assert!(solution.converged(), "{}", solution.status);
                solution.u.concat()
            });
            assert!(apart(&merged, &rows) < 1e-6, "{}", apart(&merged, &rows));
        });
    }
}

/// Two tied blocks that a load in steps pushes along a plane: the history of friction belongs to the right rows.
#[test]
fn friction_beside_merged_bodies() {
    let block = |name: &str, x: f64, more: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\norigin = [{x}, 0]\nsize = [1, 1]\nelements = 6\nsubdomains = [2, 1]\n\
             young = 1\npoisson = 0.3\n{more}\n[[obstacle]]\nbody = \"{name}\"\nside = \"bottom\"\n\
             plane = {{ point = [0, 0], normal = [0, 1] }}\nfriction = 0.3\n"
        )
    };
    let text = format!(
        "physics = \"elasticity\"\n{}{}[steps]\ntimes = [0.25, 0.5, 0.75, 1.0]\n\
         load = \"if(t<=0.5, 2*t, 1.6-1.2*t)\"\n",
        block("a", 0.0, "traction = { top = [0.024, -0.1] }"),
        block("b", 1.0, "traction = { top = [0.02, -0.08] }"),
    );
    with_session(move |session| {
        let steps = [MergeKind::None, MergeKind::Ties].map(|merge| {
            let scene = Scene::parse("merged.toml", &text).expect("a scene");
            let solver = solver(session, &scene, merge);
            let groups = solver.n_groups();
            let stepper = Stepper::with_solver(scene, solver).expect("a stepper");
            let u = stepper.map(|s| s.expect("a step").solution.u.concat());
            (groups, u.collect::<Vec<_>>())
        });
        let [(2, rows), (1, merged)] = &steps else {
            panic!("{} and {} groups", steps[0].0, steps[1].0);
        };
        assert_eq!((rows.len(), merged.len()), (4, 4));
        for (u, v) in merged.iter().zip(rows) {
            assert!(apart(u, v) < 1e-6, "{}", apart(u, v));
        }
        // The way back is not the way there: friction has a history.
        assert!(apart(&rows[0], &rows[3]) > 1e-3);
    });
}

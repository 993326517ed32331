//! Friction against closed forms.

use crate::support::session::with_session;
use crate::support::{mpi, program};
use fetifeti::error::ErrorKind;
use fetifeti::settings::MethodSettings;
use fetifeti::solution::RowState;
use fetifeti::{FetiFeti, Result};
use mpi::Scratch;
use program::run_fetifeti;
use scene::{Scene, Stepper};

pub fn near(a: f64, b: f64, size: f64, what: &str) {
    assert!((a - b).abs() <= size, "{what}: {a} and {b}");
}

/// A block on a plane that a force pulls along: tan α is the pull over the weight.
fn incline(pull: f64, friction: &str) -> String {
    format!(
        "physics = \"elasticity\"\n[[body]]\nname = \"block\"\nsize = [2, 1]\nelements = [8, 4]\nsubdomains = [2, 2]\n\
         young = 1\npoisson = 0.3\nload = [{pull}, -0.1]\n[[obstacle]]\nbody = \"block\"\nside = \"bottom\"\n\
         plane = {{ point = [0, 0], normal = [0, 1] }}\n{friction}\n"
    )
}

pub fn solved(text: impl Into<String>) -> Result<fetifeti::Solution> {
    let text = text.into();
    with_session(move |session| {
        let scene = Scene::parse("friction.toml", &text)?;
        let mut stepper = Stepper::new(session, scene)?;
        Ok(stepper.next().expect("a step")?.solution)
    })
}

/// It stands if and only if tan α ≤ μ; where it does not, the error names it and its motion.
#[test]
fn a_block_on_an_incline_stands_up_to_its_friction() {
    for (pull, stands) in [
        (0.0, true),
        (0.02, true),
        (0.0299, true),
        (0.0301, false),
        (0.05, false),
    ] {
        let found = solved(incline(pull, "friction = 0.3"));
        if stands {
            let solution = found.expect("it stands");
            assert!(solution.converged(), "{pull}: {}", solution.status);
            let rows = solution.tangential_rows();
            let drag: f64 = rows.iter().map(|r| r.multiplier * r.normal()[0]).sum();
            near(drag, 2.0 * pull, 1e-6, "friction");
        } else {
            let error = found.map(|s| s.status).expect_err("it slides");
            assert_eq!(error.kind(), ErrorKind::Input);
            let text = error.to_string();
            assert!(
                text.contains("\"block\"") && text.contains("slides along x"),
                "{text}"
            );
        }
    }
}

/// Near the angle of friction all nodes but one slip. On the way there the forces of friction may be larger than the
/// load, and then push the block up: no reason to refuse it.
#[test]
fn a_block_of_second_order_stands_near_the_angle_of_friction() {
    for (part, n) in [
        (0.99999, 16),
        (0.999_999_9, 8),
        (0.999_999_9, 16),
        (1.00001, 16),
    ] {
        let (pull, wide) = (0.3 * part, 2 * n);
        let found = solved(format!(
            "physics = \"elasticity\"\norder = 2\n[[body]]\nname = \"block\"\nsize = [2, 1]\n\
             elements = [{wide}, {n}]\nsubdomains = [2, 1]\nyoung = 1000\npoisson = 0.3\nload = [{pull}, -1]\n\
             [[obstacle]]\nbody = \"block\"\nside = \"bottom\"\nplane = {{ point = [0, 0], normal = [0, 1] }}\n\
             friction = 0.3\n"
        ));
        let Ok(solution) = found else {
            assert!(part > 1.0, "{part}, {n} elements");
            continue;
        };
        assert!(
            part < 1.0 && solution.converged(),
            "{part}: {}",
            solution.status
        );
        let rows = solution.tangential_rows();
        let drag: f64 = rows.iter().map(|r| r.multiplier * r.normal()[0]).sum();
        near(drag, 2.0 * pull, 1e-6, "friction");
    }
}

/// Contacts that `auto` finds have its law, in the plane and in space: a block stands on another one up to its
/// friction, and has the forces of one whose contact is written out. A law of soft contact gives way.
#[test]
fn contact_that_is_found_has_its_law() {
    let blocks = |dim: usize, pull: f64, contact: &str| {
        let (depth, z) = if dim == 3 { (", 1", ", 0") } else { ("", "") };
        let mesh = |n: usize| {
            if dim == 3 {
                format!("[{n}, 2, 2]")
            } else {
                format!("[{n}, 4]")
            }
        };
        format!(
            "dimension = {dim}\nphysics = \"elasticity\"\n[interface]\ndefault = \"free\"\n\
             [[body]]\nname = \"base\"\nsize = [4, 1{depth}]\nelements = {}\nyoung = 10\npoisson = 0.3\n\
             dirichlet = [\"bottom\"]\n[[body]]\nname = \"block\"\norigin = [1, 1{z}]\nsize = [2, 1{depth}]\n\
             elements = {}\nyoung = 1\npoisson = 0.3\nload = [{pull}, -0.1{z}]\n{contact}\n",
            mesh(8),
            mesh(4)
        )
    };
    let forces = |text: String| {
        let solution = solved(text).expect("it stands");
        assert!(solution.converged(), "{}", solution.status);
        let along = |r: &fetifeti::solution::SolvedRow| r.multiplier * r.normal()[0];
        let drag: f64 = solution.tangential_rows().iter().map(along).sum();
        let normal: f64 = solution.rows().iter().map(|r| r.multiplier).sum();
        (drag, normal, solution.energy)
    };
    for (dim, pull) in [(2, 0.0295), (3, 0.0295)] {
        let (auto, written) = (
            "[contact]\nauto = true",
            "[[contact]]\nbodies = [\"base\", \"block\"]",
        );
        for law in ["friction = 0.3", "friction = 0.5\nfriction_limit = 0.1"] {
            let found = forces(blocks(dim, pull, &format!("{auto}\n{law}")));
            let named = forces(blocks(dim, pull, &format!("{written}\n{law}")));
            near(found.0.abs(), 2.0 * pull, 1e-6, law);
            near(found.1, 0.2, 1e-6, law);
            near(found.2, named.2, 1e-8, law);
        }
        let slides = solved(blocks(dim, 0.0305, &format!("{auto}\nfriction = 0.3")));
        let error = slides.map(|s| s.status).expect_err("it slides").to_string();
        assert!(error.contains("\"block\""), "{error}");
        assert!(error.contains("slides along x"), "{error}");
        let hard = forces(blocks(dim, 0.0, auto)).2;
        let soft = format!("{auto}\nstiffness = 4\ntresca = 0.01\nstick_stiffness = 2");
        assert!(forces(blocks(dim, 0.0, &soft)).2 < hard - 1e-4);
    }
}

/// SMALBE names a body that slides away, too, by either law, and says what has not come to an end.
#[test]
fn smalbe_says_what_has_no_end() {
    let scratch = Scratch::new("friction-smalbe-end");
    let run = |pull: f64, law: &str, more: &[&str]| {
        let scene = scratch.file("scene.toml", &incline(pull, law));
        let kind = ["-fetifeti_contact_type", "smalbe"];
        let arguments = [&["solve", &scene, "--json", "-"][..], &kind, more].concat();
        run_fetifeti(1, &arguments)
    };
    for law in ["friction = 0.3", "tresca = 0.03"] {
        assert_eq!(run(0.0299, law, &[]).code, 0, "{law}");
        let slides = run(0.0301, law, &[]);
        let text = slides.all();
        assert_eq!(slides.code, 2, "{law}: {text}");
        let named = text.contains("\"block\"") && text.contains("slides along x");
        assert!(named, "{law}: {text}");
    }
    let stopped = run(0.0299, "friction = 0.3", &["-fetifeti_contact_max_it", "2"]);
    assert_eq!(stopped.code, 1, "{}", stopped.all());
    assert!(stopped.all().contains("DIVERGED_CONTACT_ITS"));
}

/// A bound that does not depend on the pressure, and a limit of Coulomb's: forces are at most s times the area.
#[test]
fn bounds_of_the_shear_stress_are_kept() {
    let slipping = |friction: &str| {
        let solution = solved(incline(0.02, friction)).expect("a solution");
        assert!(solution.converged(), "{}", solution.status);
        let rows = solution.tangential_rows();
        let drag: f64 = rows.iter().map(|r| r.multiplier * r.normal()[0]).sum();
        near(drag, 0.04, 1e-7, friction);
        let state = |s: RowState| rows.iter().filter(|r| r.state == s).count();
        for row in rows {
            let stress = (row.multiplier / row.label.area).abs();
            assert!(stress <= 0.0225 * (1.0 + 1e-5), "{stress}");
        }
        assert_eq!(state(RowState::Open), 0);
        (state(RowState::Sticks), state(RowState::Slips))
    };
    let (stick, slip) = slipping("tresca = 0.0225");
    assert!(stick > 0 && slip > 0);
    let (_, slip) = slipping("friction = 5\nfriction_limit = 0.0225");
    assert!(slip > 0);
}

/// Without friction, as with a coefficient of 0, nothing holds the block; with a large one it is tied.
#[test]
fn the_ends_of_friction_are_free_and_tied() {
    let text = solved(incline(0.02, "friction = 0"))
        .map(|s| s.status)
        .expect_err("it slides")
        .to_string();
    assert!(text.contains("\"block\""), "{text}");
    let tied = solved(incline(0.02, "friction = 1e3")).expect("a solution");
    assert!(tied
        .tangential_rows()
        .iter()
        .all(|r| r.state == RowState::Sticks));
    assert!(tied.tangential_rows().iter().all(|r| r.gap.abs() < 1e-6));
}

/// Soft contact and elastic slip, node by node: the pressure over the overclosure, and the shear stress over the slip.
#[test]
fn soft_rows_give_way_as_they_should() {
    let text = incline(0.01, "friction = 0.8\nstiffness = 4\nstick_stiffness = 2.5");
    let solution = solved(text).expect("a solution");
    assert!(solution.converged(), "{}", solution.status);
    for row in solution.rows() {
        let wanted = 4.0 * row.label.area * (-row.gap).max(0.0);
        near(row.multiplier, wanted, 1e-7, "pressure");
    }
    let rows = solution.tangential_rows();
    assert!(rows.iter().all(|r| r.state == RowState::Sticks));
    for row in rows {
        near(
            row.multiplier,
            2.5 * row.label.area * -row.gap,
            1e-7,
            "shear",
        );
    }
    let normal: f64 = solution.rows().iter().map(|r| r.multiplier).sum();
    near(normal, 0.2, 1e-7, "weight");
}

/// ν = 0 and a uniform pressure: the block sinks by p/k, and p/E of its height.
#[test]
fn a_soft_bed_gives_way_by_its_pressure() {
    for (dim, size, below, normal) in [
        (2, "[2, 1]", "[0, 0]", "[0, 1]"),
        (3, "[2, 1, 2]", "[0, 0, 0]", "[0, 1, 0]"),
    ] {
        let (elements, load) = match dim {
            2 => ("[4, 2]", "[0, -0.5]"),
            _ => ("[2, 2, 2]", "[0, -0.5, 0]"),
        };
        let text = format!(
            "dimension = {dim}\nphysics = \"elasticity\"\n[[body]]\nname = \"block\"\nsize = {size}\n\
             elements = {elements}\nyoung = 100\npoisson = 0\ntraction = {{ top = {load} }}\n[[obstacle]]\n\
             body = \"block\"\nside = \"bottom\"\nplane = {{ point = {below}, normal = {normal} }}\nstiffness = 8\n"
        );
        let solution = solved(text).expect("a solution");
        assert!(solution.converged(), "{dim}: {}", solution.status);
        for row in solution.rows() {
            near(row.gap, -0.5 / 8.0, 1e-7, "overclosure");
        }
        // Half the work of the load: area · (p²/k + p²/E)/2, less the whole.
        let area = if dim == 2 { 2.0 } else { 4.0 };
        near(
            solution.energy,
            -0.5 * area * (0.25 / 8.0 + 0.25 / 100.0),
            1e-7,
            "energy",
        );
    }
}

/// A load cycle that is interrupted after each step and resumed has the digits of one that is not. Search directions of
/// earlier steps, which would change the rounding, are not kept.
#[test]
fn a_resumed_cycle_has_the_same_digits() {
    with_session(|session| {
        let oracle = super::friction_oracle::oracle();
        let text = oracle["cycle"]["scene"].as_str().expect("a text");
        let stepper = || {
            let scene = Scene::parse("cycle.toml", text).expect("a scene");
            let problem = scene.substructures(&|_| true).expect("a problem");
            let solver = FetiFeti::new(session, problem, MethodSettings::default());
            Stepper::with_solver(scene, solver.expect("a set-up")).expect("a stepper")
        };
        let whole = stepper().map(|s| s.expect("a step").energy.to_bits());
        let energies: Vec<u64> = whole.collect();
        assert_eq!(energies.len(), 4);
        let mut state = None;
        for (step, energy) in energies.iter().enumerate() {
            let mut stepper = stepper().resume(state.as_ref()).expect("a state");
            let solved = stepper.next().expect("a step").expect("a solution");
            assert_eq!((solved.step, solved.energy.to_bits()), (step, *energy));
            state = stepper.checkpoint().expect("a checkpoint");
        }
    });
}

/// A block in space that is pulled along an oblique direction: it stands up to its friction, slips along the force, and
/// friction has the direction of the pull whatever the directions of its rows are.
#[test]
fn friction_in_space_is_the_same_in_all_directions() {
    let block = |pull: [f64; 2], normal: &str| {
        format!(
            "dimension = 3\nphysics = \"elasticity\"\n[[body]]\nname = \"block\"\nsize = [2, 1, 2]\n\
             elements = [4, 2, 4]\nyoung = 1\npoisson = 0.3\ntraction = {{ top = [{}, -0.1, {}] }}\n[[obstacle]]\n\
             body = \"block\"\nside = \"bottom\"\nplane = {{ point = [0, 0, 0], normal = {normal} }}\n\
             friction = 0.3\n",
            pull[0], pull[1]
        )
    };
    let mut energies = Vec::new();
    for pull in [[0.016, 0.012], [0.012, 0.016], [-0.016, 0.012]] {
        let solution = solved(block(pull, "[0, 1, 0]")).expect("a solution");
        assert!(solution.converged(), "{}", solution.status);
        let rows = solution.tangential_rows();
        for (axis, pull) in [0, 2].into_iter().zip(pull) {
            let drag: f64 = rows.iter().map(|r| r.multiplier * r.normal()[axis]).sum();
            near(drag, 4.0 * pull, 1e-6, "friction");
        }
        let slips = rows.iter().filter(|r| r.state == RowState::Slips).count();
        assert!(slips > 0 && slips < rows.len(), "{slips}");
        // A node that slips has a force of μ λ_n along its slip.
        let normal: std::collections::HashMap<_, f64> = { solution.rows().iter() }
            .map(|r| (r.label.members[0].map(|m| m.node), r.multiplier))
            .collect();
        for node in rows.chunks(2).filter(|n| n[0].state == RowState::Slips) {
            let force = [node[0].multiplier, node[1].multiplier];
            let slip = [-node[0].gap, -node[1].gap];
            let g = 0.3 * normal[&node[0].label.members[0].map(|m| m.node)];
            near(force[0].hypot(force[1]), g, 1e-5 * 0.4, "bound");
            let along = force[0] * slip[0] + force[1] * slip[1];
            near(along, g * slip[0].hypot(slip[1]), 1e-7, "direction");
        }
        energies.push(solution.energy);
    }
    near(energies[0], energies[1], 1e-8, "mirrored");
    near(energies[0], energies[2], 1e-8, "mirrored");
    let error = solved(block([0.025, 0.025], "[0, 1, 0]")).map(|s| s.status);
    let text = error.expect_err("it slides").to_string();
    // Its nodes give way one after the other, so that it turns a little, about a point that is far away.
    let moves = text.contains("slides along") || text.contains("turns about y");
    assert!(text.contains("\"block\"") && moves, "{text}");
}

/// The bound of the error, for given forces of friction at the end of the loop, against a far more exact solution. Soft
/// rows have none, and say so.
#[test]
fn the_bound_of_the_error_holds_with_friction() {
    with_session(|session| {
        let at = |friction: &str, rtol: f64| {
            let scene = Scene::parse("s.toml", &incline(0.02, friction)).expect("a scene");
            let problem = scene.substructures(&|_| true).expect("a problem");
            let settings = MethodSettings::default().rtol(rtol).certify(true);
            let mut solver = FetiFeti::new(session, problem, settings).expect("a set-up");
            let solution = solver.solve().expect("a solution");
            assert!(solution.converged(), "{friction}: {}", solution.status);
            (solver, solution)
        };
        for friction in ["tresca = 0.0225", "friction = 0.3"] {
            let (solver, rough) = at(friction, 1e-4);
            let (_, exact) = at(friction, 1e-10);
            let mut square = 0.0;
            for (sub, (a, b)) in solver
                .problem()
                .local
                .iter()
                .zip(rough.u.iter().zip(&exact.u))
            {
                let apart: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
                let mut force = vec![0.0; apart.len()];
                sub.k.mul(&apart, &mut force);
                square += apart.iter().zip(&force).map(|(u, f)| u * f).sum::<f64>();
            }
            let bound = rough.certified.expect("it was asked for").expect("a bound");
            let error = square.max(0.0).sqrt();
            // With Coulomb's law the forces of friction have an error of their own.
            let allowed = if friction.starts_with("tresca") {
                1.0
            } else {
                10.0
            };
            assert!(
                error <= allowed * bound.most,
                "{friction}: {error} {bound:?}"
            );
            assert!(bound.most < 1e-2 * bound.size, "{friction}: {bound:?}");
        }
        let (_, soft) = at("stiffness = 10\nfriction = 0.3", 1e-6);
        let why = soft.certified.expect("it was asked for").expect_err("none");
        assert!(why.text().contains("give way"), "{}", why.text());
    });
}

/// After an error in the middle of a loop in space, rows have the directions that were given: the solver goes on.
#[test]
fn a_body_that_slides_leaves_the_rows_as_they_were() {
    with_session(|session| {
        let problem = |pull: f64| {
            let text = format!(
                "dimension = 3\nphysics = \"elasticity\"\n[[body]]\nname = \"block\"\nsize = [2, 1, 2]\n\
                 elements = [4, 2, 4]\nyoung = 1\npoisson = 0.3\ntraction = {{ top = [{pull}, -0.1, {pull}] }}\n\
                 [[obstacle]]\nbody = \"block\"\nside = \"bottom\"\n\
                 plane = {{ point = [0, 0, 0], normal = [0, 1, 0] }}\nfriction = 0.3\n"
            );
            let scene = Scene::parse("s.toml", &text).expect("a scene");
            scene.substructures(&|_| true).expect("a problem")
        };
        let solver = |pull| FetiFeti::new(session, problem(pull), MethodSettings::default());
        let mut slides = solver(0.025).expect("a set-up");
        assert!(slides.solve().is_err());
        let stands = problem(0.014);
        let loads = stands.local.iter().map(|s| s.f.clone()).collect();
        let gaps: Vec<f64> = stands.rows.iter().map(|r| r.gap).collect();
        slides.set_loads(loads, &gaps);
        let after = slides.solve().expect("it stands");
        let fresh = solver(0.014).expect("a set-up").solve().expect("it stands");
        assert!(after.converged() && fresh.converged());
        near(
            after.energy,
            fresh.energy,
            1e-9 * fresh.energy.abs(),
            "energy",
        );
    });
}

/// A hub that is shrunk onto a shaft and pulled along it: friction has the force of the pull on its ring, and holds up
/// to μ times that of the fit.
#[test]
fn a_hub_holds_on_its_shaft_up_to_the_force_of_its_fit() {
    let hub = |pull: f64| {
        solved(format!(
            "physics = \"elasticity\"\nplane = \"axisymmetric\"\norder = 2\n[[body]]\nname = \"shaft\"\nsize = [1, 4]\n\
             elements = [4, 16]\nyoung = 1e4\npoisson = 0\ndirichlet = {{ bottom = {{ y = 0 }}, left = {{ x = 0 }} }}\n\
             [[body]]\nname = \"hub\"\norigin = [1, 1]\nsize = [1, 2]\nelements = [4, 8]\nyoung = 1e4\npoisson = 0\n\
             traction = {{ top = [0, {pull}] }}\n[[contact]]\nbodies = [\"shaft\", \"hub\"]\ngap = -0.002\n\
             friction = 0.3\n"
        ))
    };
    let held = hub(2.7).expect("it holds");
    assert!(held.converged(), "{}", held.status);
    let force = std::f64::consts::PI * 3.0 * 2.7;
    let rows = held.tangential_rows();
    let drag: f64 = rows.iter().map(|r| r.multiplier * r.normal()[1]).sum();
    near(drag.abs(), force, 1e-6 * force, "friction");
    let fit: f64 = held.rows().iter().map(|r| r.multiplier).sum();
    assert!(force < 0.3 * fit && 0.3 * fit < force * 4.0 / 2.7, "{fit}");
    assert!(rows.iter().any(|r| r.state == RowState::Slips));
    let text = hub(4.0)
        .map(|s| s.status)
        .expect_err("it slides")
        .to_string();
    assert!(
        text.contains("\"hub\" is pushed away for ever where it slides along y"),
        "{text}"
    );
}

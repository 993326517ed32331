//! The example scenes of many bodies have the forces that equilibrium asks for, and the answer of a reference.

use crate::support::assembled::Assembled;
use crate::support::qp::Outcome;
use crate::support::session::with_session;
use base::Result;
use fetifeti::problem::RowSource;
use fetifeti::settings::MethodSettings;
use fetifeti::solution::SolvedRow;
use fetifeti::FetiFeti;
use scene::Scene;

fn text(name: &str) -> String {
    std::fs::read_to_string(format!("../../examples/scenes/{name}.toml")).unwrap()
}

fn load(name: &str) -> Scene {
    Scene::load(format!("../../examples/scenes/{name}.toml")).unwrap()
}

/// The rows and the energy of a scene.
fn solve(scene: &Scene, rtol: f64) -> Result<(Vec<SolvedRow>, f64)> {
    let problem = scene.substructures(&|_| true).unwrap();
    with_session(move |session| {
        let settings = MethodSettings::default().rtol(rtol);
        let solution = FetiFeti::new(session, problem, settings)?.solve()?;
        assert!(solution.converged(), "{}", solution.status);
        Ok((solution.rows().to_vec(), solution.energy))
    })
}

/// The sum of the multipliers of each interface.
fn forces(scene: &Scene, rows: &[SolvedRow]) -> Vec<f64> {
    let mut out = vec![0.0; scene.interfaces.len()];
    for row in rows {
        if let RowSource::Interface(k) = row.label.source {
            out[k] += row.multiplier;
        }
    }
    out
}

/// The thrust of the arch has the same horizontal part in all joints: 1, whatever their angle.
#[test]
fn the_thrust_of_the_arch_is_known() {
    // The soft bed takes a part of the weight.
    let free = text("arch_stands").replace("spring = ", "# ");
    let scene = Scene::parse("arch.toml", &free).unwrap();
    let (rows, _) = solve(&scene, 1e-12).unwrap();
    let forces = forces(&scene, &rows);
    assert_eq!(forces.len(), 11);
    for (interface, force) in scene.interfaces.iter().zip(forces) {
        let [first, second] = interface.bodies;
        assert_eq!(second, first + 1);
        let angle = (50.0 - 10.0 * first as f64).to_radians();
        let away = (force * angle.cos() - 1.0).abs();
        assert!(away < 1e-9, "joint {first}: {force}, away by {away}");
    }
}

#[test]
fn the_standing_arch_has_the_answer_of_the_reference() {
    let scene = load("arch_stands");
    let (rows, energy) = solve(&scene, 1e-12).unwrap();
    let reference = Assembled::of_scene(&scene).qp.solve().solved();
    let away = (energy - reference.energy).abs() / reference.energy.abs();
    assert!(away < 1e-9, "{energy} {}", reference.energy);
    let sum: f64 = rows.iter().map(|r| r.multiplier).sum();
    let other: f64 = reference.below.iter().sum();
    assert!((sum - other).abs() < 1e-7 * other, "{sum} {other}");
}

/// Equal weights have no common thrust: the reference has a motion that nothing stops, and the solver says so.
#[test]
fn the_falling_arch_is_said_to_fall() {
    let scene = load("arch_falls");
    let error = solve(&scene, 1e-8).map(drop).unwrap_err().to_string();
    assert!(error.contains("are pushed away for ever"), "{error}");
    assert!(error.starts_with("bodies \"voussoir["), "{error}");
    assert!(
        !error.contains("voussoir[0]") && !error.contains("voussoir[11]"),
        "{error}"
    );
    match Assembled::of_scene(&scene).qp.solve() {
        Outcome::Unbounded(motion) => assert!(motion.iter().any(|v| v.abs() > 0.5)),
        _ => panic!("the reference finds a solution"),
    }
}

/// The same arch in 60 voussoirs: more motions than are asked about before the loop. All fall but the two that are
/// held.
#[test]
fn a_falling_arch_of_many_voussoirs_is_said_to_fall() {
    let (n, half) = (60, 1.0);
    let angles: Vec<String> = (0..n)
        .map(|k| format!("[0, 0, {}]", 60.0 - half * (2 * k + 1) as f64))
        .collect();
    let whole = text("arch_falls");
    let (before, rest) = whole.split_once("instances = [\n").unwrap();
    let after = rest.split_once("\n]").unwrap().1;
    let text = format!("{before}instances = [{}]{after}", angles.join(", "))
        .replace("from = 85, to = 95", "from = 89, to = 91")
        .replace("instances = 11", &format!("instances = {}", n - 1));
    let scene = Scene::parse("arch.toml", &text).unwrap();
    assert_eq!(scene.n_bodies(), n);
    let error = solve(&scene, 1e-8).map(drop).unwrap_err().to_string();
    let expected = "bodies \"voussoir[1]\", \"voussoir[2]\", \"voussoir[3]\" and 55 more are pushed away for ever";
    assert!(error.starts_with(expected), "{error}");
}

/// Without friction a course passes its wind from brick to brick, and a bed joint the weight above it.
#[test]
fn the_wall_passes_wind_and_weight() {
    let scene = load("wall");
    let (rows, _) = solve(&scene, 1e-10).unwrap();
    let forces = forces(&scene, &rows);
    let frame = |b: usize| !scene.bodies[b].spec.name.ends_with(']');
    let low = |b: usize| scene.bodies[b].bounds[0][1];
    let top = scene
        .bodies
        .iter()
        .map(|b| b.bounds[1][1])
        .fold(0.0, f64::max);
    let parts: Vec<usize> = (0..scene.n_bodies()).filter(|&b| frame(b)).collect();
    let below = parts.iter().map(|&b| low(b)).fold(f64::INFINITY, f64::min);
    let above = parts
        .iter()
        .map(|&b| scene.bodies[b].bounds[1][1])
        .fold(0.0, f64::max);
    let (mut head, mut bed) = (0, vec![0.0; top as usize]);
    for (interface, force) in scene.interfaces.iter().zip(&forces) {
        let ys = interface.bodies.map(low);
        let flat = interface.normals[0][0].abs() > 0.5;
        if flat && ys[0] == ys[1] && !(below..above).contains(&ys[0]) {
            assert!(
                (force - 0.5).abs() < 1e-6,
                "{:?}: {force}",
                interface.bodies
            );
            head += 1;
        }
        if !flat && ys[0].max(ys[1]) <= below {
            bed[ys[0].max(ys[1]) as usize] += force;
        }
    }
    assert!(head > 40, "{head}");
    for (level, force) in bed.iter().enumerate().take(below as usize + 1).skip(1) {
        let weight: f64 = (0..scene.n_bodies())
            .filter(|&b| low(b) >= level as f64)
            .map(|b| scene.wrench(b, 0, [0.0; 3]).unwrap().0[1])
            .sum();
        let away = (force + weight).abs() / weight.abs();
        assert!(away < 1e-8, "joint {level}: {force} of {weight}");
    }
}

/// The floor carries the spheres but for what the soft bed takes, and equal places have equal forces.
#[test]
fn the_box_carries_the_spheres() {
    let scene = load("spheres");
    assert_eq!(scene.n_bodies(), 50);
    let (rows, _) = solve(&scene, 1e-8).unwrap();
    let weight: f64 = (0..50)
        .map(|s| scene.wrench(s, 0, [0.0; 3]).unwrap().0[1])
        .sum();
    let mut floor = vec![0.0; 50];
    let (mut left, mut right) = (0.0, 0.0);
    for row in &rows {
        let (body, n) = (row.label.members[0].map(|m| m.body), row.label.normal);
        let RowSource::Obstacle(_) = row.label.source else {
            continue;
        };
        assert!(row.multiplier > -1e-6);
        match (body, n) {
            (Some(b), [_, y, _]) if y.abs() > 0.9 => floor[b] += row.multiplier,
            (_, [x, _, _]) if x > 0.9 => right += row.multiplier,
            (_, [x, _, _]) if x < -0.9 => left += row.multiplier,
            _ => {}
        }
    }
    let all: f64 = floor.iter().sum();
    assert!(all < -weight && all > -0.97 * weight, "{all} of {weight}");
    assert!(
        (left - right).abs() < 1e-4 * right && right > 0.0,
        "{left} {right}"
    );
    // The four in the middle of the lowest layer, and the four in its corners.
    for list in [[5, 6, 9, 10], [0, 3, 12, 15]] {
        for b in list {
            assert!((floor[b] - floor[list[0]]).abs() < 1e-4 * all, "{floor:?}");
        }
    }
    assert!(floor[16..].iter().all(|f| *f == 0.0));
}

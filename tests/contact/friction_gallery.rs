//! The gallery of friction (`examples/friction`): forces that equilibrium and Coulomb's law give in closed form, on
//! both sides of what friction can hold.

use std::f64::consts::PI;

use crate::support::session::with_session;
use fetifeti::problem::RowSource;
use fetifeti::settings::MethodSettings;
use fetifeti::solution::{RowState, SolvedRow};
use fetifeti::{FetiFeti, Result};
use scene::{Scene, Stepper};

/// The normal and the tangential rows in contact at a load step.
struct Step {
    normal: Vec<SolvedRow>,
    tangential: Vec<SolvedRow>,
}

impl Step {
    /// The force of friction of some sources, as a vector: what the first side drags the other along with.
    fn drag(&self, from: impl Fn(RowSource) -> bool) -> [f64; 3] {
        let rows = self.tangential.iter().filter(|r| from(r.label.source));
        rows.fold([0.0; 3], |sum, row| {
            [0, 1, 2].map(|c| sum[c] + row.multiplier * row.normal()[c])
        })
    }

    /// The normal force of some sources.
    fn press(&self, from: impl Fn(RowSource) -> bool) -> f64 {
        let rows = self.normal.iter().filter(|r| from(r.label.source));
        rows.map(|row| row.multiplier).sum()
    }

    fn all_slip(&self, from: impl Fn(RowSource) -> bool) -> bool {
        let mut rows = self.tangential.iter().filter(|r| from(r.label.source));
        rows.all(|row| matches!(row.state, RowState::Slips | RowState::Open))
    }
}

fn anything(_: RowSource) -> bool {
    true
}

fn path(name: &str) -> String {
    format!("../../examples/friction/{name}.toml")
}

/// All load steps of a scene whose text is changed by `change`.
fn solved(name: &str, change: impl Fn(String) -> String) -> Result<Vec<Step>> {
    let text = change(std::fs::read_to_string(path(name)).expect("a scene"));
    let place = path(name);
    with_session(move |session| {
        let scene = Scene::parse(&place, &text)?;
        let problem = scene.substructures(&|_| true)?;
        let solver = FetiFeti::new(session, problem, MethodSettings::default().rtol(1e-9))?;
        let stepper = Stepper::with_solver(scene, solver)?;
        let mut out = Vec::new();
        for step in stepper {
            let solution = step?.solution;
            assert!(solution.converged(), "{place}: {}", solution.status);
            let contact = solution.rows().iter().filter(|r| r.is_inequality());
            out.push(Step {
                normal: contact.copied().collect(),
                tangential: solution.tangential_rows().to_vec(),
            });
        }
        Ok(out)
    })
}

fn as_it_is(name: &str) -> Vec<Step> {
    solved(name, |text| text).unwrap_or_else(|e| panic!("{name}: {e}"))
}

fn near(a: f64, b: f64, relative: f64, what: &str) {
    assert!((a - b).abs() <= relative * b.abs(), "{what}: {a} and {b}");
}

/// The ground bears the weight of the wall and, by friction, all that pushes it sideways.
#[test]
fn a_dry_stone_wall_stands_on_its_friction() {
    let steps = as_it_is("drystone");
    let ground = |source| matches!(source, RowSource::Obstacle(_));
    let weight = 40.0 * 20.0;
    near(steps[0].press(ground), weight, 1e-7, "weight");
    near(steps[0].drag(ground)[0], 0.1 * weight, 1e-6, "sideways");
    let pushed = |text: String| text.replace("load = [0.1, -1]", "load = [0.65, -1]");
    let error = solved("drystone", pushed)
        .map(|_| ())
        .expect_err("it slides");
    assert!(error.to_string().contains("pushed away"), "{error}");
}

/// The springings of the arch bear its weight and thrust against each other; an arch thinner than Milankovitch's 0.1075
/// of the radius falls.
#[test]
fn an_arch_stands_if_it_is_thick_enough() {
    let of_thickness = |t: f64| {
        move |text: String| {
            let new = format!("inner = {}, outer = {}", 10.0 - 5.0 * t, 10.0 + 5.0 * t);
            assert!(text.contains("inner = 9.25, outer = 10.75"));
            text.replace("inner = 9.25, outer = 10.75", &new)
        }
    };
    for t in [0.15, 0.11] {
        let steps = solved("arch", of_thickness(t)).expect("it stands");
        let of = |k: usize| move |source| source == RowSource::Obstacle(k);
        let [right, left] = [0, 1].map(|k| (steps[0].press(of(k)), steps[0].drag(of(k))[0]));
        // The area of 64 voussoirs, each a ring of two straight sides.
        let area = 64.0 * 2.0 * 0.5 * (PI / 128.0).sin() * 100.0 * 2.0 * t;
        near(right.0 + left.0, area, 1e-6, "weight");
        near(right.0, left.0, 1e-6, "both springings");
        near(right.1, -left.1, 1e-6, "thrust");
        assert!(right.1.abs() > 0.1 * right.0 && right.1.abs() < 0.6 * right.0);
    }
    let error = solved("arch", of_thickness(0.105))
        .map(|_| ())
        .expect_err("it falls");
    assert!(error.to_string().contains("pushed away"), "{error}");
}

/// A hub comes off its shaft at μ p A, with Lamé's pressure p of the fit. At the ends of the hub the shaft goes on, so
/// that the pressure is larger there.
#[test]
fn a_hub_comes_off_at_the_friction_of_its_fit() {
    let steps = as_it_is("hub");
    let (young, gap, a, b, long) = (210e3, 0.02, 20.0, 40.0, 40.0);
    let pressure = young * gap / a * (b * b - a * a) / (2.0 * b * b);
    let force = 0.12 * pressure * 2.0 * PI * a * long;
    let last = steps.last().expect("there is a step");
    assert!(last.all_slip(anything));
    let drag = last.drag(anything)[1].abs();
    near(drag, 0.12 * last.press(anything), 1e-6, "Coulomb");
    near(drag, force, 5e-3, "μ p A");
    assert!(steps[2].drag(anything)[1].abs() < 0.7 * force);
}

/// A brake has the moment μ Σ λ_n r, which under a uniform pressure is that of the formula.
#[test]
fn a_brake_has_the_moment_of_its_pad() {
    let steps = as_it_is("brake");
    let last = steps.last().expect("there is a step");
    assert!(last.all_slip(anything));
    let moment = |row: &SolvedRow| {
        let ([x, y, _], [nx, ny, _]) = (row.label.point, row.normal());
        row.multiplier * (x * ny - y * nx)
    };
    let brakes: f64 = last.tangential.iter().map(moment).sum();
    let radius = |row: &SolvedRow| row.label.point[0].hypot(row.label.point[1]);
    let arms: f64 = last.normal.iter().map(|r| r.multiplier * radius(r)).sum();
    near(brakes.abs(), 0.4 * arms, 1e-4, "μ Σ λ r");
    let (inner, outer): (f64, f64) = (90.0, 140.0);
    let [squares, cubes] = [2, 3].map(|k| outer.powi(k) - inner.powi(k));
    let push = 2.0 * squares * PI / 6.0;
    near(
        brakes.abs(),
        0.4 * push * 2.0 / 3.0 * cubes / squares,
        1e-2,
        "formula",
    );
}

/// A double lap joint slips at twice the friction of its bolt.
#[test]
fn a_lap_joint_slips_at_twice_the_friction_of_its_bolt() {
    let steps = as_it_is("lap_joint");
    let between = |source| matches!(source, RowSource::Interface(_));
    let washers = |step: &Step| step.press(between);
    let plate = |row: &&SolvedRow| row.label.point[1] == 0.0 || row.label.point[1] == 12.0;
    let pull = |step: &Step| -> f64 {
        let rows = step.tangential.iter().filter(plate);
        rows.map(|r| (r.multiplier * r.normal()[0]).abs()).sum()
    };
    let last = steps.last().expect("there is a step");
    // Each of the two washers and of the two sides of the plate bears the bolt.
    near(washers(last), 4.0 * 1000.0, 1e-7, "bolt");
    near(pull(last), 2.0 * 0.2 * 1000.0, 1e-6, "slips");
    assert!(last
        .tangential
        .iter()
        .filter(plate)
        .all(|r| r.state != RowState::Sticks));
    for step in &steps[..steps.len() - 3] {
        assert!(pull(step) < 400.0 * (1.0 - 1e-3));
        assert!(step
            .tangential
            .iter()
            .filter(plate)
            .any(|r| r.state == RowState::Sticks));
    }
}

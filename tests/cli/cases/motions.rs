//! Motions that nothing holds but rounding of the coordinates, or nothing at all.

use super::pins::{on_supports, Pins};
use super::{case, solve, Solved};
use crate::support::mpi::Scratch;
use crate::support::program::{fetifeti, run_fetifeti};
use serde_json::Value;

/// A solved deck with pins.
fn pins(name: &str, ranks: usize, pins: &Pins, options: &[&str]) -> Solved {
    let scratch = Scratch::new(&format!("pins_{name}"));
    let deck = scratch.path("pins.inp");
    std::fs::write(&deck, pins.deck()).expect("a deck can be written");
    solve(&scratch, ranks, &deck, options)
}

/// The largest displacement that is printed.
fn largest(report: &Value) -> f64 {
    let printed = &report["node_print"][0]["nodes"];
    let rows = printed.as_array().expect("a table").iter();
    let values = rows.flat_map(|row| row.as_array().unwrap()[1..].to_vec());
    values
        .map(|x| x.as_f64().unwrap().abs())
        .fold(0.0, f64::max)
}

fn motions(report: &Value) -> Vec<String> {
    let all = report["free_motions"]
        .as_array()
        .cloned()
        .unwrap_or_default();
    let text = |m: &Value| {
        let bodies: Vec<&str> = m["bodies"]
            .as_array()
            .unwrap()
            .iter()
            .map(|b| b.as_str().unwrap())
            .collect();
        format!("{} {}", bodies.join(", "), m["motion"].as_str().unwrap())
    };
    all.iter().map(text).collect()
}

/// CalculiX has 5.29e-4; the coordinates of twelve digits alone would turn the pin by 10⁶ radians.
#[test]
fn a_pin_does_not_spin_by_the_rounding_of_its_coordinates() {
    for ranks in [1, 2] {
        let found = case("01_pin_spins_12digits.inp", ranks, &[]);
        let report = found.report();
        let most = largest(&report);
        assert!((5.2e-4..5.5e-4).contains(&most), "{most}");
        assert_eq!(motions(&report), ["PIN turns about (0, 0)"]);
        let said = "nothing holds body \"PIN\" where it turns about (0, 0): no load drives this";
        assert!(found.run.stdout.contains(said), "{}", found.run.all());
    }
    let report = case("01b_pin_not_converged_12digits.inp", 1, &[]).report();
    // A thousandth of the radius is shared by pin and ring.
    assert!(largest(&report) < 1e-3);
}

/// The same pin for any number of digits, wherever it stands: the motion is named, and the answer is that of sixteen.
#[test]
fn pins_rest_whatever_the_digits_of_their_coordinates() {
    for (n, at, phase) in [
        (0, [0.0; 2], 0.0),
        (1, [0.0; 2], 0.0131),
        (2, [12.3, -7.1], 0.0131),
    ] {
        let of = |digits: usize| {
            let deck = Pins {
                digits,
                at,
                phase,
                ..Pins::default()
            };
            pins(&format!("digits_{n}_{digits}"), 1, &deck, &[]).report()
        };
        let exact = of(17);
        let energy = |report: &Value| report["energy"].as_f64().unwrap();
        for digits in [7, 9, 10, 11, 13] {
            let report = of(digits);
            let [was, is] = [largest(&exact), largest(&report)];
            assert!(
                (is - was).abs() < 2e-3 * was,
                "{digits} digits: {is}, not {was}"
            );
            let [was, is] = [energy(&exact), energy(&report)];
            // The overlap is a thousandth of the radius, and known to so many digits less; far from the origin, to one
            // less again.
            let known = 10f64.powi(5 - digits as i32);
            assert!(
                (is - was).abs() < known.max(1e-6) * was,
                "{digits} digits: {is}, not {was}"
            );
            let expected = format!("PINS turns about ({}, {})", at[0], at[1]);
            assert_eq!(motions(&report), [expected], "{digits} digits");
        }
    }
}

/// Other things than turns of pins by themselves.
#[test]
fn what_holds_a_pin_and_what_drives_it_is_told_apart() {
    // A pressure in the bore is no torque, to as many digits as there are.
    for digits in [7, 10] {
        let deck = Pins {
            digits,
            load: "BORE",
            at: [3.0, 1.0],
            ..Pins::default()
        };
        let report = pins(&format!("bore_{digits}"), 1, &deck, &[]).report();
        assert_eq!(motions(&report), ["PINS turns about (3, 1)"]);
    }
    // One node holds it.
    let deck = Pins {
        held: "P1, 1, 2\n",
        ..Pins::default()
    };
    let report = pins("node", 1, &deck, &[]).report();
    assert!(motions(&report).is_empty());
    assert!(largest(&report) < 1e-3);
    // A torque drives it.
    for digits in [7, 12] {
        let deck = Pins {
            digits,
            load: "*CLOAD\nP1, 2, 1.\nP2, 2, -1.\n",
            ..Pins::default()
        };
        let found = pins(&format!("torque_{digits}"), 1, &deck, &[]);
        assert_eq!(found.run.code, 2, "{}", found.run.all());
        for part in ["body \"PINS\" is", "where it turns about (0, 0)"] {
            assert!(found.run.stderr.contains(part), "{}", found.run.all());
        }
    }
    // In space it slides out of the ring, too.
    let deck = Pins {
        solid: true,
        digits: 10,
        ..Pins::default()
    };
    let report = pins("solid", 2, &deck, &[]).report();
    assert_eq!(
        motions(&report),
        ["PINS slides along z and turns about z through (0, 0, 0)"]
    );
    assert!(largest(&report) < 1e-3);
}

#[test]
fn all_ways_through_the_loop_leave_a_pin_at_rest() {
    let deck = Pins::default();
    let energy = |report: Value| report["energy"].as_f64().unwrap();
    let usual = energy(pins("usual", 1, &deck, &[]).report());
    for (k, options) in [
        ["-fetifeti_contact_type", "augmented_lagrangian"],
        ["-fetifeti_contact_type", "smalbe"],
        ["-fetifeti_projector", "diagonal"],
        ["-fetifeti_projector", "preconditioner"],
    ]
    .iter()
    .enumerate()
    {
        let report = pins(&format!("way_{k}"), 1, &deck, options).report();
        assert!(largest(&report) < 1e-3, "{options:?}");
        assert!((energy(report) - usual).abs() < 1e-8 * usual, "{options:?}");
    }
}

/// Sixty pins have more rigid motions than dense algebra is for.
#[test]
fn many_pins_rest() {
    for ranks in [1, 2] {
        let deck = Pins {
            count: 60,
            digits: 10,
            ..Pins::default()
        };
        let found = pins(&format!("many_{ranks}"), ranks, &deck, &[]);
        let report = found.report();
        assert_eq!(motions(&report).len(), 60);
        assert!(largest(&report) < 1e-3);
        let rest = "and 55 more such motions";
        assert!(found.run.stdout.contains(rest), "{}", found.run.all());
    }
}

#[test]
fn what_is_held_by_nothing_says_which_way_it_moves() {
    let found = case("05_free_in_one_direction.inp", 1, &[]);
    assert_eq!(found.run.code, 2);
    let said = "body \"A\" is held by nothing where it slides along x (no Dirichlet side and no tie to a held body)";
    assert!(found.run.stderr.contains(said), "{}", found.run.all());
}

/// The load does not drive the motion: the upper block is where it began, but for its strain.
#[test]
fn a_block_that_slides_freely_is_named_by_plan_and_solve() {
    for ranks in [1, 2, 4] {
        let found = case("20_slides_freely.toml", ranks, &[]);
        let report = found.report();
        assert_eq!(motions(&report), ["high slides along x"]);
        let u = &report["probes"][0]["u"];
        // A block of width 1 with ν = 0.3 under a pressure of 1 with E = 100 widens by (1 − ν²) ν / (1 − ν) / E on
        // both sides of its middle.
        let wider = 0.5 * 0.3 * 1.3 / 100.0;
        assert!((u[0].as_f64().unwrap() - wider).abs() < 0.2 * wider, "{u}");
    }
    let plan = run_fetifeti(2, &["plan", "../../tests/data/cases/20_slides_freely.toml"]);
    let said = "nothing holds body \"high\" where it slides along x: a load that drives this has no answer";
    assert!(plan.stdout.contains(said), "{}", plan.all());
}

/// E in another unit than the loads: the warning is on standard error also where nothing else is printed.
#[test]
fn displacements_beyond_the_model_are_a_warning() {
    let found = case("22_wrong_unit.toml", 1, &["--quiet"]);
    assert!(found.run.stdout.is_empty());
    let said = "Warning: the largest displacement is 5.18";
    assert!(
        found.run.stderr.contains(said) && found.run.stderr.contains("units"),
        "{}",
        found.run.all()
    );
    let report = found.report();
    let warnings = report["warnings"].as_array().expect("a list");
    assert!(warnings[0]
        .as_str()
        .unwrap()
        .contains("times the size of the model"));
    // The same plate of steel in the right unit has nothing to say.
    let scratch = Scratch::new("right_unit");
    let text = std::fs::read_to_string("../../tests/data/cases/22_wrong_unit.toml").unwrap();
    let scene = scratch.path("right.toml");
    std::fs::write(&scene, text.replace("young = 210", "young = 210e9")).unwrap();
    let right = fetifeti(&["solve", &scene]);
    assert_eq!(
        (right.code, right.stderr.as_str()),
        (0, ""),
        "{}",
        right.all()
    );
}

/// Supports in turned systems, and equations with rounded coefficients, leave a pin its turn as contact does. The
/// displacement of the bore is that of a ring whose rim is held, the same for all digits.
#[test]
fn pins_on_turned_supports_rest() {
    let scratch = Scratch::new("supports");
    for by_equations in [false, true] {
        for digits in [8, 10, 12] {
            let deck = scratch.path(&format!("supports_{by_equations}_{digits}.inp"));
            std::fs::write(&deck, on_supports(digits, [3.0, 1.0], by_equations)).unwrap();
            let report = solve(&scratch, 1, &deck, &[]).report();
            assert_eq!(
                motions(&report),
                ["PIN turns about (3, 1)"],
                "{digits} digits"
            );
            // Lamé: (1 + ν) p a / E times a factor of order one.
            let most = largest(&report);
            assert!(
                (1.0e-4..1.5e-4).contains(&most),
                "{by_equations} {digits}: {most}"
            );
        }
    }
}

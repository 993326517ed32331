//! Gap elements of decks: a bar of section 1 and length 2 in uniform tension, with a gap at each node of its free end.
//! Young's modulus is 1000 and Poisson's ratio 0, so its stiffness is 500.

use crate::support::mpi::{Output, Scratch};
use crate::support::program::run_fetifeti;
use deck::{read_dat, DatQuantity};
use serde_json::Value;

/// A bar, a section, and the gaps between its free end, the nodes FRONT, and the nodes FACING.
fn bar(facing: &str, gap: &str, held: &str, steps: &str) -> String {
    format!(
        "*NODE\n1,0,0,0\n2,2,0,0\n3,2,1,0\n4,0,1,0\n5,0,0,1\n6,2,0,1\n7,2,1,1\n8,0,1,1\n{facing}\
         *ELEMENT,TYPE=C3D8,ELSET=BAR\n1,1,2,3,4,5,6,7,8\n*NSET,NSET=FRONT\n2,3,6,7\n*NSET,NSET=BACK\n1,4,5,8\n\
         *MATERIAL,NAME=M\n*ELASTIC\n1000.,0.\n*SOLID SECTION,ELSET=BAR,MATERIAL=M\n*GAP,ELSET=GAPS\n{gap}\
         *BOUNDARY\nBACK,1,3\n{held}{steps}"
    )
}

/// Four nodes opposite the free end that no element has.
const GROUND: &str =
    "102,2,0,-1\n103,2,1,-1\n106,2,0,-1\n107,2,1,-1\n*NSET,NSET=FACING\n102,103,106,107\n";

/// Gap elements from the nodes 102, 103, 106, 107 to the free end, or the other way.
fn gaps(to_bar: bool) -> String {
    let one = |k: u32| match to_bar {
        true => format!("{},{},{k}\n", 10 + k, 100 + k),
        false => format!("{},{k},{}\n", 10 + k, 100 + k),
    };
    let all: String = [2, 3, 6, 7].map(one).concat();
    format!("*ELEMENT,TYPE=GAPUNI,ELSET=GAPS\n{all}")
}

/// A step in which each node of the free end has a fourth of the force `pull`, and of `press` down.
fn step(pull: f64, press: f64) -> String {
    let load = [(1, pull), (3, -press)].map(|(d, f)| format!("FRONT,{d},{}\n", f / 4.0));
    format!(
        "*STEP\n*STATIC\n*CLOAD,OP=NEW\n{}{}*NODE PRINT,NSET=FRONT\nU\n*NODE PRINT,NSET=BACK,TOTALS=ONLY\nRF\n\
         *END STEP\n",
        load[0], load[1]
    )
}

fn solve(name: &str, deck: &str, ranks: usize) -> (Output, Vec<[f64; 2]>, Value) {
    let scratch = Scratch::new(&format!("deck_gaps_{name}_{ranks}"));
    let (file, out, json) = (
        scratch.file("bar.inp", deck),
        scratch.path("out"),
        scratch.path("report.json"),
    );
    let rtol = ["-fetifeti_ksp_rtol", "1e-10"];
    let args = ["solve", &file, "--out", &out, "--json", &json];
    let run = run_fetifeti(ranks, &[&args[..], &rtol].concat());
    let tables = std::fs::read_to_string(format!("{out}/bar.dat")).map(|text| read_dat(&text));
    let mut found: Vec<[f64; 2]> = Vec::new();
    for table in tables.unwrap_or_default() {
        let along = table.rows.iter().map(|row| row.vector[0]);
        match table.quantity {
            DatQuantity::Displacement => {
                let all: Vec<f64> = along.collect();
                let (first, most) = (all[0], all.iter().fold(0.0_f64, |m, x| m.max(x.abs())));
                assert!(
                    all.iter().all(|u| (u - first).abs() <= 1e-6 * most + 1e-12),
                    "{all:?}"
                );
                found.push([first, f64::NAN]);
            }
            _ => found.last_mut().expect("displacements before")[1] = along.sum(),
        }
    }
    let report = std::fs::read_to_string(&json).ok();
    let report = report.and_then(|text| serde_json::from_str(&text).ok());
    (run, found, report.unwrap_or_default())
}

/// Each step with the displacement of the free end and the force of the support.
fn check(name: &str, deck: &str, expected: &[[f64; 2]]) -> Value {
    let mut last = Value::Null;
    for ranks in [1, 2] {
        let (run, found, report) = solve(name, deck, ranks);
        assert_eq!(run.code, 0, "{}", run.all());
        assert_eq!(found.len(), expected.len(), "{found:?}");
        for (found, expected) in found.iter().zip(expected) {
            let near = |k: usize, size: f64| (found[k] - expected[k]).abs() <= 2e-6 * size;
            assert!(
                near(0, 6e-3) && near(1, 3.0),
                "{name}: {found:?}, not {expected:?}"
            );
        }
        last = report;
    }
    last
}

/// Pressed with N = 10 on the ground, with μ = 0.3 so that μN = 3. Pulled with 0.9 μN nothing moves; with 1.1 μN the
/// bar bears 0.1 μN. With 0.9 μN again it stays where it has slid to, and back with 1.1 μN it slides back.
#[test]
fn a_gap_with_friction_holds_up_to_the_coefficient_times_the_force() {
    let pulls = [2.7, 3.3, 2.7, -3.3].map(|pull| step(pull, 10.0)).concat();
    let slid = 0.3 / 500.0;
    let expected = [[0.0, 0.0], [slid, -0.3], [slid, -0.3], [-slid, 0.3]];
    for (to_bar, direction) in [(true, "1."), (false, "-1.")] {
        let facing = format!("{GROUND}{}", gaps(to_bar));
        let gap = format!("0.,0.,0.,{direction}\n*FRICTION\n.3\n");
        let deck = bar(&facing, &gap, "FACING,1,3\n", &pulls);
        let report = check("ground", &deck, &expected);
        let of = |key: &str| -> f64 {
            let all = report["contact"]["interfaces"].as_array().expect("gaps");
            let value = |i: &Value| match &i[key] {
                Value::Array(list) => list[0].as_f64().expect("a force"),
                value => value.as_f64().expect("a number"),
            };
            all.iter().map(value).sum()
        };
        assert_eq!((of("slipping"), of("sticking")), (4.0, 0.0));
        // Pushed along −x, the bar is held back along +x.
        assert!((of("friction") - 3.0).abs() < 1e-6, "{}", of("friction"));
    }
}

/// Without a support nothing but friction holds the bar: it stands at 0.9 μN, and slides at 1.1 μN.
#[test]
fn a_loose_block_on_gaps_slides_beyond_the_coefficient_times_the_force() {
    let block = |pull: f64| {
        let facing = format!("{GROUND}{}", gaps(true));
        let gap = "0.,0.,0.,1.\n*FRICTION\n.3\n";
        // All eight nodes stand on the ground at once, so that it cannot tip.
        let others =
            "101,0,0,-1\n104,0,1,-1\n105,0,0,-1\n108,0,1,-1\n*NSET,NSET=FACING\n101,104,105,108\n";
        let more = "*ELEMENT,TYPE=GAPUNI,ELSET=GAPS\n11,101,1\n14,104,4\n15,105,5\n18,108,8\n";
        let deck = bar(
            &format!("{facing}*NODE\n{others}{more}"),
            gap,
            "FACING,1,3\n",
            "",
        );
        let deck = deck.replace("BACK,1,3\n", "");
        format!(
            "{deck}{}",
            step(pull, 10.0).replace("*NODE PRINT", "BACK,3,-2.5\n*NODE PRINT")
        )
    };
    // The back is pressed, too, so that μN = 6; the bar between them carries half of the pull at most.
    let (run, found, _) = solve("stands", &block(2.7), 1);
    assert_eq!(run.code, 0, "{}", run.all());
    assert!(found[0][0].abs() < 1e-12, "{found:?}");
    let (run, _, _) = solve("slides", &block(6.6), 1);
    assert_ne!(run.code, 0, "{}", run.all());
    assert!(run.stderr.contains("slides along"), "{}", run.stderr);
}

/// Two bars with gaps between them, of which the first is pulled and pressed. `gap` is the line of *GAP.
fn two_bars(gap: &str, steps: &str) -> String {
    let second =
        "102,2,0,0\n103,2,1,0\n106,2,0,1\n107,2,1,1\n111,4,0,0\n114,4,1,0\n115,4,0,1\n118,4,1,1\n\
                  *NSET,NSET=FACING\n102,103,106,107\n*NSET,NSET=END\n111,114,115,118\n\
                  *ELEMENT,TYPE=C3D8,ELSET=OTHER\n2,102,111,114,103,106,115,118,107\n";
    let section = "*SOLID SECTION,ELSET=OTHER,MATERIAL=M\n";
    let gap = format!("{gap}\n*FRICTION\n.3\n{section}");
    let held = "END,1,3\nFACING,3\n";
    bar(&format!("{second}{}", gaps(true)), &gap, held, steps)
}

/// Its pairs of nodes have the area of *GAP, whatever faces lie around them.
#[test]
fn the_plan_has_the_area_of_gaps() {
    for (area, shown) in [("", "4"), (",2.5", "10")] {
        let deck = two_bars(&format!("0.,0.,0.,1.{area}"), &step(5.4, 10.0));
        let scratch = Scratch::new(&format!("deck_gaps_plan{area}"));
        let run = run_fetifeti(1, &["plan", &scratch.file("bar.inp", &deck)]);
        assert_eq!(run.code, 0, "{}", run.all());
        // Beside the faces that touch there are four pairs of nodes, with a gap of 0 and no angle.
        let pairs = run.stdout.lines().filter(|l| l.starts_with("OTHER - BAR"));
        let pairs: Vec<String> = pairs
            .map(|l| l.split_whitespace().skip(3).collect())
            .collect();
        assert!(pairs.contains(&format!("404{shown}0–")), "{}", run.stdout);
        assert_eq!(pairs.len(), 2, "{}", run.stdout);
    }
}

/// Between two bars that pull on each other the force of friction is inner. They stick to each other while one pulls
/// the other with less than μN = 3, half of the load; then each has its own displacement.
#[test]
fn gaps_between_bodies_carry_friction() {
    let pulls = [5.4, 6.6].map(|pull| step(pull, 10.0)).concat();
    let deck = two_bars("0.,0.,0.,1.", &pulls);
    let report = check("bars", &deck, &[[5.4e-3, -2.7], [3.6 / 500.0, -3.6]]);
    let interfaces = report["contact"]["interfaces"].as_array().expect("gaps");
    assert_eq!(
        (interfaces.len(), &interfaces[0]["slipping"]),
        (1, &4.into())
    );
    let name = interfaces[0]["name"].as_str().expect("a name");
    assert!(name.ends_with("gaps"), "{name}");
    // The first body in the order of the row is the second bar, with node 102: the first bar drags it along +x.
    let friction = interfaces[0]["friction"][0].as_f64().expect("a force");
    assert!((friction - 3.0).abs() < 1e-6, "{friction}");
}

/// A clearance of 1e-3 along the bar, hard or with a spring of 250 at each node; the ground may move away. CalculiX
/// finds 2.8646e-3 and -6.6330e-3 with the spring in a step with NLGEOM, in which a length of 2 counts as it is then.
#[test]
fn clearances_and_spring_constants_are_those_of_the_deck() {
    let facing = format!("{GROUND}{}", gaps(false));
    let free = 3.3 / 500.0;
    let pulls = [3.3, -3.3].map(|pull| step(pull, 0.0)).concat();
    let deck = |gap: &str, held: &str| bar(&facing, gap, held, &pulls);
    let fixed = "FACING,1,3\n";
    let hard = deck("1e-3,1.,0.,0.\n", fixed);
    check("hard", &hard, &[[1e-3, -0.5], [-free, 3.3]]);
    let soft = (3.3 + 1000.0 * 1e-3) / 1500.0;
    let spring = deck("1e-3,1.,0.,0.,,250.\n", fixed);
    check("spring", &spring, &[[soft, -500.0 * soft], [-free, 3.3]]);
    let slope = "1e-3,1.,0.,0.,.5\n*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR\n500.\n";
    check(
        "slope",
        &deck(slope, fixed),
        &[[soft, -500.0 * soft], [-free, 3.3]],
    );
    // Two elements at the same nodes are two springs, and one where they are hard.
    let twice = gaps(false) + &gaps(false).replace('1', "3").replace(",30", ",10");
    let both = |gap: &str| bar(&format!("{GROUND}{twice}"), gap, fixed, &pulls);
    let stiff = (3.3 + 2000.0 * 1e-3) / 2500.0;
    let springs = both("1e-3,1.,0.,0.,,250.\n");
    check(
        "springs",
        &springs,
        &[[stiff, -500.0 * stiff], [-free, 3.3]],
    );
    check(
        "stops",
        &both("1e-3,1.,0.,0.\n"),
        &[[1e-3, -0.5], [-free, 3.3]],
    );
    let moved = deck("1e-3,1.,0.,0.\n", "FACING,1,1,2e-3\n");
    check("moved", &moved, &[[3e-3, -1.5], [-free, 3.3]]);
    // Without a direction it is that from node to node: up, where nothing moves.
    let across = deck("0.\n", fixed);
    check("across", &across, &[[free, -3.3], [-free, 3.3]]);
}

/// The ground is printed with its motion and with the force that holds it, normal force and friction, as CalculiX does.
#[test]
fn the_ground_has_motion_and_force() {
    let scratch = Scratch::new("deck_gaps_printed");
    let facing = format!("{GROUND}{}", gaps(true));
    let asked = "*NODE PRINT,NSET=FACING\nU,RF\n*END STEP\n";
    let steps = step(3.3, 10.0).replace("*END STEP\n", asked);
    let held = "FACING,1,1,1e-3\nFACING,2,3\n";
    let deck = bar(&facing, "0.,0.,0.,1.\n*FRICTION\n.3\n", held, &steps);
    let (file, out) = (scratch.file("bar.inp", &deck), scratch.path("out"));
    let run = run_fetifeti(2, &["solve", &file, "--out", &out]);
    assert_eq!(run.code, 0, "{}", run.all());
    let text = std::fs::read_to_string(format!("{out}/bar.dat")).expect("tables");
    let tables = read_dat(&text);
    let of = |force: bool| {
        let is_force = |q: &DatQuantity| *q != DatQuantity::Displacement;
        let mut own = tables.iter().filter(|t| t.set == "FACING");
        own.find(|t| is_force(&t.quantity) == force)
            .expect("a table")
    };
    // The bar sticks to the ground, which drags it by 1e-3. It bears 0.5 of the pull, and friction less than 3.
    for row in &of(false).rows {
        assert_eq!(row.vector, [1e-3, 0.0, 0.0]);
    }
    for row in &of(true).rows {
        let away = (0..3).map(|d| row.vector[d] - [-2.8 / 4.0, 0.0, 2.5][d]);
        assert!(away.fold(0.0, |m: f64, x| m.max(x.abs())) < 1e-5, "{row:?}");
    }
}

#[test]
fn gaps_without_a_held_ground_are_refused() {
    let facing = format!("{GROUND}{}", gaps(true));
    let refused = |gap: &str, held: &str, expected: &str| {
        let (run, _, _) = solve("refused", &bar(&facing, gap, held, &step(1.0, 10.0)), 1);
        assert_eq!(run.code, 2, "{}", run.all());
        assert!(run.stderr.contains(expected), "{}", run.stderr);
    };
    let why = "no element has node 102, and *BOUNDARY does not hold it in direction";
    refused("0.,0.,0.,1.\n", "FACING,1,2\n", &format!("{why} 3"));
    refused(
        "0.,0.,0.,1.\n*FRICTION\n.3\n",
        "FACING,3\n",
        &format!("{why} 1"),
    );
}

//! Decks of parts, instances and their assembly.

use crate::support::checks::number;
use crate::support::mpi::Scratch;
use crate::support::program::{fetifeti, run_fetifeti};
use serde_json::Value;
use std::fs;

/// Two cubes on each other, the upper one turned by 90 degrees, and a cap that is tied to them: a column of height 2.5
/// and section 1 that 10 press.
const DECK: &str = "../../tests/data/cases/instances.inp";

fn solved(ranks: usize, file: &str) -> Value {
    let rtol = ["-fetifeti_ksp_rtol", "1e-11"];
    let args = [&["solve", file, "--quiet", "--json", "-"], &rtol[..]].concat();
    let out = run_fetifeti(ranks, &args);
    assert_eq!(out.code, 0, "{}", out.all());
    serde_json::from_str(&out.stdout).expect("JSON")
}

fn near(found: &Value, expected: f64) {
    let found = number(found);
    assert!((found - expected).abs() < 1e-9, "{found}, not {expected}");
}

/// u = −F H / (E A) at the top, and 2/2.5 of it at the cap's foot.
#[test]
fn instances_are_placed_and_named() {
    for ranks in [1, 2] {
        let report = solved(ranks, DECK);
        let tables = report["node_print"].as_array().expect("tables");
        let expected = [("TOP", 27, -0.025), ("BLOCK-2.HEAD", 13, -0.02)];
        for (table, (set, first, u)) in tables.iter().zip(expected) {
            assert_eq!(table["set"], set);
            let nodes = table["nodes"].as_array().expect("nodes");
            assert_eq!(nodes[0][0], first, "its number in the flat deck");
            nodes.iter().for_each(|node| near(&node[3], u));
        }
        near(&report["contact"]["interfaces"][0]["force"], 10.0);
        let notes = report["notes"].to_string();
        let sentence =
            "nodes of instance CAP-1 have their own numbers plus 16 in messages and tables";
        assert!(notes.contains(sentence), "{notes}");
    }
}

/// The deck is the mesh of a scene: its bodies are instances, and sets have short names where these say enough.
#[test]
fn a_scene_takes_the_instances_of_a_deck() {
    let scratch = Scratch::new("cases_instances");
    scratch.file("m.inp", &fs::read_to_string(DECK).expect(DECK));
    let text = "dimension = 3\nphysics = \"elasticity\"\n[mesh]\nfile = \"m.inp\"\n\
        [[body]]\nname = \"BLOCK-1\"\nyoung = 1000\npoisson = 0\ndirichlet = { \"BLOCK-1.BASE\" = 0 }\n\
        [[body]]\nname = \"BLOCK-2.ALL\"\nyoung = 1000\npoisson = 0\n\
        [[body]]\nname = \"CAP\"\nyoung = 1000\npoisson = 0\ntraction = { LID = [0, 0, -10] }\n\
        [[contact]]\nsurfaces = [\"BLOCK-2.UNDER\", \"BLOCK-1.OVER\"]\n\
        [[tie]]\nsurfaces = [\"BELOW\", \"MID\"]\n";
    let report = solved(1, &scratch.file("s.toml", text));
    near(&report["energy"], -0.125);
    near(&report["contact"]["interfaces"][0]["force"], 10.0);
}

/// As Neper writes a mesh: one part, its instance, and little else; or the part alone.
#[test]
fn a_part_may_be_all_there_is() {
    let scratch = Scratch::new("cases_part");
    let deck = fs::read_to_string(DECK).expect(DECK);
    let from = deck.find("*Part, name=Block").expect("a part");
    let end = deck.find("*End Part").expect("its end");
    let part = format!("{}*End Part\n", &deck[from..end]);
    let rest = "*Material, name=Steel\n*Elastic\n1000., 0.\n*Step\n*Static\n*Boundary\nBASE, 1, 3\n*Cload\n\
        HEAD, 3, -2.5\n*Node Print, nset=HEAD\nU\n*End Step\n";
    let assembly =
        "*Assembly, name=A\n*Instance, name=I, part=BLOCK\n*End Instance\n*End Assembly\n";
    for middle in ["", assembly] {
        let text = format!("{part}{middle}{rest}");
        let report = solved(1, &scratch.file("d.inp", &text));
        let nodes = report["node_print"][0]["nodes"].as_array().expect("nodes");
        assert_eq!(nodes[0][0], 5);
        nodes.iter().for_each(|node| near(&node[3], -0.01));
    }
}

/// The clamp that touches itself as a part: moved and turned by 90 degrees it has the same displacements, turned.
#[test]
fn a_turned_instance_moves_as_its_part_does() {
    let scratch = Scratch::new("cases_turned");
    let flat =
        fs::read_to_string("../../tests/data/cases/07_contact_of_one_body.inp").expect("a deck");
    let at = |what: &str| flat.find(what).expect(what);
    let [material, section, contact] =
        ["*MATERIAL", "*SOLID SECTION", "*SURFACE INTERACTION"].map(at);
    let rest = &flat[contact..]
        .replace("SLOW, SUP", "C-1.SLOW, C-1.SUP")
        .replace("HELD, 1, 3", "C-1.HELD, 1, 3")
        .replace("TLOW, 2, 0.4", "LOWS, 1, -0.4")
        .replace("TUP, 2, -0.4", "A.C-1.TUP, 1, 0.4")
        .replace("NSET=TLOW", "NSET=LOWS")
        .replace("NSET=TUP", "NSET=C-1.TUP");
    let deck = format!(
        "*PART, NAME=C\n{}{}*END PART\n*ASSEMBLY, NAME=A\n*INSTANCE, NAME=C-1, PART=C\n3., 0., 1.\n\
         3., 0., 0., 3., 0., 1., 90.\n*END INSTANCE\n*NSET, NSET=LOWS, INSTANCE=C-1\n63, 126\n*END ASSEMBLY\n{}{rest}",
        &flat[..material],
        &flat[section..contact],
        &flat[material..section]
    );
    let report = solved(1, &scratch.file("d.inp", &deck));
    near(
        &report["contact"]["interfaces"][0]["force"],
        0.786_747_314_51,
    );
    let tables = report["node_print"].as_array().expect("tables");
    for (table, sign) in tables.iter().zip([-1.0, 1.0]) {
        for node in table["nodes"].as_array().expect("nodes") {
            near(&node[1], sign * 0.054_671_735_85);
            near(&node[2], 0.004_779_749_578);
        }
    }
}

/// What of a deck of parts is missing or not where it must be is told with its line.
#[test]
fn mistakes_in_parts_are_told() {
    let scratch = Scratch::new("cases_parts_wrong");
    let deck = fs::read_to_string(DECK).expect(DECK);
    let tries = [
        (
            "name=Cap-1, part=Cap",
            "name=Cap-1, part=Lid",
            "line 58: *INSTANCE: there is no part LID (parts are BLOCK, CAP)",
        ),
        (
            "name=Cap-1, part=Cap",
            "name=Cap-1",
            "line 58: *INSTANCE: the parameter PART= is missing",
        ),
        (
            "*Part, name=Cap",
            "*Part",
            "line 29: *PART: the parameter NAME= is missing",
        ),
        (
            "*Part, name=Cap",
            "*Part, name=Block",
            "line 29: *PART: part BLOCK is defined before",
        ),
        (
            "name=Block-2, part",
            "name=Block-1, part",
            "line 54: *INSTANCE: instance BLOCK-1 is defined before",
        ),
        (
            "*End Part\n*Part, name=Cap",
            "*Part, name=Cap",
            "line 28: *PART: *PART BLOCK, which begins in",
        ),
        (
            "*End Assembly\n",
            "",
            "*STEP: *ASSEMBLY ASSEMBLY, which begins in",
        ),
        (
            "*End Instance\n*Nset, nset=Fixed",
            "*Nset, nset=Fixed",
            "*END ASSEMBLY: *INSTANCE CAP-1, which begins in",
        ),
        (
            "*Assembly, name=Assembly\n",
            "",
            "*INSTANCE: instances stand between *ASSEMBLY and *END ASSEMBLY",
        ),
        (
            "*Step\n",
            "*End Part\n*Step\n",
            "*END PART: no *PART, *ASSEMBLY or *INSTANCE is open",
        ),
        (
            " 0.5, 0.5, 0., 0.5, 0.5, 1., 90.",
            " 0.5, 0.5, 0., 0.5, 90.",
            "a rotation (two points of the axis and an angle",
        ),
        (
            "0.5, 0.5, 0., 0.5, 0.5, 1., 90.",
            "0.5, 0.5, 0., 0.5, 0.5, 0., 90.",
            "the two points of the axis of rotation are one",
        ),
        (
            "instance=Cap-1",
            "instance=Cap-7",
            "*NSET: there is no instance CAP-7",
        ),
        ("Block-2.base, 1, 2", "Block-7.base, 1, 2", "BLOCK-7.base"),
    ];
    for (from, to, sentence) in tries {
        assert_eq!(deck.matches(from).count(), 1, "{from}");
        let path = scratch.file("d.inp", &deck.replace(from, to));
        let out = fetifeti(&["plan", &path]);
        assert_eq!(out.code, 2, "{to}: {}", out.all());
        assert!(
            out.stderr.to_lowercase().contains(&sentence.to_lowercase()),
            "{sentence}: {}",
            out.stderr
        );
    }
}

//! Contact of a body with itself, and two sides of one body that are tied.

use super::own_meshes::{cracked, ring};
use crate::support::checks::number;
use crate::support::mpi::Scratch;
use crate::support::program::{fetifeti, run_fetifeti};
use serde_json::Value;

/// The report of a scene.
fn report(scratch: &Scratch, ranks: usize, scene: &str, more: &[&str]) -> Value {
    let path = scratch.file("s.toml", scene);
    let args = [
        "solve",
        &path,
        "--quiet",
        "--json",
        "-",
        "-fetifeti_ksp_rtol",
        "1e-10",
    ];
    let out = run_fetifeti(ranks, &[&args[..], more].concat());
    assert_eq!(out.code, 0, "{}", out.all());
    serde_json::from_str(&out.stdout).expect("JSON")
}

fn near(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!(
        (found - expected).abs() <= tolerance,
        "{what}: {found}, not {expected}"
    );
}

/// The defects of the identities B B_Dᵀ B = B, P P = P, B Z_c = 0 and λ_min ≥ 1 are rounding.
fn identities(scratch: &Scratch, ranks: usize, more: &[&str]) {
    let path = scratch.path("s.toml");
    let args = [&["solve", &path, "-fetifeti_check"], more].concat();
    let out = run_fetifeti(ranks, &args);
    let (_, list) = out.stdout.split_once("identities").expect("identities");
    let lines: Vec<&str> = list
        .lines()
        .skip(1)
        .take_while(|l| l.starts_with("  "))
        .collect();
    assert!(lines.len() > 3, "{list}");
    for line in lines {
        let defect = line.split_whitespace().last().and_then(|d| d.parse().ok());
        assert!(defect.is_some_and(|d: f64| d < 1e-9), "{line}");
    }
}

/// A clamp whose jaws are pressed together: values of an active set on the same mesh; CalculiX has 0.05483.
#[test]
fn a_deck_with_contact_of_one_body() {
    let scratch = Scratch::new("cases_own_deck");
    let (out, json) = (scratch.path("out"), scratch.path("r.json"));
    for ranks in [1, 2] {
        let deck = "../../tests/data/cases/07_contact_of_one_body.inp";
        let run = run_fetifeti(ranks, &["solve", deck, "--out", &out, "--json", &json]);
        assert_eq!(run.code, 0, "{}", run.all());
        let text = std::fs::read_to_string(&json).expect("a report");
        let report: Value = serde_json::from_str(&text).expect("JSON");
        let tips: Vec<f64> = report["node_print"]
            .as_array()
            .expect("tables")
            .iter()
            .flat_map(|table| table["nodes"].as_array().expect("nodes"))
            .map(|row| number(&row[2]))
            .collect();
        assert_eq!(tips.len(), 4);
        tips.iter()
            .for_each(|u| near(u.abs(), 0.05467, 1e-5, "tip"));
        let contact = &report["contact"];
        let interface = &contact["interfaces"][0];
        assert_eq!(interface["name"], "part 1.SLOW|part 1.SUP");
        near(number(&interface["force"]), 0.7867, 1e-4, "force");
        // The body presses on itself: nothing is left.
        for value in contact["bodies"][0]["contact"]
            .as_array()
            .expect("components")
        {
            near(number(value), 0.0, 1e-10, "resultant");
        }
    }
}

/// Against a quadratic programme for the same elements, solved by non-negative least squares: whatever the subdomains,
/// the ranks and the method of the loop are.
#[test]
fn a_slit_ring_is_pressed_shut() {
    let scratch = Scratch::new("cases_own_ring");
    scratch.file("m.msh", &ring(0.0, false).text());
    let scene = |subdomains: usize| {
        format!(
            "physics = \"elasticity\"\n[mesh]\nfile = \"m.msh\"\n[[body]]\nname = \"ring\"\nyoung = 1000\n\
             poisson = 0.3\nsubdomains = {subdomains}\npressure = {{ pressed = 0.55 }}\ndirichlet = {{ back = 0 }}\n\
             [[contact]]\nsurfaces = [\"first\", \"second\"]\n[[probe]]\nname = \"lip\"\n\
             point = [{:?}, {:?}]\n",
            (1.96_f64 - 0.0081).sqrt(),
            0.09
        )
    };
    let loops = ["active_set", "augmented_lagrangian", "smalbe"];
    for (subdomains, ranks, kind) in [(1, 1, 0), (5, 1, 1), (5, 1, 2), (5, 2, 0), (5, 4, 2)] {
        let option = ["-fetifeti_contact_type", loops[kind]];
        let report = report(&scratch, ranks, &scene(subdomains), &option);
        let what = format!("{subdomains} {ranks} {}", loops[kind]);
        let interface = &report["contact"]["interfaces"][0];
        near(number(&interface["force"]), 0.3424107343, 1e-8, &what);
        assert_eq!(interface["active"], 1, "{what}");
        let u = &report["probes"][0]["u"];
        near(number(&u[0]), -0.0781226142, 1e-8, &what);
        near(number(&u[1]), -0.09, 1e-8, &what);
        identities(&scratch, ranks, &option);
    }
}

/// The same ring floats: a plate holds it.
#[test]
fn a_floating_ring_touches_itself() {
    let scratch = Scratch::new("cases_own_floating");
    scratch.file("m.msh", &ring(0.0, true).text());
    for (subdomains, ranks) in [(1, 1), (6, 2)] {
        let scene = format!(
            "physics = \"elasticity\"\n[mesh]\nfile = \"m.msh\"\n[[body]]\nname = \"ring\"\nyoung = 1000\n\
             poisson = 0.3\nsubdomains = {subdomains}\npressure = {{ pressed = 0.55 }}\n[[body]]\nname = \"plate\"\n\
             young = 20000\npoisson = 0.3\nsubdomains = 1\ndirichlet = {{ held = 0 }}\n[[tie]]\nbodies = \"all\"\n\
             [[contact]]\nsurfaces = [\"first\", \"second\"]\n"
        );
        let report = report(&scratch, ranks, &scene, &[]);
        assert_eq!(report["floating_bodies"], 1);
        let interface = &report["contact"]["interfaces"][0];
        near(number(&interface["force"]), 0.3423359560, 1e-8, "force");
        let balance = &report["contact"]["bodies"][0];
        assert!(number(&balance["imbalance"]) < 1e-8, "{balance}");
        assert!(number(&balance["moment_imbalance"]) < 1e-8, "{balance}");
        for kind in ["dirichlet", "coarse_corrected"] {
            identities(&scratch, ranks, &["-fetifeti_pc_type", kind]);
        }
    }
}

const BLOCK: &str = "dimension = 3\nphysics = \"elasticity\"\n[mesh]\nfile = \"m.msh\"\n[[body]]\nname = \"block\"\n\
    young = 1000\n";

/// A crack with a closed tip that load steps press together and open, against a quadratic programme.
#[test]
fn load_steps_close_and_open_a_crack() {
    let scratch = Scratch::new("cases_own_crack");
    scratch.file("m.msh", &cracked(0.0).text());
    for (subdomains, ranks) in [(1, 1), (4, 2)] {
        let scene = format!(
            "{BLOCK}poisson = 0.3\nsubdomains = {subdomains}\ntraction = {{ press = [0.5, 0, -4] }}\n\
             dirichlet = {{ wall = 0 }}\n[[contact]]\nsurfaces = [\"upper\", \"lower\"]\n[steps]\ntimes = [1, 2, 3]\n\
             load = \"3 - 2*t\"\n"
        );
        let report = report(&scratch, ranks, &scene, &[]);
        let steps = report["contact"]["load_steps"].as_array().expect("steps");
        let expected = [
            (12, 2.0788267470, -0.2595041920),
            (0, 0.0, -0.3936477932),
            (0, 0.0, -3.5428301391),
        ];
        assert_eq!(steps.len(), expected.len());
        for (step, (active, force, energy)) in steps.iter().zip(expected) {
            assert_eq!(step["active"], active);
            near(number(&step["contact_force"]), force, 1e-7, "force");
            near(number(&step["energy"]), energy, 1e-8, "energy");
        }
        // At the end no row holds.
        identities(&scratch, ranks, &[]);
    }
}

/// A crack under uniform pressure, with nodes that match and with others: the stress is that without the crack,
/// σ = E u / H = 5, also at the node beside the tip. Nodes of the tip have no row.
#[test]
fn a_crack_passes_uniform_pressure() {
    let scratch = Scratch::new("cases_own_patch");
    for (shift, rows, force, ranks) in
        [(0.0, 12, 8.75, 1), (0.15, 12, 10.0, 1), (0.15, 12, 10.0, 2)]
    {
        scratch.file("m.msh", &cracked(shift).text());
        let scene = format!(
            "{BLOCK}poisson = 0\nsubdomains = 3\ndirichlet = {{ top = {{ z = -0.01 }}, bottom = 0 }}\n[[contact]]\n\
             surfaces = [\"upper\", \"lower\"]\n"
        );
        let report = report(&scratch, ranks, &scene, &[]);
        let interface = &report["contact"]["interfaces"][0];
        assert_eq!(interface["active"], rows, "{interface}");
        near(number(&interface["force"]), force, 1e-8, "force");
        near(number(&interface["max_pressure"]), 5.0, 1e-8, "pressure");
        identities(&scratch, ranks, &[]);
    }
}

/// A crack whose faces are tied is none: the deflection of the whole block. A deck with *TIE has it, too.
#[test]
fn a_tied_crack_is_none() {
    let scratch = Scratch::new("cases_own_tie");
    scratch.file("m.msh", &cracked(0.0).text());
    let solid = "dimension = 3\nphysics = \"elasticity\"\n[[body]]\nname = \"block\"\nsize = [4, 1, 2]\n\
        elements = [8, 2, 4]\nyoung = 1000\npoisson = 0.3\nload = [0, 0, -1]\ndirichlet = [\"left\"]\n";
    let expected = number(&report(&scratch, 1, solid, &[])["energy"]);
    for (subdomains, ranks) in [(1, 1), (4, 2)] {
        let scene = format!(
            "{BLOCK}poisson = 0.3\nsubdomains = {subdomains}\nload = [0, 0, -1]\ndirichlet = {{ wall = 0 }}\n[[tie]]\n\
             surfaces = [\"upper\", \"lower\"]\n"
        );
        let report = report(&scratch, ranks, &scene, &[]);
        near(
            number(&report["energy"]),
            expected,
            1e-8 * expected.abs(),
            "energy",
        );
    }
}

/// A box that is bent to a ring touches itself with two of its sides.
#[test]
fn a_bent_box_touches_itself() {
    let scratch = Scratch::new("cases_own_box");
    let scene = "physics = \"elasticity\"\n[[body]]\nname = \"c\"\nelements = [3, 40]\nsubdomains = [1, 4]\n\
        young = 100\nshape = { annulus = { inner = 1, outer = 1.3, from = 4, to = 356 } }\n\
        pressure = { right = 0.05 }\nspring = { left = 0.01 }\n[[contact]]\n\
        bodies = [\"c\", \"c\"]\nsides = [\"bottom\", \"top\"]\n";
    let run = report(&scratch, 2, scene, &[]);
    let interface = &run["contact"]["interfaces"][0];
    assert_eq!(interface["name"], "c.bottom|c.top");
    assert!(number(&interface["force"]) > 0.0, "{interface}");
    let compared = fetifeti(&[
        "compare",
        &scratch.path("s.toml"),
        "--with",
        "mumps",
        "--json",
        "-",
    ]);
    assert_eq!(compared.code, 0, "{}", compared.all());
}

#[test]
fn what_cannot_touch_itself_is_told() {
    let scratch = Scratch::new("cases_own_mistakes");
    scratch.file("m.msh", &ring(0.0, false).text());
    let tries = [
        (
            "surfaces = [\"first\", \"first\"]",
            "the surface `first` is named twice, and only body `ring` has it",
        ),
        (
            "bodies = [\"ring\", \"ring\"]",
            "a contact names body `ring` twice where two bodies were expected (or `sides`",
        ),
        (
            "bodies = [\"ring\", \"ring\"]\nsides = [\"first\", \"first\"]",
            "the side `first` of body `ring` is named twice",
        ),
        (
            "surfaces = [\"first\", \"back\"]",
            "side `first` of `ring` and side `back` of `ring` do not face each other",
        ),
    ];
    for (entry, sentence) in tries {
        let text = format!(
            "physics = \"elasticity\"\n[mesh]\nfile = \"m.msh\"\n[[body]]\nname = \"ring\"\n\
             dirichlet = {{ back = 0 }}\n[[contact]]\n{entry}\n"
        );
        let path = scratch.file("s.toml", &text);
        let out = fetifeti(&["plan", &path]);
        assert_eq!(out.code, 2, "{}", out.all());
        assert!(out.stderr.contains(sentence), "{}", out.stderr);
    }
}

//! The weights that the method chooses by itself, called as a library and as a program.

use crate::support::mpi::Scratch;
use crate::support::program::fetifeti;
use crate::support::sample::{all_cases, sample};
use crate::support::session::with_session;
use fetifeti::settings::{MethodSettings, Scaling};
use fetifeti::FetiFeti;
use scene::Scene;
use serde_json::Value;
use std::fs;

#[test]
fn meshes_in_space_are_scaled_by_stiffness_unless_told_otherwise() {
    let taken = |file: &'static str, scaling: Option<Scaling>| -> (Scaling, usize) {
        let scene = Scene::load(file).expect("a scene");
        let problem = scene.substructures(&|_| true).expect("substructures");
        let settings = MethodSettings::default().scaling(scaling);
        with_session(move |session| {
            let mut solver = FetiFeti::new(session, problem, settings).expect("set up");
            let solution = solver.solve().expect("solved");
            (solver.facts().scaling, solution.iterations)
        })
    };
    let stem = "../../examples/gallery/hip_stem.toml";
    let chosen = taken(stem, None);
    assert_eq!(chosen.0, Scaling::Stiffness);
    if all_cases() {
        assert_eq!(chosen, taken(stem, Some(Scaling::Stiffness)));
    }
    // The weights make a difference, so equal counts say that the method took the ones that it names.
    let told = taken(stem, Some(Scaling::Rho));
    assert_eq!(told.0, Scaling::Rho);
    assert_ne!(chosen.1, told.1);
    for file in [
        "../../examples/gallery/pin_lug.toml",
        "../../examples/scenes/cube_3d.toml",
    ] {
        assert_eq!(taken(file, None).0, Scaling::Rho, "{file}");
    }
}

/// The program, with the option on the command line, in the scene, or nowhere.
#[test]
fn the_report_names_the_scaling() {
    let scratch = Scratch::new("scaling");
    let mesh = fs::canonicalize("../../examples/gallery/hip_stem.msh").expect("a mesh");
    let small = "../../examples/scenes/cube_3d.toml".to_string();
    let text = fs::read_to_string("../../examples/gallery/hip_stem.toml").expect("a scene");
    let text = text.replace("hip_stem.msh", &mesh.to_string_lossy());
    let plain = scratch.file("plain.toml", &text);
    let told = format!("{text}\n[options]\nfetifeti_scaling = \"rho\"\n");
    let told = scratch.file("told.toml", &told);
    let cases = [
        (&told, &["-fetifeti_scaling", "auto"][..], "stiffness"),
        (&plain, &[], "stiffness"),
        (&small, &["-fetifeti_scaling", "deluxe"], "deluxe"),
        (&told, &[], "rho"),
    ];
    for (scene, options, expected) in sample(2, cases) {
        let out = fetifeti(&[&["solve", scene, "--json", "-"], options].concat());
        assert_eq!(out.code, 0, "{}", out.all());
        let report: Value = serde_json::from_str(&out.stdout).expect("a report");
        assert_eq!(report["scaling"], expected, "{options:?}");
    }
}

//! examples/clients: programs on finite element libraries that people have, with the solver in them. Each compares
//! itself with a direct solution of the assembled problem and ends with an error if it is another one.

use crate::python::script_with;
use crate::support::mpi::{command, Output, Scratch};
use crate::support::plugin::{number_after, vector, Program};

const ROOT: &str = env!("FETIFETI_ROOT");
const RANKS: [usize; 3] = [1, 2, 4];
const TIGHT: &str = "-fetifeti_ksp_rtol 1e-10";

/// A package of the Python registry, installed where other runs find it again.
fn installed(what: &str) -> String {
    let mut install = command("scripts/clients.sh");
    let out = install.arg(what).current_dir(ROOT).output();
    let out = out.expect("the script runs");
    let said = String::from_utf8_lossy(&out.stderr);
    assert!(out.status.success(), "{what}: {said}");
    String::from_utf8_lossy(&out.stdout).trim().to_string()
}

/// What has to be said by every client.
fn check(out: &Output, touching: &str) {
    assert_eq!(out.code, 0, "{}", out.all());
    assert!(number_after(out, "error") < 1e-8, "{}", out.all());
    assert!(out.stdout.contains(touching), "{}", out.all());
}

#[test]
fn dolfinx() {
    // Forms are compiled once and kept. dolfinx cuts the mesh by PT-Scotch, whose threads may leave its ranks in
    // different collective calls for ever, on a busy machine: it gets one thread.
    let cache = format!("{ROOT}/target/clients/forms");
    let env = [
        ("XDG_CACHE_HOME", &cache[..]),
        ("SCOTCH_PTHREAD_NUMBER", "1"),
    ];
    for ranks in RANKS {
        let client = "examples/clients/dolfinx_contact.py";
        let out = script_with(client, ranks, TIGHT, "", &env);
        check(&out, "10 of 25 nodes touch");
    }
}

#[test]
fn scikit_fem() {
    let modules = installed("skfem");
    for ranks in RANKS {
        let client = "examples/clients/skfem_mortar.py";
        check(
            &script_with(client, ranks, TIGHT, &modules, &[]),
            "4 of 10 rows hold",
        );
    }
}

#[test]
fn mfem() {
    let scratch = Scratch::new("client-mfem");
    let tree = installed("mfem");
    let client = "examples/clients/mfem_contact.cpp";
    let more = [
        "-std=c++17".to_string(),
        format!("-I{tree}/include"),
        format!("-L{tree}/lib"),
        "-lmfem".to_string(),
        format!("-Wl,-rpath,{tree}/lib"),
    ];
    let program = Program::linked_with("mpicxx", &scratch, client, &more);
    for ranks in RANKS {
        check(&program.run(ranks, TIGHT), "7 of 9 nodes touch");
    }
}

/// Options alone bring the solver into a program that was compiled without it.
#[test]
fn dmplex_with_a_snes() {
    let scratch = Scratch::new("client-plex");
    let source = "../../examples/clients/plex_newton.c";
    let program = Program::own("mpicc", &scratch, source);
    let newton = "-snes_linesearch_type basic -snes_rtol 1e-12 -snes_view_solution binary";
    let direct = "-ksp_type preonly -pc_type lu -pc_factor_mat_solver_type mumps";
    let ours = "-dm_mat_type is -ksp_type fetifeti -ksp_rtol 1e-10 -ksp_view";
    let mut first = None;
    for ranks in RANKS {
        let files = ["direct", "ours"].map(|name| scratch.path(name));
        let runs = [
            program.run(ranks, &format!("{newton}:{} {direct}", files[0])),
            program.with_plugin(ranks, &format!("{newton}:{} {ours}", files[1])),
        ];
        for out in &runs {
            assert_eq!(out.code, 0, "{}", out.all());
            let deflection = number_after(out, "deflection");
            let expected = *first.get_or_insert(deflection);
            assert!(deflection > 0.1, "{}", out.all());
            assert!((deflection - expected).abs() < 1e-8, "{}", out.all());
        }
        // Rotations cost energy from the second tangent on; from then on only numbers change.
        let mut counted = runs[1].stdout.lines().filter(|l| l.contains("set-ups: "));
        let counted = counted.next_back().expect("-ksp_view counts");
        let whole = (1..=2).any(|n| counted.contains(&format!("set-ups: {n} whole, ")));
        assert!(whole && !counted.contains(" 0 of numbers"), "{counted}");
        let [exact, u] = files.map(|file| vector(&file));
        let size = exact.iter().fold(0.0, |most, v| v.abs().max(most));
        let apart = u.iter().zip(&exact).map(|(a, b)| (a - b).abs());
        let error = apart.fold(0.0, f64::max);
        assert!(error < 1e-8 * size, "{ranks} ranks: {error} of {size}");
    }
}

#[test]
fn a_load_loop() {
    for ranks in RANKS {
        let client = "examples/clients/load_loop.py";
        let out = script_with(client, ranks, TIGHT, "", &[]);
        check(&out, "load 1.00");
        assert_eq!(out.stdout.matches("nodes touch").count(), 8);
    }
}

/// The heads of the clients say how they run, and all are short.
#[test]
fn clients_are_short() {
    let entries = std::fs::read_dir(format!("{ROOT}/examples/clients")).expect("a directory");
    for entry in entries {
        let path = entry.expect("an entry").path();
        let text = std::fs::read_to_string(&path).expect("a text");
        let name = path.display().to_string();
        assert!(text.lines().count() < 105, "{name} is too long");
        let helper = name.contains("direct");
        assert!(helper || text.contains("mpirun -n 4"), "{name}");
    }
}

//! Rows with many terms and FetiFetiAddMortar, from C, Fortran and Python: against dense solutions, against exact
//! pressures, and mistakes.

use crate::python::script;
use crate::support::sample::{all_cases, sample};
use crate::support::{mpi, plugin};
use mpi::Scratch;
use plugin::{number_after, Program};

/// tests/plugin/mortar.py: the solution is that of the dense optimality system, and the same on one rank and on 2 or 4,
/// of which cases `k` one after the other take turns.
fn against_dense(k: usize, options: &str, most_terms: f64) {
    let mut sums = Vec::new();
    for ranks in [1, [2, 4][k % 2]] {
        let always = "-fetifeti_ksp_rtol 1e-13 -fetifeti_contact_rtol 1e-12";
        let out = script(
            "tests/plugin/mortar.py",
            ranks,
            &format!("{options} {always}"),
        );
        for (what, tolerance) in [
            ("error ", 1e-10),
            ("force ", 1e-9),
            ("over ", 1e-10),
            ("pull ", 1e-10),
        ] {
            let value = number_after(&out, what);
            assert!(
                value < tolerance,
                "{options}, {ranks} ranks, {what}: {}",
                out.all()
            );
        }
        assert!(number_after(&out, "reason ") > 0.0, "{}", out.all());
        assert!(number_after(&out, "terms ") >= most_terms, "{}", out.all());
        let (rows, touch) = (number_after(&out, "rows "), number_after(&out, "touch "));
        let contact = options.contains("-kind 1");
        // Some nodes touch and some do not.
        assert!(
            touch > 2.0 && (touch < rows) == contact,
            "{options}: {}",
            out.all()
        );
        sums.push((touch, number_after(&out, "sum ")));
    }
    for (touch, sum) in &sums {
        assert_eq!(*touch, sums[0].0, "{options}");
        assert!(
            (sum - sums[0].1).abs() < 1e-9 * sum.abs(),
            "{options}: {sums:?}"
        );
    }
}

#[test]
fn rows_with_many_terms() {
    let cases = [
        ("-dim 2 -order 1 -components 2 -kind 1", 8.0),
        ("-dim 2 -order 2 -components 2 -kind 0", 4.0),
        ("-dim 2 -order 2 -components 2 -kind 1", 8.0),
        ("-dim 2 -order 1 -components 1 -kind 1", 4.0),
        ("-dim 3 -order 1 -components 3 -kind 1", 20.0),
        ("-dim 3 -order 1 -components 3 -kind 0", 8.0),
        ("-dim 3 -order 2 -components 1 -kind 1", 10.0),
    ];
    for (k, (options, terms)) in sample(3, cases).enumerate() {
        against_dense(k, &format!("-by rows {options}"), terms);
    }
}

#[test]
fn mortars_are_the_rows_that_a_host_would_make() {
    let cases = [
        "-dim 2 -order 1 -components 2 -kind 1",
        "-dim 2 -order 1 -components 2 -kind 0 -spread",
        "-dim 2 -order 1 -components 1 -kind 1 -spread",
        "-dim 3 -order 1 -components 3 -kind 1 -spread -scale 1e-6",
        "-dim 3 -order 1 -components 1 -kind 0",
    ];
    for (k, options) in sample(3, cases).enumerate() {
        against_dense(k, &format!("-by mortar {options}"), 0.0);
    }
}

#[test]
fn constant_pressures_of_both_orders() {
    let cases = [
        "-dim 2 -order 2 -components 2 -kind 1",
        "-dim 2 -order 2 -components 2 -kind 0",
        "-dim 3 -order 2 -components 3 -kind 1",
        "-dim 3 -order 1 -components 3 -kind 0",
        "-dim 3 -order 2 -components 1 -kind 1",
    ];
    for options in sample(3, cases) {
        let options = format!("-by mortar -patch -spread {options} -fetifeti_ksp_rtol 1e-13");
        // The script fails where a pressure is off by 1e-10.
        let out = script("tests/plugin/mortar.py", 2, &options);
        assert!(
            out.stdout.contains("pressure within"),
            "{options}: {}",
            out.all()
        );
    }
}

/// Tetrahedra have faces of 3 and 6 nodes, serendipity elements faces of 8. Each kind of cell is on every number of
/// ranks, with contact and ties by turns; the sample has one number for each.
#[test]
fn constant_pressures_of_faces_of_3_6_and_8_nodes() {
    for (k, (cells, order)) in [("simplex", 1), ("simplex", 2), ("serendipity", 2)]
        .into_iter()
        .enumerate()
    {
        for (i, ranks) in [1, 2, 4].into_iter().enumerate() {
            if i != (k + 1) % 3 && !all_cases() {
                continue;
            }
            let kind = (k + i) % 2;
            let options = format!(
                "-by mortar -patch -spread -dim 3 -components 3 -cells {cells} -order {order} -kind {kind} \
                 -fetifeti_ksp_rtol 1e-13"
            );
            let out = script("tests/plugin/mortar.py", ranks, &options);
            assert_eq!(
                out.stdout.matches("pressure within").count(),
                ranks,
                "{options}: {}",
                out.all()
            );
        }
    }
}

#[test]
fn examples_with_exact_pressures() {
    let scratch = Scratch::new("capi-mortar");
    let program = Program::linked("mpicc", &scratch, "examples/embedding/mortar.c");
    for ranks in [1, 2, 4] {
        let options = "-fetifeti_ksp_rtol 1e-12";
        let out = program.run(ranks, options);
        assert_eq!(out.code, 0, "{}", out.all());
        assert!(
            number_after(&out, "pressure 0.1 but for") < 1e-10,
            "{}",
            out.all()
        );
        let out = script("examples/embedding/mortar.py", ranks, options);
        assert!(
            number_after(&out, "pressure 0.1 but for") < 1e-10,
            "{}",
            out.all()
        );
    }
    // Without the tolerance the check fails, so it is one.
    let out = program.run(2, "-fetifeti_ksp_rtol 1e-3");
    assert!(
        out.code != 0 && out.stderr.contains("not the pressure"),
        "{}",
        out.all()
    );
}

#[test]
fn mistakes_are_sentences() {
    let scratch = Scratch::new("capi-mortar-wrong");
    let program = Program::linked("mpicc", &scratch, "tests/plugin/mortar_wrong.c");
    for ranks in [1, 2] {
        let out = program.run(ranks, "-fetifeti_ksp_rtol 1e-12 -malloc_dump");
        assert_eq!(out.code, 0, "{}", out.all());
        assert!(out.stdout.trim_end().ends_with("ok"), "{}", out.all());
        let line = "mortar 0: contact of surfaces 0 and 1, 2 of 2 nodes carry multipliers";
        assert!(out.stdout.contains(line), "{}", out.all());
    }
    for (wrong, sentence) in [
        ("node", "names node 4, expected numbers from 0 to below 4"),
        ("twice", "face 0 of surface 0, as rank 0 gives it, names a node twice"),
        ("dof", "the node at [0.0, 1.0] of surface 0 has unknown 77 of all, which no subdomain has"),
        ("place", "of surface 0 has two places, [0.0, 1.0] and [0.5, 1.0]"),
        ("finite", "has a node with the coordinate NaN"),
        ("turned", "do not face each other within 4.000000: they would if one of them went around"),
        ("both", "they would if both of them went around the other way"),
        ("away", "the faces of surface 0 and surface 1 do not face each other within 4.000000: expected sides"),
        ("half", "do not face each other within 4.000000: expected sides"),
        ("beside", "do not face each other within 4.000000: expected sides"),
        ("flat", "face 0 of surface 0, as rank 0 gives it, has 2 nodes, expected 3, 4, 6, 8 or 9"),
        ("components", "surface 0 has 3 unknowns in a node, expected 1 or the dimension 2"),
        ("dimension", "surface 0 is of dimension 4, expected 2 or 3"),
        ("falls", "the row pointers fall from 0 to -1"),
        ("ways", "of surface 0 go around in opposite ways"),
        ("matrix", "a surface names matrix 3 but 0 have been added"),
        ("none", "surface 0 has no faces on any rank"),
        ("surface", "a mortar names surface 7 but 2 have been added"),
        ("same", "a mortar joins surface 0 with itself"),
        ("gap", "has a gap, reach or adjust that is not finite"),
        ("differ", "ranks give the node at [0.0, 1.0] of surface 0 different gaps"),
        ("ranks", "ranks give a mortar different surfaces, kinds, reaches"),
        ("kind", "a mortar is of kind 5"),
        ("held", "no node of surface 0 can carry a multiplier of mortar 0: 2 are held"),
        ("without", "no node of surface 0 can carry a multiplier of mortar 0: 0 are held"),
        ("order", "nothing has been solved yet"),
        ("reset", "nothing has been solved yet"),
        ("number", "there is no mortar 1 in what was solved, expected one of 1 (from 0)"),
        ("room", "there is room for 3 nodes, expected 4"),
    ] {
        let out = program.run(2, &format!("-wrong {wrong}"));
        assert_ne!(out.code, 0, "{wrong}: {}", out.all());
        assert!(out.stderr.contains(sentence), "{wrong}: {}", out.all());
        assert!(!out.all().contains("panicked"), "{wrong}: {}", out.all());
    }
}

#[test]
fn squares_in_fortran() {
    let scratch = Scratch::new("capi-mortar-fortran");
    let program = Program::fortran_with_module(&scratch, "tests/plugin/mortar.F90");
    for ranks in [1, 2] {
        let out = program.run(ranks, "-fetifeti_ksp_rtol 1e-12");
        assert_eq!(out.code, 0, "{}", out.all());
        for (what, exact) in [
            ("lambda ", 0.25),
            ("pressure ", 0.5),
            ("pressure alone ", 0.5),
        ] {
            let value = number_after(&out, what);
            assert!((value - exact).abs() < 1e-8, "{what}: {}", out.all());
        }
        assert!(out.stdout.contains("state  1  1 end"), "{}", out.all());
    }
}

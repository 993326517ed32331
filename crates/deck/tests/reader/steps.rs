//! Steps: supports, loads, amplitudes, and what is printed.

use super::{bad, good, whole, CUBES, REST, STEP};
use crate::{read, Printed, Totals};

#[test]
fn steps() {
    let text = |steps: &str| whole(&format!("{CUBES}{REST}{steps}"));
    assert!(text("*STEP\n*STATIC\n*CLOAD\n1,1,1.\n")
        .ends_with("line 25: *STEP: the step has no *END STEP; the file may be cut off"));
    assert!(text("*STEP\n*STEP\n").contains("the *STEP of a.inp, line 25 has no *END STEP"));
    assert!(text("*STEP\n*END STEP\n").ends_with("line 25: *STEP: the step has no *STATIC"));
    assert!(text("*END STEP\n").ends_with("there is no *STEP before it"));
    assert!(text("*STATIC\n").ends_with("it must stand between *STEP and *END STEP"));
    assert!(text("*STEP,NLGEOM\n*STATIC\n*END STEP\n")
        .contains("NLGEOM: large displacements are not supported"));
    assert!(text("*STEP\n*FREQUENCY\n5\n*END STEP\n")
        .contains("line 26: *FREQUENCY: it depends on time"));
    assert!(text("*STEP\n*SHAKE\n").ends_with("line 26: *SHAKE: this keyword is unknown"));
    assert!(text(&format!("{STEP}*STEP,PERTURBATION\n")).contains("in the first step only"));
    let step =
        "*STEP,NLGEOM=NO,PERTURBATION,INC=10\nloads\n*STATIC,DIRECT\n*RESTART,WRITE\n*END STEP\n";
    let good = format!("{CUBES}{REST}{step}");
    let deck = read("a.inp", good.as_bytes(), &|_| unreachable!()).expect("a deck");
    assert_eq!(deck.ignored[0].keyword, "*RESTART");
    assert_eq!(deck.files.at(deck.ignored[0].place), "a.inp, line 28");
}

#[test]
fn boundary_conditions() {
    let deck = good(
        "*BOUNDARY\n1,1,3\n5,ENCASTRE\n2,2\n3,3,3,.5\n3,3,3,.25\n4,4,6\n",
        "*BOUNDARY\n2,2,2,1.\n",
    );
    let all: Vec<(u32, u8, f64)> = deck.steps[0]
        .supports
        .iter()
        .map(|s| (s.node, s.dof, s.value))
        .collect();
    let held = |n: u32| [(n, 0, 0.0), (n, 1, 0.0), (n, 2, 0.0)];
    assert_eq!(
        all,
        [&held(0)[..], &[(1, 1, 1.0), (2, 2, 0.25)], &held(4)].concat()
    );
    let line = |row: &str| bad(&format!("*BOUNDARY\n{row}\n"), "");
    assert_eq!(line("X,1"), "there is no node set X");
    assert_eq!(line("9,1"), "there is no node 9");
    assert_eq!(
        line("1"),
        "a direction is expected, a whole number, but field 2 is empty"
    );
    assert_eq!(
        line("1,11,11,20."),
        "directions are 1 to 6, but they are 11 to 11"
    );
    assert_eq!(
        line("1,1,1000000000"),
        "directions are 1 to 6, but they are 1 to 1000000000"
    );
    assert_eq!(
        line("1,3,1"),
        "the last direction, 1, comes before the first, 3"
    );
    assert!(line("1,1,6,.1").starts_with("direction 6 cannot be given here"));
    assert_eq!(
        line("1,1,1,inf"),
        "a displacement is expected, a number, but field 4 is 'inf'"
    );
    assert!(bad("*BOUNDARY,MASS FLOW\n1,1\n", "").contains("fluids are not supported"));
    assert!(bad("*BOUNDARY,AMPLITUDE=A\n1,1\n", "").ends_with("there is no amplitude A"));
}

#[test]
fn loads() {
    let deck = good(
        "*SURFACE,NAME=S\n1,S1\n2,S2\n",
        "*CLOAD\nN,2,.5\n1,2,.5\n1,1,1.\n1,1,-1.\n*DLOAD\nE,P2,1.\n*DSLOAD\nS,P,2.\n",
    );
    let step = &deck.steps[0];
    assert_eq!(step.forces.len(), 16);
    assert_eq!((step.forces[0].dof, step.forces[0].value), (1, 1.0));
    let all: Vec<(u32, u8, f64)> = step
        .pressures
        .iter()
        .map(|p| (p.cell, p.side, p.value))
        .collect();
    assert_eq!(all, [(0, 0, 2.0), (0, 1, 1.0), (1, 1, 3.0)]);
    let load = |row: &str| bad("", &format!("*DLOAD\n{row}\n"));
    assert!(load("E,P2NU,1.").starts_with("loads of type 'P2NU' are not supported"));
    assert!(load("E,P7,1.").contains("P1 to P6, but it is 'P7'"));
    assert_eq!(
        load("E,P2"),
        "a pressure is expected, a number, but field 3 is empty"
    );
    assert_eq!(load("S,P,1."), "there is no surface of sides of elements S");
    assert_eq!(load("E,GRAV,1.,0.,0.,0."), "the direction of gravity is 0");
    assert!(
        load("E,CENTRIF,1.,0.,0.,0.,0.,0.,1.\nE,CENTRIF,1.,1.,0.,0.,0.,0.,1.")
            .starts_with("a set cannot turn about two axes")
    );
    assert_eq!(
        bad("*CLOAD\n1,1,1.\n", ""),
        "*CLOAD: it must stand between *STEP and *END STEP"
    );
    assert_eq!(
        bad("", "*CLOAD\n1,4,1.\n"),
        "the direction of a force is 1 to 3 here, but it is 4"
    );
    let twice = "*NSET,NSET=A\n1,2,1\n*SURFACE,NAME=S\n1,S1\nE,S1\n*ELSET,ELSET=B\n1,1\n";
    assert!(bad(twice, "*CLOAD\nA,1,1.\n").starts_with("A has members twice"));
    assert!(bad(twice, "*DSLOAD\nS,P,1.\n").starts_with("S has members twice"));
    assert!(bad(twice, "*DLOAD\nB,P1,1.\n").starts_with("B has members twice"));
    let two = "*CLOAD,AMPLITUDE=A\n1,1,1.\n*CLOAD,AMPLITUDE=B\n1,1,1.\n";
    let amplitudes = "*AMPLITUDE,NAME=A\n0,1\n*AMPLITUDE,NAME=B\n0,2\n";
    assert!(bad(amplitudes, two).contains("another amplitude"));
}

#[test]
fn amplitudes_are_taken_at_the_end_of_steps() {
    let amplitudes = "*AMPLITUDE,NAME=A\n0.,0.,1.,2.,\n3.,4.\n*AMPLITUDE,NAME=T,TIME=TOTAL TIME\n0.,0.,10.,10.\n";
    let steps = "*STEP\n*STATIC\n.1,2.\n*CLOAD,AMPLITUDE=A\n1,1,10.\n*CLOAD,AMPLITUDE=T\n2,1,10.\n\
                 *CLOAD,AMPLITUDE=A,TIME DELAY=1.5\n3,1,10.\n*END STEP\n\
                 *STEP\n*STATIC\n.1,2.5\n*END STEP\n";
    let text = format!("{CUBES}{amplitudes}{REST}{steps}");
    let deck = read("a.inp", text.as_bytes(), &|_| unreachable!()).expect("a deck");
    let values = |k: usize| -> Vec<f64> { deck.steps[k].forces.iter().map(|f| f.value).collect() };
    assert_eq!((deck.steps[0].time, deck.steps[1].time), (2.0, 4.5));
    assert_eq!(values(0), [30.0, 20.0, 10.0]);
    assert_eq!(values(1), [30.0, 45.0, 10.0]);
    assert!(
        bad("*AMPLITUDE,NAME=A\n1.,0.,0.,1.\n", "").ends_with("the times of an amplitude decrease")
    );
    assert!(bad("*AMPLITUDE,NAME=A,USER\n", "").contains("amplitudes of users"));
    assert!(bad("*AMPLITUDE,NAME=A\n", "").ends_with("its table is missing"));
}

#[test]
fn what_is_printed() {
    let deck = good("", "*NODE PRINT,NSET=N,TOTALS=YES,FREQUENCY=100\nRF,NT,\nU\n*NODE PRINT,NSET=N,FREQUENCY=0\nU\n\
                         *NODE PRINT\nU\n*NODE FILE\nU,RF\n*EL FILE\nS\n*EL PRINT,ELSET=E\nS\n");
    let step = &deck.steps[0];
    assert_eq!(step.prints.len(), 1);
    assert_eq!(
        step.prints[0].printed,
        [Printed::Force, Printed::Displacement]
    );
    assert_eq!(
        (step.prints[0].totals, step.prints[0].global),
        (Totals::Yes, false)
    );
    assert_eq!(
        (step.fields[0].keyword, step.fields[1].keyword),
        ("*NODE FILE", "*EL FILE")
    );
    assert_eq!(step.fields[0].fields, ["U", "RF"]);
    let ignored: Vec<&str> = deck.ignored.iter().map(|n| n.keyword.as_str()).collect();
    assert_eq!(ignored, ["*EL PRINT", "*NODE PRINT", "*NODE PRINT"]);
    assert_eq!(
        bad("", "*NODE PRINT,NSET=X\nU\n"),
        "*NODE PRINT: there is no node set X"
    );
}

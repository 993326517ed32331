//! PETSc in a process of its own: what `-log_view`, `-help` and `-options_file` do there.

use super::objects::laplacian;
use super::under_mpirun as mpi;
use crate::{cite, Comm, Event, Ksp, LogStage, Options, Session, ShellPc, Vec as PVec};
use base::Result;

/// The work of a second process, started by the tests below with its own PETSc options; returns its exit code.
fn with_options(options: &str, help: &str) -> i32 {
    let args: Vec<String> = options.split(' ').map(String::from).collect();
    let session = match Session::new(&args, help) {
        Ok(session) => session,
        Err(error) => {
            println!("refused: {error}");
            return error.exit_code();
        }
    };
    session.run(|session| {
        let event = Event::register(session, "OurEvent")?;
        let stage = LogStage::register(session, "Our stage")?;
        {
            let _stage = stage.scope()?;
            let _event = event.scope()?;
            let a = laplacian(session, 50);
            let ksp = Ksp::new(session, Comm::Own)?;
            ksp.set_operators(&a, &a)?;
            ksp.set_from_options()?;
            let (x, b) = (a.right_vec()?, a.left_vec()?);
            b.set(1.0)?;
            ksp.pc()?
                .set_shell("our preconditioner", Box::new(Described))?;
            ksp.solve(&b, &x)?;
        }
        let options = Options::new(session, "fetifeti_");
        options.heading("FETI-FETI options")?;
        options.f64(
            "tau",
            10.0,
            "threshold of the eigenvalues that are deflated",
        )?;
        cite(session, "@article{ours, title={Ours}}\n")?;
        for (name, value) in Options::new(session, "").left()? {
            println!("unused {name} {value}");
        }
        Ok(())
    })
}

struct Described;

impl ShellPc for Described {
    fn apply(&self, x: &PVec, y: &PVec) -> Result<()> {
        y.copy_from(x)
    }
    fn view(&self) -> String {
        "scaling: stiffness".into()
    }
}

#[test]
fn log_view_shows_our_event_and_stage() {
    let started = mpi::as_process(|options| with_options(options, "Solves things.\n"));
    let out = started.run(1, "-log_view -ksp_view");
    assert_eq!(out.code, 0, "{}", out.all());
    for text in [
        "OurEvent",
        "Our stage",
        "our preconditioner",
        "scaling: stiffness",
    ] {
        assert!(out.stdout.contains(text), "{text}: {}", out.all());
    }
}

#[test]
fn help_lists_our_options_and_left_finds_typos() {
    let started = mpi::as_process(|options| with_options(options, "Solves things.\n"));
    let out = started.run(1, "-help -ksp_tpye cg -citations");
    assert_eq!(out.code, 0, "{}", out.all());
    for text in [
        "Solves things.",
        "FETI-FETI options",
        "-fetifeti_tau: <10> threshold",
        "-ksp_rtol",
        "unused -ksp_tpye cg",
        "@article{ours",
    ] {
        assert!(out.stdout.contains(text), "{text}: {}", out.all());
    }
}

#[test]
fn a_missing_options_file_is_one_sentence() {
    let started = mpi::as_process(|options| with_options(options, "Solves things.\n"));
    let sentence = "PETSc does not start: Unable to open options file /does/not/exist.";
    for (ranks, before) in [(1, "refused: "), (2, "Error on rank 0: ")] {
        let out = started.run(ranks, "-options_file /does/not/exist");
        assert_eq!(out.code, 3, "{}", out.all());
        assert_eq!(
            out.all().matches(&format!("{before}{sentence}")).count(),
            1,
            "{}",
            out.all()
        );
        assert!(!out.all().contains("PETSC ERROR"), "{}", out.all());
    }
}

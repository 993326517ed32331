//! The object behind `FetiFetiStep`: the stepper of a scene, and the load step that it has solved last.

use petsc::PetscInt;
use std::ffi::{CString, OsStr};
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};

use base::{Error, Fault, Result};
use fetifeti::inside::c::Held;
use fetifeti::solution::SolvedRow;
use fetifeti::{Problem, Session, Solution};
use scene::{checkpoint, distribution, Body, StepSolution, Stepper};

use crate::rows::ContactRow;

/// The data of a `FetiFetiStep`.
pub struct Steps {
    session: Session,
    /// The file of the scene.
    pub path: PathBuf,
    /// A hash of its content and of the files that it names, on rank 0; 0 on the others.
    pub identity: u64,
    /// The options of the scene: they are in PETSc's database while the stepper is at work, and not between.
    options: Vec<(String, String)>,
    /// `None` after a checkpoint that did not fit.
    stepper: Option<Stepper>,
    /// The names of the bodies.
    pub names: Vec<CString>,
    solved: Option<StepSolution>,
    /// Its tangential rows on this rank, whose gaps have no elastic part.
    tangential: Vec<SolvedRow>,
    /// The name of the reason why its solve ended.
    pub reason: CString,
    /// Its rows between bodies, once they were asked for.
    rows: Option<Vec<ContactRow>>,
}

impl Held for Steps {
    const CLASS: &'static str = "FetiFetiStep";
    const MAGIC: u64 = 0x4645_5449_5354_4550;

    fn session(&self) -> &Session {
        &self.session
    }
}

impl Steps {
    /// Reads the scene in a file and sets its solver up. Collective.
    pub fn new(session: Session, file: &[u8]) -> Result<Steps> {
        let path = path(file);
        let scene = distribution::read(&session, &path)?;
        let identity = match session.rank() {
            0 => checkpoint::identity(&path, &scene),
            _ => Ok(0),
        };
        let identity = session.agree(identity)?;
        let options = scene.options.clone();
        let names = scene.bodies.iter().map(|b| name(&b.spec.name)).collect();
        let set_up = || Stepper::new(&session, scene);
        let stepper = distribution::with_options(&session, &options, set_up)?;
        Ok(Steps {
            session,
            path,
            identity,
            options,
            stepper: Some(stepper),
            names,
            solved: None,
            tangential: Vec::new(),
            reason: CString::default(),
            rows: None,
        })
    }

    /// Solves the next load step; `false` after the last one. Collective.
    ///
    /// # Errors
    /// Those of the stepper; [`ErrorKind::NotConverged`](base::ErrorKind::NotConverged) for a step that has not
    /// converged, which can be asked for like others.
    pub fn next(&mut self) -> Result<bool> {
        let Some(solved) = self.work(|stepper| stepper.next().transpose())? else {
            return Ok(false);
        };
        let (step, status) = (solved.step, &solved.solution.status);
        (self.reason, self.rows) = (name(status.name()), None);
        let mut failed = None;
        if !status.converged() {
            let (n, scene) = (self.stepper()?.scene().n_steps(), self.path.display());
            let what = match n {
                1 => format!("{scene}"),
                _ => format!("load step {} of {n} of {scene}", step + 1),
            };
            let iterations = solved.solution.iterations;
            let said = format!("{what} did not converge: {status} after {iterations} iterations");
            failed = Some(Error::not_converged(said));
        }
        self.tangential = slid(self.stepper()?.solver().problem(), &solved.solution);
        self.solved = Some(solved);
        failed.map_or(Ok(true), Err)
    }

    /// Has the stepper at work with the options of the scene. Collective.
    pub fn work<T>(&mut self, work: impl FnOnce(&mut Stepper) -> Result<T>) -> Result<T> {
        let stepper = self.stepper.as_mut().ok_or_else(gone)?;
        distribution::with_options(&self.session, &self.options, || work(stepper))
    }

    /// Replaces the stepper by what is made of it, with the options of the scene. Collective.
    pub fn replace(&mut self, make: impl FnOnce(Stepper) -> Result<Stepper>) -> Result<()> {
        let stepper = self.stepper.take().ok_or_else(gone)?;
        let make = || make(stepper);
        self.stepper = Some(distribution::with_options(
            &self.session,
            &self.options,
            make,
        )?);
        Ok(())
    }

    /// The stepper.
    pub fn stepper(&self) -> Result<&Stepper> {
        self.stepper.as_ref().ok_or_else(gone)
    }

    /// Whether a load step was solved.
    pub fn has_begun(&self) -> bool {
        self.solved.is_some()
    }

    /// The load step that was solved last.
    pub fn solved(&self) -> Result<&StepSolution> {
        self.solved.as_ref().ok_or_else(|| {
            Fault::WrongState.error("no load step was solved yet, expected FetiFetiStepNext before")
        })
    }

    /// The body of this number.
    pub fn body(&self, body: PetscInt) -> Result<(usize, &Body)> {
        let bodies = &self.stepper()?.scene().bodies;
        let found = usize::try_from(body)
            .ok()
            .and_then(|b| Some((b, bodies.get(b)?)));
        found.ok_or_else(|| {
            Fault::OutOfRange.error(format!(
                "there is no body {body}, expected a number from 0 to below {}",
                bodies.len()
            ))
        })
    }

    /// The displacements at the nodes of a body. Collective.
    pub fn displacements(&self, body: PetscInt) -> Result<Vec<f64>> {
        let (body, _) = self.body(body)?;
        let (solved, stepper) = (self.solved()?, self.stepper()?);
        let (local, u) = (&stepper.solver().problem().local, &solved.solution.u);
        let scene = stepper.scene();
        Ok(scene.displacements(&self.session, local, u, solved.step, body))
    }

    /// The rows between bodies of all ranks. Collective.
    pub fn rows(&mut self) -> Result<&[ContactRow]> {
        let found = match self.rows.take() {
            Some(rows) => rows,
            None => {
                let own = self.solved()?.solution.rows();
                let gathered = |own: &[SolvedRow]| {
                    let mut all = SolvedRow::on_all_ranks(self.session.comm(), own);
                    all.sort_by(SolvedRow::by_place);
                    all
                };
                let all = gathered(own);
                ContactRow::all(&all, &gathered(&self.tangential))
            }
        };
        Ok(self.rows.insert(found))
    }
}

/// The tangential rows of this rank, each with a gap that is less than zero by what the sides have slid: elastic slip
/// springs back.
fn slid(problem: &Problem, solution: &Solution) -> Vec<SolvedRow> {
    let friction = problem.rows.iter().filter(|row| row.law.is_friction());
    let rows = solution.tangential_rows().iter().zip(friction);
    rows.map(|(&(mut row), given)| {
        row.gap += given.compliance * row.multiplier;
        row
    })
    .collect()
}

/// The path with these bytes.
pub fn path(file: &[u8]) -> PathBuf {
    Path::new(OsStr::from_bytes(file)).to_path_buf()
}

fn name(text: &str) -> CString {
    CString::new(text.replace('\0', " ")).unwrap_or_default()
}

fn gone() -> Error {
    Fault::WrongState.error(
        "the FetiFetiStep has no solver since a checkpoint did not fit it, expected a new one",
    )
}

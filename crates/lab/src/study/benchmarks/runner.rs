//! Writes the scene of a case with its mesh, solves it, and enters what the solver says into a report.

use std::path::Path;
use std::rc::Rc;
use std::time::Instant;

use super::report::{MeasuredValue, MeshResult, ReferencePressure};
use crate::study::solved;
use base::{ErrorKind, Result};
use fetifeti::solution::SolvedRow;
use fetifeti::{FetiFeti, Solution};
use mesh::{gmsh, MeshFile};
use petsc::Session;
use report::json::Kkt;
use report::output;
use scene::stepper::StepSolution;
use scene::{distribution, Displaced, Numbering, Scene, Stepper};

/// Relative residual that is asked of the method.
const RTOL: f64 = 1e-10;

/// The data that the cases share.
pub struct Runner<'a> {
    /// PETSc and the ranks.
    pub session: &'a Session,
    /// Where scenes and meshes are written.
    pub dir: &'a Path,
    /// Whether smaller cases are run.
    pub quick: bool,
    /// Which case it is of how many, as in "2 of 11".
    pub case: String,
    /// Told before every mesh.
    pub progress: &'a mut dyn FnMut(&str),
}

/// A scene and its solutions.
pub struct SolvedScene {
    /// The file of the scene.
    pub file: String,
    /// The scene.
    pub scene: Rc<Scene>,
    /// Its load steps, one of them where the scene has none; never empty.
    pub steps: Vec<SolvedStep>,
    /// Seconds of assembly, set-up and all steps.
    seconds: f64,
}

/// The solution of a load step, with the rows of all ranks.
pub struct SolvedStep {
    /// The solution.
    pub solution: Solution,
    /// The rows along normals.
    pub rows: Vec<SolvedRow>,
    /// The rows along the sides, of nodes with friction.
    pub tangential: Vec<SolvedRow>,
    /// The displacements of the nodes that may touch.
    pub displaced: Displaced,
}

/// A scene that was solved although it has no solution.
pub struct RefusedScene {
    /// The sentence or the status with which it was refused; `None` if it was not.
    pub said: Option<String>,
    file: String,
    dofs: usize,
    seconds: f64,
}

impl Runner<'_> {
    /// Solves the scene `text`, which is left as `name`.toml. Collective.
    ///
    /// # Errors
    /// Those of the disk, of the scene and of the method.
    pub fn solve(&mut self, name: &str, text: &str) -> Result<SolvedScene> {
        self.solve_to(name, text, None, RTOL)
    }

    /// As [`Runner::solve`], with a mesh that is left under its own name.
    ///
    /// # Errors
    /// As [`Runner::solve`].
    pub fn solve_mesh(&mut self, name: &str, text: &str, mesh: &MeshFile) -> Result<SolvedScene> {
        self.solve_to(name, text, Some(mesh), RTOL)
    }

    /// As [`Runner::solve`], to a relative residual.
    ///
    /// # Errors
    /// As [`Runner::solve`].
    pub fn solve_to(
        &mut self,
        name: &str,
        text: &str,
        mesh: Option<&MeshFile>,
        rtol: f64,
    ) -> Result<SolvedScene> {
        (self.progress)(&format!("{}, {name}", self.case));
        let file = format!("{name}.toml");
        let path = self.dir.join(&file);
        // Ranks may have one directory or each its own.
        let write = || {
            if let Some(mesh) = mesh {
                let bytes = gmsh::write(mesh);
                output::write_file(&self.dir.join(&mesh.name), |out| out.write_all(&bytes))?;
            }
            output::write_text(&path, text)
        };
        for rank in 0..self.session.size() {
            let mine = rank == self.session.rank();
            self.session.agree(if mine { write() } else { Ok(()) })?;
        }
        let scene = solved::scene(&path.display().to_string(), text);
        let scene = Rc::new(self.session.agree(scene)?);
        let clock = Instant::now();
        let steps = distribution::with_options(self.session, &scene.options, || {
            let settings = Stepper::settings(&scene).rtol(rtol);
            let problem = distribution::substructures(self.session, &scene)?;
            let solver = FetiFeti::new(self.session, problem, settings)?;
            let mut stepper = Stepper::with_solver(scene.clone(), solver)?;
            let mut steps = Vec::new();
            while let Some(step) = stepper.next().transpose()? {
                steps.push(SolvedStep::new(self.session, &stepper, step));
            }
            Ok(steps)
        })?;
        Ok(SolvedScene {
            file,
            scene,
            steps,
            seconds: clock.elapsed().as_secs_f64(),
        })
    }

    /// Solves a scene that has no solution. Collective.
    ///
    /// # Errors
    /// Those of the disk, and of scenes that cannot be read.
    pub fn refused(&mut self, name: &str, text: &str) -> Result<RefusedScene> {
        let clock = Instant::now();
        let said = match self.solve(name, text) {
            Ok(run) => {
                let solutions = run.steps.iter().map(|step| &step.solution);
                let failed = solutions.filter(|s| !s.converged());
                failed.map(|s| s.status.name().to_string()).next()
            }
            Err(e) if matches!(e.kind(), ErrorKind::Input | ErrorKind::NotConverged) => {
                Some(e.to_string())
            }
            Err(e) => return Err(e),
        };
        let file = format!("{name}.toml");
        let scene = self.session.agree(solved::scene(&file, text))?;
        Ok(RefusedScene {
            file,
            said,
            dofs: Numbering::new(&scene).len() as usize,
            seconds: clock.elapsed().as_secs_f64(),
        })
    }
}

impl RefusedScene {
    /// The record of a mesh on which nothing was to be found.
    pub fn mesh(self, mesh: String, size: f64, values: Vec<MeasuredValue>) -> MeshResult {
        MeshResult {
            mesh,
            size,
            scene: self.file,
            dofs: self.dofs,
            values,
            curve: Vec::new(),
            outer_iterations: 0,
            iterations: 0,
            condition: None,
            kkt: None,
            converged: true,
            seconds: self.seconds,
        }
    }
}

impl SolvedStep {
    fn new(session: &Session, stepper: &Stepper, step: StepSolution) -> SolvedStep {
        let rows = |rows| SolvedRow::on_all_ranks(session.comm(), rows);
        let local = &stepper.solver().problem().local;
        let (scene, u) = (stepper.scene(), &step.solution.u);
        SolvedStep {
            rows: rows(step.solution.rows()),
            tangential: rows(step.solution.tangential_rows()),
            displaced: Displaced::gather(session, scene, local, u, step.step),
            solution: step.solution,
        }
    }
}

impl SolvedScene {
    /// The last load step.
    pub fn last(&self) -> &SolvedStep {
        self.steps.last().expect("a load step")
    }

    /// The record of this mesh; iterations are those of all load steps.
    pub fn mesh(
        &self,
        mesh: impl Into<String>,
        size: f64,
        values: Vec<MeasuredValue>,
    ) -> MeshResult {
        let solutions = || self.steps.iter().map(|step| &step.solution);
        // A step of few iterations knows little of the spectrum.
        let estimates = solutions().flat_map(|s| {
            let steps = s.steps.iter().map(|step| step.estimate);
            steps.chain([s.estimate])
        });
        let kappa = estimates.flatten().map(|s| s.lambda_max / s.lambda_min);
        let kkt = solutions().map(|s| Kkt::new(&s.kkt, true).largest());
        MeshResult {
            mesh: mesh.into(),
            size,
            scene: self.file.clone(),
            dofs: Numbering::new(&self.scene).len() as usize,
            values,
            curve: Vec::new(),
            outer_iterations: solutions().map(|s| s.steps.len()).sum(),
            iterations: solutions().map(|s| s.iterations).sum(),
            condition: kappa.reduce(f64::max),
            kkt: kkt.reduce(f64::max),
            converged: solutions().all(Solution::converged),
            seconds: self.seconds,
        }
    }

    /// The record of this mesh with the pressure along the contact, which is put in order.
    pub fn with_curve(
        &self,
        mesh: impl Into<String>,
        size: f64,
        values: Vec<MeasuredValue>,
        mut curve: Vec<ReferencePressure>,
    ) -> MeshResult {
        curve.sort_by(|a, b| a.x.total_cmp(&b.x));
        MeshResult {
            curve,
            ..self.mesh(mesh, size, values)
        }
    }

    /// The largest |p/`expected` − 1| of the pressures of the rows that `select` takes, 1 where it takes none.
    pub fn worst_pressure(&self, expected: f64, select: impl Fn(&SolvedRow) -> bool) -> f64 {
        let rows = self.last().rows.iter().filter(|r| select(r));
        let off = rows.map(|r| match r.pressure() {
            Some(p) if r.holds() => (p / expected - 1.0).abs(),
            _ => 1.0,
        });
        off.reduce(f64::max).unwrap_or(1.0)
    }
}

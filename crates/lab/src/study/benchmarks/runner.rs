//! Writes the scene of a case with its mesh, solves it, and enters what the solver says into a report.

use std::path::Path;

use super::report::{MeasuredValue, MeshResult, ReferencePressure};
use crate::study::solved::Solved;
use base::Result;
use fetifeti::settings::MethodSettings;
use fetifeti::solution::SolvedRow;
use mesh::{gmsh, MeshFile};
use petsc::Session;
use report::json::Kkt;
use report::output;

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

/// A scene and its solution.
pub struct SolvedScene {
    /// The file of the scene.
    pub file: String,
    /// The solution.
    pub solved: Solved,
    /// The rows of all ranks.
    pub rows: Vec<SolvedRow>,
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
        let settings = MethodSettings::default().rtol(rtol);
        let solved = Solved::new(self.session, &path.display().to_string(), text, &settings)?;
        let rows = solved.rows(self.session);
        Ok(SolvedScene { file, solved, rows })
    }
}

impl SolvedScene {
    /// The record of this mesh.
    pub fn mesh(
        &self,
        mesh: impl Into<String>,
        size: f64,
        values: Vec<MeasuredValue>,
    ) -> MeshResult {
        let solution = &self.solved.solution;
        // A step of few iterations knows little of the spectrum.
        let estimates = solution.steps.iter().map(|s| s.estimate);
        let estimates = estimates.chain([solution.estimate]).flatten();
        let kappa = estimates.map(|s| s.lambda_max / s.lambda_min);
        let kappa = kappa.reduce(f64::max);
        MeshResult {
            mesh: mesh.into(),
            size,
            scene: self.file.clone(),
            dofs: self.solved.dofs(),
            values,
            curve: Vec::new(),
            outer_iterations: solution.steps.len(),
            iterations: solution.iterations,
            condition: kappa,
            kkt: Some(Kkt::new(&solution.kkt, true).largest()),
            converged: solution.converged(),
            seconds: self.solved.seconds,
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
        let rows = self.rows.iter().filter(|r| select(r));
        let off = rows.map(|r| match r.pressure() {
            Some(p) if r.holds() => (p / expected - 1.0).abs(),
            _ => 1.0,
        });
        off.reduce(f64::max).unwrap_or(1.0)
    }
}

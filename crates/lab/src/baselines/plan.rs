//! The plan of a comparison: which methods run, in which layout, and to which residual.

use std::path::Path;
use std::time::Duration;

use super::table::{Baseline, BaselineCase};
use super::task::BaselineTask;
use crate::assembled::system::MatrixFormat;
use base::{Error, Result};
use parallel::exchange::any;
use petsc::{Options, Session};
use report::tables::summary::ranks;
use scene::Scene;

/// Default of `-compare_inner_rtol`.
const INNER: f64 = 0.1;

/// Default of `-compare_max_ranks`. A rank takes some 50 MB before it has read anything: 512 of them, one for each
/// subdomain of a scene of 512 bodies, were more than 24 GB, and the system ended other programs.
const MAX_RANKS: usize = 256;

/// The layout of ours in which bodies that are tied for good are one.
const MERGED: &str = "merged";

/// The layout with as many ranks as cores that keeps the subdomains apart.
const PACKED: &str = "packed";

/// One method in one layout.
pub struct PlannedRun {
    /// `None`: ours.
    pub baseline: Option<&'static Baseline>,
    /// How the method uses the machine: `threads`, `ranks` or `merged` (threads, and tied bodies as one) for ours, for
    /// the others a rank per `core`, `body` or `subdomain`, or `packed`: a rank per core with several subdomains in its
    /// matrix.
    pub layout: &'static str,
    /// MPI ranks.
    pub ranks: usize,
    /// Threads per rank.
    pub threads: usize,
    /// Parts of the domain that the method sees.
    pub parts: Option<usize>,
    /// Its options without the tolerance, as a user writes them; those with the second try's behind.
    pub options: [String; 2],
    /// The functions of PETSc by which it is told more than options say.
    pub given: String,
    /// The sentence where this PETSc lacks the method.
    pub missing: Option<String>,
}

impl PlannedRun {
    /// The method's name.
    pub fn name(&self) -> &'static str {
        self.baseline.map_or("fetifeti", |b| b.name)
    }

    /// Method and ranks, for progress messages.
    pub fn title(&self) -> String {
        format!("{} on {}", self.name(), ranks(self.ranks))
    }

    /// The option of this tolerance of the method's own residual, behind others.
    pub fn tolerance(&self, rtol: f64) -> String {
        // Three digits, rounded to the smaller number: written again it asks for no less.
        let digits = 10_f64.powf(rtol.log10().floor() - 2.0);
        let rounded = (rtol / digits * (1.0 + 1e-12)).floor() * digits;
        let text = format!("{rounded:.2e}").replace(".00e", "e");
        let krylov = self.baseline.map_or("fetifeti_", |b| b.krylov);
        let space = if self.options[0].is_empty() { "" } else { " " };
        format!("{space}-{krylov}ksp_rtol {text}")
    }

    /// The job; `active`: rows of the last known active set.
    pub fn task(&self, solution: &Path, rescue: bool, active: &[usize]) -> BaselineTask {
        let solution = solution.to_path_buf();
        match self.baseline {
            None => BaselineTask::FetiFeti {
                threads: self.threads,
                merges: self.layout == MERGED,
                solution,
            },
            Some(b) => BaselineTask::Baseline {
                name: b.name.into(),
                rescue,
                separate: self.layout == PACKED,
                active: active.to_vec(),
                solution,
            },
        }
    }
}

/// The layouts in which domain decompositions of PETSc run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layouts {
    /// A part per subdomain, and a part per core.
    Two,
    /// Also a part per body.
    Three,
}

/// The runs, and the residual they have to reach.
pub struct BaselinePlan {
    /// Relative residual.
    pub rtol: f64,
    /// Reduction of the residual in a contact step while the active set changes.
    pub inner: f64,
    /// Cores that every method may use.
    pub cores: usize,
    /// Ranks that a method may have.
    pub max_ranks: usize,
    /// Time limit of one method.
    pub limit: Duration,
    /// The methods.
    pub runs: Vec<PlannedRun>,
}

impl BaselinePlan {
    /// The plan according to the options.
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) for a value out of range, and for a scene whose contacts follow
    /// from load steps before the last one.
    pub fn new(
        session: &Session,
        scene: &Scene,
        baselines: &[&'static Baseline],
        layouts: Layouts,
    ) -> Result<BaselinePlan> {
        if scene.is_renewed() {
            return Err(Error::input(format!(
                "the scene \"{}\" has `update` in [steps]: its contacts follow from the load steps before, and methods \
                 are compared on one step alone (a scene without `update` was expected)",
                scene.title
            )));
        }
        let ours = Options::new(session, "fetifeti_");
        let rtol = ours.get_f64("ksp_rtol")?.unwrap_or(1e-6);
        if !(rtol > 0.0 && rtol < 1.0) {
            return Err(Error::input(format!(
                "-fetifeti_ksp_rtol is {rtol}, expected a number between 0 and 1"
            )));
        }
        let options = Options::new(session, "compare_");
        options.heading("Options of compare")?;
        let all = std::thread::available_parallelism().map_or(1, |n| n.get());
        let cores = options
            .usize("cores", all, "cores that every method may use")?
            .max(1);
        let max_ranks = options.usize("max_ranks", MAX_RANKS, "ranks that a method may have")?;
        if cores > max_ranks {
            return Err(Error::input(format!(
                "-compare_cores is {cores}, expected at most {max_ranks}, the ranks that a method may have \
                 (-compare_max_ranks)"
            )));
        }
        let help = "reduction of the residual per contact step while the active set changes";
        let inner = options.f64("inner_rtol", INNER, help)?;
        if !(inner > 0.0 && inner < 1.0) {
            return Err(Error::input(format!(
                "-compare_inner_rtol is {inner}, expected a number between 0 and 1"
            )));
        }
        let limit = options
            .usize("time_limit", 600, "seconds after which a method is ended")?
            .max(1);
        Ok(BaselinePlan {
            rtol,
            inner,
            cores,
            max_ranks,
            limit: Duration::from_secs(limit as u64),
            runs: runs(session, scene, cores, baselines, layouts)?,
        })
    }
}

/// Ours with threads and with ranks; domain decompositions of PETSc on the same subdomains and on fewer parts; the
/// others on all cores.
fn runs(
    session: &Session,
    scene: &Scene,
    cores: usize,
    baselines: &[&'static Baseline],
    layouts: Layouts,
) -> Result<Vec<PlannedRun>> {
    let first = BaselineCase::of(session, scene)?;
    let second = BaselineCase {
        rescue: true,
        ..first
    };
    let given = ours_given(session)?;
    let (subdomains, bodies) = (scene.n_subdomains(), scene.n_bodies());
    let options = |layout| match layout {
        MERGED => format!("-fetifeti_merge ties {given}")
            .trim_end()
            .to_string(),
        _ => given.clone(),
    };
    let ours = |layout, ranks, threads| PlannedRun {
        baseline: None,
        layout,
        ranks,
        threads,
        parts: Some(subdomains),
        options: [options(layout), options(layout)],
        given: String::new(),
        missing: None,
    };
    let mut runs = vec![ours("threads", 1, cores)];
    if cores > 1 && subdomains > 1 {
        runs.push(ours("ranks", cores.min(subdomains), 1));
    }
    let asked = Options::new(session, "fetifeti_").has("merge")?;
    let tied = !scene.is_ragged() && any(session.comm(), scene.has_whole_ties());
    if layouts == Layouts::Two && tied && !asked {
        // The assembled problem that the others solve knows no rows on these faces.
        runs.push(ours(MERGED, 1, cores));
    }
    for &baseline in baselines {
        let options = [
            baseline.written(session, &first)?,
            baseline.written(session, &second)?,
        ];
        let missing = baseline.missing(session)?;
        let on = |layout, ranks, parts| PlannedRun {
            baseline: Some(baseline),
            layout,
            ranks,
            threads: 1,
            parts,
            options: options.clone(),
            given: baseline.given(&first),
            missing: missing.clone(),
        };
        match baseline.format {
            // Its row says why, once.
            _ if missing.is_some() => runs.push(on("core", cores, None)),
            MatrixFormat::Assembled => runs.push(on("core", cores, None)),
            MatrixFormat::Unassembled | MatrixFormat::Separate => {
                runs.push(on("subdomain", subdomains, Some(subdomains)));
                let few = cores.min(subdomains);
                // KSPFETIDP's own numbering does not know repeated entries.
                if few < subdomains && baseline.krylov.is_empty() && petsc::REPEATS {
                    runs.push(on(PACKED, few, Some(subdomains)));
                }
                if layouts == Layouts::Three && few < bodies && bodies < subdomains {
                    runs.push(on("body", bodies, Some(bodies)));
                }
                if few < subdomains {
                    runs.push(on("core", few, Some(few)));
                }
            }
        }
    }
    Ok(runs)
}

/// The options that the user gave ours, without the tolerance.
fn ours_given(session: &Session) -> Result<String> {
    let mut all = Options::new(session, "fetifeti_").all()?;
    all.retain(|(name, _)| name != "-fetifeti_ksp_rtol");
    let written = all.iter().map(|(name, value)| format!("{name} {value}"));
    let written: Vec<String> = written
        .map(|option| option.trim_end().to_string())
        .collect();
    Ok(written.join(" "))
}

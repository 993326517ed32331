//! `study hard-cases`: problems that are hard for the method, each compared with a direct solution that shares only
//! matrices with it, and where a force is known beforehand with that, too.
//!
//! The purpose is to show that no wrong answer is called a solution. A case ends as `solved`; as `not converged` or
//! `refused`, where the program says so itself; or as `WRONG`.

mod cases;
mod decks;
mod trackers;

pub use cases::{cases, HardCase};
pub use decks::{decks, KnownDisplacement};
pub use trackers::{trackers, KnownForce};

use serde::{Deserialize, Serialize};

use super::solved::Solved;
use crate::assembled::layout::UnknownLayout;
use crate::assembled::reference::Reference;
use crate::assembled::system::Copies;
use base::{Error, Result};
use fetifeti::settings::{MergeKind, MethodSettings};
use fetifeti::solution::SolvedRow;
use fetifeti::FetiFeti;
use parallel::exchange::highest;
use petsc::Session;
use report::json;
use report::tables::table::{condition, count, fixed, scientific, Table};

/// Relative residual that is asked of the method.
pub const RTOL: f64 = 1e-8;

/// Largest admissible distance of an answer from the direct solution, relative to it, in the energy norm and in the
/// largest displacement.
pub const LIMIT: f64 = 1e-3;

/// Exact spectra are computed up to this number of multipliers; the second number is for the quick study.
const SPECTRUM: [usize; 2] = [1200, 400];

/// How a case ended.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HardCaseOutcome {
    /// Converged, and near the direct solution.
    Solved,
    /// The solver says that it did not converge.
    #[default]
    NotConverged,
    /// The program refuses the scene with a sentence, and the direct solver finds no solution either.
    Refused,
    /// Converged, but not to the solution; or a solvable scene is refused.
    Wrong,
}

impl HardCaseOutcome {
    /// The word for tables.
    pub fn name(self) -> &'static str {
        match self {
            HardCaseOutcome::Solved => "solved",
            HardCaseOutcome::NotConverged => "not converged (said so)",
            HardCaseOutcome::Refused => "no solution (said so)",
            HardCaseOutcome::Wrong => "WRONG",
        }
    }
}

/// The study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HardCasesReport {
    /// Its name, "hard-cases".
    pub study: String,
    /// Relative residual that was asked for.
    pub rtol: f64,
    /// Distance from the direct solution above which an answer is wrong.
    pub limit: f64,
    /// The cases.
    pub cases: Vec<Record>,
}

/// One case.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Its name.
    pub case: String,
    /// The difficulty of the case.
    pub title: String,
    /// Unknowns.
    pub dofs: usize,
    /// Subdomains.
    pub subdomains: usize,
    /// Multipliers.
    pub multipliers: usize,
    /// Steps of the contact loop; 0 without inequalities.
    pub outer_iterations: usize,
    /// Krylov iterations in total.
    pub iterations: usize,
    /// κ with the active rows at the end.
    pub condition: json::Condition,
    /// A force that is known beforehand: found, and known.
    pub force: Option<[f64; 2]>,
    /// A displacement that is known beforehand: found, and known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub displacement: Option<[f64; 2]>,
    /// Why there is no direct solution, where the assembled problem has no form for one. The certificate decides then.
    pub undecided: Option<String>,
    /// The certificate of the method.
    pub kkt: Option<json::Kkt>,
    /// Distance from the direct solution in the energy norm, relative.
    pub error_energy: Option<f64>,
    /// The largest difference of a displacement, over the largest displacement.
    pub error_max: Option<f64>,
    /// Number of active rows, in our solution and in the direct one.
    pub active: [Option<usize>; 2],
    /// The largest residual of the direct solution; `None` where there is no direct solution.
    pub reference: Option<f64>,
    /// The verdict.
    pub verdict: HardCaseOutcome,
    /// The program's message, where it did not solve the case.
    pub message: Option<String>,
    /// Seconds of assembly, set-up and solve.
    pub seconds: f64,
}

impl HardCasesReport {
    /// The cases that are wrong.
    pub fn wrong(&self) -> impl Iterator<Item = &Record> {
        self.cases
            .iter()
            .filter(|c| c.verdict == HardCaseOutcome::Wrong)
    }
}

/// Runs all cases, and calls `progress` before each. Collective.
///
/// # Errors
/// A scene that cannot be read, and PETSc's own errors.
pub fn run(
    session: &Session,
    quick: bool,
    only: Option<&str>,
    progress: &mut dyn FnMut(&str),
) -> Result<HardCasesReport> {
    let mut records = Vec::new();
    for (of, case) in super::numbered(super::chosen(cases(quick), |c| c.name, only)?) {
        progress(&format!("{of}, {}", case.name));
        records.push(one(session, &case, SPECTRUM[usize::from(quick)])?);
    }
    Ok(HardCasesReport {
        study: "hard-cases".into(),
        rtol: RTOL,
        limit: LIMIT,
        cases: records,
    })
}

/// Solves one case and compares it with the direct solution; exact spectra up to `spectrum` multipliers. Collective.
///
/// # Errors
/// As [`run`].
pub fn one(session: &Session, case: &HardCase, spectrum: usize) -> Result<Record> {
    let ending = if case.text.starts_with('*') {
        "inp"
    } else {
        "toml"
    };
    let file = format!("{}.{ending}", case.name);
    let scene = session.agree(super::solved::scene(&file, &case.text))?;
    let mut record = Record {
        case: case.name.into(),
        title: case.title.clone(),
        dofs: scene::Numbering::new(&scene).len() as usize,
        subdomains: scene.n_subdomains(),
        ..Record::default()
    };
    let settings = MethodSettings::default().rtol(RTOL).merge(MergeKind::None);
    let mut solved = match Solved::new(session, &file, &case.text, &settings) {
        Ok(solved) => solved,
        // The scene has been read: a refusal from here on says that it has no solution.
        Err(e) if refused_or_failed(&e) => {
            record.message = Some(e.to_string());
            let exists = Reference::certified(session, &scene, &UnknownLayout::new(&scene)).is_ok();
            record.verdict = match (exists, e.is_not_converged()) {
                (true, false) => HardCaseOutcome::Wrong,
                (true, true) => HardCaseOutcome::NotConverged,
                (false, _) => HardCaseOutcome::Refused,
            };
            return Ok(record);
        }
        Err(e) => return Err(e),
    };
    fill(session, &mut solved, spectrum, &mut record)?;
    if let Some(known) = &case.force {
        let along = |r: &SolvedRow| r.multiplier * r.normal()[known.axis];
        let found = solved.rows(session).iter().map(along).sum();
        record.force = Some([found, known.value]);
    }
    if let Some(known) = &case.point {
        record.displacement = Some([displacement(session, &solved, known), known.value]);
    }
    compare(session, &solved, &mut record)?;
    judge(&solved, case, &mut record);
    Ok(record)
}

fn multipliers(solver: &FetiFeti) -> usize {
    let facts = solver.facts();
    facts.multipliers_local + facts.multipliers_global
}

/// Fills the record with the method's own report.
fn fill(session: &Session, solved: &mut Solved, exact: usize, record: &mut Record) -> Result<()> {
    if multipliers(&solved.solver) <= exact {
        // If the eigensolver fails, the solution remains valid.
        record.condition.exact = solved.solver.spectrum().ok().flatten().map(Into::into);
    }
    let (solver, solution) = (&solved.solver, &solved.solution);
    let facts = solver.facts();
    record.multipliers = multipliers(solver);
    record.outer_iterations = solution.steps.len();
    record.iterations = solution.iterations;
    record.seconds = solved.seconds;
    record.condition.estimate = solution.estimate.map(Into::into);
    record.kkt = Some(json::Kkt::new(&solution.kkt, facts.inequalities > 0));
    let rows = solved.rows(session);
    let active = rows
        .iter()
        .filter(|r| r.is_inequality() && r.holds())
        .count();
    record.active[0] = (facts.inequalities > 0).then_some(active);
    Ok(())
}

/// The displacement at a node, which some rank has. Collective.
fn displacement(session: &Session, solved: &Solved, known: &KnownDisplacement) -> f64 {
    let mut found = f64::NEG_INFINITY;
    for (sub, u) in solved.solver.problem().local.iter().zip(&solved.solution.u) {
        let body = &solved.scene.bodies[sub.body];
        for (i, point) in sub.coordinates.iter().flatten().enumerate() {
            let axis = (sub.dofs[i] - body.first_dof) as usize % body.components;
            let near = (0..3).all(|d| (point[d] - known.at[d]).abs() < 1e-9);
            if near && axis == known.axis {
                found = u[i];
            }
        }
    }
    highest(session.comm(), found)
}

/// Compares with the direct solution.
fn compare(session: &Session, solved: &Solved, record: &mut Record) -> Result<()> {
    let (solver, solution) = (&solved.solver, &solved.solution);
    let layout = UnknownLayout::new(&solved.scene);
    if let Some(trouble) = &layout.trouble {
        record.undecided = Some(trouble.clone());
        return Ok(());
    }
    match Reference::certified(session, &solved.scene, &layout) {
        Ok(direct) => {
            let local = &solver.problem().local;
            let [energy, largest] = direct.distance(local, &solution.u, Copies::Alike)?;
            record.error_energy = Some(energy);
            record.error_max = Some(largest);
            record.reference = Some(direct.found.certificate.largest());
            let groups = direct.problem.groups(&mut direct.found.active.clone());
            let active = groups.holds.iter().filter(|holds| **holds).count();
            record.active[1] = record.active[0].map(|_| active);
        }
        Err(e) if e.is_not_converged() => {
            if session.rank() == 0 {
                eprintln!("{}: {e}", solved.scene.title);
            }
        }
        Err(e) => return Err(e),
    }
    if record.reference.is_none() {
        record.message = Some("the direct solver finds no solution".into());
    }
    Ok(())
}

/// Whether a scene was refused, or its solve did not converge.
fn refused_or_failed(error: &Error) -> bool {
    use base::ErrorKind::{Input, NotConverged, Unfit};
    matches!(error.kind(), Input | Unfit | NotConverged)
}

/// The verdict, when all comparisons are made.
fn judge(solved: &Solved, case: &HardCase, record: &mut Record) {
    let near = |e: Option<f64>| e.is_some_and(|e| e <= LIMIT);
    let right = match record.undecided {
        None => near(record.error_energy) && near(record.error_max),
        // The problem is convex: what satisfies the conditions of optimality is the solution.
        Some(_) => near(record.kkt.map(|kkt| kkt.largest())),
    };
    let within = |known: Option<f64>, found: Option<[f64; 2]>| match (known, found) {
        (Some(within), Some([found, value])) => (found - value).abs() <= within,
        _ => true,
    };
    let balanced = within(case.force.map(|k| k.within), record.force)
        && within(case.point.map(|k| k.within), record.displacement);
    record.verdict = match (solved.solution.converged(), right && balanced) {
        (false, _) => HardCaseOutcome::NotConverged,
        (true, true) => HardCaseOutcome::Solved,
        (true, false) => HardCaseOutcome::Wrong,
    };
    if record.verdict == HardCaseOutcome::NotConverged {
        record.message = Some(solved.solution.status.to_string());
    }
}

/// All cases.
pub fn table(report: &HardCasesReport) -> Table {
    let outer = |c: &Record| Some(c.outer_iterations).filter(|n| *n > 0);
    let set = |c: &Record| match c.active {
        [Some(ours), Some(direct)] => format!("{ours}/{direct}"),
        [Some(ours), None] => ours.to_string(),
        _ => String::new(),
    };
    Table::of(&report.cases)
        .words("case", |c| &c.case)
        .numbers("dofs", |c| c.dofs)
        .numbers("sub", |c| c.subdomains)
        .numbers("mult", |c| c.multipliers)
        .numbers("outer", |c| count(outer(c)))
        .numbers("it", |c| c.iterations)
        .numbers("κ exact", |c| {
            condition(c.condition.exact.map(|s| s.kappa))
        })
        .numbers("κ est", |c| {
            condition(c.condition.estimate.map(|s| s.kappa))
        })
        .numbers("kkt", |c| scientific(c.kkt.map(|kkt| kkt.largest())))
        .numbers("error energy", |c| scientific(c.error_energy))
        .numbers("error max", |c| scientific(c.error_max))
        .numbers("force", |c| scientific(c.force.map(|f| f[0])))
        .numbers("set", |c| set(c))
        .numbers("direct", |c| scientific(c.reference))
        .numbers("s", |c| fixed(Some(c.seconds), 2))
        .words("verdict", |c| c.verdict.name())
        .table()
}

/// The table for terminals, with descriptions of the cases and messages of the program.
pub fn text(report: &HardCasesReport) -> String {
    let mut out = format!(
        "Hard cases: rtol {:e}; errors against a direct solution; force: where it is known beforehand; \
         set: rows that hold, ours/direct\n{}\n",
        report.rtol,
        table(report)
    );
    for c in &report.cases {
        out += &format!("{}: {}", c.case, c.title);
        if let Some([found, known]) = c.force {
            out += &format!(". Force {found:.7e}, known {known:.7e}");
        }
        if let Some([found, known]) = c.displacement {
            out += &format!(". Displacement {found:.7e}, known {known:.7e}");
        }
        if let Some(message) = &c.message {
            out += &format!(". Said: {message}");
        }
        if let Some(why) = &c.undecided {
            out += &format!(". No direct solution, the certificate decides: {why}");
        }
        out += "\n";
    }
    out
}

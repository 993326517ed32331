//! Condition numbers of contact with friction beside those of ties and of contact without friction.
//!
//! Every scene is held so that it stands without friction, too, and is solved with each law and the same loads. The
//! last step of a contact loop begins near the solution, and its Krylov method sees a part of the spectrum alone. The
//! estimate is therefore that of CG from zero, for a load without symmetry, on a problem of its own whose rows hold as
//! they did in the end.

use serde::{Deserialize, Serialize};

use super::scenes::{self, FrictionScene};
use base::{Error, Result};
use fetifeti::problem::Law;
use fetifeti::settings::{Adaptive, MethodSettings};
use fetifeti::solution::RowState;
use fetifeti::Status;
use fetifeti::{FetiFeti, Problem, Row, Solution};
use parallel::contiguous_share;
use petsc::Session;
use report::tables::table::Table;
use scene::Scene;

/// A law of all contacts of a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ContactLaw {
    /// Ties in place of all contacts.
    Tied,
    /// Contact without friction.
    Frictionless,
    /// Coulomb's friction.
    Friction,
    /// Friction, and contact of this stiffness by area and length.
    Soft(f64),
    /// Friction, contact and elastic slip of this stiffness.
    ElasticSlip(f64),
}

impl ContactLaw {
    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            ContactLaw::Tied => "tied",
            ContactLaw::Frictionless => "frictionless",
            ContactLaw::Friction => "friction",
            ContactLaw::Soft(_) => "soft",
            ContactLaw::ElasticSlip(_) => "elastic slip",
        }
    }

    /// The stiffness of the springs; `None` where rows are rigid.
    pub fn stiffness(self) -> Option<f64> {
        match self {
            ContactLaw::Soft(k) | ContactLaw::ElasticSlip(k) => Some(k),
            ContactLaw::Tied | ContactLaw::Frictionless | ContactLaw::Friction => None,
        }
    }

    /// The keys of a contact in a scene, with this coefficient of friction.
    pub(super) fn keys(self, coefficient: f64) -> String {
        let friction = format!("friction = {coefficient}\n");
        match self {
            ContactLaw::Frictionless => String::new(),
            // Ties hold the tangential rows, too.
            ContactLaw::Tied | ContactLaw::Friction => friction,
            ContactLaw::Soft(k) => format!("{friction}stiffness = {k:e}\n"),
            ContactLaw::ElasticSlip(k) => {
                format!("{friction}stiffness = {k:e}\nstick_stiffness = {k:e}\n")
            }
        }
    }
}

/// Ends of a spectrum.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Ends {
    /// The smallest eigenvalue.
    pub lambda_min: f64,
    /// The largest eigenvalue.
    pub lambda_max: f64,
    /// λ_max / λ_min.
    pub kappa: f64,
}

impl From<fetifeti::solution::Spectrum> for Ends {
    fn from(of: fetifeti::solution::Spectrum) -> Ends {
        Ends {
            lambda_min: of.lambda_min,
            lambda_max: of.lambda_max,
            kappa: of.kappa(),
        }
    }
}

/// One scene with one law.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct FrictionRow {
    /// The scene.
    pub scene: String,
    /// The law.
    pub law: String,
    /// The stiffness of its springs, by area and length; Young's modulus is 1.
    pub stiffness: Option<f64>,
    /// H_s/h.
    pub elements: usize,
    /// Free degrees of freedom of the subdomains, copies counted.
    pub dofs: usize,
    /// Nodes that stick.
    pub sticking: usize,
    /// Nodes that slip.
    pub slipping: usize,
    /// Steps of the contact loop; 1 without.
    pub steps: usize,
    /// Krylov iterations of all steps.
    pub iterations: usize,
    /// CG's estimate for the rows of the solution, from zero.
    pub estimate: Ends,
    /// The exact spectrum of the same operator, where it was asked for.
    pub exact: Option<Ends>,
    /// The exact spectrum of the last step as the solve reports it. In space the rows of nodes that slip are turned
    /// there, and those across the slip are springs.
    pub last_step: Option<Ends>,
}

/// The rows of one scene at one size. Collective.
///
/// # Errors
/// As [`super::run`].
pub fn rows(
    session: &Session,
    scene: &FrictionScene,
    elements: usize,
    laws: &[ContactLaw],
    exact: bool,
) -> Result<Vec<FrictionRow>> {
    laws.iter()
        .map(|&law| row(session, scene, elements, law, exact))
        .collect()
}

fn row(
    session: &Session,
    of: &FrictionScene,
    elements: usize,
    law: ContactLaw,
    exact: bool,
) -> Result<FrictionRow> {
    let scene = Scene::parse("kappa.toml", &scenes::text(of, elements, law))?;
    let mine = contiguous_share(scene.n_subdomains(), session.size(), session.rank());
    let mut problem = session.agree(scene.substructures(&|s| mine.contains(&s)))?;
    if law == ContactLaw::Tied {
        for row in &mut problem.rows {
            (row.law, row.holds) = (Law::Tie, true);
        }
        problem.friction.clear();
    }
    // κ of the preconditioner alone.
    let mut settings = MethodSettings::default().rtol(1e-9).adaptive(Adaptive::Off);
    settings.spectrum = exact;
    let mut solver = FetiFeti::new(session, problem.clone(), settings.clone())?;
    let solution = solver.solve()?;
    if !solution.converged() {
        return Err(Error::not_converged(format!(
            "kappa, {}, {}, H_s/h = {elements}: {}",
            of.name,
            law.name(),
            solution.status
        )));
    }
    let states = states(&problem, &solution);
    let [dofs, sticking, slipping] = totals(session, &problem, &states);
    let mut held = FetiFeti::new(session, as_held(problem, &states), settings)?;
    Ok(FrictionRow {
        scene: of.name.into(),
        law: law.name().into(),
        stiffness: law.stiffness(),
        elements,
        dofs,
        sticking,
        slipping,
        steps: solution.steps.len().max(1),
        iterations: solution.iterations,
        estimate: estimate(&held)?,
        exact: match exact {
            true => held.spectrum()?.map(Ends::from),
            false => None,
        },
        last_step: solution.steps.last().and_then(|s| s.exact).map(Ends::from),
    })
}

/// Degrees of freedom, nodes that stick and nodes that slip, over all ranks. Collective.
fn totals(session: &Session, problem: &Problem, states: &[RowState]) -> [usize; 3] {
    let count = |state: RowState| {
        let nodes = problem.friction.iter();
        let of = nodes.filter(|n| n.tangential.first().is_some_and(|&t| states[t] == state));
        of.count() as f64
    };
    let dofs: usize = problem.local.iter().map(|s| s.k.n()).sum();
    let mut out = [dofs as f64, count(RowState::Sticks), count(RowState::Slips)];
    parallel::exchange::sum_all(session.comm(), &mut out);
    out.map(|n| n as usize)
}

/// The states of the rows of a problem in its solution.
fn states(problem: &Problem, solution: &Solution) -> Vec<RowState> {
    let mut normal = solution.rows().iter();
    let mut tangential = solution.tangential_rows().iter();
    let state = |row: &Row| {
        let solved = match row.law {
            Law::Friction => tangential.next(),
            _ => normal.next(),
        };
        solved.expect("a row of the solution").state
    };
    problem.rows.iter().map(state).collect()
}

/// The problem whose rows hold to begin with where these states say so.
fn as_held(mut problem: Problem, states: &[RowState]) -> Problem {
    for (row, state) in problem.rows.iter_mut().zip(states) {
        row.holds = matches!(state, RowState::Holds | RowState::Tied | RowState::Sticks);
    }
    problem
}

/// CG from zero at A s, for a vector s that is rich in all eigenvectors. Collective.
fn estimate(solver: &FetiFeti) -> Result<Ends> {
    let (ksp, dual) = (solver.ksp(), solver.dual());
    let jump = &dual.stiffness.jump;
    let start = dual.multipliers()?;
    for (i, v) in start.array_mut()?.iter_mut().enumerate() {
        // Multiples of the golden ratio modulo one never repeat.
        *v = 2.0 * ((jump.first + i + 1) as f64 * 0.618_033_988_749_894_9).fract() - 1.0;
    }
    drop(dual);
    let (load, x) = (start.duplicate()?, start.duplicate()?);
    ksp.operator()?.mult(&start, &load)?;
    ksp.set_tolerances(Some(1e-11), None, None, None)?;
    ksp.solve(&load, &x)?;
    let reason = ksp.converged_reason()?;
    if !reason.converged() {
        return Err(Error::not_converged(format!(
            "kappa, the estimate: {}",
            Status::Krylov(reason)
        )));
    }
    let (lambda_max, lambda_min) = ksp.extreme_singular_values()?;
    Ok(Ends {
        lambda_min,
        lambda_max,
        kappa: lambda_max / lambda_min,
    })
}

/// The table that is printed and written as CSV.
pub fn table(rows: &[FrictionRow]) -> Table {
    let digits = |of: Option<f64>| of.map_or(String::new(), |v| format!("{v:.3}"));
    Table::of(rows)
        .words("scene", |r| &r.scene)
        .words("contact", |r| &r.law)
        .numbers("k", |r| {
            r.stiffness.map_or(String::new(), |k| k.to_string())
        })
        .numbers("H_s/h", |r| r.elements)
        .numbers("dofs", |r| r.dofs)
        .numbers("stick", |r| r.sticking)
        .numbers("slip", |r| r.slipping)
        .numbers("steps", |r| r.steps)
        .numbers("it", |r| r.iterations)
        .numbers("λ_min", |r| {
            format!("{:.6}", r.exact.unwrap_or(r.estimate).lambda_min)
        })
        .numbers("λ_max", |r| {
            format!("{:.3}", r.exact.unwrap_or(r.estimate).lambda_max)
        })
        .numbers("κ estimate", |r| format!("{:.3}", r.estimate.kappa))
        .when(rows.iter().any(|r| r.exact.is_some()), |t| {
            t.numbers("κ exact", |r| digits(r.exact.map(|e| e.kappa)))
                .numbers("κ last step", |r| digits(r.last_step.map(|e| e.kappa)))
        })
        .table()
}

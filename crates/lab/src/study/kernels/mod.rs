//! `study kernels`: every solver of `cholesky::interior` with every ordering, on the matrices of subdomains.
//!
//! The subdomain is the middle one of three in every direction, so that it floats and its whole surface is interface Γ.
//! Three kernels are timed on one thread, without the analysis of the pattern: the factorisation L Lᵀ = K_II, a solve
//! with it, and the Schur complement S on Γ. In every round all combinations of a case run one after the other, so that
//! other load on the machine affects all of them. The results are medians over the rounds.

mod subdomain;
mod tables;

pub use tables::{faster, summary, table, text};

use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use base::{Error, Result};
use cholesky::interior::{LocalSolver, NoFactor, Ordering, Solver};
use cholesky::symbolic::Keep;
use petsc::Session;
use subdomain::Sample;

/// A family of matrices.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KernelCase {
    /// Name in tables.
    pub name: &'static str,
    /// 2 or 3.
    pub dim: usize,
    /// Elasticity instead of a scalar.
    pub elastic: bool,
    /// Elements across the subdomain.
    pub sizes: &'static [usize],
}

/// The cases of the study.
pub const CASES: [KernelCase; 4] = [
    KernelCase {
        name: "scalar-2d",
        dim: 2,
        elastic: false,
        sizes: &[16, 64, 128],
    },
    KernelCase {
        name: "elastic-2d",
        dim: 2,
        elastic: true,
        sizes: &[16, 64],
    },
    KernelCase {
        name: "scalar-3d",
        dim: 3,
        elastic: false,
        sizes: &[8, 16, 22],
    },
    KernelCase {
        name: "elastic-3d",
        dim: 3,
        elastic: true,
        sizes: &[6, 12],
    },
];

/// A solver must be this many times faster than the default one to replace it.
pub const WORTH_CHANGING: f64 = 1.3;

/// Seconds and errors of one solver in one order.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct KernelRow {
    /// The case.
    pub case: String,
    /// Elements across the subdomain.
    pub elements: usize,
    /// Interior dofs.
    pub interior: usize,
    /// Interface dofs.
    pub interface: usize,
    /// The solver.
    pub solver: String,
    /// The order.
    pub ordering: String,
    /// Whether this combination is the default of the options.
    pub default: bool,
    /// Number of rounds, of which the medians are taken.
    pub rounds: usize,
    /// Seconds of the analysis of the pattern of K_II.
    pub analyse: f64,
    /// Seconds of L Lᵀ = K_II.
    pub factor: f64,
    /// Seconds of a solve with one right-hand side.
    pub solve: f64,
    /// Seconds of S.
    pub schur: f64,
    /// Bytes of the factor of K_II.
    pub bytes: usize,
    /// Largest error of the solution of K_II u = f with a known u, relative to the largest u.
    pub error: f64,
    /// Largest error of S u = g for a known u on the whole subdomain, relative to the largest g.
    pub schur_error: f64,
}

/// The study.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct KernelsReport {
    /// "kernels".
    pub study: String,
    /// The results by case, size, solver and ordering.
    pub rows: Vec<KernelRow>,
}

/// The measurements of one combination in one round.
#[derive(Default)]
struct Seconds {
    analyse: Vec<f64>,
    factor: Vec<f64>,
    solve: Vec<f64>,
    schur: Vec<f64>,
}

/// Runs the study.
///
/// # Errors
/// [`Error::Input`] on several ranks, which would disturb each other's timing; a solver that
/// fails.
pub fn run(
    session: &Session,
    quick: bool,
    only: Option<&str>,
    progress: &mut dyn FnMut(&str),
) -> Result<KernelsReport> {
    super::alone(session, "kernels", "it measures one thread")?;
    let mut rows = Vec::new();
    for (of, case) in super::numbered(super::chosen(CASES.to_vec(), |c| c.name, only)?) {
        let sizes = if quick { &case.sizes[..1] } else { case.sizes };
        for &elements in sizes {
            progress(&format!("{of}, {}, {elements} elements", case.name));
            rows.extend(one(&case, elements, quick)?);
        }
    }
    Ok(KernelsReport {
        study: "kernels".into(),
        rows,
    })
}

/// The combinations of solver and ordering that this build supports.
fn combinations() -> Vec<LocalSolver> {
    let orderings = || Ordering::ALL.into_iter().filter(|o| o.available());
    let solvers = Solver::ALL.into_iter();
    solvers
        .flat_map(|kind| orderings().map(move |ordering| LocalSolver { kind, ordering }))
        .collect()
}

/// Measures one subdomain. There is a least number of rounds; further rounds follow until there are enough or the time
/// is up.
fn one(case: &KernelCase, elements: usize, quick: bool) -> Result<Vec<KernelRow>> {
    let (fewest, most, time) = match quick {
        true => (3, 3, Duration::ZERO),
        false => (3, 15, Duration::from_secs(8)),
    };
    let sample = Sample::new(case, elements)?;
    let all = combinations();
    let mut rows: Vec<KernelRow> = all.iter().map(|s| empty(case, &sample, *s)).collect();
    let mut seconds: Vec<Seconds> = all.iter().map(|_| Seconds::default()).collect();
    let clock = Instant::now();
    for round in 0..most {
        if round >= fewest && clock.elapsed() > time {
            break;
        }
        for turn in 0..all.len() {
            // The order rotates: every combination is first once.
            let c = (turn + round) % all.len();
            let failed = |why: NoFactor| {
                let names = (all[c].kind.name(), all[c].ordering.name());
                Error::environment(format!("{} with {}: {why:?}", names.0, names.1))
            };
            measure(&sample, all[c], &mut rows[c], &mut seconds[c]).map_err(failed)?;
        }
    }
    for (row, s) in rows.iter_mut().zip(seconds) {
        row.rounds = s.factor.len();
        row.analyse = median(s.analyse);
        row.factor = median(s.factor);
        row.solve = median(s.solve);
        row.schur = median(s.schur);
    }
    Ok(rows)
}

fn empty(case: &KernelCase, sample: &Sample, solver: LocalSolver) -> KernelRow {
    let default = LocalSolver::default();
    KernelRow {
        case: case.name.into(),
        elements: sample.elements,
        interior: sample.inner.n(),
        interface: sample.interface.len(),
        solver: solver.kind.name().into(),
        ordering: solver.ordering.name().into(),
        default: (solver.kind, solver.ordering) == (default.kind, default.ordering.taken()),
        ..KernelRow::default()
    }
}

/// Solves are repeated and averaged: at least this number of times, and this long.
const SOLVES: u32 = 3;
const MEASURABLE: Duration = Duration::from_millis(1);

fn measure(
    sample: &Sample,
    solver: LocalSolver,
    row: &mut KernelRow,
    seconds: &mut Seconds,
) -> std::result::Result<(), NoFactor> {
    let clock = Instant::now();
    let analysis = solver.analyse(&sample.inner, &[], Some(&sample.inner_positions))?;
    seconds.analyse.push(clock.elapsed().as_secs_f64());
    let clock = Instant::now();
    let factor = analysis.factor(&sample.inner)?;
    seconds.factor.push(clock.elapsed().as_secs_f64());
    row.bytes = factor.bytes();
    let mut x = sample.inner_load.clone();
    // A first solve brings the factor into the caches if it fits there.
    factor.solve(&mut x);
    let (mut solves, clock) = (0, Instant::now());
    while solves < SOLVES || clock.elapsed() < MEASURABLE {
        x.clone_from(&sample.inner_load);
        factor.solve(&mut x);
        solves += 1;
    }
    let each = clock.elapsed().as_secs_f64() / f64::from(solves);
    seconds.solve.push(each);
    row.error = far(&x, &sample.inner_solution);
    drop((factor, analysis));

    let analysis = solver.analyse(&sample.k, &sample.interface, Some(&sample.positions))?;
    let clock = Instant::now();
    let (factor, s) = analysis.condense(&sample.k, Keep::Boundary)?;
    seconds.schur.push(clock.elapsed().as_secs_f64());
    // The condensed load of K u is S u_Γ.
    let mut work = sample.load.clone();
    factor.forward(&mut work);
    let on_gamma = |v: &[f64]| -> Vec<f64> {
        let gamma = sample.interface.iter();
        gamma.map(|&i| v[i as usize]).collect()
    };
    let mut g = vec![0.0; sample.interface.len()];
    s.add_mul(&on_gamma(&sample.solution), &mut g);
    row.schur_error = far(&g, &on_gamma(&work));
    Ok(())
}

/// The largest difference of two vectors over the largest entry of `b`.
fn far(a: &[f64], b: &[f64]) -> f64 {
    let size = b.iter().fold(0.0f64, |s, v| s.max(v.abs()));
    let far = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    far.fold(0.0, f64::max) / size
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    match values.len() {
        0 => f64::NAN,
        n if n % 2 == 1 => values[n / 2],
        n => 0.5 * (values[n / 2 - 1] + values[n / 2]),
    }
}

//! The measurements of one case.

use std::path::Path;
use std::time::Instant;

use super::{AdaptiveCase, AdaptiveRun, Bddc, Effort, Fine, Plain, Record, RTOL, USUAL};
use crate::assembled::layout::UnknownLayout;
use crate::assembled::reference::{Reference, ResidualPrecision};
use crate::assembled::system::Copies;
use crate::baselines::single;
use base::{ErrorKind, Result};
use fetifeti::settings::{Adaptive, MergeKind, MethodSettings};
use fetifeti::{FetiFeti, Problem, Solution, Subdomain};
use petsc::Session;
use report::output;
use scene::{distribution, Numbering, Scene};

/// Relative residuals below [`RTOL`]; rounding stops the iteration somewhere on the way.
const TIGHTER: [f64; 4] = [1e-10, 1e-12, 1e-14, 1e-15];

/// Without deflation, a κ above this is only CG's estimate: SLEPc takes minutes for the same digits.
const ESTIMATED: f64 = 1e4;

/// Options of PCBDDC besides the threshold. Adaptive constraints need deluxe scaling; an iteration that has not
/// converged after this many steps will not converge. Edges and motions are primal as well: here
/// iterations count, not seconds.
const ADAPTIVE: [&str; 8] = [
    "-bddc_pc_bddc_use_deluxe_scaling",
    "true",
    "-bddc_pc_bddc_use_nnsp",
    "true",
    "-bddc_pc_bddc_use_edges",
    "true",
    "-bddc_ksp_max_it",
    "500",
];

/// A solve and its cost.
struct MeasuredSolve {
    solver: FetiFeti,
    solution: Solution,
    seconds: f64,
}

/// Measures one case; its files go into `dir`.
///
/// # Errors
/// Those of the scene, of the disk and of PETSc. A method that fails is no error.
pub fn one(session: &Session, case: &AdaptiveCase, effort: Effort, dir: &Path) -> Result<Record> {
    let file = case.write(dir)?;
    let scene = distribution::load(session, &file)?;
    let problem = distribution::substructures(session, &scene)?;
    let mut record = Record {
        case: case.name.clone(),
        title: case.title.clone(),
        dofs: Numbering::new(&scene).len() as usize,
        bodies: case.bodies,
        subdomains: scene.n_subdomains(),
        ..Record::default()
    };
    let layout = UnknownLayout::new(&scene);
    let direct = Reference::certified(session, &scene, &layout);
    if let Err(e) = &direct {
        eprintln!("{}: {e}", case.name);
    }
    let direct = direct.ok();
    let court = DirectComparison {
        direct: direct.as_ref(),
        parts: &problem.local,
    };
    if let Some(direct) = &direct {
        record.reference = Some(direct.found.certificate.largest());
        record.last_place = Some(last_place(direct, &scene, &problem.local)?);
    }
    let known = direct.as_ref().map(|d| &d.found.active[..]);
    let mumps = mumps(session, &scene, &layout, known);
    if let Err(e) = &mumps {
        eprintln!("{}, MUMPS: {e}", case.name);
    }
    let mumps = mumps.ok().filter(|m| m.found.converged);
    if let Some(mumps) = &mumps {
        record.mumps = court.error(&mumps.values(&problem.local)?)?;
    }
    ours(session, &problem, &court, effort, &mut record)?;
    // In contact, PCBDDC solves the equations of a known active set.
    let known = mumps.is_some() || !scene.has_contact();
    if effort.patience > 0 && known {
        let list = |m: &Reference| m.problem.rows.list(&m.found.active);
        let active = mumps.as_ref().map_or_else(Vec::new, list);
        for run in &mut record.runs {
            run.bddc = Some(bddc(&file, &scene, case.bodies, run.tau, &active, effort)?);
        }
    }
    let (reference, mumps) = (record.reference.is_some(), record.mumps);
    for run in &mut record.runs {
        run.fails = run.judge(reference, mumps);
    }
    Ok(record)
}

/// The solution of MUMPS with iterative refinement in working precision. If its active-set loop does not settle and
/// `known` is given, the equations of that correct set are solved.
fn mumps<'a>(
    session: &Session,
    scene: &Scene,
    layout: &'a UnknownLayout<'a>,
    known: Option<&[bool]>,
) -> Result<Reference<'a>> {
    let solve = |set| Reference::new(session, scene, layout, ResidualPrecision::Working, set);
    let found = solve(None)?;
    match known {
        Some(known) if !found.found.converged => solve(Some(known)),
        _ => Ok(found),
    }
}

/// Runs without and with deflation in turns, so that other load on the machine affects all of them.
fn ours(
    session: &Session,
    problem: &Problem,
    court: &DirectComparison,
    effort: Effort,
    record: &mut Record,
) -> Result<()> {
    let mut ways = vec![Adaptive::Off];
    ways.extend(effort.taus.iter().map(|&tau| Adaptive::Below(tau)));
    let mut seconds = vec![Vec::new(); ways.len()];
    let mut searches = vec![Vec::new(); ways.len()];
    for round in 0..effort.repeats {
        for (k, &way) in ways.iter().enumerate() {
            let mut solved = match solve(session, problem, way) {
                Ok(solved) => solved,
                // If one variant fails, its row says why.
                Err(e) if e.kind() == ErrorKind::Environment => return Err(e),
                Err(e) => {
                    if round == 0 {
                        refused(way, e.to_string(), record);
                    }
                    continue;
                }
            };
            seconds[k].push(solved.seconds);
            searches[k].extend(solved.solver.deflated().map(|c| c.seconds));
            if round == 0 {
                match way {
                    Adaptive::Below(tau) => record.runs.push(deflated(tau, &mut solved, court)?),
                    _ => plain(&solved, court, effort, record)?,
                }
            }
        }
    }
    let mut times = seconds.iter_mut().zip(&mut searches);
    if let Some((s, _)) = times.next() {
        record.plain.seconds = median(s);
    }
    for (run, (s, search)) in record.runs.iter_mut().zip(times) {
        run.seconds = median(s);
        run.search = median(search);
    }
    Ok(())
}

fn solve(session: &Session, problem: &Problem, adaptive: Adaptive) -> Result<MeasuredSolve> {
    let settings = MethodSettings::default()
        .rtol(RTOL)
        .merge(MergeKind::None)
        .adaptive(adaptive);
    let problem = problem.clone();
    let clock = Instant::now();
    let mut solver = FetiFeti::new(session, problem, settings)?;
    let solution = solver.solve()?;
    let seconds = clock.elapsed().as_secs_f64();
    Ok(MeasuredSolve {
        solver,
        solution,
        seconds,
    })
}

fn refused(way: Adaptive, said: String, record: &mut Record) {
    match way {
        Adaptive::Below(tau) => record.runs.push(AdaptiveRun {
            tau,
            message: Some(said),
            ..AdaptiveRun::default()
        }),
        _ => record.plain.message = Some(said),
    }
}

fn plain(
    solved: &MeasuredSolve,
    court: &DirectComparison,
    effort: Effort,
    record: &mut Record,
) -> Result<()> {
    let (solver, solution) = (&solved.solver, &solved.solution);
    let facts = solver.facts();
    record.multipliers = facts.multipliers_local + facts.multipliers_global;
    let small = |s: &fetifeti::solution::Spectrum| s.kappa() < ESTIMATED;
    let exact = if record.multipliers <= effort.plain && solution.estimate.iter().all(small) {
        // If the eigensolver fails, the solution remains valid.
        solver.plain_spectrum().ok().flatten()
    } else {
        None
    };
    record.plain = Plain {
        exact: exact.map(|s| s.kappa()),
        estimate: solution.estimate.map(|s| s.kappa()),
        iterations: solution.iterations,
        seconds: 0.0,
        error: court.error(&solution.u)?,
        message: (!solution.converged()).then(|| solution.status.to_string()),
    };
    Ok(())
}

fn deflated(tau: f64, solved: &mut MeasuredSolve, court: &DirectComparison) -> Result<AdaptiveRun> {
    let (solver, solution) = (&mut solved.solver, &solved.solution);
    let searched = solver.deflated().is_some();
    // As with -fetifeti_spectrum: vectors that the iterations have not called for are searched for as well.
    let spectrum = solver.spectrum().ok().flatten();
    let cost = solver.deflated();
    let vectors = cost.as_ref().map_or(&[][..], |c| &c.vectors);
    let mut run = AdaptiveRun {
        tau,
        searched,
        kappa: spectrum.map(|s| s.kappa()),
        lambda_min: spectrum.map(|s| s.lambda_min),
        vectors: vectors.iter().sum::<usize>() + cost.as_ref().map_or(0, |c| c.shared),
        most: vectors.iter().copied().max().unwrap_or(0),
        capped: cost.as_ref().map_or(0, |c| c.capped.len()),
        iterations: solution.iterations,
        error: court.error(&solution.u)?,
        message: (!solution.converged()).then(|| solution.status.to_string()),
        ..AdaptiveRun::default()
    };
    run.attainable = attainable(solver, court, run.error)?;
    Ok(run)
}

/// The smallest error over ever smaller residuals, up to and including the first residual that is not reached: as for
/// MUMPS, only the solution counts.
fn attainable(
    solver: &mut FetiFeti,
    court: &DirectComparison,
    first: Option<f64>,
) -> Result<Option<f64>> {
    let mut least = first;
    for rtol in TIGHTER {
        solver.ksp().set_tolerances(Some(rtol), None, None, None)?;
        let Ok(tight) = solver.solve() else { break };
        least = match (least, court.error(&tight.u)?) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        };
        if !tight.converged() {
            break;
        }
    }
    Ok(least)
}

/// Seconds of a case on finer elements, without and with deflation in turns. Files go into `dir`/fine.
///
/// # Errors
/// Those of the scene, of the disk and of PETSc.
pub fn fine(session: &Session, case: &AdaptiveCase, effort: Effort, dir: &Path) -> Result<Fine> {
    let dir = dir.join("fine");
    output::prepare_directory(&dir)?;
    let scene = distribution::load(session, &case.write(&dir)?)?;
    let problem = distribution::substructures(session, &scene)?;
    let mut out = Fine {
        dofs: Numbering::new(&scene).len() as usize,
        ..Fine::default()
    };
    let (mut off, mut on, mut search) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..effort.repeats {
        for way in [Adaptive::Off, Adaptive::Below(USUAL)] {
            let MeasuredSolve {
                solver,
                solution,
                seconds,
            } = match solve(session, &problem, way) {
                Ok(solved) => solved,
                Err(e) if e.kind() == ErrorKind::Environment => return Err(e),
                Err(e) => {
                    out.message = Some(e.to_string());
                    return Ok(out);
                }
            };
            if !solution.converged() {
                out.message = Some(format!("{}: {}", way.name(), solution.status));
            }
            if way == Adaptive::Off {
                off.push(seconds);
                out.estimate = solution.estimate.map(|s| s.kappa());
                out.plain_iterations = solution.iterations;
            } else {
                on.push(seconds);
                let cost = solver.deflated();
                search.extend(cost.as_ref().map(|c| c.seconds));
                out.vectors = cost.map_or(0, |c| c.vectors.iter().sum());
                out.iterations = solution.iterations;
            }
        }
    }
    out.plain_seconds = median(&mut off);
    out.seconds = median(&mut on);
    out.search = median(&mut search);
    Ok(out)
}

/// PCBDDC with one part for each body: its matrices are then as large as ours, and it needs no hundreds of ranks.
fn bddc(
    file: &Path,
    scene: &Scene,
    bodies: usize,
    tau: f64,
    active: &[usize],
    effort: Effort,
) -> Result<Bddc> {
    let ranks = bodies.min(scene.n_subdomains());
    let threshold = tau.to_string();
    let mut options = vec!["-bddc_pc_bddc_adaptive_threshold", &threshold];
    options.extend(ADAPTIVE);
    let outcome = single::baseline("bddc", file, ranks, &options, active, RTOL, effort.patience)?;
    Ok(match outcome {
        Ok(o) => Bddc {
            ranks,
            kappa: o.kappa,
            iterations: o.iterations,
            seconds: o.setup + o.solve,
            message: o.message,
        },
        Err(message) => Bddc {
            ranks,
            message: Some(message),
            ..Bddc::default()
        },
    })
}

/// Measures the distance of solutions from the direct one.
struct DirectComparison<'a> {
    direct: Option<&'a Reference<'a>>,
    parts: &'a [Subdomain],
}

impl DirectComparison<'_> {
    /// The relative distance in the energy norm. Copies that differ are averaged with the weight of their coefficients,
    /// as in `compare`.
    fn error(&self, u: &[Vec<f64>]) -> Result<Option<f64>> {
        let distance = |d: &Reference| d.distance(self.parts, u, Copies::ByCoefficient);
        Ok(self.direct.map(distance).transpose()?.map(|d| d[0]))
    }
}

/// The energy norm of an error of one unit in the last place of every displacement.
fn last_place(direct: &Reference, scene: &Scene, parts: &[Subdomain]) -> Result<f64> {
    let numbering = Numbering::new(scene);
    let mut d = direct.values(parts)?;
    for (part, d) in parts.iter().zip(&mut d) {
        for (d, &dof) in d.iter_mut().zip(&part.dofs) {
            let i = numbering.global(dof) as usize;
            let up = i.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 63 == 0;
            *d *= f64::EPSILON * if up { 1.0 } else { -1.0 };
        }
    }
    direct.size(parts, &d, Copies::Alike)
}

/// The median; 0 of no values.
fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

//! `fetifeti solve`.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

use mpi::traits::Communicator;

use super::args::Solve;
use super::checkpoint::Checkpoints;
use super::{not_converged, problem};
use crate::feti::exchange::{exchange_words, sum_all};
use crate::feti::{FetiFeti, PcType, Settings, Solution, Spectrum};
use crate::petsc::{max_memory, Session};
use crate::report::field::{self, Mesh};
use crate::report::json::{self, SolveReport};
use crate::report::vtu::{Shape, Vtu};
use crate::report::{output, summary};
use crate::scene::Scene;
use crate::Result;

/// Solves a scene and writes what was asked for.
pub fn run(session: &Session, args: &Solve) -> Result<()> {
    let clock = Instant::now();
    let scene = problem::load(session, &args.scene)?;
    prepare(session, args.out.as_deref(), args.json.as_deref())?;
    let checkpoints = Checkpoints::new(session, args, &scene)?;
    let start = Instant::now();
    let substructures = problem::substructures(session, &scene)?;
    let assemble = start.elapsed().as_secs_f64();

    let solver = FetiFeti::new(session, substructures, Settings::default())?;
    let solution = contact_loop(session, &solver, checkpoints)?;
    let exact = if solver.settings().spectrum {
        solver.spectrum()?
    } else {
        None
    };
    let mut report = report(session, &scene, &solver, &solution, exact)?;
    if solver.settings().check {
        report.check = Some(checks(&solver)?);
    }
    report.seconds.assemble = assemble;
    if let Some(dir) = &args.out {
        write_fields(session, &scene, &solution, &solver, dir)?;
    }
    report.seconds.total = clock.elapsed().as_secs_f64();
    let written = if session.rank() == 0 {
        write_report(args, &report)
    } else {
        Ok(())
    };
    session.agree(written)?;
    if solution.converged {
        Ok(())
    } else {
        Err(not_converged(
            &format!("the dual problem of {}", args.scene.display()),
            &solution.reason,
            solution.iterations,
        ))
    }
}

/// Solves, from the checkpoint if there is one, and leaves one after every outer step.
fn contact_loop(
    session: &Session,
    solver: &FetiFeti,
    checkpoints: Checkpoints,
) -> Result<Solution> {
    let mut checkpoints = checkpoints.attach(session, solver)?;
    let (load_step, records, start) = match checkpoints.start() {
        Some((load_step, records, state)) => (load_step, records, Some(state)),
        None => (0, String::new(), None),
    };
    solver.solve_from(start.as_ref(), &mut |_, state| {
        checkpoints.save(session, load_step, &records, state)
    })
}

/// Finds out before the work whether results can be written. Collective.
pub(super) fn prepare(session: &Session, out: Option<&Path>, file: Option<&Path>) -> Result<()> {
    let ready = || -> Result<()> {
        if let Some(dir) = out {
            output::prepare_directory(dir)?;
        }
        if let Some(file) = file {
            output::prepare_file(file)?;
        }
        Ok(())
    };
    session.agree(if session.rank() == 0 { ready() } else { Ok(()) })
}

fn write_report(args: &Solve, report: &SolveReport) -> Result<()> {
    let to_stdout = args.json.as_deref().is_some_and(output::is_stdout);
    if !args.quiet && !to_stdout {
        output::print(&summary::solve(report))?;
    }
    if let Some(file) = &args.json {
        json::write(file, report)?;
    }
    if let Some(dir) = &args.out {
        json::write(&dir.join("report.json"), report)?;
        if !args.quiet && !to_stdout {
            output::print(&format!(
                "written: solution.vtu, solution.png, report.json in {}\n",
                dir.display()
            ))?;
        }
    }
    Ok(())
}

/// The identities, and λ_min ≥ 1 by the exact spectrum.
fn checks(solver: &FetiFeti) -> Result<BTreeMap<String, f64>> {
    let identities = solver.check()?;
    let mut out: BTreeMap<String, f64> = identities
        .into_iter()
        .map(|(name, defect)| (name.to_string(), defect))
        .collect();
    let kind = solver.dual().preconditioner.kind();
    if matches!(kind, PcType::Dirichlet | PcType::CoarseCorrected) {
        if let Some(s) = solver.spectrum()? {
            out.insert("lambda_min >= 1".into(), (1.0 - s.lambda_min).max(0.0));
        }
    }
    Ok(out)
}

fn spectrum(s: Spectrum) -> json::Spectrum {
    json::Spectrum::new(s.lambda_min, s.lambda_max)
}

fn report(
    session: &Session,
    scene: &Scene,
    solver: &FetiFeti,
    solution: &Solution,
    exact: Option<Spectrum>,
) -> Result<SolveReport> {
    let facts = solver.facts();
    let dual = solver.dual();
    let mut memory = [max_memory() / 1e6];
    sum_all(session.comm(), &mut memory);
    let mut errors = [0.0; 3];
    for (j, sub) in solver.problem().local.iter().enumerate() {
        let mesh = scene.subdomain_mesh(sub.index)?;
        if let Some(squares) = scene.error_squares(&mesh, &mesh.nodal(&solution.u[j])) {
            errors.iter_mut().zip(squares).for_each(|(e, s)| *e += s);
        }
    }
    sum_all(session.comm(), &mut errors);
    let [l2, h1, energy] = errors.map(f64::sqrt);
    let floating = dual.natural.r > 0;
    let inequalities = false;
    Ok(SolveReport {
        scene: scene.title.clone(),
        ranks: session.size(),
        threads: dual.stiffness.team.threads(),
        bodies: scene.n_bodies(),
        floating_bodies: facts.floating_bodies,
        subdomains: scene.n_subdomains(),
        dofs: scene.plan().dofs,
        multipliers: json::Multipliers {
            local: facts.multipliers_local,
            global: facts.multipliers_global,
            active: facts.multipliers_active,
        },
        outer_iterations: 1,
        iterations: json::Iterations::new(vec![solution.iterations]),
        condition: json::Condition {
            exact: exact.map(spectrum),
            estimate: solution.estimate.map(spectrum),
        },
        kkt: json::Kkt {
            stationarity: solution.kkt.stationarity,
            feasibility: solution.kkt.feasibility,
            complementarity: solution.kkt.complementarity,
            min_multiplier: inequalities.then_some(solution.kkt.min_multiplier),
        },
        energy: solution.energy,
        contact: None,
        error: scene
            .exact
            .is_some()
            .then_some(json::ErrorNorms { l2, h1, energy }),
        seconds: json::Seconds {
            assemble: 0.0,
            setup: facts.setup_seconds,
            solve: solution.solve_seconds,
            recover: solution.recover_seconds,
            total: 0.0,
        },
        memory_mb: memory[0],
        converged_reason: solution.reason.clone(),
        ksp_type: solver.ksp().type_name()?,
        preconditioner: dual.preconditioner.kind().name().into(),
        projector: if floating {
            dual.natural.projector.name()
        } else {
            "none"
        }
        .into(),
        check: None,
        rtol: solver.ksp().tolerances()?.0,
    })
}

/// u, ρ, body and subdomain as VTU and PNG; rank 0 writes for all. Collective.
fn write_fields(
    session: &Session,
    scene: &Scene,
    solution: &Solution,
    solver: &FetiFeti,
    dir: &Path,
) -> Result<()> {
    // [subdomain, n, u × n] to rank 0
    let mut outgoing: Vec<Vec<u64>> = vec![Vec::new(); session.comm().size() as usize];
    for (sub, u) in solver.problem().local.iter().zip(&solution.u) {
        outgoing[0].extend([sub.index as u64, u.len() as u64]);
        outgoing[0].extend(u.iter().map(|v| v.to_bits()));
    }
    let received = exchange_words(session.comm(), outgoing).concat();
    let written = if session.rank() == 0 {
        Gathered::new(scene, &received).and_then(|g| g.write(&scene.title, dir))
    } else {
        Ok(())
    };
    session.agree(written)
}

/// The whole solution on rank 0, subdomain after subdomain.
#[derive(Default)]
struct Gathered {
    points: Vec<[f64; 2]>,
    quads: Vec<[u32; 4]>,
    body: Vec<u32>,
    subdomain: Vec<u32>,
    u: Vec<f64>,
    rho: Vec<f64>,
}

impl Gathered {
    fn new(scene: &Scene, words: &[u64]) -> Result<Gathered> {
        let mut parts: Vec<(usize, &[u64])> = Vec::new();
        let mut rest = words;
        while let [index, n, tail @ ..] = rest {
            let (values, tail) = tail.split_at(*n as usize);
            parts.push((*index as usize, values));
            rest = tail;
        }
        parts.sort_unstable_by_key(|p| p.0);
        let mut all = Gathered::default();
        for (index, values) in parts {
            let mesh = scene.subdomain_mesh(index)?;
            let u: Vec<f64> = values.iter().map(|&w| f64::from_bits(w)).collect();
            let first = all.points.len();
            all.u.extend(mesh.nodal(&u));
            all.points.extend(&mesh.points);
            let quads = mesh.quads();
            all.body
                .extend(std::iter::repeat_n(mesh.body as u32, quads.len()));
            all.subdomain
                .extend(std::iter::repeat_n(index as u32, quads.len()));
            all.quads
                .extend(quads.iter().map(|q| q.map(|p| (first + p) as u32)));
            all.rho.extend(&mesh.rho);
        }
        Ok(all)
    }

    fn write(&self, title: &str, dir: &Path) -> Result<()> {
        let points: Vec<[f64; 3]> = self.points.iter().map(|p| [p[0], p[1], 0.0]).collect();
        let cells = self.quads.as_flattened();
        let body: Vec<i32> = self.body.iter().map(|&b| b as i32).collect();
        let subdomain: Vec<i32> = self.subdomain.iter().map(|&s| s as i32).collect();
        Vtu::new(&points, Shape::Quad, cells)
            .point_data("u", 1, &self.u[..])
            .cell_data("rho", 1, &self.rho[..])
            .cell_data("body", 1, &body[..])
            .cell_data("subdomain", 1, &subdomain[..])
            .write(&dir.join("solution.vtu"))?;
        let mesh = Mesh {
            points: &self.points,
            quads: &self.quads,
            body: &self.body,
            subdomain: &self.subdomain,
        };
        field::write_solution(
            &mesh,
            &self.u,
            &self.rho,
            &[],
            title,
            &dir.join("solution.png"),
        )
    }
}

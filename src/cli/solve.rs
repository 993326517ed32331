//! `fetifeti solve`.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

use super::args::Solve;
use super::balance;
use super::contact;
use super::course::{follow, Course};
use super::fields::{Gathered, Place};
use super::first_rank::on_first_rank;
use super::values::Values;
use super::{maps, physics, picture};
use crate::checkpoint::Checkpoints;
use crate::feti::subdomain::problem::factorisations;
use crate::feti::Facts;
use crate::feti::MethodSettings;
use crate::mesh::deck;
use crate::parallel::exchange::sum_all;
use crate::petsc::{max_memory, Session};
use crate::report::destination::Destination;
use crate::report::json::adaptive::{Adaptive, Deflation};
use crate::report::json::contact::ContactReport;
use crate::report::json::probes::NodePrint;
use crate::report::json::{self, Operators, SolveReport};
use crate::report::output;
use crate::report::pictures::contact_map;
use crate::report::plots::{load_steps, profile};
use crate::report::tables::summary;
use crate::scene::{distribution, DeckScenes, Scene};
use crate::substructures::BodyNode;
use crate::{Error, FetiFeti, Result, Spectrum, Status};

/// Number of directions that a load step passes on to the next one.
const DIRECTIONS: usize = 30;

/// Solves a scene, or the steps of a deck, and writes the results that the arguments ask for.
pub fn run(session: &Session, args: Solve) -> Result<()> {
    let clock = Instant::now();
    let destination = Destination::from(args.results.clone());
    if DeckScenes::is_deck(&args.scene) {
        return run_deck(session, &args, &destination);
    }
    let scene = distribution::load(session, &args.scene)?;
    on_first_rank(session, || {
        destination.prepare()?;
        destination.print(&lines(&scene.notes))
    })?;
    solve(session, &args, &destination, &scene, clock, None)?;
    Ok(())
}

/// Solves the steps of a deck one after the other; each is a linear problem of its own. With several steps the results
/// of each are in a directory of their own, and the report is that of the last.
fn run_deck(session: &Session, args: &Solve, destination: &Destination) -> Result<()> {
    let deck = session.agree(DeckScenes::load(&args.scene))?;
    on_first_rank(session, || destination.prepare())?;
    let stem = args
        .scene
        .file_stem()
        .map(|s| s.to_string_lossy().into_owned());
    let stem = stem.unwrap_or_default();
    on_first_rank(session, || destination.print(&lines(&deck.notes())))?;
    // Only rank 0 has tables.
    let mut printed = Vec::new();
    let n = deck.n_steps();
    for step in 0..n {
        let clock = Instant::now();
        let title = match n {
            1 => stem.clone(),
            _ => format!("{stem}, step {}", step + 1),
        };
        let scene = session.agree(deck.scene(&title, step))?;
        let mut of_step = destination.clone();
        if n > 1 {
            of_step.out = destination
                .out
                .as_ref()
                .map(|dir| dir.join(format!("step{}", step + 1)));
            of_step.json = destination.json.clone().filter(|_| step + 1 == n);
            on_first_rank(session, || of_step.prepare())?;
        }
        let deck = FromDeck {
            deck: &deck,
            step,
            printed,
        };
        printed = solve(session, args, &of_step, &scene, clock, Some(deck))?;
    }
    on_first_rank(session, || match &destination.out {
        Some(dir) if !printed.is_empty() => {
            let tables: Vec<deck::Table> = printed.iter().flat_map(|p| p.tables.clone()).collect();
            output::write_text(&dir.join(format!("{stem}.dat")), &deck::write_dat(&tables))
        }
        _ => Ok(()),
    })?;
    Ok(())
}

/// A line for each sentence.
pub(super) fn lines(notes: &[String]) -> String {
    notes.iter().map(|note| format!("{note}\n")).collect()
}

/// The step of a deck that a scene describes.
struct FromDeck<'a> {
    deck: &'a DeckScenes,
    step: usize,
    /// What earlier steps have printed.
    printed: Vec<NodePrint>,
}

/// Solves a scene and writes its results; returned is what the steps of its deck have printed up to this one.
fn solve(
    session: &Session,
    args: &Solve,
    destination: &Destination,
    scene: &Scene,
    clock: Instant,
    deck: Option<FromDeck>,
) -> Result<Vec<NodePrint>> {
    let checkpoints = Checkpoints::new(
        session,
        &args.scene,
        scene,
        args.checkpoint.as_deref(),
        args.resume.as_deref(),
    )?;
    let start = Instant::now();
    let substructures = distribution::substructures(session, scene)?;
    let assemble = start.elapsed().as_secs_f64();

    let settings = MethodSettings {
        recycle: if scene.steps.is_some() { DIRECTIONS } else { 0 },
        ..MethodSettings::default()
    };
    let mut solver = FetiFeti::new(session, substructures, settings)?;
    let place = match args.pieces {
        true => Place::EachRank,
        false => Place::FirstRank,
    };
    let course = follow(session, scene, &mut solver, destination, place, checkpoints)?;
    let scene = course.scene.as_ref().unwrap_or(scene);
    let solution = &course.solution;
    let exact = match (solver.settings().method.spectrum, solution.steps.last()) {
        (false, _) => None,
        (true, Some(step)) if step.exact.is_some() => step.exact,
        (true, _) => solver.spectrum()?,
    };
    let mut report = report(session, scene, &solver, &course, exact)?;
    if solver.settings().method.check {
        report.check = Some(checks(&solver, exact)?);
    }
    report.seconds.assemble = assemble;
    let asked = deck.as_ref().and_then(|deck| deck.deck.asks(deck.step));
    let mut printed = Vec::new();
    if !scene.probes.is_empty() || asked.is_some() {
        let values = Values::displacements(session, scene, &solver, solution, course.step)?;
        let found = match session.rank() {
            0 => values.probes(scene),
            _ => Ok(Vec::new()),
        };
        report.probes = session.agree(found)?;
        let forces = match asked {
            Some(true) => Some(Values::forces(session, scene, &solver, &course)?),
            _ => None,
        };
        if let (0, Some(deck)) = (session.rank(), &deck) {
            let displacement = |at: BodyNode| values.at(at.body, at.node);
            let force = |at: BodyNode| forces.as_ref().map_or([0.0; 3], |f| f.at(at.body, at.node));
            let tables = deck.deck.tables(deck.step, &displacement, &force);
            printed.extend(tables.into_iter().map(NodePrint::new));
        }
    }
    if let Some(deck) = deck {
        printed.splice(0..0, deck.printed);
    }
    report.node_print.clone_from(&printed);
    if let Some(dir) = &destination.out {
        write_fields(session, scene, &solver, &course, place, dir)?;
    }
    report.seconds.total = clock.elapsed().as_secs_f64();
    on_first_rank(session, || write_report(destination, &report, place))?;
    if solution.converged() {
        Ok(printed)
    } else {
        let scene = args.scene.display();
        let what = match (solver.facts().inequalities, solution.steps.len()) {
            (0, _) => format!("the dual problem of {scene}"),
            (_, n) => format!("the contact problem of {scene} ({n} contact steps)"),
        };
        Err(not_converged(&what, &solution.status, solution.iterations))
    }
}

/// The error of a solve that stopped early; its results have been written before.
pub(super) fn not_converged(what: &str, status: &Status, iterations: usize) -> Error {
    Error::NotConverged(format!(
        "{what} did not converge: {status} after {iterations} iterations (the results written are partial)"
    ))
}

fn write_report(destination: &Destination, report: &SolveReport, place: Place) -> Result<()> {
    destination.print(&summary::solve(report))?;
    destination.write_json("report.json", report)?;
    let solution = place.file("solution");
    let mut files = files(report);
    files[0] = &solution;
    destination.written(&files)
}

/// The files in a directory of results.
fn files(report: &SolveReport) -> Vec<&'static str> {
    let mut out = vec!["solution.vtu", "solution.png", "report.json"];
    if let Some(contact) = &report.contact {
        out.push("interfaces.png");
        // Maps of whole faces would have too many shapes for an SVG file.
        if report.dimension < 3 {
            out.push("interfaces.svg");
        }
        out.push("interfaces.csv");
        if !contact.load_steps.is_empty() {
            out.extend(["solution.pvd", "steps.png", "steps.svg", "steps.csv"]);
        }
    }
    out
}

/// The checks of the identities, and of λ_min ≥ 1 by the exact spectrum.
fn checks(solver: &FetiFeti, exact: Option<Spectrum>) -> Result<BTreeMap<String, f64>> {
    let identities = solver.check()?;
    let mut out: BTreeMap<String, f64> = identities
        .into_iter()
        .map(|(name, defect)| (name.to_string(), defect))
        .collect();
    if solver.dual().preconditioner.kind.has_floor() {
        let spectrum = match exact {
            Some(known) => Some(known),
            None => solver.spectrum()?,
        };
        if let Some(s) = spectrum {
            out.insert("lambda_min >= 1".into(), (1.0 - s.lambda_min).max(0.0));
        }
    }
    Ok(out)
}

fn report(
    session: &Session,
    scene: &Scene,
    solver: &FetiFeti,
    course: &Course,
    exact: Option<Spectrum>,
) -> Result<SolveReport> {
    let solution = &course.solution;
    let contact = contact_report(session, scene, solver, course)?;
    let facts = solver.facts();
    let dual = solver.dual();
    let mut memory = [max_memory() / 1e6];
    sum_all(session.comm(), &mut memory);
    let mut errors = [0.0; 3];
    let compared = scene.exact.iter().flat_map(|_| &solver.problem().local);
    for (sub, u) in compared.zip(&solution.u) {
        let mesh = scene.subdomain_mesh(sub.index)?;
        if let Some(squares) = scene.error_squares(&mesh, &mesh.nodal(u)) {
            errors.iter_mut().zip(squares).for_each(|(e, s)| *e += s);
        }
    }
    sum_all(session.comm(), &mut errors);
    let [l2, h1, energy_norm] = errors.map(f64::sqrt);
    let floating = dual.natural.r > 0;
    let rows = solution.rows();
    let mut active = [rows.iter().filter(|r| r.holds()).count() as f64];
    sum_all(session.comm(), &mut active);
    Ok(SolveReport {
        scene: scene.title.clone(),
        dimension: scene.dim(),
        physics: if scene.form.is_elastic() {
            "elasticity"
        } else {
            "scalar"
        }
        .into(),
        components: scene.components(),
        form: physics::form(scene),
        ranks: session.size(),
        threads: dual.stiffness.team.threads(),
        bodies: scene.n_bodies(),
        floating_bodies: facts.floating_bodies,
        subdomains: scene.n_subdomains(),
        dofs: scene.plan().dofs,
        multipliers: json::Multipliers {
            local: facts.multipliers_local,
            global: facts.multipliers_global,
            active: active[0] as usize,
        },
        outer_iterations: course.iterations.len(),
        iterations: json::Iterations::new(course.iterations.clone()),
        condition: json::Condition {
            exact: exact.map(Into::into),
            estimate: solution.estimate.map(Into::into),
        },
        adaptive: adaptive(solver)?,
        kkt: json::Kkt::new(&solution.kkt, facts.inequalities > 0),
        energy: course.energy,
        contact,
        error: scene.exact.is_some().then_some(json::ErrorNorms {
            l2,
            h1,
            energy_norm,
        }),
        notes: scene.notes.clone(),
        probes: Vec::new(),
        node_print: Vec::new(),
        communication: solver.communication(),
        seconds: json::Seconds {
            assemble: 0.0,
            setup: facts.setup_seconds,
            solve: course.solve_seconds,
            recover: course.recover_seconds,
            total: 0.0,
        },
        memory_mb: memory[0],
        operators: Some(operators(session, solver.facts())),
        converged_reason: solution.status.to_string(),
        ksp_type: solver.ksp().type_name()?,
        preconditioner: dual.preconditioner.kind.name().into(),
        scaling: facts.scaling.name().into(),
        local_solver: solver.settings().method.local.kind.name().into(),
        local_ordering: solver
            .settings()
            .method
            .local
            .ordering
            .taken()
            .name()
            .into(),
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

/// The value of key `adaptive`. Collective.
pub(super) fn adaptive(solver: &FetiFeti) -> Result<Option<Adaptive>> {
    let facts = solver.facts();
    let out = Adaptive {
        constraints: facts.adaptive_constraints.clone(),
        constraint_seconds: facts.adaptive_seconds,
        deflation: deflation(solver)?,
    };
    let added = out.constraints.iter().any(|n| *n > 0);
    Ok((added || out.deflation.is_some()).then_some(out))
}

fn deflation(solver: &FetiFeti) -> Result<Option<Deflation>> {
    let Some(cost) = solver.deflated() else {
        return Ok(None);
    };
    // A spectrum of many decades may be beyond the eigensolver.
    let exact_without = match solver.settings().method.spectrum {
        true => solver.plain_spectrum().ok().flatten(),
        false => None,
    };
    let names = &solver.problem().body_names;
    Ok(Some(Deflation {
        tau: cost.tau,
        vectors: cost.vectors.iter().sum(),
        shared: cost.shared,
        dependent: cost.dependent,
        given_up: cost.given_up,
        largest: cost.largest,
        capped: cost.capped.iter().map(|&b| names[b].clone()).collect(),
        by_body: cost.vectors,
        seconds: cost.seconds,
        exact_without: exact_without.map(Into::into),
        estimate_without: cost.before.map(Into::into),
    }))
}

/// Writes the fields, the pictures and the profiles along the interfaces; rank 0 writes for all. Collective.
fn write_fields(
    session: &Session,
    scene: &Scene,
    solver: &FetiFeti,
    course: &Course,
    place: Place,
    dir: &Path,
) -> Result<()> {
    let gathered = |place: Place| {
        let mut fields = Gathered::new(session, scene, solver, place)?;
        fields.gather(session, scene, solver, &course.solution, course.step);
        Ok::<_, Error>(fields)
    };
    let mut known = None;
    let fields = match &course.fields {
        Some(fields) => fields,
        None => known.insert(gathered(place)?),
    };
    let rows = &course.rows;
    fields.write_vtu(session, scene, &course.solution, rows, dir, "solution")?;
    // The picture shows the whole scene.
    let mut whole = None;
    let fields = match place {
        Place::FirstRank => fields,
        Place::EachRank => whole.insert(gathered(Place::FirstRank)?),
    };
    on_first_rank(session, || {
        picture::write(scene, fields, &course.rows, course.step, dir)?;
        if solver.facts().inequalities > 0 {
            match scene.dim() {
                2 => profile::write(&contact::profiles(scene, &course.rows), &scene.title, dir)?,
                _ => contact_map::write(&maps::of(scene, &course.rows), &scene.title, dir)?,
            };
        }
        if !course.load_steps.is_empty() {
            load_steps::write(&course.load_steps, &scene.title, dir)?;
        }
        Ok(())
    })
}

/// The value of key `operators`. Collective.
fn operators(session: &Session, facts: &Facts) -> Operators {
    let mut sums = [
        facts.kinds as f64,
        facts.implicit_kinds as f64,
        1e-6 * facts.factor_bytes as f64,
        1e-6 * facts.dense_bytes as f64,
        facts.in_single as f64,
    ];
    sum_all(session.comm(), &mut sums);
    Operators {
        kinds: sums[0] as usize,
        sparse: sums[1] as usize,
        factor_mb: sums[2],
        dense_mb: sums[3],
        single: sums[4] as usize,
    }
}

/// The value of key `contact`. Collective.
fn contact_report(
    session: &Session,
    scene: &Scene,
    solver: &FetiFeti,
    course: &Course,
) -> Result<Option<ContactReport>> {
    let facts = solver.facts();
    if facts.inequalities == 0 {
        return Ok(None);
    }
    let mut counts = [factorisations() as f64, facts.kinds as f64];
    sum_all(session.comm(), &mut counts);
    let inequalities = || course.rows.iter().filter(|r| r.is_inequality());
    Ok(Some(ContactReport {
        method: contact::method(&course.outer),
        candidates: facts.inequalities,
        active: inequalities().filter(|r| r.holds()).count(),
        factorisations: counts[0] as usize,
        distinct_subdomains: counts[1] as usize,
        steps: course.outer.clone(),
        interfaces: contact::forces(
            scene,
            &course.rows,
            course.moved.as_ref().map(|u| (u, course.step)),
        ),
        bodies: balance::bodies(session, scene, solver, &course.rows, course.step)?,
        load_steps: course.load_steps.clone(),
        updated: scene.is_renewed(),
        renewable: !scene.is_renewed() && scene.may_be_renewed(),
    }))
}

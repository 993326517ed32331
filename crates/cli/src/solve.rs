//! `fetifeti solve`.

use std::path::Path;

use super::args::SolveArguments;
use super::contact;
use super::course::{follow, Course};
use super::events::Events;
use super::fields::{GatherTarget, Gathered};
use super::first_rank::on_first_rank;
use super::phases::Phases;
use super::record::{checks, report};
use super::values::NodalValues;
use super::{doubts, inputs, maps, picture, smoothed};
use crate::checkpoint::Checkpoints;
use base::{Error, Result};
use fetifeti::problem::BodyNode;
use fetifeti::solution::SolvedRow;
use fetifeti::{FetiFeti, Status};
use petsc::{give_back, Session};
use report::destination::Destination;
use report::json::probes::NodePrint;
use report::json::SolveReport;
use report::output;
use report::pictures::contact_map;
use report::plots::{load_steps, profile};
use report::tables::summary;
use scene::{distribution, fits, DeckScenes, Scene, SlipHistory, Stepper};

/// Solves a scene, or the steps of a deck, and writes the results that the arguments ask for.
pub fn run(session: &Session, args: SolveArguments) -> Result<()> {
    let destination = Destination::from(args.results.clone());
    if DeckScenes::is_deck(&args.scene) {
        return run_deck(session, &args, &destination);
    }
    let mut phases = begun(session, &args, &destination);
    let scene = distribution::load_part(session, &args.scene)?;
    phases.end();
    on_first_rank(session, || {
        destination.prepare()?;
        destination.print(&lines(&scene.sentences()))
    })?;
    solve(session, &args, &destination, scene, phases, None)
}

/// Solves the steps of a deck one after the other; each is a problem of its own, which begins where friction has slid
/// to before. With several steps the results of each are in a directory of their own, and the report is that of the
/// last.
fn run_deck(session: &Session, args: &SolveArguments, destination: &Destination) -> Result<()> {
    let mut begun = Some(begun(session, args, destination));
    let in_full = fits::is_in_full(session)?;
    let deck = session.agree(DeckScenes::load(&args.scene))?;
    let deck = deck.integrated(in_full);
    on_first_rank(session, || destination.prepare())?;
    let stem = args
        .scene
        .file_stem()
        .map(|s| s.to_string_lossy().into_owned());
    let stem = stem.unwrap_or_default();
    begun.iter_mut().for_each(|phases| {
        phases.end();
    });
    let mut told = deck.notes();
    on_first_rank(session, || destination.print(&lines(&told)))?;
    let mut course = FromDeck {
        deck: &deck,
        step: 0,
        slid: SlipHistory::default(),
        printed: Vec::new(),
    };
    let n = deck.n_steps();
    for step in 0..n {
        course.step = step;
        // The first step has the seconds of the file.
        let mut phases = begun
            .take()
            .unwrap_or_else(|| self::begun(session, args, destination));
        let title = match n {
            1 => stem.clone(),
            _ => format!("{stem}, step {}", step + 1),
        };
        let scene = session.agree(deck.scene_after(&course.slid, &title, step))?;
        distribution::same_on_all_ranks(session, &args.scene, &scene)?;
        phases.end();
        // What steps have in common is said once.
        let mut new = scene.sentences();
        new.retain(|note| !told.contains(note));
        on_first_rank(session, || destination.print(&lines(&new)))?;
        told.extend(new);
        let mut of_step = destination.clone();
        if n > 1 {
            of_step.out = destination
                .out
                .as_ref()
                .map(|dir| dir.join(format!("step{}", step + 1)));
            of_step.json = destination.json.clone().filter(|_| step + 1 == n);
            on_first_rank(session, || of_step.prepare())?;
        }
        solve(session, args, &of_step, scene, phases, Some(&mut course))?;
    }
    let printed = course.printed;
    on_first_rank(session, || match &destination.out {
        Some(dir) if !printed.is_empty() => {
            let tables: Vec<deck::DatTable> =
                printed.iter().flat_map(|p| p.tables.clone()).collect();
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

/// The step of a deck that a scene describes, and what the steps up to it have left.
struct FromDeck<'a> {
    deck: &'a DeckScenes,
    step: usize,
    slid: SlipHistory,
    /// The tables that are printed; only rank 0 has some.
    printed: Vec<NodePrint>,
}

/// The clock, in the phase in which a file is read.
fn begun(session: &Session, args: &SolveArguments, destination: &Destination) -> Phases {
    let mut phases = Phases::new(session, destination.quiet);
    phases.begin(&format!("reading {}", args.scene.display()));
    phases
}

/// Solves a scene and writes its results. The phases so far were those of reading.
fn solve(
    session: &Session,
    args: &SolveArguments,
    destination: &Destination,
    scene: Scene,
    mut phases: Phases,
    mut deck: Option<&mut FromDeck>,
) -> Result<()> {
    let checkpoints = Checkpoints::new(
        session,
        &args.scene,
        &scene,
        args.checkpoint.as_deref(),
        args.resume.as_deref(),
    )?;
    let events = Events::new(session, args.events.as_deref())?;
    let name = args.scene.display().to_string();
    session.agree(fits::solved(session, &scene, &name))?;
    let read = phases.total();
    phases.begin("assembling");
    let substructures = distribution::substructures(session, &scene)?;
    give_back(); // what reading took
    let assemble = phases.end();

    phases.begin("setting up");
    let solver = FetiFeti::new(session, substructures, Stepper::settings(&scene))?;
    give_back(); // lists of the set-up
                 // What merging bodies took, beside the set-up that the solver counts, with those between load steps.
    let merging = phases.end() - solver.facts().setup_seconds;
    let stepper = Stepper::with_solver(scene, solver)?;
    let place = if args.pieces {
        GatherTarget::EachRank
    } else {
        GatherTarget::FirstRank
    };
    let written = (checkpoints, &events);
    let (mut stepper, course) = follow(session, stepper, destination, place, written)?;
    let solution = &course.solution;
    let exact = match (
        stepper.solver().settings().method.spectrum,
        solution.steps.last(),
    ) {
        (false, _) => None,
        (true, Some(step)) if step.exact.is_some() => step.exact,
        (true, _) => stepper.solver_mut().spectrum()?,
    };
    let mut report = report(session, stepper.scene(), stepper.solver(), &course, exact)?;
    if stepper.solver().settings().method.check {
        report.check = Some(checks(stepper.solver_mut(), exact)?);
    }
    let (scene, solver) = (stepper.scene(), stepper.solver());
    report.seconds.read = read;
    report.seconds.assemble = assemble;
    report.seconds.setup += merging;
    if session.rank() == 0 {
        report.inputs = inputs::of(&args.scene);
    }
    report.warnings.extend(course.unbalanced.clone());
    report
        .warnings
        .extend(smoothed::warnings(scene, &course.rows));
    let sliding = match deck {
        Some(_) => SolvedRow::on_all_ranks(session.comm(), solution.tangential_rows()),
        None => Vec::new(),
    };
    let asked = deck.as_ref().and_then(|deck| deck.deck.asks(deck.step));
    if !scene.probes.is_empty() || asked.is_some() {
        let values = NodalValues::displacements(session, scene, solver, solution, course.step)?;
        let found = match session.rank() {
            0 => values.probes(scene, course.step),
            _ => Ok(Vec::new()),
        };
        report.probes = session.agree(found)?;
        let forces = match asked {
            Some(true) => Some(NodalValues::forces(session, scene, solver, &course)?),
            _ => None,
        };
        if let (0, Some(deck)) = (session.rank(), &mut deck) {
            let displacement = |at: BodyNode| values.at(at.body, at.node);
            let force = |at: BodyNode| forces.as_ref().map_or([0.0; 3], |f| f.at(at.body, at.node));
            let rows = course.rows.iter().chain(&sliding);
            let of_deck = deck.deck;
            let tables = of_deck.tables(deck.step, (scene, rows), &displacement, &force);
            deck.printed.extend(tables.into_iter().map(NodePrint::new));
        }
    }
    if let Some(deck) = deck {
        deck.slid.add(scene, &sliding);
        report.node_print.clone_from(&deck.printed);
    }
    if let Some(dir) = &destination.out {
        phases.begin("writing fields and pictures");
        write_fields(session, scene, solver, &course, place, dir)?;
        report.seconds.write += phases.end();
    }
    report.seconds.end(phases.total());
    on_first_rank(session, || write_report(destination, &report, place))?;
    if solution.converged() {
        Ok(())
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
    Error::not_converged(format!(
        "{what} did not converge: {status} after {iterations} iterations (the results written are partial)"
    ))
}

/// Prints and writes the record. Warnings are on standard error, also where nothing else is printed.
fn write_report(
    destination: &Destination,
    report: &SolveReport,
    place: GatherTarget,
) -> Result<()> {
    let so = "no load drives this, and of all places along it the answer has the one nearest to the start";
    destination.print(&lines(&doubts::free(&report.free_motions, so)))?;
    destination.print(&summary::solve(report))?;
    for warning in &report.warnings {
        eprintln!("Warning: {warning}");
    }
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

/// Writes the fields, the pictures and the profiles along the interfaces; rank 0 writes for all. Collective.
fn write_fields(
    session: &Session,
    scene: &Scene,
    solver: &FetiFeti,
    course: &Course,
    place: GatherTarget,
    dir: &Path,
) -> Result<()> {
    let gathered = |place: GatherTarget| {
        let mut fields = Gathered::new(session, scene, solver, place)?;
        fields.gather(session, scene, solver, &course.solution, course.step);
        Ok::<_, Error>(fields)
    };
    let mut known = None;
    let fields = match &course.fields {
        Some(fields) => fields,
        None => known.insert(gathered(place)?),
    };
    let rows = course.contact();
    fields.write_vtu(session, scene, &course.solution, rows, dir, "solution")?;
    // The picture shows the whole scene.
    let mut whole = None;
    let fields = match place {
        GatherTarget::FirstRank => fields,
        GatherTarget::EachRank => whole.insert(gathered(GatherTarget::FirstRank)?),
    };
    on_first_rank(session, || {
        let friction = &course.friction;
        picture::write(scene, fields, (&course.rows, friction), course.step, dir)?;
        if solver.facts().inequalities > 0 {
            match scene.dim() {
                2 => profile::write(
                    &contact::profiles(scene, &course.rows, friction),
                    &scene.title,
                    dir,
                )?,
                _ => {
                    contact_map::write(&maps::of(scene, &course.rows, friction), &scene.title, dir)?
                }
            };
        }
        if !course.load_steps.is_empty() {
            load_steps::write(&course.load_steps, &scene.title, dir)?;
        }
        Ok(())
    })
}

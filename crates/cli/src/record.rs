//! The record of a solve: what report.json and the summary say.

use std::collections::BTreeMap;

use super::course::Course;
use super::{contact, doubts, physics};
use base::Result;
use fetifeti::inside::factorisations;
use fetifeti::inside::{coarse_solver::CoarseSolves, distributed};
use fetifeti::solution::{SetUpSummary, Spectrum};
use fetifeti::FetiFeti;
use parallel::exchange::sum_all;
use petsc::{max_memory, Options, Session};
use report::json::adaptive::{Adaptive, Declined, Deflation};
use report::json::contact::ContactReport;
use report::json::{self, NaturalCoarse, Operators, SolveReport};
use scene::Scene;

/// All but seconds, probes and checks, which are added later. Collective.
pub(super) fn report(
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
    // Rows inside merged bodies always hold.
    let holding = rows.iter().filter(|r| r.holds()).count();
    let mut active = [(holding - solver.n_merged_rows()) as f64];
    sum_all(session.comm(), &mut active);
    Ok(SolveReport {
        schema: SolveReport::SCHEMA.into(),
        version: env!("CARGO_PKG_VERSION").into(),
        petsc: petsc::version()?,
        converged: solution.converged(),
        options: options(session)?,
        scene: scene.title.clone(),
        command: std::env::args().collect(),
        inputs: Vec::new(),
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
        floating_bodies: floating_bodies(scene, solver),
        groups: solver.n_groups(),
        subdomains: scene.n_subdomains(),
        dofs: scene.dofs(),
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
        certified: course.certified.clone(),
        energy: course.energy,
        contact,
        error: scene.exact.is_some().then_some(json::ErrorNorms {
            l2,
            h1,
            energy_norm,
        }),
        notes: scene.sentences(),
        free_motions: doubts::recorded(scene, &solver.free_motions()),
        warnings: [
            scene.warnings.clone(),
            doubts::beyond(session, scene, course),
        ]
        .concat(),
        probes: Vec::new(),
        node_print: Vec::new(),
        communication: solver.communication(),
        seconds: json::Seconds {
            setup: facts.setup_seconds,
            solve: course.solve_seconds,
            recover: course.recover_seconds,
            write: course.write_seconds,
            ..json::Seconds::default()
        },
        memory_mb: memory[0],
        operators: Some(operators(session, solver.facts())),
        converged_reason: solution.status.to_string(),
        ksp_type: solver.ksp().type_name()?,
        preconditioner: dual.preconditioner.kind().pc_type.name().into(),
        scaling: facts.scaling.name().into(),
        local_solver: "multifrontal".into(),
        local_ordering: "nd".into(),
        projector: if floating {
            dual.natural.projector.name()
        } else {
            "none"
        }
        .into(),
        natural_coarse: match &dual.natural.gtg {
            Some(gtg) => gtg.solver.work()?.map(natural_coarse),
            None => None,
        },
        check: None,
        rtol: solver.ksp().tolerances()?.0,
    })
}

/// Number of bodies that nothing holds; those that the method has as one float together.
fn floating_bodies(scene: &Scene, solver: &FetiFeti) -> usize {
    let columns = &solver.dual().natural.columns;
    let floats = |b: &usize| !columns.of(solver.group(*b)).is_empty();
    (0..scene.n_bodies()).filter(floats).count()
}

/// The record of a solver of GᵀQG.
fn natural_coarse(work: CoarseSolves) -> NaturalCoarse {
    NaturalCoarse {
        solver: work.solver,
        iterated: work.iterated,
        rtol: work.iterated.then_some(distributed::EXACT),
        iterations: (work.iterated).then(|| work.iterations as f64 / work.solves.max(1) as f64),
    }
}

/// The PETSc options that are set.
pub(super) fn options(session: &Session) -> Result<BTreeMap<String, String>> {
    let mut all: BTreeMap<String, String> = Options::new(session, "").all()?.into_iter().collect();
    // That of the session itself.
    all.remove("-no_signal_handler");
    Ok(all)
}

/// The checks of the identities, and of λ_min ≥ 1 by the exact spectrum.
pub(super) fn checks(
    solver: &mut FetiFeti,
    exact: Option<Spectrum>,
) -> Result<BTreeMap<String, f64>> {
    let identities = solver.check()?;
    let mut out: BTreeMap<String, f64> = identities
        .into_iter()
        .map(|(name, defect)| (name.to_string(), defect))
        .collect();
    if solver.dual().preconditioner.kind().floor.is_some() {
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

/// The value of key `adaptive`. Collective.
pub(super) fn adaptive(solver: &FetiFeti) -> Result<Option<Adaptive>> {
    let facts = solver.facts();
    let out = Adaptive {
        constraints: facts.adaptive_constraints.clone(),
        constraint_seconds: facts.adaptive_seconds,
        deflation: deflation(solver)?,
        declined: solver.deflation_declined().map(|(seen, from)| Declined {
            seen,
            worth_from: from.is_finite().then_some(from),
        }),
    };
    let added = out.constraints.iter().any(|n| *n > 0);
    let deflated = out.deflation.is_some() || out.declined.is_some();
    Ok((added || deflated).then_some(out))
}

fn deflation(solver: &FetiFeti) -> Result<Option<Deflation>> {
    let Some(cost) = solver.deflated() else {
        return Ok(None);
    };
    // A spectrum of many decades may be beyond the eigensolver.
    let exact_without = if solver.settings().method.spectrum {
        solver.plain_spectrum().ok().flatten()
    } else {
        None
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

/// The value of key `operators`. Collective.
fn operators(session: &Session, facts: &SetUpSummary) -> Operators {
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
            (&course.rows, &course.friction.rows),
            course.slides.as_ref(),
        ),
        bodies: course.balances.clone(),
        load_steps: course.load_steps.clone(),
        updated: scene.is_renewed(),
        renewable: !scene.is_renewed() && scene.may_be_renewed(),
    }))
}

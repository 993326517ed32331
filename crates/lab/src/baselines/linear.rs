//! A baseline on a problem without inequalities, or on the equations of a given active set, whose rows tie unknowns
//! together as faces do. PCBDDC and KSPFETIDP need the latter: they are set up for a mesh and its parts, and an outer
//! loop would have to set them up again in every step.

use std::path::Path;

use super::attempt::{solve_to, Attempt};
use super::corners;
use super::second::SecondLoad;
use super::table::Baseline;
use super::task::{ContactOutcome, Job, Outcome};
use crate::assembled::groups::ActiveGroups;
use crate::assembled::layout::UnknownLayout;
use crate::assembled::near::NearKernel;
use crate::assembled::rows::Inequalities;
use crate::assembled::system::{AssembledSystem, MatrixFormat};
use crate::assembled::unknowns::Unknowns;
use base::Result;
use parallel::meter::{memory, timed};
use petsc::{Comm, Is, Ksp, Mat, PetscInt, Session};
use scene::Scene;

/// The solver of a baseline with its operator and options, and the solver that iterates. The two differ for KSPFETIDP,
/// which iterates in an inner solver.
///
/// # Errors
/// PETSc's, and those of the options.
pub fn solver(session: &Session, row: &Baseline, a: &Mat) -> Result<(Ksp, Ksp)> {
    let ksp = Ksp::new(session, Comm::World)?;
    ksp.set_operators(a, a)?;
    ksp.set_options_prefix(&row.prefix())?;
    ksp.set_from_options()?;
    let krylov = match ksp.type_name()?.as_str() {
        "fetidp" => ksp.fetidp_inner_ksp()?,
        _ => ksp.clone(),
    };
    // At set-up KSPFETIDP passes this on to the inner solver and overwrites the inner solver's own setting.
    ksp.set_compute_singular_values(true)?;
    krylov.set_compute_singular_values(true)?;
    Ok((ksp, krylov))
}

/// Gives PCBDDC, alone or inside KSPFETIDP, the component and the position of each local unknown. It picks vertices
/// that hold a subdomain by these positions where each rank has one subdomain; where a rank has several, it is given
/// them.
fn tell(
    session: &Session,
    scene: &Scene,
    ksp: &Ksp,
    unknowns: &Unknowns,
    (system, format): (&AssembledSystem, MatrixFormat),
) -> Result<()> {
    if scene.components() == 1 {
        return Ok(());
    }
    let bddc = match ksp.type_name()?.as_str() {
        "fetidp" => ksp.fetidp_inner_bddc()?,
        _ => ksp.pc()?,
    };
    let list = |c: usize| -> Vec<PetscInt> {
        let of = system.local.fields.iter().enumerate();
        of.filter(|(_, f)| **f == c)
            .map(|(i, _)| i as PetscInt)
            .collect()
    };
    let sets: Result<Vec<Is>> = (0..scene.components())
        .map(|c| Is::general(session, Comm::Own, &list(c)))
        .collect();
    bddc.bddc_set_fields_local(&sets?)?;
    let layout = unknowns.layout;
    if format == MatrixFormat::Separate {
        let vertices = corners::corners(session, scene, layout, system)?;
        bddc.bddc_set_primal_vertices_local(&Is::general(session, Comm::Own, &vertices)?)?;
    }
    let node = |place: u64| layout.position(place / layout.components() as u64);
    let places = unknowns.places(system.b.ownership_range());
    let points: Vec<[f64; 3]> = places.into_iter().map(node).collect();
    bddc.set_coordinates(scene.dim(), &points)
}

/// κ by the last run of CG; `None` for other methods.
///
/// # Errors
/// PETSc's.
pub fn kappa(krylov: &Ksp) -> Result<Option<f64>> {
    if krylov.type_name()? != "cg" || krylov.iterations()? == 0 {
        return Ok(None);
    }
    let (large, small) = krylov.extreme_singular_values()?;
    // An iteration that continues after it has found the solution reports rounding as an eigenvalue.
    Ok((small > 1e-13 * large).then(|| large / small))
}

/// A baseline on its matrix in this format. `active`: the rows that hold, in scenes with inequalities.
///
/// # Errors
/// Those of the scene, PETSc's, and those of the disk.
pub fn baseline(
    session: &Session,
    scene: &Scene,
    job: &Job,
    (row, format): (&Baseline, MatrixFormat),
    active: &[usize],
    file: &Path,
) -> Result<Outcome> {
    let layout = UnknownLayout::new(scene);
    let unknowns = match format {
        MatrixFormat::Assembled => Unknowns::all(&layout),
        _ if scene.has_contact() => {
            let rows = Inequalities::new(scene, &layout);
            let mut on = rows.set(active);
            let in_order: Vec<usize> = (0..rows.len()).collect();
            let groups = ActiveGroups::new(&rows, &mut on, &in_order);
            Unknowns::merged(&layout, &rows, &groups)
        }
        _ => Unknowns::dense(&layout),
    };
    let (system, assemble) = timed(session, || {
        AssembledSystem::new(session, scene, &unknowns, format)
    })?;
    let kernel = NearKernel::new(scene, &unknowns, &system.b, row.near)?;
    kernel.attach(&system.a)?;
    let (ksp, krylov) = solver(session, row, &system.a)?;
    if format != MatrixFormat::Assembled {
        tell(session, scene, &ksp, &unknowns, (&system, format))?;
    }
    let ((), setup) = timed(session, || ksp.setup())?;
    let first = krylov.tolerances()?.0;
    let direct = krylov.type_name()? == "preonly";
    krylov.record_residuals(1)?;
    let (attempt, rtol, message) = solve_to(job.rtol, first, |rtol| {
        krylov.set_tolerances(Some(rtol), None, None, None)?;
        let u = system.b.duplicate()?;
        let ((), mut seconds) = timed(session, || ksp.solve(&system.b, &u))?;
        let mut reason = krylov.converged_reason()?;
        if !reason.converged() && !row.krylov.is_empty() {
            // Parts that mirror each other need no multipliers: then the first residual is rounding, and the iteration
            // would diverge. The assembled residual tells whether this is the case.
            let zero = krylov.residual_history()?.first().map(|r| 2.0 * r);
            krylov.set_tolerances(None, zero, None, None)?;
            let trial = u.duplicate()?;
            let ((), more) = timed(session, || ksp.solve(&system.b, &trial))?;
            krylov.set_tolerances(None, Some(0.0), None, None)?;
            if system.relative_residual(&trial)? <= job.rtol {
                u.copy_from(&trial)?;
                (reason, seconds) = (krylov.converged_reason()?, more);
            }
        }
        let iterations = krylov.iterations()?;
        Ok(Attempt {
            residual: system.relative_residual(&u)?,
            u: vec![u],
            converged: reason.converged(),
            outcome: Outcome {
                kappa: kappa(&krylov)?,
                iterations: (!direct).then_some(iterations),
                solve: seconds,
                contact: scene.has_contact().then(|| ContactOutcome {
                    steps: None,
                    active: active.to_vec(),
                }),
                reason: reason.name,
                ..Outcome::default()
            },
        })
    })?;
    let memory = memory(session);
    if unknowns.are_all() {
        attempt.save(file)?
    } else {
        unknowns.spread(session, &attempt.u[0])?.save(file)?
    }
    let again = if job.again && message.is_none() {
        krylov.set_tolerances(Some(rtol), None, None, None)?;
        let b = SecondLoad::new(&layout).of(&unknowns, &system.b)?;
        let u = b.duplicate()?;
        Some(timed(session, || ksp.solve(&b, &u))?.1)
    } else {
        None
    };
    let outcome = attempt.report(rtol, message, [assemble, setup, memory]);
    Ok(Outcome { again, ..outcome })
}

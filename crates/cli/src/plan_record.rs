//! The record of a plan.

use super::{doubts, physics, record};
use base::Result;
use fetifeti::inside::ProblemSizes;
use petsc::Session;
use report::json::{Multipliers, PlanReport, PlannedBody, PlannedInterface, PlannedMemory};
use scene::{fits, Scene};

/// The record that `plan --json` writes. Collective.
pub(super) fn report(session: &Session, scene: &Scene, sizes: &ProblemSizes) -> Result<PlanReport> {
    let plan = scene.plan();
    let left = session.agree(fits::left(session, None))?;
    let product = |counts: [usize; 3]| counts.iter().map(|&n| n.max(1)).product();
    let bodies = plan.bodies.iter().zip(&sizes.defect);
    Ok(PlanReport {
        schema: PlanReport::SCHEMA.into(),
        version: env!("CARGO_PKG_VERSION").into(),
        dimension: scene.dim(),
        form: physics::form(scene),
        ranks: session.size(),
        options: record::options(session)?,
        notes: scene.sentences(),
        free_motions: doubts::recorded(scene, &sizes.free),
        warnings: scene.warnings.clone(),
        bodies: bodies
            .map(|(b, &floating)| PlannedBody {
                name: b.name.clone(),
                elements: product(b.elements),
                subdomains: product(b.subdomains),
                dofs: b.dofs,
                prescribed: b.prescribed,
                floating,
            })
            .collect(),
        interfaces: plan
            .interfaces
            .iter()
            .map(|i| PlannedInterface {
                bodies: i.bodies.map(|b| plan.bodies[b].name.clone()),
                nodes: i.nodes,
                tied: i.tied,
                contact: i.contact,
            })
            .collect(),
        scene: plan.title,
        elements: plan.elements,
        subdomains: plan.subdomains,
        dofs: plan.dofs,
        assembled: plan.assembled,
        multipliers: Multipliers {
            local: sizes.multipliers_local,
            global: sizes.multipliers_global,
            active: sizes.multipliers_active,
        },
        inequalities: sizes.inequalities,
        primal: sizes.primal,
        load_steps: plan.steps,
        kinds: sizes.kinds,
        sparse: sizes.implicit_kinds,
        preconditioner: sizes.preconditioner.kind.pc_type.name().into(),
        memory: PlannedMemory {
            factor_mb: sizes.factor_bytes / 1e6,
            dense_mb: sizes.dense_bytes / 1e6,
            solve_mb: fits::needed(session, scene) / 1e6,
            available_mb: left.map(|l| l.bytes / 1e6),
        },
    })
}

//! Factoring one of each kind of subdomain.

use std::sync::Arc;

use super::equal;
use super::forms;
use super::jump::Jump;
use super::local::interior::{NoFactor, Solver};
use super::local::multifrontal::SingularInterior;
use super::local::problem::LocalProblem;
use super::local::scaled::Local;
use super::settings::{Adaptive, Operators, PcType, Scaling, Settings};
use super::team::Team;
use crate::petsc::Session;
use crate::substructures::{Subdomain, Substructures};
use crate::{Error, Result};

/// Factors one of each kind of subdomain.
pub(super) fn factor(
    session: &Session,
    problem: &Substructures,
    jump: &Jump,
    team: &Team,
    settings: &Settings,
    kind: PcType,
) -> Result<Vec<Local>> {
    // What multiplies with S or looks into it before the iteration begins wants a matrix.
    let wants_s = kind == PcType::CoarseCorrected
        || settings.scaling == Scaling::Deluxe
        || matches!(settings.adaptive, Adaptive::Below(_));
    let ours = settings.local.kind == Solver::Multifrontal;
    if !ours && settings.operators == Operators::Implicit {
        return Err(Error::input(format!(
            "option -{}operators is implicit, which goes with the local solver multifrontal alone, but -{0}local_solver is {}",
            settings.prefix,
            settings.local.kind.name()
        )));
    }
    let first = equal::representatives(problem, jump, team);
    let kinds = forms::kinds(problem, jump, &first);
    let forms = forms::choose(
        &kinds,
        team,
        if ours {
            settings.operators
        } else {
            Operators::Explicit
        },
        forms::APPLICATIONS[usize::from(jump.inequality.iter().any(|i| *i))],
        settings
            .memory
            .map_or(forms::usual_memory(session.size()), |mb| 1e6 * mb as f64),
        wants_s,
    );
    let factored = team.map(kinds.len(), |k| {
        let (kind, sub) = (&kinds[k], kinds[k].sub);
        let averages = jump.averages[kind.j].iter();
        let averages: Vec<&[u32]> = averages.map(|a| &a.dofs[..]).collect();
        let places = sub.coordinates.as_deref();
        let (delta, primal, form) = (kind.delta, kind.primal, forms[k]);
        LocalProblem::new(
            &sub.k,
            delta,
            primal,
            &averages,
            places,
            settings.local,
            form,
        )
        .map(|mut local| {
            if kind.copies < forms::MANY {
                local.pack();
            }
            Arc::new(local)
        })
        .map_err(|e| no_factor(problem, sub, e))
    });
    let factored = factored.into_iter().collect::<Result<Vec<_>>>()?;
    let place = |j: usize| kinds.binary_search_by_key(&j, |k| k.j).expect("a kind");
    let of = |&(j, factor): &(usize, f64)| Local::new(factored[place(j)].clone(), factor);
    Ok(first.iter().map(of).collect())
}

/// Why subdomain `sub` cannot be factored, for the user.
pub(super) fn no_factor(problem: &Substructures, sub: &Subdomain, error: NoFactor) -> Error {
    match error {
        NoFactor::Interior(SingularInterior { dof }) | NoFactor::Indefinite(dof) => {
            unfit_matrix(problem, sub, dof)
        }
        NoFactor::Failed(why) => Error::environment(why),
    }
}

fn unfit_matrix(problem: &Substructures, sub: &Subdomain, dof: u32) -> Error {
    Error::Unfit(format!(
        "the matrix of subdomain {} in body \"{}\" is not positive semidefinite (at local dof {dof}), expected a stiffness matrix",
        sub.index, problem.body_names[sub.body]
    ))
}

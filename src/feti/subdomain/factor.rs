//! Factorisation of one subdomain of each kind.

use std::collections::hash_map::DefaultHasher;
use std::collections::HashMap;
use std::hash::{Hash, Hasher};
use std::sync::Arc;

use super::equal::{same_averages, Likeness};
use super::problem::{basis, LocalProblem};
use super::retained::Still;
use super::scaled::ScaledSubdomain;
use super::which::OperatorForm;
use crate::feti::cost::forms::{self, SubdomainKind};
use crate::feti::interface::entities::Average;
use crate::feti::jump::operator::Jump;
use crate::feti::settings::{Adaptive, MethodSettings, Scaling};
use crate::feti::subdomain::equal;
use crate::substructures::{Problem, Subdomain};
use crate::{Error, Result};
use cholesky::interior::{Analysed, Analysis, Condenser, NoFactor};
use cholesky::multifrontal::SingularInterior;
use cholesky::symbolic::Symbolic;
use parallel::team::Team;
use petsc::Session;

/// The local subdomains, factored.
pub(crate) struct Factored {
    pub locals: Vec<ScaledSubdomain>,
    /// The analysis of each one's pattern, if the settings want it or it was there already.
    pub analysed: Vec<Option<Arc<Analysed>>>,
}

/// Factors one subdomain of each kind. `needs_s`: whether the preconditioner uses S before the iteration begins. `kept`
/// has what of them is known already; it may be empty.
pub(crate) fn factor(
    session: &Session,
    problem: &Problem,
    jump: &Jump,
    team: &Team,
    (settings, needs_s): (&MethodSettings, bool),
    kept: &[Still],
) -> Result<Factored> {
    // A matrix S is needed by every user that multiplies with it or reads its entries before the iteration begins.
    let wants_s = needs_s
        || settings.scaling == Some(Scaling::Deluxe)
        || matches!(settings.adaptive, Adaptive::Below(_));
    let first = equal::representatives(problem, jump, team);
    let kinds = forms::kinds(problem, jump, &first);
    let place = |j: usize| kinds.binary_search_by_key(&j, |k| k.j).expect("a kind");
    let known = |j: usize| kept.get(j).and_then(|k| k.whole.as_ref());
    let forms_so_far: Vec<Option<OperatorForm>> = kinds
        .iter()
        .map(|k| kept.get(k.j).and_then(|k| k.form))
        .collect();
    let (forms, counted) = forms::choose(
        &kinds,
        &forms_so_far,
        team,
        settings.operators,
        forms::APPLICATIONS[usize::from(jump.law.iter().any(|law| law.is_inequality()))],
        settings
            .memory
            .map_or(forms::usual_memory(session.size()), |mb| 1e6 * mb as f64),
        wants_s,
    );
    let mut needed = vec![false; kinds.len()];
    for (j, like) in first.iter().enumerate() {
        needed[place(like.first)] |= known(j).is_none();
    }
    let found = |j: usize| kept.get(j).and_then(|k| k.analysed.clone());
    let keeps = settings.keeps_analyses;
    let there = |k: usize| found(kinds[k].j).or_else(|| counted[k].clone());
    let analysed = analyses(&kinds, (&forms, &needed), (&there, keeps), team);
    let make = |k: usize, j: usize| {
        let (kind, sub) = (&kinds[k], &problem.local[j]);
        let condenser = Condenser {
            analysed: analysed[k].as_deref(),
            keep: kind.keep(),
        };
        let averages = jump.averages[j].iter();
        let averages: Vec<&Average> = averages.collect();
        let places = sub.coordinates.as_deref();
        let (delta, primal, form) = (kind.delta, kind.primal, forms[k]);
        // Nothing else could stiffen what no other subdomain and no row shares.
        if let Some(dof) = slack(sub, [delta, primal]) {
            return Err(unfit_matrix(problem, sub, dof));
        }
        LocalProblem::new(&sub.k, delta, primal, &averages, places, condenser, form)
            .map_err(|e| no_factor(problem, sub, e))
            .and_then(|mut local| {
                let gamma = &local.gamma;
                // A fixing dof is one that nothing else holds.
                if let Some(&i) = gamma.fixing.iter().find(|&&i| local.stiff[i] == 0.0) {
                    return Err(no_stiffness(problem, sub, gamma.interface[i]));
                }
                if kind.copies > 1 {
                    local.store_psi();
                }
                if kind.copies < forms::MANY {
                    local.pack();
                }
                Ok(Arc::new(local))
            })
    };
    let factored = team.map(kinds.len(), |k| {
        needed[k].then(|| make(k, kinds[k].j)).transpose()
    });
    let factored = factored.into_iter().collect::<Result<Vec<_>>>()?;
    // Copies that are turned alike have Ψ in common.
    let mut turned: Vec<(usize, usize, ScaledSubdomain)> = Vec::new();
    let of = |(j, like): (usize, &Likeness)| {
        if let Some(known) = known(j) {
            return Ok(known.clone());
        }
        let k = place(like.first);
        let problem = factored[k].as_ref().expect("a kind that is needed");
        let Some(turn) = like.turn else {
            return Ok(ScaledSubdomain::new(problem.clone(), like.factor));
        };
        // Free dofs of the interior that joined Γ tear nodes apart.
        if problem.gamma.n_gamma() > kinds[k].delta.len() + kinds[k].primal.len() {
            return Ok(ScaledSubdomain::new(make(k, j)?, 1.0));
        }
        let same = |(first, i, s): &&(usize, usize, ScaledSubdomain)| {
            *first == like.first && s.turn() == Some(&turn) && same_averages(jump, *i, j)
        };
        if let Some((_, _, known)) = turned.iter().find(same) {
            return Ok(known.with_factor(like.factor));
        }
        let averages: Vec<&Average> = jump.averages[j].iter().collect();
        let basis = basis(&jump.delta[j], &averages);
        let new = ScaledSubdomain::turned(problem.clone(), like.factor, turn, basis);
        turned.push((like.first, j, new.clone()));
        Ok(new)
    };
    let locals: Result<Vec<ScaledSubdomain>> = first.iter().enumerate().map(of).collect();
    let pattern = |(j, like): (usize, &Likeness)| {
        if known(j).is_some() {
            return found(j);
        }
        analysed[place(like.first)].clone().filter(|_| keeps)
    };
    Ok(Factored {
        locals: locals?,
        analysed: first.iter().enumerate().map(pattern).collect(),
    })
}

/// The analyses of each kind that has to be factored: those that are `found` already for it, one for all kinds with the
/// same pattern and interface otherwise. Different coefficients and moved nodes change values only. A pattern of a
/// single kind is analysed during its factorisation; its analysis is dropped then, unless it is to be kept (`keeps`).
fn analyses(
    kinds: &[SubdomainKind],
    (forms, needed): (&[OperatorForm], &[bool]),
    (found, keeps): (&dyn Fn(usize) -> Option<Arc<Analysed>>, bool),
    team: &Team,
) -> Vec<Option<Arc<Analysed>>> {
    let mut groups: HashMap<u64, Vec<Vec<usize>>> = HashMap::new();
    let hashes = team.map(kinds.len(), |k| pattern_hash(&kinds[k]));
    for (k, hash) in hashes.iter().enumerate().filter(|(k, _)| needed[*k]) {
        let alike = groups.entry(*hash).or_default();
        match alike
            .iter_mut()
            .find(|g| same_pattern(&kinds[g[0]], &kinds[k]))
        {
            Some(group) => group.push(k),
            None => alike.push(vec![k]),
        }
    }
    let mut groups: Vec<Vec<usize>> = groups.into_values().flatten().collect();
    groups.sort_unstable();
    let mut out = vec![None; kinds.len()];
    // Groups whose kinds would otherwise all analyse the pattern.
    let mut open = Vec::new();
    for group in &groups {
        let mut of_group = group.iter().filter_map(|&k| found(k));
        let dense = |k: &&usize| forms[**k] == OperatorForm::Explicit;
        let shared = group.iter().filter(dense).count() > 1;
        let Some(analysed) = of_group
            .next()
            .or_else(|| (keeps || shared).then(Arc::default))
        else {
            continue;
        };
        if shared && analysed.dense.get().is_none() {
            open.push((group[0], analysed.clone()));
        }
        group.iter().for_each(|&k| out[k] = Some(analysed.clone()));
    }
    team.map(open.len(), |g| {
        let (k, analysed) = &open[g];
        let kind = &kinds[*k];
        let interface = [kind.delta, kind.primal].concat();
        let places = kind.sub.coordinates.as_deref();
        let made = Analysis::new(Symbolic::new(&kind.sub.k, &interface, places));
        let _ = analysed.dense.set(Arc::new(made));
    });
    out
}

fn pattern_hash(kind: &SubdomainKind) -> u64 {
    let mut state = DefaultHasher::new();
    let k = &kind.sub.k;
    (k.n(), k.nnz(), kind.delta, kind.primal).hash(&mut state);
    state.finish()
}

fn same_pattern(a: &SubdomainKind, b: &SubdomainKind) -> bool {
    let (k, l) = (&a.sub.k, &b.sub.k);
    let averages = |kind: &SubdomainKind| -> Vec<Vec<u32>> {
        kind.averages.iter().map(|a| a.dofs.clone()).collect()
    };
    let same = (a.delta, a.primal) == (b.delta, b.primal) && averages(a) == averages(b);
    same && k.row_ptr == l.row_ptr && k.col == l.col
}

/// The error for the user when subdomain `sub` cannot be factored.
pub(crate) fn no_factor(problem: &Problem, sub: &Subdomain, error: NoFactor) -> Error {
    match error {
        NoFactor::Interior(SingularInterior { dof }) | NoFactor::Indefinite(dof) => {
            unfit_matrix(problem, sub, dof)
        }
    }
}

/// A dof without stiffness inside the subdomain, away from its interface.
fn slack(sub: &Subdomain, interface: [&[u32]; 2]) -> Option<u32> {
    let mut slack = sub.k.diagonal().into_iter().enumerate();
    let dofs = slack.find(|&(i, d)| d == 0.0 && !interface.concat().contains(&(i as u32)));
    dofs.map(|(i, _)| i as u32)
}

/// The error for a row of zeros at a dof of the interface.
pub(crate) fn no_stiffness(problem: &Problem, sub: &Subdomain, dof: u32) -> Error {
    let place = sub.coordinates.as_ref().map(|c| c[dof as usize]);
    let place = place.map_or(String::new(), |[x, y, z]| format!(", at ({x}, {y}, {z})"));
    Error::unfit(format!(
        "the matrix of subdomain {} in body \"{}\" has a row of zeros on its interface (at local dof {dof}{place}), \
         expected a stiffness matrix that holds it",
        sub.index, problem.body_names[sub.body]
    ))
    .at(problem.location(&[sub.body as u32]))
}

fn unfit_matrix(problem: &Problem, sub: &Subdomain, dof: u32) -> Error {
    Error::unfit(format!(
        "the matrix of subdomain {} in body \"{}\" is not positive semidefinite \
         (at local dof {dof}), expected a stiffness matrix",
        sub.index, problem.body_names[sub.body]
    ))
    .at(problem.location(&[sub.body as u32]))
}

//! Subdomains with the constraints that were found for them.

use std::sync::{Arc, Mutex};

use crate::feti::interface::entities::{Average, AverageKind};
use crate::feti::jump::operator::Jump;
use crate::feti::subdomain::problem::LocalProblem;
use crate::feti::subdomain::scaled::ScaledSubdomain;
use crate::feti::subdomain::which::OperatorForm;
use crate::substructures::{Problem, Subdomain};
use crate::Result;
use cholesky::interior::{Condenser, NoFactor};
use cholesky::symbolic::Keep;
use parallel::team::Team;

/// Gives the subdomains the constraints that
/// [`find_adaptive_constraints`](super::constraints::find_adaptive_constraints) added. Subdomains that were equal stay
/// equal, but a turned copy with a constraint gets operators of its own. The old operators are dropped one by one, so
/// that two operators of every subdomain never exist at the same time.
pub fn constrain(
    problem: &Problem,
    jump: &Jump,
    locals: Vec<ScaledSubdomain>,
    team: &Team,
    fails: impl Fn(&Subdomain, NoFactor) -> crate::Error + Sync,
) -> Result<Vec<ScaledSubdomain>> {
    let added = |j: usize| {
        let list = jump.averages[j].iter();
        let list = list.filter(|a| a.kind == AverageKind::Adaptive);
        list.filter_map(|a| Some((&a.dofs[..], a.weights.as_deref()?)))
    };
    let grows: Vec<bool> = (0..locals.len())
        .map(|j| added(j).next().is_some())
        .collect();
    let mut first: Vec<usize> = Vec::new();
    for j in 0..locals.len() {
        let same = |&i: &usize| locals[i].name() == locals[j].name() && added(i).eq(added(j));
        first.push((0..j).find(same).unwrap_or(j));
    }
    let kinds: Vec<usize> = (0..first.len())
        .filter(|&j| first[j] == j && grows[j])
        .collect();
    // The operators of a kind belong to the matrix of one subdomain. The others have a multiple of it, and theirs must
    // not be taken: their factor would count twice. A turned copy takes its own matrix, which the others then have a
    // multiple of.
    let own = |&j: &usize| {
        let is = |&i: &usize| locals[i].name() == locals[j].name() && locals[i].factor == 1.0;
        let plain = || (0..locals.len()).find(is);
        let found = locals[j].turn().map_or_else(plain, |_| Some(j));
        found.expect("operators belong to a matrix")
    };
    let own: Vec<usize> = kinds.iter().map(own).collect();
    let held = |&j: &usize| {
        let turned = locals[j].turn().is_some();
        Mutex::new(Some((locals[j].kind().clone(), turned)))
    };
    let held: Vec<_> = kinds.iter().map(held).collect();
    let factor = |(local, first): (&ScaledSubdomain, &usize)| match locals[*first].turn() {
        Some(_) => local.factor / locals[*first].factor,
        None => local.factor,
    };
    let factors: Vec<f64> = locals.iter().zip(&first).map(factor).collect();
    let kept = locals.into_iter().zip(&grows);
    let kept: Vec<Option<ScaledSubdomain>> = kept.map(|(l, grows)| (!grows).then_some(l)).collect();
    let renewed = team.map(kinds.len(), |k| {
        let (j, old) = (kinds[k], held[k].lock().expect("nobody panics").take());
        let (mut old, turned) = old.expect("each is taken once");
        let (sub, places) = (
            &problem.local[own[k]],
            problem.local[own[k]].coordinates.as_deref(),
        );
        if turned {
            let base = unturned(jump, j, &old, sub).map_err(|e| fails(sub, e))?;
            old = Arc::new(base);
        }
        let renewed = old.constrained(&sub.k, added(j), places);
        renewed.map(Arc::new).map_err(|e| fails(sub, e))
    });
    let renewed = renewed.into_iter().collect::<Result<Vec<_>>>()?;
    let place = |j: &usize| kinds.binary_search(j).expect("a first one is a kind");
    let of = |((kept, j), factor): ((Option<ScaledSubdomain>, &usize), f64)| {
        kept.unwrap_or_else(|| ScaledSubdomain::new(renewed[place(j)].clone(), factor))
    };
    Ok(kept.into_iter().zip(&first).zip(factors).map(of).collect())
}

/// Local subdomain `j`, which shared the operators of `like` as a turned copy, with operators of its own.
fn unturned(
    jump: &Jump,
    j: usize,
    like: &LocalProblem,
    sub: &Subdomain,
) -> std::result::Result<LocalProblem, NoFactor> {
    let averages = jump.averages[j].iter();
    let averages: Vec<&Average> = averages
        .filter(|a| a.kind != AverageKind::Adaptive)
        .collect();
    let (delta, vertices) = like.gamma.interface.split_at(like.gamma.n_delta);
    let (places, condenser) = (sub.coordinates.as_deref(), Condenser::alone(Keep::Interior));
    let form = OperatorForm::Explicit;
    let mut out = LocalProblem::new(&sub.k, delta, vertices, &averages, places, condenser, form)?;
    if like.operators.is_packed() {
        out.pack();
    }
    Ok(out)
}

//! Displacements that satisfy all rows and multipliers that push everywhere, near those of a solution.

use super::loads::Loads;
use crate::feti::jump::operator::Jump;
use crate::feti::method::LinearMethod;
use crate::feti::operators::dual::Dual;
use crate::feti::projector::balance::KernelLoad;
use crate::feti::subdomain::scaled::ScaledSubdomain;
use crate::Result;
use cholesky::lanes::LANES;
use parallel::exchange::{any, max_all};

/// Rounds in which rows are closed, and in which multipliers that pull are taken away.
const ROUNDS: usize = 12;

/// Jumps below this part of the largest displacement or gap are rounding.
const CLOSED: f64 = 1e-12;

/// Gaps of dependent rows that contradict each other by less than this part of it do so by rounding.
const AGREES: f64 = 1e-10;

/// Forces of dependent rows below this part of the largest multiplier are rounding.
const SAME: f64 = 1e-12;

/// Displacements that satisfy all rows.
pub(super) struct Admissible {
    /// By local dof of each local subdomain.
    pub u: Vec<Vec<f64>>,
    /// c − B u on the owned rows: 0 where they are closed, positive where inequalities are open.
    slack: Vec<f64>,
}

impl Admissible {
    /// This rank's part of λᵀ (c − B u).
    pub fn work(&self, lambda: &[f64]) -> f64 {
        lambda.iter().zip(&self.slack).map(|(l, s)| l * s).sum()
    }
}

/// u ← u − H B_Dᵀ (B u − c) on the rows that hold, and on those that are violated, until all are satisfied; H continues
/// into the interiors with least energy. `None` if there is no end of it. The set of rows that hold is put back.
/// Collective.
pub(super) fn admissible(method: &LinearMethod, u: &[Vec<f64>]) -> Result<Option<Admissible>> {
    method.with_rows_put_back(|| closed(method, u))
}

/// [`admissible`], which leaves other rows held.
fn closed(method: &LinearMethod, u: &[Vec<f64>]) -> Result<Option<Admissible>> {
    let mut held = method.dual().stiffness.jump.active.clone();
    let mut out = u.to_vec();
    let mut found = None;
    for round in 0..=ROUNDS {
        let (gaps, length) = all_gaps(method, &out)?;
        let (more, far) = {
            let dual = method.dual();
            let jump = &dual.stiffness.jump;
            let mut more = false;
            let mut far = 0.0f64;
            for (r, &gap) in gaps.iter().enumerate() {
                if held[r] {
                    let slack = jump.held[r] - jump.gap[r];
                    let slack = if slack.abs() < AGREES * length {
                        slack
                    } else {
                        0.0
                    };
                    far = far.max((gap - slack).abs());
                } else if jump.law[r].violation(gap, false) > CLOSED * length {
                    held[r] = true;
                    more = true;
                    far = far.max(gap);
                }
            }
            let mut largest = [far, f64::from(u8::from(more))];
            max_all(dual.comm(), &mut largest);
            (largest[1] > 0.0, largest[0])
        };
        if !more && far <= CLOSED * length {
            // The force of a node that slips is given, and does its work on whatever slip there is.
            let law = &method.dual().stiffness.jump.law;
            let open = |r: &usize| !held[*r] && !law[*r].is_friction();
            let slack = |r: usize| if open(&r) { (-gaps[r]).max(0.0) } else { 0.0 };
            found = Some((0..gaps.len()).map(slack).collect());
            break;
        }
        if round == ROUNDS {
            break;
        }
        if more {
            method.set_active(&held)?;
        }
        close(method, &gaps, &mut out)?;
    }
    Ok(found.map(|slack| Admissible { u: out, slack }))
}

/// B u − c on the owned rows, and the scale of its terms. Collective.
fn all_gaps(method: &LinearMethod, u: &[Vec<f64>]) -> Result<(Vec<f64>, f64)> {
    let dual = method.dual();
    let stiffness = &dual.stiffness;
    let jump = &stiffness.jump;
    let mut work = stiffness.work();
    for ((w, local), u) in work.iter_mut().zip(&stiffness.locals).zip(u) {
        for (y, &i) in w.y.iter_mut().zip(&local.gamma().interface) {
            *y = u[i as usize];
        }
    }
    let rows = dual.multipliers()?;
    stiffness.jump_of_all(&work, &rows)?;
    let mut gaps = rows.to_vec()?;
    gaps.iter_mut().zip(&jump.gap).for_each(|(b, c)| *b -= c);
    let size = |list: &mut dyn Iterator<Item = &f64>| list.fold(0.0f64, |a, v| a.max(v.abs()));
    let candidates = (0..jump.n_owned).filter(|&r| jump.is_candidate(r));
    let mut largest = [
        size(&mut u.iter().flatten()),
        size(&mut candidates.map(|r| &jump.gap[r])),
    ];
    max_all(dual.comm(), &mut largest);
    Ok((gaps, largest[0].max(largest[1])))
}

/// u ← u − H B_Dᵀ gaps on the rows that hold now. Collective.
fn close(method: &LinearMethod, gaps: &[f64], u: &mut [Vec<f64>]) -> Result<()> {
    let dual = method.dual();
    let stiffness = &dual.stiffness;
    let jump = &stiffness.jump;
    let rows = dual.multipliers()?;
    {
        let mut rows = rows.array_mut()?;
        let inside = jump.rows_between_bodies().start;
        for (r, row) in rows.iter_mut().enumerate() {
            if r < inside || jump.active[r] {
                *row = gaps[r] - (jump.held[r] - jump.gap[r]);
            }
        }
    }
    let mut ghost = stiffness.scaled_ghosts();
    stiffness.fetch_scaled(&rows, &mut ghost)?;
    let columns = &jump.columns;
    let mut work = stiffness.work();
    stiffness.team.for_each(&mut work, |j, w| {
        columns.of(j).bd_transpose(&ghost, &mut w.y); /*      v ← B_Dᵀ (B u − c)        */
    });
    let none: Vec<Vec<f64>> = u.iter().map(|u| vec![0.0; u.len()]).collect();
    let none: Vec<&[f64]> = none.iter().map(Vec::as_slice).collect();
    let still = Loads::of(&dual, &none, None).interiors;
    let batches = stiffness.batches(LANES);
    let moved = stiffness.by_batch(&batches, |locals, members| {
        let part = |&j: &usize| (&still[j][..], &work[j].y[..]);
        let parts: Vec<_> = members.iter().map(part).collect();
        ScaledSubdomain::recover_many(locals, &parts)
    });
    for (u, v) in u.iter_mut().flatten().zip(moved.iter().flatten()) {
        *u -= v; /*                                           u ← u − H v               */
    }
    Ok(())
}

/// Multipliers near `lambda` that are not negative on inequalities and balance the loads of floating bodies. `None` if
/// there is no end of the search. The set of rows that hold is put back. Collective.
pub(super) fn feasible(method: &LinearMethod, lambda: &[f64]) -> Result<Option<Vec<f64>>> {
    method.with_rows_put_back(|| pushing(method, lambda))
}

/// [`feasible`], which leaves other rows held.
fn pushing(method: &LinearMethod, lambda: &[f64]) -> Result<Option<Vec<f64>>> {
    let mut held = method.dual().stiffness.jump.active.clone();
    let mut out = lambda.to_vec();
    let mut found = false;
    let mut load = None;
    for _ in 0..ROUNDS {
        let pulls = {
            let dual = method.dual();
            let jump = &dual.stiffness.jump;
            share(jump, &held, &mut out);
            let mut pulls = false;
            for r in jump.rows_between_bodies() {
                let law = jump.law[r];
                if law.pull(out[r]) > 0.0 {
                    (out[r], held[r], pulls) = (law.project(out[r]), false, true);
                }
            }
            any(dual.comm(), pulls)
        };
        if !pulls {
            found = true;
            break;
        }
        method.set_active(&held)?;
        let dual = method.dual();
        let load = match &load {
            Some(load) => load,
            None => load.insert(given_load(method, &dual, lambda)?),
        };
        let rows = dual.multipliers()?;
        rows.array_mut()?.copy_from_slice(&out);
        dual.natural.balance(dual.comm(), load, &rows)?;
        out.copy_from_slice(&rows.array()?);
    }
    Ok(found.then_some(out))
}

/// The loads on floating bodies with the forces of nodes that slip. Collective.
fn given_load(method: &LinearMethod, dual: &Dual, lambda: &[f64]) -> Result<KernelLoad> {
    let jump = &dual.stiffness.jump;
    let slips = |r: usize| jump.law[r].is_friction() && !jump.active[r];
    let given = |r: usize| if slips(r) { lambda[r] } else { 0.0 };
    let given: Vec<f64> = (0..lambda.len()).map(given).collect();
    let loads = Loads::new(&method.problem, dual);
    Ok(loads.with_multipliers(&method.problem, dual, &given)?.1)
}

/// Gives dependent rows, some of which pull, other multipliers with the same forces, if there are some that push.
fn share(jump: &Jump, held: &[bool], lambda: &mut [f64]) {
    for block in &jump.blocks {
        let start = block.rows.start;
        let on = &held[block.rows.clone()];
        let pulls = |r: usize| jump.law[start + r].pull(lambda[start + r]) > 0.0;
        if !(0..on.len()).any(|r| on[r] && pulls(r)) {
            continue;
        }
        let of_block = block.rows.clone();
        let others = block.others(on, &jump.law[of_block.clone()], &lambda[of_block]);
        let Some(others) = others else {
            continue;
        };
        let own = others.multipliers.iter().map(|m| lambda[start + m.0].abs());
        if others.rest <= SAME * own.fold(0.0, f64::max) {
            for (row, value) in others.multipliers {
                lambda[start + row] = value;
            }
        }
    }
}

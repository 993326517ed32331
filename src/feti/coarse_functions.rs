//! Z_c before anything is multiplied with it: copies of Ψ averaged inside the bodies.

use std::collections::BTreeMap;

use mpi::traits::Communicator;

use super::exchange::exchange_words;
use super::jump::Jump;
use super::local::dense::Dense;
use super::local::scaled::Local;
use super::sharing::Sharing;
use super::stiffness::Stiffness;
use crate::petsc::Session;
use crate::substructures::Substructures;

/// Z_c on one subdomain with the global numbers of its columns.
pub(super) struct Averaged {
    /// n_Γ × columns.
    pub z: Dense,
    /// Global numbers, increasing.
    pub columns: Vec<u32>,
}

/// What one subdomain contributes to the columns of another one: rows of D Ψ, D scaled to a sum of one over the copies.
struct Contribution {
    /// The subdomain that it comes from.
    from: u64,
    /// Global numbers of its columns.
    columns: Vec<u32>,
    /// (position in Γ of the one that it goes to, a value for each column).
    rows: Vec<(u32, Vec<f64>)>,
}

/// Exchanges rows of Ψ between the copies of every shared dof and averages them.
pub(super) fn average_copies(
    session: &Session,
    problem: &Substructures,
    sharing: &Sharing,
    stiffness: &Stiffness,
) -> Vec<Averaged> {
    let (comm, team) = (session.comm(), &stiffness.team);
    let (space, locals, jump) = (&stiffness.space, &stiffness.locals, &stiffness.jump);
    let global = |j: usize, p: usize| space.ghosts[space.of_subdomain[j][p] as usize];
    // For each subdomain that shares something: [to, from, columns, rows, column numbers, (local dof, values) of each row].
    let packed = team.map(locals.len(), |j| {
        let (sub, local) = (&problem.local[j], &locals[j]);
        let shared = shared_columns(jump, local, j);
        let mut lists: BTreeMap<u32, Vec<u64>> = BTreeMap::new();
        for (i, &dof) in local.interface[..local.n_delta].iter().enumerate() {
            let copies = sharing.shared(sub.dofs[dof as usize]);
            let total: f64 = copies.iter().map(|c| c.weight).sum();
            let Some(own) = copies.iter().find(|c| c.subdomain as usize == sub.index) else {
                continue;
            };
            for to in copies {
                let list = lists.entry(to.subdomain).or_insert_with(|| {
                    let head = [
                        to.subdomain as u64,
                        sub.index as u64,
                        shared.len() as u64,
                        0,
                    ];
                    let columns = shared.iter().map(|&p| u64::from(global(j, p)));
                    head.into_iter().chain(columns).collect()
                });
                list[3] += 1;
                list.push(u64::from(to.local));
                let value = |&p: &usize| (own.weight / total * local.psi.get(i, p)).to_bits();
                list.extend(shared.iter().map(value));
            }
        }
        lists
    });
    let mut outgoing: Vec<Vec<u64>> = vec![Vec::new(); comm.size() as usize];
    for (to, list) in packed.into_iter().flatten() {
        outgoing[sharing.rank_of[to as usize] as usize].extend(list);
    }
    let places: Vec<Vec<(u32, u32)>> = locals
        .iter()
        .map(|local| {
            let mut place: Vec<(u32, u32)> = local.interface.iter().copied().zip(0..).collect();
            place.sort_unstable();
            place
        })
        .collect();
    let mut received: Vec<Vec<Contribution>> = locals.iter().map(|_| Vec::new()).collect();
    for words in exchange_words(comm, outgoing) {
        let mut rest = &words[..];
        while let [to, from, n, m, tail @ ..] = rest {
            let j = jump.local_index(*to as u32);
            let n = *n as usize;
            let (columns, tail) = tail.split_at(n);
            let (rows, tail) = tail.split_at(*m as usize * (n + 1));
            let row = |w: &[u64]| {
                let at = places[j].binary_search_by_key(&(w[0] as u32), |p| p.0);
                let at = places[j][at.expect("a shared dof is an interface dof")].1;
                (at, w[1..].iter().map(|&v| f64::from_bits(v)).collect())
            };
            received[j].push(Contribution {
                from: *from,
                columns: columns.iter().map(|&c| c as u32).collect(),
                rows: rows.chunks_exact(n + 1).map(row).collect(),
            });
            rest = tail;
        }
    }
    // Added up in the same order whatever the ranks.
    received
        .iter_mut()
        .for_each(|list| list.sort_unstable_by_key(|c| c.from));
    team.map(locals.len(), |j| {
        let n_shared = jump.n_shared[j];
        let vertices: Vec<u32> = (0..n_shared).map(|p| global(j, p)).collect();
        gather(
            &locals[j],
            &received[j],
            &vertices,
            &candidates(jump, &locals[j], j),
        )
    })
}

/// The primal dofs of local subdomain `j` that it shares: vertices and averages.
fn shared_columns(jump: &Jump, local: &Local, j: usize) -> Vec<usize> {
    let first = local.n_vertices();
    (0..jump.n_shared[j])
        .chain(first..first + jump.averages[j].len())
        .collect()
}

/// Which interface positions of local subdomain `j` may be in contact: those with an entry of B_gl.
fn candidates(jump: &Jump, local: &Local, j: usize) -> Vec<bool> {
    let columns = &jump.columns[j];
    let mut out = vec![false; local.n_gamma()];
    for (&row, &at) in columns.row.iter().zip(&columns.at) {
        out[at as usize] |= jump.ghost_is_contact[row as usize];
    }
    out
}

/// Z_c on one subdomain: the sum of the contributions, one at each shared vertex, zero where bodies may touch.
fn gather(
    local: &Local,
    received: &[Contribution],
    vertices: &[u32],
    candidate: &[bool],
) -> Averaged {
    let live = |row: &(u32, Vec<f64>)| !candidate[row.0 as usize];
    let mut columns: Vec<u32> = received
        .iter()
        .filter(|c| c.rows.iter().any(live))
        .flat_map(|c| c.columns.iter().copied())
        .collect();
    let held = vertices.iter().enumerate();
    let held = held.filter(|(p, _)| !candidate[local.n_delta + p]);
    columns.extend(held.clone().map(|(_, g)| g));
    columns.sort_unstable();
    columns.dedup();
    let place = |c: &u32| {
        columns
            .binary_search(c)
            .expect("every column was collected")
    };
    let mut z = Dense::zeros(local.n_gamma(), columns.len());
    for contribution in received {
        let rows = || contribution.rows.iter().filter(|r| live(r));
        if rows().next().is_none() {
            continue;
        }
        for (k, column) in contribution.columns.iter().map(place).enumerate() {
            let z = z.col_mut(column);
            rows().for_each(|(i, values)| z[*i as usize] += values[k]);
        }
    }
    for (p, g) in held {
        z.set(local.n_delta + p, place(g), 1.0);
    }
    Averaged { z, columns }
}

//! Adaptive primal constraints: functionals that become primal inside bodies, where coefficients jump along or beside
//! the interfaces of the subdomains.
//!
//! The rank of the lowest subdomain of a class solves the eigenproblem of [`pencil`] on the class. It sends the
//! functionals to all subdomains that share the class.

use std::collections::HashMap;

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use super::classes::DualClass;
use super::pencil::PencilTerm;
use crate::feti::adaptive::classes;
use crate::feti::adaptive::pencil;
use crate::feti::interface::entities::{Average, AverageKind};
use crate::feti::interface::sharing::DofSharing;
use crate::feti::jump::operator::Jump;
use crate::feti::settings::Adaptive;
use crate::feti::subdomain::scaled::ScaledSubdomain;
use crate::substructures::{Problem, Subdomain};
use base::linalg::dense::{multiply, Dense};
use bytemuck::{Pod, Zeroable};
use parallel::exchange::{any, exchange_by_rank, sum_all};
use parallel::parcels::Parcels;
use parallel::team::Team;

/// Finds the constraints that bring the eigenvalues of every class below τ and adds them to `jump.averages`. The
/// entries of `jump` are on interface positions. Returns the number of constraints of each body over all ranks; the
/// list is empty if no class is tested. Collective.
pub fn find_adaptive_constraints(
    comm: &SimpleCommunicator,
    problem: &Problem,
    sharing: &DofSharing,
    jump: &mut Jump,
    locals: &[ScaledSubdomain],
    team: &Team,
    adaptive: Adaptive,
) -> Vec<usize> {
    let (tau, all) = match adaptive {
        Adaptive::Off => return Vec::new(),
        Adaptive::Auto => (Adaptive::USUAL, false),
        // Where coefficients do not vary along a class, its eigenvalues come from the mesh and are about ten at most.
        // Deflation sees these eigenvalues, too.
        Adaptive::Below(tau) => (tau, tau < Adaptive::USUAL),
    };
    if !all && !classes::anywhere(comm, problem, locals) {
        return Vec::new();
    }
    let mut classes: Vec<Vec<DualClass>> = (0..locals.len())
        .map(|j| classes::of(&problem.local[j], sharing, &locals[j], |_| true))
        .collect();
    if !all {
        let rough = classes::rough(comm, problem, sharing, locals, &classes);
        let keep = classes.iter_mut().zip(rough);
        keep.for_each(|(list, rough)| {
            let mut rough = rough.into_iter();
            list.retain(|_| rough.next() == Some(true));
        });
    }
    if !any(comm, classes.iter().any(|list| !list.is_empty())) {
        return Vec::new();
    }

    for (j, list) in classes.iter_mut().enumerate() {
        classes::collect_entries(jump, j, locals[j].gamma().n_gamma(), list);
    }
    // Each sharer sends its part to the rank of the lowest sharer.
    let rank = comm.rank() as usize;
    let rank_of = |s: u32| sharing.locations.rank(s);
    let part = |j: usize, class: &DualClass| pencil_term(problem, jump, &locals[j], j, class);
    let of = |j: usize, class: &DualClass| ClassSharer::new(class, problem.local[j].index as u32);
    let (mut entries, mut names) = (Parcels::for_each_rank(comm), Parcels::for_each_rank(comm));
    for (j, list) in classes.iter().enumerate() {
        for class in list.iter().filter(|c| rank_of(c.sharers[0]) != rank) {
            let (to, part) = (rank_of(class.sharers[0]), part(j, class));
            entries[to].push(orders(&part), numbers(&part));
            names[to].push(of(j, class), part.names);
        }
    }
    let entries = exchange_by_rank(comm, entries);
    let names = exchange_by_rank(comm, names);
    let mut received: HashMap<ClassSharer, PencilTerm> = HashMap::new();
    let entries = entries.iter().flat_map(Parcels::iter);
    for ((orders, numbers), (of, names)) in entries.zip(names.iter().flat_map(Parcels::iter)) {
        received.insert(of, part_of(orders, numbers, names));
    }
    let mut here: HashMap<ClassSharer, (usize, &DualClass)> = HashMap::new();
    let mut owned = Vec::new();
    for (j, list) in classes.iter().enumerate() {
        for class in list {
            let index = problem.local[j].index;
            here.insert(of(j, class), (j, class));
            if class.sharers[0] as usize == index {
                owned.push((j, class));
            }
        }
    }
    // Equal subdomains that meet in the same way have the same functionals.
    let mut known: HashMap<Vec<u64>, usize> = HashMap::new();
    let mut kinds: Vec<(usize, &DualClass)> = Vec::new();
    let kind_of: Vec<usize> = owned
        .iter()
        .map(|&(j, class)| {
            let next = kinds.len();
            let sharers = class.sharers.iter();
            let present: Option<Vec<_>> = sharers
                .map(|&s| here.get(&ClassSharer::new(class, s)).copied())
                .collect();
            let kind = present.map_or(next, |present| {
                let key = signature(problem, jump, locals, &present);
                *known.entry(key).or_insert(next)
            });
            if kind == next {
                kinds.push((j, class));
            }
            kind
        })
        .collect();
    let of_kind = team.map(kinds.len(), |i| {
        let (j, class) = kinds[i];
        let own = |&s: &u32| {
            let key = ClassSharer::new(class, s);
            match here.get(&key) {
                Some((j, class)) => part(*j, class),
                None => received[&key].clone(),
            }
        };
        let parts: Vec<PencilTerm> = class.sharers.iter().map(own).collect();
        pencil::functionals(&parts, &classes::averages(jump, &locals[j], j, class), tau)
    });
    let found: Vec<&Vec<Vec<f64>>> = kind_of.iter().map(|&k| &of_kind[k]).collect();

    // The functionals, one after the other, go to every sharer.
    let mut per_body = vec![0.0; problem.n_bodies];
    let mut outgoing = Parcels::for_each_rank(comm);
    for ((j, class), list) in owned.iter().zip(found) {
        per_body[problem.local[*j].body] += list.len() as f64;
        for &to in class.sharers.iter().filter(|_| !list.is_empty()) {
            let values = list.iter().flatten().copied();
            outgoing[rank_of(to)].push(ClassSharer::new(class, to), values);
        }
    }
    let answers = exchange_by_rank(comm, outgoing);
    let mut added: Vec<(usize, Average)> = Vec::new();
    for (to, values) in answers.iter().flat_map(Parcels::iter) {
        let (j, class) = here[&to];
        let interface = &locals[j].gamma().interface;
        let functionals = values.chunks_exact(class.dofs.len()).zip(&class.dofs);
        added.extend(functionals.map(|(values, &key)| {
            let average = Average {
                kind: AverageKind::Adaptive,
                key,
                dofs: class.at.iter().map(|&i| interface[i]).collect(),
                weights: Some(values.to_vec()),
            };
            (j, average)
        }));
    }
    drop(here);
    for (j, average) in added {
        jump.averages[j].push(average);
    }
    sum_all(comm, &mut per_body);
    per_body.iter().map(|&n| n as usize).collect()
}

/// All data that the functionals of a class depend on, as numbers. These are, for each sharer (given with its class):
/// its matrix (equal matrices are one object), the positions of the class in it, the entries of B_D there, and the
/// names that say which primal dofs the sharers have in common.
fn signature(
    problem: &Problem,
    jump: &Jump,
    locals: &[ScaledSubdomain],
    sharers: &[(usize, &DualClass)],
) -> Vec<u64> {
    fn number<K: std::hash::Hash + Eq>(seen: &mut HashMap<K, u64>, key: K) -> u64 {
        let next = seen.len() as u64;
        *seen.entry(key).or_insert(next)
    }
    let mut primal = HashMap::new();
    let mut rows = HashMap::new();
    let mut out = Vec::new();
    for &(j, class) in sharers {
        out.extend([
            locals[j].name(),
            locals[j].factor.to_bits(),
            class.at.len() as u64,
        ]);
        out.extend(class.at.iter().map(|&i| i as u64));
        let columns = jump.columns.of(j);
        out.push(class.entries.len() as u64);
        for &k in &class.entries {
            let k = k as usize;
            let row = number(&mut rows, columns.row[k]);
            out.extend([row, u64::from(columns.at[k]), columns.bd[k].to_bits()]);
        }
        let names = names(&problem.local[j], jump, &locals[j], j);
        out.extend(names.into_iter().map(|name| number(&mut primal, name)));
    }
    out
}

/// Names of the primal dofs of local subdomain `j`. Subdomains that share a primal dof have the same name for it.
fn names(sub: &Subdomain, jump: &Jump, local: &ScaledSubdomain, j: usize) -> Vec<[u64; 2]> {
    let vertices = local.gamma().interface[local.gamma().n_delta..].iter();
    let vertices = vertices.map(|&i| [0, sub.dofs[i as usize]]);
    let averages = jump.averages[j]
        .iter()
        .map(|a| [a.kind.number().into(), a.key]);
    let fixing = local.gamma().fixing.iter();
    let fixing = fixing.map(|&i| [(2 + sub.index as u64) << 32, i as u64]);
    vertices.chain(averages).chain(fixing).collect()
}

/// The contribution of local subdomain `j` to the eigenproblem of a class.
fn pencil_term(
    problem: &Problem,
    jump: &Jump,
    local: &ScaledSubdomain,
    j: usize,
    class: &DualClass,
) -> PencilTerm {
    let sub = &problem.local[j];
    let (n, at) = (class.at.len(), &class.at);
    let q = lifted(jump, j, class);
    let s = local.s_on(at);
    let mut sq = Dense::zeros(n, q.cols);
    multiply(sq.view_mut(), false, 1.0, s.view(), q.view());
    let mut a = Dense::zeros(q.cols, q.cols);
    multiply(a.view_mut(), false, 1.0, q.view().transpose(), sq.view());
    let mut psi = Dense::zeros(n, local.gamma().n_pi());
    for p in 0..psi.cols {
        for (k, &i) in at.iter().enumerate() {
            psi.set(k, p, local.psi().get(i, p));
        }
    }
    PencilTerm {
        a,
        t: local.t_on(at),
        psi,
        sigma: local.sigma(),
        stiff: local.primal_stiffness(),
        names: names(sub, jump, local, j),
    }
}

/// Q_c: the matrix of B_Dᵀ B from the differences to the last sharer to the copy in local subdomain `j`. It is read
/// from the entries of B_D.
fn lifted(jump: &Jump, j: usize, class: &DualClass) -> Dense {
    let (n, q) = (class.at.len(), class.sharers.len());
    let columns = jump.columns.of(j);
    let place: HashMap<u32, usize> = class.at.iter().map(|&i| i as u32).zip(0..).collect();
    let entries = class.entries.iter().map(|&k| {
        let k = k as usize;
        (columns.row[k], place[&columns.at[k]], columns.bd[k])
    });
    // The first entry of a row is the one on the row's own dof. The rows of a dof are numbered pair after pair.
    let mut rows: Vec<Vec<u32>> = vec![Vec::new(); n];
    let mut known: HashMap<u32, usize> = HashMap::new();
    for (row, x, _) in entries.clone() {
        known.entry(row).or_insert_with(|| {
            rows[x].push(row);
            x
        });
    }
    rows.iter_mut().for_each(|r| r.sort_unstable());
    let pairs: Vec<(usize, usize)> = (0..q)
        .flat_map(|a| (a + 1..q).map(move |b| (a, b)))
        .collect();
    let mut out = Dense::zeros(n, (q - 1) * n);
    for (row, y, bd) in entries {
        let x = known[&row];
        let pair = rows[x].binary_search(&row).expect("a row of the dof");
        let (a, b) = pairs[pair];
        let mut add = |k: usize, value: f64| {
            if k < q - 1 {
                let sum = out.get(y, k * n + x) + value;
                out.set(y, k * n + x, sum);
            }
        };
        add(a, bd);
        add(b, -bd);
    }
    out
}

/// A class and one of its sharers.
#[repr(C)]
#[derive(Clone, Copy, PartialEq, Eq, Hash, Pod, Zeroable)]
struct ClassSharer {
    class: u64,
    subdomain: u64,
}

impl ClassSharer {
    fn new(class: &DualClass, subdomain: u32) -> ClassSharer {
        ClassSharer {
            class: class.name(),
            subdomain: subdomain.into(),
        }
    }
}

/// The orders N, n and n_Π of the matrices of a part.
fn orders(part: &PencilTerm) -> [usize; 3] {
    [&part.a, &part.t, &part.sigma].map(|m| m.rows)
}

/// The part with these orders, [`numbers`] and names.
fn part_of([jumps, n, n_pi]: [usize; 3], mut numbers: &[f64], names: &[[u64; 2]]) -> PencilTerm {
    let mut matrix = |rows: usize, cols: usize| {
        let (data, rest) = numbers.split_at(rows * cols);
        numbers = rest;
        let data = data.to_vec();
        Dense { rows, cols, data }
    };
    PencilTerm {
        a: matrix(jumps, jumps),
        t: matrix(n, n),
        psi: matrix(n, n_pi),
        sigma: matrix(n_pi, n_pi),
        stiff: numbers.to_vec(),
        names: names.to_vec(),
    }
}

/// The entries of the matrices of a part, and its stiffnesses.
fn numbers(part: &PencilTerm) -> impl Iterator<Item = f64> + '_ {
    let matrices = [&part.a, &part.t, &part.psi, &part.sigma];
    let entries = matrices.into_iter().flat_map(|m| &m.data);
    entries.chain(&part.stiff).copied()
}

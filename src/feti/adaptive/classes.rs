//! Classes: the dual dofs that the same subdomains of a body share, and whether coefficients vary along them.
//!
//! In the plane a class is an edge. In space it is an edge, or a face together with the edges in which it meets the
//! surface of its body. A class contains all components of the field.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::sync::Arc;

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use crate::feti::interface::entities::Average;
use crate::feti::interface::sharing::DofSharing;
use crate::feti::jump::operator::Jump;
use crate::feti::subdomain::scaled::ScaledSubdomain;
use crate::substructures::{Problem, Subdomain};
use parallel::exchange::{any, exchange};

/// Stiffnesses along a class and beside it may differ by this factor. Smaller differences come from the mesh, or from
/// jumps that the weights alone deal with.
const SMOOTH: f64 = 1e2;

/// Where ρ varies by no more than this, differences in the diagonal of K come from the mesh, however large: a corner of
/// a single tetrahedron beside a node inside has a hundredth of its stiffness.
const EQUAL: f64 = 2.0;

/// Dual dofs of one subdomain that the same subdomains share, in the order of body dof.
pub struct DualClass {
    /// The subdomains, increasing.
    pub sharers: Vec<u32>,
    /// The body dofs; the lowest one names the class.
    pub dofs: Vec<u64>,
    /// Positions in Γ.
    pub at: Vec<usize>,
    /// Places of the entries of the class's rows in the subdomain's list of entries of B_D.
    pub entries: Vec<u32>,
}

impl DualClass {
    /// Unique over all bodies.
    pub fn name(&self) -> u64 {
        self.dofs[0]
    }
}

/// The classes of a subdomain, of the dofs at the positions of Γ that `chosen` selects.
pub fn of(
    sub: &Subdomain,
    sharing: &DofSharing,
    local: &ScaledSubdomain,
    chosen: impl Fn(usize) -> bool,
) -> Vec<DualClass> {
    let mut found: BTreeMap<Vec<u32>, Vec<(u64, usize)>> = BTreeMap::new();
    for (i, &dof) in local.gamma().interface[..local.gamma().n_delta]
        .iter()
        .enumerate()
    {
        let dof = sub.dofs[dof as usize];
        let copies = sharing.shared(dof);
        if copies.len() > 1 && chosen(i) {
            let sharers = copies.iter().map(|c| c.subdomain).collect();
            found.entry(sharers).or_default().push((dof, i));
        }
    }
    let class = |(sharers, mut members): (Vec<u32>, Vec<(u64, usize)>)| {
        members.sort_unstable();
        let (dofs, at) = members.into_iter().unzip();
        DualClass {
            sharers,
            dofs,
            at,
            entries: Vec::new(),
        }
    };
    found.into_iter().map(class).collect()
}

/// For each class of each local subdomain, whether coefficients vary in one of its sharers. Collective.
pub fn rough(
    comm: &SimpleCommunicator,
    problem: &Problem,
    sharing: &DofSharing,
    locals: &[ScaledSubdomain],
    classes: &[Vec<DualClass>],
) -> Vec<Vec<bool>> {
    let mut outgoing: Vec<Vec<u64>> = vec![Vec::new(); comm.size() as usize];
    for (j, list) in classes.iter().enumerate() {
        let stiff = stiffness(&problem.local[j]);
        for class in list {
            let dofs = class.at.iter().map(|&i| locals[j].gamma().interface[i]);
            if varies(&problem.local[j], &stiff, dofs) {
                for &to in &class.sharers {
                    outgoing[sharing.locations.rank(to)].push(class.name());
                }
            }
        }
    }
    let mut names = exchange(comm, outgoing);
    names.sort_unstable();
    let of = |class: &DualClass| names.binary_search(&class.name()).is_ok();
    classes
        .iter()
        .map(|list| list.iter().map(of).collect())
        .collect()
}

/// Whether stiffness varies along the interface of any subdomain. Equal subdomains are examined once. Collective.
pub fn anywhere(comm: &SimpleCommunicator, problem: &Problem, locals: &[ScaledSubdomain]) -> bool {
    let mut seen = HashSet::new();
    let mut locals = locals.iter().zip(&problem.local);
    let found = locals.any(|(local, sub)| {
        let shared = local.gamma().interface[..local.gamma().n_delta]
            .iter()
            .copied();
        seen.insert(Arc::as_ptr(local.kind())) && varies(sub, &stiffness(sub), shared)
    });
    any(comm, found)
}

/// The diagonal of K for each entry of its row. A corner of one tetrahedron has a hundredth of the diagonal of a node
/// inside, whatever the coefficients are; it also has a quarter of the neighbours.
fn stiffness(sub: &Subdomain) -> Vec<f64> {
    let of = |i| sub.k.get(i, i) / sub.k.row(i).0.len().max(1) as f64;
    (0..sub.k.n()).map(of).collect()
}

/// Whether stiffness and ρ vary along these dofs of a subdomain or next to them.
fn varies(sub: &Subdomain, stiff: &[f64], dofs: impl Iterator<Item = u32>) -> bool {
    let mut stiffness = (f64::INFINITY, 0.0f64);
    let mut rho = stiffness;
    let widen = |(low, high): &mut (f64, f64), v: f64| (*low, *high) = (low.min(v), high.max(v));
    for i in dofs {
        for &k in sub.k.row(i as usize).0 {
            widen(&mut stiffness, stiff[k as usize]);
            widen(&mut rho, sub.rho[k as usize]);
        }
    }
    stiffness.1 > SMOOTH * stiffness.0 && rho.1 > EQUAL * rho.0
}

/// The averages on a class of local subdomain `j` that are primal already, as functionals of its dofs.
pub fn averages(
    jump: &Jump,
    local: &ScaledSubdomain,
    j: usize,
    class: &DualClass,
) -> Vec<Vec<f64>> {
    let interface = &local.gamma().interface;
    let dofs = class.at.iter().map(|&i| interface[i]);
    let place: HashMap<u32, usize> = dofs.zip(0..).collect();
    let inside = jump.averages[j]
        .iter()
        .filter(|a| place.contains_key(&a.dofs[0]));
    let functional = |average: &Average| {
        let mut c = vec![0.0; class.at.len()];
        for (k, dof) in average.dofs.iter().enumerate() {
            c[place[dof]] = average.weights.as_ref().map_or(1.0, |w| w[k]);
        }
        c
    };
    inside.map(functional).collect()
}

/// Notes the entries of B_D in the rows of every class.
pub fn collect_entries(jump: &Jump, j: usize, n_gamma: usize, classes: &mut [DualClass]) {
    let mut of = vec![None; n_gamma];
    for (c, class) in classes.iter().enumerate() {
        class.at.iter().for_each(|&i| of[i] = Some(c));
    }
    let columns = jump.columns.of(j);
    for (k, (&row, &at)) in columns.row.iter().zip(columns.at).enumerate() {
        if let Some(c) = of[at as usize].filter(|_| !jump.ghost_is_contact[row as usize]) {
            classes[c].entries.push(k as u32);
        }
    }
}

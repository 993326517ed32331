//! Motions that have no energy, and that no row sees.
//!
//! A mesh of cells with few points of integration may have motions without energy that are not rigid. Where a row sees
//! one of them, it belongs to the kernel of its body, as rigid motions do. Where none does, nothing can ever hold it:
//! whoever makes the matrices adds a spring at one degree of freedom of each such motion, so that K is regular. The
//! spring bears no force if the load does no work on the motion, and displacements are what they are without it, up to
//! the motion itself. The load is therefore asked before each solve, and afterwards the displacement along the motion
//! is taken away.

use std::collections::BTreeMap;
use std::sync::Arc;

use mpi::topology::SimpleCommunicator;

use super::Subdomain;
use base::{Error, Result};
use bytemuck::{Pod, Zeroable};
use parallel::exchange::gather_all;

/// The part of a subdomain in a motion of its body that has no energy and that no row sees.
///
/// The motions of a body are orthonormal over its degrees of freedom.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Idle {
    /// The number of the motion in its body.
    pub number: u32,
    /// Local dofs, increasing; all components of the nodes that move.
    pub dofs: Vec<u32>,
    /// The motion there.
    pub values: Vec<f64>,
    /// One over the number of subdomains that have the dof.
    pub shares: Vec<f64>,
    /// How far it is from having no energy: the largest strain of a cell of size one.
    pub strain: f64,
    /// The message where a load drives the motion: a sentence.
    pub what: Arc<str>,
}

impl Idle {
    /// Motion `number` of its body with this `strain`, and the message where a load drives it; so far without dofs.
    pub fn new(number: u32, strain: f64, what: Arc<str>) -> Idle {
        Idle {
            number,
            dofs: Vec::new(),
            values: Vec::new(),
            shares: Vec::new(),
            strain,
            what,
        }
    }
}

/// The load does work on a motion only if that is more than this part of what it could be, |fᵀv| beside ‖f‖ ‖v‖.
const WORK: f64 = 1e-6;

/// The load does work on a motion only if that, relative to ‖f‖ ‖v‖, is more than this many times the strain of the
/// motion, too: coordinates with few digits turn the load.
const TURNED: f64 = 100.0;

/// Returns an error if the load does work on an idle motion: nothing stands against it. Collective.
///
/// # Errors
/// [`ErrorKind::Input`](base::ErrorKind::Input) with the motion, the same on all ranks.
pub(crate) fn check(comm: &SimpleCommunicator, local: &[Subdomain]) -> Result<()> {
    let sums = sums(comm, local, |s, idle| {
        let loads = idle.dofs.iter().map(|&i| s.f[i as usize]);
        let work: f64 = loads.clone().zip(&idle.values).map(|(f, v)| f * v).sum();
        [work, loads.map(|f| f * f).sum()]
    });
    let strains = each(local).map(|(key, _, idle)| OfMotion {
        key,
        values: [idle.strain, 0.0],
    });
    let strains = gather_all(comm, &strains.collect::<Vec<_>>()).concat();
    let strains: BTreeMap<u64, f64> = strains.iter().map(|s| (s.key, s.values[0])).collect();
    let most = |key: &u64| WORK.max(TURNED * strains[key]).min(0.1);
    let driven = sums
        .iter()
        .find(|(key, [work, square])| work.abs() > most(key) * square.sqrt());
    let Some((&key, _)) = driven else {
        return Ok(());
    };
    // Any rank that has the motion can say what it is; all of those say the same.
    let what = each(local)
        .find(|(k, _, _)| *k == key)
        .map(|(_, _, idle)| idle.what.clone());
    let what: Vec<u32> = what
        .iter()
        .flat_map(|text| text.chars().map(u32::from))
        .collect();
    let all = gather_all(comm, &what).into_iter();
    let text = all
        .into_iter()
        .find(|text| !text.is_empty())
        .unwrap_or_default();
    let text: String = text.into_iter().filter_map(char::from_u32).collect();
    Err(Error::input(text))
}

/// Takes the displacement along idle motions away. Collective.
pub fn remove_idle(comm: &SimpleCommunicator, local: &[Subdomain], u: &mut [Vec<f64>]) {
    let place: BTreeMap<usize, usize> = local
        .iter()
        .enumerate()
        .map(|(j, s)| (s.index, j))
        .collect();
    let along = sums(comm, local, |s, idle| {
        let u = &u[place[&s.index]];
        let each = idle.dofs.iter().zip(&idle.values).zip(&idle.shares);
        [
            each.map(|((&i, v), share)| share * v * u[i as usize]).sum(),
            0.0,
        ]
    });
    for (key, s, idle) in each(local) {
        let (u, along) = (&mut u[place[&s.index]], along[&key][0]);
        for (&i, v) in idle.dofs.iter().zip(&idle.values) {
            u[i as usize] -= along * v;
        }
    }
}

/// Numbers about a part of a motion, by its body and number.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct OfMotion {
    key: u64,
    values: [f64; 2],
}

/// All parts of this rank, by body and number.
fn each(local: &[Subdomain]) -> impl Iterator<Item = (u64, &Subdomain, &Idle)> {
    local.iter().flat_map(|s| {
        let key = move |idle: &Idle| (s.body as u64) << 32 | u64::from(idle.number);
        s.idle.iter().map(move |idle| (key(idle), s, idle))
    })
}

/// Sums over all parts of each motion, by body and number, the same on all ranks. Collective.
fn sums(
    comm: &SimpleCommunicator,
    local: &[Subdomain],
    of: impl Fn(&Subdomain, &Idle) -> [f64; 2],
) -> BTreeMap<u64, [f64; 2]> {
    let mine = each(local).map(|(key, s, idle)| OfMotion {
        key,
        values: of(s, idle),
    });
    let mut sums: BTreeMap<u64, [f64; 2]> = BTreeMap::new();
    for part in gather_all(comm, &mine.collect::<Vec<_>>()).concat() {
        let sum = sums.entry(part.key).or_default();
        (0..2).for_each(|k| sum[k] += part.values[k]);
    }
    sums
}

//! The motions without energy of every subdomain: what the host gave, held against the kernels of the matrices.
//!
//! Three cases, the same on all ranks:
//!
//! - The host's vectors (without any: the constants of each component) span the kernel of every subdomain matrix. They
//!   are used.
//! - Some subdomains have motions beyond them: cells that hang by an edge or a node (a *mechanism*). These subdomains
//!   are marked, become bodies of their own, and the method finds their kernels from the matrices.
//! - There are no vectors, and constants do not do; or the vectors are those of another problem (rotations across the
//!   seam of a periodic body). The kernels of the matrices take their place everywhere.

use std::collections::HashMap;

use super::kernels::{orthogonal, KernelVectors};
use super::nullspace::{annihilates, kernel, Indefinite};
use super::parts::TornSubdomain;
use super::sharing::Sharers;
use super::torn::Torn;
use crate::feti::subdomain::equal::{hash_matrix, multiple_of};
use crate::{Error, Result};
use parallel::exchange::{any, exchange_by_rank};
use parallel::parcels::Parcels;
use petsc::Session;
use rustc_hash::{FxHashMap, FxHasher};
use std::hash::Hasher;

/// A row annihilates a vector of the host if its terms cancel to less than this fraction: vectors have errors of their
/// own, such as those of coordinates in single precision.
pub const CANCELS: f64 = 1e-9;

/// A motion of the kernel is one of the known ones if this fraction of it at most is left of it beside them.
const OUTSIDE: f64 = 1e-6;

/// Values below this at the dofs that two subdomains share count as zero; motions have entries of order one.
const NOTHING: f64 = 1e-8;

/// The motions without energy of the subdomains.
pub struct NearKernels {
    /// An orthogonal basis in every part, entries of order one.
    bases: Vec<KernelVectors>,
    /// For every part a basis of the kernel of its matrix, entries of order one.
    free: Vec<KernelVectors>,
    /// Components of the field.
    pub components: usize,
    /// For every subdomain of this rank and their neighbours, the number of motions, and whether there are others
    /// beyond the bases.
    around: HashMap<u32, (usize, bool)>,
    /// Where the bases differ between subdomains: for every part, by higher neighbour, the motions of either side at
    /// the shared dofs. [shared dof][motion], orthogonal.
    pairs: Option<Vec<HashMap<u32, KernelVectors>>>,
}

impl NearKernels {
    /// Compares the host's vectors `modes`, if there are any, with the kernels of the matrices. Returns the motions,
    /// and the vectors if they may be used. Collective.
    ///
    /// # Errors
    /// A matrix that is not positive semidefinite.
    pub fn new(
        session: &Session,
        torn: &Torn,
        parts: &[TornSubdomain],
        sharers: &Sharers,
        modes: Option<Vec<KernelVectors>>,
    ) -> Result<(NearKernels, Option<Vec<KernelVectors>>)> {
        let constants = |part: &TornSubdomain| -> KernelVectors {
            let one = |c: usize| {
                let value = |&dof: &u32| f64::from(u8::from(torn.component(dof) == c));
                part.dofs.iter().map(value).collect()
            };
            (0..torn.block_size).map(one).collect()
        };
        let known: Vec<KernelVectors> = match &modes {
            Some(columns) => columns.iter().map(orthogonal).collect(),
            None => parts.iter().map(|p| orthogonal(&constants(p))).collect(),
        };
        let found = session.agree(own_kernels(parts, &known, sharers.first))?;
        let beyond: Vec<bool> = found
            .iter()
            .zip(&known)
            .map(|(f, k)| !spans(k, f))
            .collect();
        // As many motions as the known ones, but others: the known ones are wrong.
        let wrong = |j: usize| {
            let [known, found] = [&known[j], &found[j]];
            let zero = |x: &Vec<f64>| annihilates(&parts[j].k, x, CANCELS);
            found.len() >= known.len() && !known.iter().all(zero)
        };
        let useless = match &modes {
            None => beyond.iter().any(|b| *b),
            Some(_) => (0..parts.len()).any(|j| beyond[j] && wrong(j)),
        };
        let own = any(session.comm(), useless);
        let bases = if own { found.clone() } else { known };
        let facts = bases.iter().zip(beyond);
        let facts = facts.map(|(basis, beyond)| [basis.len(), usize::from(beyond && !own)]);
        let around = sharers.around(session, &facts.collect::<Vec<_>>());
        let of = |(s, [n, beyond]): (u32, [usize; 2])| (s, (n, beyond != 0));
        let pairs = own.then(|| pairs(session, sharers, &bases));
        let motions = NearKernels {
            bases,
            free: found,
            components: torn.block_size,
            around: around.into_iter().map(of).collect(),
            pairs,
        };
        Ok((motions, modes.filter(|_| !own)))
    }

    /// The motions of every part.
    pub fn bases(&self) -> &[KernelVectors] {
        &self.bases
    }

    /// The kernel of the matrix of part `j`, where such kernels take the place of the host's vectors.
    pub fn own_kernel(&self, j: usize) -> KernelVectors {
        match self.pairs {
            Some(_) => self.bases[j].clone(),
            None => KernelVectors::new(),
        }
    }

    /// The kernel of the matrix of part `j`.
    pub fn free(&self, j: usize) -> &KernelVectors {
        &self.free[j]
    }

    /// The motions of part `j` and its neighbour `high` at the dofs `dofs` that they share: a row for each dof.
    pub fn between(&self, j: usize, high: u32, dofs: &[u32]) -> KernelVectors {
        match &self.pairs {
            Some(pairs) => pairs[j][&high].clone(),
            None => {
                let row = |&i: &u32| self.bases[j].iter().map(|x| x[i as usize]).collect();
                dofs.iter().map(row).collect()
            }
        }
    }

    /// Whether a subdomain of this rank, or a neighbour, has motions beyond the bases.
    pub fn is_loose(&self, subdomain: usize) -> bool {
        self.around[&(subdomain as u32)].1
    }

    /// Whether the bases are the kernels of the matrices.
    pub fn are_kernels(&self) -> bool {
        self.pairs.is_some()
    }

    /// Number of motions of a subdomain of this rank, or of a neighbour.
    pub fn count(&self, subdomain: usize) -> usize {
        self.around[&(subdomain as u32)].0
    }

    /// The largest number of motions of a subdomain of this rank.
    pub fn most(&self) -> usize {
        self.bases.iter().map(Vec::len).max().unwrap_or(0)
    }

    /// How many motions the dofs that subdomains `low` and `high` share must see, so that neither moves without the
    /// other.
    pub fn needed(&self, low: usize, high: usize) -> usize {
        let [a, b] = [low, high].map(|s| self.count(s));
        // A basis of known motions may be smaller where a part has few dofs. Kernels of matrices are smaller where
        // something holds the part; its neighbour has to be held all the same.
        if self.are_kernels() {
            a.max(b)
        } else {
            a.min(b)
        }
    }
}

/// The kernels of the matrices of this rank's parts, of which `first` is the first. Matrices that are multiples of each
/// other have one kernel, for which one of them is factored.
fn own_kernels(
    parts: &[TornSubdomain],
    known: &[KernelVectors],
    first: usize,
) -> Result<Vec<KernelVectors>> {
    let mut alike: FxHashMap<u64, Vec<usize>> = FxHashMap::default();
    let mut out: Vec<KernelVectors> = Vec::with_capacity(parts.len());
    for (j, (part, known)) in parts.iter().zip(known).enumerate() {
        let mut state = FxHasher::default();
        hash_matrix(&part.k, &mut state);
        let others = alike.entry(state.finish()).or_default();
        let same = |&i: &usize| {
            let (a, b) = (&parts[i].k, &part.k);
            a.row_ptr == b.row_ptr && a.col == b.col && multiple_of(a, b).is_some()
        };
        let found = match others.iter().copied().find(same) {
            Some(i) => out[i].clone(),
            None => {
                others.push(j);
                kernel(&part.k, known).map_err(|e| indefinite(first + j, part, e))?
            }
        };
        out.push(found);
    }
    Ok(out)
}

/// Whether every column of `found` is a combination of the orthogonal columns `known`.
fn spans(known: &KernelVectors, found: &KernelVectors) -> bool {
    found.iter().all(|x| {
        let mut rest = x.clone();
        for q in known {
            let square: f64 = q.iter().map(|q| q * q).sum();
            let part = rest.iter().zip(q).map(|(x, q)| x * q).sum::<f64>() / square;
            rest.iter_mut().zip(q).for_each(|(x, q)| *x -= part * q);
        }
        norm(&rest) <= OUTSIDE * norm(x)
    })
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// For every part, by higher neighbour, an orthogonal basis of the motions of both at the dofs that they share.
/// Collective.
fn pairs(
    session: &Session,
    sharers: &Sharers,
    bases: &[KernelVectors],
) -> Vec<HashMap<u32, KernelVectors>> {
    // Both sides list the shared dofs by increasing global number. The higher one sends its motions, column by column.
    let mut outgoing = Parcels::for_each_rank(session.comm());
    for (j, basis) in bases.iter().enumerate() {
        let me = (sharers.first + j) as u32;
        for (low, dofs) in sharers.neighbours[j].iter().filter(|n| n.0 < me) {
            let on =
                |x: &'_ Vec<f64>| -> Vec<f64> { dofs.iter().map(|&i| x[i as usize]).collect() };
            let entries = basis.iter().flat_map(on);
            outgoing[sharers.owners.of(*low)].push([*low, me, dofs.len() as u32], entries);
        }
    }
    let mut theirs: HashMap<(u32, u32), KernelVectors> = HashMap::new();
    let received = exchange_by_rank(session.comm(), outgoing);
    for ([low, high, n], entries) in received.iter().flat_map(Parcels::iter) {
        let columns = entries.chunks_exact(n.max(1) as usize);
        theirs.insert((low, high), columns.map(<[f64]>::to_vec).collect());
    }
    let of_part = |(j, basis): (usize, &KernelVectors)| {
        let me = (sharers.first + j) as u32;
        let above = sharers.neighbours[j].iter().filter(|n| n.0 > me);
        above
            .map(|(high, dofs)| {
                let mut both = theirs.remove(&(me, *high)).unwrap_or_default();
                let mine = |x: &Vec<f64>| dofs.iter().map(|&i| x[i as usize]).collect();
                both.extend(basis.iter().map(mine));
                both.retain(|x| norm(x) > NOTHING * (x.len() as f64).sqrt());
                let both = orthogonal(&both);
                let row = |p: usize| both.iter().map(|x| x[p]).collect();
                (*high, (0..dofs.len()).map(row).collect())
            })
            .collect()
    };
    bases.iter().enumerate().map(of_part).collect()
}

/// The error for a subdomain matrix with a negative eigenvalue.
fn indefinite(subdomain: usize, part: &TornSubdomain, e: Indefinite) -> Error {
    let energy = e
        .energy
        .map_or(String::new(), |e| format!(" ({e:.2e} of its terms)"));
    Error::unfit(format!(
        "the operator is indefinite: the matrix of subdomain {subdomain} has a motion of negative energy{energy} \
         that moves global dof {} most, expected a stiffness matrix (a Helmholtz shift or a wrong sign makes it \
         indefinite); take the shift out, or a KSP and PC for indefinite operators, such as -ksp_type gmres with \
         a direct or overlapping Schwarz preconditioner",
        part.dofs[e.dof as usize]
    ))
}

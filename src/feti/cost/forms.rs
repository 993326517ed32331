//! Dense matrices or sparse solves for each kind of subdomain: the form with the shorter time to the solution is taken,
//! within the available memory.
//!
//! ```text
//!     explicit   f (flops of [I, Γ] → S and of S → T)  +  applications · copies · (n_Γ² + n_Δ²) · d
//!     implicit   f (flops of K_rr and K_II)  +  n_Π l_rr e (copies)  +  applications · copies · 2 (l_rr + l_II) · e
//! ```
//!
//! n follows from the interface. Flops and the entries l of the factors follow from the symbolic factorisation and are
//! exact. The seconds f, d, e per operation are measured (`fetifeti study kernels` measures them again). They are the
//! same on every machine, so that runs can be repeated.

use std::sync::Arc;

use crate::feti::interface::entities::Average;
use crate::feti::jump::operator::Jump;
use crate::feti::settings::Operators;
use crate::feti::subdomain::equal::Likeness;
use crate::feti::subdomain::implicit;
use crate::feti::subdomain::which::OperatorForm;
use crate::substructures::{Problem, Subdomain};
use cholesky::interior::{Analysed, Analysis, SparseAnalysis};
use cholesky::symbolic::Keep;
use cholesky::symbolic::Symbolic;
use parallel::team::Team;

/// Seconds per multiplication and addition in dense fronts.
pub(crate) const FLOP: f64 = 8e-11;

/// Seconds per entry of a dense operator and application. The first is for a single vector (half of the entries are
/// read), the second for many copies in a matrix-matrix product.
pub(crate) const DENSE: f64 = 2e-10;
pub(crate) const DENSE_SHARED: f64 = 6e-11;

/// Seconds per entry of a sparse factor and pass over it: for one vector, and for each of several.
const SPARSE: f64 = 4e-10;
const SPARSE_SHARED: f64 = 2e-10;

/// Number of copies on a rank from which on products with S and T are matrix-matrix products. With fewer copies,
/// reading S and T takes longer than multiplying, and only their lower triangles are stored.
pub(crate) const MANY: usize = 8;

/// Dense operators are chosen without an analysis if they take less than this to compute.
const SHORT: f64 = 5e-3;

/// Computing S and T takes about this many times n_Γ³ operations if the interface is not large beside the interior.
const SMALL: f64 = 3.0;

/// Expected number of applications of F and M⁻¹ per set-up: for tied problems, and for loops over active sets.
pub const APPLICATIONS: [f64; 2] = [25.0, 60.0];

/// The cost of a kind of subdomain.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Cost {
    /// Seconds with dense operators: for computing them, and for one application to all copies.
    pub explicit: [f64; 2],
    /// Seconds with sparse solves: for the same two.
    pub implicit: [f64; 2],
    /// Bytes of S and T.
    pub dense_bytes: f64,
}

/// The cost of a kind and the analyses that it was counted with: of [I, Γ], and of K_rr and K_II.
struct CountedKind {
    cost: Cost,
    dense: Symbolic,
    sparse: SparseAnalysis,
}

impl CountedKind {
    /// The analysis that the factorisation in this form needs.
    fn analysed(self, form: OperatorForm) -> Arc<Analysed> {
        let analysed = Analysed::default();
        let is_new = match form {
            OperatorForm::Explicit => analysed
                .dense
                .set(Arc::new(Analysis::new(self.dense)))
                .is_ok(),
            OperatorForm::Implicit => analysed.sparse.set(self.sparse).is_ok(),
        };
        debug_assert!(is_new);
        Arc::new(analysed)
    }
}

impl Cost {
    fn total([make, apply]: [f64; 2], applications: f64) -> f64 {
        make + applications * apply
    }

    /// Seconds that dense operators save over sparse solves.
    fn gain(&self, applications: f64) -> f64 {
        Cost::total(self.implicit, applications) - Cost::total(self.explicit, applications)
    }
}

/// Data about a kind of subdomain before its factorisation.
pub struct SubdomainKind<'a> {
    /// Index of the local subdomain that represents it.
    pub j: usize,
    /// The representative.
    pub sub: &'a Subdomain,
    /// Dual dofs of the interface.
    pub delta: &'a [u32],
    /// Primal dofs.
    pub primal: &'a [u32],
    /// The averages.
    pub averages: &'a [Average],
    /// Number of subdomains of this kind on this rank.
    pub copies: usize,
}

impl SubdomainKind<'_> {
    /// Entries of the sparse factors in the given form.
    pub fn factor_entries(&self, form: OperatorForm) -> usize {
        let (k, x) = (&self.sub.k, self.sub.coordinates.as_deref());
        match form {
            OperatorForm::Explicit => {
                Symbolic::new(k, &[self.delta, self.primal].concat(), x).factor_entries(self.keep())
            }
            OperatorForm::Implicit => self.sparse().entries(),
        }
    }

    /// The part of the factor that is kept beside dense operators. With a few copies, the rows that save each of them
    /// half a solve do not pay.
    pub fn keep(&self) -> Keep {
        if self.copies < MANY {
            Keep::Interior
        } else {
            Keep::Boundary
        }
    }

    /// The analyses behind sparse solves.
    fn sparse(&self) -> SparseAnalysis {
        let dofs = self.averages.iter().map(|a| a.dofs.clone()).collect();
        let x = self.sub.coordinates.as_deref();
        implicit::analysis(&self.sub.k, self.delta, self.primal, dofs, x)
    }
}

/// One of each kind of subdomain. `first` has the representative of every local subdomain.
pub fn kinds<'a>(
    problem: &'a Problem,
    jump: &'a Jump,
    first: &[Likeness],
) -> Vec<SubdomainKind<'a>> {
    let own = (0..first.len()).filter(|&j| first[j].first == j);
    let of = |j: usize| SubdomainKind {
        j,
        sub: &problem.local[j],
        delta: &jump.delta[j],
        primal: &jump.primal[j],
        averages: &jump.averages[j],
        copies: first.iter().filter(|f| f.first == j).count(),
    };
    own.map(of).collect()
}

/// The form of each kind: the one asked for, or the cheaper one with `applications`. Dense operators take at most
/// `memory` bytes where sparse solves are possible. They are preferred if S itself is needed (`wants_s`). Kinds with a
/// form `so_far` keep it if memory suffices: nothing is counted for them. What was counted with an analysis leaves that
/// of its form.
pub fn choose(
    kinds: &[SubdomainKind],
    so_far: &[Option<OperatorForm>],
    team: &Team,
    asked: Operators,
    applications: f64,
    memory: f64,
    wants_s: bool,
) -> (Vec<OperatorForm>, Vec<Option<Arc<Analysed>>>) {
    let all = |form| (vec![form; kinds.len()], vec![None; kinds.len()]);
    match asked {
        Operators::Explicit => return all(OperatorForm::Explicit),
        Operators::Implicit => return all(OperatorForm::Implicit),
        Operators::Auto => {}
    }
    let bytes: f64 = kinds.iter().map(dense_bytes).sum();
    if wants_s && bytes <= memory {
        return all(OperatorForm::Explicit);
    }
    let dense = |k: &usize| so_far[*k] != Some(OperatorForm::Implicit);
    let least: f64 = (0..kinds.len())
        .filter(dense)
        .map(|k| dense_bytes(&kinds[k]))
        .sum();
    let keep = least <= memory;
    let counted = team.map(kinds.len(), |k| match so_far[k] {
        Some(_) if keep => None,
        _ => count(&kinds[k], least > memory),
    });
    let costs: Vec<Option<Cost>> = counted.iter().map(|c| c.as_ref().map(|c| c.cost)).collect();
    let form = |(k, c): (usize, &Option<Cost>)| match (so_far[k], c) {
        (Some(form), _) if keep => form,
        (_, Some(c)) if c.gain(applications) < 0.0 && !wants_s => OperatorForm::Implicit,
        _ => OperatorForm::Explicit,
    };
    let mut forms: Vec<OperatorForm> = costs.iter().enumerate().map(form).collect();
    let mut used: f64 = 0.0;
    let mut dense: Vec<usize> = (0..kinds.len())
        .filter(|&k| forms[k] == OperatorForm::Explicit)
        .collect();
    dense.iter().for_each(|&k| used += dense_bytes(&kinds[k]));
    // The kinds that save the least time for their memory become sparse first.
    let worth =
        |k: &usize| costs[*k].map_or(f64::INFINITY, |c| c.gain(applications) / c.dense_bytes);
    dense.sort_by(|a, b| worth(a).total_cmp(&worth(b)).then(a.cmp(b)));
    for k in dense {
        if used <= memory {
            break;
        }
        forms[k] = OperatorForm::Implicit;
        used -= dense_bytes(&kinds[k]);
    }
    let chosen = counted.into_iter().zip(&forms);
    let analysed = chosen
        .map(|(c, &form)| c.map(|c| c.analysed(form)))
        .collect();
    (forms, analysed)
}

/// Bytes of S and T.
fn dense_bytes(kind: &SubdomainKind) -> f64 {
    let n_delta = kind.delta.len() as f64;
    let n_gamma = n_delta + kind.primal.len() as f64;
    let each = if kind.copies < MANY { 4.0 } else { 8.0 };
    each * (n_gamma.powi(2) + n_delta.powi(2))
}

/// Whether S and T of a subdomain with so many interface dofs are dense matrices, because they are made at once.
pub(crate) fn is_short(n_gamma: usize) -> bool {
    FLOP * SMALL * (n_gamma as f64).powi(3) < SHORT
}

/// The cost of a kind; `None` if dense operators are computed so fast that no analysis pays, unless memory is short
/// (`always`).
fn count(kind: &SubdomainKind, always: bool) -> Option<CountedKind> {
    let (k, x) = (&kind.sub.k, kind.sub.coordinates.as_deref());
    let interface = [kind.delta, kind.primal].concat();
    let (n_gamma, n_delta) = (interface.len() as f64, kind.delta.len() as f64);
    // Three analyses to choose one do not pay for small interfaces.
    if is_short(interface.len()) && !always {
        return None;
    }
    let partial = Symbolic::new(k, &interface, x);
    // T: Cholesky factorisation and inverse of S_ΔΔ.
    let make = FLOP * (partial.flops() + n_delta.powi(3));
    if make < SHORT && !always {
        return None;
    }
    let analysis = kind.sparse();
    let of_held = analysis.held.symbolic().factor_entries(Keep::Boundary) as f64;
    let entries = analysis.entries() as f64;
    // Ψ is stored for copies.
    let stored = kind.primal.len() + kind.averages.len();
    let columns = if kind.copies > 1 { stored as f64 } else { 0.0 };
    let (dense, sparse) = match kind.copies {
        n if n < MANY => (DENSE, SPARSE),
        _ => (DENSE_SHARED, SPARSE_SHARED),
    };
    let copies = kind.copies as f64;
    let psi = columns * of_held * SPARSE_SHARED;
    let cost = Cost {
        explicit: [make, copies * dense * (n_gamma.powi(2) + n_delta.powi(2))],
        implicit: [
            FLOP * analysis.flops() + psi,
            copies * sparse * 2.0 * entries,
        ],
        dense_bytes: dense_bytes(kind),
    };
    Some(CountedKind {
        cost,
        dense: partial,
        sparse: analysis,
    })
}

/// Bytes for dense operators on each of `ranks` ranks of one machine if the user sets no limit: half of the machine's
/// memory.
pub fn usual_memory(ranks: usize) -> f64 {
    let text = std::fs::read_to_string("/proc/meminfo").unwrap_or_default();
    let line = text.lines().find_map(|l| l.strip_prefix("MemTotal:"));
    let kilobytes = line.and_then(|l| l.trim().trim_end_matches("kB").trim().parse::<f64>().ok());
    // Four gigabytes if the machine does not tell.
    0.5 * kilobytes.map_or(4e9, |k| 1024.0 * k) / ranks as f64
}

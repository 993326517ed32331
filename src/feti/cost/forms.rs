//! Dense matrices or sparse solves: for each kind of subdomain what takes less time until the solution is there, in the memory that there is.
//!
//! ```text
//!     explicit    f (flops of [I, Γ] → S and of S → T)  +  applications · copies · (n_Γ² + n_Δ²) · d
//!     implicit    f (flops of K_rr and K_II)  +  columns of Ψ · 2 l · e  +  applications · copies · 2 (l_rr + l_II) · e
//! ```
//!
//! with n from the interface, flops and entries l of the factors from the symbolic factorisation (exact), and seconds f, d, e per operation
//! as measured (`fetifeti study kernels` measures them again). They are the same everywhere, so that runs can be repeated.

use crate::cholesky::symbolic::Keep;
use crate::cholesky::symbolic::Symbolic;
use crate::feti::jump::operator::Jump;
use crate::feti::settings::Operators;
use crate::feti::subdomain::which::OperatorForm;
use crate::parallel::team::Team;
use crate::substructures::{Subdomain, Substructures};

/// Seconds per multiplication and addition in dense fronts.
pub(crate) const FLOP: f64 = 8e-11;

/// Seconds per entry of a dense operator and application: by itself (half of the entries are read), and where many copies make it a
/// matrix-matrix product.
pub(crate) const DENSE: f64 = 2e-10;
pub(crate) const DENSE_SHARED: f64 = 6e-11;

/// Seconds per entry of a sparse factor and pass over it, for one vector, and for each of several.
const SPARSE: f64 = 6e-10;
const SPARSE_SHARED: f64 = 2e-10;

/// So many copies on a rank make a product of matrices; with fewer, products with S and T take longer to read them than to multiply, and their lower
/// triangles are kept alone.
pub(crate) const MANY: usize = 8;

/// Dense operators that take less than this to make are made without asking.
const SHORT: f64 = 5e-3;

/// Making S and T takes about so many times n_Γ³ operations where the interface is not large beside the interior.
const SMALL: f64 = 3.0;

/// Applications of F and M⁻¹ that one set-up is for: tied problems, and loops over active sets.
pub const APPLICATIONS: [f64; 2] = [25.0, 60.0];

/// What a kind of subdomain costs.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Cost {
    /// Seconds with dense operators: to make them, and for one application to all copies.
    pub explicit: [f64; 2],
    /// Seconds with sparse solves.
    pub implicit: [f64; 2],
    /// Bytes of S and T.
    pub dense_bytes: f64,
}

impl Cost {
    fn total([make, apply]: [f64; 2], applications: f64) -> f64 {
        make + applications * apply
    }

    /// Seconds that dense operators save.
    fn gain(&self, applications: f64) -> f64 {
        Cost::total(self.implicit, applications) - Cost::total(self.explicit, applications)
    }
}

/// What is known about a kind of subdomain before it is factored.
pub struct Kind<'a> {
    /// Which local subdomain stands for it.
    pub j: usize,
    /// One of them.
    pub sub: &'a Subdomain,
    /// Dual and primal dofs.
    pub delta: &'a [u32],
    /// Primal dofs.
    pub primal: &'a [u32],
    /// Number of averages.
    pub averages: usize,
    /// How many there are on this rank.
    pub copies: usize,
}

impl Kind<'_> {
    /// Entries of the sparse factors in this form.
    pub fn factor_entries(&self, form: OperatorForm) -> usize {
        let (k, x) = (&self.sub.k, self.sub.coordinates.as_deref());
        match form {
            OperatorForm::Explicit => {
                Symbolic::new(k, &[self.delta, self.primal].concat(), x).factor_entries(self.keep())
            }
            OperatorForm::Implicit => sparse_entries(&self.sparse()),
        }
    }

    /// What is kept of its factor beside dense operators: a few copies alone do not pay for rows that save each of them half a solve.
    pub fn keep(&self) -> Keep {
        if self.copies < MANY {
            Keep::Interior
        } else {
            Keep::Boundary
        }
    }

    /// K_rr and K_II.
    fn sparse(&self) -> [Symbolic; 2] {
        let (k, x) = (&self.sub.k, self.sub.coordinates.as_deref());
        let mut kept = vec![false; k.n()];
        let interface = self.delta.iter().chain(self.primal);
        interface.for_each(|&i| kept[i as usize] = true);
        let inside: Vec<u32> = (0..k.n() as u32).filter(|&i| !kept[i as usize]).collect();
        let places: Option<Vec<[f64; 3]>> =
            x.map(|x| inside.iter().map(|&i| x[i as usize]).collect());
        [
            Symbolic::new(k, self.primal, x),
            Symbolic::new(&k.restricted(&inside), &[], places.as_deref()),
        ]
    }
}

/// One of each kind of subdomain; `first` has the representative of every local subdomain.
pub fn kinds<'a>(
    problem: &'a Substructures,
    jump: &'a Jump,
    first: &[(usize, f64)],
) -> Vec<Kind<'a>> {
    let own = (0..first.len()).filter(|&j| first[j].0 == j);
    let of = |j: usize| Kind {
        j,
        sub: &problem.local[j],
        delta: &jump.delta[j],
        primal: &jump.primal[j],
        averages: jump.averages[j].len(),
        copies: first.iter().filter(|f| f.0 == j).count(),
    };
    own.map(of).collect()
}

/// The form of each kind: as asked, or what costs less with `applications`, with dense operators of at most `memory` bytes where sparse
/// solves are possible. Dense ones are preferred where S itself is wanted (`wants_s`).
pub fn choose(
    kinds: &[Kind],
    team: &Team,
    asked: Operators,
    applications: f64,
    memory: f64,
    wants_s: bool,
) -> Vec<OperatorForm> {
    match asked {
        Operators::Explicit => return vec![OperatorForm::Explicit; kinds.len()],
        Operators::Implicit => return vec![OperatorForm::Implicit; kinds.len()],
        Operators::Auto => {}
    }
    let bytes: f64 = kinds.iter().map(dense_bytes).sum();
    if wants_s && bytes <= memory {
        return vec![OperatorForm::Explicit; kinds.len()];
    }
    let costs = team.map(kinds.len(), |k| cost(&kinds[k], bytes > memory));
    let form = |c: &Option<Cost>| match c {
        Some(c) if c.gain(applications) < 0.0 && !wants_s => OperatorForm::Implicit,
        _ => OperatorForm::Explicit,
    };
    let mut forms: Vec<OperatorForm> = costs.iter().map(form).collect();
    let mut used: f64 = 0.0;
    let mut dense: Vec<usize> = (0..kinds.len())
        .filter(|&k| forms[k] == OperatorForm::Explicit)
        .collect();
    dense.iter().for_each(|&k| used += dense_bytes(&kinds[k]));
    // What saves the least time for its memory goes first.
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
    forms
}

/// Entries of the factors behind sparse solves.
fn sparse_entries(factors: &[Symbolic; 2]) -> usize {
    factors
        .iter()
        .map(|f| f.factor_entries(Keep::Interior))
        .sum()
}

/// Bytes of S and T.
fn dense_bytes(kind: &Kind) -> f64 {
    let n_delta = kind.delta.len() as f64;
    let n_gamma = n_delta + kind.primal.len() as f64;
    let each = if kind.copies < MANY { 4.0 } else { 8.0 };
    each * (n_gamma.powi(2) + n_delta.powi(2))
}

/// `None` where dense operators are made so fast that nothing else is worth analysing, unless memory is short (`always`).
fn cost(kind: &Kind, always: bool) -> Option<Cost> {
    let (k, x) = (&kind.sub.k, kind.sub.coordinates.as_deref());
    let interface = [kind.delta, kind.primal].concat();
    let (n_gamma, n_delta) = (interface.len() as f64, kind.delta.len() as f64);
    // The set-up analyses again what it factors: not worth it for small interfaces.
    if FLOP * SMALL * n_gamma.powi(3) < SHORT && !always {
        return None;
    }
    let partial = Symbolic::new(k, &interface, x);
    // T: Cholesky factorisation and inverse of S_ΔΔ.
    let make = FLOP * (partial.flops() + n_delta.powi(3));
    if make < SHORT && !always {
        return None;
    }
    let [held, interior] = kind.sparse();
    let of_held = held.factor_entries(Keep::Interior) as f64;
    let (flops, entries) = (
        held.flops() + interior.flops(),
        sparse_entries(&[held, interior]) as f64,
    );
    let columns = (kind.primal.len() + 2 * kind.averages) as f64;
    let (dense, sparse) = match kind.copies {
        n if n < MANY => (DENSE, SPARSE),
        _ => (DENSE_SHARED, SPARSE_SHARED),
    };
    let copies = kind.copies as f64;
    let psi = columns * 2.0 * of_held * SPARSE_SHARED;
    Some(Cost {
        explicit: [make, copies * dense * (n_gamma.powi(2) + n_delta.powi(2))],
        implicit: [FLOP * flops + psi, copies * sparse * 2.0 * entries],
        dense_bytes: dense_bytes(kind),
    })
}

/// Bytes for dense operators on each of `ranks` ranks of one machine, where nothing is asked for: half of its memory.
pub fn usual_memory(ranks: usize) -> f64 {
    let text = std::fs::read_to_string("/proc/meminfo").unwrap_or_default();
    let line = text.lines().find_map(|l| l.strip_prefix("MemTotal:"));
    let kilobytes = line.and_then(|l| l.trim().trim_end_matches("kB").trim().parse::<f64>().ok());
    // Four gigabytes where the machine does not say.
    0.5 * kilobytes.map_or(4e9, |k| 1024.0 * k) / ranks as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::feti::interface::sharing::Sharing;
    use crate::feti::settings::Primal;
    use crate::petsc::testing::with_session;
    use crate::scene::Scene;

    /// Forms for a grid with one kind of physics; `rho` by position.
    fn forms(grid: &'static str, memory: f64, check: fn(&[OperatorForm])) {
        with_session(move |session| {
            let scene = Scene::parse("grid.toml", grid).expect("a scene");
            let problem = scene.substructures(&|_| true).expect("substructures");
            let weights: Vec<Vec<f64>> = problem.local.iter().map(|s| s.rho.clone()).collect();
            let sharing = Sharing::new(session.comm(), &problem, &weights, Primal::default())
                .expect("shared");
            let jump = Jump::new(session.comm(), &problem, &sharing);
            let first: Vec<(usize, f64)> = (0..problem.local.len()).map(|j| (j, 1.0)).collect();
            let team = Team::new(1).expect("threads");
            let kinds = kinds(&problem, &jump, &first);
            check(&choose(
                &kinds,
                &team,
                Operators::Auto,
                APPLICATIONS[0],
                memory,
                false,
            ));
        });
    }

    const SOLID: &str = "title = \"solid\"\ndimension = 3\nphysics = \"elasticity\"\n[grid]\nbodies = [1, 1, 1]\nsubdomains = [2, 2, 2]\n\
                         elements_per_subdomain = 9\nload = [0, -1, 0]\ndirichlet = [\"bottom\"]\n";
    const PLANE: &str = "title = \"plane\"\n[grid]\nbodies = 1\nsubdomains = 3\nelements_per_subdomain = 48\nload = 1\n";

    #[test]
    fn large_solids_that_differ_are_solved_sparsely_and_plane_ones_are_dense() {
        forms(
            SOLID,
            1e12,
            |f| assert!(f.contains(&OperatorForm::Implicit)),
        );
        forms(PLANE, 1e12, |f| {
            assert!(!f.contains(&OperatorForm::Implicit))
        });
    }

    #[test]
    fn what_does_not_fit_is_solved_sparsely() {
        forms(
            PLANE,
            0.0,
            |f| assert!(!f.contains(&OperatorForm::Explicit)),
        );
        let n = 4.0 * 48.0; // a subdomain has no more rows than that
        forms(PLANE, 2.5 * 8.0 * n * n, |f| {
            let dense = f.iter().filter(|f| **f == OperatorForm::Explicit).count();
            assert!((2..9).contains(&dense), "{dense} of {}", f.len());
        });
    }
}

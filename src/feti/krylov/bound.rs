//! The spectrum and the bound on it: the conditions for deflation.

use super::eigenvalues;
use super::iterate::{KrylovRun, Watch};
use crate::feti::deflation::{self, profitability, Cost, Deflation};
use crate::feti::method::LinearMethod;
use crate::feti::settings::{Adaptive, ProjectorKind};
use crate::feti::spectrum::Spectrum;
use crate::Result;

/// If a bound τ is asked for, shared modes are deflated once an eigenvalue is above `KEPT` τ, down to `SHARED` τ.
const KEPT: f64 = 1.45;
const SHARED: f64 = 1.25;

/// Iterations before the first look at the spectrum. A search costs about twenty iterations. Most steps of a loop that
/// changes the rows take no more than that, and each of them would have to rebuild the matrices of the deflation.
const WATCHED_FROM: usize = 5;
const WATCHED_FROM_IN_STEPS: usize = 20;

impl LinearMethod {
    /// The condition for breaking an iteration off to deflate eigenvalues above τ; `None` if it runs to its end.
    pub(super) fn watch(&self) -> Option<Watch> {
        let adaptive = self.settings.adaptive;
        let limit = match &*self.system.deflation() {
            None => match adaptive {
                Adaptive::Auto => self.usual_limit().map(|limit| limit.max(self.worth())),
                _ => self.usual_limit(),
            },
            Some(d) if d.cost.given_up || d.exhausted => None,
            Some(_) => match adaptive {
                Adaptive::Below(tau) => Some(KEPT * tau),
                _ => None,
            },
        };
        let from = match self.facts.inequalities {
            0 => WATCHED_FROM,
            _ => WATCHED_FROM_IN_STEPS,
        };
        limit.map(|limit| Watch { limit, from })
    }

    /// The eigenvalue at which an iteration is broken off where deflation costs little.
    fn usual_limit(&self) -> Option<f64> {
        deflation::watch(self.settings.adaptive, self.varies)
    }

    /// The eigenvalue from which deflation is worth its cost. Collective when it is first asked for.
    fn worth(&self) -> f64 {
        *self.worth.get_or_init(|| {
            let dual = self.dual();
            let natural = &dual.natural;
            let (bodies, r) = (self.problem.n_bodies, natural.r);
            if profitability::is_cheap(bodies, r) {
                return 0.0;
            }
            // The graph of so many bodies takes time and memory on every rank.
            if profitability::is_never(bodies, r) {
                return f64::INFINITY;
            }
            let graph = natural.graph(&self.problem, &dual.stiffness);
            let problem = profitability::ProblemKind {
                wide: natural.projector == ProjectorKind::Preconditioner,
                contact: self.facts.inequalities > 0,
            };
            profitability::from(graph, natural.columns.start(), problem)
        })
    }

    /// Notes an eigenvalue that a run has seen, if it would have been deflated with fewer bodies.
    pub(super) fn note(&self, run: &KrylovRun) {
        let may = self.settings.adaptive == Adaptive::Auto && !self.is_deflated();
        let Some(seen) = run.estimate.filter(|_| may) else {
            return;
        };
        let declined = self
            .usual_limit()
            .is_some_and(|usual| seen.lambda_max > usual);
        let long = self.watch().is_some_and(|w| run.iterations > w.from);
        if declined && long && seen.lambda_max <= self.worth() {
            self.declined.set(self.declined.get().max(seen.lambda_max));
        }
    }

    /// (The largest eigenvalue that iterations have seen and `auto` would have deflated with fewer bodies, the
    /// eigenvalue from which it is worth the cost); `None` if there was none.
    pub fn deflation_declined(&self) -> Option<(f64, f64)> {
        let seen = self.declined.get();
        (seen > 0.0 && !self.is_deflated()).then(|| (seen, self.worth()))
    }

    /// Whether the search must come before the iteration: large eigenvalues are expected or a bound is asked for, and
    /// the Krylov method is not CG, the only one whose Ritz values can be read.
    pub(super) fn is_blind(&self) -> Result<bool> {
        let expected = self.watch().is_some_and(|watch| {
            let bounded = matches!(self.settings.adaptive, Adaptive::Below(_));
            bounded || watch.limit <= deflation::EXPECTED
        });
        Ok(expected && !self.is_deflated() && self.ksp.type_name()? != "cg")
    }

    /// Finds the eigenvectors above τ with all candidate rows and deflates them from now on, whatever the spectrum of
    /// the iterations. Collective.
    pub fn deflate(&self) -> Result<()> {
        self.deflate_candidates(None)
    }

    /// Searches with the rows that hold, or with all candidate rows if there are inequalities. `seen` is the spectrum
    /// that the iterations have shown.
    pub(super) fn search(&self, seen: Option<Spectrum>) -> Result<()> {
        match self.facts.inequalities {
            0 => self.deflate_held(seen),
            _ => self.deflate_candidates(seen),
        }
    }

    fn deflate_candidates(&self, before: Option<Spectrum>) -> Result<()> {
        let candidates: Vec<bool> = {
            let dual = self.dual();
            let jump = &dual.stiffness.jump;
            let may = |i| jump.active[i] || jump.is_candidate(i);
            (0..jump.n_owned).map(may).collect()
        };
        self.with_rows_put_back(|| {
            self.set_active(&candidates)?;
            self.deflate_held(before)
        })
    }

    /// A first search body by body. A second one for shared modes follows only if a bound is asked for.
    fn deflate_held(&self, before: Option<Spectrum>) -> Result<()> {
        let tau = match self.settings.adaptive {
            Adaptive::Below(tau) => tau,
            _ => Adaptive::USUAL,
        };
        let most = self.settings.adaptive_max;
        if self.is_deflated() {
            let more = self.deflate_shared(SHARED * tau)?;
            if let Some(deflation) = self.system.change_deflation().as_mut() {
                deflation.exhausted = !more;
            }
        } else {
            let mut deflation = Deflation::new(&self.problem, &self.dual(), tau, most)?;
            deflation.cost.before = before;
            deflation.bounded = matches!(self.settings.adaptive, Adaptive::Below(_));
            self.system.change_deflation().replace(deflation);
        }
        Ok(())
    }

    /// Deflates the eigenvalues above `bound` with the rows that hold. Returns `false` if none is found or deflation
    /// has been given up.
    fn deflate_shared(&self, bound: f64) -> Result<bool> {
        let most = self.settings.adaptive_max;
        match self.system.change_deflation().as_mut() {
            Some(deflation) if !deflation.cost.given_up => {
                let found = deflation.polish(&self.dual(), bound, most)?;
                Ok(found > 0)
            }
            _ => Ok(false),
        }
    }

    /// Sets P_2 = I from now on, where rounding has made P_2 useless. Returns `false` if P_2 is I already. The report
    /// of the search is kept.
    pub(super) fn give_deflation_up(&self) -> bool {
        let useful = |d: &Deflation| d.matrices().is_some();
        if !self.system.deflation().as_ref().is_some_and(useful) {
            return false;
        }
        if let Some(deflation) = self.system.change_deflation().as_mut() {
            deflation.give_up();
        }
        true
    }

    fn is_deflated(&self) -> bool {
        self.system.deflation().is_some()
    }

    /// Result and cost of the deflation; `None` if there was no search.
    pub fn deflated(&self) -> Option<Cost> {
        let deflation = self.system.deflation();
        deflation.as_ref().map(|d| d.cost.clone())
    }

    /// Exact extreme eigenvalues of the preconditioned operator; `None` without multipliers. If a bound is asked for
    /// and nothing has been deflated yet, deflation comes first. Collective.
    pub fn spectrum(&self) -> Result<Option<Spectrum>> {
        let bound = match self.settings.adaptive {
            Adaptive::Below(tau) => Some(tau),
            _ => None,
        };
        if bound.is_some() && !self.is_deflated() {
            self.deflate()?;
        }
        let mut spectrum = self.present_spectrum()?;
        // Fewer rows may hold now than in the search. Bodies may then share modes that the search did not see.
        if let Some(tau) = bound {
            let too_large =
                |s: &Option<Spectrum>| matches!(s, Some(s) if s.lambda_max > KEPT * tau);
            while too_large(&spectrum) && self.deflate_shared(SHARED * tau)? {
                spectrum = self.present_spectrum()?;
            }
        }
        Ok(spectrum)
    }

    /// [`spectrum`](Self::spectrum) without deflation. Collective.
    pub fn plain_spectrum(&self) -> Result<Option<Spectrum>> {
        let kept = self.system.change_deflation().take();
        let spectrum = self.present_spectrum();
        *self.system.change_deflation() = kept;
        spectrum
    }

    fn present_spectrum(&self) -> Result<Option<Spectrum>> {
        // SLEPc's options begin with `eps_` themselves.
        eigenvalues::exact(&self.system, &self.settings.prefix)
    }
}

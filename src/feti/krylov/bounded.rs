//! The spectrum of a solver, and the bound on it: when deflation is looked for, and how often.

use super::spectrum;
use super::spectrum::Spectrum;
use crate::feti::deflation::{Cost, Deflation};
use crate::feti::operators::dual::Dual;
use crate::feti::settings::Adaptive;
use crate::feti::solver::FetiFeti;
use crate::Result;

/// Where a bound τ is asked for, deflation of what bodies share sets in above `KEPT` τ and goes down to `SHARED` τ.
const KEPT: f64 = 1.45;
const SHARED: f64 = 1.25;

impl FetiFeti {
    /// Finds what of the spectrum is above τ and deflates it from now on, whatever the iterations have shown; with all rows that may hold.
    /// Collective.
    pub fn deflate(&self) -> Result<()> {
        self.deflate_after(None)
    }

    /// The same with what the iterations have seen of the spectrum.
    fn deflate_after(&self, before: Option<Spectrum>) -> Result<()> {
        let (candidates, now) = {
            let dual = self.dual();
            let jump = &dual.stiffness.jump;
            let may = |i| jump.active[i] || jump.is_candidate(i);
            let all: Vec<bool> = (0..jump.n_owned).map(may).collect();
            (all, jump.active.clone())
        };
        let set = |active: &[bool]| {
            self.shared()
                .borrow_mut()
                .set_active(self.problem(), active)
        };
        let changed = set(&candidates)?;
        let found = self.deflate_with(&self.dual(), before);
        if changed > 0 {
            set(&now)?;
        }
        found
    }

    /// The same where the iterations ask for it: with the rows that hold, unless rows come and go.
    pub(crate) fn search(&self, seen: Option<Spectrum>) -> Result<()> {
        if self.facts().inequalities > 0 {
            self.deflate_after(seen)
        } else {
            self.deflate_with(&self.dual(), seen)
        }
    }

    fn deflate_with(&self, dual: &Dual, before: Option<Spectrum>) -> Result<()> {
        let tau = match self.settings().adaptive {
            Adaptive::Below(tau) => tau,
            _ => Adaptive::USUAL,
        };
        let bounded = matches!(self.settings().adaptive, Adaptive::Below(_));
        // Modes that bodies share come second, and only where a bound is asked for.
        let searched = dual.deflation().is_some();
        let more = if searched {
            self.polish(SHARED * tau)?
        } else {
            let most = self.settings().adaptive_max;
            let mut deflation = Deflation::new(self.session(), self.problem(), dual, tau, most)?;
            deflation.cost.before = before;
            dual.deflate(Some(deflation));
            true
        };
        dual.set_watch((bounded && more).then_some(KEPT * tau));
        Ok(())
    }

    /// Deflates what is above `bound` with the rows that hold; `false` where nothing is found, or deflation has been given up.
    fn polish(&self, bound: f64) -> Result<bool> {
        let dual = self.dual();
        let Some(mut deflation) = dual.take_deflation() else {
            return Ok(false);
        };
        let most = self.settings().adaptive_max;
        let found = match deflation.cost.given_up {
            true => Ok(0),
            false => deflation.polish(self.session(), &dual, bound, most),
        };
        dual.deflate(Some(deflation));
        Ok(found? > 0)
    }

    /// What is deflated and what that has cost; `None` where nothing has been searched for.
    pub fn deflated(&self) -> Option<Cost> {
        self.dual().deflation().as_ref().map(|d| d.cost.clone())
    }

    /// Exact extreme eigenvalues of the preconditioned operator; `None` without multipliers. Where a bound is asked for and nothing
    /// has been deflated yet, that is done first. Collective.
    pub fn spectrum(&self) -> Result<Option<Spectrum>> {
        let searched = self.dual().deflation().is_some();
        if matches!(self.settings().adaptive, Adaptive::Below(_)) && !searched {
            self.deflate()?;
        }
        let mut spectrum = self.present_spectrum()?;
        // What bodies share with the rows that hold now, which may be fewer than those that were searched with.
        if let Adaptive::Below(tau) = self.settings().adaptive {
            let too_large =
                |s: &Option<Spectrum>| matches!(s, Some(s) if s.lambda_max > KEPT * tau);
            while too_large(&spectrum) && self.polish(SHARED * tau)? {
                spectrum = self.present_spectrum()?;
            }
        }
        Ok(spectrum)
    }

    /// The same without deflation. Collective.
    pub fn plain_spectrum(&self) -> Result<Option<Spectrum>> {
        let kept = self.dual().take_deflation();
        let spectrum = self.present_spectrum();
        self.dual().deflate(kept);
        spectrum
    }

    fn present_spectrum(&self) -> Result<Option<Spectrum>> {
        let prefix = format!("{}eps_", self.settings().prefix);
        spectrum::exact(self.session(), self.shared(), &prefix)
    }
}

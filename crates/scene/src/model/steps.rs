//! Quasi-static load steps: the times t and the factors of loads, gaps and given values at each of them.

use super::entry::EntryId;
use super::profile::Limit;
use super::ramp::Ramp;
use super::spec::SceneSpec;
use base::{Error, Result};

/// Checked load steps.
#[derive(Debug, Clone, PartialEq)]
pub struct Steps {
    /// The times, increasing; at least one.
    pub times: Vec<f64>,
    /// Whether each step renews normals, pairing and gaps of contacts.
    pub update: bool,
    load: Ramp,
    gap: Ramp,
    dirichlet: Ramp,
    /// The ramps of the contacts, and of the obstacles.
    contacts: Vec<Option<Ramp>>,
    obstacles: Vec<Option<Ramp>>,
}

impl Steps {
    /// Takes the ramps of the entries of `spec` again, after entries for surfaces have become entries for bodies.
    pub(crate) fn renumber(&mut self, spec: &SceneSpec) {
        self.contacts = spec.contacts.iter().map(|c| c.ramp.clone()).collect();
        self.obstacles = spec.obstacles.iter().map(|o| o.ramp.clone()).collect();
    }

    /// The steps of `spec`. Every factor is evaluated at every time.
    pub(crate) fn new(spec: &SceneSpec) -> Result<Option<Steps>> {
        let bodies = spec.bodies.iter().map(|b| (&b.ramp, &b.location));
        let contacts = spec.contacts.iter().map(|c| (&c.ramp, &c.location));
        let obstacles = spec.obstacles.iter().map(|o| (&o.ramp, &o.location));
        let ramps = bodies.chain(contacts).chain(obstacles);
        let Some(steps) = &spec.steps else {
            let ramped = ramps.clone().find(|(ramp, _)| ramp.is_some());
            return match ramped {
                None => Ok(None),
                Some((_, location)) => {
                    let what = "a `ramp` in a scene without load steps ([steps] was expected)";
                    Err(Error::input(what).at(location.with_key("ramp")))
                }
            };
        };
        let fail = |message: String| Err(Error::input(message).at(&steps.location));
        if steps.times.is_empty() {
            return fail("no times in [steps] where at least one was expected".into());
        }
        if let Some(t) = steps.times.iter().find(|t| !t.is_finite()) {
            return fail(format!(
                "the time {t} in [steps] where a finite number was expected"
            ));
        }
        if let Some(pair) = steps.times.windows(2).find(|w| w[0] >= w[1]) {
            return fail(format!(
                "the time {} after {} in [steps] (increasing times were expected)",
                pair[1], pair[0]
            ));
        }
        let own = [
            ("load", &steps.load),
            ("gap", &steps.gap),
            ("dirichlet", &steps.dirichlet),
        ]
        .map(|(key, ramp)| (key, ramp, &steps.location));
        let ramped = ramps.filter_map(|(ramp, location)| Some(("ramp", ramp.as_ref()?, location)));
        for (key, ramp, location) in own.into_iter().chain(ramped) {
            for &t in &steps.times {
                let value = ramp.at(t);
                if !value.is_finite() {
                    return Err(Error::input(format!(
                        "the factor `{key}` = \"{ramp}\" is {value} at t = {t} \
                         where a finite number was expected"
                    ))
                    .at(location.with_key(key)));
                }
            }
        }
        let mut checked = Steps {
            times: steps.times.clone(),
            update: steps.update,
            load: steps.load.clone(),
            gap: steps.gap.clone(),
            dirichlet: steps.dirichlet.clone(),
            contacts: Vec::new(),
            obstacles: Vec::new(),
        };
        checked.renumber(spec);
        Ok(Some(checked))
    }

    /// The ramp that an entry has for itself.
    fn ramp(&self, entry: EntryId) -> Option<&Ramp> {
        match entry {
            EntryId::Contact(k) => self.contacts.get(k)?.as_ref(),
            EntryId::Obstacle(k) => self.obstacles.get(k)?.as_ref(),
            EntryId::Tie(_) | EntryId::Equation(_) => None,
        }
    }
}

/// The factors of one load step; all are 1 where the scene has no steps.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Factors<'a> {
    at: Option<(&'a Steps, f64)>,
}

impl<'a> Factors<'a> {
    /// The factors of every step; a single step with factors 1 if the scene has no steps.
    pub fn every(steps: &'a Option<Steps>) -> Vec<Factors<'a>> {
        match steps {
            None => vec![Factors::none()],
            Some(s) => s
                .times
                .iter()
                .map(|&t| Factors { at: Some((s, t)) })
                .collect(),
        }
    }

    /// Factors that are all 1.
    pub fn none() -> Factors<'a> {
        Factors { at: None }
    }

    /// The factors of the last step.
    pub fn last(steps: &'a Option<Steps>) -> Factors<'a> {
        let at = steps.as_ref();
        Factors {
            at: at.and_then(|s| s.times.last().map(|&t| (s, t))),
        }
    }

    /// The factors of step `step`.
    pub fn of(steps: &'a Option<Steps>, step: usize) -> Result<Factors<'a>> {
        let every = steps.as_ref().map_or(1, |s| s.times.len());
        if step >= every {
            return Err(Error::input(format!(
                "load step {step} of a scene with {every} (a number below that was expected)"
            )));
        }
        Ok(Factors {
            at: steps.as_ref().map(|s| (s, s.times[step])),
        })
    }

    /// The factor of the load of a body with the ramp `own`.
    pub fn load(&self, own: Option<&Ramp>) -> f64 {
        self.at.map_or(1.0, |(s, t)| own.unwrap_or(&s.load).at(t))
    }

    /// The factor of given values.
    pub fn dirichlet(&self) -> f64 {
        self.at.map_or(1.0, |(s, t)| s.dirichlet.at(t))
    }

    /// The tightest of several bounds and the entry that it comes from.
    pub fn tightest<'l>(
        &self,
        limits: impl IntoIterator<Item = &'l Limit>,
    ) -> Option<(f64, Option<EntryId>)> {
        limits
            .into_iter()
            .map(|l| (l.value * self.gap(l.entry), l.entry))
            .min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// The tightest of the bounds of an inequality; there must be at least one.
    pub fn bound(&self, limits: &[Limit]) -> (f64, Option<EntryId>) {
        self.tightest(limits)
            .expect("a row of an inequality has a bound")
    }

    /// The factor of the gaps of an entry.
    pub fn gap(&self, entry: Option<EntryId>) -> f64 {
        self.at.map_or(1.0, |(s, t)| {
            let own = entry.and_then(|e| s.ramp(e));
            own.unwrap_or(&s.gap).at(t)
        })
    }

    /// " at t = 0.5" for messages; nothing without steps.
    pub fn when(&self) -> String {
        self.at.map_or(String::new(), |(_, t)| format!(", t = {t}"))
    }
}

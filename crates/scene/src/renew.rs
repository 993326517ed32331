//! A scene whose contacts are renewed: it looks at its bodies where the last load step has left them.

use super::body::bounds_of;
use super::checked::Scene;
use super::displaced::Displaced;
use super::renewal::is_renewed;
use base::Result;

impl Scene {
    /// Whether load steps renew normals, pairing and gaps of contacts.
    pub fn is_renewed(&self) -> bool {
        self.renewal.is_some()
    }

    /// Whether `[steps] update = true` would be accepted.
    pub fn may_be_renewed(&self) -> bool {
        self.renewable
    }

    /// The number of pairs of bodies whose contact is renewed, and of those whose contact stays as it is because they
    /// are tied in part or meet in a corner.
    pub fn renewed_pairs(&self) -> [usize; 2] {
        let contacts = self.interfaces.iter().filter(|i| i.has_contact());
        let renewed = contacts.clone().filter(|i| is_renewed(i)).count();
        [renewed, contacts.count() - renewed]
    }

    /// Renews the contacts and obstacles for load step `step`, at the displacements of the end of the last one, if
    /// `[steps]` has `update`. The rows are then those of [`Scene::solver_rows`] with the right-hand sides of
    /// [`Scene::gaps`]: [`FetiFeti::set_rows`](fetifeti::FetiFeti::set_rows) takes them.
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) where given values contradict an inequality; the scene is then as
    /// it was.
    pub fn renew(&mut self, at: &Displaced, step: usize) -> Result<()> {
        let Some(renewal) = self.renewal.clone() else {
            return Ok(());
        };
        let mut bodies = std::mem::take(&mut self.bodies);
        let bounds: Vec<[[f64; 3]; 2]> = bodies.iter().map(|b| b.bounds).collect();
        for (k, body) in bodies.iter_mut().enumerate() {
            body.spec.moved = at.of(k);
            body.bounds = bounds_of(&body.spec);
        }
        let mut steps = self.steps.clone();
        let found = renewal.on(&mut bodies, &mut steps, step);
        for (body, bounds) in bodies.iter_mut().zip(bounds) {
            body.spec.moved = None;
            body.bounds = bounds;
        }
        self.bodies = bodies;
        let (interfaces, obstacles, rows) = found?;
        self.steps = steps;
        (self.interfaces, self.obstacles) = (interfaces.into(), obstacles);
        (self.points, self.rows) = (rows.points, rows.rows);
        Ok(())
    }
}

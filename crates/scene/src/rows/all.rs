//! All rows of a scene: what its interfaces, obstacles and equations come to.

use super::bounds::Checks;
use super::mortar;
use super::obstacles::Obstacle;
use super::points::InterfacePoint;
use super::row::Row;
use crate::axis;
use crate::body::Body;
use crate::geometry::interface::BodyInterface;
use crate::model::spec::SceneSpec;
use crate::model::steps::{Factors, Steps};
use crate::rows::equations;
use crate::rows::laws;
use crate::rows::points;
use base::Result;
use fetifeti::problem::RowSource;
use std::collections::HashSet;

/// The rows with the points at which nodes meet, and sentences about them.
pub(crate) struct SceneRows {
    pub points: Vec<InterfacePoint>,
    /// By point, then equations, then rows between sides whose nodes do not match.
    pub rows: Vec<Row>,
    pub notes: Vec<String>,
}

/// The data from which rows are made.
pub(crate) struct Joined<'a> {
    pub spec: &'a SceneSpec,
    pub interfaces: &'a mut [BodyInterface],
    pub obstacles: &'a [Obstacle],
    /// Rows between sides whose nodes do not match that are known already.
    pub known: Vec<Row>,
    /// The subdomains at whose points rows are wanted. All are, where rows lead from point to point: where there are
    /// equations, or sides whose nodes do not match.
    pub owns: &'a dyn Fn(usize) -> bool,
}

impl Joined<'_> {
    /// Whether a soft row has no force whatever its overclosure is: its node has no area, on an axis of symmetry.
    fn is_forceless(&self, bodies: &[Body], row: &Row) -> bool {
        if !laws::is_soft(self.spec, row) {
            return false;
        }
        let side = match row.source {
            RowSource::Obstacle(k) if self.obstacles[k].area.is_none() => self.obstacles[k].side,
            RowSource::Interface(k) if self.interfaces[k].area.is_none() => {
                let interface = &self.interfaces[k];
                interface.sides[interface.order[0]]
            }
            _ => return false,
        };
        let first = row.members[0].expect("a contact has a first node");
        axis::has_no_area(&bodies[first.body], &self.spec.form, side, first.node)
    }

    /// Makes the rows; given values are checked against those of load step `step`, or of all steps.
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) where given values contradict rows.
    pub fn rows(
        self,
        bodies: &mut [Body],
        steps: &Option<Steps>,
        step: Option<usize>,
    ) -> Result<SceneRows> {
        let spec = self.spec;
        // Rows beside obstacles are added to points that are known.
        let beside: HashSet<usize> = self.obstacles.iter().map(|o| o.body).collect();
        let wanted = |p: &InterfacePoint| {
            (self.owns)(p.subdomain) || p.members.iter().any(|m| beside.contains(&m.body))
        };
        let near =
            |(b, body): (usize, &Body)| beside.contains(&b) || body.subdomains().any(self.owns);
        let near: Vec<bool> = bodies.iter().enumerate().map(near).collect();
        let found = points::collect(bodies, self.interfaces, &|b| near[b], &wanted)?;
        let (mut points, mut rows) = found;
        let mut checks = Checks::new(bodies, self.obstacles, spec, steps);
        if let Some(step) = step {
            checks.factors = vec![Factors::of(steps, step)?];
        }
        checks.apply(&mut points, &mut rows)?;
        points.retain(|p| (self.owns)(p.subdomain));
        points.shrink_to_fit();
        rows.retain(|row| (self.owns)(row.subdomain) && !self.is_forceless(bodies, row));
        let (mortar, notes) = mortar::collect(
            bodies,
            &spec.form,
            self.interfaces,
            &points,
            &checks,
            self.known,
        )?;
        let mut chained = equations::collect(bodies, &spec.equations)?;
        chained.extend(mortar);
        let slides = |row: &Row| laws::has_friction(spec, row);
        equations::join(bodies, &mut points, &mut rows, &mut chained, slides);
        rows.extend(chained);
        rows.shrink_to_fit();
        Ok(SceneRows {
            points,
            rows,
            notes,
        })
    }
}

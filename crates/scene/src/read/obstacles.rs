//! [[obstacle]].

use super::document::{Item, TableSection, Value};
use super::groups::{sides_of, some};
use super::instances::fits;
use super::mesh::{load_beside, SceneMesh};
use super::ties::body_name;
use super::SceneReader;
use crate::model::body::BodySpec;
use crate::model::joints::{Extent, ObstacleSpec};
use crate::model::profile::Profile;
use crate::model::rigid::Rigid;
use crate::model::rigid_surface::RigidSurface;
use base::{Error, ErrorKind, Result};

/// The rigid body that an elastic body cannot enter, and how it is taken.
#[derive(Default)]
struct RigidShape {
    rigid: Option<Rigid>,
    surface: Option<RigidSurface>,
    motion: [f64; 3],
    distance: Option<f64>,
    adjust: f64,
}

impl SceneReader {
    /// An obstacle; one for each of all bodies where some of them are meshes, whose sides have numbers of their own.
    pub(super) fn obstacle(
        &self,
        item: &Item,
        bodies: &[BodySpec],
        source: Option<&mut SceneMesh>,
    ) -> Result<Vec<ObstacleSpec>> {
        let mut section = item.section("[[obstacle]]")?;
        let wanted = "\"all\" or the name of a body";
        let named = section.need("body", wanted)?;
        let body = if named.is("all") {
            None
        } else {
            Some(body_name(named, bodies, wanted)?)
        };
        let meant: Vec<&BodySpec> = match &body {
            Some(name) => bodies.iter().filter(|b| fits(name, &b.name)).collect(),
            None => bodies.iter().collect(),
        };
        let several = body.as_ref().is_some_and(|name| name.contains('*'));
        if several && meant.is_empty() {
            return named.error(format!("{} fits no body", named.value.kind()));
        }
        if let (Some(name), true) = (&body, meant.is_empty()) {
            let names: Vec<String> = bodies.iter().map(|b| format!("`{}`", b.name)).collect();
            return item.error(format!(
                "an obstacle names body `{name}`, which the scene does not have (bodies are {})",
                some(&names)
            ));
        }
        let of_cells = meant.iter().any(|b| b.mesh.cells().is_some());
        let side = section.need("side", "a side, a list of them or \"all\"")?;
        let sides = if of_cells {
            self.obstacle_groups(side, &meant)?
        } else if several {
            let sides = self.obstacle_sides(side)?;
            let each = meant.iter().map(|b| (Some(b.name.clone()), sides.clone()));
            each.collect()
        } else {
            vec![(body.clone(), self.obstacle_sides(side)?)]
        };
        let extent = self.extent(&mut section, item, "[[obstacle]]")?;
        let mut bound = |key| section.read(key, |item| self.profile(item));
        let elastic = self.form.is_elastic();
        let (below, above, gap) = if elastic {
            (None, None, bound("gap")?)
        } else {
            (bound("below")?, bound("above")?, None)
        };
        let shape = if elastic {
            self.rigid_shape(&mut section, item, bodies, source, &extent)?
        } else {
            RigidShape::default()
        };
        let law = self.law(&mut section)?;
        let ramp = self.ramp(&mut section)?;
        section.finish()?;
        let rigid = shape.rigid.is_some() || shape.surface.is_some();
        if below.is_none() && above.is_none() && !rigid {
            return item.error(if elastic {
                "[[obstacle]] without a rigid body (`plane`, `cylinder`, `sphere` or `surface` was expected)"
            } else { "[[obstacle]] without a bound (`below`, `above` or both were expected)" });
        }
        let gap = gap.unwrap_or_else(|| Profile::constant(0.0));
        let one = |(body, sides)| ObstacleSpec {
            body,
            sides,
            extent: extent.clone(),
            below: below.clone(),
            above: above.clone(),
            rigid: shape.rigid,
            surface: shape.surface.clone(),
            gap: gap.clone(),
            motion: shape.motion,
            distance: shape.distance,
            adjust: shape.adjust,
            area: None,
            law: law.clone(),
            ramp: ramp.clone(),
            location: item.location(),
        };
        Ok(sides.into_iter().map(one).collect())
    }

    /// The sides of each body that has some of the named groups.
    fn obstacle_groups(
        &self,
        item: &Item,
        bodies: &[&BodySpec],
    ) -> Result<Vec<(Option<String>, Vec<usize>)>> {
        let names: Vec<String> = match &item.value {
            Value::List(items) => {
                let name = |item: &Item| item.text("the name of a side or boundary group");
                items.iter().map(name).collect::<Result<_>>()?
            }
            _ => vec![item.text("a side or boundary group, a list of them or \"all\"")?],
        };
        let has = |body: &BodySpec, name: &String| body.mesh.side_of_name(name).is_some();
        let nowhere = |name: &&String| *name != "all" && !bodies.iter().any(|b| has(b, name));
        if let Some(name) = names.iter().find(nowhere) {
            let whose = match bodies {
                [one] => format!("which body `{}` does not have", one.name),
                _ => "which no such body has".into(),
            };
            return item.error(format!(
                "the side `{name}`, {whose} (sides are {})",
                sides_of(bodies.iter().copied())
            ));
        }
        let mut out = Vec::new();
        for body in bodies {
            let sides: Vec<usize> = if names.iter().any(|n| n == "all") {
                body.mesh.outer_sides().collect()
            } else {
                names
                    .iter()
                    .filter_map(|n| body.mesh.side_of_name(n))
                    .collect()
            };
            if !sides.is_empty() {
                out.push((Some(body.name.clone()), sides));
            }
        }
        if out.is_empty() {
            item.expected("a side, a list of them or \"all\"")
        } else {
            Ok(out)
        }
    }

    fn obstacle_sides(&self, item: &Item) -> Result<Vec<usize>> {
        let names = self.sides_list().replace(" or ", ", ");
        let side = |item: &Item| {
            let wanted = format!("{names}, a list of them or \"all\"");
            self.side(item).or_else(|_| item.expected(wanted))
        };
        match &item.value {
            _ if item.is("all") => Ok((0..2 * self.dim).collect()),
            Value::List(items) if !items.is_empty() => {
                let mut sides = items.iter().map(side).collect::<Result<Vec<usize>>>()?;
                sides.sort_unstable();
                sides.dedup();
                Ok(sides)
            }
            _ => Ok(vec![side(item)?]),
        }
    }

    /// `plane`, `cylinder`, `sphere` or `surface`, and the keys beside them.
    fn rigid_shape(
        &self,
        section: &mut TableSection,
        entry: &Item,
        bodies: &[BodySpec],
        source: Option<&mut SceneMesh>,
        extent: &Extent,
    ) -> Result<RigidShape> {
        let rigid = self.rigid(section, entry)?;
        let surface = self.rigid_surface(section, entry, bodies, source)?;
        let motion = section.read("move", |item| self.vector(item, "a vector"))?;
        let distance = section.read("distance", |item| self.positive(item))?;
        let adjust = section.read("adjust", |item| self.positive(item))?;
        if rigid.is_some() && surface.is_some() {
            return entry.error(
                "a `surface` beside a `plane`, `cylinder` or `sphere` where one was expected",
            );
        }
        if surface.is_some() && matches!(extent, Extent::Points(_) | Extent::Nodes(_)) {
            return entry.error(
                "`points` or `nodes` beside a `surface`, whose rows are integrals over faces (a `range` or the whole \
                 side was expected)",
            );
        }
        Ok(RigidShape {
            rigid,
            surface,
            motion: motion.unwrap_or_default(),
            distance,
            adjust: adjust.unwrap_or(0.0),
        })
    }

    /// `surface`: a group of faces of the scene's mesh, or of the file `mesh`.
    fn rigid_surface(
        &self,
        section: &mut TableSection,
        entry: &Item,
        bodies: &[BodySpec],
        source: Option<&mut SceneMesh>,
    ) -> Result<Option<RigidSurface>> {
        let item = section.take("surface");
        let file = section.take("mesh");
        let scale = section.read("scale", |item| self.positive(item))?;
        let reverse = section.read("reverse", |item| match item.value {
            Value::Truth(v) => Ok(v),
            _ => item.expected("true or false"),
        })?;
        let reverse = reverse.unwrap_or(false);
        let Some(item) = item else {
            let alone = [
                ("mesh", file.is_some()),
                ("scale", scale.is_some()),
                ("reverse", reverse),
            ];
            return match alone.iter().find(|a| a.1) {
                Some((key, _)) => entry.error(format!("`{key}` without a `surface`")),
                None => Ok(None),
            };
        };
        let name = item.text("the name of a group of faces")?;
        let told = |error: Error| match error.kind() {
            ErrorKind::Input => error.at(item.location()),
            _ => error,
        };
        if let Some(file) = file {
            let mesh = load_beside(file)?;
            let scale = scale.unwrap_or(1.0);
            return RigidSurface::of_file(&mesh, self.dim, &name, scale, reverse)
                .map(Some)
                .map_err(told);
        }
        if scale.is_some() {
            return entry.error("`scale` without `mesh` ([mesh] has a `scale` of its own)");
        }
        let Some(source) = source else {
            return item.error(format!(
                "the surface `{name}` in a scene without a mesh ([mesh], or the key `mesh` with the name of a file, \
                 was expected)"
            ));
        };
        let has = |b: &&BodySpec| {
            let mesh = b.mesh.cells();
            mesh.is_some_and(|m| {
                m.sides
                    .iter()
                    .any(|s| s.name == name && !s.faces.is_empty())
            })
        };
        if let Some(body) = bodies.iter().find(has) {
            return item.error(format!(
                "the rigid surface `{name}` is a side of body `{}` (faces that belong to no body were expected; \
                 [[contact]] joins bodies)",
                body.name
            ));
        }
        source.surface(&name, reverse).map(Some).map_err(told)
    }
}

//! Loads, springs and given values at the boundary groups of bodies that are groups of a mesh.

use std::collections::BTreeSet;

use super::document::{Item, TableSection, Value};
use super::groups::some;
use super::SceneReader;
use crate::model::body::{held, BodySpec, Force, SurfaceLoad};
use crate::model::field::Field;
use base::Result;
use mesh::CellMesh;

/// The boundary groups of the parts of a body.
pub(super) struct BoundaryGroups {
    names: BTreeSet<String>,
    /// The names of the groups that have a face on the boundary of a part.
    with_faces: BTreeSet<String>,
}

impl BoundaryGroups {
    pub fn of(parts: &[CellMesh]) -> BoundaryGroups {
        let sides = || parts.iter().flat_map(|part| &part.sides);
        let with_faces = sides().filter(|side| !side.faces.is_empty());
        BoundaryGroups {
            names: sides().map(|side| side.name.clone()).collect(),
            with_faces: with_faces.map(|side| side.name.clone()).collect(),
        }
    }

    /// An error if what acts on faces is given at a group without a face.
    fn need_faces(&self, item: &Item, name: &str, key: &str) -> Result<()> {
        if self.with_faces.contains(name) {
            Ok(())
        } else {
            item.error(format!(
            "`{key}` at the boundary group `{name}`, of which no face is on the boundary of the body, so that it \
             would do nothing (a group of faces was expected)"
        ))
        }
    }
}

/// Given values by boundary group.
type SupportsByGroup = Vec<(String, [Option<Field>; 3])>;

/// The loads, springs and given values of a body at its boundary groups. An absent entry leaves a body as it is.
#[derive(Default)]
pub(super) struct OfGroups {
    /// Loads, each list with whether it is one of pressures.
    forces: Vec<(bool, Vec<(String, Force)>)>,
    springs: Option<Vec<(String, Field)>>,
    dirichlet: Option<SupportsByGroup>,
}

impl OfGroups {
    /// Gives a body what belongs to its groups, in the place of what it has.
    pub fn apply(&self, body: &mut BodySpec) {
        let mesh = body.mesh.clone();
        for (is_pressure, list) in &self.forces {
            let own = |load: &SurfaceLoad| matches!(load.force, Force::Pressure(_)) == *is_pressure;
            body.surface.retain(|load| !own(load));
            let at_sides = list.iter().filter_map(|(name, force)| {
                let (side, force) = (mesh.side_of_name(name)?, force.clone());
                Some(SurfaceLoad { side, force })
            });
            body.surface.extend(at_sides);
        }
        if let Some(list) = &self.springs {
            let at_sides = list.iter();
            let at_sides =
                at_sides.filter_map(|(name, k)| Some((mesh.side_of_name(name)?, k.clone())));
            body.springs = at_sides.collect();
        }
        if let Some(list) = &self.dirichlet {
            body.dirichlet = vec![[const { None }; 3]; mesh.n_sides()].into();
            for (name, given) in list {
                if let Some(side) = mesh.side_of_name(name) {
                    body.dirichlet[side] = given.clone();
                }
            }
        }
    }
}

impl SceneReader {
    /// Loads and given values of boundary groups.
    pub(super) fn conditions_of_mesh(
        &self,
        section: &mut TableSection,
        groups: &BoundaryGroups,
    ) -> Result<OfGroups> {
        let mut out = OfGroups::default();
        let keys: &[(&'static str, bool)] = if self.form.is_elastic() {
            &[("traction", false), ("pressure", true)]
        } else {
            &[("flux", false)]
        };
        for &(key, is_pressure) in keys {
            let Some(list) = self.by_group(section, key, groups)? else {
                continue;
            };
            let force = |(name, item): (&str, &Item)| {
                groups.need_faces(item, name, key)?;
                let force = if is_pressure {
                    Force::Pressure(self.formula(item)?)
                } else {
                    let list = self.components(item)?.into_iter();
                    Force::Traction(list.map(Field::Expression).collect())
                };
                Ok((name.to_string(), force))
            };
            let list: Result<_> = list.into_iter().map(force).collect();
            out.forces.push((is_pressure, list?));
        }
        if let Some(list) = self.by_group(section, "spring", groups)? {
            let spring = |(name, item): (&str, &Item)| {
                groups.need_faces(item, name, "spring")?;
                Ok((name.to_string(), self.formula(item)?))
            };
            out.springs = Some(list.into_iter().map(spring).collect::<Result<_>>()?);
        }
        out.dirichlet = self.held_groups(section, groups)?;
        Ok(out)
    }

    /// The entries of a table whose keys are boundary groups.
    fn by_group<'a>(
        &self,
        section: &mut TableSection<'a>,
        key: &'static str,
        groups: &BoundaryGroups,
    ) -> Result<Option<Vec<(&'a str, &'a Item<'a>)>>> {
        let Some(item) = section.take(key) else {
            return Ok(None);
        };
        let table = item.section(key)?;
        let entry = |(name, _, item): &'a (String, usize, Item<'a>)| {
            known(item, name, groups)?;
            Ok((name.as_str(), item))
        };
        let entries: Result<_> = table.entries.iter().map(entry).collect();
        entries.map(Some)
    }

    /// `dirichlet`: "all", "none", a list of groups held at zero, or a table of values.
    fn held_groups(
        &self,
        section: &mut TableSection,
        groups: &BoundaryGroups,
    ) -> Result<Option<SupportsByGroup>> {
        let Some(item) = section.take("dirichlet") else {
            return Ok(None);
        };
        let list: Result<SupportsByGroup> = match &item.value {
            Value::Text(text) if text == "none" => Ok(Vec::new()),
            Value::Text(_) => {
                let name = item.text("a boundary group")?;
                known(item, &name, groups)?;
                Ok(vec![(name, held())])
            }
            Value::List(items) => {
                let one = |item: &Item| {
                    let name = item.text("a boundary group")?;
                    known(item, &name, groups)?;
                    Ok((name, held()))
                };
                items.iter().map(one).collect()
            }
            _ => {
                let list = self.by_group(section, "dirichlet", groups)?;
                let one = |(name, item): (&str, &Item)| Ok((name.to_string(), self.given(item)?));
                list.into_iter().flatten().map(one).collect()
            }
        };
        list.map(Some)
    }
}

/// An error if no part of the body has a boundary group of this name.
fn known(item: &Item, name: &str, groups: &BoundaryGroups) -> Result<()> {
    if groups.names.contains(name) {
        return Ok(());
    }
    let list: Vec<String> = groups.names.iter().map(|n| format!("`{n}`")).collect();
    item.error(format!(
        "the boundary group `{name}`, which the body does not have (groups at it are {})",
        some(&list)
    ))
}

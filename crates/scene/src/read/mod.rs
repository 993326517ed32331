//! From TOML to a [`SceneSpec`]: keys, types and shapes.

mod cells;
mod conditions;
mod document;
mod fields;
mod form;
mod friction;
mod groups;
mod instances;
mod material;
mod mesh;
mod obstacles;
mod placements;
mod probes;
mod shape;
mod sides;
mod steps;
mod ties;
mod unused;
mod values;

use super::model::body::{BodySpec, Load, POISSON};
use super::model::grid::GridSpec;
use super::model::spec::SceneSpec;
use super::validate::MOST_BODIES;
use ::mesh::BoxMesh;
use base::{Error, ErrorKind, Result};
use document::{Item, TableSection, Value};
use elements::form::Form;
use fields::FieldSizes;
pub(super) use values::MOST as MOST_IN_A_ROW;
use values::MOST;

/// The scene in `text`; `file` names it in messages, which are one line whatever the texts are that they quote.
pub fn read(file: &str, text: &str) -> Result<SceneSpec> {
    spec(file, text).map_err(|error| match error.kind() {
        ErrorKind::Input => {
            error.retold(|message| base::location::on_one_line(message).into_owned())
        }
        _ => error,
    })
}

fn spec(file: &str, text: &str) -> Result<SceneSpec> {
    let root = document::parse(file, text)?;
    let mut scene = root.section("the scene")?;
    let reader = SceneReader::new(&mut scene)?;

    let title = match (scene.take("name"), scene.take("title")) {
        (_, Some(item)) | (Some(item), None) => item.text("a title")?,
        (None, None) => stem(file),
    };
    let mut source = scene.read("mesh", |item| mesh::SceneMesh::read(&reader, item))?;
    let grids = scene.each("grid", |item| Ok(reader.grid(item)?.expand()))?;
    let mut bodies = grids.concat();
    if let Some(source) = &mut source {
        let entries = [scene.tables("tie")?, scene.tables("contact")?];
        source.joints = ties::named_sides(entries.into_iter().flatten());
    }
    for item in scene.tables("body")? {
        match &mut source {
            Some(source) if mesh::SceneMesh::has(item) => {
                bodies.extend(reader.mesh_bodies(item, source)?)
            }
            _ => bodies.extend(reader.bodies_of(item, bodies.len())?),
        }
    }
    let default = scene.read("interface", |item| reader.interface(item))?;
    let ties = scene.each("tie", |item| reader.tie(item, &bodies))?;
    let (auto, contacts) = reader.contacts(&mut scene, &bodies)?;
    let obstacles = scene
        .each("obstacle", |item| {
            reader.obstacle(item, &bodies, source.as_mut())
        })?
        .concat();
    let probes = scene.each("probe", |item| reader.probe(item, &bodies))?;
    let steps = scene.read("steps", |item| reader.steps(item))?;
    let exact = scene.read("exact", |item| reader.components(item))?;
    let options = scene.read("options", options)?;
    scene.finish()?;
    if bodies.is_empty() {
        return Err(Error::input(format!(
            "{file}: the scene has no bodies ([[body]] or [grid] was expected)"
        )));
    }
    let entries = unused::SceneEntries {
        bodies: &bodies,
        ties: &ties,
        contacts: &contacts,
        obstacles: &obstacles,
    };
    let source = source.as_ref();
    let notes = source.map_or(Vec::new(), |source| unused::notes(source, &entries));
    let unnamed = source.and_then(|source| unused::unnamed(source, &entries));
    Ok(SceneSpec {
        title,
        form: reader.form,
        bodies,
        default: default.unwrap_or_default(),
        ties,
        contacts,
        equations: Vec::new(),
        auto,
        probes,
        obstacles,
        steps,
        exact,
        options: options.unwrap_or_default(),
        notes,
        asides: unnamed.into_iter().collect(),
    })
}

pub(super) fn stem(file: &str) -> String {
    std::path::Path::new(file)
        .file_stem()
        .map_or_else(|| file.to_string(), |s| s.to_string_lossy().into_owned())
}

/// PETSc options, with or without the leading dash.
fn options(item: &Item) -> Result<Vec<(String, String)>> {
    let option = |(key, _, item): &(String, usize, Item)| {
        let value = match &item.value {
            Value::Text(text) => text.clone(),
            Value::Integer(v) => v.to_string(),
            Value::Number(v) => format!("{v:e}"),
            Value::Truth(v) => v.to_string(),
            _ => return item.expected("a text, a number or a truth value"),
        };
        Ok((key.trim_start_matches('-').to_string(), value))
    };
    let section = item.section("[options]")?;
    section.entries.iter().map(option).collect()
}

/// The order of elements, 1 or 2.
fn order(item: &Item) -> Result<usize> {
    match item.value {
        Value::Integer(k @ (1 | 2)) => Ok(k as usize),
        _ => item.expected("1 or 2"),
    }
}

struct SceneReader {
    /// The order of the elements of boxes that say nothing else.
    order: usize,
    /// The dimension of the scene.
    dim: usize,
    /// The equation and its finite elements.
    form: Form,
}

impl SceneReader {
    /// A body or its copies; without a name it is called by its number.
    fn bodies_of(&self, item: &Item, number: usize) -> Result<Vec<BodySpec>> {
        let mut section = item.section("[[body]]")?;
        let name = section.read("name", |item| item.text("a name"))?;
        let name = name.unwrap_or_else(|| format!("body{number}"));
        let (body, shape) = self.box_of_elements(&mut section, item, name, None)?;
        let placements = section.read("instances", |item| self.placements(item))?;
        let only = section.tables("only")?;
        section.finish()?;
        match placements {
            Some(list) => self.copies(&body, &list, only, |section, body| {
                self.conditions_of_box(section, &shape, body)
            }),
            None if only.is_empty() => Ok(vec![body]),
            None => instances::none_to_select(only),
        }
    }

    fn grid(&self, item: &Item) -> Result<GridSpec> {
        let mut section = item.section("[grid]")?;
        let name = section.read("name", |item| item.text("a name"))?;
        let counts = section.need("bodies", "the number of bodies in x and y")?;
        let bodies = self.counts(counts, 1)?;
        let n = bodies.iter().fold(1_usize, |n, b| n.saturating_mul(*b));
        if n > MOST_BODIES {
            return counts.error(format!(
                "{n} bodies where at most {MOST_BODIES} were expected"
            ));
        }
        let name = name.unwrap_or_else(|| "b".into());
        let (whole, _) = self.box_of_elements(&mut section, item, name, Some(bodies))?;
        section.finish()?;
        Ok(GridSpec { bodies, whole })
    }

    /// The keys that a body has, and a grid of `bodies`.
    fn box_of_elements(
        &self,
        section: &mut TableSection,
        item: &Item,
        name: String,
        bodies: Option<[usize; 3]>,
    ) -> Result<(BodySpec, FieldSizes)> {
        let wanted = ["a point [x, y]", "a point [x, y, z]"][self.dim - 2];
        let origin = section.read("origin", |item| self.vector(item, wanted))?;
        let bent = section.take("shape");
        let size = match section.read("size", |item| self.size(item))? {
            Some(size) => size,
            // The unit box.
            None if bent.is_some() || bodies.is_some() => [1.0, 1.0, [0.0, 1.0][self.dim - 2]],
            None => self.size(section.need("size", "a width and a height")?)?,
        };
        let (elements, subdomains) = self.partition(section, item, &name, bodies.is_some())?;
        let mesh = BoxMesh {
            origin: origin.unwrap_or_default(),
            size,
            elements,
            subdomains,
        };
        let map = bent.map(|item| self.map(item, &mesh)).transpose()?;
        let shape = FieldSizes {
            mesh,
            bodies,
            of_cells: false,
        };
        let mut body = BodySpec::new(name, mesh);
        self.conditions_of_box(section, &shape, &mut body)?;
        body.order = section.read("order", order)?.unwrap_or(self.order);
        (body.map, body.location) = (map, item.location());
        Ok((body, shape))
    }

    /// Material, loads and given values of a box: each key that is there replaces what the body has.
    fn conditions_of_box(
        &self,
        section: &mut TableSection,
        shape: &FieldSizes,
        body: &mut BodySpec,
    ) -> Result<()> {
        self.material_and_load(section, shape, body)?;
        self.surface_loads(section, &mut body.surface)?;
        if let Some(springs) = self.springs(section)? {
            body.springs = springs;
        }
        if let Some(item) = section.take("dirichlet") {
            body.dirichlet = self.sides(item)?;
        }
        Ok(())
    }

    /// Material, load and ramp of a body: each key that is there replaces what the body has.
    fn material_and_load(
        &self,
        section: &mut TableSection,
        shape: &FieldSizes,
        body: &mut BodySpec,
    ) -> Result<()> {
        let elastic = self.form.is_elastic();
        if body.law.is_some() && section.entry("material").is_none() {
            let given = ["young", "poisson"].map(|key| section.entry(key));
            if let [Some(one), None] | [None, Some(one)] = given {
                return one.error(
                    "one of `young` and `poisson` in place of `material` (both were expected)",
                );
            }
        }
        if let Some(item) = section.take(if elastic { "young" } else { "rho" }) {
            body.rho = self.coefficient(item, shape, 1.0)?;
            body.law = None;
        }
        if let Some(item) = elastic.then(|| section.take("poisson")).flatten() {
            body.poisson = self.coefficient(item, shape, POISSON)?;
        }
        if let Some(item) = elastic.then(|| section.take("material")).flatten() {
            for key in ["young", "poisson"] {
                if let Some(other) = section.entry(key) {
                    return other.error(format!(
                        "`{key}` beside `material`, which has its constants"
                    ));
                }
            }
            self.material(item, body)?;
        }
        if elastic {
            self.heat(section, shape, body)?;
        }
        if let Some(item) = section.take("load") {
            let (fields, quadrature) = self.vector_field(item, shape)?;
            let quadrature = quadrature.unwrap_or_default();
            body.load = Load { fields, quadrature };
        }
        if let Some(ramp) = self.ramp(section)? {
            body.ramp = Some(ramp);
        }
        Ok(())
    }

    /// `elements` or `elements_per_subdomain`, and `subdomains`.
    fn partition(
        &self,
        section: &mut TableSection,
        item: &Item,
        name: &str,
        grid: bool,
    ) -> Result<([usize; 3], [usize; 3])> {
        let subdomains = section.read("subdomains", |item| self.counts(item, 1))?;
        let subdomains = subdomains.unwrap_or([1; 3]);
        let elements =
            match (
                section.take("elements"),
                section.take("elements_per_subdomain"),
            ) {
                (Some(item), None) => self.counts(item, 0)?,
                (None, Some(item)) => {
                    let each = self.counts(item, 0)?;
                    let elements = [0, 1, 2].map(|d| each[d] * subdomains[d]);
                    if let Some(n) = elements.iter().find(|n| **n > MOST) {
                        return item.error(format!("{n} elements in a row, more than {MOST}"));
                    }
                    elements
                }
                (Some(_), Some(item)) => return item.error(
                    "both `elements` and `elements_per_subdomain` are given where one was expected",
                ),
                (None, None) => {
                    let name = if grid {
                        "of the grid".into()
                    } else {
                        format!("`{name}`")
                    };
                    return item.error(format!(
                        "body {name} has no `elements` (or `elements_per_subdomain`)"
                    ));
                }
            };
        Ok((elements, subdomains))
    }
}

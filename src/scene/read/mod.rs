//! From TOML to a [`SceneSpec`]: keys, types and shapes.

mod cells;
pub(crate) mod document;
mod fields;
mod form;
mod shape;
mod sides;
mod steps;
mod ties;
mod values;

use super::model::field::{By, Field};
use super::model::spec::{
    free_all_round, BodySpec, ByDefault, GridSpec, Load, SceneSpec, Sides, SurfaceLoad, POISSON,
};
use super::validate::MOST_BODIES;
use crate::error::{Error, Result};
use crate::fem::Form;
use crate::mesh::BoxMesh;
use document::{Item, Section, Source, Value};
use fields::Shape;
use values::MOST;

/// The scene in `text`; `file` names it in messages.
pub(super) fn read(file: &str, text: &str) -> Result<SceneSpec> {
    let source = Source { file, text };
    let root = source.parse()?;
    let mut scene = Section::new(&source, "the scene", &root)?;
    let reader = Reader::new(&source, &mut scene)?;

    let title = match (scene.take("name"), scene.take("title")) {
        (_, Some(item)) | (Some(item), None) => reader.text(item, "a title")?,
        (None, None) => stem(file),
    };
    let mut bodies = Vec::new();
    for item in reader.tables(scene.take("grid"))? {
        bodies.extend(reader.grid(item)?.expand());
    }
    for item in reader.tables(scene.take("body"))? {
        bodies.push(reader.body(item, bodies.len())?);
    }
    let default = match scene.take("interface") {
        None => ByDefault::default(),
        Some(item) => reader.interface(item)?,
    };
    let mut ties = Vec::new();
    for item in reader.tables(scene.take("tie"))? {
        ties.push(reader.tie(item, &bodies)?);
    }
    let mut contacts = Vec::new();
    for item in reader.tables(scene.take("contact"))? {
        contacts.push(reader.contact(item, &bodies)?);
    }
    let mut obstacles = Vec::new();
    for item in reader.tables(scene.take("obstacle"))? {
        obstacles.push(reader.obstacle(item, &bodies)?);
    }
    let steps = match scene.take("steps") {
        None => None,
        Some(item) => Some(reader.steps(item)?),
    };
    let exact = match scene.take("exact") {
        None => None,
        Some(item) => Some(reader.exact(item)?),
    };
    let options = match scene.take("options") {
        None => Vec::new(),
        Some(item) => reader.options(item)?,
    };
    scene.finish()?;
    if bodies.is_empty() {
        return Err(Error::Input(format!(
            "{file}: the scene has no bodies ([[body]] or [grid] was expected)"
        )));
    }
    Ok(SceneSpec {
        title,
        form: reader.form,
        bodies,
        default,
        ties,
        contacts,
        obstacles,
        steps,
        exact,
        options,
    })
}

fn stem(file: &str) -> String {
    std::path::Path::new(file)
        .file_stem()
        .map_or_else(|| file.to_string(), |s| s.to_string_lossy().into_owned())
}

struct Reader<'a> {
    source: &'a Source<'a>,
    /// The dimension of the scene.
    dim: usize,
    /// The equation and its finite elements.
    form: Form,
}

/// Data that bodies and grids have in common.
struct Data {
    rho: Field,
    poisson: Field,
    load: Load,
    surface: Vec<SurfaceLoad>,
    springs: Vec<(usize, Field)>,
    dirichlet: Sides,
}

impl<'a> Reader<'a> {
    fn body(&self, item: &'a Item, index: usize) -> Result<BodySpec> {
        let mut section = Section::new(self.source, "[[body]]", item)?;
        let name = match section.take("name") {
            Some(item) => self.text(item, "a name")?,
            None => format!("body{index}"),
        };
        let origin = self.origin(&mut section)?;
        let bent = section.take("shape");
        let size = match (section.take("size"), bent) {
            (Some(item), _) => self.size(item)?,
            (None, Some(_)) => self.unit(),
            (None, None) => self.size(section.need("size", "a width and a height")?)?,
        };
        let (elements, subdomains) = self.partition(&mut section, item, &name)?;
        let mut body = BodySpec::new(
            name,
            BoxMesh {
                origin,
                size,
                elements,
                subdomains,
            },
        );
        body.map = bent.map(|item| self.map(item, origin, size)).transpose()?;
        body.written = self.written(item);
        let shape = Shape {
            bare: By::Subdomain,
            bodies: None,
            elements,
            subdomains,
        };
        let data = self.data(&mut section, &shape)?;
        body.ramp = self.ramp(&mut section)?;
        (body.rho, body.poisson) = (data.rho, data.poisson);
        (body.load, body.surface, body.dirichlet) = (data.load, data.surface, data.dirichlet);
        body.springs = data.springs;
        section.finish()?;
        Ok(body)
    }

    fn grid(&self, item: &'a Item) -> Result<GridSpec> {
        let mut section = Section::new(self.source, "[grid]", item)?;
        let name = match section.take("name") {
            Some(item) => self.text(item, "a name")?,
            None => "b".into(),
        };
        let counts = section.need("bodies", "the number of bodies in x and y")?;
        let bodies = self.counts(counts, 1)?;
        let n = bodies.iter().fold(1_usize, |n, b| n.saturating_mul(*b));
        if n > MOST_BODIES {
            return self.error(
                counts,
                format_args!("{n} bodies where at most {MOST_BODIES} were expected"),
            );
        }
        let origin = self.origin(&mut section)?;
        let size = match section.take("size") {
            Some(item) => self.size(item)?,
            None => self.unit(),
        };
        let bent = section.take("shape");
        let map = bent.map(|item| self.map(item, origin, size)).transpose()?;
        let (elements, subdomains) = self.partition(&mut section, item, "of the grid")?;
        let shape = Shape {
            bare: By::Body,
            bodies: Some(bodies),
            elements,
            subdomains,
        };
        let data = self.data(&mut section, &shape)?;
        let ramp = self.ramp(&mut section)?;
        section.finish()?;
        Ok(GridSpec {
            name,
            bodies,
            origin,
            size,
            map,
            elements,
            subdomains,
            rho: data.rho,
            poisson: data.poisson,
            load: data.load,
            surface: data.surface,
            springs: data.springs,
            ramp,
            dirichlet: data.dirichlet,
            written: self.written(item),
        })
    }

    /// `elements` or `elements_per_subdomain`, and `subdomains`.
    fn partition(
        &self,
        section: &mut Section<'a>,
        item: &Item,
        name: &str,
    ) -> Result<([usize; 3], [usize; 3])> {
        let subdomains = match section.take("subdomains") {
            Some(item) => self.counts(item, 1)?,
            None => [1; 3],
        };
        match (
            section.take("elements"),
            section.take("elements_per_subdomain"),
        ) {
            (Some(item), None) => Ok((self.counts(item, 0)?, subdomains)),
            (None, Some(item)) => {
                let each = self.counts(item, 0)?;
                let elements = [0, 1, 2].map(|d| each[d] * subdomains[d]);
                match elements.iter().find(|n| **n > MOST) {
                    None => Ok((elements, subdomains)),
                    Some(n) => self.error(
                        item,
                        format_args!("{n} elements in a row, more than {MOST}"),
                    ),
                }
            }
            (Some(_), Some(item)) => self.error(
                item,
                "both `elements` and `elements_per_subdomain` are given where one was expected",
            ),
            (None, None) => self.error(
                item,
                format_args!(
                    "body {name} has no `elements` (or `elements_per_subdomain`)",
                    name = if name == "of the grid" {
                        name.into()
                    } else {
                        format!("`{name}`")
                    }
                ),
            ),
        }
    }

    /// Coefficients, loads and Dirichlet conditions.
    fn data(&self, section: &mut Section<'a>, shape: &Shape) -> Result<Data> {
        let elastic = self.form.is_elastic();
        let key = if elastic { "young" } else { "rho" };
        let rho = match section.take(key) {
            Some(item) => self.coefficient(item, shape, 1.0)?,
            None => Field::constant(1.0),
        };
        let given = if elastic {
            section.take("poisson")
        } else {
            None
        };
        let poisson = match given {
            Some(item) => self.coefficient(item, shape, POISSON)?,
            None => Field::constant(POISSON),
        };
        let load = match section.take("load") {
            Some(item) => {
                let (fields, quadrature) = self.vector_field(item, shape)?;
                Load {
                    fields,
                    quadrature: quadrature.unwrap_or_default(),
                }
            }
            None => Load::constant(0.0),
        };
        Ok(Data {
            rho,
            poisson,
            load,
            surface: self.surface_loads(section)?,
            springs: self.springs(section)?,
            dirichlet: match section.take("dirichlet") {
                Some(item) => self.sides(item)?,
                None => free_all_round(),
            },
        })
    }

    /// PETSc options, with or without the leading dash.
    fn options(&self, item: &'a Item) -> Result<Vec<(String, String)>> {
        let section = Section::new(self.source, "[options]", item)?;
        let mut out = Vec::new();
        for (key, _, item) in section.entries() {
            let value = match &item.value {
                Value::Text(text) => text.clone(),
                Value::Integer(v) => v.to_string(),
                Value::Number(v) => format!("{v:e}"),
                Value::Truth(v) => v.to_string(),
                _ => return self.expected(item, "a text, a number or a truth value"),
            };
            out.push((key.trim_start_matches('-').to_string(), value));
        }
        Ok(out)
    }
}

//! [mesh], and bodies that are groups of its cells.

use super::document::{Item, Section, Value};
use super::fields::Shape;
use super::Reader;
use crate::error::{Error, Result};
use crate::mesh::{deck, defects, gmsh, BoxMesh, CellMesh, Extractor, Members, MeshFile};
use crate::scene::model::field::Field;
use crate::scene::model::rigid_surface::RigidSurface;
use crate::scene::model::spec::{held, BodySpec, Cut, Force, Load, Sides, SurfaceLoad, POISSON};
use std::collections::{BTreeSet, HashMap, HashSet};
use std::path::{Path, PathBuf};

/// The mesh of a scene.
pub(super) struct Source {
    mesh: Extractor<MeshFile>,
    /// The groups of cells of the scene's dimension: their places in the list of groups. Of equal names the first.
    groups: HashMap<String, usize>,
    /// The factor of all lengths.
    scale: f64,
    /// The names of groups that are rigid surfaces.
    rigid: Vec<String>,
}

/// The keys that only boxes have.
const OF_BOXES: [&str; 6] = [
    "elements",
    "elements_per_subdomain",
    "size",
    "origin",
    "shape",
    "order",
];

impl Source {
    /// Reads `[mesh]` and its file, which is relative to the scene's own directory.
    pub fn read(reader: &Reader, item: &Item) -> Result<Source> {
        let mut section = item.section("[mesh]")?;
        let file = section.need("file", "the name of a file")?;
        let scale = section.read("scale", |item| reader.positive(item))?;
        section.finish()?;
        let mesh = load_beside(file)?;
        let mut groups = HashMap::new();
        for (k, group) in mesh.groups.iter().enumerate() {
            if matches!(group.members, Members::Cells { dim, .. } if dim == reader.dim) {
                groups.entry(group.name.clone()).or_insert(k);
            }
        }
        Ok(Source {
            mesh: Extractor::new(mesh, reader.dim),
            groups,
            scale: scale.unwrap_or(1.0),
            rigid: Vec::new(),
        })
    }

    /// A sentence on nodes that are left out.
    pub fn note(&self) -> Option<String> {
        self.mesh.file().unused(self.mesh.dim(), &self.rigid)
    }

    /// The group of faces `name` as a rigid surface.
    pub fn surface(&mut self, name: &str, reverse: bool) -> Result<RigidSurface> {
        let (file, dim) = (self.mesh.file(), self.mesh.dim());
        let surface = RigidSurface::of_file(file, dim, name, self.scale, reverse)?;
        self.rigid.push(name.into());
        Ok(surface)
    }

    /// Whether a body is a group of this mesh, not a box.
    pub fn has(item: &Item) -> bool {
        let Ok(section) = item.section("[[body]]") else {
            return false;
        };
        !OF_BOXES.iter().any(|key| section.entry(key).is_some())
    }

    /// The connected parts of a group of cells: one mesh each.
    fn parts(&mut self, item: &Item, name: &str) -> Result<Vec<CellMesh>> {
        let cells = self.group(item, name)?;
        let parts = self.mesh.connected(&cells);
        let mesh = |part: &Vec<u32>| {
            let mesh = self.mesh.extract(part, self.scale)?;
            // The plane of a plane scene is z = 0.
            match mesh
                .points
                .iter()
                .zip(&mesh.node_ids)
                .find(|(p, _)| mesh.dim == 2 && p[2] != 0.0)
            {
                Some((point, id)) => item.error(format!(
                    "node {id} of {} has z = {} where 0 was expected in a plane scene",
                    self.mesh.file().name,
                    point[2]
                )),
                None => Ok(mesh),
            }
        };
        parts.iter().map(mesh).collect()
    }

    /// The cells of the group `name` of the scene's dimension.
    fn group(&self, item: &Item, name: &str) -> Result<Vec<u32>> {
        let (file, of_scene) = (self.mesh.file(), self.mesh.dim());
        if let Some(&k) = self.groups.get(name) {
            if let Members::Cells { cells, .. } = &file.groups[k].members {
                return Ok(cells.clone());
            }
        }
        let mut others = Vec::new();
        let mut lower = None;
        for group in &file.groups {
            let dim = match &group.members {
                Members::Cells { dim, .. } if *dim == of_scene => {
                    others.push(format!("`{}`", group.name));
                    continue;
                }
                Members::Cells { dim, .. } => format!("of dimension {dim}"),
                Members::Nodes(_) => "of nodes".into(),
                Members::Sides(_) => "of sides".into(),
            };
            if group.name == name {
                lower = Some(dim);
            }
        }
        let all = 0..file.cells.len() as u32;
        let all = all.filter(|&c| file.cells.kind(c as usize).dim() == of_scene);
        let all: Vec<u32> = all.collect();
        let file = &file.name;
        if let Some(dim) = lower {
            return item.error(format!(
                "the group `{name}` of {file} is {dim} where cells of dimension {of_scene} were expected"
            ));
        }
        match (others.is_empty(), all.is_empty()) {
            // A mesh without groups is one body, whatever its name.
            (true, false) => Ok(all),
            (true, true) => item.error(format!("{file} has no cells of dimension {of_scene}")),
            (false, _) => item.error(format!(
                "{file} has no group `{name}` of cells of dimension {of_scene} (groups are {})",
                some(&others)
            )),
        }
    }
}

/// The first few of some names.
fn some(names: &[String]) -> String {
    let more = if names.len() > 12 { ", …" } else { "" };
    format!("{}{more}", names[..names.len().min(12)].join(", "))
}

/// Reads the mesh that an item names, beside the scene.
pub(super) fn load_beside(file: &Item) -> Result<MeshFile> {
    let path = PathBuf::from(file.text("the name of a file")?);
    let directory = Path::new(file.file).parent();
    let path = directory.map_or(path.clone(), |directory| directory.join(path));
    load(&path).or_else(|e| match e {
        Error::Input(message) => file.error(message),
        other => Err(other),
    })
}

/// Reads a mesh, by the ending of its name.
pub(crate) fn load(path: &Path) -> Result<MeshFile> {
    let name = path.display().to_string();
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    match ending.as_deref() {
        Some("msh") => gmsh::load(path),
        Some("inp") => {
            let read = |file: &Path| {
                let name = file.display();
                std::fs::read(file).map_err(|e| Error::Input(format!("{name}: the deck cannot be read: {e}")))
            };
            let directory = path.parent().unwrap_or(Path::new(""));
            deck::read_mesh(&name, &read(path)?, &|file| read(&directory.join(file)))
        }
        _ => Err(Error::Input(format!(
            "{name}: a mesh of Gmsh (.msh) or of Abaqus or CalculiX (.inp) was expected (meshio converts many others)"
        ))),
    }
}

impl Reader {
    /// The bodies of a group of cells: one for each connected part. Parts after the first are numbered.
    pub(super) fn mesh_bodies(&self, item: &Item, source: &mut Source) -> Result<Vec<BodySpec>> {
        let mut section = item.section("[[body]]")?;
        let name = section.need("name", "the name of a group of cells")?;
        let name = name.text("the name of a group of cells")?;
        let cut = section.read("subdomains", |item| match item.is("auto") {
            true => Ok(Cut::Auto),
            false => Ok(Cut::Into(
                item.count("\"auto\" or a positive whole number")?,
            )),
        })?;
        let parts = source.parts(item, &name)?;
        let several = parts.len() > 1;
        let mut names = BTreeSet::new();
        for part in &parts {
            names.extend(part.sides.iter().map(|side| side.name.clone()));
        }
        let shape = Shape {
            mesh: BoxMesh::plane([0.0; 2], [1.0; 2], [1; 2], [1; 2]),
            bodies: None,
            of_cells: true,
        };
        let mut common = BodySpec::new(name.clone(), shape.mesh);
        let elastic = self.form.is_elastic();
        if let Some(item) = section.take(if elastic { "young" } else { "rho" }) {
            common.rho = self.coefficient(item, &shape, 1.0)?;
        }
        if let Some(item) = elastic.then(|| section.take("poisson")).flatten() {
            common.poisson = self.coefficient(item, &shape, POISSON)?;
        }
        if let Some(item) = section.take("load") {
            let (fields, quadrature) = self.vector_field(item, &shape)?;
            let quadrature = quadrature.unwrap_or_default();
            common.load = Load { fields, quadrature };
        }
        let keys: &[&'static str] = match elastic {
            true => &["traction", "pressure"],
            false => &["flux"],
        };
        let mut forces = Vec::new();
        for &key in keys {
            for (name, item) in self.by_group(&mut section, key, &names)? {
                let force = match key {
                    "pressure" => Force::Pressure(self.formula(item)?),
                    _ => {
                        let list = self.components(item)?.into_iter();
                        Force::Traction(list.map(Field::Expression).collect())
                    }
                };
                forces.push((name, force));
            }
        }
        let mut springs = Vec::new();
        for (name, item) in self.by_group(&mut section, "spring", &names)? {
            springs.push((name, self.formula(item)?));
        }
        let dirichlet = self.held_groups(&mut section, &names)?;
        common.ramp = self.ramp(&mut section)?;
        common.written = item.written();
        common.cut = cut.unwrap_or(Cut::Auto);
        section.finish()?;

        let body = |(k, mesh): (usize, CellMesh)| {
            let side = |name: &str| mesh.sides.iter().position(|s| s.name == name);
            let mut body = common.clone();
            if several {
                body.name = format!("{name}.{}", k + 1);
            }
            if let Some(defect) = defects(&mesh, &HashSet::new()).first() {
                let (name, first, expected) = (&body.name, &defect.first, defect.expected);
                return item.error(format!("body `{name}`: {first} ({expected})"));
            }
            for (name, force) in &forces {
                let force = force.clone();
                body.surface
                    .extend(side(name).map(|side| SurfaceLoad { side, force }));
            }
            for (name, stiffness) in &springs {
                body.springs
                    .extend(side(name).map(|side| (side, stiffness.clone())));
            }
            let mut sides: Sides = vec![[const { None }; 3]; mesh.sides.len()];
            for (name, given) in &dirichlet {
                if let Some(side) = side(name) {
                    sides[side] = given.clone();
                }
            }
            body.dirichlet = sides;
            body.mesh = mesh.into();
            Ok(body)
        };
        parts.into_iter().enumerate().map(body).collect()
    }

    /// The entries of a table whose keys are boundary groups.
    fn by_group<'a>(
        &self,
        section: &mut Section<'a>,
        key: &'static str,
        names: &BTreeSet<String>,
    ) -> Result<Vec<(&'a str, &'a Item<'a>)>> {
        let Some(item) = section.take(key) else {
            return Ok(Vec::new());
        };
        let table = item.section(key)?;
        let entry = |(name, _, item): &'a (String, usize, Item<'a>)| {
            known(item, name, names)?;
            Ok((name.as_str(), item))
        };
        table.entries.iter().map(entry).collect()
    }

    /// `dirichlet`: "all", "none", a list of groups held at zero, or a table of values.
    fn held_groups(
        &self,
        section: &mut Section,
        names: &BTreeSet<String>,
    ) -> Result<Vec<(String, [Option<Field>; 3])>> {
        let Some(item) = section.entry("dirichlet") else {
            section.take("dirichlet");
            return Ok(Vec::new());
        };
        match &item.value {
            Value::Text(text) if text == "none" => {
                section.take("dirichlet");
                Ok(Vec::new())
            }
            Value::Text(_) => {
                section.take("dirichlet");
                let name = item.text("a boundary group")?;
                known(item, &name, names)?;
                Ok(vec![(name, held())])
            }
            Value::List(items) => {
                section.take("dirichlet");
                let one = |item: &Item| {
                    let name = item.text("a boundary group")?;
                    known(item, &name, names)?;
                    Ok((name, held()))
                };
                items.iter().map(one).collect()
            }
            _ => {
                let list = self.by_group(section, "dirichlet", names)?;
                let one = |(name, item): (&str, &Item)| Ok((name.to_string(), self.given(item)?));
                list.into_iter().map(one).collect()
            }
        }
    }
}

/// An error if no part of the body has a boundary group of this name.
fn known(item: &Item, name: &str, names: &BTreeSet<String>) -> Result<()> {
    if names.contains(name) {
        return Ok(());
    }
    let list: Vec<String> = names.iter().map(|n| format!("`{n}`")).collect();
    item.error(format!(
        "the boundary group `{name}`, which the body does not have (groups at it are {})",
        some(&list)
    ))
}

//! [mesh], and bodies that are groups of its cells.

use super::conditions::BoundaryGroups;
use super::document::Item;
use super::fields::FieldSizes;
use super::form::{integration, rules};
use super::groups::some;
use super::instances::none_to_select;
use super::SceneReader;
use crate::model::body::{BodySpec, Cut};
use crate::model::rigid_surface::RigidSurface;
use crate::quantity::unfit_size;
use base::{Error, ErrorKind, Result};
use mesh::{bytes, defects, gmsh, of_both_sides, BoxMesh, CellMesh, Extractor, Members, MeshFile};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// The mesh of a scene.
pub(super) struct SceneMesh {
    mesh: Extractor<MeshFile>,
    /// The groups of cells of the scene's dimension: their places in the list of groups. Of equal names the first.
    groups: HashMap<String, usize>,
    /// The factor of all lengths.
    scale: f64,
    /// The names of groups that are rigid surfaces.
    pub(super) rigid: Vec<String>,
    /// The names of groups that are bodies.
    pub(super) bodies: Vec<String>,
    /// The cells that belong to bodies.
    pub(super) taken: Vec<bool>,
    /// The pairs of groups that entries of [[tie]] and [[contact]] name.
    pub joints: Vec<[String; 2]>,
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

impl SceneMesh {
    /// Reads `[mesh]` and its file, which is relative to the scene's own directory.
    pub fn read(reader: &SceneReader, item: &Item) -> Result<SceneMesh> {
        let mut section = item.section("[mesh]")?;
        let file = section.need("file", "the name of a file")?;
        let mesh = load_beside(file)?.counter_clockwise(reader.dim);
        let scale = section.read("scale", |item| reader.positive(item))?;
        section.finish()?;
        let mut groups = HashMap::new();
        for (k, group) in mesh.groups.iter().enumerate() {
            if matches!(group.members, Members::Cells { dim, .. } if dim == reader.dim) {
                groups.entry(group.name.clone()).or_insert(k);
            }
        }
        Ok(SceneMesh {
            taken: vec![false; mesh.cells.len()],
            mesh: Extractor::new(mesh, reader.dim),
            groups,
            scale: scale.unwrap_or(1.0),
            rigid: Vec::new(),
            bodies: Vec::new(),
            joints: Vec::new(),
        })
    }

    /// The file.
    pub fn file(&self) -> &MeshFile {
        self.mesh.file()
    }

    /// The dimension of the cells of bodies.
    pub fn dim(&self) -> usize {
        self.mesh.dim()
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
        self.bodies.push(name.into());
        cells.iter().for_each(|&c| self.taken[c as usize] = true);
        let parts = self.mesh.connected(&cells);
        let mesh = |part: &Vec<u32>| {
            let mesh = self.mesh.extract(part, self.scale)?;
            if let Some((size, expected)) = unfit_size(&mesh.points) {
                return item.error(format!(
                    "cells of {} reach {size:e} from the origin where {expected} was expected (take another `scale`)",
                    self.mesh.file().name
                ));
            }
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

/// Reads the mesh that an item names, beside the scene.
pub(super) fn load_beside(file: &Item) -> Result<MeshFile> {
    let path = PathBuf::from(file.text("the name of a file")?);
    let directory = Path::new(file.file).parent();
    let path = directory.map_or(path.clone(), |directory| directory.join(path));
    load(&path).map_err(|error| match error.kind() {
        ErrorKind::Input => error.within(file.location()),
        _ => error,
    })
}

/// Reads a mesh, by the ending of its name.
pub(crate) fn load(path: &Path) -> Result<MeshFile> {
    let name = path.display().to_string();
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    match ending.as_deref() {
        // Gmsh writes name.msh, and name.msh2 or name.msh41 where it is told the format.
        Some(e) if e.trim_end_matches(|c: char| c.is_ascii_digit()) == "msh" => gmsh::load(path),
        Some("inp") => {
            let read = |file: &Path| bytes(file, "deck");
            let directory = path.parent().unwrap_or(Path::new(""));
            deck::read_mesh(&name, &read(path)?, &|file| read(&directory.join(file)))
        }
        _ => Err(Error::input(format!(
            "{name}: a mesh of Gmsh (.msh) or of Abaqus or CalculiX (.inp) was expected (meshio converts many others)"
        ))),
    }
}

impl SceneReader {
    /// The bodies of a group of cells: one for each connected part. Parts after the first are numbered.
    pub(super) fn mesh_bodies(&self, item: &Item, source: &mut SceneMesh) -> Result<Vec<BodySpec>> {
        let mut section = item.section("[[body]]")?;
        let name = section.need("name", "the name of a group of cells")?;
        let name = name.text("the name of a group of cells")?;
        let cut = section.read("subdomains", |item| {
            if item.is("auto") {
                Ok(Cut::Auto)
            } else {
                Ok(Cut::Into(
                    item.count("\"auto\" or a positive whole number")?,
                ))
            }
        })?;
        let rule = section.read("integration", integration)?;
        let parts = source.parts(item, &name)?;
        let several = parts.len() > 1;
        let groups = BoundaryGroups::of(&parts);
        let shape = FieldSizes {
            mesh: BoxMesh::plane([0.0; 2], [1.0; 2], [1; 2], [1; 2]),
            bodies: None,
            of_cells: true,
        };
        let mut common = BodySpec::new(name.clone(), shape.mesh);
        self.material_and_load(&mut section, &shape, &mut common)?;
        let conditions = self.conditions_of_mesh(&mut section, &groups)?;
        common.location = item.location();
        common.cut = cut.unwrap_or(Cut::Auto);
        let placements = section.read("instances", |item| self.placements(item))?;
        let only = section.tables("only")?;
        section.finish()?;
        if placements.is_none() && !only.is_empty() {
            return none_to_select(only);
        }

        let mut out = Vec::new();
        for (k, mesh) in parts.into_iter().enumerate() {
            let mut body = common.clone();
            if several {
                body.name = format!("{name}.{}", k + 1);
            }
            let joints = source.joints.iter().map(|j| [&j[0][..], &j[1][..]]);
            let joined = of_both_sides(&mesh, joints);
            if let Some(defect) = defects(&mesh, &joined).first() {
                let (name, first, expected) = (&body.name, &defect.first, defect.expected);
                return item.error(format!("body `{name}`: {first} ({expected})"));
            }
            body.integration = rules(rule, &mesh);
            body.mesh = mesh.into();
            body.dirichlet = vec![[const { None }; 3]; body.mesh.n_sides()].into();
            conditions.apply(&mut body);
            let Some(placements) = &placements else {
                out.push(body);
                continue;
            };
            let copies = self.copies(&body, placements, only, |section, body| {
                self.material_and_load(section, &shape, body)?;
                self.conditions_of_mesh(section, &groups)?.apply(body);
                Ok(())
            })?;
            out.extend(
                copies
                    .into_iter()
                    .zip(placements)
                    .map(|(mut copy, placement)| {
                        if let (true, Some(name)) = (several, &placement.name) {
                            copy.name = format!("{name}.{}", k + 1);
                        }
                        copy
                    }),
            );
        }
        Ok(out)
    }
}

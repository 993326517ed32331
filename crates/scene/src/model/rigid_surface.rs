//! A rigid obstacle that is a surface of a mesh: faces that belong to no body.

use std::collections::HashMap;
use std::sync::Arc;

use base::linalg::vec3::{minus, norm};
use base::{Error, Result};
use elements::kind::CellKind;
use elements::mortar::{self, MortarFace, MortarSide};
use mesh::{Members, MeshFile};

/// A rigid surface. The normals of its faces point to the side that is free.
#[derive(Debug, Clone, PartialEq)]
pub struct RigidSurface {
    /// The name of its group.
    pub name: String,
    pub(crate) side: Arc<MortarSide>,
}

/// A face of a file: its number there for messages, its kind and its points in the file.
type FileFace = (u64, CellKind, Vec<u32>);

impl RigidSurface {
    /// The group `name` of a file in a scene of dimension `dim`. Lengths are multiplied by `scale`; `reverse` turns the
    /// normals around.
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) where there is no such group, where it has no faces, and where the
    /// normals of two neighbours point to different sides.
    pub fn of_file(
        file: &MeshFile,
        dim: usize,
        name: &str,
        scale: f64,
        reverse: bool,
    ) -> Result<RigidSurface> {
        let mut faces = faces(file, dim, name)?;
        check_normals(file, name, &faces)?;
        if reverse {
            for (_, kind, nodes) in &mut faces {
                *nodes = mortar::reversed(*kind, nodes);
            }
        }
        let mut places: HashMap<u32, u32> = HashMap::new();
        let mut points = Vec::new();
        let mut own = |k: u32| {
            *places.entry(k).or_insert_with(|| {
                points.push(file.points[k as usize].map(|x| scale * x));
                points.len() as u32 - 1
            })
        };
        let faces = faces.into_iter().map(|(_, kind, nodes)| MortarFace {
            kind,
            nodes: nodes.into_iter().map(&mut own).collect(),
        });
        let faces = faces.collect();
        if let Some(x) = points.iter().find(|x| dim == 2 && x[2] != 0.0) {
            return Err(Error::input(format!(
                "the surface `{name}` of {} has a node at z = {} where 0 was expected in a plane scene",
                file.name, x[2]
            )));
        }
        Ok(RigidSurface {
            name: name.into(),
            side: Arc::new(MortarSide::new(dim, points, faces)),
        })
    }

    /// This surface with its normals reversed.
    pub(crate) fn reversed(&self) -> RigidSurface {
        RigidSurface {
            name: self.name.clone(),
            side: Arc::new(self.side.reversed()),
        }
    }

    /// The length of the diagonal of its box.
    pub(crate) fn size(&self) -> f64 {
        let [low, high] = self.bounds();
        norm(minus(high, low))
    }

    /// The lowest and the highest corner of its box.
    pub(crate) fn bounds(&self) -> [[f64; 3]; 2] {
        let start = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        self.side.points().iter().fold(start, |[low, high], x| {
            [
                [0, 1, 2].map(|d| low[d].min(x[d])),
                [0, 1, 2].map(|d| high[d].max(x[d])),
            ]
        })
    }
}

/// The faces of the group `name`.
fn faces(file: &MeshFile, dim: usize, name: &str) -> Result<Vec<FileFace>> {
    let found = file.groups.iter().filter(|g| g.name == name);
    let found: Vec<&Members> = found.map(|g| &g.members).collect();
    let (wanted, what) = match dim {
        2 => ("edges", "an edge"),
        _ => ("faces", "a face"),
    };
    for members in &found {
        match members {
            Members::Cells { dim: of, cells } if of + 1 == dim => {
                let face = |&c: &u32| {
                    let c = c as usize;
                    let (id, kind) = (file.cell_ids[c], file.cells.kind(c));
                    (id, kind, file.cells.nodes(c).to_vec())
                };
                return Ok(cells.iter().map(face).collect());
            }
            Members::Sides(list) if !list.is_empty() => {
                let face = |&(c, side): &(u32, u8)| {
                    let (c, place) = (c as usize, usize::from(side));
                    let kind = file.cells.kind(c).sides()[place].kind;
                    (
                        file.cell_ids[c],
                        kind,
                        file.cells.side_nodes(c, place).collect(),
                    )
                };
                let out: Vec<FileFace> = list.iter().map(face).collect();
                if out.iter().all(|(_, kind, _)| kind.dim() + 1 == dim) {
                    return Ok(out);
                }
            }
            _ => {}
        }
    }
    let kind = match found.first() {
        Some(Members::Cells { dim, .. }) => format!("has cells of dimension {dim}"),
        Some(Members::Nodes(_)) => "is a set of nodes".into(),
        Some(Members::Sides(_)) => "has sides of another dimension".into(),
        None => {
            let is_surface = |m: &Members| match m {
                Members::Cells { dim: of, .. } => of + 1 == dim,
                Members::Sides(_) => true,
                Members::Nodes(_) => false,
            };
            let names = file.groups.iter().filter(|g| is_surface(&g.members));
            let names: Vec<String> = names.take(12).map(|g| format!("`{}`", g.name)).collect();
            let list = if names.is_empty() {
                format!("there is no group of {wanted}")
            } else {
                format!("groups of {wanted} are {}", names.join(", "))
            };
            return Err(Error::input(format!(
                "{} has no group `{name}` ({list})",
                file.name
            )));
        }
    };
    Err(Error::input(format!(
        "the group `{name}` of {} {kind} where {wanted} were expected: {what} is a part of a rigid surface",
        file.name
    )))
}

/// An error where two faces that share an edge (in the plane a node) have normals to different sides.
fn check_normals(file: &MeshFile, name: &str, faces: &[FileFace]) -> Result<()> {
    let fail = |a: u64, b: u64| {
        Err(Error::input(format!(
            "the normals of the neighbours {a} and {b} of the surface `{name}` of {} point to different sides (one \
             side was expected, that which is free)",
            file.name
        )))
    };
    // A way along an edge and the face that has it; in the plane from a segment's first to its second end.
    let mut ways: HashMap<[u32; 2], u64> = HashMap::new();
    for (id, kind, nodes) in faces {
        let corners = &nodes[..kind.corners()];
        let n = corners.len();
        let own: Vec<[u32; 2]> = match n {
            2 => vec![[corners[0], u32::MAX], [u32::MAX, corners[1]]],
            _ => (0..n).map(|k| [corners[k], corners[(k + 1) % n]]).collect(),
        };
        for way in own {
            if let Some(other) = ways.insert(way, *id) {
                return fail(other, *id);
            }
        }
    }
    Ok(())
}

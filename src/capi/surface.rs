//! Surfaces of bodies that the host gives by the places of their nodes and by faces, each rank the faces that it has.
//!
//! All ranks see the whole surface, with nodes and faces in an order that depends on places alone: so the rows that
//! follow are the same at any number of ranks.

use std::collections::{BTreeMap, BTreeSet};

use super::numbering::HostNumbering;
use crate::Result;
use base::linalg::sorted::distinct;
use base::linalg::vec3::{minus, norm};
use base::Fault;
use elements::mortar::{one_way, MortarFace, MortarSide};
use parallel::exchange::gather_all;
use parallel::parcels::Parcels;
use petsc::{PetscInt, Session};

/// Places of one node that differ by more than this part of the coordinates are different places.
const SAME: f64 = 1e-9;

/// The data that one rank gives of a surface.
pub struct GivenSurface<'a> {
    /// The matrix whose unknowns `dofs` lists; negative: numbers among all unknowns.
    pub matrix: PetscInt,
    pub dim: PetscInt,
    /// Unknowns of a node.
    pub components: PetscInt,
    /// The unknowns of each node; a negative one is no unknown but a displacement of zero.
    pub dofs: &'a [PetscInt],
    pub coords: &'a [f64],
    /// The start of each face in `nodes`.
    pub start: &'a [PetscInt],
    /// Nodes of the faces, as places in the list of this rank's nodes.
    pub nodes: &'a [PetscInt],
}

/// The number of unknowns of a matrix.
pub type SizeOf<'a> = &'a dyn Fn(usize) -> Result<usize>;

/// A surface, on all ranks.
pub struct HostSurface {
    pub numbering: HostNumbering,
    pub components: usize,
    pub side: MortarSide,
    /// The unknowns of each node of `side`.
    pub dofs: Vec<Vec<PetscInt>>,
    /// The node of `side` for each node that this rank gave; `None` for one in none of its faces.
    pub mine: Vec<Option<u32>>,
    /// The lowest rank that gave each node.
    pub giver: Vec<usize>,
}

impl GivenSurface<'_> {
    /// # Errors
    /// What makes no surface.
    fn check(&self, rank: usize, number: usize, size: SizeOf<'_>) -> Result<HostNumbering> {
        let whose = || format!("surface {number}, as rank {rank} gives it,");
        let dim = self.dim as usize;
        if self.dim != 2 && self.dim != 3 {
            return Err(Fault::OutOfRange.error(format!(
                "surface {number} is of dimension {}, expected 2 or 3",
                self.dim
            )));
        }
        if self.components != 1 && self.components != self.dim {
            return Err(Fault::OutOfRange.error(format!(
                "surface {number} has {} unknowns in a node, expected 1 or the dimension {dim}",
                self.components
            )));
        }
        let (numbering, known) = match usize::try_from(self.matrix) {
            Err(_) => (HostNumbering::All, None),
            Ok(k) => (HostNumbering::Matrix(k), Some(size(k)?)),
        };
        let beyond = |d: &&PetscInt| **d >= 0 && known.is_some_and(|n| **d as usize >= n);
        if let (Some(dof), Some(n)) = (self.dofs.iter().find(beyond), known) {
            return Err(Fault::OutOfRange.error(format!(
                "{} has unknown {dof}, expected numbers below {n}, those of matrix {}",
                whose(),
                self.matrix
            )));
        }
        if let Some(x) = self.coords.iter().find(|x| !x.is_finite()) {
            return Err(Fault::Wrong.error(format!(
                "{} has a node with the coordinate {x}, expected a finite number",
                whose()
            )));
        }
        let n = self.coords.len() / dim;
        for (f, range) in self.start.windows(2).enumerate() {
            let list = &self.nodes[range[0] as usize..range[1] as usize];
            let Some(kind) = MortarFace::kind_of(dim, list.len()) else {
                let expected = if dim == 2 {
                    "2 or 3"
                } else {
                    "3, 4, 6, 8 or 9"
                };
                return Err(Fault::Wrong.error(format!(
                    "face {f} of {} has {} nodes, expected {expected} in dimension {dim}",
                    whose(),
                    list.len()
                )));
            };
            if let Some(k) = list.iter().find(|k| !(0..n as PetscInt).contains(*k)) {
                return Err(Fault::OutOfRange.error(format!(
                    "face {f} of {} names node {k}, expected numbers from 0 to below {n}",
                    whose()
                )));
            }
            let different: BTreeSet<_> = list.iter().collect();
            if different.len() != list.len() {
                return Err(Fault::Wrong.error(format!(
                    "face {f} of {} names a node twice, expected the different nodes of a {}",
                    whose(),
                    kind.name()
                )));
            }
        }
        Ok(numbering)
    }

    /// The nodes that are in faces, increasing.
    fn used(&self) -> Vec<usize> {
        distinct(self.nodes.iter().map(|&k| k as usize))
    }

    /// This rank's part as it is sent: nodes in faces only, so that a host may give all its nodes.
    fn sent(&self) -> (Parcels<[f64; 3], PetscInt>, Parcels<(), u32>) {
        let (mut nodes, mut faces) = (Parcels::default(), Parcels::default());
        let used = self.used();
        let (dim, components) = (self.dim as usize, self.components as usize);
        for &k in &used {
            let mut place = [0.0; 3];
            for (to, x) in place.iter_mut().zip(&self.coords[k * dim..][..dim]) {
                // 0 and -0 are one place.
                *to = x + 0.0;
            }
            let dofs = &self.dofs[k * components..][..components];
            nodes.push(place, dofs.iter().map(|&d| d.max(-1)));
        }
        for range in self.start.windows(2) {
            let list = &self.nodes[range[0] as usize..range[1] as usize];
            let place = |k: &PetscInt| used.binary_search(&(*k as usize)).expect("it is in a face");
            faces.push((), list.iter().map(|k| place(k) as u32));
        }
        (nodes, faces)
    }
}

/// A node as a rank gives it.
struct SurfaceNode {
    x: [f64; 3],
    dofs: Vec<PetscInt>,
}

/// The key that tells nodes apart: their unknowns, or their places where they have none.
type NodeKey = (Vec<PetscInt>, [u64; 3]);

impl SurfaceNode {
    fn key(&self) -> NodeKey {
        if self.dofs.iter().any(|&d| d >= 0) {
            (self.dofs.clone(), [0; 3])
        } else {
            (Vec::new(), self.x.map(f64::to_bits))
        }
    }
}

impl HostSurface {
    /// Puts the parts of all ranks together; `number` is that of the surface, `size` has the number of unknowns of a
    /// matrix. Collective.
    ///
    /// # Errors
    /// What makes no surface; the same on all ranks.
    pub fn new(
        session: &Session,
        given: &GivenSurface<'_>,
        number: usize,
        size: SizeOf<'_>,
    ) -> Result<HostSurface> {
        let numbering = session.agree(given.check(session.rank(), number, size))?;
        let (dim, components) = (given.dim as usize, given.components as usize);
        let facts = [given.matrix.max(-1), given.dim, given.components];
        let all = gather_all(session.comm(), &facts);
        if all.iter().any(|facts| *facts != all[0]) {
            return Err(Fault::Wrong.error(format!(
                "ranks give surface {number} different matrices, dimensions or numbers of unknowns in a node, \
                 expected the same"
            )));
        }
        let (nodes, faces) = given.sent();
        let nodes = nodes.gather_all(session.comm());
        let faces = faces.gather_all(session.comm());
        let parts = nodes.iter().zip(&faces);
        let parts: Vec<RankSurface> = parts
            .map(|(nodes, faces)| RankSurface::new(nodes, faces))
            .collect();
        let mut first: BTreeMap<NodeKey, (usize, &SurfaceNode)> = BTreeMap::new();
        for (rank, part) in parts.iter().enumerate() {
            for node in &part.nodes {
                let (_, known) = *first.entry(node.key()).or_insert((rank, node));
                let size = node.x.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
                if norm(minus(known.x, node.x)) > SAME * size {
                    return Err(Fault::Wrong.error(format!(
                        "the node with unknowns {:?} of surface {number} has two places, {:?} and {:?}, \
                         expected one",
                        node.dofs,
                        &known.x[..dim],
                        &node.x[..dim]
                    )));
                }
            }
        }
        let mut nodes: Vec<(&NodeKey, &(usize, &SurfaceNode))> = first.iter().collect();
        nodes.sort_by(|(k, (_, a)), (l, (_, b))| {
            let places = a.x.iter().zip(&b.x).map(|(x, y)| x.total_cmp(y));
            places
                .fold(std::cmp::Ordering::Equal, |o, p| o.then(p))
                .then(k.cmp(l))
        });
        let place: BTreeMap<&NodeKey, u32> = nodes.iter().map(|n| n.0).zip(0..).collect();
        let places_of = |part: &RankSurface| -> Vec<u32> {
            part.nodes.iter().map(|n| place[&n.key()]).collect()
        };
        // A face that several ranks give counts once.
        let mut faces: BTreeMap<Vec<u32>, MortarFace> = BTreeMap::new();
        for part in &parts {
            let here = places_of(part);
            for list in &part.faces {
                let nodes: Vec<u32> = list.iter().map(|&k| here[k]).collect();
                let mut sorted = nodes.clone();
                sorted.sort_unstable();
                let kind = MortarFace::kind_of(dim, nodes.len())
                    .expect("checked on the rank that gave it");
                faces.entry(sorted).or_insert(MortarFace { kind, nodes });
            }
        }
        let faces: Vec<MortarFace> = faces.into_values().collect();
        if faces.is_empty() {
            return Err(Fault::Wrong.error(format!(
                "surface {number} has no faces on any rank, expected some"
            )));
        }
        let points: Vec<[f64; 3]> = nodes.iter().map(|n| n.1 .1.x).collect();
        if let Some(pair) = one_way(&faces) {
            let [a, b] = pair.map(|f| {
                let list = &faces[f].nodes;
                let mean = |d: usize| {
                    list.iter().map(|&k| points[k as usize][d]).sum::<f64>() / list.len() as f64
                };
                (0..dim).map(mean).collect::<Vec<_>>()
            });
            return Err(Fault::Wrong.error(format!(
                "the neighbouring faces around {a:?} and {b:?} of surface {number} go around in opposite ways, \
                 expected normals out of the body for all"
            )));
        }
        let mut mine = vec![None; given.coords.len() / dim];
        for (&k, node) in given.used().iter().zip(places_of(&parts[session.rank()])) {
            mine[k] = Some(node);
        }
        Ok(HostSurface {
            numbering,
            components,
            dofs: nodes.iter().map(|n| n.1 .1.dofs.clone()).collect(),
            mine,
            giver: nodes.iter().map(|n| n.1 .0).collect(),
            side: MortarSide::new(dim, points, faces),
        })
    }
}

/// One rank's part, as all ranks see it.
struct RankSurface {
    nodes: Vec<SurfaceNode>,
    faces: Vec<Vec<usize>>,
}

impl RankSurface {
    fn new(nodes: &Parcels<[f64; 3], PetscInt>, faces: &Parcels<(), u32>) -> RankSurface {
        let node = |(x, dofs): ([f64; 3], &[PetscInt])| SurfaceNode {
            x,
            dofs: dofs.to_vec(),
        };
        let face = |((), list): ((), &[u32])| list.iter().map(|&k| k as usize).collect();
        RankSurface {
            nodes: nodes.iter().map(node).collect(),
            faces: faces.iter().map(face).collect(),
        }
    }
}

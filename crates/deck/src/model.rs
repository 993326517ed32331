//! The contents of a deck, checked: every name is resolved to places, every number is finite.

use super::deck_line::{DeckLine, Files, Note};
use super::element::{ElementModel, ElementType};
use super::gap::Gap;
use super::joint::{ContactPair, Interaction, Tie};
use super::step::DeckStep;
use base::linalg::vec3::{cross, dot, minus, norm};
use elements::law::Law;
use mesh::clockwise::side_backwards;
use mesh::MeshFile;

/// A deck of Abaqus or CalculiX that asks for static steps of linear elasticity with contact.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Deck {
    /// The files of the deck: itself, then what it includes.
    pub files: Files,
    /// Nodes, cells, and as groups the node sets, element sets and surfaces, with names in capitals.
    pub mesh: MeshFile,
    /// The type of each cell.
    pub elements: Vec<ElementType>,
    /// The section of each cell, as a place in `sections`.
    pub cell_section: Vec<u32>,
    /// The sections; a later one wins where element sets overlap.
    pub sections: Vec<Section>,
    /// The materials.
    pub materials: Vec<DeckMaterial>,
    /// The systems of coordinates of nodes.
    pub transforms: Vec<Transform>,
    /// The system of each node that has one, as (node, place in `transforms`), in increasing order of nodes.
    pub node_transform: Vec<(u32, u32)>,
    /// The equations, those of *MPC among them.
    pub equations: Vec<DeckEquation>,
    /// One unit in the last digit of the factors of equations, as the deck writes them; 0 where they are exact.
    pub factor_resolution: f64,
    /// The ties.
    pub ties: Vec<Tie>,
    /// The contact pairs.
    pub contacts: Vec<ContactPair>,
    /// The gap elements, by their *GAP.
    pub gaps: Vec<Gap>,
    /// Temperatures at the beginning, by increasing node; 0 elsewhere.
    pub initial_temperatures: Vec<(u32, f64)>,
    /// The axes of materials.
    pub orientations: Vec<Orientation>,
    /// The surface interactions, and the laws of the gap elements.
    pub interactions: Vec<Interaction>,
    /// The steps, each with everything that holds at its end.
    pub steps: Vec<DeckStep>,
    /// Notes on keywords that were ignored since they change no displacement.
    pub ignored: Vec<Note>,
    /// Notes on keywords that are solved as something else than CalculiX solves them.
    pub replaced: Vec<Note>,
    /// Notes on its parts and instances, and what became of them.
    pub placed: Vec<Note>,
}

/// A *SOLID SECTION.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// Its element set.
    pub elset: String,
    /// Its material, as a place in [`Deck::materials`].
    pub material: u32,
    /// The thickness of plane elements, 1 if none is given.
    pub thickness: f64,
    /// The axes of its material, as a place in [`Deck::orientations`]; `None`: those of the coordinates.
    pub orientation: Option<u32>,
    /// Where it stands.
    pub place: DeckLine,
}

/// A *MATERIAL.
#[derive(Debug, Clone, PartialEq)]
pub struct DeckMaterial {
    /// Its name, in capitals.
    pub name: String,
    /// The law, along the axes of its section. Materials of cells have one.
    pub elastic: Option<Law>,
    /// The mass per volume.
    pub density: Option<f64>,
    /// The strain per degree along the axes of its section.
    pub expansion: Option<[f64; 3]>,
    /// Where it stands.
    pub place: DeckLine,
    /// Why no cell may have it.
    pub(super) refused: Option<Note>,
}

/// A *TRANSFORM: the axes along which boundary conditions, forces and equations of its nodes count.
#[derive(Debug, Clone, PartialEq)]
pub struct Transform {
    /// Whether the axes are radial, tangential and axial.
    pub cylindrical: bool,
    /// A point of the first axis, or of the axis of the cylinder.
    pub a: [f64; 3],
    /// A point of the plane of the first two axes, or another point of the axis of the cylinder.
    pub b: [f64; 3],
    /// Where it stands.
    pub place: DeckLine,
}

/// An *ORIENTATION: the axes along which the constants of materials count.
#[derive(Debug, Clone, PartialEq)]
pub struct Orientation {
    /// The axes before they are turned.
    pub axes: Transform,
    /// The axis about which they are turned, 0 to 2, and by how many degrees.
    pub turn: Option<(usize, f64)>,
}

/// A linear equation between displacements, with right-hand side 0.
#[derive(Debug, Clone, PartialEq)]
pub struct DeckEquation {
    /// Its terms. CalculiX eliminates the first.
    pub terms: Vec<Term>,
    /// Where it stands.
    pub place: DeckLine,
}

/// A term of a [`DeckEquation`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Term {
    /// The node.
    pub node: u32,
    /// The direction, 0 to 2, in the system of the node.
    pub dof: u8,
    /// The factor.
    pub factor: f64,
}

impl Deck {
    /// The mechanical model of the elements. Decks are either of solids, plane or axisymmetric; plane decks may mix
    /// plane strain and plane stress, and then this is the model of the first element.
    pub fn model(&self) -> ElementModel {
        self.elements
            .first()
            .map_or(ElementModel::Solid, |e| e.model())
    }

    /// 2 or 3.
    pub fn dim(&self) -> usize {
        self.elements.first().map_or(3, |e| e.kind().dim())
    }

    /// Makes the nodes of plane elements run counter-clockwise. Numbers of faces keep their meaning: those of pressures
    /// and surfaces are numbered anew. Returns the elements that ran clockwise.
    pub fn turn_clockwise(&mut self) -> Vec<u32> {
        if self.dim() != 2 {
            return Vec::new();
        }
        let turned = self.mesh.turn_clockwise();
        for pressure in self.steps.iter_mut().flat_map(|step| &mut step.pressures) {
            if turned.binary_search(&pressure.cell).is_ok() {
                let kind = self.mesh.cells.kind(pressure.cell as usize);
                pressure.side = side_backwards(kind, pressure.side);
            }
        }
        turned
    }

    /// The axes along which the directions of `node` count, if they are not those of the coordinates: row i is axis i.
    pub fn frame(&self, node: u32) -> Option<[[f64; 3]; 3]> {
        let found = self.node_transform.binary_search_by_key(&node, |t| t.0);
        let transform = &self.transforms[self.node_transform[found.ok()?].1 as usize];
        Some(transform.frame(self.mesh.points[node as usize]))
    }
}

impl Transform {
    /// The axes at `point`; row i is axis i. On the axis of a cylinder, where every direction is radial, CalculiX's
    /// choice is taken.
    pub fn frame(&self, point: [f64; 3]) -> [[f64; 3]; 3] {
        /// How far from the axis a point lies on it, as in CalculiX.
        const NOTHING: f64 = 1e-10;
        let Transform { a, b, .. } = *self;
        if !self.cylindrical {
            let first = unit(a);
            let second = unit(minus(b, first.map(|x| x * dot(b, first))));
            return [first, second, cross(first, second)];
        }
        let axial = unit(minus(b, a));
        let from = minus(point, a);
        let across = minus(from, axial.map(|x| x * dot(from, axial)));
        let radial = if norm(across) >= NOTHING {
            across
        } else if axial[0].abs() > NOTHING {
            [-axial[1] / axial[0], 1.0, 0.0]
        } else if axial[1].abs() > NOTHING {
            [0.0, -axial[2] / axial[1], 1.0]
        } else {
            [1.0, 0.0, 0.0]
        };
        let radial = unit(radial);
        [radial, cross(axial, radial), axial]
    }
}

/// The vector of length 1 in the direction of `a`.
pub(super) fn unit(a: [f64; 3]) -> [f64; 3] {
    // Lengths whose squares overflow or vanish are scaled before.
    let most = a.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let a = a.map(|x| x / most);
    a.map(|x| x / norm(a))
}

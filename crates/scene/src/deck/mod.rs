//! Scenes from decks of Abaqus or CalculiX.
//!
//! A connected part of a deck's mesh is a body. Nothing joins bodies but *TIE, *CONTACT PAIR, *GAP and equations. A
//! scene describes one step of the deck at its end. Steps of a linear analysis do not depend on each other, but for the
//! slip of sides with friction ([`SlipHistory`]).

mod bodies;
mod carriers;
mod element;
mod gaps;
mod joints;
mod materials;
mod numbers;
mod slip_history;
mod tied;
mod torn;

use std::path::Path;

use super::checked::Scene;
use super::geometry::loose;
use super::model::spec::{ByDefault, SceneSpec};
use base::{Error, Result};
use bodies::Extracted;
use deck::{Deck, ElementModel};
use elements::cell::{Cure, Plane};
use elements::form::{Form, Physics};
use fetifeti::problem::BodyNode;
use fetifeti::solution::SolvedRow;
use mesh::bytes;
use numbers::DeckNumbering;

pub use slip_history::SlipHistory;

/// The part of a force on a ring that CalculiX prints: that on one of the sectors of 2° of which it makes the ring.
const SECTOR: f64 = 1.0 / 180.0;

/// A deck that has been read.
#[derive(Debug, Clone)]
pub struct DeckScenes {
    deck: Deck,
    numbers: DeckNumbering,
    meshes: Vec<Extracted>,
    /// Whether all elements are integrated in full, whatever their types.
    in_full: bool,
    /// A sentence for each tie that moves nodes, for each kind of defect in the mesh, and on what was turned in it.
    changes: Vec<String>,
    /// For each contact pair the ratio by which its slave is finer, where its master carries the multipliers.
    exchanged: Vec<Option<f64>>,
}

impl DeckScenes {
    /// Whether the name of a file is that of a deck.
    pub fn is_deck(path: &Path) -> bool {
        path.extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("inp"))
    }

    /// Reads the deck in the file `path`.
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) with file, line and what was expected.
    pub fn load(path: &Path) -> Result<DeckScenes> {
        let read = |file: &Path| bytes(file, "deck");
        let directory = path.parent().unwrap_or(Path::new(""));
        let name = path.display().to_string();
        DeckScenes::of(deck::read(&name, &read(path)?, &|file| {
            read(&directory.join(file))
        })?)
    }

    /// The scenes of a deck.
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) for one without a step.
    pub fn of(mut deck: Deck) -> Result<DeckScenes> {
        if deck.steps.is_empty() {
            return Err(Error::input(format!(
                "{}: the deck has no *STEP (one at least was expected)",
                deck.mesh.name
            )));
        }
        let turned = deck.turn_clockwise();
        let numbers = DeckNumbering::new(&deck);
        joints::distinguish(&mut deck);
        let mut changes = tied::adjust(&mut deck);
        let meshes = bodies::meshes(&deck, &numbers);
        changes.extend(torn::notes(&deck, &numbers, &meshes));
        changes.extend(clockwise(&deck, &turned));
        Ok(DeckScenes {
            exchanged: carriers::exchanged(&deck),
            deck,
            numbers,
            meshes,
            in_full: false,
            changes,
        })
    }

    /// This deck with all elements integrated in full if `in_full` is set: C3D8R as C3D8, C3D6 with six points.
    #[must_use]
    pub fn integrated(mut self, in_full: bool) -> DeckScenes {
        self.in_full = in_full;
        self
    }

    /// The deck as it was read, but for what its ties move.
    pub fn deck(&self) -> &Deck {
        &self.deck
    }

    /// Notes on the deck, a sentence each: what is ignored, solved as something else or left out, where its mesh is
    /// torn, and which surfaces have exchanged their roles.
    pub fn notes(&self) -> Vec<String> {
        let deck = &self.deck;
        let line = |what: &str, note: &deck::Note| {
            let place = deck.files.at(note.place);
            format!("{place}: {} {what}: {}", note.keyword, note.reason)
        };
        let ignored = deck.ignored.iter().map(|note| line("is ignored", note));
        let replaced = deck.replaced.iter().map(|note| line("is replaced", note));
        let placed = deck.placed.iter().map(|note| {
            let place = deck.files.at(note.place);
            format!("{place}: {}: {}", note.keyword, note.reason)
        });
        let ends = deck.gaps.iter().flat_map(|gap| &gap.elements);
        let ends: Vec<u32> = ends.flat_map(|e| e.nodes).collect();
        let unused = deck.mesh.unused(deck.dim(), &[], &ends);
        let changes = self.changes.iter().cloned();
        let all = ignored.chain(replaced).chain(placed).chain(unused);
        let exchanged = carriers::notes(deck, &self.exchanged);
        all.chain(changes).chain(exchanged).collect()
    }

    /// Number of steps, ≥ 1.
    pub fn n_steps(&self) -> usize {
        self.deck.steps.len()
    }

    /// The scene of step `step` after what earlier steps have left.
    ///
    /// # Errors
    /// As [`DeckScenes::scene`].
    pub fn scene_after(&self, slid: &SlipHistory, title: &str, step: usize) -> Result<Scene> {
        let mut scene = self.scene(title, step)?;
        slid.enter(&mut scene);
        Ok(scene)
    }

    /// The scene of step `step`, as if it were the first one.
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) for what a scene refuses, such as sides that do not match.
    pub fn scene(&self, title: &str, step: usize) -> Result<Scene> {
        let deck = &self.deck;
        let plane = match deck.model() {
            ElementModel::Solid | ElementModel::PlaneStrain => Plane::Strain,
            ElementModel::PlaneStress => Plane::Stress,
            ElementModel::Axisymmetric => Plane::Axial,
        };
        if let Some(k) = deck.elements.iter().position(|e| e.model() != deck.model()) {
            return Err(Error::input(format!(
                "{}: element {} is a {} where {:?} was expected, as before: the kinds are not mixed",
                deck.mesh.name,
                deck.mesh.cell_ids[k],
                deck.elements[k].name(),
                deck.model()
            )));
        }
        let physics = Physics::Elasticity {
            plane,
            cure: Cure::None,
        };
        let form = Form {
            physics,
            ..Form::default()
        };
        let numbers = &self.numbers;
        let (bodies, mut equations) =
            bodies::of(deck, numbers, (&self.meshes, self.in_full), step)?;
        equations.extend(joints::equations(deck, numbers)?);
        let mut contacts = joints::contacts(deck, numbers, &self.exchanged, step)?;
        let (gaps, obstacles) = gaps::of(deck, numbers, &bodies, step)?;
        contacts.extend(gaps);
        let spec = SceneSpec {
            form,
            default: ByDefault::Free,
            ties: joints::ties(deck),
            contacts,
            obstacles,
            equations,
            notes: self.notes(),
            ..SceneSpec::tied(title, bodies)
        };
        let mut scene = Scene::new(spec)?;
        // In a deck nothing is joined that no keyword joins.
        let loose = loose::sentences(
            &scene.bodies,
            scene.interfaces.iter().as_slice(),
            &scene.rows,
            &scene.form,
            loose::Language::Deck,
        );
        scene.notes.extend(loose);
        // A deck cannot ask for it.
        scene.renewable = false;
        Ok(scene)
    }

    /// Whether step `step` asks for tables, and whether for forces among them.
    pub fn asks(&self, step: usize) -> Option<bool> {
        let prints = &self.deck.steps[step].prints;
        let force = |print: &deck::NodePrint| print.printed.contains(&deck::Printed::Force);
        (!prints.is_empty()).then(|| prints.iter().any(force))
    }

    /// The tables that step `step` asks for, a list for each *NODE PRINT, by its scene and all of its normal and
    /// tangential rows. Nodes that no element has do not move and bear no force, but for those that are ground.
    pub fn tables<'r>(
        &self,
        step: usize,
        (scene, rows): (&Scene, impl Iterator<Item = &'r SolvedRow>),
        displacement: &dyn Fn(BodyNode) -> [f64; 3],
        force: &dyn Fn(BodyNode) -> [f64; 3],
    ) -> Vec<Vec<deck::DatTable>> {
        let numbers = &self.numbers;
        let all = |of: &dyn Fn(BodyNode) -> [f64; 3]| -> Vec<[f64; 3]> {
            let nodes = 0..self.deck.mesh.points.len() as u32;
            nodes
                .map(|k| numbers.node(k).map_or([0.0; 3], of))
                .collect()
        };
        let (mut motions, mut forces) = (all(displacement), all(force));
        gaps::on_ground(scene, rows, &mut motions, &mut forces);
        if self.deck.model() == ElementModel::Axisymmetric {
            forces.iter_mut().flatten().for_each(|f| *f *= SECTOR);
        }
        self.deck.tables(step, &motions, &forces)
    }
}

/// A sentence on the elements that ran clockwise, if there are any.
fn clockwise(deck: &Deck, turned: &[u32]) -> Option<String> {
    let first = deck.mesh.cell_ids[*turned.first()? as usize];
    let (file, who) = (
        &deck.mesh.name,
        match turned.len() {
            1 => format!("the nodes of element {first} run clockwise"),
            n => format!("the nodes of {n} elements run clockwise (the first is element {first})"),
        },
    );
    Some(format!(
        "{file}: {who}; they are taken counter-clockwise, and face numbers keep their meaning (CalculiX refuses them)"
    ))
}

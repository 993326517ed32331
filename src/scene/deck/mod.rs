//! Scenes from decks of Abaqus or CalculiX.
//!
//! A connected part of a deck's mesh is a body. Nothing joins bodies but *TIE, *CONTACT PAIR and equations. A scene
//! describes one step of the deck at its end; steps of a linear analysis do not depend on each other.

mod bodies;
mod joints;
mod numbers;
mod torn;

use std::collections::HashSet;
use std::path::Path;

use super::checked::Scene;
use super::model::spec::{ByDefault, SceneSpec};
use crate::error::{Error, Result};
use crate::fem::cell::{Cure, Plane};
use crate::fem::{Form, Physics};
use crate::mesh::deck::{self, Deck, Model};
use crate::substructures::BodyNode;
use numbers::Numbers;

/// A node of a deck that *NODE PRINT prints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PrintedNode {
    /// Its number in the deck.
    pub id: u64,
    /// The node; `None` if no cell has it.
    pub node: Option<BodyNode>,
    /// The axes along which the displacement is printed, by rows, if they are not those of the coordinates.
    pub axes: Option<[[f64; 3]; 3]>,
}

/// A table of displacements that a deck asks for.
#[derive(Debug, Clone, PartialEq)]
pub struct NodePrint {
    /// The node set.
    pub set: String,
    /// The time of the step's end.
    pub time: f64,
    /// The nodes in the order in which they are printed.
    pub nodes: Vec<PrintedNode>,
}

/// A deck that has been read.
#[derive(Debug, Clone)]
pub struct DeckScenes {
    deck: Deck,
    /// A sentence for each kind of defect in its mesh.
    torn: Vec<String>,
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
    /// [`Error::Input`] with file, line and what was expected.
    pub fn load(path: &Path) -> Result<DeckScenes> {
        let read = |file: &Path| {
            let name = file.display();
            let bytes = std::fs::read(file);
            bytes.map_err(|e| Error::Input(format!("{name}: the deck cannot be read: {e}")))
        };
        let directory = path.parent().unwrap_or(Path::new(""));
        let name = path.display().to_string();
        let deck = deck::read(&name, &read(path)?, &|file| read(&directory.join(file)))?;
        if deck.steps.is_empty() {
            return Err(Error::Input(format!(
                "{name}: the deck has no *STEP (one at least was expected)"
            )));
        }
        let torn = torn::notes(&deck);
        Ok(DeckScenes { deck, torn })
    }

    /// The deck as it was read.
    pub fn deck(&self) -> &Deck {
        &self.deck
    }

    /// What of the deck is ignored, solved as something else or left out, and where its mesh is torn: a sentence each.
    pub fn notes(&self) -> Vec<String> {
        let deck = &self.deck;
        let line = |what: &str, note: &deck::Note| {
            let place = deck.files.at(note.place);
            format!("{place}: {} {what}: {}", note.keyword, note.reason)
        };
        let ignored = deck.ignored.iter().map(|note| line("is ignored", note));
        let replaced = deck.replaced.iter().map(|note| line("is replaced", note));
        let unused = deck.mesh.unused(deck.dim());
        let torn = self.torn.iter().cloned();
        let all = ignored.chain(self.without_forces()).chain(replaced);
        all.chain(unused).chain(torn).collect()
    }

    /// A sentence for each *NODE PRINT that asks for forces, which are not computed.
    fn without_forces(&self) -> Vec<String> {
        let prints = self.deck.steps.iter().flat_map(|step| &step.prints);
        let forces = prints.filter(|p| p.printed.contains(&deck::Printed::Force));
        let note = |print: &deck::NodePrint| {
            let place = self.deck.files.at(print.place);
            format!("{place}: *NODE PRINT is ignored: RF is not printed, only U")
        };
        let mut notes: Vec<String> = forces.map(note).collect();
        // Later steps have the requests of those before.
        let mut said = HashSet::new();
        notes.retain(|note| said.insert(note.clone()));
        notes
    }

    /// Number of steps, ≥ 1.
    pub fn n_steps(&self) -> usize {
        self.deck.steps.len()
    }

    /// The scene of step `step`.
    ///
    /// # Errors
    /// [`Error::Input`] for what a scene refuses, such as sides that do not match.
    pub fn scene(&self, title: &str, step: usize) -> Result<Scene> {
        let deck = &self.deck;
        let plane = match deck.model() {
            Model::Solid | Model::PlaneStrain => Plane::Strain,
            Model::PlaneStress => Plane::Stress,
            Model::Axisymmetric => {
                return Err(Error::Input(format!(
                    "{}: elements of revolution (CAX) are not solved (solid or plane elements were expected)",
                    deck.mesh.name
                )))
            }
        };
        if let Some(k) = deck.elements.iter().position(|e| e.model() != deck.model()) {
            return Err(Error::Input(format!(
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
        let numbers = Numbers::new(deck);
        let (bodies, mut equations) = bodies::of(deck, &numbers, step)?;
        equations.extend(joints::equations(deck, &numbers)?);
        let spec = SceneSpec {
            form,
            default: ByDefault::Free,
            ties: joints::ties(deck),
            contacts: joints::contacts(deck)?,
            equations,
            notes: self.notes(),
            ..SceneSpec::tied(title, bodies)
        };
        let mut scene = Scene::new(spec)?;
        scene.prints = self.prints(&numbers, step);
        Ok(scene)
    }

    fn prints(&self, numbers: &Numbers, step: usize) -> Vec<NodePrint> {
        let deck = &self.deck;
        let step = &deck.steps[step];
        let asked = step.prints.iter();
        let asked = asked.filter(|p| p.printed.contains(&deck::Printed::Displacement));
        asked
            .map(|print| NodePrint {
                set: print.nset.clone(),
                time: step.time,
                nodes: print
                    .nodes
                    .iter()
                    .map(|&k| PrintedNode {
                        id: deck.mesh.node_ids[k as usize],
                        node: numbers.node(k),
                        axes: deck.frame(k).filter(|_| !print.global),
                    })
                    .collect(),
            })
            .collect()
    }
}

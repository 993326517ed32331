//! One scene of a study and its solution, with all contact rows on every rank.

use std::path::Path;
use std::time::Instant;

use base::Result;
use fetifeti::settings::MethodSettings;
use fetifeti::solution::SolvedRow;
use fetifeti::{FetiFeti, Solution};
use mesh::bytes;
use petsc::Session;
use scene::{distribution, DeckScenes, Numbering, Scene};

/// A scene and its solution by the method.
pub struct Solved {
    /// The scene.
    pub scene: Scene,
    /// The solver, which can be used further.
    pub solver: FetiFeti,
    /// The solution.
    pub solution: Solution,
    /// Seconds of assembly, set-up and solve.
    pub seconds: f64,
}

impl Solved {
    /// Solves the scene in `text`. The options of the scene and of the user override `settings`. Collective.
    ///
    /// # Errors
    /// Those of the scene and of the method; a solve that does not converge is no error.
    pub fn new(
        session: &Session,
        name: &str,
        text: &str,
        settings: &MethodSettings,
    ) -> Result<Solved> {
        let scene = session.agree(scene(name, text))?;
        let (solver, solution, seconds) =
            distribution::with_options(session, &scene.options, || {
                let clock = Instant::now();
                let substructures = distribution::substructures(session, &scene)?;
                let mut solver = FetiFeti::new(session, substructures, settings.clone())?;
                let solution = solver.solve()?;
                Ok((solver, solution, clock.elapsed().as_secs_f64()))
            })?;
        Ok(Solved {
            scene,
            solver,
            solution,
            seconds,
        })
    }

    /// The rows of all ranks, in the order of [`Scene::solver_rows`], on every rank. Collective.
    pub fn rows(&self, session: &Session) -> Vec<SolvedRow> {
        SolvedRow::on_all_ranks(session.comm(), self.solution.rows())
    }

    /// Unknowns of the scene.
    pub fn dofs(&self) -> usize {
        Numbering::new(&self.scene).len() as usize
    }
}

/// The scene in a text; of a deck the last step.
///
/// # Errors
/// Those of a scene or a deck that cannot be read.
pub fn scene(name: &str, text: &str) -> Result<Scene> {
    if !DeckScenes::is_deck(Path::new(name)) {
        return Scene::parse(name, text);
    }
    let included = |file: &str| bytes(Path::new(file), "deck");
    let deck = DeckScenes::of(deck::read(name, text.as_bytes(), &included)?)?;
    deck.scene(name, deck.n_steps() - 1)
}

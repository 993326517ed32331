//! One scene of a study, solved, with its contact rows in one place.

use std::time::Instant;

use crate::feti::{FetiFeti, Settings, Solution};
use crate::parallel::exchange::gather_all;
use crate::petsc::Session;
use crate::scene::{distribution, Member, Numbering, RowLabel, RowSource, Scene};
use crate::{Error, Result};

/// A scene and what the method made of it.
pub struct Solved {
    /// The scene.
    pub scene: Scene,
    /// The solver, ready for more.
    pub solver: FetiFeti,
    /// The solution.
    pub solution: Solution,
    /// Seconds of assembly, set-up and solve.
    pub seconds: f64,
}

/// A row of B_gl of any rank.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// What it is about.
    pub label: RowLabel,
    /// Its multiplier.
    pub multiplier: f64,
    /// Whether it may be switched off.
    pub inequality: bool,
    /// Whether it holds at the end.
    pub active: bool,
}

impl Solved {
    /// Solves the scene in `text` with `settings`, on which options of the scene and of the user stand. Collective.
    ///
    /// # Errors
    /// Those of the scene and of the method; not converging is none.
    pub fn new(session: &Session, name: &str, text: &str, settings: &Settings) -> Result<Solved> {
        let scene = session.agree(Scene::parse(name, text))?;
        let (solver, solution, seconds) = distribution::with_options(session, &scene, || {
            let clock = Instant::now();
            let substructures = distribution::substructures(session, &scene)?;
            let solver = FetiFeti::new(session, substructures, settings.clone())?;
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

    /// The rows of all ranks, in the order of [`Scene::rows`], on every rank. Collective.
    ///
    /// # Errors
    /// Those of the options.
    pub fn rows(&self, session: &Session) -> Result<Vec<Row>> {
        const WORDS: usize = 4;
        let owns = distribution::owner(session, &self.scene)?;
        // Every row by its place in the list of all, which every rank can make.
        let all = self.scene.row_labels(&|_| true);
        let mine = self.scene.row_labels(&owns);
        let mut place = std::collections::HashMap::new();
        for (k, label) in all.iter().enumerate() {
            place.insert(key(label), k);
        }
        let dual = self.solver.dual();
        let jump = &dual.stiffness.jump;
        let mut words = Vec::with_capacity(WORDS * jump.order.len());
        for (k, &r) in jump.order.iter().enumerate() {
            let i = jump.n_owned_local + k;
            let number = place.get(&key(&mine[r])).copied();
            let number = number.ok_or_else(|| Error::environment("a row without a label"))?;
            words.extend([number as u64, self.solution.lambda[i].to_bits()]);
            words.extend([jump.inequality[i], self.solution.active[i]].map(u64::from));
        }
        let words = gather_all(session.comm(), &words).concat();
        let mut rows: Vec<(u64, Row)> = words
            .chunks_exact(WORDS)
            .map(|w| {
                let row = Row {
                    label: all[w[0] as usize],
                    multiplier: f64::from_bits(w[1]),
                    inequality: w[2] == 1,
                    active: w[3] == 1,
                };
                (w[0], row)
            })
            .collect();
        rows.sort_by_key(|(k, _)| *k);
        Ok(rows.into_iter().map(|(_, row)| row).collect())
    }

    /// Unknowns of the scene.
    pub fn dofs(&self) -> usize {
        Numbering::new(&self.scene).len() as usize
    }
}

/// What tells rows apart: source, members (body, node), and the two bounds of one obstacle by their direction.
type Key = (RowSource, [Option<(usize, usize)>; 2], [u64; 3]);

fn key(label: &RowLabel) -> Key {
    let member = |m: Option<Member>| m.map(|m| (m.body, m.node));
    (
        label.source,
        label.members.map(member),
        label.direction.map(f64::to_bits),
    )
}

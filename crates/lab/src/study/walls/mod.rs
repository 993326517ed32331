//! `study walls`: how many steps and iterations the contact loop takes on random walls of bodies whose coefficients
//! jump from body to body. Sets of the active-set method wander there.

mod scenes;

pub use scenes::{scene, WallFamily, FAMILIES, JUMPS};

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::solved::Solved;
use base::Result;
use fetifeti::settings::{ContactType, MethodSettings};
use petsc::Session;
use report::output::write_text;
use report::tables::table::{fixed, Table};

/// Scenes for each family and jump; the second number is for the quick study. 6 families and 4 jumps make 1,008.
const SCENES: [usize; 2] = [42, 2];

/// One scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Wall {
    /// Number of the scene within its family.
    pub seed: usize,
    /// Steps of the contact loop.
    pub steps: usize,
    /// How many of them were taken on the augmented Lagrangian.
    pub damped: usize,
    /// Krylov iterations in total.
    pub iterations: usize,
    /// The energy; `None` without a solution.
    pub energy: Option<f64>,
    /// Why the loop ended.
    pub reason: String,
    /// Whether this is a solution.
    pub converged: bool,
}

/// The scenes of one family with one jump.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Walls {
    /// The family.
    pub family: String,
    /// Coefficients of every second body; those of the others are 1.
    pub jump: f64,
    /// The scenes.
    pub walls: Vec<Wall>,
    /// Seconds of all scenes together.
    pub seconds: f64,
}

impl Walls {
    /// Scenes without a solution.
    pub fn unsolved(&self) -> impl Iterator<Item = &Wall> {
        self.walls.iter().filter(|w| !w.converged)
    }

    /// Number of scenes with steps on the augmented Lagrangian.
    pub fn damped(&self) -> usize {
        self.walls.iter().filter(|w| w.damped > 0).count()
    }

    /// Median, 99th percentile and largest of a number of the scenes.
    fn spread(&self, of: impl Fn(&Wall) -> usize) -> String {
        let mut all: Vec<usize> = self.walls.iter().map(of).collect();
        all.sort_unstable();
        let at = |part: f64| all[(part * (all.len() - 1) as f64).ceil() as usize];
        format!("{} / {} / {}", at(0.5), at(0.99), at(1.0))
    }
}

/// The study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WallsReport {
    /// "walls".
    pub study: String,
    /// The results by family and jump.
    pub rows: Vec<Walls>,
}

/// Runs the study with the options of the user. Collective.
///
/// # Errors
/// Those of the method. A scene that is not solved is no error.
pub fn run(
    session: &Session,
    quick: bool,
    only: Option<&str>,
    progress: &mut dyn FnMut(&str),
) -> Result<WallsReport> {
    let mut rows = Vec::new();
    for (of, family) in super::numbered(super::chosen(FAMILIES.to_vec(), |f| f.name, only)?) {
        for jump in JUMPS {
            progress(&format!("{of}, {}, jump {jump:e}", family.name));
            rows.push(walls(session, &family, jump, SCENES[usize::from(quick)])?);
        }
    }
    Ok(WallsReport {
        study: "walls".into(),
        rows,
    })
}

/// The first `count` scenes of a family. Collective.
fn walls(session: &Session, family: &WallFamily, jump: f64, count: usize) -> Result<Walls> {
    let mut out = Walls {
        family: family.name.into(),
        jump,
        walls: Vec::new(),
        seconds: 0.0,
    };
    let settings = MethodSettings::default();
    for seed in 0..count {
        let name = format!("{}-{jump:e}-{seed}.toml", family.name);
        let text = scene(family, jump, seed);
        let wall = match Solved::new(session, &name, &text, &settings) {
            Ok(solved) => {
                out.seconds += solved.seconds;
                let (steps, status) = (&solved.solution.steps, &solved.solution.status);
                let damped =
                    |s: &&fetifeti::solution::Step| s.method == ContactType::AugmentedLagrangian;
                Wall {
                    seed,
                    steps: steps.len(),
                    damped: steps.iter().filter(damped).count(),
                    iterations: solved.solution.iterations,
                    energy: Some(solved.solution.energy),
                    reason: status.to_string(),
                    converged: solved.solution.converged(),
                }
            }
            Err(error) if error.is_not_converged() => Wall {
                seed,
                steps: 0,
                damped: 0,
                iterations: 0,
                energy: None,
                reason: error.to_string(),
                converged: false,
            },
            Err(e) => return Err(e),
        };
        out.walls.push(wall);
    }
    Ok(out)
}

/// Writes the scenes that were not solved and the slowest one of each row; returns the names of the files.
///
/// # Errors
/// A file that cannot be written.
pub fn save(report: &WallsReport, dir: &Path) -> Result<Vec<String>> {
    let mut files = Vec::new();
    for row in &report.rows {
        let family = FAMILIES.iter().find(|f| f.name == row.family);
        let family = family.expect("the study has run this family");
        let slowest = row.walls.iter().max_by_key(|w| (w.steps, w.iterations));
        let slowest = slowest.filter(|w| w.converged);
        for wall in slowest.into_iter().chain(row.unsolved()) {
            let file = format!("{}-{:e}-{}.toml", row.family, row.jump, wall.seed);
            let text = scene(family, row.jump, wall.seed);
            write_text(&dir.join(&file), &text)?;
            files.push(file);
        }
    }
    Ok(files)
}

/// The table.
pub fn table(report: &WallsReport) -> Table {
    Table::of(&report.rows)
        .words("walls", |w| &w.family)
        .numbers("jump", |w| format!("{:e}", w.jump))
        .numbers("scenes", |w| w.walls.len())
        .numbers("steps", |w| w.spread(|w| w.steps))
        .numbers("iterations", |w| w.spread(|w| w.iterations))
        .numbers("damped", |w| w.damped())
        .numbers("unsolved", |w| w.unsolved().count())
        .numbers("s", |w| fixed(Some(w.seconds), 1))
        .table()
}

/// The table for terminals, and the scenes that were not solved.
pub fn text(report: &WallsReport) -> String {
    let mut out = format!(
        "Random walls: steps and iterations as median / 99th percentile / worst; damped: scenes with steps on the \
         augmented Lagrangian\n{}\n",
        table(report)
    );
    for row in &report.rows {
        for wall in row.unsolved() {
            let (family, jump) = (&row.family, row.jump);
            out += &format!(
                "{family}, jump {jump:e}, scene {}: {}\n",
                wall.seed, wall.reason
            );
        }
    }
    out
}

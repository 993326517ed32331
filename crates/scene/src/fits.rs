//! Whether a scene fits into the memory, said before anything large is made for it.

use std::path::Path;

use super::checked::Scene;
use super::model::spec::{ByDefault, Faces, SceneSpec};
use super::need::Need;
use super::part::RankPart;
use super::read::MOST_IN_A_ROW;
use super::validate::MOST_BODIES;
use crate::model::spec;
use base::{Error, Result};
use parallel::available::{available, Available};
use petsc::{Options, Session};

/// The option that replaces what the system says.
const LIMIT: &str = "fetifeti_memory_limit";

/// How far a scene has to come.
#[derive(Clone, Copy, PartialEq)]
enum Until {
    /// To its matrices: `plan`.
    Assembled,
    /// To a solution.
    Solved,
}

/// Reads the scene, unless what assembles it would not fit into the memory.
///
/// # Errors
/// Those of [`Scene::load`]; [`ErrorKind::Environment`](base::ErrorKind::Environment) with the estimate, the memory
/// that there is, and what to change.
pub fn load(session: &Session, path: &Path) -> Result<Scene> {
    load_part(session, path, |_| Ok(RankPart::WHOLE))
}

/// [`load`] of a part.
pub(super) fn load_part(
    session: &Session,
    path: &Path,
    part: impl FnOnce(&SceneSpec) -> Result<RankPart>,
) -> Result<Scene> {
    let name = path.display().to_string();
    let in_full = is_in_full(session)?;
    Scene::load_if(path, in_full, |spec| {
        let own = spec.options.iter().find(|(key, _)| key == LIMIT);
        check(
            session,
            &name,
            &of_spec(spec),
            Until::Assembled,
            own.map(|o| o.1.as_str()),
        )?;
        part(spec)
    })
}

/// Whether the elements of decks are integrated in full. Reads the option `-fetifeti_full_integration`.
pub fn is_in_full(session: &Session) -> Result<bool> {
    let help = "whether all elements of a deck are integrated in full";
    Options::new(session, "fetifeti_").bool("full_integration", false, help)
}

/// The experiment of Table 1 of \[Lee\], unless it would not fit into the memory. Errors say `name` for the row, as the
/// user has written it.
///
/// # Errors
/// Those of [`Scene::lee`], and as [`load`].
pub fn lee(session: &Session, name: &str, row: [usize; 3], faces: Faces) -> Result<Scene> {
    let [bodies, subdomains, elements] = row;
    if bodies.saturating_mul(bodies) > MOST_BODIES {
        return Err(Error::input(format!(
            "{name}: {bodies} × {bodies} bodies where at most {MOST_BODIES} were expected"
        )));
    }
    let in_a_row = subdomains.saturating_mul(elements);
    if in_a_row > MOST_IN_A_ROW {
        return Err(Error::input(format!(
            "{name}: {in_a_row} elements along a side of a body where at most {MOST_IN_A_ROW} were expected"
        )));
    }
    let spec = spec::lee(bodies, subdomains, elements, faces);
    check(session, name, &of_spec(&spec), Until::Solved, None)?;
    Scene::new(spec)
}

/// Refuses a scene whose matrices would not fit into the memory.
///
/// # Errors
/// As [`load`].
pub(crate) fn assembled(session: &Session, scene: &Scene) -> Result<()> {
    check(
        session,
        &scene.title,
        &of_scene(scene),
        Until::Assembled,
        None,
    )
}

/// Refuses a scene whose solve would not fit into the memory.
///
/// # Errors
/// As [`load`].
pub fn solved(session: &Session, scene: &Scene, name: &str) -> Result<()> {
    check(session, name, &of_scene(scene), Until::Solved, None)
}

/// The memory that a solve of the scene takes on each rank, in bytes.
pub fn needed(session: &Session, scene: &Scene) -> f64 {
    of_scene(scene).solved(session.size())
}

/// The memory that this rank may take: `-fetifeti_memory_limit`, or what the system says; `value` is that of the scene,
/// if the user has set none.
pub fn left(session: &Session, value: Option<&str>) -> Result<Option<Available>> {
    let options = Options::new(session, "");
    let on_machine = ranks_here(session);
    let help = "MB that all ranks of a machine may take together; 0: what is free";
    let default = value.and_then(|v| v.parse().ok()).unwrap_or(0);
    Ok(match options.usize(LIMIT, default, help)? {
        0 => available(on_machine),
        megabytes => Some(Available {
            bytes: 1e6 * megabytes as f64 / on_machine as f64,
            by: "of -fetifeti_memory_limit",
        }),
    })
}

/// Ranks on this machine, as Open MPI and MPICH tell.
fn ranks_here(session: &Session) -> usize {
    let told = ["OMPI_COMM_WORLD_LOCAL_SIZE", "MPI_LOCALNRANKS"];
    let told = told
        .iter()
        .find_map(|name| std::env::var(name).ok()?.parse().ok());
    told.unwrap_or(session.size()).max(1)
}

fn of_scene(scene: &Scene) -> Need {
    let bodies = scene.bodies.iter().map(|b| &b.spec);
    Need::of(bodies, &scene.form, scene.mostly_tied)
}

fn of_spec(spec: &SceneSpec) -> Need {
    let tied = spec.default == ByDefault::Tied && spec.contacts.is_empty();
    Need::of(spec.bodies.iter(), &spec.form, tied)
}

fn check(
    session: &Session,
    name: &str,
    need: &Need,
    until: Until,
    value: Option<&str>,
) -> Result<()> {
    let ranks = session.size();
    let (bytes, what) = match until {
        Until::Solved => (need.solved(ranks), "a solve"),
        Until::Assembled => (need.assembled(ranks), "the matrices"),
    };
    let Some(left) = left(session, value)? else {
        return Ok(());
    };
    if bytes <= left.bytes {
        return Ok(());
    }
    let on_each = match ranks {
        1 => String::new(),
        n => format!(" on each of {n} ranks"),
    };
    // Factors of large subdomains are what more subdomains make smaller.
    let change = if until == Until::Solved && need.solved(ranks) > 2.0 * need.assembled(ranks) {
        "fewer elements per subdomain"
    } else {
        "fewer elements or subdomains"
    };
    Err(Error::environment(format!(
        "{name}: {what} would take about {}{on_each}, for {} elements in {} subdomains, where {} {} are left; \
         take {change}, ranks on more machines, or another limit (-fetifeti_memory_limit MB)",
        size(bytes),
        count(need.elements),
        count(need.subdomains),
        size(left.bytes),
        left.by
    )))
}

/// Bytes in MB or GB.
pub fn size(bytes: f64) -> String {
    if bytes < 1e9 {
        format!("{:.0} MB", bytes / 1e6)
    } else {
        format!("{:.1} GB", bytes / 1e9)
    }
}

/// A count, large ones in powers of ten.
fn count(n: f64) -> String {
    if n < 1e6 {
        format!("{n}")
    } else {
        format!("{n:.1e}")
    }
}

//! The distribution of subdomains over ranks, and this rank's part of a scene.

use std::path::Path;

use super::checked::Scene;
use crate::error::{Error, Result};
use crate::mesh::contiguous_share;
use crate::petsc::{Options, Session};
use crate::substructures::Substructures;

/// Reads the scene and puts its options into the database, below those of the user. Collective.
pub(crate) fn load(session: &Session, path: &Path) -> Result<Scene> {
    let scene = session.agree(Scene::load(path))?;
    set_options(session, &scene)?;
    Ok(scene)
}

/// Calls `work` with the options of the scene in the database, below those of the user, and removes them afterwards. It
/// serves programs that process several scenes.
pub(crate) fn with_options<T>(
    session: &Session,
    scene: &Scene,
    work: impl FnOnce() -> Result<T>,
) -> Result<T> {
    let set = set_options(session, scene)?;
    let done = work();
    for name in set {
        Options::new(session, "").clear_value(name)?;
    }
    done
}

/// Returns the names of the options that the user has not set.
fn set_options<'a>(session: &Session, scene: &'a Scene) -> Result<Vec<&'a str>> {
    let options = Options::new(session, "");
    let mut set = Vec::new();
    for (name, value) in &scene.options {
        if options.set_default(name, value)? {
            set.push(name.as_str());
        }
    }
    Ok(set)
}

/// How subdomains are dealt to ranks (`-fetifeti_distribution`).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Distribution {
    /// Contiguous blocks of subdomains.
    Block,
    /// One after the other in turn.
    Cyclic,
}

impl Distribution {
    /// Reads the option `-fetifeti_distribution`.
    pub(crate) fn from_options(session: &Session) -> Result<Distribution> {
        let help = "how subdomains are dealt to ranks";
        let names = ["block", "cyclic"];
        Ok(
            match Options::new(session, "fetifeti_").choice("distribution", &names, 0, help)? {
                0 => Distribution::Block,
                _ => Distribution::Cyclic,
            },
        )
    }

    /// Whether subdomain `s` of `n` belongs to rank `rank` of `size`.
    fn owns(self, s: usize, n: usize, rank: usize, size: usize) -> bool {
        match self {
            Distribution::Block => contiguous_share(n, size, rank).contains(&s),
            Distribution::Cyclic => s % size == rank,
        }
    }
}

/// A predicate: whether this rank owns a subdomain, according to the options.
pub(crate) fn owner(session: &Session, scene: &Scene) -> Result<impl Fn(usize) -> bool> {
    let deal = Distribution::from_options(session)?;
    let (n, rank, size) = (scene.n_subdomains(), session.rank(), session.size());
    Ok(move |s| deal.owns(s, n, rank, size))
}

/// This rank's part of the scene, assembled. Collective.
pub(crate) fn substructures(session: &Session, scene: &Scene) -> Result<Substructures> {
    let owns = owner(session, scene)?;
    let threads = if session.size() == 1 { 0 } else { 1 };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|e| Error::environment(format!("cannot start threads: {e}")))?;
    let built = pool.install(|| scene.substructures(&owns));
    session.agree(built)
}

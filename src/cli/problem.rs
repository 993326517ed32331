//! From a scene file to this rank's substructures.

use std::path::Path;

use crate::mesh::contiguous_share;
use crate::petsc::{Options, Session};
use crate::scene::Scene;
use crate::substructures::Substructures;
use crate::Result;

/// Reads the scene and puts its options into the database, below those of the user. Collective.
pub fn load(session: &Session, path: &Path) -> Result<Scene> {
    let scene = session.agree(Scene::load(path))?;
    let options = Options::new(session, "");
    for (name, value) in &scene.options {
        options.set_default(name, value)?;
    }
    Ok(scene)
}

/// How subdomains are dealt to ranks (`-fetifeti_distribution`).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Distribution {
    /// Contiguous blocks of subdomains.
    Block,
    /// One after the other in turn.
    Cyclic,
}

impl Distribution {
    /// As the options say.
    pub fn from_options(session: &Session) -> Result<Distribution> {
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
    pub fn owns(self, s: usize, n: usize, rank: usize, size: usize) -> bool {
        match self {
            Distribution::Block => contiguous_share(n, size, rank).contains(&s),
            Distribution::Cyclic => s % size == rank,
        }
    }
}

/// Which subdomains belong to this rank, as the options deal them.
pub fn owner(session: &Session, scene: &Scene) -> Result<impl Fn(usize) -> bool> {
    let deal = Distribution::from_options(session)?;
    let (n, rank, size) = (scene.n_subdomains(), session.rank(), session.size());
    Ok(move |s| deal.owns(s, n, rank, size))
}

/// This rank's part of the scene, assembled. Collective.
pub fn substructures(session: &Session, scene: &Scene) -> Result<Substructures> {
    let owns = owner(session, scene)?;
    let threads = if session.size() == 1 { 0 } else { 1 };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|e| crate::Error::environment(format!("cannot start threads: {e}")))?;
    let built = pool.install(|| scene.substructures(&owns));
    session.agree(built)
}

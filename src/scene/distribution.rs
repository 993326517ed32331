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

/// Whether subdomains are dealt to ranks one after the other in turn, and not in contiguous blocks. Reads the option
/// `-fetifeti_distribution`.
pub(crate) fn is_cyclic(session: &Session) -> Result<bool> {
    let help = "how subdomains are dealt to ranks";
    let options = Options::new(session, "fetifeti_");
    Ok(options.choice("distribution", &["block", "cyclic"], 0, help)? == 1)
}

/// A predicate: whether this rank owns a subdomain, according to the options.
pub(crate) fn owner(session: &Session, scene: &Scene) -> Result<impl Fn(usize) -> bool> {
    let cyclic = is_cyclic(session)?;
    let (size, rank) = (session.size(), session.rank());
    let share = contiguous_share(scene.n_subdomains(), size, rank);
    Ok(move |s: usize| match cyclic {
        true => s % size == rank,
        false => share.contains(&s),
    })
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

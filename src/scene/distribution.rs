//! The distribution of subdomains over ranks, and this rank's part of a scene.

use std::ops::Range;
use std::path::Path;

use super::checked::Scene;
use super::fits;
use crate::error::{Error, Result};
use crate::mesh::contiguous_share;
use crate::parallel::exchange::gather_all;
use crate::petsc::{Options, Session};
use crate::substructures::Substructures;

/// Reads the scene and puts its options into the database, below those of the user. Collective.
pub(crate) fn load(session: &Session, path: &Path) -> Result<Scene> {
    let scene = session.agree(fits::load(session, path))?;
    same_on_all_ranks(session, path, &scene)?;
    set_options(session, &scene)?;
    Ok(scene)
}

/// Refuses a scene of which ranks have read different files, as those of different machines may be: the text, counts,
/// and the nodes of meshes are compared. Collective.
///
/// # Errors
/// [`Error::Environment`] with the ranks that differ from rank 0.
pub(crate) fn same_on_all_ranks(session: &Session, path: &Path, scene: &Scene) -> Result<()> {
    if session.size() == 1 {
        return Ok(());
    }
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut add = |word: u64| hash = (hash ^ word).wrapping_mul(0x0100_0000_01b3).rotate_left(23);
    let text = std::fs::read(path).unwrap_or_default();
    text.iter().for_each(|&byte| add(byte.into()));
    for body in &scene.bodies {
        let mesh = body.mesh();
        add(mesh.n_nodes() as u64);
        add(mesh.n_subdomains() as u64);
        let points = mesh.cells().map(|mesh| mesh.points.iter().flatten());
        points.into_iter().flatten().for_each(|x| add(x.to_bits()));
    }
    let all = gather_all(session.comm(), &[hash]);
    let differ = |rank: &usize| all[*rank] != all[0];
    let differ: Vec<String> = (0..all.len())
        .filter(differ)
        .map(|r| r.to_string())
        .collect();
    if differ.is_empty() {
        return Ok(());
    }
    Err(Error::Environment(format!(
        "{}: rank {} has read another file than rank 0, expected the same files on all machines",
        path.display(),
        differ.join(", ")
    )))
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
    let share = share(scene, size, rank);
    Ok(move |s: usize| match cyclic {
        true => s % size == rank,
        false => share.contains(&s),
    })
}

/// The block of subdomains of a rank: of equal work where there are meshes of cells, else of equal number. A body may
/// lie on several ranks.
fn share(scene: &Scene, ranks: usize, rank: usize) -> Range<usize> {
    let n = scene.n_subdomains();
    if ranks == 1 || scene.bodies.iter().all(|b| b.mesh().cells().is_none()) {
        return contiguous_share(n, ranks, rank);
    }
    let works = scene.bodies.iter().flat_map(|body| {
        let nodes = |s: usize| match body.mesh().cells() {
            Some(mesh) => mesh.parts.nodes(s).len(),
            None => body.mesh().subdomain_nodes(s).len(),
        };
        let count = body.mesh().n_subdomains();
        (0..count).map(move |s| ((body.components * nodes(s)) as f64).powf(WORK))
    });
    by_work(&works.collect::<Vec<f64>>(), ranks, rank)
}

/// The work of a subdomain grows as this power of its unknowns: solves as the power 1.2 to 1.4, factorisations as 1.5
/// in the plane and 2 in space.
const WORK: f64 = 1.5;

/// The items of a rank if all are dealt out in contiguous blocks of about equal work. Every rank gets one if there are
/// enough.
fn by_work(works: &[f64], ranks: usize, rank: usize) -> Range<usize> {
    let n = works.len();
    if n <= ranks {
        return contiguous_share(n, ranks, rank);
    }
    let total: f64 = works.iter().sum();
    // An item belongs to the block in which its middle lies.
    let mut done = 0.0;
    let middles: Vec<f64> = works
        .iter()
        .map(|w| {
            done += w;
            (done - 0.5 * w) / total
        })
        .collect();
    let start = |r: usize| {
        let bound = r as f64 / ranks as f64;
        middles
            .partition_point(|m| *m < bound)
            .clamp(r, n - (ranks - r))
    };
    start(rank)..start(rank + 1)
}

/// This rank's part of the scene, assembled. Collective.
pub(crate) fn substructures(session: &Session, scene: &Scene) -> Result<Substructures> {
    session.agree(fits::assembled(session, scene))?;
    let owns = owner(session, scene)?;
    let threads = if session.size() == 1 { 0 } else { 1 };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|e| Error::environment(format!("cannot start threads: {e}")))?;
    let built = pool.install(|| scene.substructures(&owns));
    session.agree(built.and_then(|built| measurable(&scene.title, built)))
}

/// The substructures, if squares of forces, stiffnesses and displacements are numbers: norms are made of them.
fn measurable(title: &str, built: Substructures) -> Result<Substructures> {
    for sub in &built.local {
        let force = sub.f.iter().fold(0.0_f64, |a, f| a.max(f.abs()));
        let stiffness = sub.k.diagonal().into_iter().filter(|k| *k > 0.0);
        let (low, high) = stiffness.fold((f64::INFINITY, 0.0_f64), |(low, high), k| {
            (low.min(k), high.max(k))
        });
        let sizes = [force, high, force / low];
        if sizes.iter().all(|s| s.abs() < LARGEST_SQUARED) {
            continue;
        }
        return Err(Error::Input(format!(
            "{title}: in a subdomain of body `{}` nodal forces are up to {force:.1e} and stiffnesses from {low:.1e} to \
             {high:.1e}, whose squares are no numbers (take other units, for `load`, `size`, `rho` or `young`)",
            built.body_names[sub.body]
        )));
    }
    Ok(built)
}

/// Sums of squares up to this are far from overflow.
const LARGEST_SQUARED: f64 = 1e145;

#[cfg(test)]
#[path = "../../tests/inside/scene/distribution.rs"]
mod tests;

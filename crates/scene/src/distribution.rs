//! The distribution of subdomains over ranks, and this rank's part of a scene.

use std::path::Path;

use super::checked::Scene;
use super::fits;
use super::model::spec::SceneSpec;
use super::part::RankPart;
use base::{Error, Result};
use fetifeti::Problem;
use parallel::exchange::gather_all;
use petsc::{Options, Session};

/// Reads the scene and puts its options into the database, below those of the user. Collective.
pub fn load(session: &Session, path: &Path) -> Result<Scene> {
    given(session, path, fits::load(session, path))
}

/// Reads the scene and leaves the database as it is, for [`with_options`]. Collective.
pub fn read(session: &Session, path: &Path) -> Result<Scene> {
    agreed(session, path, fits::load(session, path))
}

/// [`load`] for a program that needs the rows of the rank's own points alone.
pub fn load_part(session: &Session, path: &Path) -> Result<Scene> {
    let mut cyclic = false;
    let read = fits::load_part(session, path, |spec| {
        let part = rank_part(session, spec)?;
        cyclic = part.cyclic;
        Ok(part)
    });
    let mut scene = given(session, path, read)?;
    // PETSc may read the scene's options otherwise: it ignores case.
    if cyclic != is_cyclic(session)? {
        return load(session, path);
    }
    let contact = gather_all(session.comm(), &[u32::from(scene.has_contact())]);
    scene.contact_elsewhere = contact.concat().contains(&1);
    Ok(scene)
}

/// The scene that all ranks have read, with its options in the database.
fn given(session: &Session, path: &Path, read: Result<Scene>) -> Result<Scene> {
    let scene = agreed(session, path, read)?;
    set_options(session, &scene.options)?;
    Ok(scene)
}

/// The scene that all ranks have read.
fn agreed(session: &Session, path: &Path, read: Result<Scene>) -> Result<Scene> {
    let scene = session.agree(read)?;
    same_on_all_ranks(session, path, &scene)?;
    Ok(scene)
}

/// Refuses a scene of which ranks have read different files, as those of different machines may be: the text, counts,
/// and the nodes of meshes are compared. Collective.
///
/// # Errors
/// [`ErrorKind::Environment`](base::ErrorKind::Environment) with the ranks that differ from rank 0.
pub fn same_on_all_ranks(session: &Session, path: &Path, scene: &Scene) -> Result<()> {
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
    Err(Error::environment(format!(
        "{}: rank {} has read another file than rank 0, expected the same files on all machines",
        path.display(),
        differ.join(", ")
    )))
}

/// Calls `work` with the options of a scene in the database, below those of the user, and removes them afterwards. It
/// serves programs that process several scenes.
pub fn with_options<T>(
    session: &Session,
    options: &[(String, String)],
    work: impl FnOnce() -> Result<T>,
) -> Result<T> {
    let set = set_options(session, options)?;
    let done = work();
    for name in set {
        Options::new(session, "").clear_value(name)?;
    }
    done
}

/// Returns the names of the options that the user has not set.
fn set_options<'a>(session: &Session, options: &'a [(String, String)]) -> Result<Vec<&'a str>> {
    let database = Options::new(session, "");
    let mut set = Vec::new();
    for (name, value) in options {
        if database.set_default(name, value)? {
            set.push(name.as_str());
        }
    }
    Ok(set)
}

/// Whether subdomains are dealt to ranks one after the other in turn, and not in contiguous blocks. Reads the option
/// `-fetifeti_distribution`.
pub fn is_cyclic(session: &Session) -> Result<bool> {
    is_cyclic_unless(session, None)
}

/// [`is_cyclic`] where a scene may have a value that is not in the database yet.
fn is_cyclic_unless(session: &Session, value: Option<&str>) -> Result<bool> {
    let help = "how subdomains are dealt to ranks";
    let names = ["block", "cyclic"];
    let default = names.iter().position(|name| Some(*name) == value);
    let options = Options::new(session, "fetifeti_");
    Ok(options.choice("distribution", &names, default.unwrap_or(0), help)? == 1)
}

/// The part of this rank of what `spec` describes.
fn rank_part(session: &Session, spec: &SceneSpec) -> Result<RankPart> {
    let own = spec.options.iter().find(|(key, _)| key == DISTRIBUTION);
    let cyclic = is_cyclic_unless(session, own.map(|o| o.1.as_str()))?;
    Ok(of_rank(session, cyclic))
}

/// The part of this rank.
fn of_rank(session: &Session, cyclic: bool) -> RankPart {
    RankPart {
        cyclic,
        ranks: session.size(),
        rank: session.rank(),
    }
}

/// The option that [`is_cyclic`] reads.
const DISTRIBUTION: &str = "fetifeti_distribution";

/// A predicate: whether this rank owns a subdomain, according to the options.
pub fn owner(session: &Session, scene: &Scene) -> Result<impl Fn(usize) -> bool> {
    Ok(of_rank(session, is_cyclic(session)?).owns(&scene.bodies))
}

/// For each body the ranks that own subdomains of it, according to the options.
pub fn ranks_of<'a>(
    session: &Session,
    scene: &'a Scene,
) -> Result<impl Fn(usize) -> Vec<usize> + use<'a>> {
    Ok(of_rank(session, is_cyclic(session)?).ranks_of(&scene.bodies))
}

/// This rank's part of the scene, assembled. Collective.
pub fn substructures(session: &Session, scene: &Scene) -> Result<Problem> {
    session.agree(fits::assembled(session, scene))?;
    let owns = owner(session, scene)?;
    let threads = if session.size() == 1 { 0 } else { 1 };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|e| Error::environment("cannot start threads").because(e))?;
    let built = pool.install(|| scene.substructures(&owns));
    session.agree(built.and_then(|built| measurable(&scene.title, built)))
}

/// The substructures, if squares of forces, stiffnesses and displacements are numbers: norms are made of them.
fn measurable(title: &str, built: Problem) -> Result<Problem> {
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
        return Err(Error::input(format!(
            "{title}: in a subdomain of body `{}` nodal forces are up to {force:.1e} and stiffnesses from {low:.1e} to \
             {high:.1e}, whose squares are no numbers (take other units, for `load`, `size`, `rho` or `young`)",
            built.body_names[sub.body]
        )));
    }
    Ok(built)
}

/// Sums of squares up to this are far from overflow.
const LARGEST_SQUARED: f64 = 1e145;

//! The materials of bodies, where they are few.

use std::collections::{BTreeMap, BTreeSet};

use super::GatherTarget;
use bytemuck::{Pod, Zeroable};
use parallel::exchange::gather_all;
use petsc::Session;
use scene::assembly::SubdomainMesh;
use scene::{LawSpec, Scene, SteppedMesh};

/// A body of more materials than this has one point per node.
const MOST: usize = 16;

/// ρ, or Young's modulus, and Poisson's ratio, as bits, and the number of a law that is not isotropic.
type MaterialKey = [u64; 3];

/// A material of a body.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct BodyMaterial {
    body: usize,
    key: MaterialKey,
}

/// The materials of every body.
pub(super) struct Materials(BTreeMap<usize, BTreeSet<MaterialKey>>);

/// The materials of one body.
pub(super) struct OfBody(Vec<MaterialKey>);

impl Materials {
    /// The materials of some subdomains, or of all ranks' subdomains where every rank has its own. Collective.
    pub fn new(
        session: &Session,
        scene: &Scene,
        parts: &[SteppedMesh],
        place: GatherTarget,
    ) -> Materials {
        // Scalar fields have no stress.
        if scene.form.is_elastic() {
            Materials::told_apart(session, parts, place)
        } else {
            Materials(BTreeMap::new())
        }
    }

    /// The materials of subdomains as [`new`](Self::new) finds them, in scalar problems, too. Collective.
    pub fn told_apart(session: &Session, parts: &[SteppedMesh], place: GatherTarget) -> Materials {
        let mut all = Materials(BTreeMap::new());
        for mesh in parts.iter().map(SteppedMesh::mesh) {
            let mut last = None;
            for key in (0..mesh.n_elements()).map(|e| key(mesh, e)) {
                if last.replace(key) != Some(key) {
                    all.add(mesh.body, key);
                }
            }
        }
        if place == GatherTarget::EachRank {
            let pairs = all
                .0
                .iter()
                .flat_map(|(b, keys)| keys.iter().map(move |k| (*b, *k)));
            let mine: Vec<BodyMaterial> = pairs
                .map(|(body, key)| BodyMaterial { body, key })
                .collect();
            for BodyMaterial { body, key } in gather_all(session.comm(), &mine).concat() {
                all.add(body, key);
            }
        }
        all
    }

    fn add(&mut self, body: usize, key: MaterialKey) {
        let keys = self.0.entry(body).or_default();
        if keys.len() <= MOST {
            keys.insert(key);
        }
    }

    /// The materials of a body.
    pub fn of(&self, body: usize) -> OfBody {
        let keys = self.0.get(&body).filter(|keys| keys.len() <= MOST);
        OfBody(keys.into_iter().flatten().copied().collect())
    }
}

impl OfBody {
    /// Number of materials that are told apart.
    pub fn count(&self) -> usize {
        self.0.len().max(1)
    }

    /// The number of the material of an element.
    pub fn number(&self, mesh: &SubdomainMesh, e: usize) -> usize {
        match self.0.len() {
            0 | 1 => 0,
            _ => self.0.binary_search(&key(mesh, e)).unwrap_or(0),
        }
    }
}

fn key(mesh: &SubdomainMesh, e: usize) -> MaterialKey {
    let poisson = mesh.poisson.get(e).copied().unwrap_or(0.0);
    let [first, second] = [mesh.rho[e], poisson].map(f64::to_bits);
    let law = mesh.laws.of.get(e).map_or(LawSpec::ISOTROPIC, |of| of[0]);
    [first, second, law.into()]
}

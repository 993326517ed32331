//! Bodies that touch without a common node, and that nothing joins: a sentence for each pair.
//!
//! Only pairs without an interface and without an equation between them are looked at. A tree of boxes finds those that
//! may touch; then the smaller surface looks for the larger one in the tree that this one has. With n faces in all and
//! a bounded number of neighbours that takes n log n steps.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use super::interface::BodyInterface;
use super::mortar::surface;
use crate::body::Body;
use crate::rows::row::Row;
use base::linalg::vec3::{minus, norm};
use elements::form::Form;
use elements::mortar::{self, MortarSide, Tree};
use mesh::Mesh;

/// Surfaces touch if their distance, or their overlap, is at most this fraction of their shortest edge: what `auto`
/// takes for contact where nothing is said.
const NEAR: f64 = 0.1;

/// Surfaces that touch over less than this fraction of the smallest face touch at an edge or a corner.
const SMALL: f64 = 1e-3;

/// Pairs that have a sentence of their own.
const LIST: usize = 8;

/// In which language joints are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Language {
    /// A scene: [[tie]] and [[contact]].
    Scene,
    /// A deck: *TIE and *CONTACT PAIR.
    Deck,
}

/// A sentence for each pair of bodies that touch and that nothing joins.
pub(crate) fn sentences(
    bodies: &[Body],
    interfaces: &[BodyInterface],
    rows: &[Row],
    form: &Form,
    language: Language,
) -> Vec<String> {
    let joined = joined(bodies, interfaces, rows);
    let mut skins: HashMap<usize, Skin> = HashMap::new();
    let mut out = Vec::new();
    let mut more = 0;
    for pair in near(bodies) {
        if joined.contains(&pair) {
            continue;
        }
        for b in pair {
            let skin = || Skin::new(&bodies[b], form);
            skins.entry(b).or_insert_with(skin);
        }
        let Some(common) = touch([&skins[&pair[0]], &skins[&pair[1]]]) else {
            continue;
        };
        if out.len() < LIST {
            out.push(sentence(pair.map(|b| &bodies[b]), &common, language))
        } else {
            more += 1
        }
    }
    if more > 0 {
        out.push(format!(
            "{more} more pairs of bodies touch without a common node, and nothing joins them."
        ));
    }
    out
}

/// The pairs of bodies that something joins.
fn joined(bodies: &[Body], interfaces: &[BodyInterface], rows: &[Row]) -> HashSet<[usize; 2]> {
    let mut out: HashSet<[usize; 2]> = interfaces.iter().map(|i| i.bodies).collect();
    for equation in rows.iter().filter_map(|row| row.combination.as_ref()) {
        let of = |dof: u64| bodies.partition_point(|b| b.first_dof <= dof) - 1;
        let mut all: Vec<usize> = equation.terms.iter().map(|t| of(t.0)).collect();
        all.sort_unstable();
        all.dedup();
        for (k, &a) in all.iter().enumerate() {
            out.extend(all[k + 1..].iter().map(|&b| [a, b]));
        }
    }
    out
}

/// The pairs of bodies whose boxes are so near that their surfaces may touch, in increasing order.
fn near(bodies: &[Body]) -> Vec<[usize; 2]> {
    // No edge is longer than the diagonal of the box.
    let wide = |body: &Body| {
        let [low, high] = body.bounds;
        let slack = 0.5 * NEAR * norm(minus(high, low));
        [low.map(|x| x - slack), high.map(|x| x + slack)]
    };
    let boxes: Vec<[[f64; 3]; 2]> = bodies.iter().map(wide).collect();
    let tree = Tree::new(boxes.clone());
    let pairs = boxes.iter().enumerate().flat_map(|(a, place)| {
        let found = tree.meet(place).into_iter().map(|b| b as usize);
        found.filter(move |&b| b > a).map(move |b| [a, b])
    });
    pairs.collect()
}

/// The surface of a body.
struct Skin {
    /// Its outer sides.
    sides: Vec<(usize, Arc<MortarSide>)>,
    /// Its shortest edge, and how large its smallest face is at least.
    shortest: f64,
    least: f64,
    /// How many faces it has.
    faces: usize,
}

impl Skin {
    fn new(body: &Body, form: &Form) -> Skin {
        let side = |s: usize| (s, surface(&body.spec, s, form.element).0);
        let sides: Vec<(usize, Arc<MortarSide>)> = body.mesh().outer_sides().map(side).collect();
        let each = sides.iter().map(|(_, side)| side.shortest());
        let shortest = each.fold(f64::INFINITY, f64::min);
        Skin {
            least: shortest.powi(body.mesh().dim() as i32 - 1),
            faces: sides.iter().map(|(_, side)| side.faces().len()).sum(),
            shortest,
            sides,
        }
    }
}

/// The common part of two surfaces.
struct Common {
    /// Its area; in the plane its length.
    area: f64,
    /// The faces that belong to it, of the first and of the second body: sides, and places in them.
    faces: [HashSet<(usize, u32)>; 2],
}

/// Where two surfaces touch.
fn touch(skins: [&Skin; 2]) -> Option<Common> {
    let reach = NEAR * skins[0].shortest.min(skins[1].shortest);
    let least = SMALL * skins[0].least.min(skins[1].least);
    let mut common = Common {
        area: 0.0,
        faces: [HashSet::new(), HashSet::new()],
    };
    let small = usize::from(skins[1].faces < skins[0].faces);
    for (s, own) in &skins[small].sides {
        for (t, other) in &skins[1 - small].sides {
            for sample in mortar::samples(own, other, reach) {
                common.area += sample.weight;
                common.faces[small].insert((*s, sample.face));
                common.faces[1 - small].insert((*t, sample.other));
            }
        }
    }
    (common.area > least).then_some(common)
}

fn sentence(bodies: [&Body; 2], common: &Common, language: Language) -> String {
    let [a, b] = bodies.map(|body| &body.spec.name);
    let what = match bodies[0].mesh().dim() {
        2 => "a length",
        _ => "an area",
    };
    let [x, y] = [0, 1].map(|k| named(bodies[k], &common.faces[k]));
    let meshes = bodies.iter().all(|body| body.mesh().cells().is_some());
    let (sides, write) = match (x, y) {
        (Some(x), Some(y)) => {
            let write = match (language, meshes) {
                (Language::Deck, _) => {
                    format!("*TIE or *CONTACT PAIR with the surfaces {x} and {y} joins them")
                }
                (_, true) => format!("[[tie]] or [[contact]] with `surfaces = [\"{x}\", \"{y}\"]` joins them"),
                _ => format!(
                    "[[tie]] or [[contact]] with `bodies = [\"{a}\", \"{b}\"]` and `sides = [\"{x}\", \"{y}\"]` joins \
                     them"
                ),
            };
            (format!(" (surfaces `{x}` and `{y}`)"), write)
        }
        _ => {
            let write = match language {
                Language::Deck => "*TIE or *CONTACT PAIR with a *SURFACE on each joins them",
                Language::Scene => {
                    "[[tie]] or [[contact]] joins them where `surfaces` names a boundary group of the mesh on each"
                }
            };
            (String::new(), write.into())
        }
    };
    let auto = match language {
        Language::Deck => "",
        Language::Scene => ", and `[contact] auto = true` finds them",
    };
    format!(
        "Bodies `{a}` and `{b}` touch over {what} of {:.3e}{sides} without a common node, and nothing joins them: \
         {write}{auto}.",
        common.area
    )
}

/// The side that has the most of some faces of the surface of a body. Of a mesh it is a group; `None`: no group has
/// half of them.
fn named<'a>(body: &'a Body, faces: &HashSet<(usize, u32)>) -> Option<&'a str> {
    let Mesh::Cells(mesh) = body.mesh() else {
        let mut counts = HashMap::new();
        faces
            .iter()
            .for_each(|f| *counts.entry(f.0).or_insert(0) += 1);
        let most = counts
            .into_iter()
            .max_by_key(|&(side, n)| (n, usize::MAX - side))?;
        return Some(body.mesh().side_name(most.0));
    };
    let skin = &mesh.sides[mesh.skin()].faces;
    let meant: HashSet<(u32, u8)> = faces.iter().map(|f| skin[f.1 as usize]).collect();
    let count = |side: &usize| {
        let of = mesh.sides[*side].faces.iter();
        of.filter(|face| meant.contains(face)).count()
    };
    let groups = (0..mesh.skin()).map(|side| (side, count(&side)));
    // Of equals the first.
    let (side, n) = groups.max_by_key(|&(side, n)| (n, usize::MAX - side))?;
    (2 * n >= meant.len()).then(|| body.mesh().side_name(side))
}

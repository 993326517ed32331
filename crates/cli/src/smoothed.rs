//! Pressures without the oscillations of the finer side.
//!
//! Where the side with the multipliers has the finer mesh, its nodes feel every face of the other side, and pressures
//! oscillate from face to face. With the coefficients m_pq of the rows, w_pq = |m_pq| / Σ_q |m_pq|, and the areas D_p
//!
//! ```text
//!     P_q = Σ_p w_pq D_p p_p / Σ_p w_pq D_p,    (S p)_p = Σ_q w_pq P_q
//! ```
//!
//! are the pressures at the nodes of the other side and their values back on this one: S keeps the force, and on equal
//! faces it takes away whatever has their period. It also flattens what is curved, for the most part not twice:
//! 2 S − S² has that error squared (Tukey's twicing). Nodes that do not touch have no part in it. Opposite faces of
//! second order, which bend with the other side, pressures oscillate less than this flattens: they stay as they are.

use std::collections::{BTreeMap, HashMap};

use fetifeti::problem::{BodyNode, RowSource};
use fetifeti::solution::SolvedRow;
use scene::{InterfaceShape, Scene};

/// Pressures are smoothed where the side with the multipliers is finer by more than this factor. Between meshes that
/// are nearly alike smoothing takes away more than it mends (docs/benchmarks.md).
const FINER: f64 = 1.75;

/// Deviations from the smoothed pressures above this part of the largest one, as root mean square, are a warning.
const OSCILLATES: f64 = 0.05;

/// The pressures of rows from one interface.
struct PressureSide<'a> {
    /// Places of the rows that touch.
    places: Vec<usize>,
    /// Their areas and pressures.
    area: Vec<f64>,
    raw: Vec<f64>,
    /// The nodes of the other side with w_pq.
    weights: Vec<Vec<(usize, f64)>>,
    scene: &'a Scene,
}

/// How far pressures of an interface are from the smoothed ones.
pub(super) struct Oscillation {
    /// The number of the interface.
    pub interface: usize,
    /// By which factor the side with the multipliers is finer.
    pub finer: f64,
    /// The root mean square of the deviations over the largest smoothed pressure.
    pub size: f64,
}

/// The pressure of each row, smoothed where the finer side carries the multipliers, and what that has changed. Rows
/// without an area have NaN. All rows of an interface are to be there.
pub(super) fn smoothed(scene: &Scene, rows: &[SolvedRow]) -> (Vec<f64>, Vec<Oscillation>) {
    let raw = rows.iter().map(|r| r.pressure().unwrap_or(f64::NAN));
    let mut out: Vec<f64> = raw.collect();
    let mut found = Vec::new();
    for (interface, side) in sides(scene, rows) {
        let finer = side.finer();
        if finer <= FINER {
            continue;
        }
        let once = side.spread(&side.raw);
        let left: Vec<f64> = side.raw.iter().zip(&once).map(|(p, s)| p - s).collect();
        let back = side.spread(&left);
        let twice: Vec<f64> = once.iter().zip(&back).map(|(s, b)| s + b).collect();
        for (&place, &pressure) in side.places.iter().zip(&twice) {
            out[place] = pressure;
        }
        let all = side.raw.iter().zip(&twice).zip(&side.area);
        let square: f64 = all.map(|((p, s), d)| d * (p - s).powi(2)).sum();
        let largest = twice.iter().fold(0.0_f64, |a, p| a.max(p.abs()));
        let area: f64 = side.area.iter().sum();
        found.push(Oscillation {
            interface,
            finer,
            size: if largest > 0.0 {
                (square / area).sqrt() / largest
            } else {
                0.0
            },
        });
    }
    (out, found)
}

/// A sentence for each interface of which the pressures oscillate.
pub(super) fn warnings(scene: &Scene, rows: &[SolvedRow]) -> Vec<String> {
    let (_, found) = smoothed(scene, rows);
    let all = found.iter().filter(|o| o.size > OSCILLATES);
    all.map(|o| {
        let interface = &scene.interfaces[o.interface];
        let own = interface.mortar.as_ref().map_or(0, |m| m.multipliers);
        let [own, other] =
            [own, 1 - own].map(|i| &scene.bodies[interface.bodies[i]].spec.name);
        format!(
            "the pressures between `{own}` and `{other}` oscillate by {:.0} % of the largest one (root mean square): \
             the side of `{own}` carries the multipliers, and its nodes are closer by a factor of {:.1}. Let the \
             coarser side carry them (name its surface first, or as `multipliers`; in a deck make it the \
             slave), or take the column `pressure_smoothed` of interfaces.csv",
            100.0 * o.size,
            o.finer
        )
    })
    .collect()
}

/// The rows that touch by interface, where nodes do not match.
fn sides<'a>(scene: &'a Scene, rows: &[SolvedRow]) -> BTreeMap<usize, PressureSide<'a>> {
    let mut out: BTreeMap<usize, PressureSide> = BTreeMap::new();
    type Key = (RowSource, [Option<BodyNode>; 2]);
    let contacts = scene.mortar_rows().filter(|m| m.law.is_inequality());
    let of: HashMap<Key, _> = contacts.map(|m| ((m.source, m.members), m)).collect();
    if of.is_empty() {
        return out;
    }
    let mut straight: HashMap<usize, bool> = HashMap::new();
    for (place, row) in rows.iter().enumerate() {
        let RowSource::Interface(k) = row.label.source else {
            continue;
        };
        let known = of.get(&(row.label.source, row.label.members));
        let (Some(mortar), Some(pressure)) = (known, row.pressure()) else {
            continue;
        };
        let interface = &scene.interfaces[k];
        let other = 1 - scene.carrier(row.label.source);
        let theirs = interface.order[other];
        let straight = straight.entry(k).or_insert_with(|| {
            let spec = &scene.bodies[interface.bodies[theirs]].spec;
            let mut faces = spec.faces(interface.sides[theirs]);
            faces.all(|face| face.nodes.len() == face.outline().len())
        });
        if !*straight
            || !row.is_inequality()
            || !row.holds()
            || interface.shape != InterfaceShape::Face
        {
            continue;
        }
        let side = out.entry(k).or_insert_with(|| PressureSide {
            places: Vec::new(),
            area: Vec::new(),
            raw: Vec::new(),
            weights: Vec::new(),
            scene,
        });
        let theirs = || mortar.side(other);
        let sum: f64 = theirs().map(|(_, m)| m.abs()).sum();
        side.places.push(place);
        side.area.push(row.label.area);
        side.raw.push(pressure);
        let weights = theirs().map(|(q, m)| (q.node, m.abs() / sum));
        side.weights.push(weights.collect());
    }
    out
}

impl PressureSide<'_> {
    /// S of some values at the nodes.
    fn spread(&self, values: &[f64]) -> Vec<f64> {
        let mut theirs: HashMap<usize, (f64, f64)> = HashMap::new();
        for ((weights, area), value) in self.weights.iter().zip(&self.area).zip(values) {
            for &(q, w) in weights {
                let sums = theirs.entry(q).or_default();
                sums.0 += w * area * value;
                sums.1 += w * area;
            }
        }
        let mean = |q: &usize| match theirs[q] {
            (_, 0.0) => 0.0,
            (sum, area) => sum / area,
        };
        let back = |weights: &Vec<(usize, f64)>| weights.iter().map(|(q, w)| w * mean(q)).sum();
        self.weights.iter().map(back).collect()
    }

    /// By which factor the nodes are closer to each other than those of the other side, from the areas that belong to
    /// them.
    fn finer(&self) -> f64 {
        let mut theirs: BTreeMap<usize, f64> = BTreeMap::new();
        for (weights, area) in self.weights.iter().zip(&self.area) {
            for &(q, w) in weights {
                *theirs.entry(q).or_default() += w * area;
            }
        }
        // Nodes at the rim of the contact have parts of their areas: the mean counts areas by their size.
        let mean = |areas: &mut dyn Iterator<Item = f64>| {
            let (square, sum) = areas.fold((0.0, 0.0), |(s, t), a| (s + a * a, t + a));
            square / sum
        };
        let [own, other] = [
            mean(&mut self.area.iter().copied()),
            mean(&mut theirs.into_values()),
        ];
        let across = self.scene.dim() - 1;
        (other / own).powf(1.0 / across as f64)
    }
}

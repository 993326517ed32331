//! Laws of a deck that are not isotropic, with their axes, and expansion by heat.

use super::numbers::DeckNumbering;
use crate::model::body::BodySpec;
use crate::model::heat::{HeatSpec, Temperature};
use crate::model::law::{LawSpec, MaterialAxes, OrientedLaw};
use base::linalg::orthogonal::IDENTITY;
use base::linalg::vec3::{minus, norm};
use deck::Deck;
use elements::law::Law;
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// The laws that are not isotropic, one for each section that has one; `None`: there is none.
pub(super) fn laws(deck: &Deck, part: &[u32]) -> Option<LawSpec> {
    let mut numbers: BTreeMap<u32, u32> = BTreeMap::new();
    let mut laws = Vec::new();
    let mut of_cell = Vec::with_capacity(part.len());
    for &cell in part {
        let place = deck.cell_section[cell as usize];
        let section = &deck.sections[place as usize];
        let material = &deck.materials[section.material as usize];
        let [a, b, c] = material.expansion.unwrap_or_default();
        let tangent = match material.elastic {
            Some(Law::General(tangent)) => tangent,
            // The axes are those of its expansion alone.
            Some(law) if section.orientation.is_some() && (a != b || b != c) => law.tangent(),
            _ => {
                of_cell.push(LawSpec::ISOTROPIC);
                continue;
            }
        };
        of_cell.push(*numbers.entry(place).or_insert_with(|| {
            let thickness = if deck.dim() == 2 {
                section.thickness
            } else {
                1.0
            };
            let orientation = section.orientation.map(|k| &deck.orientations[k as usize]);
            laws.push(OrientedLaw {
                tangent: tangent.scaled(thickness),
                axes: orientation.map_or(MaterialAxes::Fixed(IDENTITY), material_axes),
            });
            laws.len() as u32 - 1
        }));
    }
    (!laws.is_empty()).then_some(LawSpec { laws, of_cell })
}

/// The axes of an *ORIENTATION.
fn material_axes(orientation: &deck::Orientation) -> MaterialAxes {
    let deck::Transform {
        cylindrical, a, b, ..
    } = orientation.axes;
    let mut turn = IDENTITY;
    if let Some((about, degrees)) = orientation.turn {
        // The axes are turned about one of them: the others go towards each other.
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let (e, f) = ((about + 1) % 3, (about + 2) % 3);
        (turn[e][e], turn[e][f]) = (cosine, sine);
        (turn[f][e], turn[f][f]) = (-sine, cosine);
    }
    if cylindrical {
        let axis = minus(b, a);
        let length = norm(axis);
        return MaterialAxes::Cylinder {
            centre: a,
            axis: axis.map(|x| x / length),
            turn,
        };
    }
    let own = orientation.axes.frame([0.0; 3]);
    let row = |r: &[f64; 3]| -> [f64; 3] {
        std::array::from_fn(|d| (0..3).map(|k| r[k] * own[k][d]).sum())
    };
    MaterialAxes::Fixed([row(&turn[0]), row(&turn[1]), row(&turn[2])])
}

/// Gives bodies that expand the differences of temperatures from those of the beginning.
pub(super) fn heat(deck: &Deck, numbers: &DeckNumbering, step: usize, bodies: &mut [BodySpec]) {
    let mut changes: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
    let before: HashMap<u32, f64> = deck.initial_temperatures.iter().copied().collect();
    for &(node, temperature) in &deck.steps[step].temperatures {
        let change = temperature - before.get(&node).copied().unwrap_or(0.0);
        let Some(at) = numbers.node(node).filter(|_| change != 0.0) else {
            continue;
        };
        let n = bodies[at.body].mesh.n_nodes();
        changes.entry(at.body).or_insert_with(|| vec![0.0; n])[at.node] = change;
    }
    for (b, change) in changes {
        let expansion = numbers.parts[b].iter().map(|&c| {
            let section = &deck.sections[deck.cell_section[c as usize] as usize];
            let material = &deck.materials[section.material as usize];
            material.expansion.unwrap_or_default()
        });
        let expansion: Vec<[f64; 3]> = expansion.collect();
        if expansion.iter().flatten().any(|a| *a != 0.0) {
            bodies[b].heat = Some(HeatSpec {
                expansion,
                temperature: Some(Temperature::AtNodes(Arc::new(change))),
                reference: 0.0,
            });
        }
    }
}

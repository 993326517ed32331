//! The bodies of a deck with material, supports and loads.

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

use super::materials;
use super::numbers::DeckNumbering;
use crate::deck::element::deck_element;
use crate::model::body::{BodySpec, Cut, Force, Load, SurfaceLoad};
use crate::model::expr::Expr;
use crate::model::field::Field;
use crate::model::joints::EquationSpec;
use base::{Error, Result};
use deck::{BodyLoadKind, Deck, DeckLine, Pressure};
use elements::element::Integration;
use elements::law::Law;
use elements::q1::Quadrature;
use mesh::{CellMesh, Extractor, Mesh, SideGroup};

/// An axis of a node's system is along a coordinate if the others are below this.
const ALONG: f64 = 1e-12;

/// The mesh of a body, or what is wrong with it.
pub(super) type Extracted = std::result::Result<Arc<CellMesh>, String>;

/// The meshes of the bodies of a deck. All steps share them.
pub(super) fn meshes(deck: &Deck, numbers: &DeckNumbering) -> Vec<Extracted> {
    let mut file = Extractor::new(&deck.mesh, deck.dim());
    let mesh = |part: &Vec<u32>| match file.extract(part, 1.0) {
        Ok(mesh) => Ok(Arc::new(mesh)),
        Err(error) => Err(error.to_string()),
    };
    numbers.parts.iter().map(mesh).collect()
}

/// The bodies at the end of a step, with cells that are integrated in full or as their elements say, and the supports
/// along oblique axes as equations.
pub(super) fn of(
    deck: &Deck,
    numbers: &DeckNumbering,
    (meshes, in_full): (&[Extracted], bool),
    step: usize,
) -> Result<(Vec<BodySpec>, Vec<EquationSpec>)> {
    let mut out = Vec::with_capacity(numbers.parts.len());
    let mut pressures = vec![Vec::new(); numbers.parts.len()];
    for pressure in &deck.steps[step].pressures {
        let node = deck.mesh.cells.nodes(pressure.cell as usize)[0];
        let at = numbers.node(node);
        at.iter().for_each(|at| pressures[at.body].push(pressure));
    }
    for (b, mesh) in meshes.iter().enumerate() {
        let mesh = mesh.clone().map_err(Error::input)?;
        let part = &numbers.parts[b];
        let mut body = body(deck, b, part, mesh, (step, &pressures[b]))?;
        if in_full {
            body.integration.clear();
        }
        out.push(body);
    }
    name(deck, numbers, &mut out);
    materials::heat(deck, numbers, step, &mut out);
    let equations = supports(deck, numbers, step, &mut out)?;
    forces(deck, numbers, step, &mut out)?;
    Ok((out, equations))
}

/// Names bodies by the element set of their section, or by numbers where that is not unique.
fn name(deck: &Deck, numbers: &DeckNumbering, bodies: &mut [BodySpec]) {
    let section = |part: &[u32]| {
        let first = deck.cell_section[part[0] as usize];
        let one = part.iter().all(|&c| deck.cell_section[c as usize] == first);
        one.then(|| deck.sections[first as usize].elset.clone())
    };
    let names: Vec<Option<String>> = numbers.parts.iter().map(|part| section(part)).collect();
    let mut bodies_of: HashMap<&String, usize> = HashMap::new();
    for name in names.iter().flatten() {
        *bodies_of.entry(name).or_default() += 1;
    }
    for (b, body) in bodies.iter_mut().enumerate() {
        let unique = |name: &&String| bodies_of[name] == 1;
        body.name = match names[b].as_ref().filter(unique) {
            Some(name) => name.clone(),
            None => format!("part {}", b + 1),
        };
    }
}

/// A body at the end of a step, with the pressures on it.
fn body(
    deck: &Deck,
    b: usize,
    part: &[u32],
    mut mesh: Arc<CellMesh>,
    (step, pressed): (usize, &[&Pressure]),
) -> Result<BodySpec> {
    let of_cell = |c: u32| {
        let section = &deck.sections[deck.cell_section[c as usize] as usize];
        (section, &deck.materials[section.material as usize])
    };
    let (mut young, mut poisson, mut thickness) = (Vec::new(), Vec::new(), Vec::new());
    for &c in part {
        let (section, material) = of_cell(c);
        let (e, nu) = match material.elastic {
            Some(Law::Isotropic { young, poisson }) => (young, poisson),
            Some(Law::General(tangent)) => tangent.mean(),
            None => (f64::NAN, f64::NAN),
        };
        let t = if deck.dim() == 2 {
            section.thickness
        } else {
            1.0
        };
        young.push(e * t);
        poisson.push(nu);
        thickness.push(t);
    }
    let rules = part
        .iter()
        .map(|&c| deck_element(deck.elements[c as usize]).0);
    let integration: Vec<Integration> = rules.collect();
    let surface = pressures(part, &mut mesh, &thickness, pressed);
    let load = volume_load(deck, part, &of_cell, &thickness, step)?;
    let mut body = BodySpec::new(format!("part {}", b + 1), Mesh::Cells(mesh));
    body.rho = by_cell(young);
    body.poisson = by_cell(poisson);
    body.law = materials::laws(deck, part);
    body.integration = integration;
    body.surface = surface;
    body.load = load;
    body.cut = Cut::Auto;
    Ok(body)
}

/// Values by cell; a constant where all are equal.
fn by_cell(values: Vec<f64>) -> Field {
    if values.iter().all(|v| *v == values[0]) {
        Field::constant(values[0])
    } else {
        Field::ByCell(Arc::new(values))
    }
}

/// The pressures of a step on one body, as loads on boundary groups of their own, one for each value.
fn pressures(
    part: &[u32],
    mesh: &mut Arc<CellMesh>,
    thickness: &[f64],
    pressed: &[&Pressure],
) -> Vec<SurfaceLoad> {
    let mut by_value: BTreeMap<u64, Vec<(u32, u8)>> = BTreeMap::new();
    for pressure in pressed {
        if let Ok(c) = part.binary_search(&pressure.cell) {
            let value = pressure.value * thickness[c];
            by_value
                .entry(value.to_bits())
                .or_default()
                .push((c as u32, pressure.side));
        }
    }
    let mut loads = Vec::new();
    for (k, (value, mut faces)) in by_value.into_iter().enumerate() {
        faces.sort_unstable();
        let on = |&(c, side): &(u32, u8)| mesh.cells.side_nodes(c as usize, side.into());
        let mut nodes: Vec<u32> = faces.iter().flat_map(on).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let group = SideGroup {
            name: format!("pressure {}", k + 1),
            nodes,
            faces,
        };
        // The whole boundary stays the last.
        let side = mesh.skin();
        Arc::make_mut(mesh).sides.insert(side, group);
        loads.push(SurfaceLoad {
            side,
            force: Force::Pressure(Field::constant(f64::from_bits(value))),
        });
    }
    loads
}

/// Gravity and centrifugal forces.
fn volume_load<'d>(
    deck: &'d Deck,
    part: &[u32],
    of_cell: &dyn Fn(u32) -> (&'d deck::Section, &'d deck::DeckMaterial),
    thickness: &[f64],
    step: usize,
) -> Result<Load> {
    let dim = deck.dim();
    let mut constant = vec![vec![0.0; part.len()]; dim];
    let mut turning: Option<(Vec<String>, DeckLine)> = None;
    for load in &deck.steps[step].body_loads {
        let own = common(part, &load.cells);
        let mass = |inside: usize| {
            let (_, material) = of_cell(part[inside]);
            let density = material.density.ok_or_else(|| {
                deck.files.error(
                    load.place,
                    format!(
                        "a force by mass on material {} without *DENSITY",
                        material.name
                    ),
                )
            })?;
            Ok(density * thickness[inside])
        };
        match load.kind {
            BodyLoadKind::Gravity(acceleration) => {
                for inside in own {
                    let mass = mass(inside)?;
                    for (values, a) in constant.iter_mut().zip(acceleration) {
                        values[inside] += mass * a;
                    }
                }
            }
            BodyLoadKind::Centrifugal {
                omega2,
                point,
                direction,
            } => {
                let masses: Result<Vec<f64>> = own.iter().map(|&k| mass(k)).collect();
                let masses = masses?;
                let Some(&first) = masses.first() else {
                    continue;
                };
                let whole = own.len() == part.len() && masses.iter().all(|m| *m == first);
                if !whole || turning.is_some() {
                    return Err(deck.files.error(
                        load.place,
                        "a centrifugal force on a part of a body, or a second one (one on whole bodies of \
                         one density was expected)",
                    ));
                }
                turning = Some((centrifugal(first * omega2, point, direction), load.place));
            }
        }
    }
    let still = constant.iter().flatten().all(|v| *v == 0.0);
    let fields = match turning {
        Some((_, place)) if !still => {
            return Err(deck.files.error(
                place,
                "a centrifugal force together with gravity (one of them was expected)",
            ))
        }
        Some((formulas, place)) => {
            let parse = |text: &String| {
                let expr = Expr::parse(text).map_err(|e| deck.files.error(place, e))?;
                Ok(Field::Expression(expr))
            };
            formulas[..dim]
                .iter()
                .map(parse)
                .collect::<Result<Vec<Field>>>()?
        }
        None if still => return Ok(Load::constant(0.0)),
        None => constant
            .into_iter()
            .map(|v| Field::ByCell(Arc::new(v)))
            .collect(),
    };
    Ok(Load {
        fields,
        quadrature: Quadrature::Gauss,
    })
}

/// The places in `part` of the cells that are in `cells`, too. Both lists are increasing, and either may be much
/// longer.
fn common(part: &[u32], cells: &[u32]) -> Vec<usize> {
    if cells.len() < part.len() {
        let inside = cells.iter().filter_map(|c| part.binary_search(c).ok());
        return inside.collect();
    }
    let places = 0..part.len();
    let inside = places.filter(|&k| cells.binary_search(&part[k]).is_ok());
    inside.collect()
}

/// strength · (r − (r·d) d) with r = x − point, as formulas.
fn centrifugal(strength: f64, point: [f64; 3], d: [f64; 3]) -> Vec<String> {
    let axes = ["x", "y", "z"];
    let along: Vec<String> = (0..3)
        .map(|k| format!("({:e})*({} - ({:e}))", d[k], axes[k], point[k]))
        .collect();
    let along = along.join(" + ");
    let formula = |k: usize| {
        format!(
            "({strength:e})*({} - ({:e}) - ({:e})*({along}))",
            axes[k], point[k], d[k]
        )
    };
    (0..3).map(formula).collect()
}

/// Given displacements: values of degrees of freedom, or equations along oblique axes.
fn supports(
    deck: &Deck,
    numbers: &DeckNumbering,
    step: usize,
    bodies: &mut [BodySpec],
) -> Result<Vec<EquationSpec>> {
    let dim = deck.dim();
    let mut equations = Vec::new();
    for support in &deck.steps[step].supports {
        let Some(at) = numbers.node(support.node) else {
            continue;
        };
        let axis = axis(deck, support.node, support.dof.into());
        let first = at.node * dim;
        match along(axis) {
            // Nothing moves across the plane.
            Some((d, _)) if d >= dim => {}
            Some((d, sign)) => bodies[at.body]
                .given
                .push((first + d, sign * support.value)),
            None => equations.push(EquationSpec {
                terms: (0..dim).map(|d| (at.body, first + d, axis[d])).collect(),
                value: support.value,
                resolution: 0.0,
                support: true,
                location: deck.files.location(support.place),
            }),
        }
    }
    Ok(equations)
}

/// Axis `dof` of a node's system.
pub(super) fn axis(deck: &Deck, node: u32, dof: usize) -> [f64; 3] {
    match deck.frame(node) {
        Some(frame) => frame[dof],
        None => {
            let mut unit = [0.0; 3];
            unit[dof] = 1.0;
            unit
        }
    }
}

/// The coordinate along which an axis lies, and its sign; `None`: oblique.
fn along(axis: [f64; 3]) -> Option<(usize, f64)> {
    let d = (0..3).max_by(|&a, &b| axis[a].abs().total_cmp(&axis[b].abs()))?;
    let rest = (0..3).filter(|&k| k != d).all(|k| axis[k].abs() < ALONG);
    rest.then(|| (d, axis[d].signum()))
}

/// Forces at nodes.
fn forces(
    deck: &Deck,
    numbers: &DeckNumbering,
    step: usize,
    bodies: &mut [BodySpec],
) -> Result<()> {
    for force in &deck.steps[step].forces {
        let at = (force.node, force.dof);
        let Some(parts) = along_coordinates(deck, numbers, at, force.value) else {
            return Err(deck.files.error(
                force.place,
                format!(
                    "a force at node {}, which no element has",
                    deck.mesh.node_ids[force.node as usize]
                ),
            ));
        };
        for (body, dof, value) in parts {
            bodies[body].forces.push((dof, value));
        }
    }
    Ok(())
}

/// The parts along the coordinates of a `value` along an axis of a node's system: body, degree of freedom, value;
/// `None` for a node that no element has.
pub(super) fn along_coordinates(
    deck: &Deck,
    numbers: &DeckNumbering,
    (node, dof): (u32, u8),
    value: f64,
) -> Option<impl Iterator<Item = (usize, usize, f64)>> {
    let (dim, at) = (deck.dim(), numbers.node(node)?);
    let axis = axis(deck, node, dof.into()).into_iter().take(dim);
    let parts = axis.enumerate().filter(|(_, part)| *part != 0.0);
    Some(parts.map(move |(d, part)| (at.body, at.node * dim + d, value * part)))
}

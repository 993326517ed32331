//! The tables of `fetifeti plan`: bodies, the faces where they touch, rigid surfaces.

use fetifeti::inside::ProblemSizes;
use report::tables::table::Table;
use scene::{BodyPlan, InterfacePlan, Scene, ScenePlan, SidePair};

/// Bodies and interfaces are listed one by one up to this number.
pub(super) const LIST: usize = 24;

/// The bodies with their sizes, and how far they are held.
pub(super) fn bodies(plan: &ScenePlan, sizes: &ProblemSizes) -> String {
    // Only solids have elements in z.
    let solid = plan.bodies.iter().any(|b| b.elements[2] > 0);
    // A mesh of cells has no rows of elements.
    let dim = |b: &BodyPlan| match b.elements[1] {
        0 => 1,
        _ => 2 + usize::from(solid),
    };
    let kernel = |defect: usize| match defect {
        0 => "held".into(),
        d => format!("floats ({d})"),
    };
    let table = Table::of(plan.bodies.iter().zip(&sizes.defect).take(LIST))
        .words("body", |(b, _)| &b.name)
        .numbers("elements", |(b, _)| grid(b.elements, dim(b)))
        .numbers("subdomains", |(b, _)| grid(b.subdomains, dim(b)))
        .numbers("dofs", |(b, _)| b.dofs)
        .numbers("prescribed", |(b, _)| b.prescribed)
        .numbers("primal", |(b, _)| b.primal)
        .numbers("kernel", |(_, defect)| kernel(**defect))
        .table();
    format!("{table}{}\n", more(plan.bodies.len(), "bodies"))
}

/// A line on what a list has beyond the first [`LIST`].
fn more(count: usize, what: &str) -> String {
    match count.saturating_sub(LIST) {
        0 => String::new(),
        n => format!("... and {n} more {what}\n"),
    }
}

/// A number in four digits.
fn short(x: f64) -> String {
    if x == 0.0 || (1e-3..1e5).contains(&x.abs()) {
        format!("{}", format!("{x:.3e}").parse::<f64>().unwrap_or(x))
    } else {
        format!("{x:.3e}")
    }
}

/// Counts in x, y and z, such as "16 x 16 x 16".
fn grid(counts: [usize; 3], dim: usize) -> String {
    let each: Vec<String> = counts[..dim].iter().map(usize::to_string).collect();
    each.join(" x ")
}

/// The pairs of bodies that touch or face each other, by faces or by pairs of nodes, with the area, the gaps and the
/// angle between their sides.
pub(super) fn interfaces(scene: &Scene, plan: &ScenePlan) -> String {
    let surfaces = surfaces(scene);
    if plan.interfaces.is_empty() {
        return surfaces;
    }
    // Pairs of nodes with an area of their own are no faces, and still carry pressures.
    let faces = plan.interfaces.iter().enumerate();
    let faces = faces.filter(|(k, i)| !i.corner || scene.interfaces[*k].area.is_some());
    let name = |b: usize| &plan.bodies[b].name;
    let listed: Vec<(&InterfacePlan, SidePair)> = faces
        .clone()
        .take(LIST)
        .map(|(k, i)| (i, scene.side_pair(k)))
        .collect();
    if listed.is_empty() {
        return surfaces;
    }
    let table = Table::of(&listed)
        .words("touch", |(i, _)| match i.bodies {
            [a, b] if a == b => format!("{} - itself", name(a)),
            [a, b] => format!("{} - {}", name(a), name(b)),
        })
        .numbers("nodes", |(i, _)| i.nodes)
        .numbers("tied", |(i, _)| i.tied)
        .when(plan.contact_pairs > 0, |t| {
            t.numbers("contact", |(i, _)| i.contact)
        })
        .numbers(size(scene), |(_, p)| area(p.area))
        .numbers("gap", |(_, p)| range(p.gap))
        .numbers("angle", |(i, p)| match i.corner {
            true => "–".to_string(),
            false => format!("{:.1}°", p.angle),
        })
        .when(listed.iter().any(|(i, _)| i.multipliers.is_some()), |t| {
            t.words("mortar", |(i, _)| match i.multipliers {
                Some(b) => format!("multipliers on {}", name(b)),
                None => "nodes match".into(),
            })
        })
        .table();
    format!("{table}{}\n{surfaces}", more(faces.count(), "faces"))
}

/// The word for the size of a side.
fn size(scene: &Scene) -> &'static str {
    if scene.dim() == 2 && !scene.form.is_axial() {
        "length"
    } else {
        "area"
    }
}

/// An area, or a dash where there is none, as between nodes without a common face.
fn area(area: f64) -> String {
    match area {
        0.0 => "–".to_string(),
        area => short(area),
    }
}

/// The smallest and the largest gap.
fn range([low, high]: [f64; 2]) -> String {
    if low == high {
        short(low)
    } else {
        format!("{} to {}", short(low), short(high))
    }
}

/// The rigid surfaces beside bodies.
fn surfaces(scene: &Scene) -> String {
    let all = scene.surface_obstacles();
    if all.is_empty() {
        return String::new();
    }
    let table = Table::of(all.iter().take(LIST))
        .words("rigid surface", |s| &s.name)
        .numbers("nodes", |s| s.nodes)
        .numbers(size(scene), |s| area(s.area))
        .numbers("gap", |s| range(s.gap))
        .table();
    format!("{table}{}\n", more(all.len(), "rigid surfaces"))
}

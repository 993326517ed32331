//! Nodal loads of one subdomain: ∫ f N_a, and forces on its sides.

use super::{Grid, SubdomainElements, SubdomainMesh};
use elements::cell::{self, Element, Side};
use elements::q1::Quadrature;
use elements::{element, q1};
use mesh::Cells;

/// The nodal load ∫ f N_a over the subdomain, an entry per degree of freedom. `f` gets an element and a point and
/// returns one value per component of the field.
pub fn load_vector<F>(mesh: &SubdomainMesh, quadrature: Quadrature, f: F) -> Vec<f64>
where
    F: FnMut(usize, [f64; 3]) -> [f64; 3],
{
    match &mesh.elements {
        SubdomainElements::Grid(grid) => load_on_grid(mesh, grid, quadrature, f),
        SubdomainElements::Cells(cells) => load_on_cells(mesh, cells, f),
    }
}

/// Cells take the Gauss rule of their kind, whatever the quadrature.
fn load_on_cells<F>(mesh: &SubdomainMesh, cells: &Cells, mut f: F) -> Vec<f64>
where
    F: FnMut(usize, [f64; 3]) -> [f64; 3],
{
    let c = mesh.components();
    let mut out = vec![0.0; c * mesh.points.len()];
    let (mut points, mut local) = (Vec::new(), Vec::new());
    for (e, (kind, nodes)) in cells.iter().enumerate() {
        points.clear();
        points.extend(nodes.iter().map(|&k| mesh.points[k as usize]));
        local.clear();
        local.resize(c * nodes.len(), 0.0);
        let rule = mesh.integration(e);
        let around = |x| f(e, x).map(|v| v * mesh.form.around(x));
        element::body_load_by(rule, kind, mesh.dim, &points, c, around, &mut local);
        let nodes = nodes.iter().map(|&k| k as usize);
        add(&mut out, c, nodes.zip(local.chunks_exact(c)));
    }
    out
}

fn load_on_grid<F>(mesh: &SubdomainMesh, grid: &Grid, quadrature: Quadrature, mut f: F) -> Vec<f64>
where
    F: FnMut(usize, [f64; 3]) -> [f64; 3],
{
    let c = mesh.components();
    let mut out = vec![0.0; c * mesh.points.len()];
    let box_step = grid.step.filter(|_| mesh.form.element == Element::Q1);
    let corners = grid.corners();
    let mut local = vec![0.0; corners * c];
    for (e, place) in grid.element_places().enumerate() {
        let nodes = grid.element_nodes(place);
        local.fill(0.0);
        match box_step {
            Some(step) => {
                let first = mesh.points[nodes[0]];
                box_load(mesh.dim, c, step, quadrature, &mut local, |s| {
                    f(e, [0, 1, 2].map(|d| first[d] + s[d] * step[d]))
                });
            }
            None => {
                let points = mesh.element_points(grid, place);
                cell::body_load(
                    mesh.dim,
                    &points[..corners],
                    mesh.form.element,
                    quadrature,
                    c,
                    |x| f(e, x),
                    &mut local,
                );
            }
        }
        add(&mut out, c, nodes.into_iter().zip(local.chunks_exact(c)));
    }
    out
}

/// ∫ f N_a over a box; `f` gets a point of the unit cell.
fn box_load(
    dim: usize,
    components: usize,
    step: [f64; 3],
    quadrature: Quadrature,
    out: &mut [f64],
    mut f: impl FnMut([f64; 3]) -> [f64; 3],
) {
    let volume: f64 = step[..dim].iter().product();
    let corners = 1 << dim;
    match quadrature {
        Quadrature::Midpoint => {
            let middle = [0, 1, 2].map(|d| if d < dim { 0.5 } else { 0.0 });
            let share = f(middle).map(|v| v * (volume / corners as f64));
            for node in out.chunks_exact_mut(components) {
                node.iter_mut().zip(share).for_each(|(o, v)| *o += v);
            }
        }
        Quadrature::Gauss => {
            for q in 0..corners {
                let mut s = [0.0; 3];
                let mut weight = volume;
                for (d, s) in s.iter_mut().enumerate().take(dim) {
                    let (point, w) = q1::GAUSS2[q >> d & 1];
                    *s = point;
                    weight *= w;
                }
                let value = f(s).map(|v| v * weight);
                for (a, node) in out.chunks_exact_mut(components).enumerate() {
                    let factor = |d: usize| if a >> d & 1 == 1 { s[d] } else { 1.0 - s[d] };
                    let shape: f64 = (0..dim).map(factor).product();
                    node.iter_mut()
                        .zip(value)
                        .for_each(|(o, v)| *o += shape * v);
                }
            }
        }
    }
}

/// The part of a side of a body that belongs to a subdomain.
#[derive(Debug, Clone, PartialEq)]
pub enum SidePart {
    /// Side `0..2 D` of a grid of elements, which must reach it.
    OfGrid(usize),
    /// Sides of cells: the cell in the subdomain, and the side of its kind.
    Faces(Vec<(u32, u8)>),
}

/// Adds ∫ t N_a over a part of a side to the nodal load `out`. `f` gets the point and the unit normal out of the body.
///
/// # Panics
/// When the part is of a grid and the subdomain is none, or the other way round.
pub fn add_side_load<F>(mesh: &SubdomainMesh, part: &SidePart, f: F, out: &mut [f64])
where
    F: FnMut([f64; 3], [f64; 3]) -> [f64; 3],
{
    match (part, &mesh.elements) {
        (SidePart::OfGrid(side), SubdomainElements::Grid(grid)) => {
            add_on_grid(mesh, grid, *side, f, out)
        }
        (SidePart::Faces(faces), SubdomainElements::Cells(cells)) => {
            add_on_faces(mesh, cells, faces, f, out)
        }
        _ => panic!("a side of another kind of mesh"),
    }
}

fn add_on_faces<F>(
    mesh: &SubdomainMesh,
    cells: &Cells,
    faces: &[(u32, u8)],
    mut f: F,
    out: &mut [f64],
) where
    F: FnMut([f64; 3], [f64; 3]) -> [f64; 3],
{
    let c = mesh.components();
    let mut local = Vec::new();
    for &(cell, side) in faces {
        let (cell, side) = (cell as usize, usize::from(side));
        let kind = cells.kind(cell).sides()[side].kind;
        let nodes: Vec<usize> = cells.side_nodes(cell, side).map(|k| k as usize).collect();
        let points: Vec<[f64; 3]> = nodes.iter().map(|&k| mesh.points[k]).collect();
        local.clear();
        local.resize(c * nodes.len(), 0.0);
        let around = |x, normal| f(x, normal).map(|v| v * mesh.form.around(x));
        element::side_load(kind, mesh.dim, &points, c, around, &mut local);
        add(out, c, nodes.into_iter().zip(local.chunks_exact(c)));
    }
}

fn add_on_grid<F>(mesh: &SubdomainMesh, grid: &Grid, side: usize, mut f: F, out: &mut [f64])
where
    F: FnMut([f64; 3], [f64; 3]) -> [f64; 3],
{
    let c = mesh.components();
    let side = Side::of_index(side);
    let level = side.level(grid.elements);
    let corners: Vec<usize> = side.corners(mesh.dim).collect();
    let mut local = vec![0.0; corners.len() * c];
    for place in grid.element_places().filter(|p| p[side.axis] == level) {
        let nodes = grid.element_nodes(place);
        let points: Vec<[f64; 3]> = corners.iter().map(|&a| mesh.points[nodes[a]]).collect();
        local.fill(0.0);
        let outward = side.outward(mesh.dim);
        let element = mesh.form.element;
        cell::side_load(mesh.dim, &points, outward, element, c, &mut f, &mut local);
        let nodes = corners.iter().map(|&a| nodes[a]);
        add(out, c, nodes.zip(local.chunks_exact(c)));
    }
}

/// Adds the values of some nodes, C each.
fn add<'v>(out: &mut [f64], c: usize, values: impl Iterator<Item = (usize, &'v [f64])>) {
    for (node, values) in values {
        let entries = out[c * node..].iter_mut().zip(values);
        entries.for_each(|(entry, value)| *entry += value);
    }
}

//! How far bodies are moved apart, so that one sees where they touch.
//!
//! Two bodies a and b that touch are to move by t_b − t_a = d n, where n is the mean of the normals out of a. As bodies
//! may touch in rings, all pairs together are a problem of least squares, weighted by the areas of contact. A body that
//! lies between two others then moves with neither of them alone, and through none.

use super::mesh::{bounds, SolidMesh};
use super::surface::{diagonals, VisibleSurface};
use base::linalg::union_find::UnionFind;
use base::linalg::vec3::{cross, dot, minus, norm, unit};
use std::collections::{BTreeMap, HashMap};

/// The distance by which bodies are moved apart, relative to the extent of the smaller one in this direction: for two
/// or three bodies, and for more. Bodies that touch nothing move by it relative to the distance from the middle.
const APART: [f64; 2] = [0.75, 0.5];
/// The least distance between bodies that were moved apart, relative to the scene's size.
const LEAST: f64 = 0.08;
/// A body encloses another if the normals of their contact cancel to this part of its area.
const CLOSED: f64 = 0.05;
/// The weight of faces that are tied, beside that of faces that may open. These decide where both contradict each
/// other, as at a bolt whose head is in contact and whose nut is tied.
const TIED: f64 = 1e-3;

/// The corners of a face.
type FaceCorners = [[f64; 3]; 4];

/// The faces in which two bodies touch.
#[derive(Default)]
struct TouchingFaces {
    /// The sum of normals out of the first body, each as long as its face is large.
    normals: [f64; 3],
    /// The sum of the areas.
    area: f64,
    /// ∫ n nᵀ.
    spread: [[f64; 3]; 3],
    /// Whether it may open; otherwise the bodies are tied.
    may_open: bool,
}

/// A shift t_b − t_a that two bodies are to have, and its weight.
pub(super) struct Wish {
    pub bodies: [usize; 2],
    pub shift: [f64; 3],
    pub weight: f64,
}

/// The shift of each body.
pub(super) fn shifts(solid: &SolidMesh, surface: &VisibleSurface) -> Vec<[f64; 3]> {
    let n = solid.body.iter().max().map_or(0, |&b| b as usize + 1);
    let mut faces: Vec<Vec<FaceCorners>> = vec![Vec::new(); n];
    for face in &surface.faces {
        let corners = face.corners.map(|p| solid.points[p as usize]);
        faces[solid.body[face.cell as usize] as usize].push(corners);
    }
    let [low, high] = bounds(solid.points.iter().copied());
    let apart = APART[usize::from(n > 3)];
    let least = LEAST * norm(minus(high, low));
    let wishes: Vec<Wish> = contacts(solid, surface)
        .into_iter()
        .map(|([a, b], contact)| {
            let away = minus(middle(&faces[b]), middle(&faces[a]));
            let along = contact.direction(away);
            let extent = [a, b].map(|body| length(&faces[body], along));
            let inside = clearance(&faces[a], &faces[b], along);
            let far = (apart * extent[0].min(extent[1])).max(inside + least);
            Wish {
                bodies: [a, b],
                shift: along.map(|x| far * x),
                weight: contact.area * if contact.may_open { 1.0 } else { TIED },
            }
        })
        .collect();
    let mut shifts = least_squares_shifts(n, &wishes);
    // Groups of bodies that do not touch move away from the middle.
    let centre = [0, 1, 2].map(|d| 0.5 * (low[d] + high[d]));
    for group in groups(n, &wishes) {
        let all: Vec<FaceCorners> = group.iter().flat_map(|&b| faces[b].clone()).collect();
        // A body number without cells has no middle.
        if !all.is_empty() {
            let away = minus(middle(&all), centre).map(|x| apart * x);
            for body in group {
                (0..3).for_each(|d| shifts[body][d] += away[d]);
            }
        }
    }
    shifts
}

/// The faces in which each two bodies touch, with normals out of the first one.
fn contacts(solid: &SolidMesh, surface: &VisibleSurface) -> BTreeMap<[usize; 2], TouchingFaces> {
    let mut out: BTreeMap<[usize; 2], TouchingFaces> = BTreeMap::new();
    for face in &surface.faces {
        let body = solid.body[face.cell as usize] as usize;
        let Some(partner) = face.partner.map(|p| p as usize).filter(|p| *p != body) else {
            continue;
        };
        let corners = face.corners.map(|p| solid.points[p as usize]);
        let ([u, v], _) = diagonals(corners);
        let sign = if body < partner { 0.5 } else { -0.5 };
        let normal = cross(u, v).map(|x| sign * x);
        let area = norm(normal);
        if area == 0.0 {
            continue;
        }
        let contact = out
            .entry([body.min(partner), body.max(partner)])
            .or_default();
        contact.area += area;
        contact.may_open |= face.mark.is_some();
        for i in 0..3 {
            contact.normals[i] += normal[i];
            for j in 0..3 {
                contact.spread[i][j] += normal[i] * normal[j] / area;
            }
        }
    }
    out
}

impl TouchingFaces {
    /// The direction in which the second body leaves the first: the mean normal; where one encloses the other, the
    /// direction that is nearest to lying in all faces, on the side of `away`.
    fn direction(&self, away: [f64; 3]) -> [f64; 3] {
        if norm(self.normals) > CLOSED * self.area {
            return self.normals.map(|x| x / norm(self.normals));
        }
        // The eigenvector of the smallest eigenvalue of the spread: the one of the largest of trace − spread. Powers of
        // the matrix, here its 2¹⁰th one, keep only that.
        let trace = self.spread[0][0] + self.spread[1][1] + self.spread[2][2];
        let mut power = self.spread;
        for (i, row) in power.iter_mut().enumerate() {
            row.iter_mut().for_each(|x| *x = -*x / trace);
            row[i] += 1.0;
        }
        for _ in 0..10 {
            let square: [[f64; 3]; 3] = std::array::from_fn(|i| {
                std::array::from_fn(|j| (0..3).map(|k| power[i][k] * power[k][j]).sum())
            });
            let size = square[0][0] + square[1][1] + square[2][2];
            power = square.map(|row| row.map(|x| x / size));
        }
        let longest = power
            .into_iter()
            .max_by(|a, b| norm(*a).total_cmp(&norm(*b)));
        let axis = longest.and_then(unit).unwrap_or([0.0, 0.0, 1.0]);
        if dot(axis, away) < 0.0 {
            axis.map(|x| -x)
        } else {
            axis
        }
    }
}

/// The shifts that fulfil the wishes best, by conjugate gradients on the normal equations. Their mean is zero in every
/// group of bodies that touch.
pub(super) fn least_squares_shifts(n: usize, wishes: &[Wish]) -> Vec<[f64; 3]> {
    const ENOUGH: f64 = 1e-10;
    // wᵀ(t_b − t_a), to both bodies.
    let add = |out: &mut [[f64; 3]], wish: &Wish, value: [f64; 3]| {
        let [a, b] = wish.bodies;
        for d in 0..3 {
            out[a][d] -= wish.weight * value[d];
            out[b][d] += wish.weight * value[d];
        }
    };
    let inner =
        |x: &[[f64; 3]], y: &[[f64; 3]]| -> f64 { x.iter().zip(y).map(|(x, y)| dot(*x, *y)).sum() };
    let mut t = vec![[0.0; 3]; n];
    let mut residual = t.clone();
    wishes.iter().for_each(|w| add(&mut residual, w, w.shift));
    let mut direction = residual.clone();
    let mut size = inner(&residual, &residual);
    let enough = size * ENOUGH * ENOUGH;
    for _ in 0..10 * n {
        if size <= enough {
            break;
        }
        let mut image = vec![[0.0; 3]; n];
        for wish in wishes {
            let [a, b] = wish.bodies;
            add(&mut image, wish, minus(direction[b], direction[a]));
        }
        let step = size / inner(&direction, &image);
        for b in 0..n {
            for d in 0..3 {
                t[b][d] += step * direction[b][d];
                residual[b][d] -= step * image[b][d];
            }
        }
        let before = std::mem::replace(&mut size, inner(&residual, &residual));
        for (p, r) in direction.iter_mut().zip(&residual) {
            *p = [0, 1, 2].map(|d| r[d] + size / before * p[d]);
        }
    }
    t
}

/// The groups of bodies that touch.
fn groups(n: usize, wishes: &[Wish]) -> Vec<Vec<usize>> {
    let mut sets = UnionFind::new(n);
    for wish in wishes {
        sets.join(wish.bodies[0], wish.bodies[1]);
    }
    let mut out: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for body in 0..n {
        out.entry(sets.find(body)).or_default().push(body);
    }
    out.into_values().collect()
}

/// The middle of the box around some faces.
fn middle(faces: &[FaceCorners]) -> [f64; 3] {
    let [low, high] = bounds(faces.iter().flatten().copied());
    [0, 1, 2].map(|d| 0.5 * (low[d] + high[d]))
}

/// How far a body has to move in a direction until nothing of another one is before it: both are seen along the
/// direction, in squares as large as their largest face.
fn clearance(still: &[FaceCorners], moving: &[FaceCorners], along: [f64; 3]) -> f64 {
    let axes = {
        let least = (0..3).min_by(|&i, &j| along[i].abs().total_cmp(&along[j].abs()));
        let mut other = [0.0; 3];
        other[least.unwrap_or(0)] = 1.0;
        let first = unit(cross(along, other)).unwrap_or(other);
        [first, cross(along, first)]
    };
    let across = |v: [f64; 3]| axes.map(|axis| dot(axis, v));
    let diagonals = still.iter().chain(moving).flat_map(|f| diagonals(*f).0);
    let square = diagonals.map(|d| across(d).map(f64::abs));
    let square = square.fold(0.0_f64, |m, [x, y]| m.max(x).max(y));
    let place = |p: [f64; 3]| across(p).map(|x| (x / square).floor() as i64);
    let mut highest: HashMap<[i64; 2], f64> = HashMap::new();
    for p in still.iter().flatten() {
        let known = highest.entry(place(*p)).or_insert(f64::NEG_INFINITY);
        *known = known.max(dot(*p, along));
    }
    let before = |p: &[f64; 3]| Some(highest.get(&place(*p))? - dot(*p, along));
    moving
        .iter()
        .flatten()
        .filter_map(before)
        .fold(0.0, f64::max)
}

/// The extent of some faces in a direction.
fn length(faces: &[FaceCorners], along: [f64; 3]) -> f64 {
    let [[low], [high]] = bounds(faces.iter().flatten().map(|p| [dot(*p, along)]));
    (high - low).max(0.0)
}

#[cfg(test)]
#[path = "../../tests/pictures/apart.rs"]
mod tests;

//! Rigid motions in words: slides along x, turns about z through (0.5, 0.2, 0).

use super::rigid_motion::RigidMotion;
use base::linalg::vec3::{cross, dot, minus, norm};

/// Parts of a motion below this, relative to the others, are not worth a word.
const SMALL: f64 = 1e-6;

/// The motions of one body, or of several that move as one, in words without a subject, such as "slides along x and
/// turns about z through (0.5, 0.2, 0)"; `many` has the plural. Motions may come in any basis.
pub fn in_words(twists: &[RigidMotion], many: bool) -> String {
    let Some(first) = twists.first() else {
        return String::new();
    };
    let s = if many { "" } else { "s" };
    let all = first.dim * (first.dim + 1) / 2;
    if twists.len() >= all {
        return format!("move{s} freely");
    }
    let [slides, turns] = separated(twists);
    let along: Vec<String> = slides.iter().map(|t| direction(t.translation)).collect();
    let mut parts = Vec::new();
    match along.len() {
        0 => {}
        n if n == first.dim => parts.push(format!("slide{s} in all directions")),
        _ => parts.push(format!("slide{s} along {}", along.join(" and "))),
    }
    parts.extend(turns.iter().map(|t| turn(t, s)));
    parts.join(" and ")
}

/// Whether bodies have the same motion: what they do at the same points is the same.
pub fn as_one(twists: &[RigidMotion]) -> bool {
    let Some((first, rest)) = twists.split_first() else {
        return false;
    };
    rest.iter().all(|t| {
        let size = t.size().max(first.size());
        let off = norm(minus(first.at(t.centre), t.translation));
        let turned = norm(minus(first.rotation, t.rotation)) * t.radius;
        off.max(turned) <= SMALL * size
    })
}

/// A basis of the same motions: slides, and turns that have no part along these slides where that is possible.
fn separated(twists: &[RigidMotion]) -> [Vec<RigidMotion>; 2] {
    let first = twists[0];
    let (centre, radius) = (first.centre, first.radius.max(f64::MIN_POSITIVE));
    // Rotation times radius, then translation of the same centre.
    let rows = twists.iter().map(|t| {
        let (r, v) = (t.rotation.map(|w| w * radius), t.at(centre));
        [r[0], r[1], r[2], v[0], v[1], v[2]]
    });
    let rows = reduced(rows.collect());
    let mut slides: Vec<[f64; 6]> = Vec::new();
    let mut turns: Vec<[f64; 6]> = Vec::new();
    for row in rows {
        let turning = norm([row[0], row[1], row[2]]);
        if turning > SMALL * norm([row[3], row[4], row[5]]) {
            turns.push(row)
        } else {
            slides.push([0.0, 0.0, 0.0, row[3], row[4], row[5]])
        }
    }
    let slides = reduced(slides);
    // A slide takes out of a turn what it can.
    let mut across: Vec<[f64; 3]> = Vec::new();
    for s in &slides {
        let mut v = [s[3], s[4], s[5]];
        for a in &across {
            let along = dot(v, *a);
            v = std::array::from_fn(|d| v[d] - along * a[d]);
        }
        let length = norm(v);
        across.push(v.map(|x| x / length));
    }
    let twist = |row: &[f64; 6]| RigidMotion {
        translation: [row[3], row[4], row[5]],
        rotation: [row[0], row[1], row[2]].map(|w| w / radius),
        ..first
    };
    let turns = turns.iter().map(|row| {
        let mut row = *row;
        for a in &across {
            let along = dot([row[3], row[4], row[5]], *a);
            (0..3).for_each(|d| row[3 + d] -= along * a[d]);
        }
        twist(&row)
    });
    [slides.iter().map(twist).collect(), turns.collect()]
}

/// Rows in echelon form, each with a largest pivot of one: columns one after the other, of each the largest entry.
fn reduced(mut rows: Vec<[f64; 6]>) -> Vec<[f64; 6]> {
    let size = |row: &[f64; 6]| row.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    let largest = rows.iter().map(size).fold(0.0, f64::max);
    let mut done = 0;
    for c in 0..6 {
        let at = |k: &usize| rows[*k][c].abs();
        let best = (done..rows.len()).max_by(|a, b| at(a).total_cmp(&at(b)));
        let Some(best) = best.filter(|k| at(k) > 1e-9 * largest) else {
            continue;
        };
        rows.swap(done, best);
        let pivot = rows[done].map(|x| x / rows[done][c]);
        rows[done] = pivot;
        for (k, row) in rows.iter_mut().enumerate() {
            if k != done {
                let factor = row[c];
                (0..6).for_each(|d| row[d] -= factor * pivot[d]);
            }
        }
        done += 1;
    }
    rows.truncate(done);
    rows
}

/// A turn, with what it slides along its axis.
fn turn(t: &RigidMotion, s: &str) -> String {
    let angle = norm(t.rotation);
    let axis = t.rotation.map(|w| w / angle);
    let along = dot(t.translation, axis) / angle;
    // The point of the axis nearest to the centre: c + ω × v / ω².
    let arm = cross(t.rotation, t.translation);
    let mut point: [f64; 3] = std::array::from_fn(|d| t.centre[d] + arm[d] / (angle * angle));
    let size = norm(point).max(t.radius);
    if t.dim == 3 {
        // Of the points of an axis along a coordinate axis, that at zero.
        if let Some(d) = (0..3).find(|&d| axis[d].abs() > 1.0 - SMALL * SMALL) {
            point[d] = 0.0;
        }
    }
    let place = coordinates(&point[..t.dim], size);
    let about = match t.dim {
        2 => place,
        _ => format!("{} through {place}", direction(axis)),
    };
    let screw = along.abs() > SMALL * t.radius.max(f64::MIN_POSITIVE);
    if screw {
        format!("turn{s} about {about} and slide{s} along this axis by {along:.4} for each radian")
    } else {
        format!("turn{s} about {about}")
    }
}

/// A direction: an axis, or a unit vector whose first entry that is not zero is positive.
fn direction(v: [f64; 3]) -> String {
    let length = norm(v);
    let v = v.map(|x| x / length);
    if let Some(d) = (0..3).find(|&d| v[d].abs() > 1.0 - SMALL * SMALL) {
        return ["x", "y", "z"][d].into();
    }
    let sign = v
        .iter()
        .find(|x| x.abs() > SMALL)
        .map_or(1.0, |x| x.signum());
    coordinates(&v.map(|x| sign * x), 1.0)
}

/// Coordinates with four digits; what is rounding beside `size` is zero.
fn coordinates(at: &[f64], size: f64) -> String {
    let one = |x: &f64| {
        if x.abs() <= SMALL * size {
            "0".to_string()
        } else {
            short(*x)
        }
    };
    let all: Vec<String> = at.iter().map(one).collect();
    format!("({})", all.join(", "))
}

/// Four significant digits, without zeros at the end.
fn short(x: f64) -> String {
    let rounded: f64 = format!("{x:.3e}").parse().expect("a number is a number");
    if (1e-4..1e6).contains(&rounded.abs()) {
        format!("{rounded}")
    } else {
        format!("{rounded:e}")
    }
}

#[cfg(test)]
#[path = "../../../tests/inside/feti/projector/words.rs"]
mod tests;

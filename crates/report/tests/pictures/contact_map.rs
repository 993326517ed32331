//! Unit tests of `crates/report/src/pictures/contact_map.rs`.

use super::*;
use crate::drawing::canvas::Colour;
use crate::interfaces::NodeFriction;
use crate::scratch::Scratch;

/// An interface of n × n elements on the unit square with pressure max(1 − 4 r², 0) around its middle.
fn sample(name: &str, n: usize, size: f64) -> ContactMap {
    let at: Vec<[f64; 2]> = (0..(n + 1) * (n + 1))
        .map(|k| [k % (n + 1), k / (n + 1)].map(|i| i as f64 / n as f64))
        .collect();
    let pressure = |p: &[f64; 2]| {
        let r = (p[0] - 0.5).powi(2) + (p[1] - 0.5).powi(2);
        size * (1.0 - 8.0 * r).max(0.0)
    };
    let edge = |x: f64| if x == 0.0 || x == 1.0 { 0.5 } else { 1.0 };
    let area: Vec<f64> = at
        .iter()
        .map(|p| edge(p[0]) * edge(p[1]) / (n * n) as f64)
        .collect();
    let multiplier = at.iter().zip(&area).map(|(p, a)| pressure(p) * a).collect();
    let cell = |k: usize| {
        let a = (k / n * (n + 1) + k % n) as u32;
        [a, a + 1, a + n as u32 + 2, a + n as u32 + 1]
    };
    ContactMap {
        nodes: InterfaceNodes {
            name: name.into(),
            t: at.clone(),
            points: at.iter().map(|p| [p[0], 1.0, p[1]]).collect(),
            gap: vec![0.0; at.len()],
            multiplier,
            active: at.iter().map(|p| pressure(p) > 0.0).collect(),
            area,
            smoothed: Vec::new(),
            friction: Vec::new(),
        },
        labels: ["x".into(), "z".into()],
        cells: (0..n * n).map(cell).collect(),
        at,
    }
}

#[test]
fn pressure_is_force_over_area() {
    let map = sample("a|b", 8, 3.0);
    let largest = map.nodes.pressure().into_iter().fold(0.0, f64::max);
    assert!((largest - 3.0).abs() < 1e-12);
    let mut corner = map.clone();
    corner.nodes.area[0] = 0.0;
    assert!(corner.nodes.pressure()[0].is_nan());
}

#[test]
fn outlines_run_around_the_zone_and_the_face() {
    let map = sample("a|b", 8, 1.0);
    let outline = map.outlines();
    let length = |touch: Touch| -> f64 {
        let these = outline.iter().filter(|m| m.touch == touch);
        these
            .map(|m| (m.to[0] - m.from[0]).hypot(m.to[1] - m.from[1]))
            .sum()
    };
    // Nodes with r² < 1/8 around the middle: a cross of 4 × 4 cells without its corners, whose outline is as long
    // as the square's.
    assert!(
        (length(Touch::Closed) - 16.0 / 8.0).abs() < 1e-12,
        "{}",
        length(Touch::Closed)
    );
    assert!((length(Touch::Open) - 4.0).abs() < 1e-12);
}

#[test]
fn sticking_and_slipping_faces_have_outlines_of_their_own() {
    // The left half of the nodes sticks, the right half slips; all touch. The first body is drawn to x + z.
    let mut map = sample("a|b", 4, 1.0);
    map.nodes.active.fill(true);
    let node = |p: &[f64; 2]| NodeFriction {
        state: if p[0] < 0.6 { "stick" } else { "slip" },
        shear: [3.0, 0.0, 4.0],
        bound: 5.0,
        slip: [0.0; 3],
    };
    map.nodes.friction = map.at.iter().map(node).collect();
    let outline = map.outlines();
    let length = |touch: Touch| -> f64 {
        let these = outline.iter().filter(|m| m.touch == touch);
        these
            .map(|m| (m.to[0] - m.from[0]).hypot(m.to[1] - m.from[1]))
            .sum()
    };
    // Each half has the outline 3; the line between them is drawn once.
    assert_eq!([Touch::Sticks, Touch::Slips].map(length), [3.0, 2.0]);
    assert_eq!([Touch::Closed, Touch::Open].map(length), [0.0, 0.0]);
    let near = |found: &[Arrow], wanted: [f64; 2]| {
        assert_eq!(found.len(), 25);
        for arrow in found {
            let off = [0, 1].map(|c| (arrow.stress[c] - wanted[c]).abs());
            assert!(off[0].max(off[1]) < 1e-12, "{arrow:?}");
        }
    };
    near(&map.shear(), [3.0, 4.0]);
    // In a map with exchanged coordinates the arrows turn with them, and where the map is smaller they keep their
    // lengths.
    map.at
        .iter_mut()
        .for_each(|p| *p = [0.1 * p[1], 0.1 * p[0]]);
    near(&map.shear(), [4.0, 3.0]);
    // Nodes that are apart have no arrow.
    map.nodes.active.fill(false);
    assert!(map.shear().is_empty());
}

#[test]
fn the_legend_fits_into_the_picture() {
    let mut map = sample("a|b", 4, 1.0);
    let state = |k: usize| ["stick", "slip", "open"][k / 10];
    let node = |k: usize| NodeFriction {
        state: state(k),
        shear: [1.0 / 3.0, 0.0, 0.0],
        bound: 1.0,
        slip: [0.0; 3],
    };
    map.nodes.friction = (0..25).map(node).collect();
    map.nodes.active = (0..25).map(|k| state(k) != "open").collect();
    let picture = draw(&[map], "");
    let (w, h) = picture.size();
    let white = |x: usize| (h - 48..h).all(|y| picture.get(x, y) == Colour::WHITE);
    assert!((0..6).chain(w - 6..w).all(white));
    assert!((0..w).any(|x| !white(x)));
}

#[test]
fn files_hold_everything_and_misfits_are_refused() {
    let dir = Scratch::new("contact-map");
    let maps: Vec<ContactMap> = (1..=8)
        .map(|k| sample(&format!("i{k}"), 3, f64::from(k)))
        .collect();
    let paths = write(&maps, "eight", &dir.0).unwrap();
    let csv = std::fs::read_to_string(&paths[1]).unwrap();
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines.len(), 1 + 8 * 16);
    assert_eq!(
        lines[0],
        "name,t,s,x,y,z,gap,multiplier,active,pressure,area"
    );
    assert!(
        lines[1].starts_with("i1,0,0,0,1,0,0,0,0,0,"),
        "{}",
        lines[1]
    );
    write(&[], "", &dir.0).unwrap();
    let mut bad = sample("bad", 2, 1.0);
    bad.nodes.area.pop();
    let message = write(&[bad.clone()], "", &dir.0).unwrap_err().to_string();
    assert!(message.contains("'bad' lists 8 areas"), "{message}");
    bad.nodes.area.push(1.0);
    bad.cells[0][0] = 9;
    let message = write(&[bad], "", &dir.0).unwrap_err().to_string();
    assert!(message.contains("node 9"), "{message}");
}

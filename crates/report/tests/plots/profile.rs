//! Unit tests of `crates/report/src/plots/profile.rs`.

use super::*;
use crate::interfaces::NodeFriction;
use crate::scratch::Scratch;

/// An interface of n nodes on 0..1 that touches in the middle half, with a force that grows with `size`.
fn sample(name: &str, n: usize, size: f64) -> InterfaceProfile {
    let t: Vec<f64> = (0..n).map(|k| k as f64 / (n - 1) as f64).collect();
    let pressure = |t: f64| size * (0.0625 - (t - 0.5).powi(2)).max(0.0);
    let gap = |t: f64| 0.01 * ((t - 0.5).powi(2) - 0.0625).max(0.0);
    let nodes = InterfaceNodes {
        name: name.into(),
        points: t.iter().map(|&t| [1.0, t, 0.0]).collect(),
        gap: t.iter().map(|&t| gap(t)).collect(),
        multiplier: t.iter().map(|&t| pressure(t)).collect(),
        active: t.iter().map(|&t| pressure(t) > 0.0).collect(),
        area: Vec::new(),
        smoothed: Vec::new(),
        t: t.iter().map(|&t| [t, 0.0]).collect(),
        friction: Vec::new(),
    };
    InterfaceProfile {
        nodes,
        label: "y".into(),
    }
}

#[test]
fn the_zone_reaches_half_way_to_its_neighbours() {
    let p = sample("a|b", 17, 1.0);
    let zone = p.zone();
    assert_eq!(zone.len(), 1);
    assert_eq!(zone[0].range, (4.5 / 16.0, 11.5 / 16.0));
    // Nodes in any order; a single node; nodes at the ends.
    let mut q = p;
    q.nodes = InterfaceNodes {
        t: [1.0, 0.0, 0.5, 0.25, 0.75].map(|t| [t, 0.0]).to_vec(),
        points: [1.0, 0.0, 0.5, 0.25, 0.75].map(|y| [7.0, y, 0.0]).to_vec(),
        gap: vec![0.0; 5],
        multiplier: vec![1.0; 5],
        active: vec![true, false, true, false, false],
        ..q.nodes
    };
    let ranges = |p: &InterfaceProfile| p.zone().iter().map(|b| b.range).collect::<Vec<_>>();
    assert_eq!(ranges(&q), [(0.375, 0.625), (0.875, 1.0)]);
    q.nodes.active = vec![true; 5];
    assert_eq!(ranges(&q), [(0.0, 1.0)]);
    q.nodes.active = vec![false; 5];
    assert!(ranges(&q).is_empty());
}

#[test]
fn stick_and_slip_are_zones_of_their_own() {
    let mut p = sample("a|b", 5, 1.0);
    p.nodes.friction = ["open", "slip", "stick", "stick", "slip"]
        .map(|state| NodeFriction {
            state,
            shear: [3.0, -4.0, 0.0],
            bound: 6.0,
            slip: [0.0; 3],
        })
        .to_vec();
    let zones: Vec<(String, (f64, f64))> = { p.zone().into_iter() }
        .map(|band| (band.label, band.range))
        .collect();
    let wanted = [
        ("slips", (0.125, 0.375)),
        ("sticks", (0.375, 0.875)),
        ("slips", (0.875, 1.0)),
    ];
    assert_eq!(
        zones,
        wanted.map(|(label, range)| (label.to_string(), range))
    );
    assert_eq!(p.shear(), [5.0; 5]);
    let [forces, gaps] = p.panels(0.0);
    assert_eq!((forces.series.len(), gaps.series.len()), (4, 2));
    let bound =
        |panel: &Panel| -> Vec<f64> { panel.series[2].points.iter().map(|p| p.1).collect() };
    assert_eq!(bound(&forces), [6.0; 5]);
    // A bound far above the stresses does not make them small.
    p.nodes.friction.iter_mut().for_each(|f| f.bound = 1e6);
    let [far, _] = p.panels(0.0);
    assert!(bound(&far).iter().all(|b| b.is_nan()));
    assert!(far.y.range.unwrap().1 < 10.0);
}

#[test]
fn a_straight_interface_is_drawn_along_its_coordinate() {
    let mut p = sample("a|b", 5, 1.0);
    for (k, point) in p.nodes.points.iter_mut().enumerate() {
        *point = [3.0 + 2.0 * k as f64, -1.0, 0.0];
    }
    for (label, last) in [("x", 11.0), ("y", -1.0), ("t", 1.0)] {
        p.label = label.into();
        assert_eq!(p.t(4), last);
    }
}

#[test]
fn the_largest_forces_are_shown() {
    let profiles: Vec<InterfaceProfile> = (0..180)
        .map(|k| sample(&format!("i{k}"), 9, 1.0 + ((k * 77) % 180) as f64))
        .collect();
    let figure = figure(&profiles, "grid").unwrap();
    assert_eq!((figure.panels.len(), figure.columns), (24, 4));
    assert!(figure.title.contains("12 of 180"), "{}", figure.title);
    let mut forces: Vec<f64> = profiles.iter().map(|p| p.nodes.force()).collect();
    forces.sort_by(|a, b| b.total_cmp(a));
    let shown: Vec<f64> = figure
        .panels
        .iter()
        .filter(|p| !p.title.is_empty())
        .map(|p| {
            profiles
                .iter()
                .find(|q| q.nodes.name == p.title)
                .unwrap()
                .nodes
                .force()
        })
        .collect();
    assert_eq!(shown, forces[..12]);
    // A multiplier's panel stands above its gap's.
    for row in figure.panels.chunks(8) {
        for c in 0..4 {
            assert_eq!(row[c].x.range, row[4 + c].x.range);
            assert_eq!(
                (&row[c].y.label[..], &row[4 + c].y.label[..]),
                ("multiplier", "gap")
            );
        }
    }
}

#[test]
fn rounding_is_not_blown_up() {
    let mut closed = sample("closed", 9, 1.0);
    closed.nodes.gap = (0..9).map(|k| 1e-17 * f64::from(k - 4)).collect();
    let open = sample("open", 9, 0.5);
    let panels = figure(&[closed.clone(), open.clone()], "").unwrap().panels;
    let top = panels[2].y.range.unwrap().1;
    let largest = open.nodes.gap.iter().copied().fold(0.0, f64::max);
    assert_eq!(top, largest, "on the scale of the other interface");
    let alone = figure(&[closed], "").unwrap().panels;
    assert!(alone[1].y.range.unwrap().1 > 0.9);
}

#[test]
fn files_hold_everything() {
    let dir = Scratch::new("profile");
    let mut second = sample("a, \"b\"", 3, 2.0);
    second.nodes.gap[0] = f64::NAN;
    second.nodes.multiplier = vec![0.0, 1e-7, 0.1 + 0.2];
    let paths = write(&[sample("a|b", 5, 1.0), second], "two", &dir.0).unwrap();
    let names: Vec<_> = paths
        .iter()
        .map(|p| p.file_name().unwrap().to_str().unwrap())
        .collect();
    assert_eq!(
        names,
        ["interfaces.png", "interfaces.svg", "interfaces.csv"]
    );
    let csv = std::fs::read_to_string(&paths[2]).unwrap();
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines.len(), 1 + 5 + 3);
    assert_eq!(lines[0], "name,t,x,y,gap,multiplier,active,pressure,area");
    assert_eq!(lines[3], "a|b,0.5,1,0.5,0,0.0625,1,,");
    assert_eq!(lines[6], "\"a, \"\"b\"\"\",0,1,0,,0,0,,");
    assert!(
        lines[8].ends_with(",0.30000000000000004,0,,"),
        "{}",
        lines[8]
    );
}

#[test]
fn nothing_and_one_node_are_shown_and_misfits_refused() {
    let dir = Scratch::new("profile-odd");
    write(&[], "", &dir.0).unwrap();
    let mut corner = sample("corner", 2, 1.0);
    corner.nodes.t.truncate(1);
    let message = figure(&[corner.clone()], "").unwrap_err().to_string();
    assert!(message.contains("'corner' lists 2 points"), "{message}");
    corner.nodes.points.truncate(1);
    corner.nodes.gap.truncate(1);
    corner.nodes.multiplier = vec![1.0];
    corner.nodes.active = vec![true];
    let panels = figure(&[corner.clone()], "").unwrap().panels;
    let (low, high) = panels[0].x.range.unwrap();
    assert!(low < 0.0 && high > 0.0 && panels[0].bands.len() == 1);
    write(&[corner], "", &dir.0).unwrap();
}

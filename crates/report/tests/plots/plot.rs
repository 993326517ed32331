//! Unit tests of `crates/report/src/plots/plot.rs`.

use super::*;
use crate::drawing::canvas::Colour;
use crate::drawing::ticks::Scale;

/// A canvas that records the calls.
#[derive(Default)]
struct Recorder {
    lines: Vec<(Vec<CanvasPoint>, Colour)>,
    polygons: Vec<(Vec<CanvasPoint>, Colour)>,
    texts: Vec<(CanvasPoint, String)>,
}

impl Canvas for Recorder {
    fn polygon(&mut self, points: &[CanvasPoint], fill: Colour) {
        self.polygons.push((points.to_vec(), fill));
    }
    fn line(&mut self, points: &[CanvasPoint], _: f64, colour: Colour, _: &[f64]) {
        self.lines.push((points.to_vec(), colour));
    }
    fn text(&mut self, at: CanvasPoint, text: &str, _: &TextStyle) {
        self.texts.push((at, text.to_string()));
    }
}

const RED: Colour = Colour(200, 0, 0);

fn figure(scale: Scale, points: Vec<(f64, f64)>) -> Figure {
    let panel = Panel {
        title: "a".into(),
        x: Axis::new("x", Scale::Linear),
        y: Axis::new("y", scale),
        series: vec![Series::new("data", points, RED)],
        bands: Vec::new(),
    };
    Figure::new("both", vec![panel.clone(), panel])
}

#[test]
fn points_lie_where_the_ticks_say() {
    let figure = figure(Scale::Log, vec![(0.0, 1.0), (1.0, 10.0), (2.0, 100.0)]);
    let mut drawn = Recorder::default();
    figure.draw(&mut drawn);
    let curve = &drawn.lines.iter().find(|l| l.1 == RED).unwrap().0;
    assert_eq!(curve.len(), 3);
    let label = |text: &str| drawn.texts.iter().find(|t| t.1 == text).unwrap().0;
    assert!(
        (label("10").1 - curve[1].1).abs() < 1e-9 && (label("100").1 - curve[2].1).abs() < 1e-9
    );
    assert!(
        (curve[1].1 - 0.5 * (curve[0].1 + curve[2].1)).abs() < 1e-9,
        "equal ratios are equal steps"
    );
    // A label in the legend once, although two panels have the series.
    assert_eq!(drawn.texts.iter().filter(|t| t.1 == "data").count(), 1);
}

#[test]
fn everything_lies_inside_the_picture() {
    let figure = figure(Scale::Linear, vec![(0.0, -1e-7), (1e6, 2e-7)]);
    let mut drawn = Recorder::default();
    figure.draw(&mut drawn);
    let (w, h) = figure.size();
    let corners = drawn.lines.iter().chain(&drawn.polygons).flat_map(|l| &l.0);
    for p in corners.chain(drawn.texts.iter().map(|t| &t.0)) {
        assert!(p.0 > 0.0 && p.0 < w && p.1 > 0.0 && p.1 < h, "{p:?}");
    }
    // The legend lies below the axes' labels.
    let y = |text: &str| drawn.texts.iter().find(|t| t.1 == text).unwrap().0 .1;
    assert!(y("data") > y("x") + TEXT);
}

#[test]
fn what_cannot_be_shown_interrupts_the_line() {
    let figure = figure(
        Scale::Log,
        vec![
            (0.0, 1.0),
            (1.0, 2.0),
            (2.0, 0.0),
            (3.0, 3.0),
            (4.0, f64::NAN),
        ],
    );
    let mut drawn = Recorder::default();
    figure.draw(&mut drawn);
    let curves: Vec<usize> = drawn
        .lines
        .iter()
        .filter(|l| l.1 == RED)
        .map(|l| l.0.len())
        .collect();
    assert_eq!(curves, [2, 2, 2]); // one per panel, and the sample in the legend
    assert_eq!(
        drawn.polygons.iter().filter(|p| p.1 == RED).count(),
        3 + 3 + 1
    );
}

#[test]
fn both_files_are_written() {
    let dir = crate::scratch::Scratch::new("plot");
    let paths = figure(Scale::Linear, vec![])
        .save(&dir.0.join("sub/fig.v1"))
        .unwrap();
    assert!(paths[0].ends_with("sub/fig.v1.png") && paths[1].ends_with("sub/fig.v1.svg"));
    assert!(paths
        .iter()
        .all(|p| std::fs::metadata(p).unwrap().len() > 500));
}

#[test]
fn bands_lie_under_their_part_of_the_axis() {
    const BLUE: Colour = Colour(200, 220, 255);
    let mut figure = figure(Scale::Linear, vec![(0.0, 1.0), (1.0, 3.0), (2.0, 2e4)]);
    let band = |from: f64, to: f64| Band {
        label: "zone".into(),
        range: (from, to),
        colour: BLUE,
    };
    figure.panels[0].bands = vec![band(1.0, 2.0), band(0.0, 0.0), band(-9.0, -5.0)];
    figure.panels[1].series[0].points[2].1 = 4.0; // short labels: the axes would stand elsewhere
    figure.columns = 1;
    figure.panels.push(Panel::blank());
    let mut drawn = Recorder::default();
    figure.draw(&mut drawn);
    let curves: Vec<_> = drawn.lines.iter().filter(|l| l.1 == RED).collect();
    let at = |k: usize| curves[0].0[k].0;
    let bands: Vec<_> = drawn.polygons.iter().filter(|p| p.1 == BLUE).collect();
    assert_eq!(bands.len(), 3 + 1, "three in the panel, one in the legend");
    let ends = |k: usize| (bands[k].0[0].0, bands[k].0[1].0);
    assert!((ends(0).0 - at(1)).abs() < 1e-9 && (ends(0).1 - at(2)).abs() < 1e-9);
    assert!(
        ends(1).0 <= at(0) && ends(1).1 - ends(1).0 >= 1.5,
        "a single point is seen"
    );
    assert_eq!(drawn.texts.iter().filter(|t| t.1 == "zone").count(), 1);
    // Panels above each other have their axes in the same place.
    for k in 0..3 {
        assert!((curves[1].0[k].0 - at(k)).abs() < 1e-9);
    }
}

//! Unit tests of `crates/report/src/drawing/raster.rs`.

use super::super::canvas::Anchor;
use super::*;

impl Raster {
    /// One real pixel.
    pub(crate) fn get(&self, x: usize, y: usize) -> Colour {
        let pixel = self.pixels.pixels()[y * self.size().0 + x];
        Colour(pixel.red(), pixel.green(), pixel.blue())
    }
}

const RED: Colour = Colour(255, 0, 0);

#[test]
fn polygons_cover_their_area() {
    let mut raster = Raster::new(10.0, 10.0, 2.0);
    assert_eq!(raster.size(), (20, 20));
    // A rectangle that covers logical pixels 2..4.25 × 3..5: whole pixels 4..8, and half of column 8.
    for order in [[0, 1, 2, 3], [3, 2, 1, 0]] {
        let corners = [(2.0, 3.0), (4.25, 3.0), (4.25, 5.0), (2.0, 5.0)];
        raster.polygon(&order.map(|k| corners[k]), Colour(0, 0, 0));
    }
    assert_eq!(raster.get(5, 7), Colour(0, 0, 0));
    assert_eq!(raster.get(3, 7), Colour::WHITE);
    assert_eq!(raster.get(5, 5), Colour::WHITE);
    let half = raster.get(8, 7).0; // drawn twice: a quarter of the white is left
    assert!((i32::from(half) - 64).abs() <= 1, "{half}");
    assert_eq!(raster.get(9, 7), Colour::WHITE);
}

#[test]
fn lines_have_their_width_and_their_dashes() {
    let mut raster = Raster::new(20.0, 9.0, 1.0);
    raster.line(&[(0.0, 4.5), (20.0, 4.5)], 3.0, RED, &[4.0, 2.0]);
    assert_eq!(
        (raster.get(1, 3), raster.get(1, 5), raster.get(1, 6)),
        (RED, RED, Colour::WHITE)
    );
    assert_eq!(
        (raster.get(4, 4), raster.get(5, 4)),
        (Colour::WHITE, Colour::WHITE)
    );
    assert_eq!(raster.get(6, 4), RED);
    // A point on the edge changes nothing, not even in the antialiased rim.
    let mut with = Raster::new(20.0, 9.0, 1.0);
    with.line(&[(1.0, 4.2), (9.3, 4.2), (18.0, 4.2)], 2.5, RED, &[]);
    let mut without = Raster::new(20.0, 9.0, 1.0);
    without.line(&[(1.0, 4.2), (18.0, 4.2)], 2.5, RED, &[]);
    assert!(with.pixels == without.pixels);
    // Far outside: nothing is drawn and nothing fails.
    raster.line(&[(1e9, 1e9), (2e9, 1e9)], 1.0, RED, &[]);
    for bad in [f64::NAN, f64::INFINITY, 1e300, -1e8] {
        raster.polygon(&[(bad, 0.0), (1.0, 1.0), (2.0, 0.0)], RED);
        raster.line(&[(0.0, bad), (1.0, 1.0)], 1.0, RED, &[]);
        raster.text((bad, 1.0), "a", &TextStyle::new(9.0, Anchor::Start));
    }
}

#[test]
fn text_sits_where_it_is_anchored() {
    let ink = |raster: &Raster| {
        let (w, h) = raster.size();
        let dark: Vec<(usize, usize)> = (0..w * h)
            .map(|k| (k % w, k / w))
            .filter(|&(x, y)| raster.get(x, y).0 < 128)
            .collect();
        let x = dark.iter().map(|p| p.0);
        let y = dark.iter().map(|p| p.1);
        (
            x.clone().min().unwrap(),
            x.max().unwrap(),
            y.clone().min().unwrap(),
            y.max().unwrap(),
        )
    };
    let mut flat = Raster::new(100.0, 100.0, 1.0);
    flat.text((50.0, 50.0), "HHHH", &TextStyle::new(20.0, Anchor::Middle));
    let (x0, x1, y0, y1) = ink(&flat);
    assert!(
        (x0 + x1).abs_diff(99) <= 2 && (y0 + y1).abs_diff(99) <= 2,
        "{x0} {x1} {y0} {y1}"
    );
    assert!((y1 - y0 + 1).abs_diff(15) <= 1); // capitals are 0.729 em high
    let mut turned = Raster::new(100.0, 100.0, 1.0);
    let style = TextStyle {
        upwards: true,
        ..TextStyle::new(20.0, Anchor::Start)
    };
    turned.text((50.0, 90.0), "HHHH", &style);
    let (tx0, tx1, ty0, ty1) = ink(&turned);
    assert!((tx1 - tx0).abs_diff(y1 - y0) <= 1 && (ty1 - ty0).abs_diff(x1 - x0) <= 1);
    assert!((ty1 as f64 - 88.0).abs() <= 2.0);
}

#[test]
fn png_has_its_size() {
    let dir = crate::scratch::Scratch::new("raster");
    let path = dir.0.join("a.png");
    let mut raster = Raster::new(7.0, 5.0, 2.0);
    raster.set(3, 2, RED);
    raster.write_png(&path).unwrap();
    let mut reader = png::Decoder::new(std::fs::File::open(&path).unwrap())
        .read_info()
        .unwrap();
    let mut pixels = vec![0; reader.output_buffer_size()];
    let info = reader.next_frame(&mut pixels).unwrap();
    assert_eq!((info.width, info.height), (14, 10));
    assert_eq!(&pixels[3 * (2 * 14 + 3)..][..3], &[255, 0, 0]);
}

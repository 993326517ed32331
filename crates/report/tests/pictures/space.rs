//! Unit tests of `crates/report/src/pictures/space.rs`.

use super::*;

#[test]
fn cameras_are_orthonormal_and_see_the_front() {
    for (behind, below) in [(false, false), (false, true), (true, false), (true, true)] {
        let c = Camera::new(behind, below);
        let axes = [c.right, c.up, c.towards];
        for (i, a) in axes.iter().enumerate() {
            for (j, b) in axes.iter().enumerate() {
                let dot: f64 = (0..3).map(|d| a[d] * b[d]).sum();
                assert!((dot - f64::from(u8::from(i == j))).abs() < 1e-15);
            }
        }
        // The axes are right-handed: the picture is not mirrored.
        let [r, u] = [c.right, c.up];
        let z = r[0] * u[1] - r[1] * u[0];
        assert!((z - c.towards[2]).abs() < 1e-15);
        assert_eq!(c.towards[1] < 0.0, below);
        assert_eq!(c.towards[2] < 0.0, behind);
    }
}

#[test]
fn what_is_nearer_hides_what_is_behind_in_any_order() {
    let raster = Raster::new(10.0, 10.0, 1.0);
    let (red, blue) = (Colour(255, 0, 0), Colour(0, 0, 255));
    let triangle = |depth: f64| [[0.0, 0.0, depth], [40.0, 0.0, depth], [0.0, 40.0, depth]];
    for nearer_first in [true, false] {
        let (mut buffer, scale) = Buffer::new(10.0, 10.0, &raster);
        assert_eq!(scale, 2.0);
        for near in [nearer_first, !nearer_first] {
            let colour = if near { red } else { blue };
            let depth = f64::from(u8::from(near));
            buffer.triangle(triangle(depth), [0.0; 3], &|_| colour);
        }
        // A line behind the first triangle is hidden, one just below its surface is not.
        buffer.line([[0.0, 3.0, 0.5], [20.0, 3.0, 0.5]], 2.0, 0.1, blue);
        buffer.line([[0.0, 9.0, 0.95], [20.0, 9.0, 0.95]], 2.0, 0.1, blue);
        let mut out = Raster::new(10.0, 10.0, 1.0);
        buffer.copy(&mut out, (0.0, 0.0));
        assert_eq!(out.get(2, 1), red);
        assert_eq!(out.get(2, 4), blue);
        assert_eq!(out.get(2, 7), red);
    }
}

//! Unit tests of `crates/report/src/pictures/rigid_faces.rs`.

use super::*;
use base::linalg::vec3::cross;

#[test]
fn faces_end_where_the_picture_does() {
    let unit = [[0.0; 3], [1.0; 3]];
    // A square of 4 × 4 in the middle of the unit cube: the cube's section is left.
    let face = [[-1.0, -1.0], [3.0, -1.0], [3.0, 3.0], [-1.0, 3.0]].map(|[x, y]| [x, y, 0.5]);
    let part = clip(&face, unit);
    assert!(
        part.iter().flatten().all(|x| (0.0..=1.0).contains(x)),
        "{part:?}"
    );
    let area = |t: &[[f64; 3]; 3]| 0.5 * norm(cross(minus(t[1], t[0]), minus(t[2], t[0])));
    let around = 1.0 + 2.0 * AROUND * 3.0_f64.sqrt();
    let all: f64 = triangles(&[face.to_vec()], unit).iter().map(area).sum();
    assert!((all - around * around).abs() < 1e-12, "{all}");
    assert!(clip(&face.map(|[x, y, _]| [x, y, 1.5]), unit).is_empty());
    // A segment.
    let line = clip(&[[-1.0, 0.5, 0.0], [0.25, 0.5, 0.0]], unit);
    let ends = line.iter().map(|x| x[0]);
    let [low, high] = [ends.clone().fold(9.0, f64::min), ends.fold(-9.0, f64::max)];
    assert!(low.abs() < 1e-15 && high == 0.25, "{line:?}");
}

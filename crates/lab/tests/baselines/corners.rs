//! Unit tests of `crates/lab/src/baselines/corners.rs`.

use super::*;

fn picked(points: &[[f64; 3]], n: usize) -> Vec<usize> {
    far_apart(points, n)
}

#[test]
fn corners_of_a_face_are_far_apart() {
    let mut face = Vec::new();
    for i in 0..4 {
        for j in 0..3 {
            face.push([2.0, i as f64, j as f64]);
        }
    }
    let three = picked(&face, 3);
    let at: Vec<[f64; 3]> = three.iter().map(|&k| face[k]).collect();
    assert_eq!(at[1], [2.0, 0.0, 0.0]);
    assert_eq!(at[0], [2.0, 3.0, 2.0]);
    // The third is one of the two other corners of the face.
    assert!(
        at[2] == [2.0, 0.0, 2.0] || at[2] == [2.0, 3.0, 0.0],
        "{at:?}"
    );
    assert_eq!(picked(&face, 2), three[..2]);
}

#[test]
fn points_on_a_line_have_two_ends() {
    let line: Vec<[f64; 3]> = (0..5)
        .map(|k| {
            let t = f64::from(k) / 3.0;
            [0.1 + t, 0.7 * t, 1.0 - 0.3 * t]
        })
        .collect();
    let mut ends = picked(&line, 3);
    ends.sort_unstable();
    assert_eq!(ends, [0, 4]);
    assert_eq!(picked(&line[..1], 3), [0]);
    assert!(picked(&[], 3).is_empty());
}

//! Unit tests of `crates/report/src/pictures/solid.rs`.

use super::*;
use crate::drawing::ticks::Scale;
use crate::pictures::obstacles::ShownObstacle;
use crate::pictures::surface::tests::Blocks;
use crate::pictures::values::ShownValues;

fn count(raster: &Raster, is: impl Fn(Colour) -> bool) -> [usize; 2] {
    let (w, h) = raster.size();
    let half = |range: std::ops::Range<usize>| {
        let pixels = range.flat_map(|x| (0..h).map(move |y| (x, y)));
        pixels.filter(|&(x, y)| is(raster.get(x, y))).count()
    };
    [half(0..w / 2), half(w / 2..w)]
}

#[test]
fn a_contact_zone_between_bodies_is_seen_where_they_are_moved_apart() {
    let blocks = Blocks::new(2, 4);
    let u: Vec<f64> = blocks.points.iter().map(|p| p[1]).collect();
    let field = ShownField {
        title: "u",
        values: ShownValues::Nodal(&u),
        scale: Scale::Linear,
    };
    let marks: Vec<FaceMark> = (0..16)
        .flat_map(|k| {
            let at =
                |i: usize, j: usize| [0.25 * (k % 4 + i) as f64, 1.0, 0.25 * (k / 4 + j) as f64];
            let corners = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)];
            [0, 1].map(|body| FaceMark {
                body,
                partner: Some(1 - body),
                corners,
                closed: Some(k < 8),
            })
        })
        .collect();
    let red = |c: Colour| c.0 > 150 && c.1 < 40 && c.2 < 90;
    let plain = draw(&blocks.view(), &[field; 2], &[], &Beside::default(), "two").unwrap();
    assert_eq!(count(&plain, red), [0, 0]);
    let marked = draw(
        &blocks.view(),
        &[field; 2],
        &marks,
        &Beside::default(),
        "two",
    )
    .unwrap();
    let [left, right] = count(&marked, red);
    // The sample in the legend may lie in the left half.
    assert!(left < 1200 && right > 8000, "{left} {right}");
}

#[test]
fn the_lower_side_is_shown_where_it_touches() {
    let blocks = Blocks::new(1, 2);
    let corners = [[0.0; 3], [0.5, 0.0, 0.0], [0.5, 0.0, 0.5], [0.0, 0.0, 0.5]];
    let mark = FaceMark {
        body: 0,
        partner: None,
        corners,
        closed: Some(true),
    };
    let solid = blocks.view();
    let camera = second_camera(&solid, &solid.surface(&[mark]), false);
    assert_eq!(camera, Camera::new(false, true));
    let nothing = second_camera(&solid, &solid.surface(&[]), false);
    assert_eq!(nothing, Camera::new(true, true));
}

#[test]
fn fields_of_the_wrong_length_are_refused() {
    let blocks = Blocks::new(1, 2);
    let field = ShownField {
        title: "u",
        values: ShownValues::Cell(&[1.0; 5]),
        scale: Scale::Linear,
    };
    let error = draw(&blocks.view(), &[field; 2], &[], &Beside::default(), "")
        .err()
        .unwrap();
    assert!(error.to_string().contains("'u' has 5 numbers"), "{error}");
}

/// A ball above a block is grey in the first picture only, and lets the block be seen.
#[test]
fn obstacles_are_shown_where_bodies_are_in_their_places() {
    let blocks = Blocks::new(1, 2);
    let u = vec![0.0; blocks.points.len()];
    let ball = ShownObstacle {
        rigid: scene::Rigid::Round {
            centre: [0.5, 1.4, 0.5],
            axis: None,
            radius: 0.4,
            cavity: false,
        },
        gap: 0.0,
    };
    let fields = [ShownField::nodal("u", &u); 2];
    let grey = |c: Colour| c.0 == c.1 && c.1 == c.2 && (0x80..0xd8).contains(&c.0);
    let grey = |obstacles: &[ShownObstacle]| {
        let picture = draw(
            &blocks.view(),
            &fields,
            &[],
            &Beside {
                obstacles,
                faces: &[],
            },
            "",
        )
        .unwrap();
        count(&picture, grey)
    };
    let ([before, other], [left, right]) = (grey(&[]), grey(&[ball]));
    assert!(left > before + 20_000, "{before} {left}");
    assert!(right < other + 1000, "{other} {right}");
}

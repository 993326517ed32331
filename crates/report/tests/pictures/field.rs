//! Unit tests of `crates/report/src/pictures/field.rs`.

use super::*;
use crate::drawing::colormap::viridis;
use crate::pictures::obstacles::ShownObstacle;
use crate::pictures::outline::tests::grid;

#[test]
fn colours_stand_for_values() {
    // u = x on the unit square: the left end is dark violet, the right end yellow, the middle teal.
    let mesh = grid(2, 2, 4, false);
    let u: Vec<f64> = mesh.points.iter().map(|p| p[0]).collect();
    let picture = draw(
        &Beside::default(),
        &mesh.view(),
        &[ShownField::nodal("u", &u)],
        &Marked::default(),
        false,
        "",
    );
    let (_, origin) = (0, (LEFT, 6.0 + 2.4 * TEXT + 400.0));
    let at = |x: f64, y: f64| {
        let p = ((origin.0 + 400.0 * x) * 2.0, (origin.1 - 400.0 * y) * 2.0);
        picture.get(p.0 as usize, p.1 as usize)
    };
    let near = |a: Colour, b: Colour| {
        [(a.0, b.0), (a.1, b.1), (a.2, b.2)]
            .iter()
            .all(|(x, y)| x.abs_diff(*y) <= 3)
    };
    for (x, y) in [(0.06, 0.3), (0.31, 0.8), (0.45, 0.45), (0.9, 0.1)] {
        assert!(
            near(at(x, y), viridis(x)),
            "{:?} at {x}, {y}, expected {:?}",
            at(x, y),
            viridis(x)
        );
    }
    // The line between the bodies.
    assert_eq!(at(0.5, 0.3), Colour(0, 0, 0));
}

#[test]
fn the_contact_zone_is_marked_on_u() {
    // Two bodies that touch along x = 1/2 in its lower half; the upper half is open.
    let mesh = grid(2, 2, 4, false);
    let u = vec![0.5; mesh.points.len()];
    let field = [ShownField::nodal("u", &u); 2];
    let marks: Vec<ContactMark> = (0..16)
        .map(|k| ContactMark {
            from: [0.5, f64::from(k) / 16.0],
            to: [0.5, f64::from(k + 1) / 16.0],
            touch: if k < 8 { Touch::Closed } else { Touch::Open },
        })
        .collect();
    let plain = draw(
        &Beside::default(),
        &mesh.view(),
        &field,
        &Marked::default(),
        false,
        "",
    );
    let marked = draw(
        &Beside::default(),
        &mesh.view(),
        &field,
        &with(&marks),
        false,
        "",
    );
    let (w, h) = plain.size();
    assert_eq!(marked.size().0, w);
    assert!(marked.size().1 > h, "room for the legend");
    let red = |x: usize, y: usize| {
        let c = marked.get(x, y);
        c.0 > 200 && c.1 < 60
    };
    let rows = |xs: std::ops::Range<usize>| (0..h).filter(move |&y| xs.clone().any(|x| red(x, y)));
    // The lower half of the first picture, 400 logical pixels high, and nothing on the second.
    let count = rows(0..w / 2).count();
    assert!(count.abs_diff(400) < 12, "{count}");
    assert_eq!(rows(w / 2..w).count(), 0);
    // Dashes, in the upper half: black and white in turn.
    let x = ((LEFT + 200.0) * 2.0) as usize;
    let y0 = ((6.0 + 2.4 * TEXT) * 2.0) as usize;
    let dark: Vec<bool> = (y0 + 8..y0 + 380)
        .map(|y| marked.get(x, y).0 < 100)
        .collect();
    let changes = dark.windows(2).filter(|p| p[0] != p[1]).count();
    assert!((30..80).contains(&changes), "{changes}");
}

/// These marks without tractions.
fn with(contact: &[ContactMark]) -> Marked<'_> {
    Marked {
        contact,
        tractions: &[],
    }
}

/// u and ρ.
fn both<'a>(u: &'a [f64], rho: &'a [f64]) -> [ShownField<'a>; 2] {
    let rho = ShownField::coefficient("coefficient ρ", rho);
    [ShownField::nodal("solution u", u), rho]
}

#[test]
fn arrays_of_the_wrong_length_are_refused() {
    let mesh = grid(1, 1, 2, false);
    let (u, rho) = (
        vec![0.0; mesh.points.len()],
        vec![1.0; mesh.quads.len() + 1],
    );
    let message = write(
        &Beside::default(),
        &mesh.view(),
        &both(&u, &rho),
        &Marked::default(),
        false,
        "",
        Path::new("/dev/null"),
    )
    .unwrap_err()
    .to_string();
    assert!(
        message.contains("'coefficient ρ' has 5 numbers"),
        "{message}"
    );
}

#[test]
fn a_million_cells_are_painted() {
    let mesh = grid(2, 2, 256, false); // 2×2 bodies of 2×2 subdomains of 256²: 1024² cells
    let u: Vec<f64> = mesh.points.iter().map(|p| p[0] * p[1]).collect();
    let rho = vec![1.0; mesh.quads.len()];
    let dir = crate::scratch::Scratch::new("field");
    write(
        &Beside::default(),
        &mesh.view(),
        &both(&u, &rho),
        &Marked::default(),
        false,
        "",
        &dir.0.join("u.png"),
    )
    .unwrap();
}

/// A rigid plane under a body: grey in the margin below, white in the others.
#[test]
fn obstacles_stand_beside_bodies() {
    let mesh = grid(1, 1, 2, false);
    let u: Vec<f64> = mesh.points.iter().map(|p| p[0]).collect();
    let ground = ShownObstacle {
        rigid: scene::Rigid::Plane {
            point: [0.0; 3],
            normal: [0.0, 1.0, 0.0],
        },
        gap: 0.0,
    };
    let picture = draw(
        &Beside {
            obstacles: &[ground],
            faces: &[],
        },
        &mesh.view(),
        &[ShownField::nodal("u", &u)],
        &Marked::default(),
        true,
        "",
    );
    let size = 1.0 + 2.0 * BEYOND;
    let (unit, bottom) = (400.0 / size, 6.0 + 2.4 * TEXT + 400.0);
    let at = |x: f64, y: f64| {
        let p = (LEFT + unit * (x + BEYOND), bottom - unit * (y + BEYOND));
        picture.get((2.0 * p.0) as usize, (2.0 * p.1) as usize)
    };
    assert_eq!(at(0.5, -0.04), crate::pictures::obstacles::GREY);
    assert_eq!(at(0.5, 1.04), Colour::WHITE);
    assert_eq!(at(-0.04, 0.5), Colour::WHITE);
    assert_ne!(at(0.3, 0.3), Colour::WHITE);
}

/// A rigid surface at the same place: a band below it, and none where the surface ends.
#[test]
fn rigid_surfaces_stand_beside_bodies() {
    let mesh = grid(1, 1, 2, false);
    let u: Vec<f64> = mesh.points.iter().map(|p| p[0]).collect();
    // From right to left: the normals point up.
    let faces = [vec![[0.8, 0.0, 0.0], [-3.0, 0.0, 0.0]]];
    let beside = Beside {
        obstacles: &[],
        faces: &faces,
    };
    let picture = draw(
        &beside,
        &mesh.view(),
        &[ShownField::nodal("u", &u)],
        &Marked::default(),
        true,
        "",
    );
    let size = 1.0 + 2.0 * BEYOND;
    let (unit, bottom) = (400.0 / size, 6.0 + 2.4 * TEXT + 400.0);
    let at = |x: f64, y: f64| {
        let p = (LEFT + unit * (x + BEYOND), bottom - unit * (y + BEYOND));
        picture.get((2.0 * p.0) as usize, (2.0 * p.1) as usize)
    };
    let grey = crate::pictures::obstacles::GREY;
    assert_eq!([at(0.5, -0.01), at(-0.04, -0.01)], [grey; 2]);
    for white in [at(0.5, -0.04), at(0.9, -0.01), at(0.5, 1.04)] {
        assert_eq!(white, Colour::WHITE);
    }
}

#[test]
fn zones_and_tractions_of_friction_are_drawn() {
    // Two bodies that touch along y = 1/2; they slip on the left half and stick on the right one.
    let mesh = grid(2, 2, 4, false);
    let u = vec![0.5; mesh.points.len()];
    let field = [ShownField::nodal("u", &u); 2];
    let marks: Vec<ContactMark> = (0..16)
        .map(|k| ContactMark {
            from: [f64::from(k) / 16.0, 0.5],
            to: [f64::from(k + 1) / 16.0, 0.5],
            touch: if k < 8 { Touch::Slips } else { Touch::Sticks },
        })
        .collect();
    let tractions: Vec<Arrow> = (0..=16)
        .map(|k| Arrow {
            at: [f64::from(k) / 16.0, 0.5],
            stress: [0.0, 3.0],
        })
        .collect();
    let shown = |tractions: &[Arrow]| {
        let marked = Marked {
            tractions,
            ..with(&marks)
        };
        draw(&Beside::default(), &mesh.view(), &field, &marked, false, "")
    };
    let (plain, arrows) = (shown(&[]), shown(&tractions));
    let pixel = |x: f64, y: f64| {
        let (x, y) = (LEFT + 400.0 * x, 6.0 + 2.4 * TEXT + 400.0 - 400.0 * y);
        ((2.0 * x) as usize, (2.0 * y) as usize)
    };
    let at = |picture: &Raster, x: f64, y: f64| {
        let (x, y) = pixel(x, y);
        picture.get(x, y)
    };
    let (slips, sticks) = (at(&plain, 0.22, 0.5), at(&plain, 0.78, 0.5));
    assert!(slips.0 > 200 && slips.2 < 60, "orange, found {slips:?}");
    assert!(sticks.2 > 200 && sticks.0 < 60, "blue, found {sticks:?}");
    // A stress upwards is drawn above the line, black on both halves, and not below it nor on the second field.
    for x in [0.25, 0.75] {
        assert_eq!(at(&arrows, x, 0.54), Colour(0, 0, 0));
        assert_eq!(at(&arrows, x, 0.46), at(&plain, x, 0.46));
    }
    let (w, h) = plain.size();
    let above_legend = h - 60;
    let changed = |xs: std::ops::Range<usize>| {
        xs.flat_map(|x| (0..above_legend).map(move |y| (x, y)))
            .filter(|&(x, y)| plain.get(x, y) != arrows.get(x, y))
            .count()
    };
    assert!(changed(0..w / 2) > 100);
    assert_eq!(changed(w / 2 + 40..w), 0);
}

/// Arrows that leave the bodies have room: the picture grows, and nothing of them is on the title or on the numbers.
#[test]
fn arrows_stay_off_titles() {
    let mesh = grid(2, 2, 4, false);
    let u = vec![0.5; mesh.points.len()];
    let field = [ShownField::nodal("u", &u)];
    let shown = |stress: [f64; 2]| {
        let at = |k: usize| [k as f64 / 16.0, 1.0];
        let tractions: Vec<Arrow> = (0..=16).map(|k| Arrow { at: at(k), stress }).collect();
        let marked = Marked {
            contact: &[],
            tractions: &tractions,
        };
        draw(&Beside::default(), &mesh.view(), &field, &marked, false, "")
    };
    let (inside, outside) = (shown([0.0, -3.0]), shown([0.0, 3.0]));
    let body_width = 400.0 / 2.0;
    let longest = f64::min(LONGEST, 0.3 * body_width);
    let grown = outside.size().1 - inside.size().1;
    assert!(
        (grown as f64 - 2.0 * (longest + TIP)).abs() <= 2.0,
        "{grown}"
    );
    assert_eq!(outside.size().0, inside.size().0);
    // Between the title and the bodies: arrows, whose tips lie below the title.
    let first = ((6.0 + 2.4 * TEXT) * 2.0) as usize;
    let dark = |y: usize| {
        let xs = (2.0 * LEFT) as usize..(2.0 * (LEFT + 400.0)) as usize;
        xs.filter(|&x| outside.get(x, y).0 < 100).count()
    };
    assert_eq!(dark(first), 0);
    assert!(dark(first + 40) > 17);
}

//! Unit tests of `crates/report/src/pictures/obstacles.rs`.

use super::*;

const BODIES: [[f64; 3]; 2] = [[0.0; 3], [2.0, 1.0, 1.0]];

fn obstacles() -> [ShownObstacle; 4] {
    let round = |axis, radius, cavity| Rigid::Round {
        centre: [1.0, 3.0, 0.5],
        axis,
        radius,
        cavity,
    };
    let plane = Rigid::Plane {
        point: [0.0, -0.5, 0.0],
        normal: [0.0, 1.0, 0.0],
    };
    let shapes = [
        plane,
        round(None, 1.5, false),
        round(Some([0.0, 0.0, 1.0]), 0.2, false),
        round(None, 40.0, true),
    ];
    shapes.map(|rigid| ShownObstacle { rigid, gap: 0.1 })
}

#[test]
fn triangles_lie_on_the_surface_in_front_of_the_gap() {
    for obstacle in obstacles() {
        let triangles = obstacle.triangles(BODIES);
        assert!(!triangles.is_empty());
        let hub = |p: &[f64; 3]| p[0] == 1.0 && p[1] == 3.0;
        for p in triangles.iter().flatten().filter(|p| !hub(p)) {
            let (distance, _) = obstacle.rigid.distance(*p).unwrap();
            assert!(
                (distance + 0.1).abs() < 1e-12,
                "{obstacle:?} {p:?} {distance}"
            );
        }
    }
}

/// The area of a whole sphere and of a rectangle under the bodies.
#[test]
fn triangles_cover_the_surface() {
    let area = |obstacle: &ShownObstacle| -> f64 {
        let all = obstacle.triangles(BODIES);
        let of = |t: &[[f64; 3]; 3]| 0.5 * norm(cross(minus(t[1], t[0]), minus(t[2], t[0])));
        all.iter().map(of).sum()
    };
    let beyond = BEYOND * 6.0_f64.sqrt();
    let plane = (2.0 + 2.0 * beyond) * (1.0 + 2.0 * beyond);
    assert!((area(&obstacles()[0]) - plane).abs() < 1e-12);
    let small = ShownObstacle {
        rigid: Rigid::Round {
            centre: [1.0, 3.0, 0.5],
            axis: None,
            radius: 0.4,
            cavity: false,
        },
        gap: 0.0,
    };
    let sphere = 4.0 * PI * 0.16;
    assert!((area(&small) - sphere).abs() < 0.01 * sphere);
}

#[test]
fn a_disc_is_grey_and_its_surroundings_are_not() {
    let mut raster = Raster::new(100.0, 100.0, 2.0);
    let view = View {
        low: [0.0; 2],
        scale: 100.0,
        origin: (0.0, 100.0),
    };
    let disc = ShownObstacle {
        rigid: Rigid::Round {
            centre: [0.5, 0.75, 0.0],
            axis: Some([0.0, 0.0, 1.0]),
            radius: 0.2,
            cavity: false,
        },
        gap: 0.0,
    };
    disc.paint(&mut raster, &view, [[0.0; 2], [1.0; 2]]);
    // Its middle, which is no point's nearest, and a place nearer to its rim.
    for y in [50, 80] {
        assert_eq!(raster.get(100, y), GREY);
    }
    assert_eq!(raster.get(100, 150), Colour::WHITE);
    assert_eq!(raster.get(20, 50), Colour::WHITE);
}

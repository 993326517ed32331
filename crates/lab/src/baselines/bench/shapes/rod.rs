//! The upper half of a connecting rod with its cap, on a journal, with a pin.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::delaunay::{arc, build, circle, polyline, GroupNumbers, Planform, Solid};
use elements::kind::CellKind;
use mesh::MeshFile;

/// Distance of the axes of journal and pin, in metres.
const LENGTH: f64 = 0.15;
/// Radius of the journal, and of the eye around it.
const BIG: [f64; 2] = [0.025, 0.040];
/// Radius of the pin, and of the eye around it.
const SMALL: [f64; 2] = [0.011, 0.020];
/// Half the width of the shank.
const SHANK: f64 = 0.012;
/// Half the thickness of the eyes, and of the shank.
const HALF: [f64; 2] = [0.010, 0.006];

const ROD: usize = 1;
const CAP: usize = 2;
const JOURNAL: usize = 3;
const PIN: usize = 4;
const NAMES: &[&str] = &[
    "rod",
    "cap",
    "journal",
    "pin",
    "middle",
    "journal_bore",
    "pin_bore",
    "parting",
    "journal_end",
    "pin_end",
];

/// Tetrahedra with edges about `edge` long, of 4 nodes, or of 10. Groups: `rod`, `cap`, `journal`, `pin`; `middle` (the
/// plane of symmetry z = 0), `journal_bore`, `pin_bore` (where journal and pin meet the eyes), `parting` (between cap
/// and rod), `journal_end`, `pin_end`.
pub(in super::super) fn rod(edge: f64, quadratic: bool) -> MeshFile {
    let plan = Planform::fill(&curves(edge), edge, within);
    let layers = (HALF[0] / edge).round().max(2.0) as usize;
    let mut solid = Solid::over(&plan, layers, height);
    let mut kind = CellKind::Tet4;
    if quadratic {
        solid = solid.quadratic();
        kind = CellKind::Tet10;
    }
    let groups = GroupNumbers {
        names: NAMES,
        of_cell: solid
            .over
            .iter()
            .map(|&t| rod_part(plan.middle(t)))
            .collect(),
    };
    let side = |[x, y, z]: [f64; 3], mut beside: [usize; 2]| {
        beside.sort_unstable();
        match beside {
            [0, _] if z == 0.0 => 5,
            [0, JOURNAL] => 9,
            [0, PIN] => 10,
            [0, _] => 0,
            [ROD | CAP, JOURNAL] => 6,
            [ROD, PIN] => 7,
            [ROD, CAP] => 8,
            _ => unreachable!("parts that do not touch, at ({x}, {y}, {z})"),
        }
    };
    build("rod.msh", solid.points, kind, &solid.cells, &groups, side)
}

/// The part that has a point of the plane.
fn rod_part([x, y]: [f64; 2]) -> usize {
    match () {
        () if x.hypot(y) < BIG[0] => JOURNAL,
        () if (x - LENGTH).hypot(y) < SMALL[0] => PIN,
        () if x < 0.0 => CAP,
        () => ROD,
    }
}

/// Whether some part has a point of the plane.
fn within([x, y]: [f64; 2]) -> bool {
    let shank = x > 0.0 && x < LENGTH && y.abs() < SHANK;
    shank || x.hypot(y) < BIG[1] || (x - LENGTH).hypot(y) < SMALL[1]
}

/// The outline, both bores, and where the cap is parted from the rod.
fn curves(edge: f64) -> Vec<Vec<[f64; 2]>> {
    let pieces = |length: f64| (length / edge).ceil() as usize;
    let far = [LENGTH, 0.0];
    // Angles at which the shank leaves the eyes.
    let big = (SHANK / BIG[1]).asin();
    let small = PI - (SHANK / SMALL[1]).asin();
    let eye = |centre, radius: f64, [from, to]: [f64; 2]| {
        arc(centre, radius, [from, to], pieces(radius * (to - from)))
    };
    // The eye at the journal is parted at its top and bottom, where a segment has to end.
    let arcs = [
        [big, FRAC_PI_2],
        [FRAC_PI_2, 3.0 * FRAC_PI_2],
        [3.0 * FRAC_PI_2, TAU - big],
    ]
    .map(|part| eye([0.0; 2], BIG[1], part));
    let tip = eye(far, SMALL[1], [-small, small]);
    let (first, last) = (tip[0], tip[tip.len() - 1]);
    let (above, below) = (arcs[0][0], *arcs[2].last().expect("an arc has points"));
    let across = pieces(first[0] - below[0]);
    let parting = [1.0, -1.0].map(|s| {
        let wall = BIG[1] - BIG[0];
        let n = pieces(wall);
        (0..=n)
            .map(|k| [0.0, s * (BIG[0] + wall * k as f64 / n as f64)])
            .collect()
    });
    // Four quarters: the bore has points where it is parted.
    let bore = circle([0.0; 2], BIG[0], 4 * pieces(BIG[0] * FRAC_PI_2));
    let pin = circle(far, SMALL[0], 4 * pieces(SMALL[0] * FRAC_PI_2));
    let shank = [
        polyline(below, first, across),
        polyline(last, above, across),
    ];
    let mut curves = vec![tip, bore, pin];
    curves.extend(arcs);
    curves.extend(shank);
    curves.extend(parting);
    curves
}

/// Half the thickness: that of the eyes, from where it falls smoothly to that of the shank.
fn height([x, y]: [f64; 2]) -> f64 {
    let beyond = (x.hypot(y) - BIG[1]).min((x - LENGTH).hypot(y) - SMALL[1]);
    let t = 1.0 - (beyond / 0.012).clamp(0.0, 1.0);
    HALF[1] + (HALF[0] - HALF[1]) * t * t * (3.0 - 2.0 * t)
}

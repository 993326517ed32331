//! Code_Aster's test SSNV128 (V6.04.128): a plate on a rigid plane under pressure from above and from the side.
//!
//! Its reference are the mean displacements of several programs (R. A. Feijóo, H. J. C. Barbosa and N. Zouain,
//! Numerical formulations for contact problems with friction, J. Theor. Appl. Mech.); Code_Aster keeps 5 % of them.

use super::super::report::{MeasuredValue, MeshSeries};
use super::super::runner::{Runner, SolvedScene};
use super::tractions;
use base::Result;

/// Places along the bottom in metres, and how far they slide in metres.
const SLIDES: [(&str, f64, f64); 5] = [
    ("A", 0.0, 2.86e-5),
    ("B", 0.00125, 2.72e-5),
    ("C", 0.005, 2.28e-5),
    ("D", 0.0075, 1.98e-5),
    ("E", 0.01125, 1.50e-5),
];

/// The tolerance of Code_Aster.
const LIMIT: f64 = 0.05;

/// A kind of elements: its name in scenes, its name in reports, and the dimension.
const KINDS: [(&str, &str, usize); 3] = [
    ("q1", "quadrilaterals", 2),
    ("p1", "triangles", 2),
    ("q1", "hexahedra", 3),
];

/// Elements of both orders, in space one layer of first order that is held along z; 32 elements of first order have the
/// nodes of Code_Aster's mesh.
pub fn run(runner: &mut Runner) -> Result<Vec<MeshSeries>> {
    let mut out = Vec::new();
    for (element, kind, dim) in KINDS {
        for order in 1..=4 - dim {
            let mut list = Vec::new();
            let meshes: &[usize] = if runner.quick { &[32] } else { &[32, 64, 128] };
            for n in meshes.iter().map(|n| n / order) {
                let name = format!("ssnv128_{kind}_order{order}_{n}");
                let run = runner.solve(&name, &scene(n, element, order, dim))?;
                list.push(run.mesh(format!("{n} × {n}"), 1.0 / n as f64, slides(&run)));
            }
            // The reference has few digits: the order of what is left says nothing.
            out.push(MeshSeries {
                order: None,
                ..MeshSeries::new(format!("{kind}, order {order}"), list)
            });
        }
    }
    Ok(out)
}

fn slides(run: &SolvedScene) -> Vec<MeasuredValue> {
    let nodes = tractions(run.last());
    let at = |(name, x, expected): (&str, f64, f64)| {
        let node = nodes.iter().find(|n| (n.point[0] - x).abs() < 1e-9);
        let slip = node.map_or(f64::NAN, |n| n.slip[0]);
        MeasuredValue::beside(&format!("u_x of {name}"), slip, expected).within(Some(LIMIT))
    };
    SLIDES.map(at).into()
}

fn scene(n: usize, element: &str, order: usize, dim: usize) -> String {
    let list = |v: [&str; 3]| v[..dim].join(", ");
    let held = match dim {
        2 => "",
        _ => ", back = { z = 0 }, front = { z = 0 }",
    };
    let n = n.to_string();
    format!(
        "title = \"A plate on a rigid plane\"\ndimension = {dim}\nphysics = \"elasticity\"\n\
         element = \"{element}\"\norder = {order}\n\n\
         [[body]]\nname = \"plate\"\nsize = [{}]\nelements = [{}]\nsubdomains = [{}]\n\
         young = 130e9\npoisson = 0.2\ndirichlet = {{ right = {{ x = 0 }}{held} }}\n\
         pressure = {{ top = 5e7, left = 15e7 }}\n\n\
         [[obstacle]]\nbody = \"plate\"\nside = \"bottom\"\n\
         plane = {{ point = [{}], normal = [{}] }}\nfriction = 1\n",
        list(["0.04", "0.04", "0.00125"]),
        list([&n, &n, "1"]),
        list(["2", "2", "1"]),
        list(["0", "0", "0"]),
        list(["0", "1", "0"]),
    )
}

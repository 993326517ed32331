//! The contact patch test: two blocks of different meshes under the same pressure from all sides.

use super::report::{MeasuredValue, MeshSeries};
use super::runner::Runner;
use base::Result;

/// The largest permitted error of a pressure.
const LIMIT: f64 = 1e-10;

/// Both dimensions, a flat and an inclined common face, elements of both orders, both sides with the multipliers.
pub fn run(runner: &mut Runner) -> Result<Vec<MeshSeries>> {
    let mut out = Vec::new();
    for dim in [2, 3] {
        for (slope, face) in [(0.0, "flat"), (0.1, "inclined")] {
            for order in [1, 2] {
                let mut meshes = Vec::new();
                for (element, kinds) in [
                    ("q1", ["quadrilaterals", "hexahedra"]),
                    ("p1", ["triangles", "tetrahedra"]),
                ] {
                    let kind = kinds[dim - 2];
                    for multipliers in ["low", "up"] {
                        let name = format!("patch_{dim}d_{face}_{kind}_{order}_{multipliers}");
                        let text = scene(dim, order, element, slope, multipliers);
                        let run = runner.solve_to(&name, &text, None, 1e-12)?;
                        let worst = run.worst_pressure(1.0, |_| true);
                        let value = MeasuredValue::error("pressure", worst).within(Some(LIMIT));
                        let label = format!("{kind}, multipliers on `{multipliers}`");
                        meshes.push(run.mesh(label, 1.0, vec![value]));
                    }
                }
                let place = ["plane", "space"][dim - 2];
                out.push(MeshSeries::new(
                    format!("{place}, {face}, order {order}"),
                    meshes,
                ));
            }
        }
    }
    Ok(out)
}

/// Two blocks, one on the other. The stress is −1 everywhere, also where the common face is inclined.
fn scene(dim: usize, order: usize, element: &str, slope: f64, multipliers: &str) -> String {
    let map = match dim {
        2 => format!("{{ y = \"y + {slope}*x*y*(2 - y)\" }}"),
        _ => format!("{{ y = \"y + {slope}*(x + 0.5*z)*y*(2 - y)\" }}"),
    };
    let list = |v: [usize; 3]| format!("{:?}", &v[..dim]);
    let (held, pressed) = match dim {
        2 => ("", ""),
        _ => (", back = { z = 0 }", ", front = 1"),
    };
    let body = |name: &str, y: usize, elements: [usize; 3], held: &str, pressed: &str| {
        format!(
            "\n[[body]]\nname = \"{name}\"\norigin = {}\nsize = {}\nshape = {map}\nelements = {}\nsubdomains = {}\n\
             young = 10\npoisson = 0.3\ndirichlet = {{ left = {{ x = 0 }}{held} }}\n\
             pressure = {{ right = 1{pressed} }}\n",
            list([0, y, 0]),
            list([2, 1, 1]),
            list(elements),
            list([2, 1, 1])
        )
    };
    let low = format!("{held}, bottom = {{ y = 0 }}");
    let up = format!("{pressed}, top = 1");
    format!(
        "title = \"Contact patch test\"\ndimension = {dim}\nphysics = \"elasticity\"\nelement = \"{element}\"\n\
         order = {order}\n{}{}\n[[contact]]\nbodies = [\"low\", \"up\"]\nmultipliers = \"{multipliers}\"\n",
        body("low", 0, [4, 2, 3], &low, pressed),
        body("up", 1, [6, 3, 2], held, &up),
    )
}

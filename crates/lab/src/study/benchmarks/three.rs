//! Three bodies each of which touches both others: two blocks side by side, and a third one on both.

use super::report::{MeasuredValue, MeshSeries};
use super::runner::Runner;
use base::Result;

/// The largest permitted error of a pressure.
const LIMIT: f64 = 1e-9;

/// Pressures from the right and from above.
const SIDE: f64 = 2.0;
const TOP: f64 = 3.0;

/// In the plane and in space. Every body has the stresses −2 and −3, which are the pressures at the joints.
pub fn run(runner: &mut Runner) -> Result<Vec<MeshSeries>> {
    let mut out = Vec::new();
    for dim in [2, 3] {
        for order in [1, 2] {
            let mut list = Vec::new();
            for n in [1, 2, 3] {
                let name = format!("three_{dim}d_order{order}_{n}");
                let run = runner.solve_to(&name, &scene(dim, order, n), None, 1e-12)?;
                let up = run.worst_pressure(TOP, |r| r.normal()[1].abs() > 0.5);
                let side = run.worst_pressure(SIDE, |r| r.normal()[0].abs() > 0.5);
                let values = vec![
                    MeasuredValue::error("pressure from above", up).within(Some(LIMIT)),
                    MeasuredValue::error("pressure from the side", side).within(Some(LIMIT)),
                ];
                list.push(run.mesh(format!("n = {n}"), 1.0 / n as f64, values));
            }
            let place = ["plane", "space"][dim - 2];
            out.push(MeshSeries::new(format!("{place}, order {order}"), list));
        }
    }
    Ok(out)
}

fn scene(dim: usize, order: usize, n: usize) -> String {
    let list = |v: [usize; 3]| format!("{:?}", &v[..dim]);
    let back = ["", ", back = { z = 0 }"][dim - 2];
    let body = |name: &str, [x, y]: [usize; 2], width: usize, elements: [usize; 3], rest: &str| {
        format!(
            "\n[[body]]\nname = \"{name}\"\norigin = {}\nsize = {}\nelements = {}\nyoung = 100\npoisson = 0.3\n{rest}",
            list([x, y, 0]),
            list([width, 1, 1]),
            list(elements.map(|e| e * n))
        )
    };
    format!(
        "title = \"Three bodies that touch each other\"\ndimension = {dim}\nphysics = \"elasticity\"\n\
         order = {order}\n{}{}{}\n\
         [[contact]]\nbodies = [\"left\", \"right\"]\n\n[[contact]]\nbodies = [\"left\", \"top\"]\n\n\
         [[contact]]\nbodies = [\"right\", \"top\"]\n",
        body(
            "left",
            [0, 0],
            1,
            [2, 3, 2],
            &format!("dirichlet = {{ left = {{ x = 0 }}, bottom = {{ y = 0 }}{back} }}\n")
        ),
        body(
            "right",
            [1, 0],
            1,
            [3, 2, 1],
            &format!("dirichlet = {{ bottom = {{ y = 0 }}{back} }}\npressure = {{ right = {SIDE} }}\n")
        ),
        body(
            "top",
            [0, 1],
            2,
            [5, 2, 3],
            &format!(
                "dirichlet = {{ left = {{ x = 0 }}{back} }}\npressure = {{ right = {SIDE}, top = {TOP} }}\n"
            )
        ),
    )
}

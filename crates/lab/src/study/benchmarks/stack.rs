//! A stack of blocks under their own weight: only the lowest is held, and no spring or penalty holds the others.

use super::report::{MeasuredValue, MeshSeries};
use super::runner::{Runner, SolvedScene};
use base::Result;
use fetifeti::problem::RowSource;

/// The largest permitted error of a force, relative to the whole weight.
const LIMIT: f64 = 1e-8;

/// Height of a block; its length is 2, its depth in space 1.
const HEIGHT: f64 = 0.5;

/// Stacks of blocks in the plane and in space.
pub fn run(runner: &mut Runner) -> Result<Vec<MeshSeries>> {
    let mut out = Vec::new();
    let counts: [&[usize]; 2] = if runner.quick {
        [&[10], &[5]]
    } else {
        [&[10, 20, 40], &[5, 10, 20]]
    };
    for (dim, counts) in [2, 3].into_iter().zip(counts) {
        let mut list = Vec::new();
        for &n in counts {
            let run = runner.solve(&format!("stack_{dim}d_{n}"), &scene(dim, n))?;
            list.push(run.mesh(
                format!("{n} blocks"),
                1.0,
                vec![
                        MeasuredValue::error("force at a joint / weight", forces(&run, n))
                            .within(Some(LIMIT)),
                    ],
            ));
        }
        out.push(MeshSeries::new(["plane", "space"][dim - 2], list));
    }
    Ok(out)
}

/// The weight of block `k` per volume.
fn weight(k: usize) -> f64 {
    1.0 + 0.5 * (k % 3) as f64
}

/// The largest difference of the force at a joint from the weight above, relative to the whole weight.
fn forces(run: &SolvedScene, n: usize) -> f64 {
    let above = |k: usize| 2.0 * HEIGHT * (k + 1..n).map(weight).sum::<f64>();
    let mut found = vec![0.0; n - 1];
    for row in &run.last().rows {
        if let RowSource::Interface(k) = row.label.source {
            let [low, high] = run.scene.interfaces[k].bodies;
            assert_eq!(low + 1, high, "blocks touch their neighbours only");
            found[low] += row.multiplier;
        }
    }
    let off = found.iter().enumerate().map(|(k, f)| (f - above(k)).abs());
    off.fold(0.0, f64::max) / above(0)
}

/// `n` blocks, each with a mesh, a stiffness and a weight of its own, every second one a little to the right.
fn scene(dim: usize, n: usize) -> String {
    let list = |v: [f64; 3]| format!("{:?}", &v[..dim]);
    let mut text =
        format!("title = \"A stack of {n} blocks\"\ndimension = {dim}\nphysics = \"elasticity\"\n");
    for k in 0..n {
        let shift = 0.1 * (k % 2) as f64;
        let elements = [4 + k % 4, 2 + k % 2, 2 + k % 3];
        let mut load = vec!["0".to_string(); dim];
        load[1] = format!("{}", -weight(k));
        text += &format!(
            "\n[[body]]\nname = \"b{k}\"\norigin = {}\nsize = {}\nelements = {:?}\nyoung = {}\npoisson = 0.3\n\
             load = [{}]\n",
            list([shift, HEIGHT * k as f64, 0.0]),
            list([2.0, HEIGHT, 1.0]),
            &elements[..dim],
            1000 * (1 + k % 5),
            load.join(", ")
        );
        if k == 0 {
            text += "dirichlet = [\"bottom\"]\n";
        }
    }
    for k in 1..n {
        text += &format!("\n[[contact]]\nbodies = [\"b{}\", \"b{k}\"]\n", k - 1);
    }
    text
}

//! Random walls with friction in a box, judged by the conditions that a solution satisfies, on the assembled problem.
//!
//! ```text
//!     K u + Bᵀ λ = f,    λ_n ≥ 0,  gap ≤ 0,  λ_n gap = 0,    |λ_t| ≤ μ λ_n,    λ_t = μ λ_n w/|w| where w ≠ 0
//! ```
//!
//! Where four bodies meet, rows depend on each other, and multipliers are not unique: conditions are what can be asked.

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::support::rng::Rng;
use crate::support::sample::sample;
use crate::support::session::with_session;
use fetifeti::problem::FrictionBound;
use fetifeti::settings::MethodSettings;
use fetifeti::{FetiFeti, Problem, Solution};
use petsc::Session;
use scene::{Scene, Stepper};

/// Conditions hold to this, relative to the largest force or displacement.
const ACCURACY: f64 = 1e-6;

/// The tolerance of the solver.
const RTOL: f64 = 1e-9;

/// Floating bodies in a box without a lid, pressed down and sideways from above; the nodes of layers match, or do not.
pub(super) fn scene(id: u64) -> String {
    let mut rng = Rng::new(90_000 + id);
    let mut pick = |list: &[f64]| list[(rng.unit() * list.len() as f64) as usize % list.len()];
    let solid = pick(&[0.0, 0.0, 1.0]) > 0.0;
    let columns = pick(if solid { &[1.0, 2.0] } else { &[1.0, 2.0, 3.0] }) as usize;
    let layers = pick(if solid { &[1.0, 2.0] } else { &[1.0, 2.0, 3.0] }) as usize;
    let n = pick(if solid { &[1.0, 2.0] } else { &[2.0, 3.0, 4.0] }) as usize;
    let more = usize::from(pick(&[0.0, 0.0, 1.0]) > 0.0);
    let jump = pick(&[1.0, 100.0, 1e4]);
    let friction = pick(&[0.05, 0.1, 0.2, 0.3, 0.5, 0.8]);
    let cycle = pick(&[0.0, 0.0, 1.0]) > 0.0;
    let vector = |x: f64, y: f64, z: f64| match solid {
        true => format!("[{x}, {y}, {z}]"),
        false => format!("[{x}, {y}]"),
    };
    let dim = if solid { 3 } else { 2 };
    let mut out = format!("dimension = {dim}\nphysics = \"elasticity\"\n");
    let name = |i: usize, j: usize| format!("b{i}{j}");
    for j in 0..layers {
        for i in 0..columns {
            let young = pick(&[1.0, jump]);
            let elements = n + more * (j % 2);
            let _ = write!(
                out,
                "[[body]]\nname = \"{}\"\norigin = {}\nsize = 1\nelements = {elements}\nsubdomains = 1\n\
                 young = {young}\npoisson = {}\n",
                name(i, j),
                vector(i as f64, j as f64, 0.0),
                pick(&[0.0, 0.2, 0.3])
            );
            if j + 1 == layers {
                let down = pick(&[-0.1, -0.05, -0.02]);
                let sideways = pick(&[-0.05, 0.0, 0.02, 0.04]);
                let across = pick(&[0.0, 0.03]);
                let _ = writeln!(
                    out,
                    "traction = {{ top = {} }}",
                    vector(sideways, down, across)
                );
            }
        }
    }
    for j in 0..layers {
        for i in 0..columns {
            let mut contact = |with: String| {
                let _ = writeln!(
                    out,
                    "[[contact]]\nbodies = [\"{}\", \"{with}\"]\nfriction = {friction}",
                    name(i, j)
                );
            };
            if i + 1 < columns {
                contact(name(i + 1, j));
            }
            if j + 1 < layers {
                contact(name(i, j + 1));
            }
        }
    }
    let mut wall = |body: String, side: &str, point: String, normal: String| {
        let _ = writeln!(
            out,
            "[[obstacle]]\nbody = \"{body}\"\nside = \"{side}\"\nplane = {{ point = {point}, normal = {normal} }}\n\
             friction = {friction}"
        );
    };
    for j in 0..layers {
        let right = vector(columns as f64, 0.0, 0.0);
        wall(
            name(0, j),
            "left",
            vector(0.0, 0.0, 0.0),
            vector(1.0, 0.0, 0.0),
        );
        wall(name(columns - 1, j), "right", right, vector(-1.0, 0.0, 0.0));
    }
    for i in 0..columns {
        wall(
            name(i, 0),
            "bottom",
            vector(0.0, 0.0, 0.0),
            vector(0.0, 1.0, 0.0),
        );
        for j in (0..layers).filter(|_| solid) {
            wall(
                name(i, j),
                "back",
                vector(0.0, 0.0, 0.0),
                vector(0.0, 0.0, 1.0),
            );
            wall(
                name(i, j),
                "front",
                vector(0.0, 0.0, 1.0),
                vector(0.0, 0.0, -1.0),
            );
        }
    }
    if cycle {
        out.push_str("[steps]\ntimes = [1, 2, 3]\nload = \"if(t<2, 1, if(t<3, 0.3, 0.8))\"\n");
    }
    out
}

/// The numbers of the dofs of a problem.
fn numbers(problem: &Problem) -> BTreeMap<u64, usize> {
    let mut number = BTreeMap::new();
    for dof in problem.local.iter().flat_map(|s| &s.dofs) {
        let next = number.len();
        number.entry(*dof).or_insert(next);
    }
    number
}

/// The largest violation of the conditions; `before` is u of the load step before.
fn violation(problem: &Problem, solution: &Solution, before: &mut Option<Vec<f64>>) -> f64 {
    let number = numbers(problem);
    let mut u = vec![0.0; number.len()];
    // K u + Bᵀ λ − f.
    let mut rest = vec![0.0; number.len()];
    for (sub, values) in problem.local.iter().zip(&solution.u) {
        let at: Vec<usize> = sub.dofs.iter().map(|d| number[d]).collect();
        for (i, &row) in at.iter().enumerate() {
            u[row] = values[i];
            let (columns, entries) = sub.k.row(i);
            let product = columns
                .iter()
                .zip(entries)
                .map(|(&j, k)| k * values[j as usize]);
            rest[row] += product.sum::<f64>() - sub.f[i];
        }
    }
    let last = before.take().unwrap_or_else(|| vec![0.0; u.len()]);
    let rows = solution.rows().iter().chain(solution.tangential_rows());
    let lambda: Vec<f64> = rows.map(|r| r.multiplier).collect();
    assert_eq!(lambda.len(), problem.rows.len());
    for (row, l) in problem.rows.iter().zip(&lambda) {
        row.terms
            .iter()
            .for_each(|(dof, b)| rest[number[dof]] += b * l);
    }
    let largest = |v: &[f64]| v.iter().fold(0.0f64, |a, x| a.max(x.abs()));
    let (force, length) = (largest(&lambda), largest(&u));
    let jump = |r: usize, u: &[f64]| -> f64 {
        let terms = problem.rows[r].terms.iter();
        terms.map(|(dof, b)| b * u[number[dof]]).sum()
    };
    let mut worst = largest(&rest) / force;
    for node in &problem.friction {
        let (l, gap) = (lambda[node.normal] / force, jump(node.normal, &u) / length);
        worst = worst.max(-l).max(gap).max(l.min(-gap));
        let FrictionBound::Coulomb { coefficient, .. } = node.bound else {
            unreachable!("these walls have Coulomb friction");
        };
        let g = coefficient * l.max(0.0);
        let tangential = || node.tangential.iter();
        let w: Vec<f64> = tangential()
            .map(|&t| (jump(t, &u) - jump(t, &last)) / length)
            .collect();
        let f: Vec<f64> = tangential().map(|&t| lambda[t] / force).collect();
        let size = |v: &[f64]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
        worst = worst.max(size(&f) - g);
        // |w| (λ_t − g w/|w|): a slip of rounding has no direction.
        let slip = size(&w);
        let apart: Vec<f64> = f.iter().zip(&w).map(|(f, w)| slip * f - g * w).collect();
        worst = worst.max(size(&apart));
    }
    *before = Some(u);
    worst
}

/// All load steps of a scene: the solutions, and the largest violation.
fn solved(session: &Session, text: &str) -> base::Result<(Vec<Solution>, f64)> {
    let scene = Scene::parse("wall.toml", text).expect("a good scene");
    let problem = scene.substructures(&|_| true).expect("a good scene");
    let settings = MethodSettings::default().rtol(RTOL);
    let solver = FetiFeti::new(session, problem, settings)?;
    let mut stepper = Stepper::with_solver(scene, solver)?;
    let (mut before, mut worst, mut out) = (None, 0.0f64, Vec::new());
    while let Some(step) = stepper.next() {
        let solution = step?.solution;
        if !solution.converged() {
            out.push(solution);
            break;
        }
        if !solution.tangential_rows().is_empty() {
            let problem = stepper.solver().problem();
            worst = worst.max(violation(problem, &solution, &mut before));
        }
        out.push(solution);
    }
    Ok((out, worst))
}

/// The scenes of these numbers: how many are right, and the steps and iterations over those without friction.
fn judge(ids: impl Iterator<Item = u64>) {
    let ids: Vec<u64> = ids.collect();
    let n = ids.len();
    with_session(move |session| {
        let (mut right, mut without, mut worst) = (0, 0, 0.0f64);
        let mut ratios: [Vec<f64>; 2] = Default::default();
        let [mut failures, mut wrong] = [Vec::new(), Vec::new()];
        for id in ids {
            let text = scene(id);
            let lines = text.lines().filter(|l| !l.starts_with("friction"));
            let free = lines.collect::<Vec<_>>().join("\n") + "\n";
            let (found, off) = match solved(session, &text) {
                Ok(found) => found,
                Err(e) if e.to_string().contains("pushed away") => {
                    // What nothing holds with friction is not held without.
                    match solved(session, &free) {
                        Ok(_) => wrong.push(format!("{id}: {e}")),
                        Err(_) => without += 1,
                    }
                    continue;
                }
                Err(e) => {
                    wrong.push(format!("{id}: {e}"));
                    continue;
                }
            };
            if let Some(last) = found.last().filter(|s| !s.converged()) {
                failures.push(format!("{id}: {}", last.status));
                continue;
            }
            if off >= ACCURACY {
                wrong.push(format!("{id}: conditions to {off:.1e}"));
            }
            worst = worst.max(off);
            right += 1;
            let Ok((plain, _)) = solved(session, &free) else {
                continue;
            };
            let of = |list: &[Solution]| {
                let steps: usize = list.iter().map(|s| s.steps.len()).sum();
                let iterations: usize = list.iter().map(|s| s.iterations).sum();
                [steps as f64, iterations as f64]
            };
            let (with, without) = (of(&found), of(&plain));
            (0..2).for_each(|k| ratios[k].push(with[k] / without[k]));
        }
        let quantiles = ratios.map(|mut list| {
            list.sort_by(f64::total_cmp);
            [0.5, 0.9, 1.0].map(|q| list[((list.len() - 1) as f64 * q) as usize])
        });
        println!(
            "{right} right (conditions to {worst:.1e}), {without} without a solution, not solved: {failures:?}; steps \
             and iterations over those without friction, median, 9 of 10, most: {quantiles:.2?}"
        );
        assert!(wrong.is_empty(), "{wrong:?}");
        // Where four bodies meet in space, states may wander (22 of the 500): that is said, and no answer is wrong. A
        // sample of ten may hold three of them.
        assert!(
            failures.len() <= 4 + n / 20 && right > n / 2,
            "{failures:?}"
        );
    });
}

/// Every fiftieth of five hundred walls.
#[test]
fn random_walls_with_friction_satisfy_the_conditions() {
    judge(sample(50, 0..500));
}

/// All of them: `cargo test --test contact -- --ignored --nocapture five_hundred_walls`.
#[test]
#[ignore = "the sample runs"]
fn five_hundred_walls_with_friction() {
    judge(0..500);
}

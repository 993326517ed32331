//! Contact scenes solved on the assembled problem by a proximal method of multipliers: the rows have the right signs,
//! and the example scenes have a solution.

use faer::prelude::Solve;
use faer::sparse::{SparseColMat, Triplet};
use faer::Side;
use fetifeti::problem::{Law, RowLabel, RowSource};
use scene::{Numbering, Scene};

/// min ½ uᵀKu − fᵀu over B u ≤ g, on the unknowns of the numbering.
struct Problem {
    n: usize,
    k: Vec<Triplet<usize, usize, f64>>,
    f: Vec<f64>,
    rows: Vec<Vec<(usize, f64)>>,
    g: Vec<f64>,
    labels: Vec<RowLabel>,
}

/// Weight of the penalty and of the proximal term.
const RHO: f64 = 1e3;
const EPSILON: f64 = 1e-4;

struct Solution {
    u: Vec<f64>,
    lambda: Vec<f64>,
    energy: f64,
}

impl Problem {
    /// The scene at load step `step`.
    fn new(scene: &Scene, step: usize) -> Problem {
        let numbering = Numbering::new(scene);
        let n = numbering.len() as usize;
        let (mut k, mut f) = (Vec::new(), vec![0.0; n]);
        for index in 0..scene.n_subdomains() {
            let s = scene.subdomain(index).unwrap();
            let global: Vec<usize> = s
                .dofs
                .iter()
                .map(|&d| numbering.global(d) as usize)
                .collect();
            let load = scene.loads(index, step).unwrap();
            for (i, &gi) in global.iter().enumerate() {
                f[gi] += load[i];
                let (col, val) = s.k.row(i);
                k.extend(
                    col.iter()
                        .zip(val)
                        .map(|(&j, &v)| Triplet::new(gi, global[j as usize], v)),
                );
            }
        }
        let gaps = scene.gaps(&|_| true, step).unwrap();
        let mut out = Problem {
            n,
            k,
            f,
            rows: Vec::new(),
            g: Vec::new(),
            labels: Vec::new(),
        };
        for (row, gap) in scene.solver_rows(&|_| true).iter().zip(gaps) {
            if row.law == Law::Unilateral {
                let terms = row
                    .terms
                    .iter()
                    .map(|&(d, c)| (numbering.global(d) as usize, c));
                out.rows.push(terms.collect());
                out.g.push(gap);
                out.labels.push(row.label);
            }
        }
        out
    }

    /// B u − g.
    fn excess(&self, u: &[f64]) -> Vec<f64> {
        let row = |r: &Vec<(usize, f64)>| r.iter().map(|&(i, c)| c * u[i]).sum::<f64>();
        self.rows
            .iter()
            .zip(&self.g)
            .map(|(r, g)| row(r) - g)
            .collect()
    }

    fn k_times(&self, u: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.n];
        self.k.iter().for_each(|t| out[t.row] += t.val * u[t.col]);
        out
    }

    /// The rows with an active penalty.
    fn active(&self, v: &[f64], lambda: &[f64]) -> Vec<bool> {
        let excess = self.excess(v);
        let both = excess.iter().zip(lambda);
        both.map(|(e, l)| l + RHO * e > 0.0).collect()
    }

    /// The function that the inner iteration minimises.
    fn merit(&self, v: &[f64], u: &[f64], lambda: &[f64]) -> f64 {
        let kv = self.k_times(v);
        let smooth =
            |i: usize| (0.5 * kv[i] - self.f[i]) * v[i] + 0.5 * EPSILON * (v[i] - u[i]).powi(2);
        let excess = self.excess(v);
        let pushed = excess
            .iter()
            .zip(lambda)
            .map(|(e, l)| (l + RHO * e).max(0.0).powi(2));
        (0..self.n).map(smooth).sum::<f64>() + pushed.sum::<f64>() / (2.0 * RHO)
    }

    /// Proximal method of multipliers with a semismooth Newton method inside.
    fn solve(&self) -> Solution {
        let (mut u, mut lambda) = (vec![0.0; self.n], vec![0.0; self.rows.len()]);
        for _ in 0..200 {
            let mut v = u.clone();
            for newton in 0.. {
                let active = self.active(&v, &lambda);
                let mut triplets = self.k.clone();
                triplets.extend((0..self.n).map(|i| Triplet::new(i, i, EPSILON)));
                let mut b = faer::Mat::from_fn(self.n, 1, |i, _| self.f[i] + EPSILON * u[i]);
                for r in (0..self.rows.len()).filter(|&r| active[r]) {
                    for &(i, c) in &self.rows[r] {
                        b[(i, 0)] += c * (RHO * self.g[r] - lambda[r]);
                        let others = self.rows[r].iter();
                        triplets.extend(others.map(|&(j, d)| Triplet::new(i, j, RHO * c * d)));
                    }
                }
                let a = SparseColMat::try_new_from_triplets(self.n, self.n, &triplets).unwrap();
                let x = a.sp_cholesky(Side::Lower).unwrap().solve(&b);
                let d: Vec<f64> = (0..self.n).map(|i| x[(i, 0)] - v[i]).collect();
                // The full step, unless the convex objective increases along it.
                let (start, mut length) = (self.merit(&v, &u, &lambda), 1.0);
                let end = loop {
                    let end: Vec<f64> = v.iter().zip(&d).map(|(v, d)| v + length * d).collect();
                    if length < 1e-6 || self.merit(&end, &u, &lambda) <= start + 1e-14 {
                        break end;
                    }
                    length *= 0.5;
                };
                v = end;
                let largest = d.iter().fold(0.0f64, |m, d| m.max(d.abs()));
                let size = v.iter().fold(1.0f64, |m, v| m.max(v.abs()));
                if largest < 1e-10 * size || (length == 1.0 && self.active(&v, &lambda) == active) {
                    break;
                }
                assert!(
                    newton < 200,
                    "the inner iteration does not settle: {largest}"
                );
            }
            let excess = self.excess(&v);
            let change = v
                .iter()
                .zip(&u)
                .fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
            for (l, e) in lambda.iter_mut().zip(&excess) {
                *l = (*l + RHO * e).max(0.0);
            }
            u = v;
            if change < 1e-10 && excess.iter().all(|&e| e < 1e-12) {
                break;
            }
        }
        let ku = self.k_times(&u);
        let energy = (0..self.n).map(|i| (0.5 * ku[i] - self.f[i]) * u[i]).sum();
        let out = Solution { u, lambda, energy };
        self.check(&out);
        out
    }

    /// K u + Bᵀλ = f, B u ≤ g, λ ≥ 0, λ (B u − g) = 0.
    fn check(&self, s: &Solution) {
        let mut residual = self.k_times(&s.u);
        for (r, row) in self.rows.iter().enumerate() {
            row.iter()
                .for_each(|&(i, c)| residual[i] += c * s.lambda[r]);
        }
        let off = residual
            .iter()
            .zip(&self.f)
            .fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
        assert!(off < 1e-8, "stationarity {off}");
        for (e, l) in self.excess(&s.u).iter().zip(&s.lambda) {
            assert!(*e < 1e-8 && *l >= 0.0 && (e * l).abs() < 1e-8, "{e} {l}");
        }
    }
}

fn example(name: &str) -> Scene {
    Scene::load(format!("../../examples/scenes/{name}.toml")).unwrap()
}

#[test]
fn the_model_problem_agrees_with_an_independent_solution() {
    let text = std::fs::read_to_string("../../examples/scenes/model_contact.toml").unwrap();
    // (elements, energy, nodes in contact, contact force), from a second implementation.
    for (elements, energy, nodes, force) in [
        (8, -0.259_286_663_187_288_8, 7, 0.25),
        (16, -0.260_249_546_410_658_6, 13, 0.25),
        (32, -0.260_492_048_725_617_93, 24, 0.25),
    ] {
        for subdomains in [1, 4] {
            let text = text.replace("elements = 32", &format!("elements = {elements}"));
            let text = text.replace("[4, 4]", &format!("[{subdomains}, {subdomains}]"));
            let problem = Problem::new(&Scene::parse("model.toml", &text).unwrap(), 0);
            assert_eq!(problem.rows.len(), elements + 1);
            let s = problem.solve();
            assert!((s.energy - energy).abs() < 1e-9, "{} {energy}", s.energy);
            // The nodes in contact are the lowest ones of the face.
            for (label, lambda) in problem.labels.iter().zip(&s.lambda) {
                let k = (label.t[0] * elements as f64).round() as usize;
                assert_eq!(
                    *lambda > 1e-7,
                    k < nodes,
                    "node {k} of {elements}: {lambda}"
                );
                assert_eq!(label.source, RowSource::Interface(0));
            }
            let sum: f64 = s.lambda.iter().sum();
            assert!((sum - force).abs() < 1e-9, "{sum}");
        }
    }
}

/// Solves every step of an example; returns the numbers of rows with and without force.
fn contact_of(name: &str) -> Vec<[usize; 2]> {
    let scene = example(name);
    assert!(scene.has_contact());
    let steps = 0..scene.n_steps();
    steps
        .map(|step| {
            let s = Problem::new(&scene, step).solve();
            let on = s.lambda.iter().filter(|l| **l > 1e-7).count();
            [on, s.lambda.len() - on]
        })
        .collect()
}

#[test]
fn the_examples_have_solutions_that_touch_in_part() {
    for name in [
        "contact_row_16",
        "contact_grid_100",
        "contact_gap_table",
        "obstacle",
    ] {
        let counts = contact_of(name);
        eprintln!("{name}: {counts:?}");
        assert_eq!(counts.len(), 1);
        assert!(counts[0].iter().all(|&n| n >= 4), "{name}: {counts:?}");
    }
}

#[test]
fn the_punch_meets_the_block_on_its_way() {
    let counts = contact_of("press_ramp");
    eprintln!("{counts:?}");
    assert_eq!(counts.len(), 10);
    // Force on the block grows from step to step; at first only the base carries it.
    let scene = example("press_ramp");
    let force: Vec<f64> = (0..10)
        .map(|step| {
            let problem = Problem::new(&scene, step);
            let s = problem.solve();
            let punch = |l: &&RowLabel| l.source == RowSource::Interface(1);
            let rows = problem.labels.iter().zip(&s.lambda);
            rows.filter(|(l, _)| punch(l)).map(|(_, l)| l).sum()
        })
        .collect();
    eprintln!("{force:?}");
    assert!(force[0] == 0.0 && force[9] > 0.05, "{force:?}");
    assert!(force.windows(2).all(|w| w[0] <= w[1]), "{force:?}");
}

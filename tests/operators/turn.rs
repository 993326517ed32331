//! The operators of a turned subdomain, from those of another and from its own matrix.

use std::sync::Arc;

use crate::matrices::{distance, random};
use base::linalg::csr::Csr;
use base::linalg::dense::Dense;
use base::linalg::orthogonal::Matrix;
use cholesky::interior::Condenser;
use cholesky::symbolic::Keep;
use fetifeti::inside::turn::*;
use fetifeti::inside::which::{Operator, OperatorForm};
use fetifeti::inside::{Average, AverageKind, LocalProblem, ScaledSubdomain};
use scene::Scene;

const PHI: f64 = 3.7;

/// A rotation by an angle with sine 0.6 about z, then about x; mirrored at last.
const Q: Matrix = [[-0.8, 0.48, -0.36], [0.6, 0.64, -0.48], [0.0, 0.6, 0.8]];

/// A subdomain of an elastic body that nothing holds, bent so that no axis is like another.
#[derive(Clone)]
struct Sample {
    k: Csr,
    places: Vec<[f64; 3]>,
    delta: Vec<u32>,
    vertices: Vec<u32>,
    averages: Vec<Vec<u32>>,
    /// Rotations of each face about its middle: dofs and weights.
    motions: Vec<Vec<(Vec<u32>, Vec<f64>)>>,
}

impl Sample {
    fn new(dim: usize) -> Sample {
        let (elements, shape) = match dim {
            2 => ("[4, 3]", "{ x = \"x + 0.1*y^2\", y = \"y*(1 + 0.2*x)\" }"),
            _ => (
                "[4, 3, 3]",
                "{ x = \"x + 0.1*y^2\", y = \"y*(1 + 0.2*x)\", z = \"z*(1 + 0.1*y) + 0.1*x\" }",
            ),
        };
        let size = ["", "", "[2, 1]", "[2, 1, 1.5]"][dim];
        let text = format!(
            "title = \"t\"\ndimension = {dim}\nphysics = \"elasticity\"\n[[body]]\nname = \"b\"\nsize = {size}\n\
             elements = {elements}\nshape = {shape}\nyoung = 2\npoisson = 0.3\n"
        );
        let scene = Scene::parse("t.toml", &text).expect("a scene");
        let sub = scene.subdomain(0).expect("a subdomain");
        let places = sub.coordinates.expect("coordinates");
        let (nx, ny) = (5, 4);
        let nodes = places.len() / dim;
        let dofs = |list: &[usize]| -> Vec<u32> {
            let each = list
                .iter()
                .flat_map(|n| (0..dim).map(move |c| (dim * n + c) as u32));
            each.collect()
        };
        let lines = nodes / nx;
        let left: Vec<usize> = (0..lines).map(|l| l * nx).collect();
        let right: Vec<usize> = (0..lines).map(|l| l * nx + nx - 1).collect();
        // The corners at the ends of each face are vertices, two in the plane and four in space.
        let last = lines - 1;
        let corner = |l: &usize| [0, ny - 1, last + 1 - ny, last].contains(l);
        let pick = |face: &[usize], corners: bool| -> Vec<usize> {
            let some = (0..lines).filter(|l| corner(l) == corners);
            some.map(|l| face[l]).collect()
        };
        let open = [pick(&left, false), pick(&right, false)];
        let mut delta = [&open[0][..], &open[1]].concat();
        delta.sort_unstable();
        let mut vertices = [pick(&left, true), pick(&right, true)].concat();
        vertices.sort_unstable();
        let of = |c: usize| open.iter().map(move |face| (face, c));
        let averages = (0..dim).flat_map(of);
        let averages =
            averages.map(|(face, c)| face.iter().map(|n| (dim * n + c) as u32).collect());
        let rotations = |face: &Vec<usize>| {
            let middle = [0, 1, 2].map(|d| {
                let sum: f64 = face.iter().map(|n| places[dim * n][d]).sum();
                sum / face.len() as f64
            });
            let axes: &[[usize; 2]] = if dim == 2 {
                &[[0, 1]]
            } else {
                &[[0, 1], [1, 2], [2, 0]]
            };
            let rotation = |[a, b]: &[usize; 2]| {
                let mut weights = vec![0.0; dim * face.len()];
                for (k, n) in face.iter().enumerate() {
                    let x = places[dim * n];
                    weights[dim * k + a] = middle[*b] - x[*b];
                    weights[dim * k + b] = x[*a] - middle[*a];
                }
                (dofs(face), weights)
            };
            axes.iter().map(rotation).collect()
        };
        let motions = open.iter().map(rotations).collect();
        Sample {
            k: Arc::unwrap_or_clone(sub.k),
            motions,
            delta: dofs(&delta),
            vertices: dofs(&vertices),
            averages: averages.collect(),
            places,
        }
    }

    fn local(&self, k: &Csr, form: OperatorForm) -> LocalProblem {
        let average = |dofs: &Vec<u32>, weights| Average {
            kind: AverageKind::Mean,
            key: 0,
            dofs: dofs.clone(),
            weights,
        };
        let means = self.averages.iter().map(|dofs| average(dofs, None));
        let motions = self.motions.iter().flatten();
        let motions = motions.map(|(dofs, weights)| average(dofs, Some(weights.clone())));
        let averages: Vec<Average> = means.chain(motions).collect();
        let averages: Vec<&Average> = averages.iter().collect();
        let condenser = Condenser::alone(Keep::Interior);
        let places = Some(&self.places[..]);
        LocalProblem::new(
            k,
            &self.delta,
            &self.vertices,
            &averages,
            places,
            condenser,
            form,
        )
        .expect("a stiffness matrix")
    }

    /// Other rotations of the turned faces that see the same.
    fn turned_motions(&self, turn: &Turn) -> Vec<Vec<(Vec<u32>, Vec<f64>)>> {
        let mixed = |face: &Vec<(Vec<u32>, Vec<f64>)>| {
            let row = |k: usize| {
                let mut sum = vec![0.0; face[0].1.len()];
                for (l, (_, weights)) in face.iter().enumerate() {
                    let by = [1.0, -0.4, 0.3][(k + 2 * l) % 3];
                    sum.iter_mut().zip(weights).for_each(|(s, w)| *s += by * w);
                }
                turn.forth(&mut sum);
                (face[k].0.clone(), sum)
            };
            (0..face.len()).map(row).collect()
        };
        self.motions.iter().map(mixed).collect()
    }

    /// φ R K Rᵀ, entry by entry.
    fn turned(&self, dim: usize, q: &Matrix) -> Csr {
        let mut entries = Vec::new();
        for i in 0..self.k.n() {
            let (cols, vals) = self.k.row(i);
            for (&j, v) in cols.iter().zip(vals) {
                let j = j as usize;
                for a in 0..dim {
                    for b in 0..dim {
                        let value = PHI * q[a][i % dim] * v * q[b][j % dim];
                        let (row, col) = (i - i % dim + a, j - j % dim + b);
                        entries.push((row as u32, col as u32, value));
                    }
                }
            }
        }
        Csr::from_triplets(self.k.n(), &entries)
    }
}

fn plane() -> Matrix {
    [[0.6, 0.8, 0.0], [0.8, -0.6, 0.0], [0.0, 0.0, 1.0]]
}

#[track_caller]
fn close(a: &[f64], b: &[f64], what: &str) {
    let size = b.iter().fold(1e-300f64, |s, v| s.max(v.abs()));
    let far = distance(a, b) / size;
    assert!(far < 1e-10, "{what}: {far:.1e}");
}

fn compare(dim: usize, q: Matrix, sample: &Sample, form: OperatorForm, pack: bool) {
    let mut base = sample.local(&sample.k, form);
    if pack {
        base.pack();
    }
    base.store_psi();
    let (turn, turned) = (Turn::new(dim, q), sample.turned(dim, &q));
    let other = Sample {
        k: turned.clone(),
        motions: sample.turned_motions(&turn),
        ..sample.clone()
    };
    let mut own = other.local(&turned, form);
    own.store_psi();
    let own = ScaledSubdomain::new(Arc::new(own), 1.0);
    let basis = own.gamma().basis.clone();
    let base = Arc::new(base);
    let before = ScaledSubdomain::new(base.clone(), 1.0);
    assert!(turn.takes(sample.delta.len(), &before.gamma().basis, &basis));
    let copy = ScaledSubdomain::turned(base, PHI, turn, basis);
    assert_eq!(copy.is_implicit(), own.is_implicit());
    assert_eq!(copy.gamma().interface, own.gamma().interface);
    let n_gamma = own.gamma().n_gamma();
    let free = own.gamma().fixing.is_empty();
    let operators = if free {
        &[Operator::S, Operator::T][..]
    } else {
        &[Operator::S]
    };
    for &which in operators {
        let n = own.kind().order(which);
        let mut v = Dense::zeros(n, 3);
        v.data.copy_from_slice(&random(3 * n, 5));
        let (mut a, mut b) = (Dense::zeros(n, 3), Dense::zeros(n, 3));
        copy.apply(which, &v, &mut a);
        own.apply(which, &v, &mut b);
        close(&a.data, &b.data, "A v");
        let (mut a, mut b) = (vec![1.0; n_gamma], vec![1.0; n_gamma]);
        let v = random(n_gamma, 6);
        copy.apply_one(which, &v, &mut a);
        own.apply_one(which, &v, &mut b);
        close(&a, &b, "A v alone");
    }
    let some = [7, 0, 3, 2, 5, 4];
    close(
        &copy.s_on(&some).data,
        &own.s_on(&some).data,
        "S on some dofs",
    );
    let order: Vec<u32> = (0..n_gamma as u32).rev().collect();
    close(
        &copy.s_in_order(&order).data,
        &own.s_in_order(&order).data,
        "S in order",
    );
    if free {
        close(
            &copy.t_on(&some).data,
            &own.t_on(&some).data,
            "T on some dofs",
        );
        close(&copy.gamma().psi.data, &own.gamma().psi.data, "Ψ");
        close(&copy.sigma().data, &own.sigma().data, "Σ");
    }
    // Loads in, solutions out.
    let f = random(turned.n(), 8);
    let (a, b) = (
        ScaledSubdomain::condense_many(&[&copy], &[&f]).remove(0),
        ScaledSubdomain::condense_many(&[&own], &[&f]).remove(0),
    );
    close(&a.1, &b.1, "g");
    let u = random(n_gamma, 9);
    let a = ScaledSubdomain::recover_many(&[&copy], &[(&a.0, &u)]);
    let b = ScaledSubdomain::recover_many(&[&own], &[(&b.0, &u)]);
    close(&a[0], &b[0], "u");
}

#[test]
fn a_turned_copy_has_the_operators_of_its_own_matrix() {
    for (dim, q) in [(2, plane()), (3, Q)] {
        let sample = Sample::new(dim);
        for form in [OperatorForm::Explicit, OperatorForm::Implicit] {
            compare(dim, q, &sample, form, false);
        }
        compare(dim, q, &sample, OperatorForm::Explicit, true);
        let means = Sample {
            motions: Vec::new(),
            ..sample
        };
        compare(dim, q, &means, OperatorForm::Explicit, false);
        let without = Sample {
            averages: Vec::new(),
            ..means
        };
        compare(dim, q, &without, OperatorForm::Explicit, false);
    }
}

#[test]
fn what_a_turned_copy_holds_itself_does_not_show() {
    // Without vertices some dofs are held. Which ones differs between the frames, but not T + Ψ Σ⁺ Ψᵀ: with springs to
    // the ground at the nodes of Δ it is the inverse of S.
    for (dim, q) in [(2, plane()), (3, Q)] {
        let mut sample = Sample::new(dim);
        sample.delta.append(&mut sample.vertices);
        sample.delta.sort_unstable();
        sample.averages.clear();
        sample.motions.clear();
        compare(dim, q, &sample, OperatorForm::Explicit, false);
        let base = Arc::new(sample.local(&sample.k, OperatorForm::Explicit));
        let before = ScaledSubdomain::new(base.clone(), 1.0);
        let basis = before.gamma().basis.clone();
        let copy = ScaledSubdomain::turned(base, PHI, Turn::new(dim, q), basis);
        assert!(!copy.gamma().fixing.is_empty());
        // u = T S u + Ψ p(u), with p(u) the values of the fixing dofs.
        let u = random(copy.gamma().n_gamma(), 4);
        let mut force = vec![0.0; u.len()];
        copy.apply_one(Operator::S, &u, &mut force);
        let mut back = vec![0.0; u.len()];
        copy.apply_one(Operator::T, &force, &mut back);
        copy.gamma()
            .add_psi(&copy.gamma().primal_values(&u), &mut back);
        close(&back, &u, "u");
    }
}

//! Patch tests and orders of convergence of whole solves: plane and solid, across tied faces and faces in contact, flat
//! and distorted, for every element and cure of locking.

use crate::support::session::with_session;
use fetifeti::settings::{MethodSettings, Precision};
use fetifeti::FetiFeti;
use petsc::Session;
use scene::assembly::ErrorNorms;
use scene::Scene;

/// Error norms of the solution of a scene, against the exact solution in the scene.
pub fn errors(session: &Session, text: &str, rtol: f64) -> ErrorNorms {
    let scene = Scene::parse("scene.toml", text).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let problem = scene.substructures(&|_| true).expect("substructures");
    let settings = MethodSettings::default().rtol(rtol);
    let mut solver = FetiFeti::new(session, problem, settings).expect("set up");
    let solution = solver.solve().expect("solved");
    assert!(solution.converged(), "{}\n{text}", solution.status);
    let mut squares = [0.0; 3];
    for (sub, u) in solver.problem().local.iter().zip(&solution.u) {
        let mesh = scene.subdomain_mesh(sub.index).expect("a mesh");
        let part = scene.error_squares(&mesh, &mesh.nodal(u)).expect("exact");
        (0..3).for_each(|k| squares[k] += part[k]);
    }
    ErrorNorms::from_squares(squares)
}

const FORMS: [&str; 5] = [
    "",
    "plane = \"stress\"\n",
    "element = \"p1\"\n",
    "locking = \"selective\"\n",
    "locking = \"bbar\"\n",
];

/// Linear displacements are prescribed all round, on bodies that are distorted by a map and tied to each other.
fn tied_patch(dim: usize, form: &str, bent: bool) -> String {
    let exact = [
        ["0.1*x - 0.2*y", "0.3*x + 0.05*y", ""],
        [
            "0.1*x - 0.2*y + 0.04*z",
            "0.3*x + 0.05*y - z/7",
            "0.02*x + 0.1*y - 0.06*z",
        ],
    ][dim - 2];
    let list: Vec<String> = exact[..dim].iter().map(|e| format!("\"{e}\"")).collect();
    let list = list.join(", ");
    let sides = ["left", "right", "bottom", "top", "back", "front"];
    let held: Vec<String> = sides[..2 * dim]
        .iter()
        .map(|s| format!("{s} = [{list}]"))
        .collect();
    let shape = match (bent, dim) {
        (false, _) => "",
        (_, 2) => "shape = { x = \"x + 0.1*sin(3*y)\", y = \"y + 0.07*cos(4*x)*y\" }\n",
        _ => "shape = { x = \"x + 0.1*y*z\", y = \"y + 0.05*sin(3*x)\", z = \"z - 0.08*x*y\" }\n",
    };
    let elements = [4, 2][dim - 2];
    format!(
        "dimension = {dim}\nphysics = \"elasticity\"\n{form}exact = [{list}]\n[grid]\nbodies = 2\nsubdomains = 2\n\
         elements = {elements}\npoisson = 0.35\nyoung = 3\n{shape}dirichlet = {{ {} }}\n",
        held.join(", ")
    )
}

#[test]
fn linear_displacements_are_exact_across_ties() {
    with_session(|session| {
        for dim in [2, 3] {
            for form in FORMS {
                if dim == 3 && form.starts_with("plane") {
                    continue;
                }
                for bent in [false, true] {
                    let e = errors(session, &tied_patch(dim, form, bent), 1e-14);
                    assert!(
                        e.l2 < 1e-12 && e.energy < 1e-12,
                        "{dim}D {form} {bent}: {e:?}"
                    );
                }
            }
        }
    });
}

/// Blocks on top of each other on rollers under uniform pressure: contact without friction transmits the uniaxial
/// stress exactly.
fn pressed(dim: usize, form: &str, interface: &str) -> String {
    let (p, e, nu) = (0.3, 2.0, 0.3);
    // Plane strain has the moduli of the plane; plane stress and solids Young's own.
    let strain = dim == 2 && !form.contains("stress");
    let (along, across) = if strain {
        (-p * (1.0 - nu * nu) / e, p * nu * (1.0 + nu) / e)
    } else {
        (-p / e, p * nu / e)
    };
    let exact = [
        format!("\"{across}*x\""),
        format!("\"{along}*y\""),
        format!("\"{across}*z\""),
    ];
    let unit = ["1", "1, 1"][dim - 2];
    let body = |name: &str, y: f64, rest: &str| {
        let z = [format!("[0, {y}]"), format!("[0, {y}, 0]")];
        let back = ["", ", back = { z = 0 }"][dim - 2];
        format!(
            "[[body]]\nname = \"{name}\"\norigin = {}\nsize = [1, {unit}]\nelements = {}\nsubdomains = 2\nyoung = {e}\n\
             poisson = {nu}\ndirichlet = {{ left = {{ x = 0 }}{back}{rest}\n",
            z[dim - 2],
            [4, 2][dim - 2]
        )
    };
    format!(
        "dimension = {dim}\nphysics = \"elasticity\"\n{form}exact = [{}]\n\
         {}{}{}pressure = {{ top = {p} }}\n[interface]\ndefault = \"{interface}\"\n",
        exact[..dim].join(", "),
        body("lower", 0.0, ", bottom = { y = 0 } }"),
        body("middle", 1.0, " }"),
        body("upper", 2.0, " }"),
    )
}

#[test]
fn uniform_pressure_is_exact_across_contact() {
    with_session(|session| {
        for dim in [2, 3] {
            for form in FORMS {
                if dim == 3 && form.starts_with("plane") {
                    continue;
                }
                for interface in ["contact", "tied"] {
                    let e = errors(session, &pressed(dim, form, interface), 1e-14);
                    assert!(e.l2 < 1e-12 && e.energy < 1e-12, "{dim}D {form}: {e:?}");
                }
            }
        }
    });
}

/// u = (s, …, s) with s = ∏ sin(π x_d), and the load of this solution.
fn manufactured(dim: usize, form: &str, n: usize) -> String {
    let (nu, e) = (0.3, 1.0);
    let mu = e / (2.0 * (1.0 + nu));
    let lambda = if form.contains("stress") {
        e * nu / (1.0 - nu * nu)
    } else {
        e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu))
    };
    let axes = &["x", "y", "z"][..dim];
    let product = |cosines: &[usize]| {
        let factor = |d: usize| {
            if cosines.contains(&d) {
                format!("cos(pi*{})", axes[d])
            } else {
                format!("sin(pi*{})", axes[d])
            }
        };
        (0..dim).map(factor).collect::<Vec<_>>().join("*")
    };
    let s = product(&[]);
    let load = |i: usize| {
        let mixed: Vec<String> = (0..dim)
            .filter(|&j| j != i)
            .map(|j| product(&[i, j]))
            .collect();
        format!(
            "\"pi^2*({mu}*{dim}*{s} - ({})*({} - {s}))\"",
            lambda + mu,
            mixed.join(" + ")
        )
    };
    let loads: Vec<String> = (0..dim)
        .map(|i| format!("{} = {}", axes[i], load(i)))
        .collect();
    let exact = vec![format!("\"{s}\""); dim].join(", ");
    format!(
        "dimension = {dim}\nphysics = \"elasticity\"\n{form}exact = [{exact}]\n\
         [grid]\nbodies = 2\nsubdomains = 2\nelements = {n}\n\
         poisson = {nu}\nload = {{ {}, quadrature = \"gauss\" }}\ndirichlet = \"all\"\n",
        loads.join(", ")
    )
}

#[test]
fn errors_fall_with_the_orders_of_theory() {
    with_session(|session| {
        for dim in [2, 3] {
            for form in FORMS {
                if dim == 3 && form.starts_with("plane") {
                    continue;
                }
                let n = [8, 4][dim - 2];
                let coarse = errors(session, &manufactured(dim, form, n), 1e-10);
                let fine = errors(session, &manufactured(dim, form, 2 * n), 1e-10);
                let order = |a: f64, b: f64| (a / b).log2();
                let (l2, energy) = (order(coarse.l2, fine.l2), order(coarse.energy, fine.energy));
                println!("{dim}D {form:?}: orders {l2:.3} in L2, {energy:.3} in energy");
                let slack = if form.contains("p1") { 0.15 } else { 0.06 };
                assert!((l2 - 2.0).abs() < slack, "{dim}D {form}: {l2}");
                assert!((energy - 1.0).abs() < slack, "{dim}D {form}: {energy}");
            }
        }
    });
}

#[test]
fn a_scalar_in_space_converges_too() {
    with_session(|session| {
        let text = |n: usize| {
            let s = "sin(pi*x)*sin(pi*y)*sin(pi*z)";
            format!(
                "dimension = 3\nexact = \"{s}\"\n[grid]\nbodies = 2\nsubdomains = 2\nelements = {n}\n\
                 dirichlet = \"all\"\nload = {{ value = \"3*pi^2*{s}\", quadrature = \"gauss\" }}\n"
            )
        };
        let [coarse, fine] = [4, 8].map(|n| errors(session, &text(n), 1e-10));
        let order = |a: f64, b: f64| (a / b).log2();
        assert!((order(coarse.l2, fine.l2) - 2.0).abs() < 0.06);
        assert!((order(coarse.energy, fine.energy) - 1.0).abs() < 0.06);
    });
}

#[test]
fn a_preconditioner_in_single_precision_changes_no_answer() {
    with_session(|session| {
        let solve = |precision: Precision| {
            let scene = Scene::parse("scene.toml", &manufactured(3, "", 4)).expect("a scene");
            let settings = MethodSettings::default().rtol(1e-12).precision(precision);
            let problem = scene.substructures(&|_| true).expect("substructures");
            let mut solver = FetiFeti::new(session, problem, settings).expect("set up");
            let solution = solver.solve().expect("solved");
            assert!(solution.converged());
            (solution.u.concat(), solution.iterations)
        };
        let (double, its) = solve(Precision::Double);
        let (mixed, its_mixed) = solve(Precision::Mixed);
        let largest = double.iter().fold(0.0f64, |a, v| a.max(v.abs()));
        let far = double.iter().zip(&mixed).map(|(a, b)| (a - b).abs());
        let far = far.fold(0.0, f64::max);
        // The last bits differ: single precision is really used.
        assert!(far > 0.0 && far < 1e-10 * largest, "{far:.1e}");
        // At most one more step of refinement.
        assert!(its_mixed <= its + 6, "{its} and {its_mixed}");
    });
}

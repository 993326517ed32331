//! Poisson's equation on 2 × 2 bodies of 4 × 4 subdomains: spectrum, solution, error.
//!
//!     cargo run --release --example poisson_2x2
//!     mpirun -n 2 target/release/examples/poisson_2x2 -fetifeti_ksp_monitor
//!
//! −Δu = 2π² sin πx sin πy on the unit square, u = 0 on its boundary; u = sin πx sin πy.

use std::f64::consts::PI;
use std::process::ExitCode;

use fetifeti::settings::MethodSettings;
use fetifeti::{max_all, sum_all, Error, FetiFeti, Result, Session};
use fetifeti_scene::assembly::ErrorNorms;
use fetifeti_scene::elements::q1::Quadrature;
use fetifeti_scene::{Expr, Field, GridSpec, Load, Scene, SceneSpec};

/// Elements along the unit square.
const N: usize = 64;

fn main() -> ExitCode {
    fetifeti::run(run)
}

fn run(session: &Session) -> Result<()> {
    // A scene may come from a file (Scene::load), from text (Scene::parse) or, as here, from a program.
    let expression = |text: &str| Expr::parse(text).map_err(Error::input);
    let mut grid = GridSpec::unit_square([2, 2], [4, 4], [N / 2, N / 2]);
    grid.whole.load = Load {
        fields: vec![Field::Expression(expression("2*pi^2*sin(pi*x)*sin(pi*y)")?)],
        quadrature: Quadrature::Gauss,
    };
    let mut spec = SceneSpec::tied("Poisson on 2 x 2 bodies", grid.expand());
    spec.exact = Some(vec![expression("sin(pi*x)*sin(pi*y)")?]);
    let scene = Scene::new(spec)?;

    // Each rank assembles its own subdomains; any distribution is possible.
    let mine = fetifeti::share(session, scene.n_subdomains());
    let problem = scene.substructures(&|s| mine.contains(&s))?;

    // A tight tolerance, because the result is compared with the discrete solution below. PETSc options override it.
    let settings = MethodSettings::default().rtol(1e-12);
    let mut solver = FetiFeti::new(session, problem, settings)?;
    let spectrum = solver.spectrum()?.expect("tied bodies have multipliers");
    let solution = solver.solve()?;
    assert!(solution.converged(), "{}", solution.status);

    // Bilinear elements on a uniform grid have sin πx sin πy as an eigenvector: the discrete solution is a known
    // multiple of it, so that every nodal value can be checked to rounding and not only to the discretisation error.
    let factor = discrete_amplitude();
    let mut worst = [0.0f64];
    let mut squares = [0.0; 3];
    for (sub, u) in solver.problem().local.iter().zip(&solution.u) {
        let mesh = scene.subdomain_mesh(sub.index)?;
        let nodal = mesh.nodal(u);
        for (value, [x, y, _]) in nodal.iter().zip(&mesh.points) {
            let expected = factor * (PI * x).sin() * (PI * y).sin();
            worst[0] = worst[0].max((value - expected).abs());
        }
        let part = scene.error_squares(&mesh, &nodal);
        let part = part.expect("the scene has an exact solution");
        squares.iter_mut().zip(part).for_each(|(s, p)| *s += p);
    }
    max_all(session.comm(), &mut worst);
    sum_all(session.comm(), &mut squares);
    let error = ErrorNorms::from_squares(squares);

    if session.rank() == 0 {
        let facts = solver.facts();
        let (inside, between) = (facts.multipliers_local, facts.multipliers_global);
        println!("multipliers   {inside} inside bodies, {between} between them");
        println!(
            "spectrum      {:.6} to {:.6}, kappa {:.4}",
            spectrum.lambda_min,
            spectrum.lambda_max,
            spectrum.kappa()
        );
        println!("iterations    {}", solution.iterations);
        println!("error in L2   {:.3e}", error.l2);
        println!(
            "against the discrete solution, largest nodal difference {:.1e}",
            worst[0]
        );
    }
    assert!(worst[0] < 1e-9, "not the discrete solution");
    assert!(error.l2 < 1.0 / (N * N) as f64, "the error is not O(h²)");
    assert!(spectrum.lambda_min > 1.0 - 1e-8, "theory says λ_min ≥ 1");
    Ok(())
}

/// c in u_h = c sin πx sin πy: the load's factor over the eigenvalue of the stiffness matrix. Both are tensor products
/// of 1D rules, for s_j = sin πjh has s_{j−1} + s_{j+1} = 2 cos(πh) s_j.
fn discrete_amplitude() -> f64 {
    let h = 1.0 / N as f64;
    let stiffness = 2.0 * (1.0 - (PI * h).cos()) / h;
    let mass = h * (2.0 + (PI * h).cos()) / 3.0;
    // Two Gauss points in each of the two elements beside a node, at the distances d.
    let gauss = [1.0 - 1.0 / 3f64.sqrt(), 1.0 + 1.0 / 3f64.sqrt()];
    let load: f64 = gauss
        .iter()
        .map(|g| {
            let d = 0.5 * h * g;
            h * (1.0 - d / h) * (PI * d).cos()
        })
        .sum();
    2.0 * PI * PI * load * load / (2.0 * stiffness * mass)
}

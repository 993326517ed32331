//! FETI-DP: one body of 4 × 4 subdomains with a coefficient that jumps by 10⁶.
//!
//!     cargo run --release --example feti_dp
//!     mpirun -n 2 target/release/examples/feti_dp -fetifeti_ksp_view
//!
//! −∇·(ρ∇u) = 0 on the unit square, u = 0 at the left, u = 1 at the right, natural conditions at top and bottom. ρ is
//! constant in the four columns of subdomains, which are resistors in series: u is piecewise linear with the slope q/ρ.
//! FETI-DP needs no special setting: with one body there are no multipliers between bodies.

use std::process::ExitCode;

use fetifeti::settings::MethodSettings;
use fetifeti::{max_all, FetiFeti, Result, Session};
use fetifeti_scene::mesh::BoxMesh;
use fetifeti_scene::{BodySpec, By, Field, Scene, SceneSpec};

/// ρ of each column.
const RHO: [f64; 4] = [1.0, 1e3, 1e-3, 1.0];

fn main() -> ExitCode {
    fetifeti::run(run)
}

fn run(session: &Session) -> Result<()> {
    let mesh = BoxMesh::plane([0.0, 0.0], [1.0, 1.0], [32, 32], [4, 4]);
    let mut body = BodySpec::new("plate", mesh);
    // One row of values for each row of subdomains.
    body.rho = Field::Table {
        layers: vec![vec![RHO.to_vec(); 4]],
        by: By::Subdomain,
    };
    body.dirichlet[0][0] = Some(Field::constant(0.0));
    body.dirichlet[1][0] = Some(Field::constant(1.0));
    let scene = Scene::new(SceneSpec::tied("FETI-DP", vec![body]))?;

    let mine = fetifeti::share(session, scene.n_subdomains());
    let problem = scene.substructures(&|s| mine.contains(&s))?;
    let settings = MethodSettings::default().rtol(1e-12);
    let mut solver = FetiFeti::new(session, problem, settings)?;
    let spectrum = solver.spectrum()?.expect("subdomains have multipliers");
    let solution = solver.solve()?;
    assert!(solution.converged(), "{}", solution.status);

    let mut worst = [0.0f64];
    for (sub, u) in solver.problem().local.iter().zip(&solution.u) {
        let mesh = scene.subdomain_mesh(sub.index)?;
        for (value, [x, ..]) in mesh.nodal(u).iter().zip(&mesh.points) {
            worst[0] = worst[0].max((value - potential(*x)).abs());
        }
    }
    max_all(session.comm(), &mut worst);

    let facts = solver.facts();
    if session.rank() == 0 {
        println!(
            "multipliers   {} inside the body, {} between bodies",
            facts.multipliers_local, facts.multipliers_global
        );
        println!("primal        {} vertices", facts.primal);
        println!("kappa         {:.4}", spectrum.kappa());
        println!("iterations    {}", solution.iterations);
        println!(
            "largest nodal difference to resistors in series: {:.1e}",
            worst[0]
        );
    }
    assert_eq!(facts.multipliers_global, 0);
    assert!(worst[0] < 1e-9, "not the solution");
    // With ρ-scaling the condition number does not depend on jumps between subdomains.
    assert!(spectrum.kappa() < 5.0, "kappa {}", spectrum.kappa());
    Ok(())
}

/// u(x) of four resistors in series under one volt.
fn potential(x: f64) -> f64 {
    let flux = 1.0 / RHO.iter().map(|r| 0.25 / r).sum::<f64>();
    let share = |k: usize| (x - 0.25 * k as f64).clamp(0.0, 0.25);
    (0..4).map(|k| flux * share(k) / RHO[k]).sum()
}

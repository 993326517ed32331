//! One-level FETI: every body is one subdomain, most bodies float.
//!
//!     cargo run --release --example feti1
//!     mpirun -n 2 target/release/examples/feti1 -fetifeti_check
//!
//! −Δu = 1 on the unit square, u = 0 at its left and right end, natural conditions at top and bottom; u = x(1 − x)/2.
//! FETI needs no special setting: without subdomains there is no jump inside a body and no primal vertex.

use std::process::ExitCode;

use fetifeti::settings::MethodSettings;
use fetifeti::{max_all, FetiFeti, Result, Session};
use fetifeti_scene::{free_all_round, Field, GridSpec, Scene};

fn main() -> ExitCode {
    fetifeti::run(run)
}

fn run(session: &Session) -> Result<()> {
    let mut grid = GridSpec::unit_square([4, 4], [1, 1], [8, 8]);
    grid.whole.dirichlet = free_all_round();
    for side in [0, 1] {
        grid.whole.dirichlet[side][0] = Some(Field::constant(0.0)); // left and right, the only component
    }
    let scene = Scene::grid("One-level FETI", &grid)?;
    let mine = fetifeti::share(session, scene.n_subdomains());
    let problem = scene.substructures(&|s| mine.contains(&s))?;
    let settings = MethodSettings::default().rtol(1e-12);
    let mut solver = FetiFeti::new(session, problem, settings)?;
    let solution = solver.solve()?;
    assert!(solution.converged(), "{}", solution.status);

    // The solution does not depend on y, and linear elements in one dimension are exact at the nodes.
    let mut worst = [0.0f64];
    for (sub, u) in solver.problem().local.iter().zip(&solution.u) {
        let mesh = scene.subdomain_mesh(sub.index)?;
        for (value, [x, ..]) in mesh.nodal(u).iter().zip(&mesh.points) {
            worst[0] = worst[0].max((value - 0.5 * x * (1.0 - x)).abs());
        }
    }
    max_all(session.comm(), &mut worst);

    let facts = solver.facts();
    if session.rank() == 0 {
        println!(
            "bodies        {}, {} of them floating",
            scene.n_bodies(),
            facts.floating_bodies
        );
        println!(
            "multipliers   {} inside bodies, {} between them",
            facts.multipliers_local, facts.multipliers_global
        );
        println!("iterations    {}", solution.iterations);
        println!("largest nodal difference to x(1 - x)/2: {:.1e}", worst[0]);
    }
    // The two middle columns of bodies touch no held side; the solver has detected this from the matrices.
    assert_eq!(facts.floating_bodies, 8);
    assert_eq!(facts.multipliers_local, 0);
    assert!(worst[0] < 1e-9, "not the solution");
    Ok(())
}

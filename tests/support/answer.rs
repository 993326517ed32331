//! A scene in the plane or in space, solved: its energy and the displacements of its nodes.

use super::session::with_session;
use fetifeti::settings::MethodSettings;
use fetifeti::FetiFeti;
use scene::Scene;

/// The energy, the kinds of subdomains that differ, and (place, component, displacement) of all nodes.
pub struct Answer {
    pub energy: f64,
    pub kinds: usize,
    pub nodes: Vec<([f64; 3], usize, f64)>,
}

/// The answer at the last load step.
pub fn solve(text: &str) -> Answer {
    let scene = Scene::parse("scene.toml", text).expect("a good scene");
    with_session(move |session| {
        let problem = scene.substructures(&|_| true).expect("substructures");
        let settings = MethodSettings::default().rtol(1e-12);
        let mut solver = FetiFeti::new(session, problem, settings).expect("set up");
        let solution = solver.solve().expect("solved");
        assert!(solution.converged(), "{}", solution.status);
        let mut nodes = Vec::new();
        for (s, u) in solution.u.iter().enumerate() {
            let mesh = scene.subdomain_mesh(s).expect("a mesh");
            let c = mesh.components();
            for (k, value) in mesh.nodal(u).into_iter().enumerate() {
                nodes.push((mesh.points[k / c], k % c, value));
            }
        }
        Answer {
            energy: solution.energy,
            kinds: solver.facts().kinds,
            nodes,
        }
    })
}

//! Walls of scalar bodies in contact.

use crate::support::rng::Rng;

/// `n` × `n` bodies, ρ = 1 and `jump` by body, a random load, and random gaps at most interfaces.
pub fn wall(rng: &mut Rng, n: usize, jump: f64) -> String {
    let load = format!(
        "{}*({:.3} + cos({:.3}*x + {:.3})*sin({:.3}*y + {:.3}*bi))",
        [1, 2, 5, 10][rng.below(4)],
        rng.uniform(-0.5, 0.8),
        rng.uniform(0.5, 3.0),
        rng.uniform(0.0, 6.0),
        rng.uniform(0.5, 3.0),
        rng.uniform(0.0, 6.0),
    );
    let mut text = format!(
        "title = \"wall\"\n[grid]\nbodies = [{n}, {n}]\nsize = [{n}, {n}]\nsubdomains = 2\nelements = 4\n\
         rho = {{ checkerboard = [1, {jump:e}], by = \"body\" }}\nload = \"{load}\"\n\
         dirichlet = {{ bottom = 0, right = 0 }}\n[interface]\ndefault = \"contact\"\n"
    );
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
        for (k, l) in [(i + 1, j), (i, j + 1)] {
            if k < n && l < n && !rng.one_in(5) {
                let gap = rng.uniform(0.08, 0.3);
                text += &format!(
                    "[[contact]]\nbodies = [\"b{i}_{j}\", \"b{k}_{l}\"]\ngap = {gap:.4}\n"
                );
            }
        }
    }
    text
}

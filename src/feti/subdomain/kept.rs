//! Subdomains that stay factored while the rows between bodies are replaced.

use super::scaled::Scaled;
use crate::feti::interface::entities::Average;
use crate::feti::jump::operator::Jump;

/// The subdomains of a set-up, each with the interface that it was factored for.
pub(crate) struct Kept {
    interfaces: Vec<Interface>,
    locals: Vec<Scaled>,
}

/// What the operators of a subdomain depend on beside its matrix.
#[derive(PartialEq)]
struct Interface {
    delta: Vec<u32>,
    primal: Vec<u32>,
    averages: Vec<Average>,
}

impl Interface {
    fn of(jump: &Jump, j: usize) -> Interface {
        Interface {
            delta: jump.delta[j].clone(),
            primal: jump.primal[j].clone(),
            averages: jump.averages[j].clone(),
        }
    }
}

impl Kept {
    /// The subdomains `locals` of a set-up with these rows.
    pub fn new(jump: &Jump, locals: &[Scaled]) -> Kept {
        let each = 0..locals.len();
        Kept {
            interfaces: each.map(|j| Interface::of(jump, j)).collect(),
            locals: locals.to_vec(),
        }
    }

    /// The subdomains whose interface is still the same with other rows.
    pub fn still(&self, jump: &Jump) -> Vec<Option<Scaled>> {
        let both = self.interfaces.iter().zip(&self.locals);
        let same = both.enumerate().map(|(j, (interface, local))| {
            (*interface == Interface::of(jump, j)).then(|| local.clone())
        });
        same.collect()
    }
}

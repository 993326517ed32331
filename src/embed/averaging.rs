//! The primal constraints where the user leaves them open.
//!
//! In the plane, edges of elastic bodies are averaged with all three motions: one constraint more for each edge, which
//! costs nothing beside the iterations that it saves. In space, faces are averaged with all six motions in place of the
//! components of edges, if what the larger primal problem costs is less than the iterations that are saved. Parts of
//! a mesh have short and bent edges that hardly hold their faces: κ is half or less there. In the boxes of a grid it is
//! a little less.

use super::classes::InterfaceClass;
use crate::feti::cost::choice;
use crate::feti::cost::forms::{DENSE, FLOP};
use crate::feti::settings::{Averages, MethodSettings, Primal};
use crate::substructures::EntityKind;
use crate::Result;
use parallel::exchange::{highest, sum_all};
use petsc::{Options, Session};

/// Iterations that motions of faces save in space. Measured are 9 in parts of meshes and 1 to 4 in boxes, to a relative
/// residual of 1e-8.
const SAVED: f64 = 6.0;

/// Multiplications to factor the primal problem in space, in units of the square of its size.
const FACTOR: f64 = 20.0;

/// The primal constraints for these classes of this rank's subdomains, of which `first` is the first. `n_motions`: of
/// the subdomain of this rank that has most. Collective.
///
/// # Errors
/// PETSc's own.
pub fn constraints(
    session: &Session,
    asked: &MethodSettings,
    (space, components, n_motions): (bool, usize, usize),
    first: usize,
    classes: &[Vec<InterfaceClass>],
) -> Result<Primal> {
    let primal = choice::constraints(asked);
    let n_motions = highest(session.comm(), n_motions as f64);
    let said = Options::new(session, &asked.prefix).has("primal")?;
    let closed = asked.averages.is_some() || said || asked.primal != Primal::default();
    if closed || n_motions <= components as f64 {
        return Ok(primal);
    }
    if !space {
        return Ok(Primal {
            averages: Averages::Motions,
            ..primal
        });
    }
    // Vertices, edges and faces by component, each in its lowest subdomain, and the squares of interfaces.
    let mut sums = [0.0; 4];
    for (s, list) in (first as u32..).zip(classes) {
        for class in list.iter().filter(|c| c.sharers[0] == s) {
            let at = match class.kind(space) {
                _ if class.is_vertex() => 0,
                EntityKind::Edge => 1,
                EntityKind::Face => 2,
            };
            sums[at] += 1.0;
        }
        let interface: usize = list.iter().map(|c| c.dofs.len()).sum();
        sums[3] += (interface as f64).powi(2);
    }
    sum_all(session.comm(), &mut sums);
    let [vertices, edges, faces, squares] = sums;
    let motions = vertices + faces * n_motions / components as f64;
    let more = motions.powi(2) - (vertices + edges).powi(2);
    let costs = FLOP * FACTOR * more;
    let saves = SAVED * 2.0 * DENSE * squares / session.size() as f64;
    Ok(match costs < saves {
        true => Primal {
            edges: false,
            faces: true,
            averages: Averages::Motions,
            ..primal
        },
        false => primal,
    })
}

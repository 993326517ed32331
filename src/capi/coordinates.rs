//! Rigid body motions from the places of the nodes.

use crate::Result;
use base::Fault;
use petsc::Vec as PetscVec;

/// Positions of nodes.
pub struct Coordinates {
    /// 1, 2 or 3.
    pub dim: usize,
    /// Coordinates of the nodes that this rank owns, node by node.
    pub of_node: Vec<f64>,
}

/// Translations and rotations if there are as many components as dimensions; otherwise one constant per component.
pub fn rigid(layout: &PetscVec, bs: usize, c: &Coordinates) -> Result<Vec<PetscVec>> {
    let nodes = layout.local_len() / bs;
    if c.of_node.len() != nodes * c.dim {
        return Err(Fault::Sizes.error(format!(
            "{} coordinates were given for {nodes} nodes in {} dimensions, expected {}",
            c.of_node.len(),
            c.dim,
            nodes * c.dim
        )));
    }
    let pairs: &[(usize, usize)] = match (bs == c.dim, bs) {
        (true, 2) => &[(0, 1)],
        (true, 3) => &[(0, 1), (1, 2), (2, 0)],
        _ => &[],
    };
    let mut modes = Vec::new();
    for k in 0..bs + pairs.len() {
        let mode = layout.duplicate()?;
        mode.set(0.0)?;
        {
            let mut entries = mode.array_mut()?;
            for node in 0..nodes {
                if k < bs {
                    entries[node * bs + k] = 1.0;
                } else {
                    let (a, b) = pairs[k - bs];
                    entries[node * bs + a] = -c.of_node[node * c.dim + b];
                    entries[node * bs + b] = c.of_node[node * c.dim + a];
                }
            }
        }
        modes.push(mode);
    }
    Ok(modes)
}

//! Tangential rows beside the normal ones that the host gives: they are made here, and their results become vectors at
//! the normal rows.

use super::laws::ContactLaw;
use crate::embed::{GivenResults, GivenRow, GivenRows};
use crate::substructures::{FrictionNode, Law};
use crate::Result;
use base::linalg::vec3::{dot, tangents, unit};
use base::Fault;
use parallel::exchange::sum_all;
use petsc::{PetscInt, Session};

/// A FetiFetiRowState of the C interface.
pub type RowState = PetscInt;

/// The row does not hold: the sides are apart.
pub const OPEN: RowState = 0;
/// An equation, or contact without friction.
pub const HOLDS: RowState = 1;
const STICKS: RowState = 2;
const SLIPS: RowState = 3;

/// Components of a row's coefficients that are off its direction by more than this part make it no row of one
/// direction.
const ALONG: f64 = 1e-8;

/// A direction along which the sides may slide, and the terms of its row.
pub struct Tangent {
    pub direction: [f64; 3],
    pub terms: Vec<(u32, f64)>,
}

/// Friction at a normal row.
pub struct NodeFriction {
    /// The place of the normal row among those given.
    pub normal: usize,
    pub tangents: Vec<Tangent>,
    /// Where the sides stand without a slip.
    pub slipped: [f64; 3],
    pub law: ContactLaw,
    pub area: f64,
}

/// A tangential row of the present solver.
pub struct TangentialRow {
    /// The place of its normal row among those given.
    pub normal: usize,
    direction: [f64; 3],
    compliance: f64,
}

/// The result of a row in contact, with vectors in the components of its nodes.
#[derive(Debug, Clone, Copy, Default)]
pub struct ContactResult {
    /// The force of friction.
    pub force: [f64; 3],
    /// The slip since the beginning of the load step, without its elastic part.
    pub slip: [f64; 3],
    pub state: RowState,
}

/// The nodes with friction of all ranks after a solve.
#[derive(Debug, Clone, Copy, Default)]
pub struct FrictionCounts {
    nodes: usize,
    sticking: usize,
    slipping: usize,
}

impl FrictionCounts {
    /// The counts of the results at all rows that ranks give. Collective.
    pub fn of(session: &Session, rows: &[TangentialRow], results: &[ContactResult]) -> Self {
        let mut normals: Vec<usize> = rows.iter().map(|row| row.normal).collect();
        normals.dedup();
        let of = |state: RowState| results.iter().filter(|r| r.state == state).count();
        let mut counts = [normals.len(), of(STICKS), of(SLIPS)].map(|n| n as f64);
        sum_all(session.comm(), &mut counts);
        let [nodes, sticking, slipping] = counts.map(|n| n as usize);
        FrictionCounts {
            nodes,
            sticking,
            slipping,
        }
    }

    /// The line of FetiFetiView; none without friction.
    pub fn line(&self) -> Option<String> {
        let FrictionCounts {
            nodes,
            sticking,
            slipping,
        } = self;
        let line =
            format!("  friction: {nodes} nodes, of which {sticking} stick and {slipping} slip\n");
        (*nodes > 0).then_some(line)
    }
}

/// Appends the tangential rows of nodes with friction to the normal ones.
pub fn appended(
    rows: Vec<GivenRow>,
    friction: Vec<NodeFriction>,
) -> (GivenRows, Vec<TangentialRow>) {
    let mut made = Vec::new();
    let mut out = GivenRows {
        rows,
        friction: Vec::new(),
    };
    for node in friction {
        let bound = node.law.bound(node.area);
        let Some(bound) = bound.filter(|_| !node.tangents.is_empty()) else {
            continue;
        };
        let first = out.rows.len();
        let compliance = node.law.stick_compliance(node.area);
        for Tangent { direction, terms } in node.tangents {
            out.rows.push(GivenRow {
                terms,
                gap: dot(direction, node.slipped),
                law: Law::Friction,
                compliance,
            });
            made.push(TangentialRow {
                normal: node.normal,
                direction,
                compliance,
            });
        }
        let tangential = (first..out.rows.len()).collect();
        let new = FrictionNode::new(node.normal, tangential, bound);
        out.friction.push(new);
    }
    (out, made)
}

/// The tangents of a normal row Σ w_k n · u_k at nodes of `components` consecutive unknowns. n points to where the
/// coefficients of its first node do.
///
/// # Errors
/// Nodes of scalars; coefficients of different directions.
pub fn beside(
    terms: &[(u32, f64)],
    components: usize,
    whose: &dyn Fn() -> String,
) -> Result<Vec<Tangent>> {
    if !(2..=3).contains(&components) {
        return Err(Fault::Wrong.error(format!(
            "{} has friction at nodes of {components} unknowns, expected 2 or 3, the block size of displacements",
            whose()
        )));
    }
    let mut nodes: Vec<(u32, [f64; 3])> = Vec::new();
    for &(dof, c) in terms {
        let node = dof / components as u32;
        let known = nodes.iter().position(|n| n.0 == node);
        let place = known.unwrap_or_else(|| {
            nodes.push((node, [0.0; 3]));
            nodes.len() - 1
        });
        nodes[place].1[dof as usize % components] += c;
    }
    let normal = nodes.iter().find_map(|n| unit(n.1)).unwrap_or_default();
    let mut weights = Vec::with_capacity(nodes.len());
    for (node, c) in nodes {
        let weight = dot(c, normal);
        let off = (0..3).map(|k| (c[k] - weight * normal[k]).abs());
        if off.fold(0.0, f64::max) > ALONG * weight.abs() {
            return Err(Fault::Wrong.error(format!(
                "{} has friction and coefficients of different directions at its nodes, expected one normal",
                whose()
            )));
        }
        weights.push((node, weight));
    }
    let terms = |direction: [f64; 3]| {
        let mut terms = Vec::new();
        for &(node, weight) in &weights {
            for (c, t) in direction.into_iter().enumerate().filter(|(_, t)| *t != 0.0) {
                terms.push((node * components as u32 + c as u32, weight * t));
            }
        }
        terms
    };
    let directions = tangents(normal, components).into_iter();
    let tangent = |direction| Tangent {
        terms: terms(direction),
        direction,
    };
    Ok(directions.map(tangent).collect())
}

/// The right-hand sides of tangential rows, where the sides of a normal row stand at `slipped` without a slip.
pub fn gaps<'a>(
    rows: &'a [TangentialRow],
    slipped: impl Fn(usize) -> [f64; 3] + 'a,
) -> impl Iterator<Item = f64> + 'a {
    rows.iter()
        .map(move |row| dot(row.direction, slipped(row.normal)))
}

/// The results at the rows given, of which the last ones are these tangential ones.
pub fn results(rows: &[TangentialRow], given: &GivenResults) -> Vec<ContactResult> {
    let normals = given.multipliers.len() - rows.len();
    let state = |holds: &bool| if *holds { HOLDS } else { OPEN };
    let states = given.holds[..normals].iter().map(state);
    let mut out: Vec<ContactResult> = states
        .map(|state| ContactResult {
            state,
            ..ContactResult::default()
        })
        .collect();
    for (row, k) in rows.iter().zip(normals..) {
        let at = &mut out[row.normal];
        let force = given.multipliers[k];
        let slip = -given.gaps[k] - row.compliance * force;
        for c in 0..3 {
            at.force[c] += force * row.direction[c];
            at.slip[c] += slip * row.direction[c];
        }
        if given.holds[k] {
            at.state = STICKS;
        } else if force != 0.0 {
            at.state = SLIPS;
        }
    }
    out
}

#[cfg(test)]
#[path = "../../tests/inside/capi/tangential.rs"]
mod tests;

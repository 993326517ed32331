//! Axisymmetric bodies: they lie to the right of the axis x = 0, and their nodes on it stay there.

use super::body::{bounds_of, Body};
use super::model::body::BodySpec;
use base::Result;
use elements::form::Form;
use mesh::Mesh;

/// A node belongs to the axis if its distance is below this part of the largest radius.
const ON_AXIS: f64 = 1e-9;

/// Checks where a body lies, and prescribes u_r = 0 at its nodes on the axis: u_r/r is a strain. Does nothing in other
/// forms.
///
/// # Errors
/// [`ErrorKind::Input`](base::ErrorKind::Input) for a node to the left of the axis, and for solids and boxes with cells
/// of their own.
pub(super) fn constrain_axis(body: &mut BodySpec, form: &Form) -> Result<()> {
    if !form.is_axial() {
        return Ok(());
    }
    let error = |message: String| body.error(message);
    if body.mesh.dim() != 2 {
        return error("a solid, where a plane section of an axisymmetric body was expected".into());
    }
    let Mesh::Cells(_) = body.mesh else {
        return error(
            "a box of first order in an axisymmetric scene (`order = 2` or a mesh was expected)"
                .into(),
        );
    };
    let [_, high] = bounds_of(body);
    let near = ON_AXIS * high[0].abs();
    let mut on_axis = Vec::new();
    for node in 0..body.mesh.n_nodes() {
        let x = body.position(node)[0];
        if x < -near {
            return error(format!(
                "a node at {}, left of the axis x = 0 (radii of at least 0 were expected)",
                body.spot(node)
            ));
        }
        if x <= near {
            on_axis.push((2 * node, 0.0));
        }
    }
    if !on_axis.is_empty() {
        body.given.extend(on_axis);
    }
    Ok(())
}

/// Whether a node of a side has no area because it lies on the axis, as ends of edges of second order do: the integral
/// of its function around the axis is 0.
pub(super) fn has_no_area(body: &Body, form: &Form, side: usize, node: usize) -> bool {
    let near = ON_AXIS * body.bounds[1][0].abs();
    if !form.is_axial() || body.spec.position(node)[0] > near {
        return false;
    }
    let faces = body.spec.faces(side);
    let areas = faces.filter_map(|face| {
        let place = face.nodes.iter().position(|&n| n == node)?;
        Some(body.spec.face_areas(side, &face, form)[place])
    });
    areas.sum::<f64>() == 0.0
}

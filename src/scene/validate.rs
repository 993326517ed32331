//! Checks of a scene that look at one body at a time.

use super::field::{At, Field};
use super::spec::{BodySpec, SceneSpec, SIDES};
use super::{Body, Variables};
use crate::error::{Error, Result};
use crate::mesh::BoxMesh;
use std::collections::HashMap;

/// Largest number of bodies: a scene keeps a record for each of them.
pub(super) const MOST_BODIES: usize = 1 << 18;

/// Largest number of subdomains.
const MOST_SUBDOMAINS: usize = 1 << 24;

/// Checks names, sizes, counts and written values.
pub(super) fn check(spec: &SceneSpec) -> Result<()> {
    if spec.bodies.is_empty() {
        return Err(Error::input("the scene has no bodies"));
    }
    if spec.bodies.len() > MOST_BODIES {
        return Err(Error::Input(format!(
            "the scene has {} bodies where at most {MOST_BODIES} were expected",
            spec.bodies.len()
        )));
    }
    let mut names: HashMap<&str, &BodySpec> = HashMap::with_capacity(spec.bodies.len());
    let mut subdomains = 0;
    for body in &spec.bodies {
        check_mesh(body)?;
        check_values(body)?;
        if names.insert(&body.name, body).is_some() {
            return fail(body, "a second body of this name (names must be unique)");
        }
        subdomains += body.mesh.n_subdomains();
        if subdomains > MOST_SUBDOMAINS {
            return fail(
                body,
                format_args!("the scene has more than {MOST_SUBDOMAINS} subdomains with this body"),
            );
        }
    }
    Ok(())
}

fn fail<T>(body: &BodySpec, message: impl std::fmt::Display) -> Result<T> {
    Err(Error::Input(format!(
        "{}body `{}`: {message}",
        body.written, body.name
    )))
}

fn check_mesh(body: &BodySpec) -> Result<()> {
    let BoxMesh {
        origin,
        size,
        elements,
        subdomains,
    } = body.mesh;
    for d in 0..2 {
        let axis = ["x", "y"][d];
        if !origin[d].is_finite() {
            return fail(
                body,
                format_args!(
                    "origin {} in {axis} where a finite number was expected",
                    origin[d]
                ),
            );
        }
        if !(size[d].is_finite() && size[d] > 0.0) {
            return fail(
                body,
                format_args!(
                    "size {} in {axis} where a positive number was expected",
                    size[d]
                ),
            );
        }
        if elements[d] == 0 || subdomains[d] == 0 {
            let what = if elements[d] == 0 {
                "elements"
            } else {
                "subdomains"
            };
            return fail(
                body,
                format_args!("zero {what} in {axis} where at least one was expected"),
            );
        }
        if elements[d] % subdomains[d] != 0 {
            return fail(
                body,
                format_args!(
                    "{} subdomains in {axis} do not divide {} elements (a multiple was expected)",
                    subdomains[d], elements[d]
                ),
            );
        }
        let step = size[d] / elements[d] as f64;
        let far = origin[d].abs().max((origin[d] + size[d]).abs());
        if step < 1e-8 * far {
            return fail(
                body,
                format_args!("elements of size {step} in {axis} cannot be told apart at {far}"),
            );
        }
    }
    let block = body.mesh.block_elements();
    if (block[0] + 1).saturating_mul(block[1] + 1) >= u32::MAX as usize {
        return fail(
            body,
            format_args!(
                "a subdomain of {} × {} elements is too large (more subdomains were expected)",
                block[0], block[1]
            ),
        );
    }
    Ok(())
}

/// Values that are written down are checked here, values that have to be computed are checked when they are.
fn check_values(body: &BodySpec) -> Result<()> {
    for value in body.rho.known_values() {
        if !is_coefficient(value) {
            return fail(
                body,
                format_args!("ρ = {value} where a positive number was expected"),
            );
        }
    }
    for value in body.load.field.known_values() {
        if !value.is_finite() {
            return fail(
                body,
                format_args!("load {value} where a finite number was expected"),
            );
        }
    }
    Ok(())
}

fn is_coefficient(value: f64) -> bool {
    value.is_finite() && value > 0.0
}

/// ρ in an element with midpoint `point`, checked.
pub(super) fn checked_rho(body: &BodySpec, value: f64, point: [f64; 2]) -> Result<f64> {
    if is_coefficient(value) {
        Ok(value)
    } else {
        let [x, y] = point;
        fail(
            body,
            format_args!("ρ = {value} at ({x}, {y}) where a positive number was expected"),
        )
    }
}

/// An error for a load that is not finite.
pub(super) fn bad_load<T>(body: &BodySpec, value: f64, [x, y]: [f64; 2]) -> Result<T> {
    fail(
        body,
        format_args!("load {value} at ({x}, {y}) where a finite number was expected"),
    )
}

/// The nodes on Dirichlet sides with their values, in increasing order.
///
/// Two sides must agree at their common corner: a jump of the boundary values has infinite energy.
pub(super) fn dirichlet_nodes(body: &BodySpec) -> Result<Vec<(usize, f64)>> {
    let mesh = &body.mesh;
    let mut out: Vec<(usize, f64)> = Vec::new();
    if body.dirichlet.iter().all(Option::is_none) {
        return Ok(out);
    }
    let side_value = |field: &Field, place| {
        field.eval(&At {
            variables: Variables {
                point: mesh.position(place),
                body: body.place,
                subdomain: [0, 0],
            },
            subdomains: mesh.subdomains,
        })
    };
    for place in mesh.boundary() {
        let mut found: Option<(usize, f64)> = None;
        for side in mesh.sides(place) {
            let Some(field) = &body.dirichlet[side] else {
                continue;
            };
            let value = side_value(field, place);
            let [x, y] = mesh.position(place);
            if !value.is_finite() {
                return fail(
                    body,
                    format_args!("Dirichlet value {value} at ({x}, {y}) on side {} where a finite number was expected", SIDES[side]),
                );
            }
            match found {
                Some((other, given)) if !agree(given, value) => {
                    return fail(
                        body,
                        format_args!(
                            "sides {} and {} prescribe {given} and {value} at their common corner ({x}, {y}) (equal values were expected)",
                            SIDES[other], SIDES[side]
                        ),
                    );
                }
                Some(_) => {}
                None => found = Some((side, value)),
            }
        }
        if let Some((_, value)) = found {
            out.push((mesh.node(place), value));
        }
    }
    Ok(out)
}

/// An error when no unknown is left in the whole scene.
pub(super) fn check_unknowns(bodies: &[Body]) -> Result<()> {
    if bodies
        .iter()
        .any(|b| b.prescribed.len() < b.mesh().n_nodes())
    {
        return Ok(());
    }
    fail(
        &bodies[0].spec,
        "every node of the scene lies on a Dirichlet side (at least one free node was expected)",
    )
}

/// Whether two given values are the same up to the rounding of expressions.
pub(super) fn agree(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-10 * 1.0_f64.max(a.abs()).max(b.abs())
}

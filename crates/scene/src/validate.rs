//! Checks of a scene that look at one body at a time.

use super::body::Body;
use super::model::body::{BodySpec, Force};
use super::model::field::{At, Field};
use super::model::heat::Temperature;
use super::model::law::OrientedLaw;
use super::model::spec::SceneSpec;
use super::quantity::{Quantity, LARGEST, LOAD, LONGEST, RATIO, TEMPERATURE};
use base::{Error, Result};
use elements::cell::{jacobian_is_positive, Element};
use elements::form::Form;
use elements::law::Law;
use mesh::{places, BoxMesh, Mesh};
use std::collections::HashMap;

/// Largest number of bodies; the scene stores a record for each.
pub(super) const MOST_BODIES: usize = 1 << 18;

/// Largest number of subdomains.
const MOST_SUBDOMAINS: usize = 1 << 24;

/// Checks names, sizes, counts and written values.
pub(super) fn check(spec: &SceneSpec) -> Result<()> {
    if spec.bodies.is_empty() {
        return Err(Error::input("the scene has no bodies"));
    }
    if spec.bodies.len() > MOST_BODIES {
        return Err(Error::input(format!(
            "the scene has {} bodies where at most {MOST_BODIES} were expected",
            spec.bodies.len()
        )));
    }
    let mut names: HashMap<&str, &BodySpec> = HashMap::with_capacity(spec.bodies.len());
    let mut subdomains = 0;
    let dim = spec.bodies[0].mesh.dim();
    for body in &spec.bodies {
        if body.mesh.dim() != dim {
            return body.error(format!(
                "{} dimensions where {dim} were expected, as in the bodies before",
                body.mesh.dim()
            ));
        }
        if body.name.contains(char::is_control) {
            return Err(Error::input(format!(
                "body {:?}: a control character in its name, expected letters, digits and signs",
                body.name
            ))
            .at(&body.location));
        }
        check_mesh(body)?;
        check_values(body, &spec.form)?;
        check_frame(body, &spec.form)?;
        check_shape(body, &spec.form)?;
        if names.insert(&body.name, body).is_some() {
            return body.error("a second body of this name (names must be unique)");
        }
        subdomains += body.mesh.n_subdomains();
        if subdomains > MOST_SUBDOMAINS {
            return body.error(format!(
                "the scene has more than {MOST_SUBDOMAINS} subdomains with this body"
            ));
        }
    }
    Ok(())
}

impl BodySpec {
    /// The error `message` about this body.
    pub(super) fn error<T>(&self, message: impl std::fmt::Display) -> Result<T> {
        let message = format!("body `{}`: {message}", self.name);
        Err(Error::input(message).at(self.location.with_body(&self.name)))
    }
}

fn check_mesh(body: &BodySpec) -> Result<()> {
    let Mesh::Grid(mesh) = body.mesh else {
        return Ok(());
    };
    let BoxMesh {
        origin,
        size,
        elements,
        subdomains,
    } = mesh;
    for d in 0..mesh.dim() {
        let axis = ["x", "y", "z"][d];
        if !origin[d].is_finite() {
            return body.error(format!(
                "origin {} in {axis} where a finite number was expected",
                origin[d]
            ));
        }
        if origin[d].abs() > LONGEST {
            return body.error(format!(
                "origin {:e} in {axis} where at most {LONGEST:e} was expected (take other units)",
                origin[d]
            ));
        }
        if !(size[d].is_finite() && size[d] > 0.0) {
            return body.error(format!(
                "size {} in {axis} where a positive number was expected",
                size[d]
            ));
        }
        if !(1.0 / LONGEST..=LONGEST).contains(&size[d]) {
            return body.error(format!(
                "size {:e} in {axis} where a number between {:e} and {LONGEST:e} was expected (take other units)",
                size[d],
                1.0 / LONGEST
            ));
        }
        if elements[d] == 0 || subdomains[d] == 0 {
            let what = if elements[d] == 0 {
                "elements"
            } else {
                "subdomains"
            };
            return body.error(format!(
                "zero {what} in {axis} where at least one was expected"
            ));
        }
        if elements[d] % subdomains[d] != 0 {
            return body.error(format!(
                "{} subdomains in {axis} do not divide {} elements (a multiple was expected)",
                subdomains[d], elements[d]
            ));
        }
        let step = size[d] / elements[d] as f64;
        let far = origin[d].abs().max((origin[d] + size[d]).abs());
        if step < 1e-8 * far {
            return body.error(format!(
                "elements of size {step} in {axis} cannot be told apart at {far}"
            ));
        }
    }
    let block = mesh.block_elements();
    let nodes = block.iter().fold(3_usize, |n, b| n.saturating_mul(b + 1));
    if nodes >= u32::MAX as usize {
        let counts: Vec<String> = block[..mesh.dim()].iter().map(|n| n.to_string()).collect();
        return body.error(format!(
            "a subdomain of {} elements is too large (more subdomains were expected)",
            counts.join(" × ")
        ));
    }
    Ok(())
}

/// Whether a law fits the equation; the clause if it does not.
fn check_law(law: &OrientedLaw, dim: usize, form: &Form) -> std::result::Result<(), String> {
    Law::General(law.tangent).check()?;
    let placed = law.at([1.0, 0.0, 0.0], None);
    if dim == 2 && !placed.keeps_the_plane() {
        let found = "a strain in the plane leads to shear across it";
        return Err(format!(
            "{found}, expected a law that is symmetric about the plane"
        ));
    }
    match form.is_axial() {
        true => Ok(()),
        false => form.elastic(Law::General(placed)).check(dim, form.element),
    }
}

/// Checks values that do not depend on the point.
fn check_values(body: &BodySpec, form: &Form) -> Result<()> {
    for law in body.law.iter().flat_map(|law| &law.laws) {
        if let Err(clause) = check_law(law, body.mesh.dim(), form) {
            return body.error(format!("the law of its material: {clause}"));
        }
    }
    Quantity::coefficient(form).check(body, &body.rho)?;
    if form.is_elastic() {
        RATIO.check(body, &body.poisson)?;
    }
    if body.heat.is_some() && form.element == Element::P1 && body.mesh.grid().is_some() {
        return body.error("`expansion` with `element = \"p1\"` (\"q1\" was expected)");
    }
    let temperature = body
        .heat
        .as_ref()
        .and_then(|heat| heat.temperature.as_ref());
    if let Some(Temperature::Field(field)) = temperature {
        TEMPERATURE.check(body, field)?;
    }
    let components = form.components(body.mesh.dim());
    let count = |n: usize, what: &str| {
        if n == components || n == 1 && components == 1 {
            Ok(())
        } else {
            body.error(format!(
                "{what} of {n} components where {components} were expected"
            ))
        }
    };
    let none = body.load.fields.len() == 1 && body.load.fields[0].as_constant() == Some(0.0);
    if !none {
        count(body.load.fields.len(), "a load")?;
    }
    let mut fields: Vec<&Field> = body.load.fields.iter().collect();
    for load in &body.surface {
        match &load.force {
            Force::Traction(list) => {
                count(list.len(), "a traction")?;
                fields.extend(list);
            }
            Force::Pressure(p) => fields.push(p),
        }
    }
    let springs = body.springs.iter().map(|(_, k)| k);
    let held = body.dirichlet.iter().flatten().flatten();
    for field in fields.iter().copied().chain(springs).chain(held) {
        if let Field::Cells(cells) = field {
            let file = cells.name();
            return body.error(format!(
                "{file} gives a load, a spring or a side where only coefficients were expected"
            ));
        }
    }
    fields
        .into_iter()
        .try_for_each(|field| LOAD.check(body, field))
}

/// Whether the place of a copy suits the form: a ring only moves along its axis.
fn check_frame(body: &BodySpec, form: &Form) -> Result<()> {
    match &body.frame {
        Some(frame) if form.is_axial() && !(frame.is_shift() && frame.shift[0] == 0.0) => body
            .error("a ring at another radius or turned (shifts along the axis were expected in an axisymmetric scene)"),
        _ => Ok(()),
    }
}

/// Whether a bent body has positive elements everywhere.
fn check_shape(body: &BodySpec, form: &Form) -> Result<()> {
    let (Mesh::Grid(mesh), Some(_)) = (&body.mesh, &body.map) else {
        return Ok(());
    };
    let corners = 1 << mesh.dim();
    for place in places(mesh.elements.map(|n| n.max(1))) {
        let points: Vec<[f64; 3]> = (0..corners)
            .map(|a| body.position(mesh.node([0, 1, 2].map(|d| place[d] + (a >> d & 1)))))
            .collect();
        if let Some(p) = points.iter().find(|p| p.iter().any(|v| !v.is_finite())) {
            return body.error(format!(
                "its shape puts a node at {} where finite numbers were expected",
                body.spot_at(*p)
            ));
        }
        if !jacobian_is_positive(mesh.dim(), &points, form.element) {
            return body.error(format!(
                    "its shape turns the element at {} inside out (a map that keeps the orientation was expected)",
                    body.spot_at(points[0])
                ));
        }
    }
    Ok(())
}

/// Degrees of freedom with a value that a side gives, in increasing order: C k + c for component c of node k.
///
/// # Errors
/// A value that is not finite, or two sides that disagree where they meet.
pub(super) fn dirichlet_dofs(body: &BodySpec, components: usize) -> Result<Vec<(usize, f64)>> {
    let mesh = &body.mesh;
    // Nodes with the sides on which they are held, by increasing node and side.
    let mut held: Vec<(usize, usize)> = Vec::new();
    for side in (0..mesh.n_sides()).filter(|&side| body.holds(side)) {
        held.extend(mesh.side_nodes(side).into_iter().map(|node| (node, side)));
    }
    held.sort_unstable();
    let mut out: Vec<(usize, f64)> = Vec::new();
    for same in held.chunk_by(|a, b| a.0 == b.0) {
        let node = same[0].0;
        let at = At {
            variables: body.variables(node),
            subdomains: mesh.subdomain_counts(),
        };
        for component in 0..components {
            let mut found: Option<(usize, f64)> = None;
            for &(_, side) in same {
                let Some(field) = body.given_on(side, component) else {
                    continue;
                };
                let value = field.eval(&at);
                if !(LOAD.good)(value) {
                    let wanted = if value.is_finite() {
                        format!("at most {LARGEST:e} was expected (take other units)")
                    } else {
                        "a finite number was expected".into()
                    };
                    return body.error(format!(
                        "Dirichlet value {value:?} at {} on side {} where {wanted}",
                        body.spot(node),
                        mesh.side_name(side)
                    ));
                }
                match found {
                    Some((other, given)) if !agree(given, value) => {
                        return body.error(format!(
                            "sides {} and {} prescribe {given} and {value} \
                             at their common corner {} (equal values were expected)",
                            mesh.side_name(other),
                            mesh.side_name(side),
                            body.spot(node)
                        ));
                    }
                    Some(_) => {}
                    None => found = Some((side, value)),
                }
            }
            if let Some((_, value)) = found {
                out.push((node * components + component, value));
            }
        }
    }
    let points = body.given.len();
    out.extend(&body.given);
    out.sort_by_key(|&(dof, _)| dof);
    for same in out.chunk_by(|a, b| a.0 == b.0).filter(|_| points > 0) {
        if let Some(&(dof, other)) = same.iter().find(|g| !agree(g.1, same[0].1)) {
            let (node, given) = (dof / components, same[0].1);
            return body.error(format!(
                "node {} at {} is given the values {given} and {other} (equal values were expected)",
                mesh.node_id(node),
                body.spot(node)
            ));
        }
    }
    out.dedup_by_key(|g| g.0);
    Ok(out)
}

/// An error if no degree of freedom is free.
pub(super) fn check_unknowns(bodies: &[Body]) -> Result<()> {
    if bodies
        .iter()
        .any(|b| b.prescribed.len() < b.mesh().n_nodes() * b.components)
    {
        return Ok(());
    }
    bodies[0].spec.error(
        "every node of the scene lies on a Dirichlet side (at least one free node was expected)",
    )
}

/// Whether two given values are the same up to the rounding of expressions.
pub(super) fn agree(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-10 * 1.0_f64.max(a.abs()).max(b.abs())
}

//! The functions of `wrappers/fetifeti.h` for the laws of contact, friction and its load steps; their manual pages are
//! there.

use super::handle::{alone, optional, together, HandlePointer};
use super::laws::{ContactLaw, GivenLaw};
use super::mortar::slips;
use super::object::Object;
use super::surfaces::{at_place, solved_mortar};
use crate::Result;
use base::Fault;
use parallel::exchange::gather_all;
use petsc::PetscInt;
use std::ffi::c_int;

#[no_mangle]
pub unsafe extern "C" fn FetiFetiSetContactLaw(
    ff: HandlePointer,
    n: PetscInt,
    friction: *const f64,
    limit: *const f64,
    tresca: *const f64,
    stiffness: *const f64,
    stick_stiffness: *const f64,
) -> c_int {
    alone(ff, c"FetiFetiSetContactLaw", |o| {
        let [friction, limit, tresca, stiffness, stick] = [
            optional(friction, n, "friction")?,
            optional(limit, n, "limit")?,
            optional(tresca, n, "tresca")?,
            optional(stiffness, n, "stiffness")?,
            optional(stick_stiffness, n, "stick_stiffness")?,
        ];
        as_many_as_rows(o, n, "laws")?;
        let mut laws = Vec::with_capacity(o.rows.len());
        for (r, row) in o.rows.iter().enumerate() {
            let of = |list: Option<&[f64]>| list.map(|list| list[r]);
            let given = GivenLaw {
                friction: of(friction),
                limit: of(limit),
                tresca: of(tresca),
                stiffness: of(stiffness),
                stick_stiffness: of(stick),
            };
            let whose = || o.named(r);
            let law = ContactLaw::new(&given, &whose)?;
            law.suits(row.law, &whose)?;
            laws.push(law);
        }
        for (row, law) in o.rows.iter_mut().zip(laws) {
            o.changed.rows |= row.contact != law;
            row.contact = law;
        }
        Ok(())
    })
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiSetContactSlip(
    ff: HandlePointer,
    n: PetscInt,
    dim: PetscInt,
    slip: *const f64,
) -> c_int {
    alone(ff, c"FetiFetiSetContactSlip", |o| {
        as_many_as_rows(o, n, "slips")?;
        let components = components(o, dim)?;
        let slips = match optional(slip, n.saturating_mul(dim), "slip")? {
            None => vec![[0.0; 3]; o.rows.len()],
            Some(list) => list.chunks(components).map(vector).collect(),
        };
        let wrong = slips.iter().position(|s| s.iter().any(|v| !v.is_finite()));
        if let Some(r) = wrong {
            return Err(Fault::Wrong.error(format!(
                "{} has a slip of {:?}, expected a finite one",
                o.named(r),
                &slips[r][..components]
            )));
        }
        for (row, slip) in o.rows.iter_mut().zip(slips) {
            row.slipped = slip;
        }
        o.changed.gaps = true;
        Ok(())
    })
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiNextContactStep(ff: HandlePointer) -> c_int {
    alone(ff, c"FetiFetiNextContactStep", |o| {
        o.outcome()?;
        if o.carried {
            return Ok(());
        }
        o.carried = true;
        for row in &mut o.rows {
            add(&mut row.slipped, row.solved.slip);
        }
        for (&(mortar, node, _), result) in &o.at_nodes {
            let slipped = &mut o.mortars[mortar].slipped[node as usize];
            add(slipped, result.contact.slip);
        }
        o.changed.gaps = true;
        Ok(())
    })
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiGetContactFriction(
    ff: HandlePointer,
    n: PetscInt,
    dim: PetscInt,
    force: *mut f64,
    slip: *mut f64,
    state: *mut PetscInt,
) -> c_int {
    alone(ff, c"FetiFetiGetContactFriction", |o| {
        o.outcome()?;
        as_many_as_rows(o, n, "results")?;
        let components = components(o, dim)?;
        for (r, row) in o.rows.iter().enumerate() {
            for c in 0..components {
                at_place(force, r * components + c, row.solved.force[c]);
                at_place(slip, r * components + c, row.solved.slip[c]);
            }
            at_place(state, r, row.solved.state);
        }
        Ok(())
    })
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiSetMortarLaw(
    ff: HandlePointer,
    mortar: PetscInt,
    friction: f64,
    limit: f64,
    tresca: f64,
    stiffness: f64,
    stick_stiffness: f64,
) -> c_int {
    together(ff, c"FetiFetiSetMortarLaw", |o| {
        let some = |v: f64| (v != 0.0).then_some(v);
        let given = GivenLaw {
            friction: some(friction),
            limit: Some(limit),
            tresca: some(tresca),
            stiffness: Some(stiffness),
            stick_stiffness: Some(stick_stiffness),
        };
        let found = o.session.agree(mortar_law(o, mortar, &given))?;
        let (m, law) = found;
        let all = gather_all(o.session.comm(), &law.numbers());
        let bits = |numbers: &[f64]| numbers.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        if all.iter().any(|other| bits(other) != bits(&all[0])) {
            return Err(Fault::Wrong.error(format!(
                "ranks give mortar {m} different laws, expected the same"
            )));
        }
        o.changed.rows |= o.mortars[m].contact != law;
        o.mortars[m].contact = law;
        Ok(())
    })
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiSetMortarSlip(
    ff: HandlePointer,
    mortar: PetscInt,
    n: PetscInt,
    slip: *const f64,
) -> c_int {
    together(ff, c"FetiFetiSetMortarSlip", |o| {
        let given = || -> Result<(usize, Vec<f64>)> {
            let m = added(o, mortar)?;
            let first = o.mortars[m].surfaces[0];
            let surface = &o.surfaces[first];
            if n as usize != surface.mine.len() {
                return Err(Fault::Sizes.error(format!(
                    "there are slips of {n} nodes, expected {}: as many as this rank gave of surface {first}",
                    surface.mine.len()
                )));
            }
            let all = n.saturating_mul(surface.components as PetscInt);
            let slip = optional(slip, all, "slip")?.unwrap_or_default();
            match slip.iter().find(|v| !v.is_finite()) {
                None => Ok((m, slip.to_vec())),
                Some(v) => Err(Fault::Wrong.error(format!(
                    "mortar {m} has a slip of {v}, expected finite numbers"
                ))),
            }
        };
        let (m, slip) = o.session.agree(given())?;
        let first = o.mortars[m].surfaces[0];
        o.mortars[m].slipped = slips(&o.session, (first, &o.surfaces[first]), &slip)?;
        o.changed.gaps = true;
        Ok(())
    })
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiGetMortarFriction(
    ff: HandlePointer,
    mortar: PetscInt,
    n: PetscInt,
    force: *mut f64,
    shear: *mut f64,
    slip: *mut f64,
) -> c_int {
    alone(ff, c"FetiFetiGetMortarFriction", |o| {
        let (m, surface) = solved_mortar(o, mortar, n)?;
        let components = surface.components;
        for (i, node) in surface.mine.iter().enumerate() {
            let at = node.and_then(|node| o.at_nodes.get(&(m, node, 0)));
            for c in 0..components {
                let place = i * components + c;
                at_place(force, place, at.map_or(0.0, |a| a.contact.force[c]));
                at_place(
                    shear,
                    place,
                    at.map_or(0.0, |a| a.contact.force[c] / a.area),
                );
                at_place(slip, place, at.map_or(0.0, |a| a.contact.slip[c]));
            }
        }
        Ok(())
    })
}

/// The place of a mortar that has been added.
///
/// # Errors
/// A mortar that there is not.
fn added(o: &Object, mortar: PetscInt) -> Result<usize> {
    let found = usize::try_from(mortar).ok();
    let found = found.filter(|&m| m < o.mortars.len());
    found.ok_or_else(|| {
        Fault::OutOfRange.error(format!(
            "there is no mortar {mortar}, expected one of {} (from 0)",
            o.mortars.len()
        ))
    })
}

/// The law of a mortar that has been added.
///
/// # Errors
/// A mortar that there is not, a tie, scalars; and those of [`ContactLaw::new`].
fn mortar_law(o: &Object, mortar: PetscInt, given: &GivenLaw) -> Result<(usize, ContactLaw)> {
    let m = added(o, mortar)?;
    let whose = || format!("mortar {m}");
    let law = ContactLaw::new(given, &whose)?;
    law.suits(o.mortars[m].law, &whose)?;
    if law.has_friction() && o.surfaces[o.mortars[m].surfaces[0]].components == 1 {
        return Err(Fault::Wrong.error(format!(
            "mortar {m} has friction between surfaces of one unknown in a node, expected displacements"
        )));
    }
    Ok((m, law))
}

fn as_many_as_rows(o: &Object, n: PetscInt, what: &str) -> Result<()> {
    if n as usize == o.rows.len() {
        return Ok(());
    }
    Err(Fault::Sizes.error(format!(
        "there are {n} {what}, expected {}: as many as this rank gave rows",
        o.rows.len()
    )))
}

/// The number of components of vectors at rows.
fn components(o: &Object, dim: PetscInt) -> Result<usize> {
    let expected = o.nodes();
    if dim as usize == expected && expected <= 3 {
        return Ok(expected);
    }
    Err(Fault::Sizes.error(format!(
        "vectors at rows have {dim} components, expected {expected}: as many as a node has unknowns"
    )))
}

fn vector(components: &[f64]) -> [f64; 3] {
    let mut out = [0.0; 3];
    out[..components.len()].copy_from_slice(components);
    out
}

fn add(to: &mut [f64; 3], more: [f64; 3]) {
    to.iter_mut().zip(more).for_each(|(to, v)| *to += v);
}

//! Functions that plots along interfaces and maps of interfaces share.

use crate::{Error, Result};

/// Checks that the lists of an interface have one entry per node; `what` names the lists in the error.
pub(super) fn check_lengths(
    name: &str,
    n: usize,
    what: &str,
    lists: &[(usize, &str)],
) -> Result<()> {
    match lists.iter().find(|list| list.0 != n) {
        None => Ok(()),
        Some((found, list)) => Err(Error::input(format!(
            "the interface '{name}' lists {found} {list}, expected one for each of {n} {what}"
        ))),
    }
}

/// Force per area by node; NaN where a node has no area.
pub(super) fn pressure(force: &[f64], area: &[f64]) -> Vec<f64> {
    let each = force.iter().zip(area);
    each.map(|(&force, &area)| if area > 0.0 { force / area } else { f64::NAN })
        .collect()
}

/// The interfaces with the largest forces, at most `shown`, and the title, which gives the total number where there are
/// more. Forces that are not finite come first: the reader must see them.
pub(super) fn largest<'a, T>(
    interfaces: impl Iterator<Item = &'a T>,
    force: fn(&T) -> f64,
    shown: usize,
    title: &str,
) -> (Vec<&'a T>, String) {
    let size = |t: &T| match force(t).abs() {
        force if force.is_nan() => f64::INFINITY,
        force => force,
    };
    let mut order: Vec<&T> = interfaces.collect();
    order.sort_by(|a, b| size(b).total_cmp(&size(a)));
    let note = format!(
        "the {shown} of {} interfaces with the largest forces",
        order.len()
    );
    let title = match (title, order.len() > shown) {
        (_, false) => title.to_string(),
        ("", true) => note,
        _ => format!("{title}: {note}"),
    };
    order.truncate(shown);
    (order, title)
}

//! A warning about options that nobody has asked for.

use std::collections::BTreeSet;

use super::args::Command;
use base::Result;
use fetifeti::Settings;
use petsc::{known, Comm, Ksp, Options, Session};

/// Beginnings of options that are this program's, wherever they are set.
const OURS: [&str; 3] = ["-fetifeti_", "-compare_", "-scaling_"];

/// The solvers inside a solve, by the prefixes of their options, with the types that they have by default.
const SOLVERS: [[&str; 3]; 3] = [
    ["-fetifeti_", "cg", "none"],
    ["-fetifeti_coarse_", "preonly", "cholesky"],
    ["-fetifeti_gtg_", "preonly", "lu"],
];

/// Beginnings of options that PETSc reads when the program ends, or in a solve for objects that are not made before.
const LATE: [&str; 12] = [
    "-malloc",
    "-memory",
    "-objects",
    "-options",
    "-log",
    "-mpi",
    "-citations",
    "-saws",
    "-info",
    "-history",
    "-help",
    "-get_total_flops",
];

/// Prefixes of solvers of which `plan` cannot know all options: those of factorisations, blocks and levels.
const DEEP: [&str; 3] = ["-fetifeti_coarse_", "-fetifeti_gtg_", "-fetifeti_eps_"];

/// The warning after `command`, whose PETSc options on the command line are `line`, if there is anything to warn of.
/// PETSc's own list, `-options_left`, takes its place.
pub fn warning(session: &Session, command: &Command, line: &[String]) -> Result<Option<String>> {
    let all = Options::new(session, "");
    if all.has("options_left")? {
        return Ok(None);
    }
    let begins = |name: &str, with: &[&str]| with.iter().any(|start| name.starts_with(start));
    let wanted = |name: &String| begins(name, &OURS) || line.contains(name) && !begins(name, &LATE);
    let left: BTreeSet<String> = all.left()?.into_iter().map(|(name, _)| name).collect();
    let mut left: BTreeSet<String> = left.into_iter().filter(wanted).collect();
    if left.is_empty() {
        return Ok(None);
    }
    let names = catalogue(session)?;
    if matches!(command, Command::Plan(_)) {
        // A solve would ask for these.
        left.retain(|name| {
            !names.contains(name) && (!begins(name, &DEEP) || nearest(name, &names).is_some())
        });
    }
    let list: Vec<String> = left
        .iter()
        .map(|name| match nearest(name, &names) {
            Some(other) => format!("{name} (did you mean {other}?)"),
            None => name.clone(),
        })
        .collect();
    Ok((!list.is_empty()).then(|| {
        format!(
            "Warning: nobody has asked for {}: misspelt, or of a part that this problem does not need \
             (fetifeti -help lists the options)",
            list.join(", ")
        )
    }))
}

/// In front of the prefixes of solvers whose options are listed: PETSc lists those of one prefix once, or not at all
/// where such a solver was made before.
const ASIDE: &str = "known_";

/// The names of our options and of those of the solvers behind them, of the types that are set.
fn catalogue(session: &Session) -> Result<BTreeSet<String>> {
    let mut types = Vec::new();
    for [prefix, ..] in SOLVERS {
        let options = Options::new(session, &prefix[1..]);
        for kind in ["ksp_type", "pc_type"] {
            // -fetifeti_pc_type is ours.
            let ours = prefix == SOLVERS[0][0] && kind == "pc_type";
            if let Some(value) = options.get_string(kind)?.filter(|_| !ours) {
                types.push((format!("-{ASIDE}{}{kind}", options.prefix()), value));
            }
        }
    }
    Settings::default().with_options(session)?;
    let listed = known(session, &types, || {
        for [prefix, kind, pc] in SOLVERS {
            let ksp = Ksp::new(session, Comm::Own)?;
            ksp.set_options_prefix(&format!("{ASIDE}{}", &prefix[1..]))?;
            ksp.set_type(kind)?;
            if prefix == SOLVERS[0][0] {
                ksp.pc()?
                    .set_options_prefix(&format!("{ASIDE}fetifeti_ksp_"))?;
            }
            ksp.pc()?.set_type(pc)?;
            ksp.set_from_options()?;
        }
        Ok(())
    })?;
    let aside = format!("-{ASIDE}");
    let ours = listed.iter().filter_map(|name| name.strip_prefix(&aside));
    let mut names: BTreeSet<String> = ours.map(|name| format!("-{name}")).collect();
    // Known to every KSP, and not listed.
    names.extend(SOLVERS.map(|[prefix, ..]| format!("{prefix}ksp_converged_reason")));
    names.extend(session.asked());
    Ok(names)
}

/// The name that differs least from this one, if it is near; or this one behind our prefix.
fn nearest<'a>(name: &str, names: &'a BTreeSet<String>) -> Option<&'a String> {
    let behind = format!("-fetifeti_{}", &name[1..]);
    if let Some(other) = names.get(&behind) {
        return Some(other);
    }
    // Solvers have options of the same names.
    let solver = |name: &str| DEEP.iter().position(|start| name.starts_with(start));
    let near = |other: &&String| {
        other.as_str() != name
            && solver(other) == solver(name)
            && other.len().abs_diff(name.len()) < 3
    };
    let of = names.iter().filter(near);
    let all = of.map(|other| (distance(name, other), other));
    // Two letters, or three in long names.
    let most = if name.len() > 24 { 3 } else { 2 };
    all.min().filter(|d| d.0 <= most).map(|d| d.1)
}

/// Letters to be replaced, added or left out, and neighbours to be exchanged, to make `b` of `a`.
fn distance(a: &str, b: &str) -> usize {
    let [a, b]: [Vec<char>; 2] = [a, b].map(|text| text.chars().collect());
    let mut rows = vec![(0..=b.len()).collect::<Vec<usize>>()];
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let other = usize::from(a[i - 1] != b[j - 1]);
            let mut least = (rows[i - 1][j] + 1)
                .min(row[j - 1] + 1)
                .min(rows[i - 1][j - 1] + other);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                least = least.min(rows[i - 2][j - 2] + 1);
            }
            row.push(least);
        }
        rows.push(row);
    }
    rows[a.len()][b.len()]
}

#[cfg(test)]
#[path = "../tests/unused.rs"]
mod tests;

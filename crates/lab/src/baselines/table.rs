//! The baselines: PETSc's solvers by options on the same problem, to the same residual.
//!
//! [`peers`](super::peers) lists them. Every one has a prefix of its own, so that a researcher can tune it on the
//! command line of `compare`: `-gamg_pc_gamg_threshold 0.05`, `-bddc_pc_bddc_levels 1`, `-fetidp_fetidp_ksp_monitor`.
//! Ours keeps `-fetifeti_`.

use super::peers::{BASELINES, BDDC};
use crate::assembled::near::Near;
use crate::assembled::system::MatrixFormat;
use base::{Error, Result};
use petsc::{Options, Session};
use scene::Scene;

/// One of PETSc's solvers.
#[derive(Debug, PartialEq)]
pub struct Baseline {
    /// The name for `--with`; followed by an underscore, the prefix of its options.
    pub name: &'static str,
    /// A description.
    pub description: &'static str,
    /// A part that PETSc must have been built with.
    pub needs: Needs,
    /// The matrix it takes.
    pub format: MatrixFormat,
    /// The prefix of the Krylov method's options behind the row's own prefix: KSPFETIDP iterates in an inner solver.
    pub krylov: &'static str,
    /// The prefix of PCBDDC's options behind the row's own prefix, where it is or has one; those in [`BDDC`] hold, and
    /// its solvers of subdomains and of the coarse problem are given the best package that PETSc has.
    pub bddc: Option<&'static str>,
    /// Options that hold unless the user says otherwise; later ones override earlier ones.
    pub sets: &'static [OptionSet],
    /// The rigid motions that the solver is given.
    pub near: Near,
    /// In contact loops the preconditioner is kept until more than this part of the inequalities has changed since it
    /// was built. The value is the fastest one on the model problem.
    pub lag: f64,
}

/// A part of PETSc that not every build has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Needs {
    /// Nothing.
    Nothing,
    /// A type of preconditioner.
    Pc(&'static str),
    /// A package for factorisations.
    Package(&'static str),
}

/// Options (without the prefix of the baseline) for some problems.
#[derive(Debug, PartialEq)]
pub struct OptionSet {
    /// The problems.
    pub when: When,
    /// Names and values.
    pub options: &'static [(&'static str, &'static str)],
}

/// The problems for which options hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum When {
    /// All problems.
    Always,
    /// Problems in three dimensions.
    Space,
    /// Elastic ones.
    Elastic,
    /// Elastic ones in three dimensions.
    ElasticSpace,
    /// Elastic ones in three dimensions, with PETSc 3.21 and later.
    ElasticSpaceNewer,
    /// Contact loops, where the matrix changes and has entries that are zero.
    Contact,
    /// A second try, where the first one did not converge.
    Rescue,
}

impl When {
    fn holds(self, case: &BaselineCase) -> bool {
        match self {
            When::Always => true,
            When::Space => case.space,
            When::Elastic => case.elastic,
            When::ElasticSpace => case.elastic && case.space,
            When::ElasticSpaceNewer => case.elastic && case.space && case.newer,
            When::Contact => case.contact,
            When::Rescue => case.rescue,
        }
    }
}

impl Baseline {
    /// The baseline of this name.
    pub fn named(name: &str) -> Option<&'static Baseline> {
        BASELINES.iter().find(|b| b.name == name)
    }

    /// The prefix of its options.
    pub fn prefix(&self) -> String {
        format!("{}_", self.name)
    }

    /// Whether it has options for a second try.
    pub fn has_rescue(&self) -> bool {
        self.bddc.is_some()
    }

    /// The options of the second try, as the user of `compare` would write them.
    pub fn rescue_options(&self) -> String {
        let sets = BDDC.iter().filter(|set| set.when == When::Rescue);
        let all = sets.flat_map(|set| set.options);
        let prefix = self.prefix() + self.bddc.unwrap_or_default();
        let written = all.map(|(name, value)| format!("-{prefix}{name} {value}"));
        written.collect::<Vec<_>>().join(" ")
    }

    /// The sentence where this PETSc lacks what it needs.
    ///
    /// # Errors
    /// PETSc's.
    pub fn missing(&self, session: &Session) -> Result<Option<String>> {
        let (has, what) = match self.needs {
            Needs::Nothing => return Ok(None),
            Needs::Pc(name) => (petsc::has_pc(session, name)?, name),
            Needs::Package(name) => (petsc::has_cholesky(session, name)?, name),
        };
        let version = petsc::version()?;
        Ok((!has).then(|| format!("this PETSc ({version}) was built without {what}")))
    }

    /// The options for a problem, without the prefix, as they stand unless the user says otherwise.
    pub fn options(&self, case: &BaselineCase) -> Vec<(String, String)> {
        let mut all: Vec<(String, String)> = Vec::new();
        let mut set = |name: String, value: &str| match all.iter_mut().find(|o| o.0 == name) {
            Some(known) => known.1 = value.to_string(),
            None => all.push((name, value.to_string())),
        };
        let packages = self.bddc.into_iter().flat_map(|bddc| {
            let local = ["dirichlet", "neumann"].map(|part| (part, case.local));
            // PETSc's own factor of the coarse problem takes up to ten times as long.
            let parts = local.into_iter().chain([("coarse", case.coarse)]);
            parts.flat_map(move |(part, package)| {
                package.into_iter().flat_map(move |package| {
                    let at = format!("{bddc}pc_bddc_{part}_");
                    [
                        (format!("{at}pc_type"), "cholesky"),
                        (format!("{at}pc_factor_mat_solver_type"), package),
                    ]
                })
            })
        });
        let primal = self.bddc.into_iter().flat_map(|bddc| {
            let sets = BDDC.iter().filter(|set| set.when.holds(case));
            let listed = sets.flat_map(|set| set.options);
            listed.map(move |(name, value)| (format!("{bddc}{name}"), *value))
        });
        let sets = self.sets.iter().filter(|set| set.when.holds(case));
        let listed = sets.flat_map(|set| set.options);
        let listed = listed.map(|(name, value)| (name.to_string(), *value));
        let (first, rest): (Vec<_>, Vec<_>) = listed.partition(|(name, _)| name == "ksp_type");
        let all_sets = first.into_iter().chain(rest).chain(primal);
        for (name, value) in all_sets.chain(packages) {
            set(name, value);
        }
        all
    }

    /// Puts the options into the database, where those of the user override them, and lists them under `-help`.
    ///
    /// # Errors
    /// PETSc's.
    pub fn set_options(&self, session: &Session, rtol: f64, case: BaselineCase) -> Result<()> {
        let options = Options::new(session, &self.prefix());
        options.heading(&format!(
            "compare --with {}: {}",
            self.name, self.description
        ))?;
        let tolerance = (format!("{}ksp_rtol", self.krylov), format!("{rtol:e}"));
        for (name, value) in self.options(&case).into_iter().chain([tolerance]) {
            options.set_default(&name, &value)?;
            options.list(&name, &value, "set by compare")?;
        }
        Ok(())
    }

    /// The options of a run without its tolerance, as a user writes them in a program of his own: those for the
    /// problem, overridden and followed by those that the user of `compare` gave.
    ///
    /// # Errors
    /// PETSc's.
    pub fn written(&self, session: &Session, case: &BaselineCase) -> Result<String> {
        let prefix = format!("-{}", self.prefix());
        let mut given = Options::new(session, &self.prefix()).all()?;
        let tolerance = format!("{prefix}{}ksp_rtol", self.krylov);
        given.retain(|(name, _)| *name != tolerance);
        let mut all = self.options(case);
        for (name, value) in given {
            let name = name[prefix.len()..].to_string();
            match all.iter_mut().find(|option| option.0 == name) {
                Some(known) => known.1 = value,
                None => all.push((name, value)),
            }
        }
        let written = all.iter().map(|(name, value)| format!("-{name} {value}"));
        let written: Vec<String> = written
            .map(|option| option.trim_end().to_string())
            .collect();
        Ok(written.join(" "))
    }

    /// The functions of PETSc by which it is told more than options say, for a table.
    pub fn given(&self, case: &BaselineCase) -> String {
        let motions = match self.near {
            _ if !case.elastic => "",
            Near::None => "",
            Near::Rotations => "MatSetNearNullSpace (rotations)",
            Near::Motions => "MatSetNearNullSpace (rigid motions)",
        };
        match self.format {
            MatrixFormat::Assembled => motions.to_string(),
            _ if motions.is_empty() => String::new(),
            _ => format!("{motions}, PCBDDCSetDofsSplittingLocal, PCSetCoordinates"),
        }
    }
}

/// Packages for the subdomains of domain decompositions, the best first.
const LOCAL: [&str; 2] = ["cholmod", "mumps"];

/// The package for coarse problems.
const COARSE: &str = "mumps";

/// The properties of a run that its options depend on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BaselineCase {
    /// Whether the problem is three-dimensional.
    pub space: bool,
    /// Whether it is elasticity.
    pub elastic: bool,
    /// Whether PETSc is 3.21 or later.
    pub newer: bool,
    /// Whether there are inequalities.
    pub contact: bool,
    /// Whether this is the second try.
    pub rescue: bool,
    /// The package for subdomains; `None`: PETSc's own.
    pub local: Option<&'static str>,
    /// The package for coarse problems; `None`: PETSc's own.
    pub coarse: Option<&'static str>,
}

impl BaselineCase {
    /// The properties of `scene`, for the first try.
    ///
    /// # Errors
    /// PETSc's.
    pub fn of(session: &Session, scene: &Scene) -> Result<BaselineCase> {
        let mut local = None;
        for package in LOCAL {
            if local.is_none() && petsc::has_cholesky(session, package)? {
                local = Some(package);
            }
        }
        Ok(BaselineCase {
            space: scene.dim() == 3,
            elastic: scene.components() > 1,
            newer: petsc::REPEATS,
            contact: scene.has_contact(),
            rescue: false,
            local,
            coarse: petsc::has_cholesky(session, COARSE)?.then_some(COARSE),
        })
    }
}

/// The baselines that `--with` names, in the order of the table; all of them for an empty list.
///
/// # Errors
/// [`ErrorKind::Input`](base::ErrorKind::Input) for a name that is not in the table.
pub fn select(names: &[String]) -> Result<Vec<&'static Baseline>> {
    for name in names {
        if Baseline::named(name).is_none() {
            let known: Vec<&str> = BASELINES.iter().map(|b| b.name).collect();
            return Err(Error::input(format!(
                "--with names \"{name}\", expected some of {}",
                known.join(",")
            )));
        }
    }
    let wanted = |b: &&Baseline| names.is_empty() || names.iter().any(|n| n == b.name);
    Ok(BASELINES.iter().filter(wanted).collect())
}

#[cfg(test)]
#[path = "../../tests/baselines/table.rs"]
mod tests;

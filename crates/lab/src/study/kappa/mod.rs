//! `study kappa`: condition numbers of the preconditioned operator as a function of H_b/H_s and H_s/h; scalar and
//! elastic, in the plane and in space, with M_D and M_C.
//!
//! The domain is the unit square or cube, held all round, of two tied bodies in each direction. κ is the estimate of CG
//! (Lanczos) at a relative residual of 1e-11, a lower bound that has converged to three digits by then. `exact` is
//! SLEPc's value, where it was asked for.
//!
//! A second table has contact with friction beside ties and contact without it ([`friction`]).

pub mod friction;
pub mod scenes;

use serde::{Deserialize, Serialize};

use self::friction::{ContactLaw, FrictionRow};
use self::scenes::{FrictionScene, SCENES};
use base::{Error, Result};
use fetifeti::settings::{Adaptive, MergeKind, MethodSettings, PcType};
use fetifeti::FetiFeti;
use parallel::contiguous_share;
use petsc::Session;
use report::tables::table::Table;
use scene::Scene;

/// A family of problems that differ in size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KappaFamily {
    /// Name in tables.
    pub name: &'static str,
    /// 2 or 3.
    pub dim: usize,
    /// Poisson's ratio; `None` for a scalar.
    pub poisson: Option<f64>,
    /// Pairs (H_b/H_s, H_s/h).
    pub sizes: &'static [[usize; 2]],
    /// Number of these pairs with `--quick`.
    pub quick: usize,
}

/// The families of the study.
pub const FAMILIES: [KappaFamily; 5] = [
    KappaFamily {
        name: "scalar-2d",
        dim: 2,
        poisson: None,
        sizes: &[[2, 4], [4, 4], [8, 4], [4, 2], [4, 8], [4, 16]],
        quick: 2,
    },
    KappaFamily {
        name: "elastic-2d-0.3",
        dim: 2,
        poisson: Some(0.3),
        sizes: &[[2, 4], [4, 4], [8, 4], [4, 2], [4, 8], [4, 16]],
        quick: 2,
    },
    KappaFamily {
        name: "elastic-2d-0.49",
        dim: 2,
        poisson: Some(0.49),
        sizes: &[[2, 4], [4, 4], [8, 4], [4, 2], [4, 8], [4, 16]],
        quick: 1,
    },
    KappaFamily {
        name: "scalar-3d",
        dim: 3,
        poisson: None,
        sizes: &[[2, 2], [4, 2], [8, 2], [5, 3], [2, 4], [2, 8], [2, 16]],
        quick: 1,
    },
    KappaFamily {
        name: "elastic-3d-0.3",
        dim: 3,
        poisson: Some(0.3),
        sizes: &[[2, 2], [3, 2], [4, 2], [2, 4], [2, 8]],
        quick: 1,
    },
];

/// The result with one preconditioner on one grid.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct KappaOf {
    /// CG's estimate of κ.
    pub kappa: f64,
    /// CG's smallest eigenvalue, at least 1 up to rounding.
    pub lambda_min: f64,
    /// Iterations.
    pub iterations: usize,
    /// The exact κ, where it was asked for.
    pub exact: Option<f64>,
}

/// The results on one grid.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct KappaRow {
    /// The family.
    pub family: String,
    /// H_b/H_s.
    pub subdomains: usize,
    /// H_s/h.
    pub elements: usize,
    /// Free degrees of freedom of the subdomains, copies counted.
    pub dofs: usize,
    /// With M_D.
    pub dirichlet: KappaOf,
    /// With M_C.
    pub coarse_corrected: KappaOf,
}

/// The study.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct KappaReport {
    /// "kappa".
    pub study: String,
    /// The results by family and size.
    pub rows: Vec<KappaRow>,
    /// The results with contact, by scene, size and law.
    pub friction: Vec<FrictionRow>,
}

/// A case of the study.
#[derive(Clone, Copy)]
enum Case {
    Tied(KappaFamily),
    Contact(FrictionScene),
}

impl Case {
    fn name(&self) -> &'static str {
        match self {
            Case::Tied(family) => family.name,
            Case::Contact(scene) => scene.name,
        }
    }

    /// How many of its sizes are measured.
    fn count(&self, quick: bool) -> usize {
        let [some, all] = match self {
            Case::Tied(family) => [family.quick, family.sizes.len()],
            Case::Contact(scene) => [scene.quick, scene.sizes.len()],
        };
        match quick {
            true => some,
            false => all,
        }
    }
}

/// Runs the study; `exact` asks for the exact spectra, too (minutes on large grids). Collective.
///
/// # Errors
/// Those of the method; [`ErrorKind::NotConverged`](base::ErrorKind::NotConverged) where CG did not end.
pub fn run(
    session: &Session,
    quick: bool,
    only: Option<&str>,
    exact: bool,
    progress: &mut dyn FnMut(&str),
) -> Result<KappaReport> {
    let (mut rows, mut friction) = (Vec::new(), Vec::new());
    let tied = FAMILIES.into_iter().map(Case::Tied);
    let cases = tied.chain(SCENES.into_iter().map(Case::Contact)).collect();
    for (of, case) in super::numbered(super::chosen(cases, |c: &Case| c.name(), only)?) {
        for size in 0..case.count(quick) {
            match case {
                Case::Tied(family) => {
                    let [subdomains, elements] = family.sizes[size];
                    progress(&format!("{of}, {}, {subdomains} x {elements}", family.name));
                    rows.push(grid(session, &family, [2, subdomains, elements], exact)?);
                }
                Case::Contact(scene) => {
                    let elements = scene.sizes[size];
                    progress(&format!("{of}, {}, {elements}", scene.name));
                    let laws = laws(size == 0 && !quick);
                    friction.extend(friction::rows(session, &scene, elements, &laws, exact)?);
                }
            }
        }
    }
    Ok(KappaReport {
        study: "kappa".into(),
        rows,
        friction,
    })
}

/// The laws that scenes are solved with. The stiffness of springs is 1, Young's modulus by a length of 1, or
/// varies.
fn laws(varied: bool) -> Vec<ContactLaw> {
    let stiffness: &[f64] = if varied { &[100.0, 1.0, 0.1] } else { &[1.0] };
    let rigid = [
        ContactLaw::Tied,
        ContactLaw::Frictionless,
        ContactLaw::Friction,
    ];
    let soft = stiffness.iter().map(|&k| ContactLaw::Soft(k));
    let elastic = stiffness.iter().map(|&k| ContactLaw::ElasticSlip(k));
    rigid.into_iter().chain(soft).chain(elastic).collect()
}

/// One grid of `bodies` bodies in each direction, of `subdomains` subdomains of `elements` elements. Collective.
///
/// # Errors
/// As [`run`].
pub fn grid(
    session: &Session,
    family: &KappaFamily,
    [bodies, subdomains, elements]: [usize; 3],
    exact: bool,
) -> Result<KappaRow> {
    let scene = Scene::parse("kappa.toml", &text(family, [bodies, subdomains, elements]))?;
    let mine = contiguous_share(scene.n_subdomains(), session.size(), session.rank());
    let problem = session.agree(scene.substructures(&|s| mine.contains(&s)))?;
    let mut dofs = [problem.local.iter().map(|s| s.k.n() as f64).sum::<f64>()];
    parallel::exchange::sum_all(session.comm(), &mut dofs);
    let found = |pc: PcType| -> Result<KappaOf> {
        // κ of the preconditioner alone.
        let settings = MethodSettings::default()
            .pc_type(pc)
            .rtol(1e-9)
            .merge(MergeKind::None)
            .adaptive(Adaptive::Off);
        let mut solver = FetiFeti::new(session, problem.clone(), settings)?;
        let solution = solver.solve()?;
        if !solution.converged() {
            return Err(Error::not_converged(format!(
                "kappa, {}, H_b/H_s = {subdomains}, H_s/h = {elements}: {}",
                family.name, solution.status
            )));
        }
        let exact = if exact {
            solver.spectrum()?.map(|s| s.kappa())
        } else {
            None
        };
        Ok(KappaOf {
            kappa: solution.estimate.map_or(f64::NAN, |s| s.kappa()),
            lambda_min: solution.estimate.map_or(f64::NAN, |s| s.lambda_min),
            iterations: solution.iterations,
            exact,
        })
    };
    Ok(KappaRow {
        family: family.name.into(),
        subdomains,
        elements,
        dofs: dofs[0] as usize,
        dirichlet: found(PcType::Dirichlet)?,
        coarse_corrected: found(PcType::CoarseCorrected)?,
    })
}

/// The scene. Its load has no symmetry, so that CG sees the whole spectrum.
fn text(family: &KappaFamily, [bodies, subdomains, elements]: [usize; 3]) -> String {
    let dim = family.dim;
    let wave = |k: usize| match dim {
        2 => format!("\"sin({}*x + {}*y + {k})\"", 7 + 4 * k, 11 - 3 * k),
        _ => format!(
            "\"sin({}*x + {}*y + {}*z + {k})\"",
            7 + 4 * k,
            11 - 3 * k,
            5 + 2 * k
        ),
    };
    let rest = match family.poisson {
        None => format!("load = {}\n", wave(0)),
        Some(nu) => {
            let loads: Vec<String> = (0..dim).map(wave).collect();
            format!("poisson = {nu}\nload = [{}]\n", loads.join(", "))
        }
    };
    let physics = match family.poisson {
        None => "scalar",
        Some(_) => "elasticity",
    };
    format!(
        "dimension = {dim}\nphysics = \"{physics}\"\n[grid]\nbodies = {bodies}\nsubdomains = {subdomains}\n\
         elements_per_subdomain = {elements}\ndirichlet = \"all\"\n{rest}"
    )
}

/// The table that is printed and written as CSV.
pub fn table(report: &KappaReport) -> Table {
    let exact = |of: &KappaOf| of.exact.map_or(String::new(), |v| format!("{v:.3}"));
    Table::of(&report.rows)
        .words("problem", |r| &r.family)
        .numbers("H_b/H_s", |r| r.subdomains)
        .numbers("H_s/h", |r| r.elements)
        .numbers("dofs", |r| r.dofs)
        .numbers("κ of M_D", |r| format!("{:.3}", r.dirichlet.kappa))
        .numbers("it", |r| r.dirichlet.iterations)
        .numbers("κ of M_C", |r| format!("{:.3}", r.coarse_corrected.kappa))
        .numbers("it", |r| r.coarse_corrected.iterations)
        .when(
            report.rows.iter().any(|r| r.dirichlet.exact.is_some()),
            |t| {
                t.numbers("exact M_D", |r| exact(&r.dirichlet))
                    .numbers("exact M_C", |r| exact(&r.coarse_corrected))
            },
        )
        .table()
}

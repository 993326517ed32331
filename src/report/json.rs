//! The records that programs read: one struct per command, keys as other programs rely on them.
//!
//! A number that is not known or not finite is written as `null`, never as NaN, and read back as `None` or NaN.

use super::contact::ContactReport;
use super::output;
use crate::{Error, Result};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Serialises any record as indented JSON to a file, or to standard output for the path `-`.
///
/// # Errors
/// [`Error::Environment`] with the path when it cannot be written.
pub fn write<T: Serialize>(path: &Path, record: &T) -> Result<()> {
    let mut text = to_string(record)?;
    text.push('\n');
    output::write_text(path, &text)
}

/// Indented JSON of any record.
///
/// # Errors
/// [`Error::Environment`] when the record has no JSON form (a map whose keys are not strings).
pub fn to_string<T: Serialize>(record: &T) -> Result<String> {
    serde_json::to_string_pretty(record)
        .map_err(|e| Error::Environment(format!("cannot write a result as JSON: {e}")))
}

/// Reads `null` back as NaN; the serialiser writes NaN and the infinities as `null` by itself.
pub(super) mod number {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub fn serialize<S: Serializer>(x: &f64, s: S) -> Result<S::Ok, S::Error> {
        x.is_finite().then_some(*x).serialize(s)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(d: D) -> Result<f64, D::Error> {
        Ok(Option::<f64>::deserialize(d)?.unwrap_or(f64::NAN))
    }
}

/// What `solve` reports.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SolveReport {
    /// The scene's name or file.
    pub scene: String,
    /// 2 or 3.
    #[serde(default)]
    pub dimension: usize,
    /// `scalar` or `elasticity`.
    #[serde(default)]
    pub physics: String,
    /// Components of the field.
    #[serde(default)]
    pub components: usize,
    /// Equation and elements in words, such as `plane strain elasticity, Q1, no cure of locking`.
    #[serde(default)]
    pub form: String,
    /// MPI ranks.
    pub ranks: usize,
    /// Threads per rank.
    pub threads: usize,
    /// Bodies.
    pub bodies: usize,
    /// Bodies whose stiffness matrix is singular.
    pub floating_bodies: usize,
    /// Subdomains over all bodies.
    pub subdomains: usize,
    /// Free degrees of freedom, those that subdomains of one body share counted once.
    pub dofs: usize,
    /// Rows of B.
    pub multipliers: Multipliers,
    /// Steps of the contact loop; 1 without inequalities.
    pub outer_iterations: usize,
    /// Krylov iterations.
    pub iterations: Iterations,
    /// Extreme eigenvalues of the preconditioned operator.
    pub condition: Condition,
    /// What was deflated; absent where nothing was searched for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub adaptive: Option<super::adaptive::Adaptive>,
    /// Residuals of the Karush-Kuhn-Tucker conditions.
    pub kkt: Kkt,
    /// ½ uᵀKu − fᵀu.
    #[serde(with = "number")]
    pub energy: f64,
    /// How contact was found and what it carries; absent where no sides may touch.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact: Option<ContactReport>,
    /// Error against the exact solution, where the scene has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<ErrorNorms>,
    /// Wall-clock time by phase.
    pub seconds: Seconds,
    /// Largest resident memory, summed over the ranks, in MB of 10⁶ bytes.
    #[serde(with = "number")]
    pub memory_mb: f64,
    /// PETSc's name for why the iteration ended, such as `CONVERGED_RTOL`.
    pub converged_reason: String,
    /// Krylov method, such as `cg`.
    pub ksp_type: String,
    /// `none`, `lumped`, `dirichlet` or `coarse_corrected`.
    pub preconditioner: String,
    /// Weight Q of the projector: `none` without floating bodies, else `identity`, `diagonal` or `preconditioner`.
    pub projector: String,
    /// Relative defects of the operators' identities, where `-fetifeti_check` asked for them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub check: Option<std::collections::BTreeMap<String, f64>>,
    /// Relative tolerance of the inner iteration.
    #[serde(with = "number")]
    pub rtol: f64,
}

/// Rows of B.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Multipliers {
    /// Rows of B_loc, inside the bodies.
    pub local: usize,
    /// Rows of B_gl, between bodies.
    pub global: usize,
    /// Rows of B_gl that hold in the last contact step.
    pub active: usize,
}

/// Krylov iterations.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Iterations {
    /// Per contact step.
    pub inner: Vec<usize>,
    /// Their sum.
    pub total: usize,
}

impl Iterations {
    /// From the counts per contact step.
    pub fn new(inner: Vec<usize>) -> Self {
        let total = inner.iter().sum();
        Iterations { inner, total }
    }
}

/// Extreme eigenvalues of the preconditioned operator.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Condition {
    /// By an eigenvalue solver; `null` where it was not asked for.
    pub exact: Option<Spectrum>,
    /// Lanczos estimate of the run; `null` where the Krylov method gives none.
    pub estimate: Option<Spectrum>,
}

/// Both ends of a spectrum.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Spectrum {
    /// Smallest eigenvalue.
    #[serde(with = "number")]
    pub lambda_min: f64,
    /// Largest eigenvalue.
    #[serde(with = "number")]
    pub lambda_max: f64,
    /// Their ratio.
    #[serde(with = "number")]
    pub kappa: f64,
}

impl Spectrum {
    /// κ = λ_max / λ_min.
    pub fn new(lambda_min: f64, lambda_max: f64) -> Self {
        Spectrum {
            lambda_min,
            lambda_max,
            kappa: lambda_max / lambda_min,
        }
    }
}

/// Residuals of the Karush-Kuhn-Tucker conditions, relative to the load and the solution.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Kkt {
    /// ‖Ku + Bᵀλ − f‖ / (‖f‖ + ‖Bᵀλ‖) in the norm of diag(K)⁻¹.
    #[serde(with = "number")]
    pub stationarity: f64,
    /// Largest violation of Bu = c and Bu ≤ c.
    #[serde(with = "number")]
    pub feasibility: f64,
    /// Largest |λ_r (Bu − c)_r| over the inequalities; 0 without any.
    #[serde(with = "number")]
    pub complementarity: f64,
    /// Smallest multiplier of an inequality; `null` without any.
    pub min_multiplier: Option<f64>,
}

/// Error against an exact solution.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ErrorNorms {
    /// L² norm.
    #[serde(with = "number")]
    pub l2: f64,
    /// H¹ seminorm.
    #[serde(with = "number")]
    pub h1: f64,
    /// Energy norm.
    #[serde(with = "number")]
    pub energy: f64,
}

/// Wall-clock seconds of `solve` by phase.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Seconds {
    /// Mesh and matrices.
    pub assemble: f64,
    /// Factorisations and coarse problems.
    pub setup: f64,
    /// Iterations.
    pub solve: f64,
    /// u from λ.
    pub recover: f64,
    /// Everything, input and output included.
    pub total: f64,
}

/// One row of `table1`: an array of them is the command's JSON.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Table1Row {
    /// 1/H_b, bodies along each side of the square.
    pub bodies: usize,
    /// H_b/H_s, subdomains along each side of a body.
    pub subdomains: usize,
    /// H_s/h, elements along each side of a subdomain.
    pub elements: usize,
    /// Column (I): continuity on all of Γ.
    pub whole_interface: Table1Side,
    /// Column (II): continuity on the middle third Γ_0 of every face.
    pub middle_third: Table1Side,
}

/// One column of a row of `table1`. Every κ is a plain number.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Table1Side {
    /// Rows of B, B_loc and B_gl together.
    pub multipliers: usize,
    /// Rows of B_loc.
    pub local_multipliers: usize,
    /// Bodies that touch no Dirichlet side.
    pub floating_bodies: usize,
    /// Iterations with M_D.
    pub iterations: usize,
    /// Exact κ with M_D; `null` where it was not asked for.
    pub exact: Option<f64>,
    /// κ with M_D as CG estimates it.
    pub estimate: Option<f64>,
    /// Exact λ_min with M_D.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lambda_min: Option<f64>,
    /// Exact λ_max with M_D.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lambda_max: Option<f64>,
    /// The paper's printed numbers; `null` in a row that the paper does not have.
    pub paper: Option<PaperSide>,
    /// The same with M_C.
    pub coarse_corrected: CoarseCorrected,
}

/// The M_C part of [`Table1Side`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CoarseCorrected {
    /// Exact κ with M_C; `null` where it was not asked for.
    pub exact: Option<f64>,
    /// κ with M_C as CG estimates it.
    pub estimate: Option<f64>,
    /// Exact λ_min with M_C.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lambda_min: Option<f64>,
    /// Exact λ_max with M_C.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lambda_max: Option<f64>,
    /// Iterations with M_C.
    pub iterations: usize,
}

/// What the paper prints for one column of one row.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PaperSide {
    /// Condition number.
    pub cond: f64,
    /// Iterations.
    pub iter: usize,
}

/// What `compare` reports: facts about the problem, then one row per method and layout.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CompareReport {
    /// The scene's title.
    pub scene: String,
    /// Bodies.
    pub bodies: usize,
    /// Subdomains over all bodies.
    pub subdomains: usize,
    /// Unknowns of the assembled problem: one where tied bodies have several copies.
    pub dofs: usize,
    /// Relative residual ‖b − A u‖₂ / ‖b‖₂ of the assembled problem that every method was driven to.
    #[serde(with = "number")]
    pub rtol: f64,
    /// Cores that methods without a layout of their own were given.
    pub cores: usize,
    /// Rigid motions that nothing in the scene holds: the assembled problem has as many supports, which bear no force.
    #[serde(default)]
    pub supports: usize,
    /// Relative residual of the refined direct solution that errors are measured against; `null` if there is none.
    pub reference_residual: Option<f64>,
    /// In scenes with inequalities: what they are in the direct solution.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact: Option<CompareInequalities>,
    /// The methods.
    pub rows: Vec<CompareRow>,
}

/// One method in one layout.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct CompareRow {
    /// The method, such as `fetifeti`, `bddc`, `gamg`.
    pub method: String,
    /// Parts of the domain that the method sees; `null` for methods that see none.
    pub subdomains: Option<usize>,
    /// MPI ranks.
    pub ranks: usize,
    /// Threads per rank.
    pub threads: usize,
    /// κ as CG estimates it; `null` where there is none.
    pub kappa: Option<f64>,
    /// Iterations, of all contact steps; `null` for a direct solver or a run that failed.
    pub iterations: Option<usize>,
    /// Wall-clock time by phase.
    pub seconds: CompareSeconds,
    /// Largest resident memory over the ranks, summed, in MB of 10⁶ bytes.
    pub memory_mb: Option<f64>,
    /// The part of `memory_mb` that was there before the problem: program and libraries, once per rank.
    pub memory_at_start_mb: Option<f64>,
    /// Error in the energy norm against the assembled direct solution, relative.
    pub error: Option<f64>,
    /// Relative residual of the assembled problem that was reached.
    pub residual: Option<f64>,
    /// In scenes with inequalities: how they came out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact: Option<CompareContact>,
    /// Relative tolerance of the method's own residual with which that was reached.
    pub rtol: Option<f64>,
    /// Whether the residual was reached.
    pub converged: bool,
    /// PETSc's name for why the iteration ended.
    pub converged_reason: String,
    /// Options with which a second try was made after the first had failed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rescue: Option<String>,
    /// One sentence when the method could not run or did not converge.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub message: Option<String>,
}

/// Inequalities in the direct solution of `compare`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct CompareInequalities {
    /// Inequality rows.
    pub rows: usize,
    /// Those that hold with equality; `null` if there is no direct solution.
    pub active: Option<usize>,
    /// Active sets that the direct solution took.
    pub outer: Option<usize>,
    /// Largest violation, relative to the largest |u|.
    pub feasibility: Option<f64>,
    /// Smallest multiplier, relative to the largest; 0 where none pulls.
    pub min_multiplier: Option<f64>,
    /// Load steps of the scene, of which the last one is solved.
    pub load_steps: usize,
}

/// How the inequalities came out in one row of `compare`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct CompareContact {
    /// Active sets that were solved for; `null` for a method that solved the equations of the last one only.
    pub outer: Option<usize>,
    /// Rows of the last one.
    pub active: usize,
    /// Rows that hold here or in the direct solution, but not in both; rows that touch without a force do not count.
    pub differ: Option<usize>,
    /// Largest violation, relative to the largest |u|.
    pub feasibility: Option<f64>,
    /// Smallest multiplier, relative to the largest; 0 where none pulls.
    pub min_multiplier: Option<f64>,
}

/// Wall-clock seconds of one method in `compare`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct CompareSeconds {
    /// Mesh and matrices.
    pub assemble: Option<f64>,
    /// Factorisations, hierarchies, coarse problems.
    pub setup: Option<f64>,
    /// Iterations and recovery.
    pub solve: Option<f64>,
    /// Set-up and solve.
    pub total: Option<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{json, Value};

    fn report() -> SolveReport {
        SolveReport {
            scene: "two bodies".into(),
            dimension: 2,
            physics: "scalar".into(),
            components: 1,
            form: "plane scalar, Q1".into(),
            ranks: 2,
            threads: 1,
            bodies: 2,
            floating_bodies: 1,
            subdomains: 8,
            dofs: 100,
            multipliers: Multipliers {
                local: 16,
                global: 18,
                active: 18,
            },
            outer_iterations: 1,
            iterations: Iterations::new(vec![7, 4]),
            condition: Condition {
                exact: None,
                estimate: Some(Spectrum::new(2.0, 5.0)),
            },
            adaptive: None,
            kkt: Kkt {
                stationarity: 1e-9,
                feasibility: f64::NAN,
                complementarity: 0.0,
                min_multiplier: None,
            },
            energy: f64::INFINITY,
            contact: None,
            error: None,
            seconds: Seconds::default(),
            memory_mb: 12.5,
            converged_reason: "CONVERGED_RTOL".into(),
            ksp_type: "cg".into(),
            preconditioner: "dirichlet".into(),
            projector: "identity".into(),
            check: None,
            rtol: 1e-6,
        }
    }

    #[test]
    fn solve_report_has_the_promised_keys() {
        let value: Value = serde_json::from_str(&to_string(&report()).unwrap()).unwrap();
        let promised = [
            "scene",
            "dimension",
            "physics",
            "components",
            "ranks",
            "bodies",
            "floating_bodies",
            "subdomains",
            "dofs",
            "multipliers",
            "outer_iterations",
            "iterations",
            "condition",
            "kkt",
            "energy",
            "seconds",
            "memory_mb",
            "converged_reason",
        ];
        for key in promised {
            assert!(value.get(key).is_some(), "{key}");
        }
        assert_eq!(
            value["multipliers"],
            json!({"local": 16, "global": 18, "active": 18})
        );
        assert_eq!(value["iterations"], json!({"inner": [7, 4], "total": 11}));
        let estimate = json!({"lambda_min": 2.0, "lambda_max": 5.0, "kappa": 2.5});
        assert_eq!(
            value["condition"],
            json!({"exact": null, "estimate": estimate})
        );
        for key in ["assemble", "setup", "solve", "recover", "total"] {
            assert!(value["seconds"][key].is_number(), "{key}");
        }
        assert!(value.get("error").is_none() && value.get("contact").is_none());
    }

    #[test]
    fn what_is_not_finite_is_null_and_comes_back() {
        let text = to_string(&report()).unwrap();
        assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
        let value: Value = serde_json::from_str(&text).unwrap();
        assert!(value["energy"].is_null() && value["kkt"]["feasibility"].is_null());
        let back: SolveReport = serde_json::from_str(&text).unwrap();
        assert!(back.energy.is_nan() && back.kkt.feasibility.is_nan());
        assert_eq!(back.iterations, report().iterations);
        let nothing = CompareSeconds {
            assemble: Some(0.5),
            setup: Some(f64::NAN),
            solve: None,
            total: Some(1.0),
        };
        assert_eq!(
            serde_json::to_string(&nothing).unwrap(),
            r#"{"assemble":0.5,"setup":null,"solve":null,"total":1.0}"#
        );
    }

    #[test]
    fn error_norms_appear_where_known() {
        let mut known = report();
        known.error = Some(ErrorNorms {
            l2: 1.0,
            h1: 2.0,
            energy: 3.0,
        });
        let value: Value = serde_json::from_str(&to_string(&known).unwrap()).unwrap();
        assert_eq!(value["error"], json!({"l2": 1.0, "h1": 2.0, "energy": 3.0}));
    }

    #[test]
    fn table1_kappas_are_plain_numbers() {
        let side = Table1Side {
            multipliers: 34,
            local_multipliers: 16,
            floating_bodies: 0,
            iterations: 7,
            exact: Some(2.718541),
            estimate: Some(2.55),
            lambda_min: None,
            lambda_max: None,
            paper: Some(PaperSide {
                cond: 2.5536,
                iter: 7,
            }),
            coarse_corrected: CoarseCorrected {
                exact: Some(2.1189),
                estimate: None,
                lambda_min: None,
                lambda_max: None,
                iterations: 6,
            },
        };
        let expected = json!({
            "multipliers": 34, "local_multipliers": 16, "floating_bodies": 0, "iterations": 7,
            "exact": 2.718541, "estimate": 2.55, "paper": {"cond": 2.5536, "iter": 7},
            "coarse_corrected": {"exact": 2.1189, "estimate": null, "iterations": 6},
        });
        assert_eq!(serde_json::to_value(&side).unwrap(), expected);
    }
}

//! Settings of the linear method, with defaults (options with the prefix `fetifeti_`, see docs/options.md).

use super::jump::coupled::MANY;
pub use super::primal_constraints::{Averages, Primal};
use super::removed::refuse_removed;
use crate::{Error, Result};
use petsc::{named, Options, Session};

/// The preconditioner of the dual problem.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum PcType {
    /// No preconditioner: the projector alone.
    None,
    /// B_D K_ΓΓ B_Dᵀ: no interior solve.
    Lumped,
    /// M_D of \[Lee\].
    Dirichlet,
    /// M_C: M_D with the coarse functions of the bodies removed.
    CoarseCorrected,
}

/// The weights D of the scaled jump operator.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Scaling {
    /// D = 1: every copy counts the same.
    Multiplicity,
    /// D = ρ^γ.
    #[default]
    Rho,
    /// D = diag(K).
    Stiffness,
    /// D = S on every edge and face inside a body, as a matrix; diag(K) where bodies meet.
    Deluxe,
}

/// The coarse functions in Z_c. In the plane there are only vertices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum CoarseFunctions {
    /// Functions of vertices and of averages.
    All,
    /// Functions of vertices, with averages interpolated from them: fewer than half as many.
    Vertices,
}

/// The precision of M⁻¹.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Precision {
    /// Everything in double precision.
    Double,
    /// S in single precision where M_D and M_C multiply with it; all else in double.
    Mixed,
}

/// The form in which S and T are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Operators {
    /// The form that takes less time within the available memory.
    Auto,
    /// Dense matrices.
    Explicit,
    /// Sparse solves, wherever the vertices alone hold a subdomain.
    Implicit,
}

/// The bound on the spectrum where coefficients jump inside bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Adaptive {
    /// No bound.
    Off,
    /// Bound [`Adaptive::USUAL`] where coefficients vary inside a body, or where the first iterations show large
    /// eigenvalues.
    Auto,
    /// Bound τ > 1 in every body.
    Below(f64),
}

impl Adaptive {
    /// τ of `auto`.
    pub const USUAL: f64 = 10.0;

    /// The value as the option takes it.
    pub fn name(self) -> String {
        match self {
            Adaptive::Off => "off".into(),
            Adaptive::Auto => "auto".into(),
            Adaptive::Below(tau) => tau.to_string(),
        }
    }

    /// Parses `off`, `auto` or a number above 1; `None` for any other text.
    pub fn parse(text: &str) -> Option<Adaptive> {
        match text.trim().to_ascii_lowercase().as_str() {
            "off" => Some(Adaptive::Off),
            "auto" => Some(Adaptive::Auto),
            number => {
                let tau: f64 = number.parse().ok()?;
                (tau > 1.0 && tau.is_finite()).then_some(Adaptive::Below(tau))
            }
        }
    }
}

/// The weight Q of the projector P = I − Q G (Gᵀ Q G)⁻¹ Gᵀ.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ProjectorKind {
    /// Q = I, as in \[Lee\].
    Identity,
    /// Q = the diagonal of B_D diag(K) B_Dᵀ (superlumped).
    Diagonal,
    /// Q = M⁻¹; on the rows between bodies alone where their stiffnesses differ by more than 10⁷.
    Preconditioner,
    /// Q = M⁻¹ where some bodies float and bodies differ in stiffness or coefficients jump inside them, superlumped
    /// where many elastic bodies slide on each other and none are tied, else I.
    Auto,
}

/// Whether bodies that are tied for good, by whole faces whose nodes match, are one for the method.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum MergeKind {
    /// They stay bodies; the ties are rows between them, as in \[Lee\].
    None,
    /// They are one body of the method: FETI-DP holds them together. They keep their names and forces.
    Ties,
    /// [`Ties`](Self::Ties) for meshes in space ([`Problem::ragged`](crate::Problem::ragged)). Boxes stay bodies, and
    /// so do copies of each other, whose subdomains share factors.
    Auto,
}

named!(MergeKind { None = "none", Ties = "ties", Auto = "auto" });
named!(PcType { None = "none", Lumped = "lumped", Dirichlet = "dirichlet", CoarseCorrected = "coarse_corrected" });
named!(CoarseFunctions { All = "all", Vertices = "vertices" });
named!(Scaling { Multiplicity = "multiplicity", Rho = "rho", Stiffness = "stiffness", Deluxe = "deluxe" });
named!(Precision { Double = "double", Mixed = "mixed" });
named!(Operators { Auto = "auto", Explicit = "explicit", Implicit = "implicit" });
named!(ProjectorKind {
    Identity = "identity",
    Diagonal = "diagonal",
    Preconditioner = "preconditioner",
    Auto = "auto",
});

/// Settings of the linear method. Krylov settings live in the KSP (`fetifeti_ksp_`).
///
/// ```
/// use fetifeti::settings::{MethodSettings, PcType, Primal, ProjectorKind};
///
/// let settings = MethodSettings::default()
///     .pc_type(PcType::CoarseCorrected)
///     .primal(Primal::parse("vertices, faces").expect("names of constraints"))
///     .rtol(1e-10);
/// assert_eq!(settings.primal.name(), "vertices,faces");
/// assert_eq!(settings.projector, ProjectorKind::Auto);
/// // What the option takes: -fetifeti_pc_type coarse_corrected.
/// assert_eq!(PcType::CoarseCorrected.name(), "coarse_corrected");
/// assert_eq!(Primal::parse("corners"), None);
/// ```
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct MethodSettings {
    /// `fetifeti_pc_type`; `None` chooses coarse_corrected if there are several bodies, a body has several subdomains
    /// and the model of cost favours it; dirichlet otherwise.
    pub pc_type: Option<PcType>,
    /// `fetifeti_lifting`: the coarse functions of M_C. `None` means vertices if `pc_type` is chosen automatically, all
    /// if coarse_corrected is asked for.
    pub lifting: Option<CoarseFunctions>,
    /// `fetifeti_scaling`; `None` chooses stiffness where meshes in space are cut
    /// ([`Problem::ragged`](crate::Problem::ragged)), rho otherwise.
    pub scaling: Option<Scaling>,
    /// `fetifeti_scaling_gamma`, γ ∈ [1/2, ∞).
    pub gamma: f64,
    /// `fetifeti_precision`.
    pub precision: Precision,
    /// `fetifeti_operators`.
    pub operators: Operators,
    /// `fetifeti_memory`: megabytes that dense operators may take on this rank; `None` means half of the machine's
    /// memory divided by the ranks.
    pub memory: Option<usize>,
    /// `fetifeti_primal`.
    pub primal: Primal,
    /// `fetifeti_averages`; `None` means components, and for matrices of other programs what takes less time.
    pub averages: Option<Averages>,
    /// `fetifeti_projector`.
    pub projector: ProjectorKind,
    /// `fetifeti_merge`.
    pub merge: MergeKind,
    /// `fetifeti_adaptive`.
    pub adaptive: Adaptive,
    /// `fetifeti_adaptive_max`: largest number of vectors per body.
    pub adaptive_max: usize,
    /// `fetifeti_recycle`: number of directions that are kept for the next load.
    pub recycle: usize,
    /// `fetifeti_threads`: threads of this rank; `None` means the cores of the machine divided by the ranks on it.
    pub threads: Option<usize>,
    /// Blocks of rows between bodies that have more rows than this are scaled with a sparse factorisation. There is no
    /// option for it: both ways give the same operators after rounding.
    pub coupled: usize,
    /// Whether analyses of the patterns of subdomains are kept for matrices with other numbers
    /// ([`FetiFeti::renewed`](crate::FetiFeti::renewed)).
    pub keeps_analyses: bool,
    /// `fetifeti_check`: print the identities of the theory with their defects.
    pub check: bool,
    /// `fetifeti_certify`: a guaranteed bound of the error in the energy norm.
    pub certify: bool,
    /// `fetifeti_rtol auto`: the iteration stops where the discretisation error makes further digits useless.
    pub stops_early: bool,
    /// `fetifeti_spectrum`: exact extreme eigenvalues of the preconditioned operator.
    pub spectrum: bool,
    /// Relative residual of the dual problem at which the iteration stops, unless `fetifeti_ksp_rtol` sets another one.
    pub rtol: f64,
    /// Prefix of all options.
    pub prefix: String,
}

impl Default for MethodSettings {
    fn default() -> Self {
        MethodSettings {
            pc_type: None,
            lifting: None,
            scaling: None,
            gamma: 1.0,
            primal: Primal::default(),
            averages: None,
            precision: Precision::Double,
            operators: Operators::Auto,
            memory: None,
            projector: ProjectorKind::Auto,
            merge: MergeKind::Auto,
            adaptive: Adaptive::Auto,
            adaptive_max: 100,
            recycle: 0,
            threads: None,
            coupled: MANY,
            keeps_analyses: false,
            check: false,
            certify: false,
            stops_early: false,
            spectrum: false,
            rtol: 1e-6,
            prefix: "fetifeti_".into(),
        }
    }
}

impl MethodSettings {
    /// These settings, overridden by the options database; lists the options under `-help`.
    pub fn with_options(mut self, session: &Session) -> Result<MethodSettings> {
        let o = Options::new(session, &self.prefix);
        o.heading("FETI-FETI options")?;
        let help = "preconditioner of the dual problem";
        self.pc_type = o.named_or_auto("pc_type", self.pc_type, help)?;
        let help = "coarse functions that coarse_corrected takes away";
        self.lifting = o.named_or_auto("lifting", self.lifting, help)?;
        let help = "weights of the scaled jump operator";
        self.scaling = o.named_or_auto("scaling", self.scaling, help)?;
        let help = "exponent of rho in the scaling, at least 0.5";
        self.gamma = o.f64("scaling_gamma", self.gamma, help)?;
        if !(self.gamma >= 0.5 && self.gamma.is_finite()) {
            return Err(Error::input(format!(
                "option {} is {}, expected a number of at least 0.5",
                o.full_name("scaling_gamma"),
                self.gamma
            )));
        }
        let help = "digits of the preconditioner";
        self.precision = o.named("precision", self.precision, help)?;
        let help = "S and T as dense matrices or as sparse solves";
        self.operators = o.named("operators", self.operators, help)?;
        let help = "megabytes for dense operators on this rank; 0: half of what the machine has, divided by the ranks";
        self.memory = o.count("memory", self.memory, help)?;
        let help = "weight Q of the projector";
        self.projector = o.named("projector", self.projector, help)?;
        let help = "primal constraints inside the bodies (some of vertices, edges, faces)";
        let text = o.string("primal", &self.primal.name(), help)?;
        self.primal = Primal::parse(&text).ok_or_else(|| {
            Error::input(format!(
                "option {} is \"{text}\", expected some of {} with commas between them",
                o.full_name("primal"),
                Primal::NAMES.join(", ")
            ))
        })?;
        let help = "what edges and faces are averaged with";
        self.averages = o.named_or_auto("averages", self.averages, help)?;
        let help = "bodies that are tied for good: rows between them (none), one body (ties), or by the mesh (auto)";
        self.merge = o.named("merge", self.merge, help)?;
        let help = "bound on the condition number where coefficients jump inside bodies: off, auto or a number above 1";
        let text = o.string("adaptive", &self.adaptive.name(), help)?;
        self.adaptive = Adaptive::parse(&text).ok_or_else(|| {
            Error::input(format!(
                "option {} is \"{text}\", expected off, auto or a number above 1",
                o.full_name("adaptive")
            ))
        })?;
        let help = "deflation vectors per body at most";
        self.adaptive_max = o.usize("adaptive_max", self.adaptive_max, help)?;
        let help =
            "search directions kept for the next load with the same matrices and active rows";
        self.recycle = o.usize("recycle", self.recycle, help)?;
        let help = "threads per rank; 0: the cores of the machine divided by the ranks on it";
        self.threads = o.count("threads", self.threads, help)?;
        refuse_removed(&o)?;
        let help = "print the operator identities, which must be zero";
        self.check = o.bool("check", self.check, help)?;
        let help = "a guaranteed bound of the error in the energy norm, and estimates of the discretisation error";
        self.certify = o.bool("certify", self.certify, help)?;
        let help = "auto: stop where the discretisation error makes more digits useless; ksp_rtol: at that number";
        let text = o.string(
            "rtol",
            ["ksp_rtol", "auto"][usize::from(self.stops_early)],
            help,
        )?;
        self.stops_early = text == "auto";
        if !self.stops_early && text != "ksp_rtol" {
            return Err(Error::input(format!(
                "option {} is \"{text}\", expected auto, or ksp_rtol for the tolerance that {} says",
                o.full_name("rtol"),
                o.full_name("ksp_rtol")
            )));
        }
        let help = "exact extreme eigenvalues of the preconditioned operator";
        self.spectrum = o.bool("spectrum", self.spectrum, help)?;
        let krylov = "the Krylov method of the dual problem (any KSP option)";
        let coarse = "the primal problem of the bodies (any KSP or PC option)";
        let natural = "the natural coarse problem of floating bodies (any KSP or PC option)";
        let spectrum = "the eigensolver of -fetifeti_spectrum (any EPS option)";
        o.list("ksp_", "...", krylov)?;
        o.list("coarse_", "...", coarse)?;
        o.list("gtg_", "...", natural)?;
        o.list("eps_", "...", spectrum)?;
        Ok(self)
    }

    /// The coarse functions of M_C.
    pub fn coarse_functions(&self) -> CoarseFunctions {
        self.lifting.unwrap_or(match self.pc_type {
            None => CoarseFunctions::Vertices,
            Some(_) => CoarseFunctions::All,
        })
    }
}

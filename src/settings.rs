//! Settings of the linear method and of the contact loop, with defaults.

pub use crate::contact::{ContactSettings, ContactType, FrictionTuning, Tuning};
pub use crate::feti::settings::{
    Adaptive, Averages, CoarseFunctions, MergeKind, MethodSettings, Operators, PcType, Precision,
    Primal, ProjectorKind, Scaling,
};
use crate::Result;
use petsc::{Options, Session};

/// All settings. Krylov settings live in the KSP (`fetifeti_ksp_`).
///
/// ```
/// use fetifeti::settings::{ContactSettings, ContactType, MethodSettings, PcType, Settings};
///
/// let settings = Settings::default()
///     .method(MethodSettings::default().pc_type(PcType::Dirichlet))
///     .contact(ContactSettings::default().kind(ContactType::Smalbe));
/// assert_eq!(settings.method.rtol, 1e-6);
/// assert_eq!(settings.contact.max_it, 200);
/// // Settings of the linear method alone, with the contact loop as it is by default:
/// let settings = Settings::from(MethodSettings::default().rtol(1e-9));
/// assert_eq!(settings.contact.kind, ContactType::ActiveSet);
/// ```
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct Settings {
    /// The linear method.
    pub method: MethodSettings,
    /// `fetifeti_contact_`: the contact loop.
    pub contact: ContactSettings,
}

impl From<MethodSettings> for Settings {
    /// These settings, with the default contact loop.
    fn from(method: MethodSettings) -> Settings {
        Settings::default().method(method)
    }
}

impl Settings {
    /// These settings, overridden by the options database; lists the options under `-help`.
    ///
    /// # Errors
    /// An option with an invalid value.
    pub fn with_options(self, session: &Session) -> Result<Settings> {
        let method = self.method.with_options(session)?;
        let options = Options::new(session, &method.prefix);
        let contact = self.contact.with_options(&options)?;
        Ok(Settings { method, contact })
    }
}

/// For each setting a method of its name that changes it; those behind `optional` are `Option`s.
macro_rules! setters {
    ($settings:ident: $($name:ident: $kind:ty),*; optional $($may:ident: $known:ty),*) => {
        impl $settings {
            $(
                #[doc = concat!("These settings with another [`", stringify!($name), "`](Self#structfield.",
                    stringify!($name), ").")]
                pub fn $name(mut self, $name: $kind) -> Self {
                    self.$name = $name;
                    self
                }
            )*
            $(
                #[doc = concat!("These settings with another [`", stringify!($may), "`](Self#structfield.",
                    stringify!($may), "); `None` is the default.")]
                pub fn $may(mut self, $may: impl Into<Option<$known>>) -> Self {
                    self.$may = $may.into();
                    self
                }
            )*
        }
    };
}

setters!(Settings: method: MethodSettings, contact: ContactSettings; optional);

setters!(ContactSettings: kind: ContactType, max_it: usize, inner_rtol: f64, face_pc: bool; optional);

setters!(MethodSettings:
    gamma: f64, precision: Precision, operators: Operators, primal: Primal, projector: ProjectorKind,
    merge: MergeKind,
    adaptive: Adaptive, adaptive_max: usize, recycle: usize, coupled: usize, keeps_analyses: bool, check: bool,
    certify: bool, stops_early: bool, spectrum: bool, rtol: f64, prefix: String;
    optional
    pc_type: PcType, averages: Averages, lifting: CoarseFunctions, scaling: Scaling, memory: usize, threads: usize
);

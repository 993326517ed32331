//! Settings of the linear method and of the contact loop, with defaults.

use crate::contact::ContactSettings;
use crate::feti::MethodSettings;
use crate::Result;
use petsc::{Options, Session};

/// All settings. Krylov settings live in the KSP (`fetifeti_ksp_`).
///
/// ```
/// use fetifeti::{MethodSettings, PcType, Settings};
///
/// let settings = Settings {
///     method: MethodSettings {
///         pc_type: Some(PcType::Dirichlet),
///         ..MethodSettings::default()
///     },
///     ..Settings::default()
/// };
/// assert_eq!(settings.method.rtol, 1e-6);
/// // The contact loop as it is by default:
/// assert_eq!(Settings::from(settings.method.clone()).contact.max_it, 200);
/// ```
#[derive(Debug, Clone, Default)]
pub struct Settings {
    /// The linear method.
    pub method: MethodSettings,
    /// `fetifeti_contact_`: the contact loop.
    pub contact: ContactSettings,
}

impl From<MethodSettings> for Settings {
    /// These settings, with the default contact loop.
    fn from(method: MethodSettings) -> Settings {
        Settings {
            method,
            contact: ContactSettings::default(),
        }
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

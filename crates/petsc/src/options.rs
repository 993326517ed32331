//! PETSc's options database: reading, setting, help and typos.

use super::error::{c_string, rust_string};
use super::{Comm, Session};
use base::{Error, Result};
use petsc_sys::Flag;
use std::ffi::c_char;
use std::fmt::Display;
use std::ptr::null_mut;
use std::str::FromStr;

/// An enum whose values options take by name.
pub trait Named: Copy + PartialEq + 'static {
    /// The values and their names.
    const VALUES: &'static [(Self, &'static str)];
}

/// Makes an enum [`Named`]: the names of all of its variants, as options take them.
#[macro_export]
macro_rules! named {
    ($kind:ident { $($variant:ident = $name:literal),* $(,)? }) => {
        impl $crate::Named for $kind {
            const VALUES: &'static [(Self, &'static str)] = &[$(($kind::$variant, $name)),*];
        }

        impl $kind {
            /// The name as the option takes it.
            pub fn name(self) -> &'static str {
                match self { $($kind::$variant => $name),* }
            }
        }
    };
}

/// The options that begin with one prefix (`"fetifeti_"`; `""` for all).
///
/// Names are written without the dash and without the prefix: with the prefix `fetifeti_`, the name `ksp_rtol` is
/// `-fetifeti_ksp_rtol`. Reading an option marks it as used. The `get_*` methods return `None` where the option is not
/// set; those named after a type take a default and a line of help, which `-help` lists.
#[derive(Clone)]
pub struct Options {
    session: Session,
    prefix: String,
}

impl Options {
    /// The options of this prefix, written without a dash.
    pub fn new(session: &Session, prefix: &str) -> Options {
        Options {
            session: session.clone(),
            prefix: prefix.to_string(),
        }
    }

    /// The prefix.
    pub fn prefix(&self) -> &str {
        &self.prefix
    }

    /// The option as the user writes it.
    pub fn full_name(&self, name: &str) -> String {
        format!("-{}{name}", self.prefix)
    }

    /// Whether the option is set, with or without a value.
    pub fn has(&self, name: &str) -> Result<bool> {
        Ok(self.get_string(name)?.is_some())
    }

    /// The text of an option; empty where it was given without a value.
    pub fn get_string(&self, name: &str) -> Result<Option<String>> {
        let full = self.full_name(name);
        self.note_asked(&full);
        let full = c_string(&full);
        let mut buffer = vec![0 as c_char; 1 << 14];
        let mut set = Flag::of(false);
        petsc!(PetscOptionsGetString(
            null_mut(),
            std::ptr::null(),
            full.as_ptr(),
            buffer.as_mut_ptr(),
            buffer.len(),
            &mut set
        ))?;
        Ok(set.get().then(|| rust_string(buffer.as_ptr())))
    }

    /// A real number.
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) where the text is no finite number; likewise below.
    pub fn get_f64(&self, name: &str) -> Result<Option<f64>> {
        let value: Option<f64> = self.parse(name, "a number")?;
        match value {
            Some(v) if !v.is_finite() => Err(self.wrong(name, &v.to_string(), "a finite number")),
            value => Ok(value),
        }
    }

    /// An integer.
    pub fn get_i64(&self, name: &str) -> Result<Option<i64>> {
        self.parse(name, "an integer")
    }

    /// An integer that is not negative.
    pub fn get_usize(&self, name: &str) -> Result<Option<usize>> {
        self.parse(name, "an integer ≥ 0")
    }

    /// A truth value: true, yes, on, 1 or nothing; false, no, off, 0.
    pub fn get_bool(&self, name: &str) -> Result<Option<bool>> {
        let Some(text) = self.get_string(name)? else {
            return Ok(None);
        };
        match text.to_ascii_lowercase().as_str() {
            "" | "true" | "yes" | "on" | "1" => Ok(Some(true)),
            "false" | "no" | "off" | "0" => Ok(Some(false)),
            _ => Err(self.wrong(name, &text, "true or false")),
        }
    }

    /// One of the given names; returns its position.
    pub fn get_enum(&self, name: &str, names: &[&str]) -> Result<Option<usize>> {
        let Some(text) = self.get_string(name)? else {
            return Ok(None);
        };
        match names.iter().position(|n| n.eq_ignore_ascii_case(&text)) {
            Some(at) => Ok(Some(at)),
            None => Err(self.wrong(name, &text, &format!("one of {}", names.join(", ")))),
        }
    }

    /// A real number with default and help.
    pub fn f64(&self, name: &str, default: f64, help: &str) -> Result<f64> {
        let value = self.get_f64(name)?.unwrap_or(default);
        self.list(name, value, help)?;
        Ok(value)
    }

    /// An integer that is not negative, with default and help.
    pub fn usize(&self, name: &str, default: usize, help: &str) -> Result<usize> {
        let value = self.get_usize(name)?.unwrap_or(default);
        self.list(name, value, help)?;
        Ok(value)
    }

    /// A truth value with default and help.
    pub fn bool(&self, name: &str, default: bool, help: &str) -> Result<bool> {
        let value = self.get_bool(name)?.unwrap_or(default);
        self.list(name, value, help)?;
        Ok(value)
    }

    /// [`usize`](Self::usize) where 0 stands for `None`.
    pub fn count(&self, name: &str, default: Option<usize>, help: &str) -> Result<Option<usize>> {
        let value = self.usize(name, default.unwrap_or(0), help)?;
        Ok((value > 0).then_some(value))
    }

    /// A text with default and help.
    pub fn string(&self, name: &str, default: &str, help: &str) -> Result<String> {
        let value = self.get_string(name)?.unwrap_or_else(|| default.into());
        self.list(name, &value, help)?;
        Ok(value)
    }

    /// One of the given names, with default and help; returns its position.
    pub fn choice(&self, name: &str, names: &[&str], default: usize, help: &str) -> Result<usize> {
        let value = self.get_enum(name, names)?.unwrap_or(default);
        let help = format!("{help} (one of {})", names.join(", "));
        self.list(name, names[value], &help)?;
        Ok(value)
    }

    /// A value by its name, with default and help.
    pub fn named<T: Named>(&self, name: &str, default: T, help: &str) -> Result<T> {
        let names: Vec<&str> = T::VALUES.iter().map(|value| value.1).collect();
        let now = T::VALUES.iter().position(|value| value.0 == default);
        let at = self.choice(name, &names, now.unwrap_or(0), help)?;
        Ok(T::VALUES[at].0)
    }

    /// [`named`](Self::named) where `auto` stands for `None`.
    pub fn named_or_auto<T: Named>(
        &self,
        name: &str,
        default: Option<T>,
        help: &str,
    ) -> Result<Option<T>> {
        let names: Vec<&str> = T::VALUES.iter().map(|value| value.1).collect();
        let now = T::VALUES.iter().position(|value| Some(value.0) == default);
        let names = [&["auto"], &names[..]].concat();
        let at = self.choice(name, &names, now.map_or(0, |at| at + 1), help)?;
        Ok(at.checked_sub(1).map(|at| T::VALUES[at].0))
    }

    /// Lists an option under `-help` that is read elsewhere, once per run.
    pub fn list(&self, name: &str, value: impl Display, help: &str) -> Result<()> {
        self.print_help(
            &self.full_name(name),
            &format!("  {}: <{value}> {help}\n", self.full_name(name)),
        )
    }

    /// A heading under `-help` for the options that follow, once per run.
    pub fn heading(&self, title: &str) -> Result<()> {
        let line = "-".repeat(40);
        self.print_help(title, &format!("{line}\n{title}\n"))
    }

    fn print_help(&self, key: &str, text: &str) -> Result<()> {
        let mut wanted = Flag::of(false);
        petsc!(PetscOptionsHasHelp(null_mut(), &mut wanted))?;
        if wanted.get() && self.session.list_once(key) {
            let text = c_string(text);
            petsc!(ff_help_print(
                self.session.raw_comm(Comm::World),
                text.as_ptr()
            ))?;
        }
        Ok(())
    }

    /// Sets an option as if the user had written it; `None` for one without a value.
    pub fn set_value(&self, name: &str, value: Option<&str>) -> Result<()> {
        let full = c_string(&self.full_name(name));
        let value = value.map(c_string);
        let value = value.as_ref().map_or(std::ptr::null(), |v| v.as_ptr());
        petsc!(PetscOptionsSetValue(null_mut(), full.as_ptr(), value))
    }

    /// Sets an option unless the user has; tells whether it did.
    pub fn set_default(&self, name: &str, value: &str) -> Result<bool> {
        let full = c_string(&self.full_name(name));
        let mut set = Flag::of(false);
        // HasName asks without marking the option as used.
        petsc!(PetscOptionsHasName(
            null_mut(),
            std::ptr::null(),
            full.as_ptr(),
            &mut set
        ))?;
        if set.get() {
            return Ok(false);
        }
        self.set_value(name, Some(value))?;
        Ok(true)
    }

    /// Forgets an option.
    pub fn clear_value(&self, name: &str) -> Result<()> {
        let full = c_string(&self.full_name(name));
        petsc!(PetscOptionsClearValue(null_mut(), full.as_ptr()))
    }

    /// The unread options with this prefix: (name with its dash, value).
    pub fn left(&self) -> Result<Vec<(String, String)>> {
        let mut count = 0;
        let (mut names, mut values): (*mut *mut c_char, *mut *mut c_char) =
            (null_mut(), null_mut());
        petsc!(PetscOptionsLeftGet(
            null_mut(),
            &mut count,
            &mut names,
            &mut values
        ))?;
        let mut left = Vec::new();
        for k in 0..count as usize {
            // SAFETY: both arrays have `count` entries until they are restored.
            let (name, value) = unsafe { (*names.add(k), *values.add(k)) };
            let name = rust_string(name);
            if name.starts_with(&self.prefix) {
                left.push((format!("-{name}"), rust_string(value)));
            }
        }
        petsc!(PetscOptionsLeftRestore(
            null_mut(),
            &mut count,
            &mut names,
            &mut values
        ))?;
        Ok(left)
    }

    /// All options with this prefix that are set, by whomever: (name with its dash, value), in the order of the names.
    pub fn all(&self) -> Result<Vec<(String, String)>> {
        let mut text: *mut c_char = null_mut();
        petsc!(PetscOptionsGetAll(null_mut(), &mut text))?;
        let listed = rust_string(text);
        petsc!(ff_free(text.cast()))?;
        let mut all: Vec<(String, String)> = Vec::new();
        for word in listed.split_whitespace() {
            match word.strip_prefix('-') {
                Some(_) if word.parse::<f64>().is_err() => all.push((word.into(), String::new())),
                _ => {
                    let Some((_, value)) = all.last_mut() else {
                        continue;
                    };
                    *value = format!("{value} {word}").trim_start().to_string();
                }
            }
        }
        let start = format!("-{}", self.prefix);
        all.retain(|(name, _)| name.starts_with(&start));
        all.sort();
        Ok(all)
    }

    /// Whether the user has set any option with this prefix.
    pub fn any(&self) -> Result<bool> {
        let start = c_string(&format!("-{}", self.prefix));
        let mut found = Flag::of(false);
        petsc!(ff_options_any(start.as_ptr(), &mut found))?;
        Ok(found.get())
    }

    fn parse<T: FromStr>(&self, name: &str, expected: &str) -> Result<Option<T>> {
        let Some(text) = self.get_string(name)? else {
            return Ok(None);
        };
        match text.trim().parse() {
            Ok(value) => Ok(Some(value)),
            Err(_) => Err(self.wrong(name, &text, expected)),
        }
    }

    /// Notes that our own code has asked for an option.
    fn note_asked(&self, name: &str) {
        let mut asked = self.session.0.asked.borrow_mut();
        if !asked.contains(name) {
            asked.insert(name.to_string());
        }
    }

    fn wrong(&self, name: &str, found: &str, expected: &str) -> Error {
        Error::input(format!(
            "Option {} is \"{found}\"; expected {expected}.",
            self.full_name(name)
        ))
    }
}

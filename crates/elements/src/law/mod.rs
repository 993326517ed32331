//! Linear elastic laws.
//!
//! Elements know two: the isotropic law, whose stiffness is a few additions, and a general one by its 6 × 6 matrix
//! ([`Tangent`]). A law of its own constants is a type with [`Constants`] in a file of its own: it says what its matrix
//! along the axes of the material is.

// Tensors are written by their indices, as on paper.
#![allow(clippy::needless_range_loop)]

mod anisotropic;
mod orthotropic;
mod tangent;
mod transverse;

pub use anisotropic::Anisotropic;
pub use orthotropic::Orthotropic;
pub use tangent::{Tangent, COMPONENT, COMPONENTS};
pub use transverse::Transverse;

/// A law by constants along the axes of the material.
pub trait Constants {
    /// Its matrix along these axes; [`Law::check`] looks at its energy.
    ///
    /// # Errors
    /// One clause, without a full stop, on the constant that makes no sense and what was expected.
    fn tangent(&self) -> Result<Tangent, String>;
}

/// A law at a point, in the axes of space.
#[allow(clippy::large_enum_variant)] // made for every cell anew: it must not allocate
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Law {
    /// σ = λ (∇·u) I + 2μ ε(u).
    Isotropic {
        /// Young's modulus E.
        young: f64,
        /// Poisson's ratio ν.
        poisson: f64,
    },
    /// σ = C ε.
    General(Tangent),
}

impl Law {
    /// C.
    pub fn tangent(&self) -> Tangent {
        match *self {
            Law::Isotropic { young, poisson } => Tangent::isotropic(young, poisson),
            Law::General(tangent) => tangent,
        }
    }

    /// The number that weights the method and that stands for the stiffness: Young's modulus, in the mean over all
    /// directions.
    pub fn young(&self) -> f64 {
        match self {
            Law::Isotropic { young, .. } => *young,
            Law::General(tangent) => tangent.mean().0,
        }
    }

    /// Whether the numbers make sense.
    ///
    /// # Errors
    /// One clause, without a full stop, that says what was found and what was expected.
    pub fn check(&self) -> Result<(), String> {
        match *self {
            Law::Isotropic { young, poisson } => {
                let sound = young > 0.0;
                number("Young's modulus", young, sound, "a positive number")?;
                let sound = poisson > -1.0 && poisson < 0.5;
                let wanted = "a number above -1 and below 0.5";
                number("Poisson's ratio", poisson, sound, wanted)
            }
            Law::General(tangent) if !tangent.is_positive() => Err(
                "some strain has no positive energy with these constants, expected one for every strain".into(),
            ),
            Law::General(_) => Ok(()),
        }
    }
}

/// Whether a constant is finite and makes sense; the clause if it does not.
fn number(name: &str, value: f64, good: bool, wanted: &str) -> Result<(), String> {
    if good && value.is_finite() {
        Ok(())
    } else {
        Err(format!("{name} is {value}, expected {wanted}"))
    }
}

#[cfg(test)]
#[path = "../../tests/law/mod.rs"]
mod tests;

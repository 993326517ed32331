//! F, M⁻¹ and P as products, and as PETSc operators.

mod columns;
pub mod coupling;
pub mod dual;
mod jumps;
pub mod preconditioner;
pub mod products;
pub mod springs;
pub mod stiffness;
pub mod work;

//! F, M⁻¹ and P, as products and as PETSc sees them.

pub mod dual;
pub mod preconditioner;
pub mod products;
pub mod stiffness;
pub mod work;

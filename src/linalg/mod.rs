//! Small linear algebra that the whole crate uses: sparse matrices, dense kernels, vectors in space. No MPI, no PETSc.

pub mod csr;
pub mod dense;
pub mod lists;
pub mod nnls;
pub(crate) mod null_space;
pub(crate) mod orthogonal;
pub mod semidefinite;
pub mod single;
pub(crate) mod small;
pub mod sorted;
pub(crate) mod strained;
pub mod symmetric;
#[cfg(test)]
#[path = "../../tests/inside/linalg/testing.rs"]
pub(crate) mod testing;
#[cfg(feature = "cli")]
pub(crate) mod twice;
pub(crate) mod union_find;
pub(crate) mod vec3;

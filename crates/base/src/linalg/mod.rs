//! Small linear algebra that all crates use: sparse matrices, dense kernels, vectors in space. No MPI, no PETSc.

pub mod apart;
pub mod csr;
pub mod dense;
pub mod lists;
pub mod nnls;
pub mod null_space;
pub mod orthogonal;
pub mod semidefinite;
pub mod similar;
pub mod single;
pub mod small;
pub mod sorted;
pub mod strained;
pub mod symmetric;
pub mod twice;
pub mod union_find;
pub mod vec3;

//! Contact: answers of both methods against references that know nothing of them.

#[path = "../support/mod.rs"]
mod support;

mod bodies;
mod elastic;
mod oracle;
mod qp_reference;
mod random;
mod random_reference;
mod reference;

//! Contact: answers of both methods compared with independent references.

#[path = "../support/mod.rs"]
mod support;

mod axis;
mod bodies;
mod certified;
mod conic;
mod elastic;
mod failed;
mod friction;
mod friction_conic;
mod friction_gallery;
mod friction_limit;
mod friction_mortar;
mod friction_oracle;
mod friction_reference;
mod friction_renewed;
mod friction_walls;
mod jumps;
mod many;
mod mortar;
mod oracle;
mod qp;
mod qp_reference;
mod random;
mod random_reference;
mod reference;
mod tuning;
mod wave;
mod zero;

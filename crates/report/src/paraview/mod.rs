//! Files for ParaView: VTU with point and cell data, contact as point data, time series.

pub mod contact_fields;
pub mod friction_fields;
pub mod pvd;
pub mod vtu;

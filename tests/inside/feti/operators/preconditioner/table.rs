//! The table of preconditioners.

use super::*;
use petsc::Named;

/// Every name that an option takes leads to the kind of that name.
#[test]
fn each_name_has_its_own_line() {
    for &(pc_type, name) in PcType::VALUES {
        assert_eq!(kind(pc_type).pc_type, pc_type, "{name}");
    }
}

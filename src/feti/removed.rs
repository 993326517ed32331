//! Options that are not there any more.

use crate::{Error, Result};
use petsc::Options;

/// Refuses the options that chose other ways until 0.2: none was ever faster.
pub fn refuse_removed(o: &Options) -> Result<()> {
    if o.has("gtg_redundancy")? {
        return Err(Error::input(format!(
            "option {} is not there any more: ranks share one factor of GᵀQG, and copies of it were never faster",
            o.full_name("gtg_redundancy")
        )));
    }
    for (name, there) in [
        ("local_solver", "multifrontal"),
        ("local_ordering", "nd"),
        ("contact_start", "all"),
    ] {
        let asked = o.get_string(name)?.unwrap_or_default();
        if !["", "auto", there].contains(&&asked[..]) {
            return Err(Error::input(format!(
                "option {} is \"{asked}\", which is not there any more: it was never faster than {there}",
                o.full_name(name)
            )));
        }
    }
    Ok(())
}

//! A quick start where no launcher has started the process.
//!
//! Open MPI takes 0.3 s to begin: it starts a daemon that would start more processes, and looks for networks, one of
//! which is timed for 0.2 s. A process that is alone needs neither. Other MPI libraries ignore these settings.

/// Environment variables that launchers set for the processes that they start.
const LAUNCHED: [&str; 5] = [
    "OMPI_COMM_WORLD_SIZE",
    "PMIX_RANK",
    "PMIX_NAMESPACE",
    "PMI_RANK",
    "PMI_SIZE",
];

/// No daemon; messages of the process to itself go through memory. All processes without a daemon would share one
/// directory of the session, and one that ends removes it while another that begins makes its own in it: one start of
/// 300 failed where six ran at a time. A process that is alone writes nothing there.
const SETTINGS: [(&str, &str); 3] = [
    ("OMPI_MCA_ess_singleton_isolated", "1"),
    ("OMPI_MCA_orte_create_session_dirs", "0"),
    ("OMPI_MCA_pml", "ob1"),
];

/// Settings that stand in the environment while MPI begins. Programs that this one starts do not get them.
pub struct QuickStart(Vec<&'static str>);

impl QuickStart {
    /// Sets what the user has not set, if no launcher has started this process. No other thread may run.
    pub fn new() -> QuickStart {
        let known = |name: &str| std::env::var_os(name).is_some();
        let mut set = Vec::new();
        if !LAUNCHED.iter().any(|name| known(name)) {
            for (name, value) in SETTINGS.into_iter().filter(|s| !known(s.0)) {
                std::env::set_var(name, value);
                set.push(name);
            }
        }
        QuickStart(set)
    }
}

impl Drop for QuickStart {
    fn drop(&mut self) {
        self.0.iter().for_each(|name| std::env::remove_var(name));
    }
}

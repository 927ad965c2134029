//! How much memory there is for a run.

use std::sync::OnceLock;

use sysinfo::{MemoryRefreshKind, System};

/// Of what the process may use, in bytes, the share that a run plans with: the rest is for its threads and for others.
/// Unlimited where that cannot be told.
pub(crate) fn planned() -> u64 {
    static PLANNED: OnceLock<u64> = OnceLock::new();
    *PLANNED.get_or_init(|| {
        let mut most = address_space();
        if let Ok(mut system) = System::new() {
            system.refresh_memory_specifics(MemoryRefreshKind::nothing().with_ram());
            let machine = Some(system.total_memory()).filter(|&bytes| bytes > 0);
            let container = system.cgroup_limits().map(|limits| limits.total_memory);
            most = [most, machine, container].into_iter().flatten().min();
        }
        most.map_or(u64::MAX, |bytes| bytes / 4 * 3)
    })
}

/// What `ulimit -v` allows.
#[cfg(target_os = "linux")]
fn address_space() -> Option<u64> {
    rustix::process::getrlimit(rustix::process::Resource::As).current
}

#[cfg(not(target_os = "linux"))]
fn address_space() -> Option<u64> {
    None
}

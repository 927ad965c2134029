//! On what it was measured.

use crate::peers::Peers;

/// The paragraph above the table.
pub(crate) fn head(peers: Option<&Peers>, rounds: usize) -> String {
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let processor = field("/proc/cpuinfo", "model name").unwrap_or_else(|| "unknown processor".into());
    let load = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
    let load = load.split(' ').next().filter(|l| !l.is_empty()).unwrap_or("unknown");
    let peers = peers.map_or("no peers", |peers| &peers.names);
    format!(
        "{processor}, {cores} cores, {} {}; load average before it began {load}. ldwrap {}, {peers}. Medians of {rounds} \
         rounds in which all works of a line take turns (fewer where one takes seconds), in parentheses the least and \
         greatest; a ratio is ours over theirs of the same round. The horse has 96,966 triangles and is in memory unless said.",
        std::env::consts::OS,
        std::env::consts::ARCH,
        env!("CARGO_PKG_VERSION"),
    )
}

/// The value of the first line `name: value` of a file of the system.
pub(crate) fn field(file: &str, name: &str) -> Option<String> {
    let text = std::fs::read_to_string(file).ok()?;
    text.lines().find_map(|line| {
        let (key, value) = line.split_once(':')?;
        (key.trim() == name).then(|| value.trim().to_owned())
    })
}

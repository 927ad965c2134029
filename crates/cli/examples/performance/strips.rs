//! Segmenting and unfolding, against reading the file.

use ldwrap::segment::segment;
use ldwrap::unfold::unfold;

use crate::table::{Row, Target};
use crate::timing::{interleaved, timed};
use crate::{Bench, Outcome, read};

pub(crate) fn rows(bench: &mut Bench) -> Outcome<Vec<Row>> {
    let Some(peers) = &mut bench.peers else { return Ok(Vec::new()) };
    let mut strips = || Ok(timed(|| unfold(&bench.mesh, &segment(&bench.mesh, &Default::default()))).1);
    let mut reading = || {
        let (made, seconds) = timed(|| read(&bench.file));
        made.map(|_| seconds)
    };
    let mut theirs = || peers.time("open3d-read", 0);
    let [strips, reading, theirs] = interleaved(bench.rounds, [&mut strips, &mut reading, &mut theirs])?;
    let against = "Open3D reading the same PLY";
    Ok(vec![
        Row::ratio("segment and unfold the horse", &strips, against, &theirs, Target::AtMost(2.0)),
        Row::ratio("read and check the horse", &reading, against, &theirs, Target::None),
    ])
}

//! Other samplers, kept running in a Python with the mesh loaded, so that only their work is timed.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use crate::Outcome;

/// A Python that waits for commands; ends when dropped.
pub(crate) struct Peers {
    child: Child,
    commands: Option<ChildStdin>,
    answers: BufReader<ChildStdout>,
    /// The peers with their versions.
    pub(crate) names: String,
}

impl Peers {
    pub(crate) fn start(python: &Path, mesh: &Path) -> Outcome<Self> {
        let mut child = Command::new(python)
            .args(["-u", "-c", include_str!("peers.py")])
            .arg(mesh)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|e| format!("{}: {e}", python.display()))?;
        let answers = child.stdout.take().ok_or("the peers have no output")?;
        let commands = child.stdin.take();
        let mut peers = Self { child, commands, answers: BufReader::new(answers), names: String::new() };
        peers.names = peers.answer()?;
        Ok(peers)
    }

    pub(crate) fn has_point_cloud_utils(&self) -> bool {
        self.names.contains("point-cloud-utils")
    }

    /// How long a work of `peers.py` takes for `count` points, in seconds.
    pub(crate) fn time(&mut self, work: &str, count: usize) -> Outcome<f64> {
        let commands = self.commands.as_mut().ok_or("the peers have ended")?;
        writeln!(commands, "{work} {count}")?;
        commands.flush()?;
        let answer = self.answer()?;
        Ok(answer.parse().map_err(|_| format!("{work}: the answer {answer} is not a number"))?)
    }

    fn answer(&mut self) -> Outcome<String> {
        let mut line = String::new();
        loop {
            line.clear();
            if self.answers.read_line(&mut line)? == 0 {
                return Err("the peers ended before they answered; what they said is above".into());
            }
            if let Some(answer) = line.strip_prefix("= ") {
                return Ok(answer.trim().to_owned());
            }
        }
    }
}

impl Drop for Peers {
    fn drop(&mut self) {
        // The loop in Python ends with its input.
        self.commands = None;
        let _ = self.child.wait();
    }
}

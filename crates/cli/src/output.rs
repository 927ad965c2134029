//! Outputs: all of a run's files appear complete, or none does.
//!
//! Everything is written to temporary files beside the targets first, then to stdout, and only when that went well
//! are the files given their names. A file that was there before is replaced in that last step or not at all.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow};
use tempfile::{Builder, NamedTempFile};

use crate::exit::{Failure, Outcome};

/// Where an output goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Destination {
    /// Standard output, written as `-`.
    Stdout,
    /// A file.
    File(PathBuf),
}

impl Destination {
    /// What was typed: `-` is stdout.
    pub(crate) fn new(path: &Path) -> Self {
        if path.as_os_str() == "-" { Self::Stdout } else { Self::File(path.to_path_buf()) }
    }
}

/// An output whose name is known to be usable: where it goes and with which option it was asked for.
#[derive(Clone, Debug)]
struct Target {
    option: &'static str,
    destination: Destination,
}

/// Every output of a run, checked against one another before the work begins.
#[derive(Debug, Default)]
pub(crate) struct Targets(Vec<Target>);

impl Targets {
    /// Adds the output asked for with `option`.
    pub(crate) fn add(&mut self, option: &'static str, path: &Path) -> Destination {
        let destination = Destination::new(path);
        self.0.push(Target { option, destination: destination.clone() });
        destination
    }

    /// Makes sure that no two outputs, nor an output and the `input`, are the same file, and that every folder is
    /// there, so that a long run does not end in an error that could be seen at its start.
    pub(crate) fn check(&self, input: Option<&Path>) -> Outcome {
        for (i, target) in self.0.iter().enumerate() {
            for other in &self.0[..i] {
                if same(&target.destination, &other.destination) {
                    let place = match &target.destination {
                        Destination::Stdout => "stdout".to_owned(),
                        Destination::File(path) => path.display().to_string(),
                    };
                    return Err(Failure::wrong_use(format!(
                        "{} and {} both go to {place}: give each output a place of its own",
                        other.option, target.option
                    )));
                }
            }
            let Destination::File(path) = &target.destination else { continue };
            if input.is_some_and(|input| same_file(input, path)) {
                return Err(Failure::wrong_use(format!(
                    "{} would overwrite its own input {}: choose another name",
                    target.option,
                    path.display()
                )));
            }
        }
        for target in &self.0 {
            if let Destination::File(path) = &target.destination {
                check_file(path)?;
            }
        }
        Ok(())
    }
}

fn same(a: &Destination, b: &Destination) -> bool {
    match (a, b) {
        (Destination::Stdout, Destination::Stdout) => true,
        (Destination::File(a), Destination::File(b)) => same_file(a, b),
        _ => false,
    }
}

/// Whether two paths name one file, whether or not it exists yet. Devices may be named twice.
fn same_file(a: &Path, b: &Path) -> bool {
    let full = |path: &Path| {
        fs::canonicalize(path)
            .ok()
            .or_else(|| Some(fs::canonicalize(folder(path)).ok()?.join(path.file_name()?)))
    };
    if fs::metadata(a).is_ok_and(|m| !m.is_file()) {
        return false;
    }
    a == b || full(a).is_some_and(|a| Some(a) == full(b))
}

/// The folder that holds a file.
fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if parent.as_os_str().is_empty() => Path::new("."),
        Some(parent) => parent,
        None => path,
    }
}

fn check_file(path: &Path) -> anyhow::Result<()> {
    let name = path.display();
    match fs::metadata(path) {
        Ok(found) if found.is_dir() => {
            return Err(anyhow!("{name}: cannot be written: it is a folder; name a file in it"));
        }
        Ok(found) if found.is_file() && found.permissions().readonly() => {
            return Err(anyhow!("{name}: cannot be written: it is read-only"));
        }
        Ok(_) => return Ok(()),
        Err(_) => {}
    }
    let folder = folder(path);
    match fs::metadata(folder) {
        Ok(found) if found.is_dir() => Ok(()),
        Ok(_) => Err(anyhow!("{name}: cannot be written: {} is not a folder", folder.display())),
        Err(error) => Err(anyhow!(error)
            .context(format!("{name}: cannot be written: no folder {}; create it first", folder.display()))),
    }
}

/// The outputs of a run on their way.
#[derive(Default)]
pub(crate) struct Outputs {
    stdout: Vec<u8>,
    /// For devices and pipes, which cannot be replaced by renaming.
    direct: Vec<(PathBuf, Vec<u8>)>,
    /// Complete temporary files, with the names that were asked for and the files behind those names.
    renamed: Vec<Renamed>,
}

struct Renamed {
    name: PathBuf,
    file: NamedTempFile,
    target: PathBuf,
}

impl Outputs {
    /// Takes one complete output.
    pub(crate) fn stage(&mut self, destination: &Destination, bytes: Vec<u8>) -> anyhow::Result<()> {
        match destination {
            Destination::Stdout => self.stdout = bytes,
            Destination::File(name) if fs::metadata(name).is_ok_and(|found| !found.is_file()) => {
                self.direct.push((name.clone(), bytes));
            }
            Destination::File(name) => {
                // Through a link the file that it points to is replaced, not the link.
                let target = fs::canonicalize(name).unwrap_or_else(|_| name.clone());
                let file = temporary(folder(&target), &target, &bytes).with_context(|| failed(name))?;
                self.renamed.push(Renamed { name: name.clone(), file, target });
            }
        }
        Ok(())
    }

    /// Writes stdout and devices, then gives every file its name; returns the names.
    pub(crate) fn commit(self) -> anyhow::Result<Vec<PathBuf>> {
        write_stdout(&self.stdout)?;
        let mut names = Vec::new();
        for (name, bytes) in self.direct {
            let mut device = fs::OpenOptions::new().write(true).open(&name).with_context(|| failed(&name))?;
            device.write_all(&bytes).with_context(|| failed(&name))?;
            names.push(name);
        }
        for Renamed { name, file, target } in self.renamed {
            file.persist(target).map_err(|error| error.error).with_context(|| failed(&name))?;
            names.push(name);
        }
        Ok(names)
    }
}

fn failed(name: &Path) -> String {
    format!("{}: cannot be written", name.display())
}

/// Writes one file whole or not at all, whatever happens: it is complete on the disk, in the folder `temporaries` of the
/// same file system, before it gets its name.
pub(crate) fn write_safely(temporaries: &Path, target: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    let written = temporary(temporaries, target, bytes).and_then(|file| {
        file.as_file().sync_all()?;
        file.persist(target).map_err(|error| error.error)
    });
    written.map(drop).with_context(|| failed(target))
}

/// A complete temporary file in `folder`, with the permissions that `target` has or will have.
fn temporary(folder: &Path, target: &Path, bytes: &[u8]) -> io::Result<NamedTempFile> {
    let mut builder = Builder::new();
    builder.prefix(".ldwrap-");
    #[cfg(unix)]
    {
        // The system takes the umask off, as it does for any new file.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.tempfile_in(folder)?;
    file.write_all(bytes)?;
    file.flush()?;
    if let Ok(found) = fs::metadata(target) {
        file.as_file().set_permissions(found.permissions())?;
    }
    Ok(file)
}

/// Writes to stdout. A reader that stopped reading has what it wanted: no error.
pub(crate) fn write_stdout(bytes: &[u8]) -> anyhow::Result<()> {
    if bytes.is_empty() {
        return Ok(());
    }
    let mut stdout = io::stdout().lock();
    match stdout.write_all(bytes).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        result => result.context("stdout: cannot be written"),
    }
}

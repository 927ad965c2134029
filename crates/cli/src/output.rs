//! Outputs: all of a run's files appear complete, or none does.
//!
//! Everything is written to temporary files beside the targets first, points while they are made, then to stdout, and only when that went well
//! are the files given their names. A file that was there before is replaced in that last step or not at all.

use std::fs;
use std::io::{self, BufWriter, IntoInnerError, Read, Seek, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow};
use tempfile::{Builder, NamedTempFile, SpooledTempFile};

use crate::exit::{Failure, Outcome};
use crate::stop;

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
pub(crate) struct Outputs(Vec<Staged>);

/// An output that is being written, or complete, but not yet where it goes.
pub(crate) enum Staged {
    Stdout(Spool),
    /// A device or a pipe, which cannot be replaced by renaming.
    Device {
        name: PathBuf,
        bytes: Spool,
    },
    /// A temporary file, the name that was asked for, and the file behind that name.
    File {
        name: PathBuf,
        target: PathBuf,
        file: BufWriter<NamedTempFile>,
        /// Until the file has its name or is gone.
        _stopping: stop::Removes,
    },
}

/// Bytes in memory, and on the disk when they become many.
pub(crate) type Spool = BufWriter<SpooledTempFile>;

impl Staged {
    /// Begins an output.
    pub(crate) fn begin(destination: &Destination) -> anyhow::Result<Self> {
        /// So many bytes are kept in memory.
        const SPOOLED: usize = 1 << 26;
        let spool = || BufWriter::new(SpooledTempFile::new(SPOOLED));
        Ok(match destination {
            Destination::Stdout => Self::Stdout(spool()),
            Destination::File(name) if fs::metadata(name).is_ok_and(|found| !found.is_file()) => {
                Self::Device { name: name.clone(), bytes: spool() }
            }
            Destination::File(name) => {
                // Through a link the file that it points to is replaced, not the link.
                let target = fs::canonicalize(name).unwrap_or_else(|_| name.clone());
                Self::file(folder(&target), name, target.clone())?
            }
        })
    }

    /// Begins a file, in the folder `temporaries` of the same file system.
    pub(crate) fn begin_in(temporaries: &Path, target: &Path) -> anyhow::Result<Self> {
        Self::file(temporaries, target, target.to_path_buf())
    }

    fn file(temporaries: &Path, name: &Path, target: PathBuf) -> anyhow::Result<Self> {
        let file = temporary(temporaries, &target).with_context(|| failed(name))?;
        let stopping = stop::Removes::new(file.path());
        Ok(Self::File { name: name.to_path_buf(), target, file: BufWriter::new(file), _stopping: stopping })
    }

    /// What is said of an error on the way to it.
    pub(crate) fn failed(&self) -> String {
        match self {
            Self::Stdout(_) => "stdout: cannot be written".to_owned(),
            Self::Device { name, .. } | Self::File { name, .. } => failed(name),
        }
    }

    fn out(&mut self) -> &mut dyn Write {
        match self {
            Self::Stdout(bytes) | Self::Device { bytes, .. } => bytes,
            Self::File { file, .. } => file,
        }
    }

    /// Writes what goes to stdout or to a device.
    fn send(&mut self) -> anyhow::Result<()> {
        let failed = self.failed();
        match self {
            Self::Stdout(bytes) => {
                bytes.rewind().context(failed)?;
                copy_to_stdout(bytes.get_mut())
            }
            Self::Device { name, bytes } => {
                let mut send = || {
                    bytes.rewind()?;
                    io::copy(bytes.get_mut(), &mut fs::OpenOptions::new().write(true).open(&*name)?)
                };
                send().map(drop).context(failed)
            }
            Self::File { .. } => Ok(()),
        }
    }

    /// Gives a file its name; returns the name of all but stdout.
    fn name(self) -> anyhow::Result<Option<PathBuf>> {
        match self {
            Self::Stdout(_) => Ok(None),
            Self::Device { name, .. } => Ok(Some(name)),
            Self::File { name, target, file, _stopping } => {
                let file = file.into_inner().map_err(IntoInnerError::into_error);
                let named = file.and_then(|file| file.persist(target).map_err(|error| error.error));
                named.with_context(|| failed(&name))?;
                Ok(Some(name))
            }
        }
    }

    /// Gives a file its name, whatever happens: first all of it is on the disk. Returns its size.
    pub(crate) fn name_safely(mut self) -> anyhow::Result<u64> {
        let failed = self.failed();
        let mut size = 0;
        if let Self::File { file, .. } = &mut self {
            let synced = file.flush().and_then(|()| file.get_ref().as_file().sync_all());
            size = synced.and_then(|()| file.stream_position()).context(failed)?;
        }
        self.name().map(|_| size)
    }
}

impl Write for Staged {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.out().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out().flush()
    }
}

impl Outputs {
    /// Takes one complete output.
    pub(crate) fn stage(&mut self, destination: &Destination, bytes: &[u8]) -> anyhow::Result<()> {
        let mut staged = Staged::begin(destination)?;
        staged.write_all(bytes).with_context(|| staged.failed())?;
        self.add(staged)
    }

    /// Takes an output that is complete.
    pub(crate) fn add(&mut self, mut staged: Staged) -> anyhow::Result<()> {
        staged.flush().with_context(|| staged.failed())?;
        self.0.push(staged);
        Ok(())
    }

    /// Writes stdout and devices, then gives every file its name; returns the names.
    pub(crate) fn commit(mut self) -> anyhow::Result<Vec<PathBuf>> {
        self.0.iter_mut().try_for_each(Staged::send)?;
        let names: anyhow::Result<Vec<_>> = self.0.into_iter().map(Staged::name).collect();
        Ok(names?.into_iter().flatten().collect())
    }
}

fn failed(name: &Path) -> String {
    format!("{}: cannot be written", name.display())
}

/// Writes one file whole or not at all, whatever happens: it is complete on the disk, in the folder `temporaries` of the
/// same file system, before it gets its name.
pub(crate) fn write_safely(temporaries: &Path, target: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    let mut staged = Staged::begin_in(temporaries, target)?;
    staged.write_all(bytes).with_context(|| staged.failed())?;
    staged.name_safely().map(drop)
}

/// A temporary file in `folder`, with the permissions that `target` has or will have.
fn temporary(folder: &Path, target: &Path) -> io::Result<NamedTempFile> {
    let mut builder = Builder::new();
    builder.prefix(".ldwrap-");
    #[cfg(unix)]
    {
        // The system takes the umask off, as it does for any new file.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let file = builder.tempfile_in(folder)?;
    if let Ok(found) = fs::metadata(target) {
        file.as_file().set_permissions(found.permissions())?;
    }
    Ok(file)
}

/// Writes to stdout. A reader that stopped reading has what it wanted: no error.
pub(crate) fn write_stdout(bytes: &[u8]) -> anyhow::Result<()> {
    copy_to_stdout(&mut &*bytes)
}

fn copy_to_stdout(bytes: &mut dyn Read) -> anyhow::Result<()> {
    let mut stdout = io::stdout().lock();
    match io::copy(bytes, &mut stdout).and_then(|_| stdout.flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        result => result.context("stdout: cannot be written"),
    }
}

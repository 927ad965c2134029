//! Temporary files go when the program is told to stop (Ctrl-C, SIGTERM, SIGHUP).

use std::fs;
use std::path::{Path, PathBuf};
use std::process::exit;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The files that are being written.
static FILES: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// What shells report of a program that Ctrl-C ended.
const STOPPED: i32 = 130;

/// From now on nothing is left behind when the program is told to stop.
pub(crate) fn listen() {
    // Where they are ignored, as under nohup, they stay so, and where there are none nothing can be done.
    let _ = ctrlc::try_set_handler(|| {
        for file in files().iter() {
            let _ = fs::remove_file(file);
        }
        exit(STOPPED)
    });
}

/// While this lives, its file goes when the program is told to stop.
pub(crate) struct Removes(PathBuf);

impl Removes {
    pub(crate) fn new(file: &Path) -> Self {
        files().push(file.to_path_buf());
        Self(file.to_path_buf())
    }
}

impl Drop for Removes {
    fn drop(&mut self) {
        files().retain(|file| *file != self.0);
    }
}

fn files() -> MutexGuard<'static, Vec<PathBuf>> {
    FILES.lock().unwrap_or_else(PoisonError::into_inner)
}

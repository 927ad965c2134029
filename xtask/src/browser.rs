//! Where a Chromium or Chrome is that tests can drive.

use std::path::PathBuf;

use crate::Failure;
use crate::command::find_program;

const NAMES: [&str; 5] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome"];
#[cfg(target_os = "macos")]
const APPLICATION: &str = "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome";

/// The browser named by `LDWRAP_BROWSER`, else the first found.
///
/// # Errors
/// When there is none; the message says what to install.
pub fn find() -> Result<PathBuf, Failure> {
    if let Some(path) = std::env::var_os("LDWRAP_BROWSER").map(PathBuf::from) {
        return if path.is_file() {
            Ok(path)
        } else {
            Err(Failure(format!("LDWRAP_BROWSER is {}, which is no file", path.display())))
        };
    }
    let found = NAMES.iter().find_map(|name| find_program(name));
    #[cfg(target_os = "macos")]
    let found = found.or_else(|| Some(PathBuf::from(APPLICATION)).filter(|p| p.is_file()));
    found.ok_or_else(|| {
        Failure("no Chromium or Chrome was found: install one, or set LDWRAP_BROWSER to its program".into())
    })
}

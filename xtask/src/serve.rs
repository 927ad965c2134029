//! A static file server for this machine: enough to show the page and to test it.

use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

/// A running server; it ends with the process, or when it is told to stop.
#[derive(Debug)]
pub struct Server {
    address: SocketAddr,
    thread: JoinHandle<()>,
    stopped: Arc<AtomicBool>,
}

impl Server {
    /// Serves the files of `folder` on the loopback address; port 0 takes any free one.
    ///
    /// # Errors
    /// When the port is taken.
    pub fn start(folder: &Path, port: u16) -> std::io::Result<Self> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
        let address = listener.local_addr()?;
        let folder = folder.to_owned();
        let stopped = Arc::new(AtomicBool::new(false));
        let stop = Arc::clone(&stopped);
        let thread = std::thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                if stop.load(Ordering::Relaxed) {
                    return;
                }
                let (folder, stop) = (folder.clone(), Arc::clone(&stop));
                // A broken connection concerns only the client that broke it.
                std::thread::spawn(move || answer(stream, &folder, &stop));
            }
        });
        Ok(Self { address, thread, stopped })
    }

    /// The address of the start page.
    pub fn address(&self) -> String {
        format!("http://{}/", self.address)
    }

    /// Stops: no further request is answered.
    pub fn stop(self) {
        self.stopped.store(true, Ordering::Relaxed);
        // It wakes up for one more connection; when it has ended already there is nothing to wake.
        drop(TcpStream::connect(self.address));
        self.wait();
    }

    /// Waits until the process is ended.
    pub fn wait(self) {
        // The thread serves for ever; it could only end by a panic, which is then reported already.
        let _ = self.thread.join();
    }
}

fn answer(stream: TcpStream, folder: &Path, stopped: &AtomicBool) -> std::io::Result<()> {
    stream.set_read_timeout(Some(Duration::from_secs(30)))?;
    let mut reader = BufReader::new(stream.try_clone()?);
    let mut stream = stream;
    loop {
        let mut request = String::new();
        if reader.read_line(&mut request)? == 0 {
            return Ok(());
        }
        let mut header = String::new();
        while reader.read_line(&mut header)? > 2 {
            header.clear();
        }
        if stopped.load(Ordering::Relaxed) {
            return Ok(());
        }
        let mut words = request.split(' ');
        let (method, target) = (words.next().unwrap_or(""), words.next().unwrap_or("/"));
        let (status, kind, body) = match (method, file_of(folder, target)) {
            ("GET" | "HEAD", Some(path)) => ("200 OK", kind_of(&path), fs::read(&path)?),
            ("GET" | "HEAD", None) => ("404 Not Found", "text/plain", b"not found".to_vec()),
            _ => ("405 Method Not Allowed", "text/plain", b"only GET".to_vec()),
        };
        write!(
            stream,
            "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\nCache-Control: no-cache\r\n\r\n",
            body.len()
        )?;
        if method != "HEAD" {
            stream.write_all(&body)?;
        }
        stream.flush()?;
    }
}

/// The file that a request names; `None` outside the folder or where there is none.
fn file_of(folder: &Path, target: &str) -> Option<PathBuf> {
    let path = target.split(['?', '#']).next()?.trim_start_matches('/');
    let relative = Path::new(if path.is_empty() { "index.html" } else { path });
    if !relative.components().all(|c| matches!(c, Component::Normal(_))) {
        return None;
    }
    Some(folder.join(relative)).filter(|p| p.is_file())
}

fn kind_of(path: &Path) -> &'static str {
    match path.extension().and_then(|e| e.to_str()) {
        Some("html") => "text/html; charset=utf-8",
        Some("js" | "mjs") => "text/javascript; charset=utf-8",
        Some("wasm") => "application/wasm",
        Some("json" | "webmanifest") => "application/json",
        Some("svg") => "image/svg+xml",
        Some("png") => "image/png",
        Some("css") => "text/css; charset=utf-8",
        _ => "application/octet-stream",
    }
}

#[cfg(test)]
mod tests {
    use super::file_of;
    use std::path::Path;

    #[test]
    fn only_files_of_the_folder_are_served() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
        assert_eq!(file_of(folder, "/Cargo.toml?x=1"), Some(folder.join("Cargo.toml")));
        assert_eq!(file_of(folder, "/../Cargo.toml"), None);
        assert_eq!(file_of(folder, "/src/../Cargo.toml"), None);
        assert_eq!(file_of(folder, "/nothing.txt"), None);
    }
}

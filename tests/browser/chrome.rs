//! A headless Chromium, driven by the DevTools protocol: just the calls that the tests need.

use std::fs;
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tungstenite::{Message, WebSocket, client};

/// How long anything may take before the test fails. Software rendering on a busy machine is slow.
const PATIENCE: Duration = Duration::from_secs(60);

/// What a page looks like to a person.
#[derive(Clone, Copy)]
pub(crate) struct Screen {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) dark: bool,
    pub(crate) phone: bool,
    /// Pixels of the screen in one of the page's; 2 is a page at 200 %, or a phone.
    pub(crate) scale: u32,
}

/// A desktop in light colours.
pub(crate) const DESKTOP: Screen = Screen { width: 1400, height: 860, dark: false, phone: false, scale: 1 };

/// A browser with one page.
pub(crate) struct Chrome {
    process: Child,
    folder: tempfile::TempDir,
    socket: WebSocket<TcpStream>,
    session: String,
    calls: u64,
    problems: Vec<String>,
    workers: Vec<String>,
}

impl Chrome {
    /// Starts a browser with an empty page.
    pub(crate) fn start(program: &Path, screen: Screen) -> Self {
        let folder = tempfile::tempdir().expect("a folder for the browser's profile");
        let process = Command::new(program)
            .args(["--headless=new", "--remote-debugging-port=0", "--no-first-run", "--disable-extensions"])
            .args(["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"])
            // A test machine may forbid the browser's own sandbox and have a small /dev/shm.
            .args(["--no-sandbox", "--disable-dev-shm-usage", "--hide-scrollbars"])
            .arg(format!("--user-data-dir={}", folder.path().join("profile").display()))
            .arg("about:blank")
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap_or_else(|e| panic!("{}: {e}", program.display()));
        let address = devtools_address(&folder.path().join("profile/DevToolsActivePort"));
        let stream = TcpStream::connect(&address.0).expect("the browser's DevTools port");
        stream.set_read_timeout(Some(PATIENCE)).expect("a socket with a time limit");
        let (socket, _) =
            client(format!("ws://{}{}", address.0, address.1), stream).expect("the DevTools socket");
        let mut chrome = Self {
            process,
            folder,
            socket,
            session: String::new(),
            calls: 0,
            problems: Vec::new(),
            workers: Vec::new(),
        };
        let target = chrome.call("Target.createTarget", json!({"url": "about:blank"}));
        let attached =
            chrome.call("Target.attachToTarget", json!({"targetId": target["targetId"], "flatten": true}));
        chrome.session = attached["sessionId"].as_str().expect("a session").to_owned();
        for domain in ["Page.enable", "Runtime.enable", "Log.enable"] {
            chrome.call(domain, json!({}));
        }
        let Screen { width, height, dark, phone, scale } = screen;
        let metrics = json!({"width": width, "height": height, "deviceScaleFactor": scale, "mobile": phone});
        chrome.call("Emulation.setDeviceMetricsOverride", metrics);
        let scheme = json!([{"name": "prefers-color-scheme", "value": if dark { "dark" } else { "light" }}]);
        chrome.call("Emulation.setEmulatedMedia", json!({"features": scheme}));
        let downloads = chrome.downloads();
        fs::create_dir_all(&downloads).expect("a folder for downloads");
        chrome.call("Browser.setDownloadBehavior", json!({"behavior": "allow", "downloadPath": downloads}));
        chrome
    }

    /// Calls a method of the protocol and returns its result.
    pub(crate) fn call(&mut self, method: &str, params: Value) -> Value {
        self.calls += 1;
        let id = self.calls;
        let mut message = json!({"id": id, "method": method, "params": params});
        if !self.session.is_empty() && !method.starts_with("Browser.") {
            message["sessionId"] = self.session.clone().into();
        }
        self.socket.send(Message::text(message.to_string())).expect("the browser listens");
        loop {
            let message = self.read();
            if message["id"] == id {
                assert!(message["error"].is_null(), "{method}: {}", message["error"]);
                return message["result"].clone();
            }
        }
    }

    fn read(&mut self) -> Value {
        let text = self.socket.read().expect("the browser answers in time");
        let message: Value = serde_json::from_str(text.to_text().unwrap_or("{}")).unwrap_or_default();
        let params = &message["params"];
        match message["method"].as_str() {
            Some("Target.attachedToTarget") if params["targetInfo"]["type"] == "worker" => {
                self.workers.push(params["sessionId"].as_str().unwrap_or_default().to_owned());
            }
            Some("Runtime.exceptionThrown") => self.problems.push(params["exceptionDetails"].to_string()),
            Some("Runtime.consoleAPICalled") if params["type"] == "error" => {
                self.problems.push(params["args"].to_string())
            }
            Some("Log.entryAdded") if params["entry"]["level"] == "error" => {
                self.problems.push(params["entry"].to_string())
            }
            _ => {}
        }
        message
    }

    /// Breaks the page's workers as a defect in them would: with an error that nobody catches.
    pub(crate) fn break_workers(&mut self) {
        let attach = json!({"autoAttach": true, "waitForDebuggerOnStart": false, "flatten": true});
        self.call("Target.setAutoAttach", attach);
        let start = Instant::now();
        while self.workers.is_empty() {
            assert!(start.elapsed() < PATIENCE, "no worker");
            self.evaluate("0");
        }
        for worker in std::mem::take(&mut self.workers) {
            let page = std::mem::replace(&mut self.session, worker);
            self.evaluate("void setTimeout(() => { throw new Error('broken by the test') })");
            self.session = page;
        }
    }

    /// Errors that the page has reported so far.
    pub(crate) fn problems(&mut self) -> Vec<String> {
        // A call lets events that wait come in.
        self.evaluate("0");
        self.problems.clone()
    }

    /// Opens an address.
    pub(crate) fn open(&mut self, address: &str) {
        self.call("Page.navigate", json!({"url": address}));
    }

    /// The value of a JavaScript expression; promises are awaited.
    pub(crate) fn evaluate(&mut self, expression: &str) -> Value {
        let params = json!({"expression": expression, "awaitPromise": true, "returnByValue": true});
        let result = self.call("Runtime.evaluate", params);
        assert!(result["exceptionDetails"].is_null(), "{expression}: {}", result["exceptionDetails"]);
        result["result"]["value"].clone()
    }

    /// Waits until a JavaScript expression is true.
    pub(crate) fn wait_for(&mut self, expression: &str) {
        let start = Instant::now();
        while self.evaluate(&format!("!!({expression})")) != json!(true) {
            if start.elapsed() > PATIENCE {
                let state = self.evaluate("window.ldwrap?.inspect() ?? document.body.innerText");
                panic!("never true: {expression}; {state}; errors: {:?}", self.problems);
            }
            sleep(Duration::from_millis(100));
        }
    }

    /// The page's own state.
    pub(crate) fn state(&mut self) -> Value {
        let text = self.evaluate("window.ldwrap?.inspect() ?? ''");
        serde_json::from_str(text.as_str().unwrap_or("")).unwrap_or_default()
    }

    /// Waits until the page's own state `s` fulfils a JavaScript expression, and returns the state.
    pub(crate) fn wait_for_state(&mut self, expression: &str) -> Value {
        self.wait_for(&format!("(s => s && ({expression}))(JSON.parse(window.ldwrap?.inspect() ?? 'null'))"));
        self.state()
    }

    /// The middle of a control, found by the name that assistive technology reads.
    pub(crate) fn place_of(&mut self, name: &str) -> (f64, f64) {
        let find = format!(
            "[...document.querySelectorAll('#mirror > div')].find(e => e.ariaLabel === {})",
            json!(name)
        );
        self.wait_for(&find);
        let place = self.evaluate(&format!(
            "(r => [r.x + r.width / 2, r.y + r.height / 2])(({find}).getBoundingClientRect())"
        ));
        (place[0].as_f64().expect("x"), place[1].as_f64().expect("y"))
    }

    /// Moves the pointer.
    pub(crate) fn move_to(&mut self, (x, y): (f64, f64)) {
        self.call("Input.dispatchMouseEvent", json!({"type": "mouseMoved", "x": x, "y": y}));
    }

    /// Presses or releases the pointer's main button.
    pub(crate) fn press(&mut self, (x, y): (f64, f64), down: bool) {
        let kind = if down { "mousePressed" } else { "mouseReleased" };
        let params = json!({"type": kind, "x": x, "y": y, "button": "left", "buttons": u8::from(down), "clickCount": 1});
        self.call("Input.dispatchMouseEvent", params);
    }

    /// Moves the pointer with its main button held.
    pub(crate) fn drag_to(&mut self, (x, y): (f64, f64)) {
        let params = json!({"type": "mouseMoved", "x": x, "y": y, "button": "left", "buttons": 1});
        self.call("Input.dispatchMouseEvent", params);
    }

    /// Clicks a control.
    pub(crate) fn click(&mut self, name: &str) {
        let place = self.place_of(name);
        self.move_to(place);
        self.press(place, true);
        self.press(place, false);
    }

    /// Activates a control as assistive technology does, also where it is scrolled out of sight.
    pub(crate) fn activate(&mut self, name: &str) {
        self.place_of(name);
        self.evaluate(&format!(
            "[...document.querySelectorAll('#mirror > div')].find(e => e.ariaLabel === {}).click()",
            json!(name)
        ));
    }

    /// Turns the wheel.
    pub(crate) fn scroll(&mut self, (x, y): (f64, f64), by: f64) {
        let params = json!({"type": "mouseWheel", "x": x, "y": y, "deltaX": 0, "deltaY": by});
        self.call("Input.dispatchMouseEvent", params);
    }

    /// Presses a key, by the names of its meaning and of its place in the DOM.
    pub(crate) fn key(&mut self, key: &str, code: &str) {
        for kind in ["rawKeyDown", "keyUp"] {
            self.call("Input.dispatchKeyEvent", json!({"type": kind, "key": key, "code": code}));
        }
    }

    /// Drops a file on the middle of the page, as from a file manager.
    pub(crate) fn drop_file(&mut self, path: &Path) {
        let data = json!({"items": [], "files": [path], "dragOperationsMask": 1});
        for kind in ["dragEnter", "dragOver", "drop"] {
            self.call("Input.dispatchDragEvent", json!({"type": kind, "x": 600, "y": 400, "data": data}));
        }
    }

    /// Gives a file to a control of the document that asks for one, found by a CSS selector.
    pub(crate) fn choose_file(&mut self, selector: &str, path: &Path) {
        let document = self.call("DOM.getDocument", json!({}));
        let place = json!({"nodeId": document["root"]["nodeId"], "selector": selector});
        let found = self.call("DOM.querySelector", place);
        self.call("DOM.setFileInputFiles", json!({"nodeId": found["nodeId"], "files": [path]}));
    }

    fn downloads(&self) -> PathBuf {
        self.folder.path().join("downloads")
    }

    /// Waits for a downloaded file and returns its bytes.
    pub(crate) fn downloaded(&self, name: &str) -> Vec<u8> {
        let start = Instant::now();
        loop {
            if let Ok(bytes) = fs::read(self.downloads().join(name)) {
                return bytes;
            }
            let found: Vec<_> = fs::read_dir(self.downloads())
                .expect("the folder")
                .flatten()
                .map(|e| e.file_name())
                .collect();
            assert!(start.elapsed() < PATIENCE, "{name} was not downloaded, but {found:?}");
            sleep(Duration::from_millis(100));
        }
    }

    /// A picture of the page as PNG.
    pub(crate) fn screenshot(&mut self) -> Vec<u8> {
        let shot = self.call("Page.captureScreenshot", json!({"format": "png"}));
        decode_base64(shot["data"].as_str().expect("a picture"))
    }
}

impl Drop for Chrome {
    fn drop(&mut self) {
        // Both fail only when the browser is gone already.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// The port's address and the path that the browser writes to its profile.
fn devtools_address(file: &Path) -> (String, String) {
    let start = Instant::now();
    loop {
        if let Ok(text) = fs::read_to_string(file)
            && let Some((port, path)) = text.trim().split_once('\n')
        {
            return (format!("127.0.0.1:{port}"), path.to_owned());
        }
        assert!(start.elapsed() < PATIENCE, "the browser did not start");
        sleep(Duration::from_millis(50));
    }
}

fn decode_base64(text: &str) -> Vec<u8> {
    let value = |c: u8| match c {
        b'A'..=b'Z' => c - b'A',
        b'a'..=b'z' => c - b'a' + 26,
        b'0'..=b'9' => c - b'0' + 52,
        b'+' => 62,
        _ => 63,
    };
    let mut bytes = Vec::with_capacity(text.len() * 3 / 4);
    for group in text.trim_end_matches('=').as_bytes().chunks(4) {
        let bits =
            group.iter().enumerate().fold(0u32, |bits, (k, c)| bits | u32::from(value(*c)) << (18 - 6 * k));
        bytes.extend_from_slice(&bits.to_be_bytes()[1..group.len()]);
    }
    bytes
}

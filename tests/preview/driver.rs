//! A WebDriver client for chromedriver, and a running preview.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};
use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// `kinora preview` of a file in a folder of its own.
pub struct Preview {
    folder: TempDir,
    process: Child,
    pub address: String,
}

impl Preview {
    pub fn start(text: &str, options: &[&str]) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("a.ron"), text).expect("a disk");
        let mut command = Command::new(env!("CARGO_BIN_EXE_kinora"));
        command.args(["preview", "a.ron"]).args(options).current_dir(folder.path()).stdout(Stdio::piped());
        let mut process = command.spawn().expect("a process");
        let mut line = String::new();
        BufReader::new(process.stdout.take().expect("an output")).read_line(&mut line).expect("a line");
        let at = line.find("http://").expect("an address");
        Self { folder, process, address: line[at..].trim().to_owned() }
    }

    pub fn save(&self, text: &str) {
        fs::write(self.folder.path().join("a.ron"), text).expect("a disk");
    }

    /// What `kinora check` says.
    pub fn check(&self) -> String {
        let mut command = Command::new(env!("CARGO_BIN_EXE_kinora"));
        let checked = command.args(["check", "a.ron"]).current_dir(self.folder.path()).output();
        String::from_utf8_lossy(&checked.expect("a process").stderr).trim_end().to_owned()
    }

    pub fn text(&self) -> String {
        fs::read_to_string(self.folder.path().join("a.ron")).expect("a file")
    }
}

impl Drop for Preview {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// A browser.
pub struct Driver {
    process: Child,
    port: u16,
    session: String,
    _profile: TempDir,
}

impl Drop for Driver {
    fn drop(&mut self) {
        let _ = self.request("DELETE", &format!("/session/{}", self.session), None);
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

impl Driver {
    /// Starts a browser. None if there is none.
    pub fn start() -> Option<Self> {
        let port = TcpListener::bind("127.0.0.1:0").ok()?.local_addr().ok()?.port();
        let mut command = Command::new("chromedriver");
        command.arg(format!("--port={port}")).stdout(Stdio::null()).stderr(Stdio::null());
        let process = command.spawn().ok()?;
        let profile = tempfile::tempdir().ok()?;
        let mut driver = Self { process, port, session: String::new(), _profile: profile };
        let start = Instant::now();
        while TcpStream::connect(("127.0.0.1", port)).is_err() {
            if start.elapsed() > Duration::from_secs(20) {
                return None;
            }
            sleep(Duration::from_millis(50));
        }
        let profile = format!("--user-data-dir={}", driver._profile.path().display());
        let arguments = [
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-quic",
            "--no-first-run",
            "--disable-background-networking",
            "--window-size=1440,960",
            "--force-color-profile=srgb",
            &profile,
        ];
        let options =
            json!({ "capabilities": { "alwaysMatch": { "goog:chromeOptions": { "args": arguments } } } });
        let answer = driver.request("POST", "/session", Some(options))?;
        driver.session = answer["value"]["sessionId"].as_str()?.to_owned();
        Some(driver)
    }

    pub fn open(&self, address: &str) {
        self.command("url", json!({ "url": address }));
        self.run("window.onerror = (m) => { window.faults = (window.faults || '') + m }");
    }

    /// Runs a program in the page and returns its value.
    pub fn run(&self, program: &str) -> Value {
        self.command("execute/sync", json!({ "script": program, "args": [] }))
    }

    /// Waits until a program returns true.
    pub fn until(&self, program: &str) {
        let start = Instant::now();
        while self.run(program) != json!(true) {
            if start.elapsed() > Duration::from_secs(60) {
                panic!("not in time: {program}: {}", self.run("return JSON.stringify(state)"));
            }
            sleep(Duration::from_millis(5));
        }
    }

    /// Types keys.
    pub fn keys(&self, keys: &str) {
        let actions: Vec<Value> = keys
            .chars()
            .flat_map(|key| {
                ["keyDown", "keyUp"].map(|kind| json!({ "type": kind, "value": key.to_string() }))
            })
            .collect();
        self.command("actions", json!({ "actions": [{ "type": "key", "id": "keys", "actions": actions }] }));
    }

    /// Drags over the picture, between places as shares of its size.
    pub fn drag(&self, from: (f64, f64), to: (f64, f64)) {
        let place = |(x, y): (f64, f64), time: u32| {
            let at = self.run(&format!(
                "const b = canvas.getBoundingClientRect(); return [b.left + {x} * b.width, b.top + {y} * b.height]"
            ));
            let whole = |value: &Value| value.as_f64().unwrap_or_default() as i64;
            json!({ "type": "pointerMove", "duration": time, "x": whole(&at[0]), "y": whole(&at[1]) })
        };
        let [down, up] = ["pointerDown", "pointerUp"].map(|kind| json!({ "type": kind, "button": 0 }));
        let actions = json!([place(from, 0), down, place(to, 200), up]);
        let mouse = json!({
            "type": "pointer", "id": "mouse", "parameters": { "pointerType": "mouse" }, "actions": actions
        });
        self.command("actions", json!({ "actions": [mouse] }));
    }

    pub fn click(&self, at: (f64, f64)) {
        self.drag(at, at);
    }

    pub fn screenshot(&self, file: &Path) {
        // Let the page paint.
        sleep(Duration::from_millis(150));
        let path = format!("/session/{}/screenshot", self.session);
        let answer = self.request("GET", &path, None).expect("an answer");
        let bytes = STANDARD.decode(answer["value"].as_str().expect("a picture")).expect("base64");
        fs::write(file, bytes).expect("a disk");
    }

    fn command(&self, what: &str, body: Value) -> Value {
        let answer = self.request("POST", &format!("/session/{}/{what}", self.session), Some(body));
        let answer = answer.expect("an answer");
        if let Some(error) = answer["value"]["error"].as_str() {
            panic!("{what}: {error}: {}", answer["value"]["message"]);
        }
        answer["value"].clone()
    }

    fn request(&self, method: &str, path: &str, body: Option<Value>) -> Option<Value> {
        let body = body.map(|body| body.to_string()).unwrap_or_default();
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).ok()?;
        let head = format!(
            "{method} {path} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nConnection: close\r\nContent-Length: {}\r\n\r\n",
            self.port,
            body.len()
        );
        stream.write_all((head + &body).as_bytes()).ok()?;
        let mut all = Vec::new();
        // The driver may keep the connection open behind its answer.
        let mut buffer = [0; 1 << 16];
        loop {
            let count = stream.read(&mut buffer).ok()?;
            all.extend(&buffer[..count]);
            let text = String::from_utf8_lossy(&all);
            let Some((head, body)) = text.split_once("\r\n\r\n") else {
                if count == 0 {
                    return None;
                }
                continue;
            };
            let length = head.lines().find_map(|line| {
                line.to_ascii_lowercase().strip_prefix("content-length:").map(|value| value.trim().to_owned())
            });
            let length: usize = length.and_then(|length| length.parse().ok()).unwrap_or(usize::MAX);
            if count == 0 || body.len() >= length {
                return serde_json::from_str(body).ok();
            }
        }
    }
}

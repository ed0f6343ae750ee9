//! `kinora preview` from the outside: pictures, reloading, and attacks on the server.

use crate::command::{kinora, run, stderr};
use kinora::encode::frame_texts;
use serde_json::{Value, json};
use std::fs;
use std::io::{BufRead, BufReader, ErrorKind, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

const SCENE: &str = r##"(
    timeline: (frames: 6, fps: 6, keys: Frames),
    output: (size: (64, 40), files: ["out/frame_##.png"]),
    camera: (position: [(0, (0, 2, 6)), (3, (1, 2, 6))], target: (0, 0.7, 0)),
    // The lights.
    lights: {
        "sun": Point(position: (6, 9, 5), color: "#fff"),
        "fill": Point(position: (-6, 3, 5), intensity: 0.5),
    },
    objects: {
        "floor": (shape: Plane(), material: (color: "#efe6d2", mirror: 0.2)),
        "ball": (shape: Sphere(center: (0, 1, 0)), material: (color: "#d8341c", specular: 0.7)),
    },
)
"##;

/// The longest wait for an update, on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// A running preview, and the folder in which it runs.
struct Running {
    folder: TempDir,
    process: Child,
    port: u16,
    token: String,
}

/// An answer of the server.
struct Answer {
    status: u16,
    head: String,
    body: Vec<u8>,
}

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

impl Running {
    fn new(text: &str, options: &[&str]) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("a.ron"), text).expect("a disk");
        let mut command = Command::new(env!("CARGO_BIN_EXE_kinora"));
        command.args(["preview", "a.ron"]).args(options).current_dir(folder.path()).stdout(Stdio::piped());
        let mut process = command.spawn().expect("a process");
        let mut line = String::new();
        let out = process.stdout.take().expect("an output");
        BufReader::new(out).read_line(&mut line).expect("a line");
        let (_, address) = line.trim().split_once("http://127.0.0.1:").expect("an address");
        let (port, token) = address.trim_end_matches('/').split_once('/').expect("a token");
        let (port, token) = (port.parse().expect("a port"), token.to_owned());
        let running = Self { folder, process, port, token };
        assert_eq!(running.post("own", None).status, 200);
        running
    }

    fn file(&self, name: &str) -> std::path::PathBuf {
        self.folder.path().join(name)
    }

    fn save(&self, text: &str) {
        self.put("a.ron", text.as_bytes());
    }

    /// Puts a file in place at once, as editors do, so that nothing sees half of it.
    fn put(&self, name: &str, bytes: &[u8]) {
        let aside = tempfile::NamedTempFile::new().expect("a file");
        fs::write(aside.path(), bytes).expect("a disk");
        aside.persist(self.file(name)).expect("a disk");
    }

    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(("127.0.0.1", self.port)).expect("a connection");
        stream.set_read_timeout(Some(Duration::from_secs(60))).expect("a timeout");
        stream
    }

    /// Sends bytes and reads until the server closes.
    fn raw(&self, bytes: &[u8]) -> Answer {
        let mut stream = self.connect();
        // A server that refuses may close before it has read everything.
        let _ = stream.write_all(bytes);
        let mut all = Vec::new();
        if let Err(error) = stream.read_to_end(&mut all) {
            assert!(matches!(error.kind(), ErrorKind::ConnectionReset | ErrorKind::BrokenPipe), "{error}");
        }
        let end = all.windows(4).position(|four| four == b"\r\n\r\n").map_or(all.len(), |at| at + 4);
        let head = String::from_utf8_lossy(&all[..end]).into_owned();
        let status = head.split(' ').nth(1).and_then(|status| status.parse().ok()).unwrap_or(0);
        Answer { status, head, body: all[end..].to_vec() }
    }

    fn request(&self, method: &str, path: &str, headers: &str, body: &str) -> Answer {
        let length = body.len();
        self.raw(
            format!(
                "{method} {path} HTTP/1.1\r\nConnection: close\r\nContent-Length: {length}\r\n{headers}\r\n{body}"
            )
            .as_bytes(),
        )
    }

    fn post(&self, what: &str, body: Option<Value>) -> Answer {
        let (path, host) = (format!("/{}/{what}?page=test", self.token), self.host());
        self.request("POST", &path, &host, &body.map(|body| body.to_string()).unwrap_or_default())
    }

    fn host(&self) -> String {
        format!("Host: 127.0.0.1:{}\r\n", self.port)
    }

    /// The answer to a command.
    fn tell(&self, command: Value) -> Value {
        let answer = self.post("do", Some(command));
        assert_eq!(answer.status, 200, "{}", answer.head);
        serde_json::from_slice(&answer.body).expect("JSON")
    }

    /// The update after number `after`. A picture that never comes fails the test.
    fn next(&self, after: u64) -> (Value, Vec<u8>) {
        let path = format!("/{}/next?page=test&after={after}", self.token);
        let start = Instant::now();
        loop {
            let answer = self.request("GET", &path, &self.host(), "");
            if answer.status == 204 {
                assert!(start.elapsed() < PATIENCE, "no update after {after}");
                continue;
            }
            assert_eq!(answer.status, 200, "{}", answer.head);
            let length = u32::from_le_bytes(answer.body[..4].try_into().expect("four bytes")) as usize;
            let state = serde_json::from_slice(&answer.body[4..4 + length]).expect("JSON");
            return (state, answer.body[4 + length..].to_vec());
        }
    }

    /// The first update that is as wanted.
    fn until(&self, wanted: impl Fn(&Value) -> bool) -> (Value, Vec<u8>) {
        let (mut after, start) = (0, Instant::now());
        loop {
            let (state, picture) = self.next(after);
            if wanted(&state) {
                return (state, picture);
            }
            assert!(start.elapsed() < PATIENCE, "{state}");
            after = state["number"].as_u64().expect("a number");
        }
    }

    /// The finished picture.
    fn finished(&self) -> (Value, Vec<u8>) {
        self.until(|state| {
            state["diagnostics"].is_null() && state["stride"] == 1 && state["samples"] == state["most"]
        })
    }
}

fn pixels(png: &[u8]) -> Vec<u8> {
    image::load_from_memory(png).expect("a picture").to_rgb8().into_raw()
}

/// The pixels that `kinora render` gives a frame.
fn rendered(folder: &Path, text: &str, frame: u32) -> Vec<u8> {
    let folder = tempfile::tempdir_in(folder).expect("a folder");
    fs::write(folder.path().join("a.ron"), text).expect("a disk");
    let frames = frame.to_string();
    let command = ["render", "a.ron", "-q", "--frames", &frames, "-o", "f_#.png"];
    kinora(folder.path(), &command);
    pixels(&fs::read(folder.path().join(format!("f_{frame}.png"))).expect("a frame"))
}

/// Whether two pictures are equal but for the last bit of sums: each light has a layer of its own in a preview.
fn is_equal(one: &[u8], other: &[u8]) -> bool {
    one.len() == other.len() && one.iter().zip(other).all(|(a, b)| a.abs_diff(*b) <= 1)
}

#[test]
fn finished_pictures_are_those_of_render() {
    let lens = "camera: (position: (0, 2, 6), target: (0, 0.7, 0), aperture: 0.3)";
    let blurred =
        SCENE.replace("camera: (position: [(0, (0, 2, 6)), (3, (1, 2, 6))], target: (0, 0.7, 0))", lens);
    let clear = SCENE.replace("size: (64, 40)", "size: (61, 37), transparent: true");
    let labelled =
        SCENE.replace("    // The lights.", "annotations: { \"a\": Label(at: (0, 1, 0), text: \"ball\") },");
    for (name, text) in [("grid", SCENE), ("lens", &blurred), ("alpha", &clear), ("label", &labelled)] {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("a.ron"), text).expect("a disk");
        for frame in [0, 4] {
            let number = frame.to_string();
            let command = ["preview", "a.ron", "--snapshot", &number, "-o", "s.png"];
            kinora(folder.path(), &command);
            let shown = fs::read(folder.path().join("s.png")).expect("a picture");
            let (shown, expected) = (pixels(&shown), rendered(folder.path(), text, frame));
            assert!(is_equal(&shown, &expected), "{name}, frame {frame}");
        }
    }
}

/// Paths sample each light of a preview, and one of all lights of a render: pictures agree within their noise.
#[test]
fn pictures_of_paths_have_the_light_of_render() {
    let quality = "quality: (integrator: Path(), samples: 256, bounces: 2),";
    let text = SCENE.replace("    // The lights.", quality);
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("a.ron"), &text).expect("a disk");
    kinora(folder.path(), &["preview", "a.ron", "--snapshot", "0", "-o", "s.png"]);
    let shown = pixels(&fs::read(folder.path().join("s.png")).expect("a picture"));
    let expected = rendered(folder.path(), &text, 0);
    let mean = |codes: &[u8]| codes.iter().map(|code| f64::from(*code)).sum::<f64>() / codes.len() as f64;
    let apart: f64 = shown.iter().zip(&expected).map(|(a, b)| f64::from(a.abs_diff(*b))).sum();
    assert!((mean(&shown) - mean(&expected)).abs() < 0.5, "{} and {}", mean(&shown), mean(&expected));
    assert!(apart / (shown.len() as f64) < 3.0, "{apart}");
}

#[test]
fn snapshots_report_mistakes_as_check_does() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("a.ron"), SCENE.replace("Sphere(center", "Sfere(center")).expect("a disk");
    let told = |command: &[&str]| {
        let output = run(folder.path(), command);
        (output.status.code(), stderr(&output))
    };
    let (code, message) = told(&["preview", "a.ron", "--snapshot", "0", "-o", "s.png"]);
    assert_eq!((code, &message), (Some(2), &told(&["check", "a.ron"]).1));
    assert!(message.contains("Sfere") && !folder.path().join("s.png").exists());
    let (code, message) = told(&["preview", "a.ron", "--snapshot", "0", "-o", "s.gif"]);
    assert!(code == Some(2) && message.contains(".png"), "{message}");
    let (code, message) = told(&["preview", "none.ron"]);
    assert!(code == Some(2) && message.contains("there is no file"), "{message}");
}

#[test]
fn saved_files_are_shown_and_mistakes_stand_beside_the_last_picture() {
    let preview = Running::new(SCENE, &[]);
    let (_, first) = preview.finished();
    preview.save(&SCENE.replace("#d8341c", "#2e74c0"));
    let (state, blue) = preview.until(|state| state["generation"] == 2 && state["samples"] == state["most"]);
    assert_ne!(pixels(&first), pixels(&blue));
    // Only a material has changed, so there is one more film.
    assert!(state["films"].as_u64().expect("a number") <= 2, "{state}");
    preview.save(&SCENE.replace("Sphere(center", "Sfere(center"));
    let (state, picture) = preview.until(|state| !state["diagnostics"].is_null());
    assert_eq!(pixels(&picture), pixels(&blue));
    let check = stderr(&run(preview.folder.path(), &["check", "a.ron"]));
    assert_eq!(state["diagnostics"].as_str(), Some(check.trim_end()));
    // A file that is gone comes back.
    fs::remove_file(preview.file("a.ron")).expect("a disk");
    preview.until(|state| state["diagnostics"].as_str().is_some_and(|text| text.contains("cannot read")));
    preview.save(SCENE);
    let (_, again) = preview.finished();
    assert_eq!(pixels(&first), pixels(&again));
}

#[test]
fn included_files_and_images_are_watched() {
    let text = SCENE.replace("    // The lights.", "include: [\"part.ron\"],");
    let folder = "(objects: { \"box\": (shape: Box(min: (1, 0, 0), max: (2, 1, 1)), material: (color: Image(\"i.png\"))) })";
    let preview = Running::new(SCENE, &[]);
    preview.finished();
    let image = |color: [u8; 3]| {
        let mut bytes = std::io::Cursor::new(Vec::new());
        let picture = image::RgbImage::from_pixel(4, 4, image::Rgb(color));
        picture.write_to(&mut bytes, image::ImageFormat::Png).expect("in memory");
        preview.put("i.png", bytes.get_ref());
    };
    image([200, 20, 20]);
    preview.put("part.ron", folder.as_bytes());
    preview.save(&text);
    let (_, red) =
        preview.until(|state| state["generation"].as_u64() >= Some(2) && state["samples"] == state["most"]);
    let (state, _) = preview.next(0);
    let (generation, _) = (state["generation"].as_u64(), image([20, 20, 200]));
    let changed = |since: Option<u64>| {
        preview.until(move |state| state["generation"].as_u64() > since && state["samples"] == state["most"])
    };
    let (state, blue) = changed(generation);
    assert_ne!(pixels(&red), pixels(&blue));
    preview.put("part.ron", folder.replace("min: (1", "min: (1.5").as_bytes());
    let (state, moved) = changed(state["generation"].as_u64());
    assert_ne!(pixels(&blue), pixels(&moved));
    // A file that is missing, and comes.
    preview.save(&text.replace("\"part.ron\"", "\"part.ron\", \"new.ron\""));
    preview.until(|state| state["diagnostics"].as_str().is_some_and(|text| text.contains("new.ron")));
    preview.put("new.ron", b"(objects: { \"dot\": (shape: Sphere(center: (-1, 2, 0), radius: 0.4)) })");
    let (_, new) = changed(state["generation"].as_u64().map(|before| before + 1));
    assert_ne!(pixels(&moved), pixels(&new));
}

#[test]
fn lights_switch_without_tracing() {
    let preview = Running::new(SCENE, &[]);
    let (before, lit) = preview.finished();
    preview.tell(json!({ "do": "light", "index": 0, "on": false }));
    let (state, dark) = preview.until(|state| state["lights"][0]["on"] == false);
    assert_eq!(state["rays"], before["rays"]);
    assert_eq!(state["changed"], json!(["lights"]));
    let off = SCENE.replace("color: \"#fff\"", "on: false");
    assert!(is_equal(&pixels(&dark), &rendered(preview.folder.path(), &off, 0)));
    assert_ne!(pixels(&dark), pixels(&lit));
    // The same by an edit of the file, and an intensity.
    preview.tell(json!({ "do": "reset" }));
    preview.save(&SCENE.replace("intensity: 0.5", "intensity: 0.25"));
    let (state, _) = preview.until(|state| state["lights"][1]["intensity"] == 0.25);
    assert_eq!((&state["rays"], &state["samples"]), (&before["rays"], &before["samples"]));
}

#[test]
fn two_hundred_saves_leave_the_last_picture() {
    let preview = Running::new(SCENE, &[]);
    preview.finished();
    let memory = || {
        let status = fs::read_to_string(format!("/proc/{}/status", preview.process.id())).unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).map(str::to_owned);
        line.and_then(|line| line.trim().trim_end_matches(" kB").parse::<u64>().ok())
    };
    let mut after_some = None;
    for index in 0..200 {
        let text = SCENE.replace("\"#d8341c\"", &format!("(0.5, {}, 0.1)", f64::from(index) / 400.0));
        // Every second one is half of a file, and none is put in place at once.
        let part = if index % 2 == 0 { &text[..] } else { &text[..text.len() / 2] };
        fs::write(preview.file("a.ron"), part).expect("a disk");
        std::thread::sleep(Duration::from_millis(10));
        if index == 100 {
            after_some = memory();
        }
    }
    let last = SCENE.replace("\"#d8341c\"", "(0.25, 0.5, 0.75)");
    preview.save(&last);
    let expected = rendered(preview.folder.path(), &last, 0);
    let start = Instant::now();
    let mut after = 0;
    loop {
        let (state, picture) = preview.next(after);
        if state["diagnostics"].is_null() && is_equal(&pixels(&picture), &expected) {
            break;
        }
        assert!(start.elapsed() < Duration::from_secs(30), "{state}");
        after = state["number"].as_u64().expect("a number");
    }
    // Films of 64 x 40 pixels are small; a leak of worlds or texts would not be.
    if let (Some(before), Some(now)) = (after_some, memory()) {
        assert!(now < before + 64 * 1024, "{before} kB, then {now} kB");
    }
}

#[test]
fn renders_from_the_page_have_the_bytes_of_render() {
    let preview = Running::new(SCENE, &[]);
    preview.finished();
    preview.tell(json!({ "do": "light", "index": 0, "on": false }));
    preview.tell(json!({ "do": "render", "from": 2 }));
    let (state, _) = preview.until(|state| !state["render"]["outcome"].is_null());
    assert!(state["render"]["outcome"]["files"].is_array(), "{state}");
    let other = tempfile::tempdir().expect("a folder");
    fs::write(other.path().join("a.ron"), SCENE).expect("a disk");
    kinora(other.path(), &["render", "a.ron", "-q", "--frames", "2-5"]);
    for frame in 2..6 {
        let name = format!("out/frame_{frame:02}.png");
        let (ours, expected) = (preview.file(&name), other.path().join(&name));
        assert_eq!(fs::read(&ours).expect("a frame"), fs::read(&expected).expect("a frame"));
        assert!(!frame_texts(&ours).is_empty());
    }
    assert!(!preview.file("out/frame_00.png").exists());
}

#[test]
fn values_are_written_only_with_edit() {
    let preview = Running::new(SCENE, &[]);
    let write = json!({ "do": "write-light", "index": 1, "field": "intensity", "value": 0.75 });
    assert!(preview.tell(write.clone())["error"].as_str().is_some_and(|error| error.contains("--edit")));
    assert_eq!(fs::read_to_string(preview.file("a.ron")).expect("a file"), SCENE);
    let preview = Running::new(SCENE, &["--edit"]);
    preview.finished();
    assert_eq!(preview.tell(write), json!({ "written": true }));
    let text = fs::read_to_string(preview.file("a.ron")).expect("a file");
    assert_eq!(text, SCENE.replace("intensity: 0.5", "intensity: 0.75"));
    // The camera of this file has keys, which stay.
    preview.tell(json!({ "do": "camera", "move": "orbit", "x": 0.3, "y": 0.1 }));
    let answer = preview.tell(json!({ "do": "write-camera" }));
    assert!(answer["error"].as_str().is_some_and(|error| error.contains("has keys")), "{answer}");
    let still = SCENE.replace("[(0, (0, 2, 6)), (3, (1, 2, 6))]", "(0, 2, 6) /* here */");
    preview.save(&still);
    // Until the saved file is read, the camera has its keys. A reader may also see it while it is still empty.
    let start = Instant::now();
    loop {
        let answer = preview.tell(json!({ "do": "write-camera" }));
        if answer == json!({ "written": true }) {
            break;
        }
        assert!(start.elapsed() < Duration::from_secs(60), "{answer}");
        std::thread::sleep(Duration::from_millis(20));
    }
    let text = fs::read_to_string(preview.file("a.ron")).expect("a file");
    let (before, after) = still.split_once("(0, 2, 6)").expect("a position");
    assert!(text.starts_with(before) && text.contains(" /* here */, target: (0, 0.7, 0)"), "{text}");
    assert!(text.ends_with(after.split_once("}").expect("lights").1));
}

#[test]
fn pixels_tell_what_they_show() {
    let preview = Running::new(SCENE, &[]);
    preview.finished();
    let found = preview.tell(json!({ "do": "pick", "x": 32, "y": 18 }));
    assert_eq!(found["object"], "ball");
    let distance = found["distance"].as_f64().expect("a distance");
    assert!((4.5..6.0).contains(&distance), "{found}");
    assert_eq!(found["rays"]["camera"], 1);
    let shares: f64 =
        found["light"].as_array().expect("shares").iter().filter_map(|of| of["share"].as_f64()).sum();
    assert!((shares - 1.0).abs() < 1e-3, "{found}");
    assert_eq!(preview.tell(json!({ "do": "pick", "x": 0, "y": 0 }))["object"], Value::Null);
    let place = preview.tell(json!({ "do": "place", "names": ["objects", "ball"] }));
    let line = SCENE.lines().position(|line| line.contains("\"ball\"")).expect("a line") + 1;
    assert_eq!(place["line"], line);
    let copied = preview.tell(json!({ "do": "copy-camera" }));
    assert_eq!(
        copied["text"],
        "camera: (position: (0, 2, 6), target: (0, 0.7, 0), projection: Perspective(fov: 45)),"
    );
}

#[test]
fn strangers_see_nothing() {
    let preview = Running::new(SCENE, &[]);
    let (token, own) = (&preview.token, preview.host());
    let origin = format!("{own}Origin: http://evil.example\r\n");
    let cross = format!("{own}Sec-Fetch-Site: cross-site\r\n");
    let page = format!("/{token}/");
    for (path, headers) in [
        ("/", own.as_str()),
        ("/favicon.ico", &own),
        (&format!("/{}/", "0".repeat(token.len())), &own),
        (&format!("/{}/", &token[1..]), &own),
        (&format!("/{token}/../../etc/passwd"), &own),
        (&format!("/{token}/%2e%2e/a.ron"), &own),
        (&format!("/{token}/a.ron"), &own),
        (&page, "Host: evil.example\r\n"),
        (&page, "Host: 127.0.0.1.evil.example:80\r\n"),
        (&page, ""),
        (&page, &origin),
        (&page, &cross),
    ] {
        for method in ["GET", "POST", "OPTIONS", "PUT"] {
            let answer = preview.request(method, path, headers, "");
            assert!(matches!(answer.status, 400 | 404), "{method} {path} {headers}: {}", answer.head);
            assert!(answer.body.len() < 200 && !answer.head.to_lowercase().contains("access-control"));
        }
    }
    let answer = preview.request("GET", &page, &own, "");
    assert_eq!(answer.status, 200);
    let head = answer.head.to_lowercase();
    for rule in ["default-src 'none'", "frame-ancestors 'none'", "nosniff", "no-store", "no-referrer"] {
        assert!(head.contains(rule), "{rule} in {head}");
    }
    // A tunnel has another port.
    assert_eq!(preview.request("GET", &page, "Host: localhost:9999\r\n", "").status, 200);
}

#[test]
fn the_last_page_owns_the_session() {
    let preview = Running::new(SCENE, &[]);
    let own = preview.host();
    let next = |page: &str| {
        preview.request("GET", &format!("/{}/next?page={page}&after=0", preview.token), &own, "").status
    };
    preview.finished();
    assert_eq!((next("test"), next("other"), next("")), (200, 409, 409));
    let path = format!("/{}/own?page=other", preview.token);
    assert_eq!(preview.request("POST", &path, &own, "").status, 200);
    assert_eq!((next("test"), next("other")), (409, 200));
    assert_eq!(preview.post("do", Some(json!({ "do": "frame", "frame": 1 }))).status, 409);
}

#[test]
fn huge_and_slow_requests_are_refused() {
    let preview = Running::new(SCENE, &[]);
    let (token, own) = (preview.token.clone(), preview.host());
    let path = format!("/{token}/do?page=test");
    let huge = preview.request("POST", &path, &own, &"x".repeat(1 << 20));
    assert!(matches!(huge.status, 413 | 0), "{}", huge.head);
    for command in ["", "{", "[1]", "{\"do\":\"delete\"}"] {
        assert_eq!(preview.request("POST", &path, &own, command).status, 400, "{command}");
    }
    let long = format!("GET /{}/ HTTP/1.1\r\n{own}\r\n", "a".repeat(1 << 20));
    assert!(matches!(preview.raw(long.as_bytes()).status, 400 | 404 | 414 | 431 | 0));
    let many: String = (0..1000).map(|index| format!("X-{index}: 1\r\n")).collect();
    assert!(matches!(
        preview.request("GET", &format!("/{token}/"), &format!("{own}{many}"), "").status,
        400 | 431 | 0
    ));
    assert!(matches!(preview.raw(&[0xff; 5000]).status, 400 | 0));
    // Half of a head, a body that never comes, and many idle connections. The page is served all the while.
    let mut slow: Vec<TcpStream> = (0..300).map(|_| preview.connect()).collect();
    slow[298].write_all(format!("GET /{token}/ HTTP/1.1\r\nHo").as_bytes()).expect("written");
    slow[299]
        .write_all(format!("POST {path} HTTP/1.1\r\n{own}Content-Length: 100\r\n\r\n").as_bytes())
        .expect("written");
    let start = Instant::now();
    assert_eq!(preview.request("GET", &format!("/{token}/"), &own, "").status, 200);
    assert!(start.elapsed() < Duration::from_secs(2));
    // Each of them ends.
    for stream in &mut slow {
        let mut rest = Vec::new();
        let _ = stream.read_to_end(&mut rest);
    }
    assert!(start.elapsed() < Duration::from_secs(40), "{:?}", start.elapsed());
    preview.finished();
}

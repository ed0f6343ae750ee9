//! Drives the page of `kinora preview` in a headless Chromium, and takes screenshots.
//!
//!     apt-get install chromium chromium-driver
//!     cargo quick-test --test preview -- FOLDER
//!
//! `cargo test` leaves it out. Without a browser it says so and ends. Screenshots go to FOLDER, by default
//! `output/preview`.
#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a program that tests may panic and print"
)]

mod driver;

use driver::{Driver, Preview};
use serde_json::json;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

fn main() {
    let folder = std::env::args().nth(1).filter(|argument| !argument.starts_with('-'));
    let shots = PathBuf::from(folder.unwrap_or_else(|| "output/preview".to_owned()));
    let Some(driver) = Driver::start() else {
        println!(
            "skipped: there is no chromium or no chromedriver (apt-get install chromium chromium-driver)"
        );
        return;
    };
    fs::create_dir_all(&shots).expect("a folder for screenshots");
    edits(&driver, &shots);
    controls(&driver, &shots);
    timeline(&driver, &shots);
    speeds(&driver);
    println!("ok: the page works; screenshots are in {}", shots.display());
}

fn shipped(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("sequences").join(name);
    fs::read_to_string(path).expect("a sequence")
}

/// Saving the file shows it; mistakes stand beside the last good picture.
fn edits(driver: &Driver, shots: &Path) {
    let text = shipped("hello.ron");
    let preview = Preview::start(&text, &["--edit"]);
    driver.open(&preview.address);
    driver.until("return $('status').textContent === 'Picture complete'");
    driver.screenshot(&shots.join("first.png"));
    let pixel =
        "return Array.from(context.getImageData(canvas.width / 2, canvas.height / 2, 1, 1).data).join()";
    let before = driver.run(pixel);
    preview.save(&text.replace("Sphere(center", "Sfere(center").replace("mirror: 0.12", "miror: 0.12"));
    driver.until("return !$('diagnostics').hidden && $('messages').textContent.includes('Sfere')");
    assert_eq!(driver.run("return $('messages').textContent"), preview.check());
    assert_eq!(driver.run(pixel), before, "the last good picture stays");
    driver.screenshot(&shots.join("mistake.png"));
    preview.save(&text);
    driver.until("return $('diagnostics').hidden && $('status').textContent === 'Picture complete'");
    // The file is written by the page.
    driver.run("const i = document.querySelector('#lights input[type=number]'); i.value = 0.5; i.dispatchEvent(new Event('change'))");
    driver.until("return state.lights[0].intensity === 0.5");
    assert_eq!(preview.text(), text.replace("(60, 90, 50)", "(60, 90, 50), intensity: 0.5"));
    assert_eq!(driver.run("return window.faults || null"), json!(null));
}

/// Keys, mouse, maps and the split view.
fn controls(driver: &Driver, shots: &Path) {
    let preview = Preview::start(&shipped("glazed-orbit.ron"), &["-s", "480x480"]);
    driver.open(&preview.address);
    let complete = "return $('status').textContent === 'Picture complete'";
    driver.until(complete);
    driver.keys("r2");
    driver.until("return state.lights[1].on === false && isSplit");
    driver.screenshot(&shots.join("split.png"));
    driver.keys("s2");
    driver.until("return state.lights[1].on === true && !isSplit");
    driver.drag((0.5, 0.5), (0.62, 0.42));
    driver.until("return state.camera_moved");
    driver.until(complete);
    driver.keys("p");
    driver.until("return state.parallel");
    driver.until(complete);
    // The height of a parallel picture is a length in the world, of any size.
    driver.keys("c");
    driver.until("return $('copied').textContent.includes('Orthographic')");
    let height = "return Number($('copied').textContent.match(/height: ([^)]+)/)[1])";
    let before = driver.run(height).as_f64().unwrap_or_default();
    driver.run("moveCamera({ move: 'zoom', factor: 1.5 })");
    driver.until("return !busy.size");
    driver.until(complete);
    driver.run("$('copied').textContent = ''");
    driver.keys("c");
    driver.until("return $('copied').textContent.includes('Orthographic')");
    let after = driver.run(height).as_f64().unwrap_or_default();
    assert!(before > 100.0 && (after / before - 1.5).abs() < 1e-3, "{before} {after}");
    driver.keys("c");
    driver.until("return $('copied').textContent.startsWith('camera: (position: (')");
    driver.keys("--");
    driver.until("return state.changed.includes('bounces')");
    driver.until(complete);
    driver.click((0.5, 0.6));
    driver.until("return $('pick').textContent.includes('Material')");
    driver.screenshot(&shots.join("camera.png"));
    driver.keys("0");
    driver.until("return state.changed.length === 0");
    driver.until(complete);
    driver.keys("y");
    driver.until("return state.heat === 'rays' && !$('scale').hidden");
    driver.screenshot(&shots.join("rays.png"));
    driver.keys("e");
    driver.until("return $('toast').textContent.includes('no noise')");
    driver.keys("y?");
    driver.until("return $('help').open");
    driver.screenshot(&shots.join("help.png"));
    driver.run("$('help').close()");
    // Every control has a name.
    let nameless = "return [...document.querySelectorAll('button, input, [role]')].filter(e => \
        !(e.textContent.trim() || e.getAttribute('aria-label') || e.getAttribute('aria-labelledby') || \
        (e.labels && e.labels.length) || e.id === 'toast' || e.id === 'messages' || e.id === 'status' || \
        e.id === 'render-state')).map(e => e.outerHTML)";
    assert_eq!(driver.run(nameless), json!([]));
    driver.run("$('predict').click()");
    driver.until("return $('forecast').textContent.includes('All 72 frames')");
    driver.screenshot(&shots.join("forecast.png"));
}

/// Scrubbing, playing, keys and the plan.
fn timeline(driver: &Driver, shots: &Path) {
    let preview = Preview::start(&shipped("glazed-lights.ron"), &["-s", "320x240"]);
    driver.open(&preview.address);
    driver.until("return state.plan && $('plan').children.length > 0 && $('tracks').children.length > 0");
    driver.keys(".");
    driver.until("return state.frame === 1");
    driver.run("document.querySelector('#tracks .key').click()");
    driver.until("return !$('source').hidden && $('source-text').textContent.length > 20");
    driver.screenshot(&shots.join("timeline.png"));
    driver.keys(" ");
    driver.until("return state.playing && state.frame > 12");
    println!("plays: {} pictures/s", driver.run("return state.shown_per_second"));
    driver.screenshot(&shots.join("playing.png"));
    driver.keys(" ");
    driver.until("return !state.playing");
    // Another page takes over, and this one says so.
    driver.run("fetch('own?page=other', { method: 'POST' })");
    driver.until("return !$('elsewhere').hidden");
}

/// Changes whose times are measured.
const CHANGES: usize = 9;

/// Prints the times from a change to its pictures, in milliseconds. On a quiet machine they are the figures of the preview.
fn speeds(driver: &Driver) {
    let complete = "return $('status').textContent === 'Picture complete'";
    let watched = |text: &str, options: &[&str]| {
        let preview = Preview::start(text, options);
        driver.open(&preview.address);
        driver.until(complete);
        driver.run(
            "const draw = context.drawImage.bind(context); \
             context.drawImage = (...all) => { draw(...all); window.draws.push(Date.now()); }; window.draws = []",
        );
        preview
    };
    // The first and the last picture after a change that `act` makes.
    let times = |act: &dyn Fn(usize)| -> [f64; 2] {
        let measured = (0..CHANGES).map(|change| {
            driver.run("window.draws = []");
            let start = SystemTime::now().duration_since(UNIX_EPOCH).expect("a time").as_secs_f64() * 1e3;
            act(change);
            driver.until("return window.draws.length > 0");
            driver.until(complete);
            ["return window.draws[0]", "return window.draws.at(-1)"]
                .map(|which| driver.run(which).as_f64().expect("a time") - start)
        });
        let measured: Vec<[f64; 2]> = measured.collect();
        [0, 1].map(|which: usize| {
            let mut all: Vec<f64> = measured.iter().map(|times| times[which]).collect();
            all.sort_by(f64::total_cmp);
            all[CHANGES / 2]
        })
    };
    let text = shipped("hello.ron");
    let hello = watched(&text, &[]);
    let [first, whole] = times(&|change| hello.save(&text.replace("#9cc0e0", &format!("#9cc0{change}0"))));
    println!("hello saved: first picture {first:.0} ms, whole frame {whole:.0} ms");
    let press = "document.body.dispatchEvent(new KeyboardEvent('keydown', { key: '1', bubbles: true }))";
    let [light, _] = times(&|_| drop(driver.run(press)));
    println!("light switched: {light:.0} ms");
    drop(hello);
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets");
    let text = shipped("room.ron").replace("../assets", &assets.display().to_string());
    let room = watched(&text, &["--allow-outside"]);
    let bounces = |change: usize| text.replace("bounces: 8", &format!("bounces: {}", 1 + change % 7));
    let [first, whole] = times(&|change| room.save(&bounces(change)));
    println!("room saved: first picture {first:.0} ms, whole frame {whole:.0} ms");
    drop(room);
    // A command is answered when what is being traced has stopped for it.
    let large = Preview::start(&text, &["-s", "1920x1080", "--allow-outside"]);
    driver.open(&large.address);
    let answered = (0..CHANGES).map(|_| {
        driver.until("return state.stride > 0 && state.stride < 4");
        let answer = "return (async () => { const start = performance.now(); \
                      await send({ do: 'camera', move: 'orbit', x: 0.01, y: 0 }); \
                      return performance.now() - start; })()";
        driver.run(answer).as_f64().expect("a time")
    });
    let mut answered: Vec<f64> = answered.collect();
    answered.sort_by(f64::total_cmp);
    let (median, worst) = (answered[CHANGES / 2], answered[CHANGES - 1]);
    println!("a drag while 1920x1080 pixels are traced: answered in {median:.0} ms, at most {worst:.0} ms");
}

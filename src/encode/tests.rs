//! The encoder from films to files.

use super::*;
use crate::base::cancel::Stop;
use crate::base::color::Rgb;
use crate::base::time::Rate;
use crate::film::Film;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

const SIZE: (u32, u32) = (6, 4);

fn start(job: EncodeJob) -> Result<Encoder, EncodeError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("a pool");
    Encoder::start(job, std::sync::Arc::new(pool), &Stop::default())
}

fn job(outputs: &[String], frames: &[u32]) -> EncodeJob {
    EncodeJob {
        confined: false,
        existing: Existing::default(),
        frame_keys: Vec::new(),
        outputs: outputs.iter().map(|text| Output::parse(text).expect(text)).collect(),
        frames: frames.to_vec(),
        rate: Rate::new(24, 1).expect("a rate"),
        size: SIZE,
        tonemap: Tonemap::None,
        transparent: false,
        background_color: DEFAULT_BACKGROUND_COLOR,
        drawings: Vec::new(),
        formats: Formats::default(),
        info: SequenceInfo { name: "a".into(), frames: 256, ..SequenceInfo::default() },
    }
}

/// A film whose frame k is grey with code k.
fn film(frame: u32) -> Film {
    let mut film = Film::new(SIZE.0, SIZE.1, vec![Rgb::ONE]);
    film.data_mut().fill(Rgb::splat(frame as f32 / 255.0));
    film
}

fn within(dir: &tempfile::TempDir, name: &str) -> String {
    dir.path().join(name).to_string_lossy().into_owned()
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("a folder");
    let mut names: Vec<_> =
        entries.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

fn encode(job: EncodeJob) -> Result<Report, EncodeError> {
    let mut encoder = start(job.clone())?;
    for &frame in &job.frames {
        encoder.push(frame, film(frame))?;
    }
    encoder.finish()
}

/// The red values of a GIF's first pixel, frame by frame.
fn gif_codes(path: &str) -> Vec<u8> {
    let mut options = ::gif::DecodeOptions::new();
    options.set_color_output(::gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(fs::File::open(path).expect("a file")).expect("a GIF");
    let mut codes = Vec::new();
    while let Some(frame) = decoder.read_next_frame().expect("a frame") {
        codes.push(frame.buffer[0]);
    }
    codes
}

#[test]
fn stills_and_a_gif_of_a_subset() {
    let dir = tempfile::tempdir().expect("a folder");
    let outputs = [within(&dir, "out/f_##.png"), within(&dir, "a.gif"), within(&dir, "b.gif")];
    let frames = [9, 3, 200, 3];
    let report = encode(job(&outputs, &frames)).expect("written");
    assert_eq!(report.files, outputs.each_ref().map(PathBuf::from));
    assert!(report.notes.is_empty() && report.nan_pixels == 0 && report.busy > Duration::ZERO);
    assert_eq!(names(dir.path()), ["a.gif", "b.gif", "out"]);
    assert_eq!(names(&dir.path().join("out")), ["f_03.png", "f_09.png", "f_200.png"]);
    for frame in [9, 3, 200] {
        let path = dir.path().join(format!("out/f_{frame:02}.png"));
        assert_eq!(png::read(&path).expect("read").rgb, vec![frame as u8; 6 * 4 * 3]);
    }
    assert_eq!(gif_codes(&outputs[1]), [9, 3, 200, 3]);
    assert_eq!(fs::read(&outputs[1]).expect("read"), fs::read(&outputs[2]).expect("read"));
}

#[test]
fn a_gif_without_stills_has_the_same_bytes_and_leaves_no_spool() {
    let dir = tempfile::tempdir().expect("a folder");
    let (alone, beside, stills) = (within(&dir, "a.gif"), within(&dir, "b.gif"), within(&dir, "f_#.png"));
    let frames: Vec<u32> = (0..40).collect();
    encode(job(std::slice::from_ref(&alone), &frames)).expect("written");
    assert_eq!(names(dir.path()), ["a.gif"]);
    encode(job(&[beside.clone(), stills], &frames)).expect("written");
    assert_eq!(fs::read(alone).expect("read"), fs::read(beside).expect("read"));
}

#[test]
fn exr_files_do_not_change_other_outputs_and_do_not_store_gif_frames() {
    let dir = tempfile::tempdir().expect("a folder");
    let [all, some] = ["all", "some"].map(|folder| within(&dir, folder));
    let within = |folder: &str, names: &[&str]| names.iter().map(|name| format!("{folder}/{name}")).collect();
    let outputs: Vec<String> = within(&all, &["f_#.exr", "f_#.png", "a.gif"]);
    encode(job(&outputs, &[1, 2])).expect("written");
    assert_eq!(names(Path::new(&all)), ["a.gif", "f_1.exr", "f_1.png", "f_2.exr", "f_2.png"]);
    let outputs: Vec<String> = within(&some, &["f_#.exr", "a.gif"]);
    encode(job(&outputs, &[1, 2])).expect("written");
    assert_eq!(names(Path::new(&some)), ["a.gif", "f_1.exr", "f_2.exr"]);
    for name in ["a.gif", "f_1.exr", "f_2.exr"] {
        let bytes = [&all, &some].map(|folder| fs::read(format!("{folder}/{name}")).expect(name));
        assert!(bytes[0] == bytes[1], "{name}");
    }
}

#[test]
fn a_single_frame_needs_no_placeholder() {
    let dir = tempfile::tempdir().expect("a folder");
    encode(job(&[within(&dir, "still.png")], &[77])).expect("written");
    assert_eq!(names(dir.path()), ["still.png"]);
}

#[test]
fn invalid_jobs_leave_nothing() {
    let dir = tempfile::tempdir().expect("a folder");
    fs::create_dir(dir.path().join("folder.gif")).expect("a folder");
    fs::write(dir.path().join("file"), "").expect("a file");
    let bad = |outputs: &[&str], change: fn(&mut EncodeJob)| {
        let outputs: Vec<_> = outputs.iter().map(|name| within(&dir, name)).collect();
        let mut job = job(&outputs, &[0, 1]);
        change(&mut job);
        let message = start(job).err().expect("an error").to_string();
        assert_eq!(names(dir.path()), ["file", "folder.gif"], "{message}");
        message
    };
    let keep: fn(&mut EncodeJob) = |_| {};
    assert!(bad(&["new/f.png"], keep).contains("new/f_####.png"));
    assert!(bad(&["new/f.exr"], keep).contains("new/f_####.exr"));
    assert!(bad(&["new/f_#.png", "new/f_%d.png"], keep).contains("two outputs would write"));
    assert!(bad(&["a.gif", "./a.gif"], keep).contains("two outputs would write"));
    assert!(bad(&["new/a.gif", "folder.gif"], keep).contains("it is a folder"));
    assert!(bad(&["new/a.gif", "file/b.gif"], keep).contains("file is a file; name a folder there"));
    assert!(bad(&["new/a.gif", "file/in/f_#.png"], keep).contains("file is a file; name a folder there"));
    assert!(bad(&["new/a.gif"], |job| job.size.1 = 65_536).contains("a GIF ends at 65535x65535"));
    assert!(bad(&["new/a.gif"], |job| job.frames.clear()).contains("nothing to write"));
    let slow = |job: &mut EncodeJob| job.rate = Rate::new(1, 10_000_000).expect("a rate");
    assert!(bad(&["new/a.gif"], slow).contains("100 days"));
}

#[cfg(unix)]
#[test]
fn an_unwritable_folder_fails_before_the_first_frame() {
    use std::os::unix::fs::PermissionsExt;
    let dir = tempfile::tempdir().expect("a folder");
    let closed = dir.path().join("closed");
    fs::create_dir(&closed).expect("a folder");
    fs::set_permissions(&closed, fs::Permissions::from_mode(0o555)).expect("closed");
    // The superuser may write everywhere.
    if fs::write(closed.join("probe"), "").is_err() {
        let outputs = [within(&dir, "new/a.gif"), within(&dir, "closed/f_#.png")];
        let message = start(job(&outputs, &[0, 1])).err().expect("an error").to_string();
        assert!(message.contains("closed") && message.contains("-o"), "{message}");
        assert_eq!(names(dir.path()), ["closed"]);
    }
    fs::set_permissions(&closed, fs::Permissions::from_mode(0o755)).expect("open");
}

#[test]
fn an_error_in_the_middle_comes_early_and_leaves_no_temporary() {
    let dir = tempfile::tempdir().expect("a folder");
    let outputs = [within(&dir, "a.gif"), within(&dir, "f_#.png")];
    let frames: Vec<u32> = (0..100).collect();
    let mut encoder = start(job(&outputs, &frames)).expect("started");
    encoder.push(0, film(0)).expect("taken");
    encoder.push(1, film(1)).expect("taken");
    fs::create_dir_all(dir.path().join("f_3.png/in the way")).expect("a folder");
    let error = (2..100).find_map(|k| encoder.push(k, film(k)).err()).expect("an error in time");
    assert!(error.to_string().contains("f_3.png"), "{error}");
    assert!(matches!(encoder.push(99, film(99)), Err(EncodeError::Films(_) | EncodeError::Stopped(None))));
    assert!(matches!(encoder.finish(), Err(EncodeError::Stopped(None))));
    // Later frames may exist, because several files are committed at the same time.
    let names = names(dir.path());
    assert_eq!(names[..4], ["f_0.png", "f_1.png", "f_2.png", "f_3.png"]);
    assert!(names.iter().all(|name| name.starts_with("f_")), "{names:?}");
}

#[test]
fn a_lost_frame_leaves_neither_gif_nor_temporary() {
    let dir = tempfile::tempdir().expect("a folder");
    let outputs = [within(&dir, "a.gif"), within(&dir, "f_#.png")];
    let mut encoder = start(job(&outputs, &[0, 1])).expect("started");
    encoder.push(0, film(0)).expect("taken");
    encoder.push(1, film(1)).expect("taken");
    while ["f_0.png", "f_1.png"].iter().any(|name| !dir.path().join(name).exists()) {
        std::thread::yield_now();
    }
    fs::remove_file(dir.path().join("f_0.png")).expect("removed");
    let message = encoder.finish().expect_err("a frame is missing").to_string();
    assert!(message.contains("f_0.png"), "{message}");
    assert_eq!(names(dir.path()), ["f_1.png"]);
}

#[test]
fn dropped_encoders_leave_no_gif_and_no_new_folder() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut encoder = start(job(&[within(&dir, "new/a.gif")], &[0, 1])).expect("started");
    encoder.push(0, film(0)).expect("taken");
    drop(encoder);
    assert!(names(dir.path()).is_empty());
}

#[test]
fn films_must_be_those_announced() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut encoder = start(job(&[within(&dir, "f_#.png")], &[5, 6])).expect("started");
    let order = encoder.push(6, film(6)).expect_err("not its turn").to_string();
    assert_eq!(order, "received frame 6 instead of frame 5");
    let size = encoder.push(5, Film::new(1, 1, vec![Rgb::ONE])).expect_err("too small").to_string();
    assert_eq!(size, "frame 5 has 1x1 pixels instead of 6x4");
    encoder.push(5, film(5)).expect("taken");
    assert_eq!(encoder.finish().expect_err("too early").to_string(), "received only 1 of 2 frames");
}

#[test]
fn notes_report_dropped_frames_and_nan_pixels() {
    let dir = tempfile::tempdir().expect("a folder");
    let frames: Vec<u32> = (0..60).collect();
    let job = EncodeJob { rate: Rate::new(60, 1).expect("a rate"), ..job(&[within(&dir, "a.gif")], &frames) };
    let mut encoder = start(job).expect("started");
    for frame in 0..60 {
        let mut film = film(frame);
        film.data_mut()[3].y = if frame >= 7 { f32::NAN } else { 0.0 };
        encoder.push(frame, film).expect("taken");
    }
    let report = encoder.finish().expect("written");
    assert_eq!(report.nan_pixels, 53);
    assert!(report.notes[0].contains("shows 50 of 60 frames"), "{:?}", report.notes);
    assert!(report.notes[1].contains("53 pixels") && report.notes[1].contains("frame 7"));
    assert_eq!(gif_codes(&within(&dir, "a.gif"))[..7], [0, 1, 2, 3, 4, 6, 7]);
}

//! Every file operation fails, once or permanently. No partial file appears, no temporary file stays, and the next run
//! makes the same files as a run without faults.

use super::disk::Operation;
use super::disk::faults::{end, plan};
use super::*;
use crate::base::cancel::Stop;
use crate::base::color::Rgb;
use crate::base::digest::Digest;
use crate::base::time::Rate;
use crate::film::Film;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::Arc;

const SIZE: (u32, u32) = (6, 4);
const FRAMES: [u32; 2] = [3, 4];

/// Writes one output of each kind, into two folders.
fn run(folder: &Path) -> Result<Report, EncodeError> {
    let outputs = ["new/f_#.png", "new/f_#.exr", "new/f_#.jpg", "a.gif", "a.mp4", "a.apng"];
    let mut encoder = started(folder, &outputs, Existing::Keep)?;
    for frame in encoder.missing() {
        encoder.push(frame, film(frame))?;
    }
    encoder.finish()
}

/// Writes frames of a shared job. Each frame is a film of its own.
fn shared(folder: &Path) -> Result<Report, EncodeError> {
    let mut encoder = started(folder, &["new/f_#.png", "new/f_#.exr"], Existing::Share)?;
    for frame in encoder.missing() {
        match encoder.lease_frames(Digest(frame.into()), &[frame])? {
            FrameLease::Acquired(frames) => {
                frames.into_iter().try_for_each(|frame| encoder.push(frame, film(frame)))?
            }
            other => panic!("{other:?}"),
        }
    }
    encoder.finish()
}

fn film(frame: u32) -> Film {
    let aovs = crate::film::AovSet::of_picture(true);
    let mut film = Film::with_aovs(SIZE.0, SIZE.1, vec![Rgb::ONE], aovs);
    for (place, value) in film.data_mut().iter_mut().enumerate() {
        *value = Rgb::splat(frame as f32 * 0.01 + place as f32 * 0.02);
    }
    film
}

fn started(folder: &Path, outputs: &[&str], existing: Existing) -> Result<Encoder, EncodeError> {
    let outputs = outputs.iter().copied();
    let outputs = outputs.map(|name| Output::parse(folder.join(name)).expect(name));
    let key = |frame: &u32| FrameKey {
        image_hash: Digest(u128::from(*frame)),
        exposure: 1.0,
        ..FrameKey::default()
    };
    let job = EncodeJob {
        outputs: outputs.collect(),
        confined: false,
        existing,
        frames: FRAMES.to_vec(),
        frame_keys: FRAMES.iter().map(key).collect(),
        rate: Rate::new(24, 1).expect("a rate"),
        size: SIZE,
        tonemap: Tonemap::default(),
        // The GIF's frames are stored in a spool.
        transparent: true,
        background_color: DEFAULT_BACKGROUND_COLOR,
        drawings: Vec::new(),
        formats: Formats::default(),
        info: SequenceInfo::default(),
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
    Encoder::start(job, Arc::new(pool), &Stop::default())
}

/// All files in a folder and its subfolders, by their names.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).expect("a folder").flatten() {
        let (path, name) = (entry.path(), entry.file_name().to_string_lossy().into_owned());
        if path.is_dir() {
            found.insert(name.clone(), Vec::new());
            found
                .extend(contents(&path).into_iter().map(|(inner, bytes)| (format!("{name}/{inner}"), bytes)));
        } else {
            found.insert(name, fs::read(path).expect("a file"));
        }
    }
    found
}

#[test]
fn whatever_fails_no_file_is_partial_and_the_next_run_succeeds() {
    let operations = failing(run, 10);
    for kind in
        [Operation::CreateFolder, Operation::Create, Operation::Write, Operation::Sync, Operation::Rename]
    {
        assert!(operations.contains(&kind), "{kind:?}");
    }
}

#[test]
fn whatever_fails_no_lease_stays() {
    failing(shared, 5);
}

/// Makes every operation of a run fail in turn. The run makes `files` files and folders.
fn failing(run: fn(&Path) -> Result<Report, EncodeError>, files: usize) -> Vec<Operation> {
    let reference = tempfile::tempdir().expect("a folder");
    plan(reference.path(), usize::MAX, false);
    run(reference.path()).expect("no faults");
    let operations = end(reference.path());
    let whole = contents(reference.path());
    assert_eq!(whole.len(), files, "{:?}", whole.keys());
    for (first, operation) in operations.iter().enumerate() {
        for lasts in [false, true] {
            let dir = tempfile::tempdir().expect("a folder");
            let what = format!("{operation:?}, operation {first}, lasting: {lasts}");
            plan(dir.path(), first, lasts);
            let done = run(dir.path());
            // Files are committed in parallel, so the order of their operations varies.
            let failed = end(dir.path()).get(first).copied();
            // A file that cannot be read is made again. Any other fault ends the run with an error that names the path.
            if failed.is_some_and(|operation| operation != Operation::Read || lasts) {
                let message = done.expect_err(&what).to_string();
                assert!(message.contains(&*dir.path().to_string_lossy()), "{what}: {message}");
            }
            for (name, bytes) in contents(dir.path()) {
                assert!(
                    whole.get(&name) == Some(&bytes),
                    "{what}: {name} is partial, or should not be there"
                );
            }
            run(dir.path()).expect("no faults");
            assert!(contents(dir.path()) == whole, "{what}: the next run makes other files");
        }
    }
    operations
}

/// The second run reads existing frames, to keep them and to make animations from them.
#[test]
fn whatever_fails_in_a_second_run_frames_stay() {
    let dir = tempfile::tempdir().expect("a folder");
    run(dir.path()).expect("no faults");
    let whole = contents(dir.path());
    plan(dir.path(), usize::MAX, false);
    assert_eq!(run(dir.path()).expect("no faults").kept, 2);
    let operations = end(dir.path());
    assert!(operations.contains(&Operation::Read));
    for (first, operation) in operations.iter().enumerate() {
        plan(dir.path(), first, true);
        let _ = run(dir.path());
        end(dir.path());
        assert!(contents(dir.path()) == whole, "{operation:?}, operation {first}");
    }
}

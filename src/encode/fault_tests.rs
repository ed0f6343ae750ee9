//! Every operation on files fails once, and from then on: nothing appears by halves, nothing stays behind, and the next
//! run makes what one without faults makes.

use super::disk::Operation;
use super::disk::faults::{end, plan};
use super::*;
use crate::base::color::Rgb;
use crate::base::digest::Digest;
use crate::base::time::Rate;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

const SIZE: (u32, u32) = (6, 4);
const FRAMES: [u32; 2] = [3, 4];

/// Writes all formats but those that are like others, into two folders.
fn run(folder: &Path) -> Result<Report, EncodeError> {
    let outputs = ["new/f_#.png", "new/f_#.exr", "new/f_#.jpg", "a.gif", "a.mp4", "a.apng"];
    let mut encoder = started(folder, &outputs, Existing::Keep)?;
    for frame in encoder.missing() {
        encoder.push(frame, film(frame))?;
    }
    encoder.finish()
}

/// Writes frames that others may make, too: each is a film of its own.
fn shared(folder: &Path) -> Result<Report, EncodeError> {
    let mut encoder = started(folder, &["new/f_#.png", "new/f_#.exr"], Existing::Share)?;
    for frame in encoder.missing() {
        match encoder.ask(Digest(frame.into()), &[frame])? {
            Asked::Mine(frames) => {
                frames.into_iter().try_for_each(|frame| encoder.push(frame, film(frame)))?
            }
            other => panic!("{other:?}"),
        }
    }
    encoder.finish()
}

fn film(frame: u32) -> Film {
    let extras = crate::film::Extras { coverage: true, guides: false };
    let mut film = Film::with_extras(SIZE.0, SIZE.1, vec![Rgb::ONE], extras);
    for (place, value) in film.data_mut().iter_mut().enumerate() {
        *value = Rgb::splat(frame as f32 * 0.01 + place as f32 * 0.02);
    }
    film
}

fn started(folder: &Path, outputs: &[&str], existing: Existing) -> Result<Encoder, EncodeError> {
    let outputs = outputs.iter().copied();
    let outputs = outputs.map(|name| Output::parse(folder.join(name)).expect(name));
    let seen = |frame: &u32| Seen { radiance: Digest(u128::from(*frame)), exposure: 1.0, ..Seen::default() };
    let job = Job {
        outputs: outputs.collect(),
        confined: false,
        existing,
        frames: FRAMES.to_vec(),
        seen: FRAMES.iter().map(seen).collect(),
        rate: Rate::new(24, 1).expect("a rate"),
        size: SIZE,
        tonemap: Tonemap::default(),
        // The GIF's frames wait in a spool.
        transparent: true,
        matte: MATTE,
        caption: None,
        formats: Formats::default(),
        about: About::default(),
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
    Encoder::start(job, Arc::new(pool), &Stop::default())
}

/// All files in a folder and below, by their names.
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
fn whatever_fails_no_file_is_partial_and_the_next_run_goes_on() {
    let operations = failing(run, 10);
    for kind in
        [Operation::CreateFolder, Operation::Create, Operation::Write, Operation::Sync, Operation::Rename]
    {
        assert!(operations.contains(&kind), "{kind:?}");
    }
}

#[test]
fn whatever_fails_no_claim_stays() {
    failing(shared, 5);
}

/// Lets every operation of a run that makes so many files and folders fail.
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
            // Files are stored beside each other, so that their operations come in one order or another.
            let failed = end(dir.path()).get(first).copied();
            // A file that cannot be looked at is made again; all else ends the run, with a word of the place.
            if failed.is_some_and(|operation| operation != Operation::Read || lasts) {
                let told = done.expect_err(&what).to_string();
                assert!(told.contains(&*dir.path().to_string_lossy()), "{what}: {told}");
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

/// The second run reads what is there, to keep it and to make animations of it.
#[test]
fn whatever_fails_as_a_run_goes_on_frames_stay() {
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

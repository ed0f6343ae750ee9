//! Checks of frames on disk before an animation is made from them: which frames are missing, damaged, outdated, or
//! inconsistent with the others.

use super::assembler::decode_picture;
use super::flaw::Flaw;
use super::job::EncodeJob;
use super::metadata::{self, StoredTextEntry};
use super::output::StillFormat;
use super::pattern::FramePattern;
use super::png::{self, Seal};
use crate::base::files;
use crate::base::time::Rate;
use rayon::ThreadPool;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// The result of inspecting frames together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Inspection {
    /// The frames with a flaw, in ascending order.
    pub flaws: Vec<(u32, Flaw)>,
    /// The name of the sequence, from the frames' metadata.
    pub name: Option<String>,
    pub rate: Option<Rate>,
    /// The number of frames of the whole sequence.
    pub frames: Option<u32>,
    /// The frames without metadata.
    pub without_metadata: Vec<u32>,
}

/// The reason for a file with a broken seal.
const CHANGED: &str = "its bytes are not those that were written";
/// The reason for a broken PNG without a seal.
const BROKEN: &str = "it is not a complete PNG";

/// Finds the flaws of the PNG files of a pattern, which should be the frames of a job. They are in the job's order.
pub fn inspect_job(job: &EncodeJob, pattern: &FramePattern, pool: &ThreadPool) -> Vec<(u32, Flaw)> {
    let flaw = |(index, &frame): (usize, &u32)| {
        let path = pattern.path(frame);
        flaw_in_job(job, index, &path).map(|flaw| (frame, flaw))
    };
    pool.install(|| job.frames.par_iter().enumerate().filter_map(flaw).collect())
}

fn flaw_in_job(job: &EncodeJob, index: usize, path: &Path) -> Option<Flaw> {
    let mut bytes = match png::read_bytes(path, job.size) {
        Ok(bytes) => bytes,
        Err(error) => return Some(unreadable(&error)),
    };
    let expected = job.identity(StillFormat::Png, index).map(|identity| identity.to_string());
    match (png::verify(&mut bytes), expected) {
        (Seal::Broken, _) => Some(Flaw::Damaged(CHANGED.to_owned())),
        (Seal::Intact(name), Some(expected)) => (name != expected).then_some(Flaw::Stale),
        (Seal::Intact(_), None) => wrong_size(&bytes, job.size),
        (_, _) if !png::is_whole(&bytes) => Some(Flaw::Damaged(BROKEN.to_owned())),
        (Seal::NoDigest(name), Some(expected)) if name == expected => Some(Flaw::NoDigest),
        (Seal::NoDigest(_), Some(_)) => Some(Flaw::Stale),
        (Seal::Missing, Some(_)) => Some(Flaw::NoMetadata),
        (Seal::NoDigest(_) | Seal::Missing, None) => wrong_size(&bytes, job.size),
    }
}

/// The flaw of a picture of another size. The size is all that can be checked without an identity.
fn wrong_size(bytes: &[u8], size: (u32, u32)) -> Option<Flaw> {
    let found = png::size_in(bytes).filter(|found| *found != size)?;
    Some(Flaw::Inconsistent(format!("{} pixels, not {}", pixels(found), pixels(size))))
}

fn pixels((width, height): (u32, u32)) -> String {
    format!("{width}x{height}")
}

fn unreadable(error: &io::Error) -> Flaw {
    match error.kind() {
        ErrorKind::NotFound => Flaw::Missing,
        _ => Flaw::Damaged(files::describe(error)),
    }
}

/// Inspects frames that are to be shown one after the other, without knowing their sequence.
pub fn inspect(frames: &[(u32, PathBuf)], pool: &ThreadPool) -> Inspection {
    let read = |(frame, path): &(u32, PathBuf)| (*frame, read_metadata(path));
    let read: Vec<_> = pool.install(|| frames.par_iter().map(read).collect());
    let mut found = Inspection::default();
    let (mut described, mut sizes) = (Vec::new(), BTreeMap::<String, Vec<u32>>::new());
    for (frame, result) in read {
        let (size, entries) = match result {
            Ok(read) => read,
            Err(flaw) => {
                found.flaws.push((frame, flaw));
                continue;
            }
        };
        sizes.entry(pixels(size)).or_default().push(frame);
        if entries.is_empty() {
            found.without_metadata.push(frame);
        } else {
            described.push((frame, entries));
        }
    }
    found.flaws.extend(inconsistent(&described, sizes));
    found.flaws.sort();
    let count = |entries: &Vec<StoredTextEntry>| metadata::find(entries, metadata::FRAMES)?.parse().ok();
    found.frames = described.iter().filter_map(|(_, entries)| count(entries)).max();
    let name = described.first().and_then(|(_, entries)| metadata::find(entries, metadata::TITLE));
    found.name = name.map(str::to_owned);
    found.rate = described.iter().find_map(|(_, entries)| rate(entries));
    found
}

/// The size and the metadata of a picture; no metadata if Kinora did not write it. A damaged file is an error.
fn read_metadata(path: &Path) -> Result<((u32, u32), Vec<StoredTextEntry>), Flaw> {
    let mut bytes = files::read(path, u64::MAX - 1).map_err(|error| unreadable(&error))?;
    let damaged = |why: &str| Flaw::Damaged(why.to_owned());
    if !png::is_png(&bytes) {
        return match decode_picture(&bytes) {
            Ok(picture) => Ok(((picture.width, picture.height), Vec::new())),
            Err(error) => Err(damaged(&error.to_string())),
        };
    }
    match png::verify(&mut bytes) {
        Seal::Broken => return Err(damaged(CHANGED)),
        Seal::NoDigest(_) | Seal::Missing if !png::is_whole(&bytes) => return Err(damaged(BROKEN)),
        Seal::Intact(_) | Seal::NoDigest(_) | Seal::Missing => {}
    }
    let entries = png::texts_in(&bytes);
    let ours = metadata::find(&entries, metadata::FRAME).is_some();
    let size = png::size_in(&bytes).ok_or_else(|| damaged(BROKEN))?;
    Ok((size, if ours { entries } else { Vec::new() }))
}

/// Keywords whose values frames of one run share, and their names in messages.
const SHARED: [(&str, &str); 8] = [
    ("Software", "version"),
    (metadata::TITLE, "sequence"),
    ("kinora:seed", "seed"),
    ("kinora:samples", "number of samples"),
    ("kinora:noise", "error"),
    ("kinora:denoise", "denoiser"),
    ("kinora:antialias", "antialias"),
    (metadata::TIME_LIMIT, "time limit"),
];

/// Frames whose file name has the wrong number, and frames that differ from most others. `sizes` groups all frames by
/// their size.
fn inconsistent(
    described: &[(u32, Vec<StoredTextEntry>)],
    sizes: BTreeMap<String, Vec<u32>>,
) -> BTreeMap<u32, Flaw> {
    let mut flaws = BTreeMap::new();
    for (frame, entries) in described {
        let number = metadata::find(entries, metadata::FRAME).filter(|number| *number != frame.to_string());
        if let Some(number) = number {
            flaws.insert(*frame, Flaw::Inconsistent(format!("frame {number} under another number")));
        }
    }
    let rates = |entries: &Vec<StoredTextEntry>| rate(entries).map(|rate| rate.to_string());
    let shared = SHARED.iter().map(|(keyword, what)| {
        let value = |entries: &Vec<StoredTextEntry>| metadata::find(entries, keyword).map(str::to_owned);
        (*what, values(described, value))
    });
    for (what, values) in shared.chain([("rate", values(described, rates)), ("size", sizes)]) {
        // The value of most frames. Of equally frequent values, the value of the first frame.
        let most = values.iter().max_by_key(|(_, frames)| (frames.len(), std::cmp::Reverse(frames[0])));
        let Some((usual, _)) = most else { continue };
        for (value, frames) in values.iter().filter(|(value, _)| *value != usual) {
            for frame in frames {
                let what = || Flaw::Inconsistent(format!("{what} {value}; most frames have {usual}"));
                flaws.entry(*frame).or_insert_with(what);
            }
        }
    }
    flaws
}

/// Groups frames by a value of their metadata.
fn values(
    described: &[(u32, Vec<StoredTextEntry>)],
    value: impl Fn(&Vec<StoredTextEntry>) -> Option<String>,
) -> BTreeMap<String, Vec<u32>> {
    let mut values: BTreeMap<String, Vec<u32>> = BTreeMap::new();
    for (frame, entries) in described {
        if let Some(value) = value(entries) {
            values.entry(value).or_default().push(*frame);
        }
    }
    values
}

/// The frame rate that follows from a frame's number and time. `None` for frame 0, whose time is 0 at any rate.
fn rate(entries: &[StoredTextEntry]) -> Option<Rate> {
    let number: i128 = metadata::find(entries, metadata::FRAME)?.parse().ok()?;
    let time = metadata::find(entries, metadata::TIME)?;
    let (part, whole) = time.split_once('/').unwrap_or((time, "1"));
    Rate::new(number.checked_mul(whole.parse().ok()?)?, part.parse().ok()?)
}

//! Frames on disk, looked at before anything is made of them: which are missing or damaged, and which are not those that
//! they should be, as far as that can be known.

use super::assembly::decode_picture;
use super::job::Job;
use super::output::Still;
use super::pattern::FramePattern;
use super::png::{self, Seal};
use super::record::{self, Told};
use crate::base::files;
use crate::base::time::Rate;
use rayon::ThreadPool;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::fmt;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// What is wrong with a frame.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Flaw {
    Missing,
    /// It is no whole picture, or not as it was written; with the reason.
    Damaged(String),
    /// It would be made otherwise now.
    Stale,
    /// It holds no digest of its pixels, as earlier versions wrote it.
    Unsealed,
    /// It does not say what it shows, although its job's frames do.
    Silent,
    /// It differs from most of the others, or from what is to be made, in something that frames of one run share.
    Odd(String),
}

impl fmt::Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Missing => f.write_str("missing"),
            Self::Damaged(why) => write!(f, "damaged: {why}"),
            Self::Stale => f.write_str("stale: would be made otherwise now"),
            Self::Unsealed => {
                f.write_str("without a digest of their pixels, as earlier versions of Kinora wrote them")
            }
            Self::Silent => f.write_str("without a word on what they show, as --no-metadata writes them"),
            Self::Odd(what) => f.write_str(what),
        }
    }
}

/// Frames that were looked at together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Inspected {
    /// What is wrong with some of them, in their order.
    pub flaws: Vec<(u32, Flaw)>,
    /// The name that they tell of their sequence, its rate, and how many frames it has.
    pub name: Option<String>,
    pub rate: Option<Rate>,
    pub frames: Option<u32>,
    /// Those that tell nothing.
    pub silent: Vec<u32>,
}

/// Not as it was written.
const CHANGED: &str = "its bytes are not those that were written";
/// Of a PNG that nobody has sealed.
const BROKEN: &str = "it is no whole PNG";

/// What is wrong with the PNGs that are called like this, if they are to be the frames of a job, in the job's order.
pub fn inspect_job(job: &Job, pattern: &FramePattern, pool: &ThreadPool) -> Vec<(u32, Flaw)> {
    let flaw = |(index, &frame): (usize, &u32)| {
        let path = pattern.path(frame);
        flaw_in_job(job, index, &path).map(|flaw| (frame, flaw))
    };
    pool.install(|| job.frames.par_iter().enumerate().filter_map(flaw).collect())
}

fn flaw_in_job(job: &Job, index: usize, path: &Path) -> Option<Flaw> {
    let mut bytes = match png::bytes_of(path, job.size) {
        Ok(bytes) => bytes,
        Err(error) => return Some(unreadable(&error)),
    };
    let expected = job.identity(Still::Png, index).map(|identity| identity.to_string());
    match (png::look(&mut bytes), expected) {
        (Seal::Broken, _) => Some(Flaw::Damaged(CHANGED.to_owned())),
        (Seal::Whole(name), Some(expected)) => (name != expected).then_some(Flaw::Stale),
        (Seal::Whole(_), None) => of_another_size(&bytes, job.size),
        (_, _) if !png::check(&bytes) => Some(Flaw::Damaged(BROKEN.to_owned())),
        (Seal::Open(name), Some(expected)) if name == expected => Some(Flaw::Unsealed),
        (Seal::Open(_), Some(_)) => Some(Flaw::Stale),
        (Seal::None, Some(_)) => Some(Flaw::Silent),
        (Seal::Open(_) | Seal::None, None) => of_another_size(&bytes, job.size),
    }
}

/// What does not say what it shows may be a picture of anything; its size is known.
fn of_another_size(bytes: &[u8], size: (u32, u32)) -> Option<Flaw> {
    let found = png::size_in(bytes).filter(|found| *found != size)?;
    Some(Flaw::Odd(format!("{} pixels, not {}", pixels(found), pixels(size))))
}

fn pixels((width, height): (u32, u32)) -> String {
    format!("{width}x{height}")
}

fn unreadable(error: &io::Error) -> Flaw {
    match error.kind() {
        ErrorKind::NotFound => Flaw::Missing,
        _ => Flaw::Damaged(files::why(error)),
    }
}

/// Looks at frames of which nothing is known but that they are to be shown one after the other.
pub fn inspect(frames: &[(u32, PathBuf)], pool: &ThreadPool) -> Inspected {
    let look = |(frame, path): &(u32, PathBuf)| (*frame, words_of(path));
    let looked: Vec<_> = pool.install(|| frames.par_iter().map(look).collect());
    let mut found = Inspected::default();
    let (mut told, mut sizes) = (Vec::new(), BTreeMap::<String, Vec<u32>>::new());
    for (frame, seen) in looked {
        let (size, words) = match seen {
            Ok(seen) => seen,
            Err(flaw) => {
                found.flaws.push((frame, flaw));
                continue;
            }
        };
        sizes.entry(pixels(size)).or_default().push(frame);
        if words.is_empty() {
            found.silent.push(frame);
        } else {
            told.push((frame, words));
        }
    }
    let odd = odd(&told, sizes);
    found.flaws.extend(odd);
    found.flaws.sort();
    let number = |words: &Vec<Told>| record::find(words, record::FRAMES)?.parse().ok();
    found.frames = told.iter().filter_map(|(_, words)| number(words)).max();
    found.name = told.first().and_then(|(_, words)| record::find(words, record::TITLE)).map(str::to_owned);
    found.rate = told.iter().find_map(|(_, words)| rate(words));
    found
}

/// The size of a picture and its metadata; no metadata if Kinora did not write it. An error if the file is damaged.
fn words_of(path: &Path) -> Result<((u32, u32), Vec<Told>), Flaw> {
    let mut bytes = files::read(path, u64::MAX - 1).map_err(|error| unreadable(&error))?;
    let damaged = |why: &str| Flaw::Damaged(why.to_owned());
    if !png::is_png(&bytes) {
        return match decode_picture(&bytes) {
            Ok(picture) => Ok(((picture.width, picture.height), Vec::new())),
            Err(error) => Err(damaged(&error.to_string())),
        };
    }
    match png::look(&mut bytes) {
        Seal::Broken => return Err(damaged(CHANGED)),
        Seal::Open(_) | Seal::None if !png::check(&bytes) => return Err(damaged(BROKEN)),
        Seal::Whole(_) | Seal::Open(_) | Seal::None => {}
    }
    let words = png::texts_in(&bytes);
    let ours = record::find(&words, record::FRAME).is_some();
    let size = png::size_in(&bytes).ok_or_else(|| damaged(BROKEN))?;
    Ok((size, if ours { words } else { Vec::new() }))
}

/// What frames of one run share if they tell it, and how it is called.
const SHARED: [(&str, &str); 7] = [
    ("Software", "version"),
    (record::TITLE, "sequence"),
    ("kinora:seed", "seed"),
    ("kinora:samples", "number of samples"),
    ("kinora:noise", "error"),
    ("kinora:antialias", "antialias"),
    (record::TIME_LIMIT, "limit of time"),
];

/// Frames that are not what their names say, and those that differ from most; `sizes` are those of all.
fn odd(told: &[(u32, Vec<Told>)], sizes: BTreeMap<String, Vec<u32>>) -> BTreeMap<u32, Flaw> {
    let mut odd = BTreeMap::new();
    for (frame, words) in told {
        if let Some(shown) = record::find(words, record::FRAME).filter(|shown| *shown != frame.to_string()) {
            odd.insert(*frame, Flaw::Odd(format!("frame {shown} under another number")));
        }
    }
    let rates = |words: &Vec<Told>| rate(words).map(|rate| rate.to_string());
    let shared = SHARED.iter().map(|(keyword, what)| {
        let value = |words: &Vec<Told>| record::find(words, keyword).map(str::to_owned);
        (*what, values(told, value))
    });
    for (what, values) in shared.chain([("rate", values(told, rates)), ("size", sizes)]) {
        // What most frames have; of two that as many have, that of the first frame.
        let most = values.iter().max_by_key(|(_, frames)| (frames.len(), std::cmp::Reverse(frames[0])));
        let Some((usual, _)) = most else { continue };
        for (value, frames) in values.iter().filter(|(value, _)| *value != usual) {
            for frame in frames {
                let what = || Flaw::Odd(format!("another {what} than most: {value}, not {usual}"));
                odd.entry(*frame).or_insert_with(what);
            }
        }
    }
    odd
}

/// Which frames tell which value, in their order.
fn values(
    told: &[(u32, Vec<Told>)],
    value: impl Fn(&Vec<Told>) -> Option<String>,
) -> BTreeMap<String, Vec<u32>> {
    let mut values: BTreeMap<String, Vec<u32>> = BTreeMap::new();
    for (frame, words) in told {
        if let Some(value) = value(words) {
            values.entry(value).or_default().push(*frame);
        }
    }
    values
}

/// The rate at which a frame is shown where it says that it is; the first one is so at any.
fn rate(words: &[Told]) -> Option<Rate> {
    let number: i128 = record::find(words, record::FRAME)?.parse().ok()?;
    let time = record::find(words, record::TIME)?;
    let (part, whole) = time.split_once('/').unwrap_or((time, "1"));
    Rate::new(number.checked_mul(whole.parse().ok()?)?, part.parse().ok()?)
}

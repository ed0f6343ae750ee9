//! What an EXR file says about itself: its identity, and a digest of the whole file, as the format has no sums of its
//! own. Where the digest stands, zeros are digested in its place.

use crate::base::digest::{Digest, Digester};
use crate::base::files;
use crate::encode::atomic::Aside;
use crate::encode::disk::{Operation, attempt};
use crate::encode::job::Job;
use crate::encode::keep::Held;
use crate::encode::record::{self, Told};
use exr::meta::attribute::{AttributeValue, Text};
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;

/// The attribute's name.
pub const SEAL: &str = "kinora:identity";

/// The name of the attribute that tells in words what the file shows.
pub const WORDS: &str = "kinora:about";

/// How that begins in the file.
const TELLS: &[u8] = b"kinora:about\0string\0";

/// How the seal begins in the file: its name and its type, before four bytes of length.
const START: &[u8] = b"kinora:identity\0string\0";

/// Digits of a digest.
const DIGITS: usize = 32;

/// Bytes of a file's header at most, and of what stands between its blocks.
const BESIDES: usize = 1 << 22;

/// The attribute before the rest of the file is known.
pub fn open(identity: Digest) -> AttributeValue {
    AttributeValue::Text(Text::from(format!("{identity} {:0DIGITS$}", 0).as_str()))
}

/// Puts the digest in its place, once all has been written.
pub fn close(file: &mut Aside) -> io::Result<()> {
    file.seek(SeekFrom::Start(0))?;
    let mut head = Vec::new();
    Read::by_ref(file).take(BESIDES as u64).read_to_end(&mut head)?;
    let place = place_in(&head).ok_or(io::ErrorKind::InvalidData)?;
    let mut digester = Digester::new();
    digester.bytes(&head);
    let mut piece = vec![0; 1 << 16];
    loop {
        match file.read(&mut piece)? {
            0 => break,
            read => digester.bytes(&piece[..read]),
        }
    }
    file.seek(SeekFrom::Start(place as u64))?;
    file.write_all(digester.finish().to_string().as_bytes())
}

/// Where the digest stands in a file that starts like this.
fn place_in(head: &[u8]) -> Option<usize> {
    let start = head.windows(START.len()).position(|window| window == START)?;
    Some(start + START.len() + size_of::<u32>() + DIGITS + 1).filter(|place| place + DIGITS <= head.len())
}

/// What a file tells in words; nothing of what is no file of ours.
pub fn texts(path: &Path) -> Vec<Told> {
    let read = || -> io::Result<Vec<u8>> {
        let mut head = Vec::new();
        File::open(path)?.take(BESIDES as u64).read_to_end(&mut head)?;
        Ok(head)
    };
    read().ok().and_then(|head| told_in(&head)).unwrap_or_default()
}

fn told_in(head: &[u8]) -> Option<Vec<Told>> {
    let start = head.windows(TELLS.len()).position(|window| window == TELLS)? + TELLS.len();
    let (length, rest) = head.get(start..)?.split_first_chunk()?;
    let text = rest.get(..u32::from_le_bytes(*length) as usize)?;
    // Latin-1: every byte is the number of its letter.
    Some(record::of_lines(&text.iter().copied().map(char::from).collect::<String>()))
}

/// What there is of the frame with this identity in a file: all of it if not a byte has changed.
pub fn holds(path: &Path, identity: Digest, job: &Job) -> Held {
    // Layers take what they take; a picture without compression takes less than this of each.
    let layers = job.about.layers.len() as u64 + 4;
    let most = u64::from(job.size.0) * u64::from(job.size.1) * 16 * layers + BESIDES as u64;
    let read = attempt(Operation::Read, path, || files::read(path, most));
    if read.is_ok_and(|bytes| is_whole(bytes, identity)) { Held::Right } else { Held::Stale }
}

fn is_whole(mut bytes: Vec<u8>, identity: Digest) -> bool {
    let head = bytes.len().min(BESIDES);
    let Some(place) = place_in(&bytes[..head]) else { return false };
    if bytes[place - DIGITS - 1..place - 1] != *identity.to_string().as_bytes() {
        return false;
    }
    let found = bytes[place..place + DIGITS].to_vec();
    bytes[place..place + DIGITS].fill(b'0');
    let mut digester = Digester::new();
    digester.bytes(&bytes);
    digester.finish().to_string().as_bytes() == found
}

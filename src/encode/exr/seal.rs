//! The seal of an EXR file: its identity and a digest of the whole file, because the format has no checksums. The
//! digest is computed with zeros in the place of the digest itself.

use crate::base::digest::{Digest, Digester};
use crate::base::files;
use crate::encode::atomic::AtomicFile;
use crate::encode::disk::{Operation, attempt};
use crate::encode::file_state::FileState;
use crate::encode::metadata::{StoredTextEntry, from_lines};
use exr::meta::attribute::{AttributeValue, Text};
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;

/// The name of the attribute that holds the seal.
pub const IDENTITY: &str = "kinora:identity";

/// The name of the attribute that holds the metadata.
pub const METADATA: &str = "kinora:about";

/// The bytes in the file before the metadata: the attribute's name and type. Four bytes of length follow.
const METADATA_HEAD: &[u8] = b"kinora:about\0string\0";

/// The bytes in the file before the seal: the attribute's name and type. Four bytes of length follow.
const SEAL_HEAD: &[u8] = b"kinora:identity\0string\0";

/// Hexadecimal digits of a digest.
const DIGITS: usize = 32;

/// Bytes of a file's header and block tables, at most.
const MAX_OVERHEAD: usize = 1 << 22;

/// The attribute with zeros in place of the digest, which is not known yet.
pub fn open(identity: Digest) -> AttributeValue {
    AttributeValue::Text(Text::from(format!("{identity} {:0DIGITS$}", 0).as_str()))
}

/// Computes the digest of a complete file and writes it into the attribute.
pub fn close(file: &mut AtomicFile) -> io::Result<()> {
    file.seek(SeekFrom::Start(0))?;
    let mut head = Vec::new();
    Read::by_ref(file).take(MAX_OVERHEAD as u64).read_to_end(&mut head)?;
    let place = digest_offset(&head).ok_or(io::ErrorKind::InvalidData)?;
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

/// The offset of the digest, given the start of the file.
fn digest_offset(head: &[u8]) -> Option<usize> {
    let start = head.windows(SEAL_HEAD.len()).position(|window| window == SEAL_HEAD)?;
    Some(start + SEAL_HEAD.len() + size_of::<u32>() + DIGITS + 1).filter(|place| place + DIGITS <= head.len())
}

/// The metadata of an EXR file. Empty if Kinora did not write the file.
pub fn texts(path: &Path) -> Vec<StoredTextEntry> {
    let read = || -> io::Result<Vec<u8>> {
        let mut head = Vec::new();
        File::open(path)?.take(MAX_OVERHEAD as u64).read_to_end(&mut head)?;
        Ok(head)
    };
    read().ok().and_then(|head| metadata_in(&head)).unwrap_or_default()
}

fn metadata_in(head: &[u8]) -> Option<Vec<StoredTextEntry>> {
    let start = head.windows(METADATA_HEAD.len()).position(|window| window == METADATA_HEAD)?;
    let start = start + METADATA_HEAD.len();
    let (length, rest) = head.get(start..)?.split_first_chunk()?;
    let text = rest.get(..u32::from_le_bytes(*length) as usize)?;
    // In Latin-1, every byte is the code point of its character.
    Some(from_lines(&text.iter().copied().map(char::from).collect::<String>()))
}

/// The state of a file that should hold the frame with this identity. It is current if no byte has changed.
pub fn state(path: &Path, identity: Digest, size: (u32, u32), light_groups: usize) -> FileState {
    // An upper bound of the size without compression.
    let layers = light_groups as u64 + 4;
    let most = u64::from(size.0) * u64::from(size.1) * 16 * layers + MAX_OVERHEAD as u64;
    let read = attempt(Operation::Read, path, || files::read(path, most));
    if read.is_ok_and(|bytes| is_whole(bytes, identity)) { FileState::Current } else { FileState::Stale }
}

fn is_whole(mut bytes: Vec<u8>, identity: Digest) -> bool {
    let head = bytes.len().min(MAX_OVERHEAD);
    let Some(place) = digest_offset(&bytes[..head]) else { return false };
    if bytes[place - DIGITS - 1..place - 1] != *identity.to_string().as_bytes() {
        return false;
    }
    let found = bytes[place..place + DIGITS].to_vec();
    bytes[place..place + DIGITS].fill(b'0');
    let mut digester = Digester::new();
    digester.bytes(&bytes);
    digester.finish().to_string().as_bytes() == found
}

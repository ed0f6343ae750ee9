//! Files and data that a glTF file names by URIs.

use crate::base::files::{self, Root};
use crate::base::lists::shortened;
use crate::base::machine;
use base64::Engine;
use base64::engine::DecodePaddingMode;
use base64::engine::general_purpose::{GeneralPurpose, GeneralPurposeConfig};
use std::borrow::Cow;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Base64 with or without padding.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &base64::alphabet::STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// Where URIs lead: paths are relative to `folder` and must be within `root`.
pub struct Resources<'a> {
    pub folder: &'a Path,
    pub root: &'a Root,
}

impl Resources<'_> {
    /// The path of a file.
    pub fn path(&self, uri: &str) -> Result<PathBuf, String> {
        if uri.split_once(':').is_some_and(|(scheme, _)| scheme.len() > 1 && !scheme.contains('/')) {
            return Err("its `uri` is neither a relative path nor a data URI".to_owned());
        }
        let name = decoded(uri).ok_or("its `uri` is no UTF-8 text after percent-decoding")?;
        let path = self.folder.join(&name);
        // Pipes and folders are refused here, where their names are known.
        self.root
            .admit(&path)
            .and_then(|path| files::open(&path, u64::MAX).map(|_| path))
            .map_err(|error| format!("cannot read {:?}: {}", shortened(&name), files::describe(&error)))
    }
}

/// The first `length` bytes of a file, or all of a shorter one.
pub fn start_of(path: &Path, length: usize) -> Result<Vec<u8>, String> {
    let read = || {
        let (file, size) = files::open(path, u64::MAX)?;
        machine::check_memory(size.min(length as u64))?;
        let mut bytes = Vec::new();
        file.take(length as u64).read_to_end(&mut bytes)?;
        Ok(bytes)
    };
    read().map_err(|error| files::describe(&error))
}

/// The part of a data URI behind `data:`. The names of schemes have no case.
fn behind_scheme(uri: &str) -> Option<&str> {
    const SCHEME: &str = "data:";
    uri.get(..SCHEME.len()).filter(|scheme| scheme.eq_ignore_ascii_case(SCHEME))?;
    uri.get(SCHEME.len()..)
}

/// Whether a URI is a data URI.
pub fn is_data(uri: &str) -> bool {
    behind_scheme(uri).is_some()
}

/// The bytes of a data URI (RFC 2397); none if it is no data URI.
pub fn data(uri: &str) -> Option<Result<Vec<u8>, String>> {
    let (kind, text) = behind_scheme(uri)?.split_once(',').unwrap_or_default();
    if !kind.rsplit_once(';').is_some_and(|(_, encoding)| encoding.eq_ignore_ascii_case("base64")) {
        return Some(Err("its data URI is not in base64".to_owned()));
    }
    let text =
        if text.contains('%') { decoded(text).map_or(Cow::Borrowed(text), Cow::Owned) } else { text.into() };
    Some(BASE64.decode(&*text).map_err(|error| format!("its data URI is wrong: {error}")))
}

/// A text without percent-encoding (RFC 3986, section 2.1).
fn decoded(uri: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.bytes();
    while let Some(byte) = rest.next() {
        let code = if byte == b'%' { rest.hex_pair() } else { None };
        bytes.push(code.unwrap_or(byte));
    }
    String::from_utf8(bytes).ok()
}

/// The code of two hexadecimal digits that come next.
trait HexPair {
    fn hex_pair(&mut self) -> Option<u8>;
}

impl HexPair for std::str::Bytes<'_> {
    fn hex_pair(&mut self) -> Option<u8> {
        let mut ahead = self.clone();
        let digit = |byte: u8| char::from(byte).to_digit(16);
        let code = 16 * digit(ahead.next()?)? + digit(ahead.next()?)?;
        *self = ahead;
        Some(code as u8)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percent_codes_are_decoded() {
        assert_eq!(decoded("a%20b%C3%a4.bin").as_deref(), Some("a bä.bin"));
        assert_eq!(decoded("100%.bin").as_deref(), Some("100%.bin"));
        assert_eq!(decoded("%ff"), None);
    }

    #[test]
    fn data_is_base64_with_or_without_padding() {
        for text in [
            "data:application/octet-stream;base64,AAEC/w==",
            "data:;base64,AAEC/w",
            "DATA:application/octet-stream;charset=x;BASE64,AAEC%2Fw%3D%3D",
        ] {
            assert_eq!(data(text).expect("data").expect("base64"), [0, 1, 2, 255]);
        }
        assert!(data("a.bin").is_none() && !is_data("dat") && !is_data("datä:;base64,AA"));
        assert!(data("data:,text").expect("data").is_err());
        assert!(data("data:;base64,A*").expect("data").is_err());
    }
}

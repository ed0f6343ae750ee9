//! Files and data that a glTF file names by URIs.

use crate::base::files::{self, Root};
use base64::Engine;
use base64::engine::DecodePaddingMode;
use base64::engine::general_purpose::{GeneralPurpose, GeneralPurposeConfig};
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
    /// The bytes of a data URI, or of a file of at most `limit` bytes.
    pub fn bytes(&self, uri: &str, limit: u64) -> Result<Vec<u8>, String> {
        if let Some(data) = data(uri) {
            return data;
        }
        files::read(&self.path(uri)?, limit).map_err(|error| files::describe(&error))
    }

    /// The path of a file.
    pub fn path(&self, uri: &str) -> Result<PathBuf, String> {
        if uri.split_once(':').is_some_and(|(scheme, _)| scheme.len() > 1 && !scheme.contains('/')) {
            return Err("its `uri` is neither a relative path nor a data URI".to_owned());
        }
        let name = decoded(uri).ok_or("its `uri` is no UTF-8 text after percent-decoding")?;
        self.root
            .admit(&self.folder.join(&name))
            .map_err(|error| format!("cannot read {name:?}: {}", files::describe(&error)))
    }
}

/// The bytes of a data URI; none if it is no data URI.
pub fn data(uri: &str) -> Option<Result<Vec<u8>, String>> {
    let rest = uri.strip_prefix("data:")?;
    let Some((_, text)) = rest.split_once(";base64,") else {
        return Some(Err("its data URI is not in base64".to_owned()));
    };
    Some(BASE64.decode(text).map_err(|error| format!("its data URI is wrong: {error}")))
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
        for text in ["data:application/octet-stream;base64,AAEC/w==", "data:;base64,AAEC/w"] {
            assert_eq!(data(text).expect("data").expect("base64"), [0, 1, 2, 255]);
        }
        assert!(data("a.bin").is_none());
        assert!(data("data:,text").expect("data").is_err());
        assert!(data("data:;base64,A*").expect("data").is_err());
    }
}

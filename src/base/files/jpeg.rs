//! Detects truncated JPEG files, because decoders fill the missing part with grey.

/// The first bytes of a JPEG file.
const START: [u8; 3] = [0xff, 0xd8, 0xff];

/// Whether a file begins like a JPEG but lacks the end marker (EOI) of ITU-T T.81, B.1.1.3.
pub fn is_truncated(bytes: &[u8]) -> bool {
    if !bytes.starts_with(&START) {
        return false;
    }
    let mut rest = &bytes[2..];
    // In data, 00 follows an FF. A marker may have any number of FF before it.
    while let Some(at) = rest.windows(2).position(|pair| pair[0] == 0xff && !matches!(pair[1], 0x00 | 0xff)) {
        let marker = rest[at + 1];
        rest = &rest[at + 2..];
        match marker {
            0xd9 => return false,
            // These markers have no segment.
            0x01 | 0xd0..=0xd8 => {}
            // A segment begins with its length, which includes these two bytes.
            _ => {
                let length = rest.first_chunk().map_or(usize::MAX, |bytes| u16::from_be_bytes(*bytes).into());
                rest = rest.get(length..).unwrap_or_default();
            }
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_cut_wherever_it_ends_early() {
        let thumbnail = [0xff, 0xd8, 0xff, 0xd9];
        let mut file = vec![0xff, 0xd8, 0xff, 0xe1, 0, 6];
        file.extend(thumbnail);
        // A scan with byte stuffing, a restart and fill bytes, and its end.
        file.extend([0xff, 0xda, 0, 3, 1, 7, 0xff, 0, 8, 0xff, 0xd0, 9, 0xff, 0xff, 0xd9]);
        assert!(!is_truncated(&file));
        assert!((3..file.len()).all(|end| is_truncated(&file[..end])));
        file.extend(b"what comes after it");
        assert!(!is_truncated(&file) && !is_truncated(b"\x89PNG") && !is_truncated(b""));
    }
}

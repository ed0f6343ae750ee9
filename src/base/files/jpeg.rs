//! Whether a JPEG file is whole: decoders fill with grey what is missing of one.

/// How a JPEG file begins.
const START: [u8; 3] = [0xff, 0xd8, 0xff];

/// Whether a file begins like a JPEG and ends before its picture does: it has no end marker, as ITU-T T.81, B.1.1.3, has it.
pub fn is_cut(bytes: &[u8]) -> bool {
    if !bytes.starts_with(&START) {
        return false;
    }
    let mut rest = &bytes[2..];
    // In data an FF is followed by 00, and before a marker there may be any number of them.
    while let Some(at) = rest.windows(2).position(|pair| pair[0] == 0xff && !matches!(pair[1], 0x00 | 0xff)) {
        let marker = rest[at + 1];
        rest = &rest[at + 2..];
        match marker {
            0xd9 => return false,
            // These stand alone.
            0x01 | 0xd0..=0xd8 => {}
            // What follows tells how long it is, these two bytes included.
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
        // A scan with stuffing, a restart and filling, and its end.
        file.extend([0xff, 0xda, 0, 3, 1, 7, 0xff, 0, 8, 0xff, 0xd0, 9, 0xff, 0xff, 0xd9]);
        assert!(!is_cut(&file));
        assert!((3..file.len()).all(|end| is_cut(&file[..end])));
        file.extend(b"what comes after it");
        assert!(!is_cut(&file) && !is_cut(b"\x89PNG") && !is_cut(b""));
    }
}

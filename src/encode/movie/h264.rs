//! What has to be known of H.264 to put a stream into a file.

/// The units of a stream, without the start codes of two or three zeros and a one in front of each.
pub fn units(stream: &[u8]) -> impl Iterator<Item = &[u8]> {
    let starts = stream.windows(3).enumerate().filter(|(_, bytes)| *bytes == [0, 0, 1]);
    let starts: Vec<usize> = starts.map(|(at, _)| at).collect();
    let ends: Vec<usize> = starts.iter().skip(1).copied().chain([stream.len()]).collect();
    starts.into_iter().zip(ends).map(|(start, end)| {
        let unit = &stream[start + 3..end];
        // The first zero of the next start code; no unit ends with one.
        let last = unit.iter().rposition(|byte| *byte != 0).map_or(0, |last| last + 1);
        &unit[..last]
    })
}

/// What the codes of colours mean, for players that do not look into the file around the stream: the fields of E.1.1
/// from `aspect_ratio_info_present_flag` on, as bits. A limited range, primaries, transfer and matrix of Rec. 709 (1
/// each), and colour in the middle of four pixels (1).
const COLORS: [(u32, usize); 15] = [
    (0, 1),
    (0, 1),
    (1, 1),
    (5, 3),
    (0, 1),
    (1, 1),
    (1, 8),
    (1, 8),
    (1, 8),
    (1, 1),
    (0b010, 3),
    (0b010, 3),
    (0, 1),
    (0, 2),
    (0, 2),
];

/// A sequence's parameters that tell what its colours are. The encoder says nothing after the flag that nothing
/// follows, the last bit but the end mark; parameters that say more are left as they are.
pub fn told_colors(unit: &[u8]) -> Vec<u8> {
    let mut bits: Vec<bool> =
        plain(unit).iter().flat_map(|byte| (0..8).rev().map(move |at| byte >> at & 1 == 1)).collect();
    let mark = bits.iter().rposition(|bit| *bit).unwrap_or(0);
    if mark == 0 || bits[mark - 1] {
        return unit.to_vec();
    }
    bits.truncate(mark);
    bits[mark - 1] = true;
    bits.extend(
        COLORS.iter().flat_map(|&(value, count)| (0..count).rev().map(move |at| value >> at & 1 == 1)),
    );
    bits.push(true);
    let byte = |bits: &[bool]| (0..8).fold(0, |byte, at| byte << 1 | u8::from(bits.get(at) == Some(&true)));
    escaped(bits.chunks(8).map(byte))
}

/// A unit without the bytes that keep start codes out of it.
fn plain(unit: &[u8]) -> Vec<u8> {
    let mut plain: Vec<u8> = Vec::with_capacity(unit.len());
    let mut zeros = 0;
    for &byte in unit {
        if !(byte == 3 && zeros >= 2) {
            plain.push(byte);
        }
        zeros = if byte == 0 { zeros + 1 } else { 0 };
    }
    plain
}

/// The same with them.
fn escaped(plain: impl Iterator<Item = u8>) -> Vec<u8> {
    let (mut unit, mut zeros) = (Vec::new(), 0);
    for byte in plain {
        if zeros >= 2 && byte <= 3 {
            unit.push(3);
            zeros = 0;
        }
        unit.push(byte);
        zeros = if byte == 0 { zeros + 1 } else { 0 };
    }
    unit
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_end_before_the_next_start_code() {
        let stream = [0, 0, 0, 1, 0x67, 1, 2, 0, 0, 1, 0x68, 3, 0, 0, 0, 1, 0x65, 0, 0, 3, 1];
        let found: Vec<&[u8]> = units(&stream).collect();
        assert_eq!(found, [&[0x67, 1, 2][..], &[0x68, 3], &[0x65, 0, 0, 3, 1]]);
    }

    #[test]
    fn start_codes_are_kept_out_and_come_back() {
        let bytes = [0, 0, 0, 0, 1, 9, 0, 0, 3, 0, 0, 4];
        let unit = escaped(bytes.into_iter());
        assert_eq!(unit, [0, 0, 3, 0, 0, 3, 1, 9, 0, 0, 3, 3, 0, 0, 4]);
        assert_eq!(plain(&unit), bytes);
    }

    #[test]
    fn colours_are_told_once() {
        // The flag is the last bit but one: ...0 1 000000.
        let told = told_colors(&[0x67, 77, 0, 30, 0b1010_0100]);
        assert_eq!(told[..4], [0x67, 77, 0, 30]);
        assert!(told.len() > 8);
        assert_eq!(told_colors(&[0x67, 0b0000_1100]), [0x67, 0b0000_1100]);
    }
}

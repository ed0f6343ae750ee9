//! Parsing of H.264 streams, as far as a container needs it.

/// The NAL units of a stream, without their start codes (two or three zeros and a one).
pub fn nal_units(stream: &[u8]) -> impl Iterator<Item = &[u8]> {
    let starts = stream.windows(3).enumerate().filter(|(_, bytes)| *bytes == [0, 0, 1]);
    let starts: Vec<usize> = starts.map(|(at, _)| at).collect();
    let ends: Vec<usize> = starts.iter().skip(1).copied().chain([stream.len()]).collect();
    starts.into_iter().zip(ends).map(|(start, end)| {
        let unit = &stream[start + 3..end];
        // Remove the first zero of a longer start code. No unit ends with a zero.
        let last = unit.iter().rposition(|byte| *byte != 0).map_or(0, |last| last + 1);
        &unit[..last]
    })
}

/// The colour description of the video usability information (VUI), for players that ignore the container's. These are
/// the fields of E.1.1 from `aspect_ratio_info_present_flag` on, as values and numbers of bits: limited range;
/// primaries, transfer function and matrix of Rec. 709 (1 each); chroma in the centre of four pixels (1).
const VUI_COLORS: [(u32, usize); 15] = [
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

/// Adds the colour description to a sequence parameter set (SPS). The encoder writes no VUI, so its flag is the last
/// bit before the stop bit. A parameter set with a VUI is returned unchanged.
pub fn with_color_description(unit: &[u8]) -> Vec<u8> {
    let mut bits: Vec<bool> =
        unescaped(unit).iter().flat_map(|byte| (0..8).rev().map(move |at| byte >> at & 1 == 1)).collect();
    let stop = bits.iter().rposition(|bit| *bit).unwrap_or(0);
    if stop == 0 || bits[stop - 1] {
        return unit.to_vec();
    }
    bits.truncate(stop);
    bits[stop - 1] = true;
    bits.extend(
        VUI_COLORS.iter().flat_map(|&(value, count)| (0..count).rev().map(move |at| value >> at & 1 == 1)),
    );
    bits.push(true);
    let byte = |bits: &[bool]| (0..8).fold(0, |byte, at| byte << 1 | u8::from(bits.get(at) == Some(&true)));
    escaped(bits.chunks(8).map(byte))
}

/// Removes the emulation prevention bytes of a unit.
fn unescaped(unit: &[u8]) -> Vec<u8> {
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

/// Adds emulation prevention bytes, so that the unit contains no start code.
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
        let found: Vec<&[u8]> = nal_units(&stream).collect();
        assert_eq!(found, [&[0x67, 1, 2][..], &[0x68, 3], &[0x65, 0, 0, 3, 1]]);
    }

    #[test]
    fn escaping_round_trips() {
        let bytes = [0, 0, 0, 0, 1, 9, 0, 0, 3, 0, 0, 4];
        let unit = escaped(bytes.into_iter());
        assert_eq!(unit, [0, 0, 3, 0, 0, 3, 1, 9, 0, 0, 3, 3, 0, 0, 4]);
        assert_eq!(unescaped(&unit), bytes);
    }

    #[test]
    fn colours_are_described_once() {
        // The flag is the last bit but one: ...0 1 000000.
        let described = with_color_description(&[0x67, 77, 0, 30, 0b1010_0100]);
        assert_eq!(described[..4], [0x67, 77, 0, 30]);
        assert!(described.len() > 8);
        assert_eq!(with_color_description(&[0x67, 0b0000_1100]), [0x67, 0b0000_1100]);
    }
}

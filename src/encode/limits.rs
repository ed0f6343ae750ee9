//! The largest pictures that formats can hold.

use super::error::JobError;
use super::output::{AnimationFormat, Output, StillFormat};

/// Longest sides in pixels.
const JPEG_SIDE: u32 = 65_535;
const GIF_SIDE: u32 = 65_535;
const WEBP_SIDE: u32 = 16_384;
/// Macroblocks of 16x16 pixels in a picture and along a side, at most: the limits of H.264's level 5.2.
const MAX_MACROBLOCKS: u32 = 36_864;
const MAX_SIDE_MACROBLOCKS: u32 = 543;

/// The limit of GIF, as messages give it.
pub const GIF_LIMIT: &str = "a GIF ends at 65535x65535";

/// Refuses pictures that are larger than an output's format can hold. `frame` is the first of them.
pub fn check_size(output: &Output, frame: u32, size: (u32, u32)) -> Result<(), JobError> {
    let longest = size.0.max(size.1);
    let limit = match output {
        Output::Stills(StillFormat::Jpeg, _) => (longest > JPEG_SIDE).then_some("a JPEG ends at 65535x65535"),
        Output::Movie(AnimationFormat::Gif, _) => (longest > GIF_SIDE).then_some(GIF_LIMIT),
        Output::Movie(AnimationFormat::Webp, _) => {
            (longest > WEBP_SIDE).then_some("a WebP ends at 16384x16384")
        }
        Output::Movie(AnimationFormat::Mp4, _) => h264_limit(size),
        _ => None,
    };
    limit.map_or(Ok(()), |limit| Err(JobError::TooLarge { path: output.path(frame), size, limit }))
}

/// Why pictures of this size cannot be encoded as H.264 on this machine, if they cannot.
fn h264_limit((width, height): (u32, u32)) -> Option<&'static str> {
    let blocks = [width, height].map(|side| side.div_ceil(16));
    let fits = blocks[0].max(blocks[1]) <= MAX_SIDE_MACROBLOCKS && blocks[0] * blocks[1] <= MAX_MACROBLOCKS;
    let size = (!fits).then_some("H.264 ends at 36864 blocks of 16x16 pixels, such as 4096x2304");
    size.or_else(missing_encoder)
}

/// Why this program has no H.264 encoder, or this processor lacks its SIMD instructions. On x86-64 the encoder has no
/// path without them.
fn missing_encoder() -> Option<&'static str> {
    if cfg!(not(feature = "video")) {
        return Some(
            "this program was built without its H.264 encoder, the feature `video`; write .y4m or stills",
        );
    }
    #[cfg(target_arch = "x86_64")]
    if !(is_x86_feature_detected!("ssse3") && is_x86_feature_detected!("sse4.1")) {
        return Some(
            "the H.264 encoder needs a processor with SSE4.1 (of 2008 or later); write .y4m or stills",
        );
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_have_a_limit() {
        let fits = |name: &str, size| check_size(&Output::parse(name).expect(name), 0, size).is_ok();
        assert!(fits("a.jpg", (65_535, 1)) && !fits("a.jpg", (1, 65_536)));
        assert!(fits("a.webp", (16_384, 1)) && !fits("a.webp", (1, 16_385)));
        assert!(fits("a.png", (100_000, 1)));
    }

    #[test]
    fn videos_have_a_limit_of_macroblocks() {
        assert_eq!(h264_limit((4096, 2304)), None);
        assert!(h264_limit((4096, 2320)).is_some() && h264_limit((9000, 16)).is_some());
    }
}

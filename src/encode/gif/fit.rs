//! Fits a GIF into a maximum size: it drops colours, then pixels, then frames, until the file is small enough.

use super::file::FinishedGif;
use super::timing::TimedFrame;
use crate::base::color::{linear_to_srgb, srgb_to_linear};
use crate::base::escape;
use crate::base::units;
use crate::encode::error::EncodeError;
use crate::encode::picture::Picture;
use crate::encode::settings::GifSettings;
use std::path::Path;
use std::sync::LazyLock;

/// The colours, pixels and frames that a file keeps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GifQuality {
    pub colors: u16,
    /// Factor of width and height, at most 1.
    pub scale: f64,
    /// Every how many frames one is shown.
    pub frame_step: usize,
}

/// The qualities to try in order: colours, scale and frame step.
const LADDER: [(u16, f64, usize); 17] = [
    (192, 1.0, 1),
    (128, 1.0, 1),
    (96, 1.0, 1),
    (64, 1.0, 1),
    (128, 0.85, 1),
    (128, 0.75, 1),
    (96, 0.67, 1),
    (96, 0.75, 2),
    (96, 0.67, 2),
    (96, 0.5, 1),
    (96, 0.5, 2),
    (64, 0.4, 2),
    (64, 0.4, 3),
    (64, 0.33, 3),
    (48, 0.25, 4),
    (32, 0.2, 6),
    (16, 0.12, 8),
];

impl GifQuality {
    /// The relative size of a file. Measured on shipped sequences: half the colours save about a sixth.
    fn relative_size(&self) -> f64 {
        let colors = 0.25 + 0.094 * libm::log2(f64::from(self.colors));
        colors * self.scale * self.scale / self.frame_step as f64
    }

    pub fn size(&self, (width, height): (u16, u16)) -> (u16, u16) {
        let scaled = |side: u16| ((f64::from(side) * self.scale).round() as u16).max(1);
        (scaled(width), scaled(height))
    }

    /// The frames that are kept. Each is shown for the time of the frames that it replaces.
    pub fn thinned(&self, frames: &[TimedFrame]) -> Vec<TimedFrame> {
        let merged = |frames: &[TimedFrame]| TimedFrame {
            index: frames[0].index,
            delay: frames.iter().map(|frame| frame.delay).sum(),
        };
        frames.chunks(self.frame_step).map(merged).collect()
    }

    /// Scales a picture with a box filter in linear light.
    pub fn scaled(&self, picture: Picture) -> Picture {
        if self.scale >= 1.0 {
            return picture;
        }
        let short = |side: u32| u16::try_from(side).unwrap_or(u16::MAX);
        let (width, height) = self.size((short(picture.width), short(picture.height)));
        shrunk(&picture, u32::from(width), u32::from(height))
    }

    /// Describes the loss compared to the requested quality.
    fn loss(&self, requested: &Self, size: (u16, u16)) -> String {
        let mut parts = Vec::new();
        if self.colors < requested.colors {
            parts.push(format!("{} colours instead of {}", self.colors, requested.colors));
        }
        if self.scale < 1.0 {
            let (width, height) = self.size(size);
            parts.push(format!("{width}x{height} pixels instead of {}x{}", size.0, size.1));
        }
        if self.frame_step > 1 {
            parts.push(format!("one of {} frames", self.frame_step));
        }
        parts.join(", ")
    }
}

/// Writes the GIF `path` of `size` pixels with the requested settings, or with as little loss as its maximum size
/// allows. `encode` makes a file of a given quality. Returns a note about the loss, if there is any.
pub fn write(
    path: &Path,
    size: (u16, u16),
    settings: &GifSettings,
    encode: impl Fn(&GifQuality) -> Result<FinishedGif, EncodeError>,
) -> Result<Option<String>, EncodeError> {
    let requested = GifQuality { colors: settings.colors, scale: 1.0, frame_step: 1 };
    let full = encode(&requested)?;
    let Some(limit) = settings.max_size.filter(|&limit| full.size > limit) else {
        full.file.commit()?;
        return Ok(None);
    };
    let (full_size, mut best, mut quality) = (full.size, full, requested);
    let mut factor = best.size as f64 / requested.relative_size();
    for (colors, scale, frame_step) in LADDER {
        let next = GifQuality { colors: colors.min(requested.colors), scale, frame_step };
        // Skip qualities whose estimated size is too large.
        if next.relative_size() >= quality.relative_size()
            || next.relative_size() * factor > 1.1 * limit as f64
        {
            continue;
        }
        let file = encode(&next)?;
        factor = file.size as f64 / next.relative_size();
        (best, quality) = (file, next);
        if best.size <= limit {
            break;
        }
    }
    let path = escape::path(path);
    let loss = quality.loss(&requested, size);
    let fits = best.size <= limit;
    let (size, full_size, limit) = (units::bytes(best.size), units::bytes(full_size), units::bytes(limit));
    best.file.commit()?;
    Ok(Some(match fits {
        true => format!("{path} would have {full_size}; to stay within {limit} it has {loss}: {size}"),
        false => format!("{path} cannot be made as small as {limit}: with {loss} it has {size}"),
    }))
}

/// The linear value of every code.
static LINEAR: LazyLock<Vec<f32>> =
    LazyLock::new(|| (0..=255u8).map(|code| srgb_to_linear(f64::from(code) / 255.0) as f32).collect());

/// Scales a picture down with a box filter. Alpha becomes one bit per pixel.
fn shrunk(picture: &Picture, width: u32, height: u32) -> Picture {
    let columns = shares(picture.width, width);
    let rows = shares(picture.height, height);
    let stride = picture.width as usize;
    let pixels = picture.rgb.as_chunks::<3>().0;
    let mut rgb = Vec::with_capacity(3 * width as usize * height as usize);
    for row in &rows {
        for column in &columns {
            let mut sum = [0.0f32; 3];
            for &(y, down) in row {
                for &(x, across) in column {
                    let pixel = pixels[y * stride + x];
                    sum = std::array::from_fn(|i| sum[i] + down * across * LINEAR[usize::from(pixel[i])]);
                }
            }
            rgb.extend(sum.map(|light| (linear_to_srgb(f64::from(light).min(1.0)) * 255.0 + 0.5) as u8));
        }
    }
    let half = |alpha: &Vec<u8>| {
        let covered = |row: &[(usize, f32)], column: &[(usize, f32)]| {
            let share = |&(y, down): &(usize, f32), &(x, across): &(usize, f32)| {
                down * across * f32::from(alpha[y * stride + x]) / 255.0
            };
            row.iter().flat_map(|y| column.iter().map(move |x| share(y, x))).sum::<f32>() >= 0.5
        };
        let pixels = rows.iter().flat_map(|row| columns.iter().map(move |column| covered(row, column)));
        pixels.map(|covered| if covered { 255 } else { 0 }).collect()
    };
    Picture { alpha: picture.alpha.as_ref().map(half), ..Picture::opaque(width, height, rgb) }
}

/// For each of `to` pixels, the indices of the `from` pixels that it covers, and their weights.
fn shares(from: u32, to: u32) -> Vec<Vec<(usize, f32)>> {
    let step = f64::from(from) / f64::from(to);
    let one = |i: u32| {
        let (start, end) = (f64::from(i) * step, (f64::from(i + 1) * step).min(f64::from(from)));
        let covered = |x: u32| (end.min(f64::from(x + 1)) - start.max(f64::from(x))).max(0.0);
        let pixels = start as u32..(end.ceil() as u32).min(from);
        pixels
            .map(|x| (x as usize, (covered(x) / (end - start)) as f32))
            .filter(|(_, share)| *share > 0.0)
            .collect()
    };
    (0..to).map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scaling_preserves_linear_light() {
        let code = |i: u32| [(i * 7 % 256) as u8, (i % 256) as u8, 100];
        let picture = Picture::opaque(30, 20, (0..600).flat_map(code).collect());
        let small = shrunk(&picture, 20, 13);
        assert_eq!((small.width, small.height, small.rgb.len()), (20, 13, 780));
        let mean = |picture: &Picture, channel: usize| {
            let light = picture.rgb.iter().skip(channel).step_by(3).map(|code| LINEAR[usize::from(*code)]);
            light.sum::<f32>() / (picture.width * picture.height) as f32
        };
        assert!((0..3).all(|channel| (mean(&picture, channel) - mean(&small, channel)).abs() < 0.003));
        assert_eq!(shrunk(&Picture::filled(7, 7, [9, 8, 7]), 3, 2), Picture::filled(3, 2, [9, 8, 7]));
    }

    #[test]
    fn qualities_become_smaller_and_describe_their_loss() {
        let steps = LADDER.map(|(colors, scale, frame_step)| GifQuality { colors, scale, frame_step });
        let requested = GifQuality { colors: 256, scale: 1.0, frame_step: 1 };
        assert!(steps[0].relative_size() < requested.relative_size() && steps[16].relative_size() < 0.01);
        let loss = steps[8].loss(&requested, (480, 270));
        assert_eq!(loss, "96 colours instead of 256, 322x181 pixels instead of 480x270, one of 2 frames");
        let frames: Vec<TimedFrame> = (0..5).map(|index| TimedFrame { index, delay: 4 }).collect();
        let left = GifQuality { frame_step: 2, ..requested }.thinned(&frames);
        assert_eq!(
            left.iter().map(|frame| (frame.index, frame.delay)).collect::<Vec<_>>(),
            [(0, 8), (2, 8), (4, 4)]
        );
    }
}

//! A GIF that may not be larger than so many bytes: it loses colours, then pixels, then frames, until it is not.

use super::Animation;
use super::file::Finished;
use super::timing::Shot;
use crate::base::color::{linear_to_srgb, srgb_to_linear};
use crate::base::escape;
use crate::base::units;
use crate::encode::error::EncodeError;
use crate::encode::picture::Picture;
use std::sync::LazyLock;

/// How a stored frame is read.
pub type Load<'a> = dyn Fn(usize) -> Result<Picture, EncodeError> + Sync + 'a;

/// What a file keeps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    pub colors: u16,
    /// Of width and height, at most 1.
    pub scale: f64,
    /// One of so many frames is shown.
    pub every: usize,
}

/// What files become, one after the other, until they are small enough: colours, scale, and one of how many frames.
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

impl Plan {
    /// How large a file becomes, up to a factor. Measured on shipped sequences: half the colours save about a sixth.
    fn cost(&self) -> f64 {
        let colors = 0.25 + 0.094 * libm::log2(f64::from(self.colors));
        colors * self.scale * self.scale / self.every as f64
    }

    pub fn size(&self, (width, height): (u16, u16)) -> (u16, u16) {
        let scaled = |side: u16| ((f64::from(side) * self.scale).round() as u16).max(1);
        (scaled(width), scaled(height))
    }

    /// The shots that stay, each as long as those it stands for.
    pub fn thinned(&self, shots: &[Shot]) -> Vec<Shot> {
        let one =
            |shots: &[Shot]| Shot { index: shots[0].index, delay: shots.iter().map(|shot| shot.delay).sum() };
        shots.chunks(self.every).map(one).collect()
    }

    /// A picture in the plan's size: light averaged over the squares that pixels cover.
    pub fn scaled(&self, picture: Picture) -> Picture {
        if self.scale >= 1.0 {
            return picture;
        }
        let short = |side: u32| u16::try_from(side).unwrap_or(u16::MAX);
        let (width, height) = self.size((short(picture.width), short(picture.height)));
        shrunk(&picture, u32::from(width), u32::from(height))
    }

    /// What has been lost, in words.
    fn told(&self, asked: &Self, size: (u16, u16)) -> String {
        let mut parts = Vec::new();
        if self.colors < asked.colors {
            parts.push(format!("{} colours instead of {}", self.colors, asked.colors));
        }
        if self.scale < 1.0 {
            let (width, height) = self.size(size);
            parts.push(format!("{width}x{height} pixels instead of {}x{}", size.0, size.1));
        }
        if self.every > 1 {
            parts.push(format!("one of {} frames", self.every));
        }
        parts.join(", ")
    }
}

/// Writes the animation as it was asked for, or with as little lost as keeps it below its limit. Returns what to tell.
pub fn write(animation: &Animation, load: &Load) -> Result<Option<String>, EncodeError> {
    let asked = Plan { colors: animation.settings.colors, scale: 1.0, every: 1 };
    let whole = animation.attempt(&asked, load)?;
    let Some(most) = animation.settings.max_size.filter(|&most| whole.size > most) else {
        whole.file.commit()?;
        return Ok(None);
    };
    let (wanted, mut best, mut plan) = (whole.size, whole, asked);
    let mut factor = best.size as f64 / asked.cost();
    for (colors, scale, every) in LADDER {
        let next = Plan { colors: colors.min(asked.colors), scale, every };
        // What would surely be too large is not tried.
        if next.cost() >= plan.cost() || next.cost() * factor > 1.1 * most as f64 {
            continue;
        }
        let found: Finished = animation.attempt(&next, load)?;
        factor = found.size as f64 / next.cost();
        (best, plan) = (found, next);
        if best.size <= most {
            break;
        }
    }
    let path = escape::path(&animation.path);
    let (size, before, limit) = (units::bytes(best.size), units::bytes(wanted), units::bytes(most));
    let lost = plan.told(&asked, animation.size);
    let fits = best.size <= most;
    best.file.commit()?;
    Ok(Some(match fits {
        true => format!("{path} would have {before}; to stay within {limit} it has {lost}: {size}"),
        false => format!("{path} cannot be made as small as {limit}: with {lost} it has {size}"),
    }))
}

/// Linear light of every code.
static LIGHT: LazyLock<Vec<f32>> =
    LazyLock::new(|| (0..=255u8).map(|code| srgb_to_linear(f64::from(code) / 255.0) as f32).collect());

/// The picture in fewer pixels.
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
                    sum = std::array::from_fn(|i| sum[i] + down * across * LIGHT[usize::from(pixel[i])]);
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

/// Which of `from` pixels each of `to` covers, and with which share.
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
    fn pictures_keep_their_light() {
        let code = |i: u32| [(i * 7 % 256) as u8, (i % 256) as u8, 100];
        let picture = Picture::opaque(30, 20, (0..600).flat_map(code).collect());
        let small = shrunk(&picture, 20, 13);
        assert_eq!((small.width, small.height, small.rgb.len()), (20, 13, 780));
        let mean = |picture: &Picture, channel: usize| {
            let light = picture.rgb.iter().skip(channel).step_by(3).map(|code| LIGHT[usize::from(*code)]);
            light.sum::<f32>() / (picture.width * picture.height) as f32
        };
        assert!((0..3).all(|channel| (mean(&picture, channel) - mean(&small, channel)).abs() < 0.003));
        assert_eq!(shrunk(&Picture::filled(7, 7, [9, 8, 7]), 3, 2), Picture::filled(3, 2, [9, 8, 7]));
    }

    #[test]
    fn plans_become_cheaper_and_say_what_they_lose() {
        let plans = LADDER.map(|(colors, scale, every)| Plan { colors, scale, every });
        let asked = Plan { colors: 256, scale: 1.0, every: 1 };
        assert!(plans[0].cost() < asked.cost() && plans[16].cost() < 0.01);
        let told = plans[8].told(&asked, (480, 270));
        assert_eq!(told, "96 colours instead of 256, 322x181 pixels instead of 480x270, one of 2 frames");
        let shots: Vec<Shot> = (0..5).map(|index| Shot { index, delay: 4 }).collect();
        let left = Plan { every: 2, ..asked }.thinned(&shots);
        assert_eq!(
            left.iter().map(|shot| (shot.index, shot.delay)).collect::<Vec<_>>(),
            [(0, 8), (2, 8), (4, 4)]
        );
    }
}

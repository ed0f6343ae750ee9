//! Animated WebP without loss: `image-webp` codes the frames, and this is the container around them
//! (RFC 9649, 2.7).

use super::clock::length;
use super::difference::{Rectangle, changed};
use crate::base::time::Rate;
use crate::encode::atomic::Aside;
use crate::encode::error::EncodeError;
use crate::encode::job::Job;
use crate::encode::movie::Movie;
use crate::encode::picture::Picture;
use image_webp::{ColorType, EncodingError, WebPEncoder};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Pixels along a side, at most.
const LONGEST: u32 = 16_384;
/// Milliseconds that one frame can stay: 24 bits.
const LONGEST_STAY: u64 = (1 << 24) - 1;
/// Where the size of the file and the flags of its features stand, once all frames are known.
const SIZE_AT: u64 = 4;
const FLAGS_AT: u64 = 20;
/// Features: an animation, and pixels with alpha.
const ANIMATION: u8 = 1 << 1;
const ALPHA: u8 = 1 << 4;
/// A frame that replaces what it covers instead of being laid over it.
const REPLACES: u8 = 1 << 1;

/// What keeps pictures of this size from being WebPs.
pub fn limit((width, height): (u32, u32)) -> Option<&'static str> {
    (width.max(height) > LONGEST).then_some("a WebP ends at 16384x16384")
}

/// A WebP in the making.
pub struct Webp {
    path: PathBuf,
    rate: Rate,
    file: Aside,
    size: (u32, u32),
    /// The frame before, as red, green, blue and alpha.
    last: Vec<[u8; 4]>,
    /// The last frame that shows something new, which may stay longer.
    held: Option<Held>,
    /// Whether any frame has alpha.
    alpha: bool,
    pushed: usize,
    written: u64,
}

struct Held {
    place: Rectangle,
    flags: u8,
    /// The chunk that codes its pixels.
    image: Vec<u8>,
    /// Milliseconds.
    stay: u64,
}

impl Webp {
    pub fn create(path: &Path, job: &Job) -> Result<Self, EncodeError> {
        let mut webp = Self {
            path: path.to_path_buf(),
            rate: job.rate,
            file: Aside::create(path)?,
            size: job.size,
            last: Vec::new(),
            held: None,
            alpha: false,
            pushed: 0,
            written: 0,
        };
        webp.head(job.formats.webp.0.unwrap_or(0)).map_err(|e| EncodeError::write(path, e))?;
        Ok(webp)
    }

    /// All that stands before the frames. The size and the flags are not known yet.
    fn head(&mut self, plays: u16) -> io::Result<()> {
        let mut head = b"RIFF\0\0\0\0WEBP".to_vec();
        let mut features = vec![0; 4];
        features.extend(three(self.size.0 - 1));
        features.extend(three(self.size.1 - 1));
        head.extend(chunk(b"VP8X", &features));
        let mut animation = vec![0; 4];
        animation.extend(plays.to_le_bytes());
        head.extend(chunk(b"ANIM", &animation));
        self.put(&head)
    }

    fn put(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.written += bytes.len() as u64;
        self.file.write_all(bytes)
    }

    fn add(&mut self, picture: &Picture) -> Result<(), EncodingError> {
        let alpha = picture.alpha.is_some();
        let pixels: Vec<[u8; 4]> = match alpha {
            true => picture.interleaved().as_chunks::<4>().0.to_vec(),
            false => picture.rgb.as_chunks::<3>().0.iter().map(|&[r, g, b]| [r, g, b, 255]).collect(),
        };
        let stay = length(self.pushed, self.rate, 1000) as u64;
        self.pushed += 1;
        match (self.place(&pixels), &mut self.held) {
            (None, Some(held)) => held.stay += stay,
            (place, _) => {
                let place = place.unwrap_or(self.whole());
                let (image, flags) = self.coded(&pixels, place, alpha)?;
                self.write_held()?;
                self.held = Some(Held { place, flags, image, stay });
            }
        }
        self.last = pixels;
        Ok(())
    }

    fn whole(&self) -> Rectangle {
        Rectangle { left: 0, top: 0, width: self.size.0 as usize, height: self.size.1 as usize }
    }

    /// Where something is new, if anything is; corners lie at even pixels.
    fn place(&self, pixels: &[[u8; 4]]) -> Option<Rectangle> {
        if self.last.is_empty() {
            return Some(self.whole());
        }
        let Rectangle { left, top, width, height } = changed(&self.last, pixels, self.size.0 as usize)?;
        let (x, y) = (left / 2 * 2, top / 2 * 2);
        Some(Rectangle { left: x, top: y, width: width + left - x, height: height + top - y })
    }

    /// A part of a frame, coded in the way that takes less space, and its flags: as it is, or, where nothing is
    /// transparent, with all that stays as it was left out.
    fn coded(
        &mut self,
        pixels: &[[u8; 4]],
        place: Rectangle,
        alpha: bool,
    ) -> Result<(Vec<u8>, u8), EncodingError> {
        let stride = self.size.0 as usize;
        let part: Vec<[u8; 4]> = place.rows(pixels, stride).flatten().copied().collect();
        if alpha {
            self.alpha = true;
            return Ok((image(&part, place, true)?, REPLACES));
        }
        let plain = image(&part, place, false)?;
        if self.last.is_empty() {
            return Ok((plain, REPLACES));
        }
        let before = place.rows(&self.last, stride).flatten();
        let new: Vec<[u8; 4]> =
            part.iter().zip(before).map(|(n, o)| if n == o { [0; 4] } else { *n }).collect();
        let sparse = image(&new, place, true)?;
        if sparse.len() >= plain.len() {
            return Ok((plain, REPLACES));
        }
        self.alpha = true;
        Ok((sparse, 0))
    }

    fn write_held(&mut self) -> io::Result<()> {
        let Some(Held { place, flags, image, stay }) = self.held.take() else { return Ok(()) };
        // Long stays are several equal frames.
        let pieces = stay.div_ceil(LONGEST_STAY).max(1);
        for piece in 0..pieces {
            let share = ((piece + 1) * stay / pieces - piece * stay / pieces) as u32;
            let number = |length: usize| three(length as u32);
            let mut frame = Vec::with_capacity(image.len() + 16);
            frame.extend(
                [place.left / 2, place.top / 2, place.width - 1, place.height - 1].map(number).as_flattened(),
            );
            frame.extend(three(share));
            frame.push(flags);
            frame.extend(&image);
            self.put(&chunk(b"ANMF", &frame))?;
        }
        Ok(())
    }

    fn end(&mut self) -> io::Result<()> {
        self.write_held()?;
        let size = u32::try_from(self.written - 8);
        let size = size.map_err(|_| io::Error::other("a WebP ends at 4 GB"))?;
        self.file.seek(SeekFrom::Start(SIZE_AT))?;
        self.file.write_all(&size.to_le_bytes())?;
        self.file.seek(SeekFrom::Start(FLAGS_AT))?;
        self.file.write_all(&[ANIMATION | if self.alpha { ALPHA } else { 0 }])
    }
}

impl Movie for Webp {
    fn push(&mut self, picture: &Picture) -> Result<(), EncodeError> {
        self.add(picture).map_err(|e| EncodeError::write(&self.path, into_io(e)))
    }

    fn divert(&mut self) -> Option<PathBuf> {
        Some(self.file.divert())
    }

    fn finish(mut self: Box<Self>) -> Result<(), EncodeError> {
        self.end().map_err(|e| EncodeError::write(&self.path, e))?;
        self.file.commit()
    }
}

/// The chunk with the pixels of a part of a picture.
fn image(pixels: &[[u8; 4]], place: Rectangle, alpha: bool) -> Result<Vec<u8>, EncodingError> {
    let mut file = Vec::new();
    let (width, height) = (place.width as u32, place.height as u32);
    let encoder = WebPEncoder::new(&mut file);
    if alpha {
        encoder.encode(pixels.as_flattened(), width, height, ColorType::Rgba8)?;
    } else {
        let rgb: Vec<u8> = pixels.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
        encoder.encode(&rgb, width, height, ColorType::Rgb8)?;
    }
    // A file of one picture is a header of 12 bytes and that chunk.
    Ok(file.split_off(12))
}

/// A chunk: its name, its size, what it holds, and a byte that makes it even.
fn chunk(name: &[u8; 4], payload: &[u8]) -> Vec<u8> {
    let mut chunk = name.to_vec();
    chunk.extend((payload.len() as u32).to_le_bytes());
    chunk.extend(payload);
    chunk.resize(chunk.len().next_multiple_of(2), 0);
    chunk
}

/// A number of 24 bits.
fn three(number: u32) -> [u8; 3] {
    let [a, b, c, _] = number.to_le_bytes();
    [a, b, c]
}

fn into_io(error: EncodingError) -> io::Error {
    match error {
        EncodingError::IoError(error) => error,
        other => io::Error::other(other),
    }
}

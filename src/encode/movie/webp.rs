//! Animated lossless WebP: `image-webp` compresses the frames, and this file writes the container (RFC 9649, 2.7).

use super::clock::duration;
use super::difference::{PixelRect, changed};
use super::writer::MovieWriter;
use crate::base::time::Rate;
use crate::encode::atomic::AtomicFile;
use crate::encode::error::EncodeError;
use crate::encode::job::EncodeJob;
use crate::encode::picture::Picture;
use image_webp::{ColorType, EncodingError, WebPEncoder};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// The longest duration of a frame in milliseconds: 24 bits.
const MAX_DURATION: u64 = (1 << 24) - 1;
/// Offsets of the file's size and of the feature flags, which are written after the last frame.
const SIZE_OFFSET: u64 = 4;
const FLAGS_OFFSET: u64 = 20;
/// Feature flags: animation and alpha.
const ANIMATION: u8 = 1 << 1;
const ALPHA: u8 = 1 << 4;
/// The frame flag for replacing pixels instead of blending over them.
const NO_BLEND: u8 = 1 << 1;

/// A WebP that is being written.
pub struct Webp {
    path: PathBuf,
    rate: Rate,
    file: AtomicFile,
    size: (u32, u32),
    /// The previous frame as RGBA.
    last: Vec<[u8; 4]>,
    /// The last changed frame, whose duration may still grow.
    pending: Option<PendingFrame>,
    /// Whether any frame has alpha.
    alpha: bool,
    pushed: usize,
    written: u64,
}

struct PendingFrame {
    rect: PixelRect,
    flags: u8,
    /// The chunk of its compressed pixels.
    image: Vec<u8>,
    /// Milliseconds.
    duration: u64,
}

impl Webp {
    pub fn create(path: &Path, job: &EncodeJob) -> Result<Self, EncodeError> {
        let mut webp = Self {
            path: path.to_path_buf(),
            rate: job.rate,
            file: AtomicFile::create(path)?,
            size: job.size,
            last: Vec::new(),
            pending: None,
            alpha: false,
            pushed: 0,
            written: 0,
        };
        webp.write_head(job.formats.webp.0.unwrap_or(0)).map_err(|e| EncodeError::write(path, e))?;
        Ok(webp)
    }

    /// Writes the header. The size and the flags are not known yet.
    fn write_head(&mut self, loop_count: u16) -> io::Result<()> {
        let mut head = b"RIFF\0\0\0\0WEBP".to_vec();
        let mut features = vec![0; 4];
        features.extend(u24(self.size.0 - 1));
        features.extend(u24(self.size.1 - 1));
        head.extend(chunk(b"VP8X", &features));
        let mut animation = vec![0; 4];
        animation.extend(loop_count.to_le_bytes());
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
        let duration = duration(self.pushed, self.rate, 1000) as u64;
        self.pushed += 1;
        match (self.changed_rect(&pixels), &mut self.pending) {
            (None, Some(pending)) => pending.duration += duration,
            (rect, _) => {
                let rect = rect.unwrap_or(self.full_rect());
                let (image, flags) = self.compressed(&pixels, rect, alpha)?;
                self.write_pending()?;
                self.pending = Some(PendingFrame { rect, flags, image, duration });
            }
        }
        self.last = pixels;
        Ok(())
    }

    fn full_rect(&self) -> PixelRect {
        PixelRect { left: 0, top: 0, width: self.size.0 as usize, height: self.size.1 as usize }
    }

    /// The rectangle that has changed since the previous frame, with its corner at even pixels. `None` if nothing
    /// changed.
    fn changed_rect(&self, pixels: &[[u8; 4]]) -> Option<PixelRect> {
        if self.last.is_empty() {
            return Some(self.full_rect());
        }
        let PixelRect { left, top, width, height } = changed(&self.last, pixels, self.size.0 as usize)?;
        let (x, y) = (left / 2 * 2, top / 2 * 2);
        Some(PixelRect { left: x, top: y, width: width + left - x, height: height + top - y })
    }

    /// Compresses a rectangle of a frame, and returns its flags. An opaque frame is compressed in two ways, as it is
    /// and with unchanged pixels transparent, and the smaller result is used.
    fn compressed(
        &mut self,
        pixels: &[[u8; 4]],
        rect: PixelRect,
        alpha: bool,
    ) -> Result<(Vec<u8>, u8), EncodingError> {
        let stride = self.size.0 as usize;
        let part: Vec<[u8; 4]> = rect.rows(pixels, stride).flatten().copied().collect();
        if alpha {
            self.alpha = true;
            return Ok((image(&part, rect, true)?, NO_BLEND));
        }
        let plain = image(&part, rect, false)?;
        if self.last.is_empty() {
            return Ok((plain, NO_BLEND));
        }
        let before = rect.rows(&self.last, stride).flatten();
        let new: Vec<[u8; 4]> =
            part.iter().zip(before).map(|(n, o)| if n == o { [0; 4] } else { *n }).collect();
        let sparse = image(&new, rect, true)?;
        if sparse.len() >= plain.len() {
            return Ok((plain, NO_BLEND));
        }
        self.alpha = true;
        Ok((sparse, 0))
    }

    fn write_pending(&mut self) -> io::Result<()> {
        let Some(PendingFrame { rect, flags, image, duration }) = self.pending.take() else { return Ok(()) };
        // Long durations are split into several equal frames.
        let pieces = duration.div_ceil(MAX_DURATION).max(1);
        for piece in 0..pieces {
            let share = ((piece + 1) * duration / pieces - piece * duration / pieces) as u32;
            let number = |length: usize| u24(length as u32);
            let mut frame = Vec::with_capacity(image.len() + 16);
            frame.extend(
                [rect.left / 2, rect.top / 2, rect.width - 1, rect.height - 1].map(number).as_flattened(),
            );
            frame.extend(u24(share));
            frame.push(flags);
            frame.extend(&image);
            self.put(&chunk(b"ANMF", &frame))?;
        }
        Ok(())
    }

    fn end(&mut self) -> io::Result<()> {
        self.write_pending()?;
        let size = u32::try_from(self.written - 8);
        let size = size.map_err(|_| io::Error::other("a WebP ends at 4 GB"))?;
        self.file.seek(SeekFrom::Start(SIZE_OFFSET))?;
        self.file.write_all(&size.to_le_bytes())?;
        self.file.seek(SeekFrom::Start(FLAGS_OFFSET))?;
        self.file.write_all(&[ANIMATION | if self.alpha { ALPHA } else { 0 }])
    }
}

impl MovieWriter for Webp {
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

/// The chunk of the compressed pixels of a rectangle.
fn image(pixels: &[[u8; 4]], rect: PixelRect, alpha: bool) -> Result<Vec<u8>, EncodingError> {
    let mut file = Vec::new();
    let (width, height) = (rect.width as u32, rect.height as u32);
    let encoder = WebPEncoder::new(&mut file);
    if alpha {
        encoder.encode(pixels.as_flattened(), width, height, ColorType::Rgba8)?;
    } else {
        let rgb: Vec<u8> = pixels.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
        encoder.encode(&rgb, width, height, ColorType::Rgb8)?;
    }
    // The file of a single picture is a header of 12 bytes and this chunk.
    Ok(file.split_off(12))
}

/// A chunk: its name, size and payload, padded to an even length.
fn chunk(name: &[u8; 4], payload: &[u8]) -> Vec<u8> {
    let mut chunk = name.to_vec();
    chunk.extend((payload.len() as u32).to_le_bytes());
    chunk.extend(payload);
    chunk.resize(chunk.len().next_multiple_of(2), 0);
    chunk
}

/// A 24-bit integer, little-endian.
fn u24(number: u32) -> [u8; 3] {
    let [a, b, c, _] = number.to_le_bytes();
    [a, b, c]
}

fn into_io(error: EncodingError) -> io::Error {
    match error {
        EncodingError::IoError(error) => error,
        other => io::Error::other(other),
    }
}

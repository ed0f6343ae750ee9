//! APNG: every frame without loss, for exactly as long as it should stay.

use super::clock::fraction;
use super::difference::{Rectangle, changed};
use crate::base::time::Rate;
use crate::encode::atomic::Aside;
use crate::encode::error::EncodeError;
use crate::encode::job::Job;
use crate::encode::movie::Movie;
use crate::encode::picture::Picture;
use png::{BlendOp, DisposeOp, EncodingError, Writer};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// An APNG in the making.
pub struct Apng {
    path: PathBuf,
    rate: Rate,
    /// None before the first frame, which tells whether there is alpha.
    writer: Option<Writer<Shared>>,
    file: Shared,
    /// How many frames the file says that it holds, and how many it will hold.
    announced: u32,
    frames: u32,
    plays: u32,
    size: (u32, u32),
    /// The frame before, three or four codes for each pixel.
    last: Vec<u8>,
    pushed: usize,
}

/// A file that is still there when the writer of PNGs has swallowed it.
#[derive(Clone)]
struct Shared(Arc<Mutex<Aside>>);

impl Write for Shared {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).flush()
    }
}

impl Apng {
    pub fn create(path: &Path, job: &Job) -> Result<Self, EncodeError> {
        let frames = u32::try_from(job.frames.len()).unwrap_or(u32::MAX);
        Ok(Self {
            path: path.to_path_buf(),
            rate: job.rate,
            writer: None,
            file: Shared(Arc::new(Mutex::new(Aside::create(path)?))),
            announced: frames,
            frames,
            plays: job.formats.apng.0.map_or(0, u32::from),
            size: job.size,
            last: Vec::new(),
            pushed: 0,
        })
    }

    /// The file with all that belongs at its end.
    fn closed(self) -> Result<Aside, EncodeError> {
        let Self { path, writer, file, .. } = self;
        if let Some(writer) = writer {
            writer.finish().map_err(|e| EncodeError::write(&path, e))?;
        }
        // The writer was the other one who held it.
        let file = Arc::try_unwrap(file.0).map_err(|_| EncodeError::Stopped(None))?;
        Ok(file.into_inner().unwrap_or_else(PoisonError::into_inner))
    }

    fn start(&self, alpha: bool) -> Result<Writer<Shared>, EncodingError> {
        let mut encoder = png::Encoder::new(self.file.clone(), self.size.0, self.size.1);
        encoder.set_color(if alpha { png::ColorType::Rgba } else { png::ColorType::Rgb });
        encoder.set_depth(png::BitDepth::Eight);
        // One file for all frames may take a little longer to become smaller.
        encoder.set_compression(png::Compression::Balanced);
        encoder.set_filter(png::Filter::Adaptive);
        encoder.set_animated(self.frames, self.plays)?;
        encoder.set_blend_op(BlendOp::Source)?;
        encoder.set_dispose_op(DisposeOp::None)?;
        encoder.write_header()
    }

    fn write(&mut self, picture: &Picture) -> Result<(), EncodingError> {
        let (depth, codes) = (if picture.alpha.is_some() { 4 } else { 3 }, picture.interleaved());
        let mut writer = match self.writer.take() {
            Some(writer) => writer,
            None => self.start(picture.alpha.is_some())?,
        };
        let (seconds, frames) = fraction(self.pushed, self.rate);
        writer.set_frame_delay(seconds, frames)?;
        if self.pushed == 0 {
            writer.write_image_data(&codes)?;
        } else {
            let part = self.part(&codes, depth);
            let short = |length: usize| length as u32;
            writer.reset_frame_position()?;
            writer.set_frame_dimension(short(part.width / depth), short(part.height))?;
            writer.set_frame_position(short(part.left / depth), short(part.top))?;
            let rows: Vec<&[u8]> = part.rows(&codes, self.size.0 as usize * depth).collect();
            writer.write_image_data(&rows.concat())?;
        }
        (self.writer, self.last) = (Some(writer), codes);
        self.pushed += 1;
        Ok(())
    }

    /// The part of a frame that is new, its columns counted in codes. An APNG has to announce how many frames it
    /// holds, so a frame that changes nothing is there as well, one pixel large.
    fn part(&self, codes: &[u8], depth: usize) -> Rectangle {
        let stride = self.size.0 as usize;
        let found = match depth {
            3 => changed(self.last.as_chunks::<3>().0, codes.as_chunks::<3>().0, stride),
            _ => changed(self.last.as_chunks::<4>().0, codes.as_chunks::<4>().0, stride),
        };
        let pixels = found.unwrap_or(Rectangle { left: 0, top: 0, width: 1, height: 1 });
        Rectangle { left: pixels.left * depth, width: pixels.width * depth, ..pixels }
    }
}

impl Movie for Apng {
    fn push(&mut self, picture: &Picture) -> Result<(), EncodeError> {
        self.write(picture).map_err(|e| EncodeError::write(&self.path, e))
    }

    fn divert(&mut self) -> Option<PathBuf> {
        self.frames = self.pushed as u32;
        let Shared(file) = &self.file;
        Some(file.lock().unwrap_or_else(PoisonError::into_inner).divert())
    }

    fn finish(self: Box<Self>) -> Result<(), EncodeError> {
        let (path, announced, frames, plays) = (self.path.clone(), self.announced, self.frames, self.plays);
        let mut file = self.closed()?;
        if frames != announced {
            announce(&mut file, frames, plays).map_err(|e| EncodeError::write(&path, e))?;
        }
        file.commit()
    }
}

/// Where the chunk that announces the animation stands: behind the file's mark and its first chunk.
const CONTROL_AT: u64 = 8 + 25;

/// Announces another number of frames than before.
fn announce(file: &mut Aside, frames: u32, plays: u32) -> io::Result<()> {
    let body = [*b"acTL", frames.to_be_bytes(), plays.to_be_bytes()].concat();
    file.seek(SeekFrom::Start(CONTROL_AT + 4))?;
    file.write_all(&body)?;
    file.write_all(&checksum(&body).to_be_bytes())
}

/// The CRC of a PNG's chunks (ISO 3309).
fn checksum(bytes: &[u8]) -> u32 {
    let step = |crc: u32, _| if crc & 1 == 1 { crc >> 1 ^ 0xEDB8_8320 } else { crc >> 1 };
    !bytes.iter().fold(u32::MAX, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), step))
}

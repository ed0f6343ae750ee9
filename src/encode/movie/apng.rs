//! APNG: lossless frames with exact delays.

use super::clock::fraction;
use super::difference::{PixelRect, changed};
use super::writer::MovieWriter;
use crate::base::time::Rate;
use crate::encode::atomic::AtomicFile;
use crate::encode::error::EncodeError;
use crate::encode::job::EncodeJob;
use crate::encode::picture::Picture;
use png::{BlendOp, DisposeOp, EncodingError, Writer};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// An APNG that is being written.
pub struct Apng {
    path: PathBuf,
    rate: Rate,
    /// None before the first frame, which decides whether the file has alpha.
    writer: Option<Writer<Shared>>,
    file: Shared,
    /// The number of frames in the file's header.
    announced: u32,
    /// The number of frames that the file will hold.
    frames: u32,
    /// How often the animation plays; 0 means forever.
    loop_count: u32,
    size: (u32, u32),
    /// The previous frame, three or four codes per pixel.
    last: Vec<u8>,
    pushed: usize,
}

/// A file that stays accessible while the PNG writer owns a handle to it.
#[derive(Clone)]
struct Shared(Arc<Mutex<AtomicFile>>);

impl Write for Shared {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).flush()
    }
}

impl Apng {
    pub fn create(path: &Path, job: &EncodeJob) -> Result<Self, EncodeError> {
        let frames = u32::try_from(job.frames.len()).unwrap_or(u32::MAX);
        Ok(Self {
            path: path.to_path_buf(),
            rate: job.rate,
            writer: None,
            file: Shared(Arc::new(Mutex::new(AtomicFile::create(path)?))),
            announced: frames,
            frames,
            loop_count: job.formats.apng.0.map_or(0, u32::from),
            size: job.size,
            last: Vec::new(),
            pushed: 0,
        })
    }

    /// Writes the end of the PNG and returns the file.
    fn close(self) -> Result<AtomicFile, EncodeError> {
        let Self { path, writer, file, .. } = self;
        if let Some(writer) = writer {
            writer.finish().map_err(|e| EncodeError::write(&path, e))?;
        }
        // The PNG writer held the only other handle.
        let file = Arc::try_unwrap(file.0).map_err(|_| EncodeError::Stopped(None))?;
        Ok(file.into_inner().unwrap_or_else(PoisonError::into_inner))
    }

    fn start(&self, alpha: bool) -> Result<Writer<Shared>, EncodingError> {
        let mut encoder = png::Encoder::new(self.file.clone(), self.size.0, self.size.1);
        encoder.set_color(if alpha { png::ColorType::Rgba } else { png::ColorType::Rgb });
        encoder.set_depth(png::BitDepth::Eight);
        // A single file for all frames is worth a slower, better compression.
        encoder.set_compression(png::Compression::Balanced);
        encoder.set_filter(png::Filter::Adaptive);
        encoder.set_animated(self.frames, self.loop_count)?;
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
            let part = self.changed_part(&codes, depth);
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

    /// The rectangle that has changed since the previous frame, with columns counted in codes. An APNG announces its
    /// number of frames, so an unchanged frame is written too, as a single pixel.
    fn changed_part(&self, codes: &[u8], depth: usize) -> PixelRect {
        let stride = self.size.0 as usize;
        let found = match depth {
            3 => changed(self.last.as_chunks::<3>().0, codes.as_chunks::<3>().0, stride),
            _ => changed(self.last.as_chunks::<4>().0, codes.as_chunks::<4>().0, stride),
        };
        let pixels = found.unwrap_or(PixelRect { left: 0, top: 0, width: 1, height: 1 });
        PixelRect { left: pixels.left * depth, width: pixels.width * depth, ..pixels }
    }
}

impl MovieWriter for Apng {
    fn push(&mut self, picture: &Picture) -> Result<(), EncodeError> {
        self.write(picture).map_err(|e| EncodeError::write(&self.path, e))
    }

    fn divert(&mut self) -> Option<PathBuf> {
        self.frames = self.pushed as u32;
        let Shared(file) = &self.file;
        Some(file.lock().unwrap_or_else(PoisonError::into_inner).divert())
    }

    fn finish(self: Box<Self>) -> Result<(), EncodeError> {
        let (path, announced) = (self.path.clone(), self.announced);
        let (frames, loop_count) = (self.frames, self.loop_count);
        let mut file = self.close()?;
        if frames != announced {
            announce(&mut file, frames, loop_count).map_err(|e| EncodeError::write(&path, e))?;
        }
        file.commit()
    }
}

/// The offset of the acTL chunk: after the signature and the IHDR chunk.
const ACTL_OFFSET: u64 = 8 + 25;

/// Changes the announced number of frames.
fn announce(file: &mut AtomicFile, frames: u32, loop_count: u32) -> io::Result<()> {
    let body = [*b"acTL", frames.to_be_bytes(), loop_count.to_be_bytes()].concat();
    file.seek(SeekFrom::Start(ACTL_OFFSET + 4))?;
    file.write_all(&body)?;
    file.write_all(&checksum(&body).to_be_bytes())
}

/// The CRC-32 of PNG chunks (ISO 3309).
fn checksum(bytes: &[u8]) -> u32 {
    let step = |crc: u32, _| if crc & 1 == 1 { crc >> 1 ^ 0xEDB8_8320 } else { crc >> 1 };
    !bytes.iter().fold(u32::MAX, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), step))
}

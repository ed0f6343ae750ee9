//! Frames → H.264 stream: the encoder's settings and the split into GOPs.

use super::gops::{EncodeChunk, ParallelGops};
use crate::base::machine::{free_memory, thread_cpu_time};
use crate::encode::job::EncodeJob;
use rayon::ThreadPool;
use rusty_h264_common::{Profile, YuvFrame};
use rusty_h264_encoder::{Encoder, EncoderConfig, Preset, set_me_fc};
use std::io;
use std::mem::take;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Maximum duration of a GOP in seconds. Players can seek to its first frame.
const GOP_SECONDS: i128 = 1;
/// Maximum number of frames of a GOP at any rate.
const MAX_GOP: i128 = 250;
/// Frames of lookahead for the quality of macroblocks, and the maximum bytes of these frames.
const LOOKAHEAD: usize = 40;
const LOOKAHEAD_BYTES: usize = 1 << 26;
/// Maximum bytes of frames in flight, and the fraction of the free memory that they may take, as a divisor. Neither
/// affects the stream.
const IN_FLIGHT_BYTES: u64 = 1 << 29;
const MEMORY_SHARE: u64 = 8;

/// Encodes frames on all threads of a pool. Streams do not depend on the number of threads.
pub struct H264Encoder {
    config: EncoderConfig,
    gops: ParallelGops<YuvFrame>,
    /// Lengths of the remaining GOPs, in frames.
    lengths: Box<dyn Iterator<Item = usize> + Send>,
    /// Frames that the current GOP still takes.
    left: usize,
    /// The chunk that is being collected.
    chunk: Vec<YuvFrame>,
    /// Frames of a full chunk.
    chunk_length: usize,
    /// Nanoseconds of processor time that the pool has spent on encoding.
    cpu: Arc<AtomicU64>,
}

impl H264Encoder {
    /// `size` is that of the frames: width and height, both even.
    pub fn new(size: (usize, usize), job: &EncodeJob, pool: Arc<ThreadPool>) -> io::Result<Self> {
        // With this batching of the motion search, SIMD and scalar code would choose different vectors.
        set_me_fc(false);
        let config = config(size, job);
        // Report invalid settings now instead of at the first frame.
        Encoder::new(config.clone()).map_err(other)?;
        let frame_bytes = size.0 * size.1 * 3 / 2;
        let longest = config.gop_size as usize;
        let chunk_length = config.lookahead as usize;
        let wanted = (pool.current_num_threads() + 1) * longest;
        let room = IN_FLIGHT_BYTES.min(free_memory() / MEMORY_SHARE) as usize / frame_bytes;
        // At least one chunk is encoded while the next is collected.
        let limit = (wanted.min(room) / chunk_length).max(2);
        let lengths = Box::new(gop_lengths(job.frames.len(), longest));
        let (left, chunk, cpu) = Default::default();
        Ok(Self { config, gops: ParallelGops::new(pool, limit), lengths, left, chunk, chunk_length, cpu })
    }

    /// Adds the next frame.
    pub fn push(&mut self, frame: YuvFrame) -> io::Result<()> {
        if self.left == 0 {
            self.left = self.lengths.next().unwrap_or(self.config.gop_size as usize);
            self.gops.start(self.gop()?);
        }
        self.chunk.push(frame);
        self.left -= 1;
        if self.left == 0 || self.chunk.len() == self.chunk_length {
            self.gops.push(take(&mut self.chunk));
        }
        Ok(())
    }

    /// The next encoded stream in the order of the frames: Annex B units of whole frames. `None` if it is not encoded
    /// yet. Waits for it if too many frames are in flight.
    pub fn next(&mut self) -> Option<io::Result<Vec<u8>>> {
        self.gops.next(false)
    }

    /// Like [`H264Encoder::next`] after the last frame: waits for each stream. None after the last stream.
    pub fn rest(&mut self) -> Option<io::Result<Vec<u8>>> {
        if !self.chunk.is_empty() {
            self.gops.push(take(&mut self.chunk));
        }
        self.gops.next(true)
    }

    /// Seconds of processor time that the pool has spent on encoding.
    pub fn cpu(&self) -> f64 {
        self.cpu.load(Relaxed) as f64 * 1e-9
    }

    /// Starts a GOP with an encoder of its own, whose first frame is a keyframe.
    fn gop(&self) -> io::Result<EncodeChunk<YuvFrame>> {
        let mut encoder = Encoder::new(self.config.clone()).map_err(other)?;
        let cpu = Arc::clone(&self.cpu);
        Ok(Box::new(move |frames| {
            let before = thread_cpu_time().unwrap_or(0.0);
            let mut stream = Vec::new();
            for frame in &frames {
                stream.extend(encoder.try_encode(frame).map_err(other)?);
            }
            stream.extend(encoder.try_flush().map_err(other)?);
            cpu.fetch_add(((thread_cpu_time().unwrap_or(0.0) - before) * 1e9) as u64, Relaxed);
            Ok(stream)
        }))
    }
}

/// Splits frames into as few GOPs as `longest` allows. Their lengths differ by one at most, because a short GOP at the
/// end would cost a keyframe and leave other threads idle.
fn gop_lengths(frames: usize, longest: usize) -> impl Iterator<Item = usize> {
    let gops = frames.div_ceil(longest);
    (0..gops).map(move |gop| frames / gops + usize::from(gop < frames % gops))
}

/// The encoder's settings. They were chosen by measurement; docs/outputs.md has the figures.
fn config((width, height): (usize, usize), job: &EncodeJob) -> EncoderConfig {
    let rate = job.rate.per_second();
    let mut config = EncoderConfig::new(width, height);
    config.profile = Profile::Main;
    config.preset = Preset::Quality;
    config.qp = quantizer(job.formats.mp4.quality);
    config.framerate = (*rate.numer() as f64 / *rate.denom() as f64) as f32;
    config.gop_size = (rate * GOP_SECONDS).round().to_integer().clamp(1, MAX_GOP) as u32;
    // Scene cuts do not split GOPs.
    config.scenecut = 0;
    config.num_ref_frames = 2;
    config.me_wide = Some(false);
    config.lookahead = (LOOKAHEAD_BYTES / (width * height * 3 / 2)).clamp(1, LOOKAHEAD) as u32;
    config
}

/// The quantization parameter (QP) for a quality of 1..=100. Quality 75 gives QP 20, which is about visually lossless.
fn quantizer(quality: u8) -> u8 {
    (100 - quality.clamp(1, 100)).saturating_mul(4).div_ceil(5).min(51)
}

/// Converts the encoder's errors to I/O errors.
fn other(error: rusty_h264_encoder::EncodeError) -> io::Error {
    io::Error::other(error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn qualities_are_quantizers() {
        assert_eq!([100, 75, 50, 1].map(quantizer), [0, 20, 40, 51]);
    }

    #[test]
    fn gops_have_about_the_same_length() {
        let lengths = |frames, longest| gop_lengths(frames, longest).collect::<Vec<_>>();
        assert_eq!(lengths(60, 24), [20, 20, 20]);
        assert_eq!(lengths(49, 24), [17, 16, 16]);
        assert_eq!(lengths(24, 24), [24]);
        assert_eq!(lengths(3, 1), [1, 1, 1]);
        assert!(lengths(0, 24).is_empty());
    }
}

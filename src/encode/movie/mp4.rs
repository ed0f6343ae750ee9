//! MP4 with H.264: what browsers, slides and every player show.

use super::h264::{told_colors, units};
use super::h264_encoder::{H264Encoder, missing_instructions};
use super::yuv::Planes;
use crate::base::time::Rate;
use crate::encode::atomic::Aside;
use crate::encode::error::EncodeError;
use crate::encode::job::Job;
use crate::encode::movie::Movie;
use crate::encode::picture::Picture;
use rayon::ThreadPool;
use rusty_h264_common::YuvFrame;
use shiguredo_mp4::boxes::{Avc1Box, AvccBox, SampleEntry, UnknownBox, VisualSampleEntryFields as Visual};
use shiguredo_mp4::mux::{Mp4FileMuxer, Mp4FileMuxerOptions, Sample, estimate_maximum_moov_box_size};
use shiguredo_mp4::{BoxSize, BoxType, TrackKind, Uint};
use std::io::{self, Seek, SeekFrom, Write};
use std::num::NonZeroU32;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Blocks of 16x16 pixels in a picture, at most, and along a side: those of level 5.2.
const MOST_BLOCKS: u32 = 36_864;
const LONGEST_BLOCKS: u32 = 543;
/// Bytes of the size in front of each unit of a frame.
const LENGTH_BYTES: u8 = 4;
/// Kinds of units: parameters of the sequence and the pictures, and what starts a frame for those who seek.
const SEQUENCE: u8 = 7;
const PICTURES: u8 = 8;
const KEY: u8 = 5;
/// Units that hold a part of a picture.
const SLICES: std::ops::RangeInclusive<u8> = 1..=5;

/// What keeps pictures of this size from being H.264 on this machine.
pub fn limit((width, height): (u32, u32)) -> Option<&'static str> {
    let blocks = [width, height].map(|side| side.div_ceil(16));
    let fits = blocks[0].max(blocks[1]) <= LONGEST_BLOCKS && blocks[0] * blocks[1] <= MOST_BLOCKS;
    let size = (!fits).then_some("H.264 ends at 36864 blocks of 16x16 pixels, such as 4096x2304");
    size.or_else(missing_instructions)
}

/// An MP4 in the making.
pub struct Mp4 {
    path: PathBuf,
    rate: Rate,
    file: Aside,
    encoder: H264Encoder,
    muxer: Mp4FileMuxer,
    /// How far the file is written.
    position: u64,
    /// The parameters that players need first, once the encoder has told them.
    sequence: Vec<u8>,
    pictures: Vec<u8>,
    /// Width and height, both even.
    size: (usize, usize),
    /// Whether the first frame is written.
    started: bool,
}

impl Mp4 {
    /// Starts an MP4 that is encoded on the threads of `pool`.
    pub fn create(path: &Path, job: &Job, pool: &Arc<ThreadPool>) -> Result<Self, EncodeError> {
        let fault = |e: io::Error| EncodeError::write(path, e);
        // The encoder takes colour for squares of four pixels, so sides are even.
        let even = |side: u32| side.next_multiple_of(2) as usize;
        let size = (even(job.size.0), even(job.size.1));
        let encoder = H264Encoder::new(size, job, Arc::clone(pool)).map_err(fault)?;
        let options = Mp4FileMuxerOptions {
            // With the index in front, browsers play before all is there.
            reserved_moov_box_size: estimate_maximum_moov_box_size(&[job.frames.len()]),
            ..Mp4FileMuxerOptions::default()
        };
        let muxer = Mp4FileMuxer::with_options(options).map_err(|e| fault(other(e)))?;
        let mut file = Aside::create(path)?;
        let head = muxer.initial_boxes_bytes();
        file.write_all(head).map_err(fault)?;
        let position = head.len() as u64;
        let (sequence, pictures) = (Vec::new(), Vec::new());
        let (path, rate) = (path.to_path_buf(), job.rate);
        Ok(Self { path, rate, file, encoder, muxer, position, sequence, pictures, size, started: false })
    }

    fn add(&mut self, frame: YuvFrame) -> io::Result<()> {
        self.encoder.push(frame)?;
        while let Some(stream) = self.encoder.next() {
            self.write(&stream?)?;
        }
        Ok(())
    }

    /// Writes the frames that the encoder has finished. They come as units, each after a start code; every slice is
    /// a frame.
    fn write(&mut self, stream: &[u8]) -> io::Result<()> {
        let mut before = Vec::new();
        for unit in units(stream) {
            match unit.first().map(|first| first & 31) {
                Some(SEQUENCE) => self.sequence = told_colors(unit),
                Some(PICTURES) => self.pictures = unit.to_vec(),
                Some(kind) => {
                    before.extend((unit.len() as u32).to_be_bytes());
                    before.extend(unit);
                    if SLICES.contains(&kind) {
                        self.sample(&before, kind == KEY)?;
                        before.clear();
                    }
                }
                None => {}
            }
        }
        Ok(())
    }

    fn sample(&mut self, data: &[u8], keyframe: bool) -> io::Result<()> {
        let sample_entry = (!self.started).then(|| self.entry()).transpose()?;
        self.started = true;
        let (frames, seconds) = (*self.rate.per_second().numer(), *self.rate.per_second().denom());
        let timescale = u32::try_from(frames).ok().and_then(NonZeroU32::new);
        let sample = Sample {
            track_kind: TrackKind::Video,
            sample_entry,
            keyframe,
            timescale: timescale.ok_or_else(|| io::Error::other("this rate has no place in an MP4"))?,
            duration: u32::try_from(seconds).map_err(io::Error::other)?,
            composition_time_offset: None,
            data_offset: self.position,
            data_size: data.len(),
        };
        self.file.write_all(data)?;
        self.position += data.len() as u64;
        self.muxer.append_sample(&sample).map_err(other)
    }

    /// What players have to know before the first frame.
    fn entry(&self) -> io::Result<SampleEntry> {
        let [_, profile, compatible, level, ..] = self.sequence[..] else {
            return Err(io::Error::other("the encoder has not told its parameters"));
        };
        let short = |side: usize| u16::try_from(side).map_err(io::Error::other);
        Ok(SampleEntry::Avc1(Avc1Box {
            visual: Visual {
                data_reference_index: Visual::DEFAULT_DATA_REFERENCE_INDEX,
                width: short(self.size.0)?,
                height: short(self.size.1)?,
                horizresolution: Visual::DEFAULT_HORIZRESOLUTION,
                vertresolution: Visual::DEFAULT_VERTRESOLUTION,
                frame_count: Visual::DEFAULT_FRAME_COUNT,
                compressorname: [0; 32],
                depth: Visual::DEFAULT_DEPTH,
            },
            avcc_box: AvccBox {
                avc_profile_indication: profile,
                profile_compatibility: compatible,
                avc_level_indication: level,
                length_size_minus_one: Uint::new(LENGTH_BYTES - 1),
                sps_list: vec![self.sequence.clone()],
                pps_list: vec![self.pictures.clone()],
                chroma_format: None,
                bit_depth_luma_minus8: None,
                bit_depth_chroma_minus8: None,
                sps_ext_list: Vec::new(),
            },
            unknown_boxes: vec![colors()],
        }))
    }

    fn end(&mut self) -> io::Result<()> {
        while let Some(stream) = self.encoder.rest() {
            self.write(&stream?)?;
        }
        let done = self.muxer.finalize().map_err(other)?;
        for (offset, bytes) in done.offset_and_bytes_pairs() {
            self.file.seek(SeekFrom::Start(offset))?;
            self.file.write_all(bytes)?;
        }
        Ok(())
    }
}

impl Movie for Mp4 {
    fn push(&mut self, picture: &Picture) -> Result<(), EncodeError> {
        let frame = frame(&Planes::halved(picture), self.size);
        self.add(frame).map_err(|e| EncodeError::write(&self.path, e))
    }

    fn cpu(&self) -> f64 {
        self.encoder.cpu()
    }

    fn divert(&mut self) -> Option<PathBuf> {
        Some(self.file.divert())
    }

    fn finish(mut self: Box<Self>) -> Result<(), EncodeError> {
        self.end().map_err(|e| EncodeError::write(&self.path, e))?;
        self.file.commit()
    }
}

/// A frame of an even size; a row or column that is too few is there twice.
fn frame(planes: &Planes, (width, height): (usize, usize)) -> YuvFrame {
    let rows = (0..height).map(|y| &planes.y[y.min(planes.height - 1) * planes.width..][..planes.width]);
    let wide = rows.flat_map(|row| (0..width).map(|x| row[x.min(planes.width - 1)]));
    YuvFrame { width, height, y: wide.collect(), u: planes.u.clone(), v: planes.v.clone() }
}

/// What the codes mean: primaries, transfer and matrix of Rec. 709 in the limited range (ISO 14496-12, 12.1.5). The
/// transfer is told as that of Rec. 709, as every video does whose codes are meant for a screen.
fn colors() -> UnknownBox {
    let mut payload = b"nclx".to_vec();
    for number in [1u16; 3] {
        payload.extend(number.to_be_bytes());
    }
    payload.push(0);
    let size = BoxSize::U32(payload.len() as u32 + 8);
    UnknownBox { box_type: BoxType::Normal(*b"colr"), box_size: size, payload }
}

fn other(error: impl std::fmt::Debug) -> io::Error {
    io::Error::other(format!("{error:?}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_a_limit() {
        assert_eq!(limit((4096, 2304)), None);
        assert!(limit((4096, 2320)).is_some() && limit((9000, 16)).is_some());
    }
}

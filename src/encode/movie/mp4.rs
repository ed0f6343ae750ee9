//! MP4 with H.264, which browsers, presentation programs and all players support.

use super::h264::{nal_units, with_color_description};
use super::h264_encoder::H264Encoder;
use super::writer::MovieWriter;
use super::yuv::Planes;
use crate::base::time::Rate;
use crate::encode::atomic::AtomicFile;
use crate::encode::error::EncodeError;
use crate::encode::job::EncodeJob;
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

/// Bytes of the length before each unit of a frame.
const LENGTH_BYTES: u8 = 4;
/// Types of NAL units: sequence parameter set, picture parameter set, and slice of a keyframe (IDR).
const SPS: u8 = 7;
const PPS: u8 = 8;
const IDR_SLICE: u8 = 5;
/// Types of units that hold a slice of a picture.
const SLICES: std::ops::RangeInclusive<u8> = 1..=5;

/// An MP4 that is being written.
pub struct Mp4 {
    path: PathBuf,
    rate: Rate,
    file: AtomicFile,
    encoder: H264Encoder,
    muxer: Mp4FileMuxer,
    /// The current end of the file.
    position: u64,
    /// The parameter sets, which are empty until the encoder writes them.
    sps: Vec<u8>,
    pps: Vec<u8>,
    /// Width and height, both even.
    size: (usize, usize),
    /// Whether the first frame is written.
    started: bool,
}

impl Mp4 {
    /// Starts an MP4. The threads of `pool` encode it.
    pub fn create(path: &Path, job: &EncodeJob, pool: &Arc<ThreadPool>) -> Result<Self, EncodeError> {
        let fault = |e: io::Error| EncodeError::write(path, e);
        // The encoder uses 4:2:0 chroma, so both sides must be even.
        let even = |side: u32| side.next_multiple_of(2) as usize;
        let size = (even(job.size.0), even(job.size.1));
        let encoder = H264Encoder::new(size, job, Arc::clone(pool)).map_err(fault)?;
        let options = Mp4FileMuxerOptions {
            // Browsers can play a file before it is complete if the index comes first.
            reserved_moov_box_size: estimate_maximum_moov_box_size(&[job.frames.len()]),
            ..Mp4FileMuxerOptions::default()
        };
        let muxer = Mp4FileMuxer::with_options(options).map_err(|e| fault(other(e)))?;
        let mut file = AtomicFile::create(path)?;
        let head = muxer.initial_boxes_bytes();
        file.write_all(head).map_err(fault)?;
        let position = head.len() as u64;
        let (sps, pps) = (Vec::new(), Vec::new());
        let (path, rate) = (path.to_path_buf(), job.rate);
        Ok(Self { path, rate, file, encoder, muxer, position, sps, pps, size, started: false })
    }

    fn add(&mut self, frame: YuvFrame) -> io::Result<()> {
        self.encoder.push(frame)?;
        while let Some(stream) = self.encoder.next() {
            self.write(&stream?)?;
        }
        Ok(())
    }

    /// Writes encoded frames. The stream consists of units after start codes, and every slice is a frame.
    fn write(&mut self, stream: &[u8]) -> io::Result<()> {
        let mut before = Vec::new();
        for unit in nal_units(stream) {
            match unit.first().map(|first| first & 31) {
                Some(SPS) => self.sps = with_color_description(unit),
                Some(PPS) => self.pps = unit.to_vec(),
                Some(kind) => {
                    before.extend((unit.len() as u32).to_be_bytes());
                    before.extend(unit);
                    if SLICES.contains(&kind) {
                        self.sample(&before, kind == IDR_SLICE)?;
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
            timescale: timescale.ok_or_else(|| io::Error::other("an MP4 cannot hold this frame rate"))?,
            duration: u32::try_from(seconds).map_err(io::Error::other)?,
            composition_time_offset: None,
            data_offset: self.position,
            data_size: data.len(),
        };
        self.file.write_all(data)?;
        self.position += data.len() as u64;
        self.muxer.append_sample(&sample).map_err(other)
    }

    /// The description of the video track, with the parameter sets.
    fn entry(&self) -> io::Result<SampleEntry> {
        let [_, profile, compatible, level, ..] = self.sps[..] else {
            return Err(io::Error::other("the encoder has written no parameter sets"));
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
                sps_list: vec![self.sps.clone()],
                pps_list: vec![self.pps.clone()],
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

impl MovieWriter for Mp4 {
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

/// A frame of an even size. A missing row or column repeats the last one.
fn frame(planes: &Planes, (width, height): (usize, usize)) -> YuvFrame {
    let rows = (0..height).map(|y| &planes.y[y.min(planes.height - 1) * planes.width..][..planes.width]);
    let wide = rows.flat_map(|row| (0..width).map(|x| row[x.min(planes.width - 1)]));
    YuvFrame { width, height, y: wide.collect(), u: planes.u.clone(), v: planes.v.clone() }
}

/// The colour description: primaries, transfer function and matrix of Rec. 709 in the limited range (ISO 14496-12,
/// 12.1.5). The transfer function is given as that of Rec. 709, as in all videos whose codes are meant for screens.
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

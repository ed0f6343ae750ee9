//! Animations read back by independent decoders.

use super::*;
use crate::base::cancel::Stop;
use crate::base::time::Rate;
use crate::encode::picture::Picture;
use crate::encode::{DEFAULT_BACKGROUND_COLOR, Formats, LoopCount, SequenceInfo, Tonemap};
use image::codecs::png::PngDecoder;
use image::codecs::webp::WebPDecoder;
use image::{AnimationDecoder, Frame, ImageDecoder};
use std::fs;
use std::io::Cursor;

/// A square that moves over a grey background. The third frame repeats the second.
fn frames(size: (u32, u32), alpha: bool) -> Vec<Picture> {
    let frame = |k: u32| {
        let pixel = |i: u32| {
            let (x, y) = (i % size.0, i / size.0);
            let inside = (3 + 2 * k..9 + 2 * k).contains(&x) && (3..8).contains(&y);
            if inside { [200, (40 * k) as u8, 20] } else { [90 + (x % 3) as u8, 90, 90 + (y % 2) as u8] }
        };
        let count = size.0 * size.1;
        let mut picture = Picture::opaque(size.0, size.1, (0..count).flat_map(pixel).collect());
        picture.alpha = alpha.then(|| (0..count).map(|i| (i * 7 + k) as u8 | 1).collect());
        picture
    };
    [0, 1, 1, 2].map(frame).to_vec()
}

fn job(path: &str, size: (u32, u32), rate: (i128, i128), formats: Formats) -> EncodeJob {
    EncodeJob {
        confined: false,
        existing: crate::encode::Existing::default(),
        frame_keys: Vec::new(),
        outputs: vec![Output::parse(path).expect(path)],
        frames: (0..4).collect(),
        rate: Rate::new(rate.0, rate.1).expect("a rate"),
        size,
        tonemap: Tonemap::Srgb,
        transparent: false,
        background_color: DEFAULT_BACKGROUND_COLOR,
        drawings: Vec::new(),
        formats,
        info: SequenceInfo::default(),
    }
}

fn pool(threads: usize) -> Arc<ThreadPool> {
    Arc::new(rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool"))
}

/// The bytes of an animation of these frames.
fn make(name: &str, pictures: &[Picture], rate: (i128, i128), formats: Formats) -> Vec<u8> {
    make_on(2, name, pictures, rate, formats)
}

/// Like [`make`], on a number of threads.
fn make_on(
    threads: usize,
    name: &str,
    pictures: &[Picture],
    rate: (i128, i128),
    formats: Formats,
) -> Vec<u8> {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join(name);
    let size = (pictures[0].width, pictures[0].height);
    let mut job = job(&path.to_string_lossy(), size, rate, formats);
    job.frames = (0..pictures.len() as u32).collect();
    let mut movie =
        start(&job.outputs[0], &job, &pool(threads), &Stop::default()).expect("started").expect("a movie");
    pictures.iter().try_for_each(|picture| movie.push(picture)).expect("pushed");
    movie.finish().expect("finished");
    fs::read(path).expect("a file")
}

/// Asserts that decoded frames equal these pictures, and returns their delays as fractions of milliseconds.
fn same(found: Vec<Frame>, pictures: &[&Picture]) -> Vec<(u32, u32)> {
    assert_eq!(found.len(), pictures.len());
    for (found, picture) in found.iter().zip(pictures) {
        let opaque = vec![255; picture.rgb.len() / 3];
        let alpha = picture.alpha.clone().unwrap_or(opaque);
        let whole = Picture { alpha: Some(alpha), ..(*picture).clone() };
        assert!(found.buffer().as_raw() == &whole.interleaved());
    }
    found.iter().map(|frame| frame.delay().numer_denom_ms()).collect()
}

#[test]
fn apng_holds_every_frame_exactly() {
    for alpha in [false, true] {
        let pictures = frames((31, 17), alpha);
        let formats = Formats { apng: LoopCount(Some(3)), ..Formats::default() };
        let bytes = make("a.apng", &pictures, (30_000, 1001), formats);
        let reader = png::Decoder::new(Cursor::new(&bytes)).read_info().expect("a PNG");
        let control = reader.info().animation_control.expect("an animation");
        assert_eq!((control.num_frames, control.num_plays), (4, 3));
        let first = reader.info().frame_control.expect("a frame");
        assert_eq!((first.delay_num, first.delay_den), (1001, 30_000));
        let decoder = PngDecoder::new(Cursor::new(&bytes)).expect("a PNG").apng().expect("an APNG");
        let found = decoder.into_frames().collect_frames().expect("frames");
        same(found, &pictures.iter().collect::<Vec<_>>());
    }
}

#[test]
fn webp_holds_every_frame_exactly_and_equal_ones_once() {
    for alpha in [false, true] {
        let mut pictures = frames((31, 17), alpha);
        pictures[2] = pictures[1].clone();
        let bytes = make("a.webp", &pictures, (24, 1), Formats::default());
        assert_eq!(bytes.len() as u32 - 8, u32::from_le_bytes([bytes[4], bytes[5], bytes[6], bytes[7]]));
        let decoder = WebPDecoder::new(Cursor::new(&bytes)).expect("a WebP");
        assert!(decoder.has_animation() && decoder.dimensions() == (31, 17));
        let found = decoder.into_frames().collect_frames().expect("frames");
        let delays = same(found, &[&pictures[0], &pictures[1], &pictures[3]]);
        assert_eq!(delays, [(42, 1), (83, 1), (42, 1)]);
    }
}

#[test]
fn webp_frames_with_delays_of_hours_are_split() {
    let pictures = frames((4, 4), false);
    let bytes = make("a.webp", &[pictures[0].clone(), pictures[0].clone()], (1, 10_000), Formats::default());
    let found = WebPDecoder::new(Cursor::new(&bytes)).expect("a WebP").into_frames().collect_frames();
    assert_eq!(same(found.expect("frames"), &[&pictures[0]; 2]), [(10_000_000, 1); 2]);
}

#[test]
fn y4m_is_a_header_and_planes() {
    let pictures = frames((31, 17), false);
    for (full_chroma, chroma, name) in [(false, 16 * 9, "C420jpeg"), (true, 31 * 17, "C444")] {
        let formats = Formats { y4m: crate::encode::Y4mSettings { full_chroma }, ..Formats::default() };
        let bytes = make("a.y4m", &pictures, (30_000, 1001), formats);
        let head = format!("YUV4MPEG2 W31 H17 F30000:1001 Ip A1:1 {name} XCOLORRANGE=LIMITED\n");
        assert!(bytes.starts_with(head.as_bytes()));
        assert_eq!(bytes.len(), head.len() + 4 * (6 + 31 * 17 + 2 * chroma));
    }
}

/// The frames of an MP4 by a demuxer and a decoder that did not make it.
fn decoded(bytes: &[u8]) -> Vec<rusty_h264_common::YuvFrame> {
    let mut cursor = Cursor::new(bytes);
    let file = re_mp4::Mp4::read(&mut cursor, bytes.len() as u64).expect("an MP4");
    let track = file.tracks().values().next().expect("a track");
    assert_eq!(track.timescale, 30_000);
    assert!(track.samples.iter().all(|sample| sample.duration == 1001));
    let config = track.raw_codec_config(&file).expect("parameters");
    // One SPS and one PPS after the version, profile and level, each with a length of two bytes.
    let mut stream = Vec::new();
    let mut rest = &config[6..];
    for _ in 0..2 {
        let length = usize::from(u16::from_be_bytes([rest[0], rest[1]]));
        stream.extend([&[0, 0, 0, 1], &rest[2..2 + length]].concat());
        rest = &rest[2 + length + usize::from(stream.len() == length + 4)..];
    }
    for sample in &track.samples {
        let mut data = &bytes[sample.offset as usize..][..sample.size as usize];
        while let Some((length, after)) = data.split_first_chunk::<4>() {
            let length = u32::from_be_bytes(*length) as usize;
            stream.extend([&[0, 0, 0, 1], &after[..length]].concat());
            data = &after[length..];
        }
    }
    rusty_h264_decoder::Decoder::new().decode_stream(&stream).expect("a stream")
}

#[test]
fn mp4_shows_nearly_the_frames() {
    let pictures = frames((31, 17), false);
    let bytes = make("a.mp4", &pictures, (30_000, 1001), Formats::default());
    assert_eq!(&bytes[4..8], b"ftyp");
    let index = |name: &[u8]| bytes.windows(4).position(|at| at == name).expect("a box");
    assert!(index(b"moov") < index(b"mdat"), "the index is not in front");
    let found = decoded(&bytes);
    assert_eq!(found.len(), 4);
    for (found, picture) in found.iter().zip(&pictures) {
        assert_eq!((found.width, found.height), (32, 18));
        let planes = yuv::Planes::halved(picture);
        let off = |(i, code): (usize, &u8)| f64::from(code.abs_diff(found.y[i / 31 * 32 + i % 31]));
        let mean = planes.y.iter().enumerate().map(off).sum::<f64>() / planes.y.len() as f64;
        assert!(mean < 2.0, "{mean}");
    }
    assert!(
        bytes == make("a.mp4", &pictures, (30_000, 1001), Formats::default()),
        "not the same bytes again"
    );
}

/// Textures that move, a cut, and frames that are equal: 70 frames of 30 per second.
fn long() -> Vec<Picture> {
    let frame = |k: u32| {
        let k = k - k % 3;
        let pixel = move |i: u32| {
            let (x, y) = (i % 50 + k, i / 50 + k / 4);
            let code = (x * x / 9 + y * 11) as u8;
            if k < 40 { [code, (x ^ y) as u8, 90] } else { [40, code / 2, 255 - code] }
        };
        Picture::opaque(50, 38, (0..50 * 38).flat_map(pixel).collect())
    };
    (0..70).map(frame).collect()
}

#[test]
fn mp4s_are_the_same_on_any_number_of_threads() {
    let pictures = long();
    let bytes = make_on(1, "a.mp4", &pictures, (30_000, 1001), Formats::default());
    for threads in [2, 3, 8] {
        let again = make_on(threads, "a.mp4", &pictures, (30_000, 1001), Formats::default());
        assert!(bytes == again, "on {threads} threads");
    }
    let found = decoded(&bytes);
    assert_eq!(found.len(), 70);
    for (k, (found, picture)) in found.iter().zip(&pictures).enumerate() {
        let planes = yuv::Planes::halved(picture);
        let off = found.y.chunks(50).zip(planes.y.chunks(50)).flat_map(|(a, b)| a.iter().zip(b));
        let worst = off.map(|(a, b)| a.abs_diff(*b)).max().expect("pixels");
        assert!(worst < 40, "{worst} in frame {k}");
    }
}

/// The encoder has special code for some processors. Its bytes must be the same on all.
#[test]
fn mp4s_are_the_same_on_every_processor() {
    let bytes = make("a.mp4", &long(), (30_000, 1001), Formats::default());
    assert_eq!(blake3::hash(&bytes).to_hex()[..16], *"1d06b6d40a691bad");
}

/// Players can seek to a frame in every second, and all groups of pictures have about the same length.
#[test]
fn mp4s_have_a_keyframe_every_second() {
    let bytes = make("a.mp4", &long(), (30, 1), Formats::default());
    let file = re_mp4::Mp4::read(Cursor::new(&bytes), bytes.len() as u64).expect("an MP4");
    let samples = &file.tracks().values().next().expect("a track").samples;
    let keys: Vec<usize> = (0..samples.len()).filter(|&k| samples[k].is_sync).collect();
    assert_eq!(keys, [0, 24, 47]);
}

/// A stopped animation plays the frames so far, under the name of a partial file.
#[test]
fn stopped_animations_hold_their_frames() {
    let pictures = frames((31, 17), false);
    for name in ["a.apng", "a.webp", "a.mp4", "a.y4m"] {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join(name);
        let job = job(&path.to_string_lossy(), (31, 17), (24, 1), Formats::default());
        let mut movie =
            start(&job.outputs[0], &job, &pool(2), &Stop::default()).expect("started").expect("a movie");
        pictures[..2].iter().try_for_each(|picture| movie.push(picture)).expect("pushed");
        let part = movie.stop().expect("stopped").expect("a file");
        assert_eq!(part, dir.path().join(format!("part_{name}")));
        assert!(!path.exists());
        let bytes = fs::read(part).expect("a file");
        let found = match name {
            "a.apng" => {
                PngDecoder::new(Cursor::new(bytes)).and_then(PngDecoder::apng).expect("APNG").into_frames()
            }
            "a.webp" => WebPDecoder::new(Cursor::new(&bytes))
                .expect("a WebP")
                .into_frames()
                .collect_frames()
                .map(|f| {
                    assert_eq!(f.len(), 2);
                    image::Frames::new(Box::new(f.into_iter().map(Ok)))
                })
                .expect("frames"),
            "a.mp4" => {
                let size = bytes.len() as u64;
                let file = re_mp4::Mp4::read(Cursor::new(bytes), size).expect("an MP4");
                assert_eq!(file.tracks().values().next().expect("a track").samples.len(), 2);
                continue;
            }
            _ => continue,
        };
        same(found.collect_frames().expect("frames"), &[&pictures[0], &pictures[1]]);
    }
}

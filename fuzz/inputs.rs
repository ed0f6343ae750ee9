//! What is done with any bytes at all, by fuzzing and, with inputs that were kept, by tests. Whatever the bytes are,
//! the answer is a value or an error in words.
#![allow(clippy::expect_used, clippy::panic, reason = "a panic is how a fault is found")]
#![allow(dead_code, reason = "each fuzz target uses one of these")]

use kinora::appearance::texture::{ColorEncoding, Image};
use kinora::base::cancel::Stop;
use kinora::base::color::Rgb;
use kinora::base::files::Root;
use kinora::base::frame_set::FrameSet;
use kinora::base::math::Angle;
use kinora::base::stats::ProgressMeter;
use kinora::base::time::Rate;
use kinora::encode::{
    AnimationAssembler, DEFAULT_BACKGROUND_COLOR, EncodeError, EncodeJob, Encoder, Existing, Formats,
    FrameKey, Output, Picture, SequenceInfo, Tonemap,
};
use kinora::film::Film;
use kinora::geometry::mesh::{self, Center, Preparation, TriangleMesh};
use kinora::import;
use kinora::import::table::{Table, TableFormat};
use kinora::pipeline::schedule::{FilmSink, FrameLoop};
use kinora::sequence::{Sequence, parse};
use std::collections::HashSet;
use std::fs::File;
use std::io;
use std::sync::Arc;

/// The text of a sequence: read, or refused with messages that can be laid out.
pub fn sequence(bytes: &[u8]) {
    read(bytes);
}

fn read(bytes: &[u8]) -> Option<Sequence> {
    match parse("fuzz/fuzz.ron", std::str::from_utf8(bytes).ok()?) {
        Ok(sequence) => Some(sequence),
        Err(faults) => {
            assert!(!faults.render(false).is_empty());
            None
        }
    }
}

struct Nowhere;

impl FilmSink for Nowhere {
    fn push(&mut self, _: u32, film: Film) -> Result<(), EncodeError> {
        assert_eq!(film.radiance().count(), 12);
        Ok(())
    }
}

/// The text of a sequence, and its first and last frames at twelve pixels.
pub fn frame(bytes: &[u8]) {
    let Some(mut sequence) = read(bytes) else { return };
    sequence.output.size = (4, 3);
    let quality = &mut sequence.quality;
    (quality.antialias, quality.samples, quality.shutter_steps) = (1, 1, 1);
    quality.bounces = quality.bounces.min(4);
    let last = sequence.timeline.frames - 1;
    let mut frames = FrameLoop::new(&sequence, Nowhere, ProgressMeter::default().into());
    // A frame may lack a camera; none may panic.
    let _ = frames.frame(0).and_then(|()| frames.frame(last));
}

/// What `--frames` takes.
pub fn frame_set(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    match text.parse::<FrameSet>() {
        Ok(set) => {
            if let Ok(frames) = set.frames(100_000) {
                assert!(!frames.is_empty() && frames.is_sorted_by(|a, b| a < b));
                assert!(frames.last().is_some_and(|&last| last < 100_000));
            }
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// A glTF file.
pub fn gltf(bytes: &[u8]) {
    let folder = std::path::Path::new("fuzz");
    if let Err(error) = import::gltf::from_bytes(bytes, folder, &Root::of(folder)) {
        assert!(!error.to_string().is_empty());
    }
}

/// A PVD file, which lists at least one file in the order of time.
pub fn pvd(bytes: &[u8]) {
    match import::series::read_pvd(bytes) {
        Ok(steps) => assert!(!steps.is_empty() && steps.is_sorted_by(|a, b| a.time < b.time)),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// An OBJ file; what follows a zero byte is its material library.
pub fn obj(bytes: &[u8]) {
    let (text, library) = match bytes.iter().position(|&byte| byte == 0) {
        Some(end) => (&bytes[..end], &bytes[end + 1..]),
        None => (bytes, &b""[..]),
    };
    let _ = import::mtl::read(library);
    let open = |_: &str| -> io::Result<Vec<u8>> { Ok(library.to_vec()) };
    built(import::obj::read(text, &open));
}

/// A PLY file.
pub fn ply(bytes: &[u8]) {
    built(import::ply::read_sized(bytes, bytes.len() as u64));
}

/// An STL file.
pub fn stl(bytes: &[u8]) {
    built(import::stl::read(bytes, bytes.len() as u64));
}

/// A VTK file, legacy or XML.
pub fn vtk(bytes: &[u8]) {
    built(import::vtk::read(bytes));
    // The same bytes as the list of a parallel program.
    if let Ok(files) = import::vtk::pieces(bytes) {
        assert!(!files.is_empty());
    }
}

/// A table; its first byte says in which format.
pub fn table(bytes: &[u8]) {
    let Some((format, bytes)) = bytes.split_first() else { return };
    let format = if format % 2 == 0 { TableFormat::JsonLines } else { TableFormat::Csv };
    match Table::read(bytes, format) {
        Ok(table) => {
            assert_eq!(table.lines().len(), table.rows());
            assert!(table.lines().is_sorted());
            for name in table.names() {
                match table.column(name) {
                    Ok(values) => assert!(values.iter().all(|value| value.is_finite())),
                    Err(error) => assert!(error.line.is_some()),
                }
            }
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

fn built(parts: Result<mesh::MeshData, mesh::MeshError>) {
    if let Ok(parts) = &parts {
        let preparation =
            Preparation { center: Center::Bounds, crease: Some(Angle(40.0)), ..Preparation::default() };
        let mut prepared = parts.clone();
        preparation.apply(&mut prepared);
        let _ = TriangleMesh::new(prepared);
    }
    match parts.and_then(TriangleMesh::new) {
        Ok(mesh) => assert!(!mesh.smooth_normals().is_empty()),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// An image file of any format.
pub fn picture(bytes: &[u8]) {
    match Image::decode(bytes, ColorEncoding::Srgb) {
        Ok(image) => assert!(image.width() > 0 && image.height() > 0),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// A frame's file that is there when a run begins; its first byte says in which format.
pub fn kept(bytes: &[u8]) {
    let Some((format, bytes)) = bytes.split_first() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let name = ["f_#.png", "f_#.exr"][usize::from(format % 2)];
    let output = Output::parse(folder.path().join(name)).expect("an output");
    let mut job = job(&output, (2, 1), 1);
    job.frame_keys = vec![FrameKey::default()];
    std::fs::write(output.path(0), bytes).expect("a disk");
    let pool = Arc::new(rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread"));
    let start = |job: EncodeJob| Encoder::start(job, Arc::clone(&pool), &Stop::default()).expect("a job");
    let mut encoder = start(job.clone());
    if encoder.missing() == [0] {
        encoder.push(0, Film::new(2, 1, vec![Rgb::ONE])).expect("a film");
    }
    encoder.finish().expect("a file");
    assert!(start(job).missing().is_empty(), "what has been written is not kept");
}

/// Three numbers and pixels, as a GIF that is read back: as many colours as fit come out as they went in.
pub fn gif(bytes: &[u8]) {
    let &[width, height, rate, colors, ref codes @ ..] = bytes else { return };
    let (width, height) = (u32::from(width % 24) + 1, u32::from(height % 24) + 1);
    let area = (width * height) as usize;
    let frames = codes.len().div_ceil(area).clamp(1, 12);
    // A code is a colour of 3, 3 and 2 bits, so that colours come again.
    let color = |i: usize| codes.get(i).map_or([0; 3], |&code| [code & 0xe0, code << 3 & 0xe0, code << 6]);
    let pictures: Vec<Vec<u8>> =
        (0..frames).map(|frame| (frame * area..(frame + 1) * area).flat_map(color).collect()).collect();
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.gif");
    let mut formats = Formats::default();
    formats.gif.colors = u16::from(colors).max(1) + 1;
    let rate = Rate::new(i128::from(rate % 60) + 1, 1).expect("a rate");
    let output = Output::parse(&path).expect("an output");
    let job = EncodeJob { rate, formats, ..job(&output, (width, height), frames as u32) };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let mut assembly = AnimationAssembler::start(job, Arc::new(pool)).expect("a job");
    for rgb in &pictures {
        assembly.push(&Picture::opaque(width, height, rgb.clone())).expect("a frame");
    }
    assembly.finish().expect("a file");
    let distinct = pictures.iter().flat_map(|rgb| rgb.as_chunks::<3>().0).collect::<HashSet<_>>().len();
    let shown = played(&path, area);
    let total: u64 = shown.iter().map(|(_, delay)| delay).sum();
    let exact = frames as f64 * 100.0 / rate_of(rate);
    assert!((total as f64 - exact).abs() <= 2.0, "{total} instead of {exact} hundredths");
    if distinct <= usize::from(formats.gif.colors) && rate_of(rate) <= 50.0 {
        let mut expected = pictures;
        expected.dedup();
        let mut found: Vec<_> = shown.into_iter().map(|(rgb, _)| rgb).collect();
        found.dedup();
        assert!(found == expected, "{distinct} colours of {} differ", formats.gif.colors);
    }
}

/// What writes so many frames into one output.
fn job(output: &Output, size: (u32, u32), frames: u32) -> EncodeJob {
    EncodeJob {
        outputs: vec![output.clone()],
        confined: false,
        existing: Existing::Keep,
        frames: (0..frames).collect(),
        frame_keys: Vec::new(),
        rate: Rate::default(),
        size,
        tonemap: Tonemap::default(),
        transparent: false,
        background_color: DEFAULT_BACKGROUND_COLOR,
        drawings: Vec::new(),
        formats: Formats::default(),
        info: SequenceInfo::default(),
    }
}

fn rate_of(rate: Rate) -> f64 {
    rate.to_string().parse().expect("a whole number")
}

/// The pictures of a GIF with their delays in hundredths of a second.
fn played(path: &std::path::Path, area: usize) -> Vec<(Vec<u8>, u64)> {
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut reader = options.read_info(File::open(path).expect("a file")).expect("a GIF");
    let width = usize::from(reader.width());
    let (mut canvas, mut shown) = (vec![0; 3 * area], Vec::new());
    while let Some(frame) = reader.read_next_frame().expect("a frame") {
        let (left, top) = (usize::from(frame.left), usize::from(frame.top));
        let size = usize::from(frame.width);
        for (i, &[r, g, b, alpha]) in frame.buffer.as_chunks::<4>().0.iter().enumerate() {
            if alpha > 0 {
                let at = 3 * ((top + i / size) * width + left + i % size);
                canvas[at..at + 3].copy_from_slice(&[r, g, b]);
            }
        }
        shown.push((canvas.clone(), u64::from(frame.delay)));
    }
    shown
}

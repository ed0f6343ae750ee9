//! A loaded sequence, and what renders it.

use crate::errors::{not_loaded, not_rendered, wrong_type, wrong_value};
use crate::watch::{self, Watched};
use kinora::base::files::Root;
use kinora::cli::keywords::{KeywordError, Keywords, frames_of};
use kinora::encode::Picture;
use kinora::pipeline::pictures::{PicturesRequest, render_pictures, write_pictures};
use kinora::pipeline::render::render_until;
use kinora::sequence::{load_text, load_watched};
use kinora::{Existing, Output, Request};
use pyo3::prelude::*;
use pyo3::types::{PyByteArray, PyType};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A frame for Python: its number, its codes row by row, and its radiance as native `f32`.
type FrameBytes<'py> = (u32, Bound<'py, PyByteArray>, Option<Bound<'py, PyByteArray>>);

/// A sequence with the settings of its keywords.
#[pyclass(frozen, module = "kinora._kinora")]
pub struct Sequence {
    sequence: Arc<kinora::Sequence>,
    keywords: Keywords,
}

#[pymethods]
impl Sequence {
    /// Loads a file, or the text that a file of this path would have.
    #[classmethod]
    fn load(
        _class: &Bound<'_, PyType>,
        py: Python<'_>,
        path: PathBuf,
        text: Option<String>,
        options: Vec<(String, Option<String>)>,
    ) -> PyResult<Self> {
        let keywords = Keywords::parse(&options).map_err(|error| match error {
            KeywordError::Unknown(why) => wrong_type(why),
            KeywordError::Value(why) => wrong_value(why),
        })?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let root = if keywords.allow_outside() { Root::anywhere() } else { Root::of(folder) };
        // Meshes may take long to load.
        let load = move |_: &_, _: &_| match text {
            Some(text) => load_text(&path, &text, root, &Arc::default()),
            None => load_watched(&path, root, &Arc::default()),
        };
        let loaded = watch::run(py, Watched { progress: None, frames: 0, settles: false }, load)?;
        let sequence = loaded.map_err(|error| not_loaded(py, &error))?;
        let sequence = Arc::new(keywords.apply(sequence).map_err(wrong_value)?);
        Ok(Self { sequence, keywords })
    }

    /// The name of the file without its extension.
    #[getter]
    fn name(&self) -> &str {
        &self.sequence.name
    }

    /// Width and height in pixels.
    #[getter]
    fn size(&self) -> (u32, u32) {
        self.sequence.output.size
    }

    /// The number of frames.
    #[getter]
    fn count(&self) -> u32 {
        self.sequence.timeline.frames
    }

    /// Frames per second, as numerator and denominator.
    #[getter]
    fn rate(&self) -> (i128, i128) {
        let rate = self.sequence.timeline.rate.per_second();
        (*rate.numer(), *rate.denom())
    }

    /// Codes per pixel: 3, or 4 with alpha.
    #[getter]
    fn channels(&self) -> usize {
        if self.sequence.output.transparent { 4 } else { 3 }
    }

    /// Things that are valid but may not be intended.
    fn notes(&self) -> Vec<String> {
        self.sequence.notes()
    }

    /// The frames of a set such as `0-47:2`.
    fn frames(&self, set: &str) -> PyResult<Vec<u32>> {
        frames_of(set, &self.sequence).map_err(wrong_value)
    }

    /// Renders frames into memory.
    fn render<'py>(
        &self,
        py: Python<'py>,
        frames: Vec<u32>,
        linear: bool,
        progress: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Vec<FrameBytes<'py>>> {
        let (threads, reuse) = (self.keywords.threads(), self.keywords.reuse());
        let watched = Watched { progress: progress.as_ref(), frames: frames.len(), settles: false };
        let (sequence, request) =
            (Arc::clone(&self.sequence), PicturesRequest { frames, radiance: linear, threads, reuse });
        let rendered =
            watch::run(py, watched, move |meter, stop| render_pictures(&sequence, &request, meter, stop))?;
        let (pictures, _) = rendered.map_err(|error| not_rendered(&error))?;
        let bytes = pictures.into_iter().map(|frame| {
            let radiance = frame.radiance.map(|light| {
                let bytes = light.iter().flat_map(|light| light.to_array()).flat_map(f32::to_ne_bytes);
                PyByteArray::new(py, &bytes.collect::<Vec<u8>>())
            });
            (frame.frame, PyByteArray::new(py, &frame.picture.interleaved()), radiance)
        });
        Ok(bytes.collect())
    }

    /// Renders frames into files, and returns their names. Frames that exist and are current are kept.
    fn render_files(
        &self,
        py: Python<'_>,
        frames: Vec<u32>,
        outputs: Vec<OsString>,
        replace: bool,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<(Vec<PathBuf>, Vec<String>)> {
        let outputs = outputs.into_iter().map(Output::parse).collect::<Result<_, _>>();
        let request = Request {
            frames,
            threads: self.keywords.threads(),
            reuse: self.keywords.reuse(),
            existing: if replace { Existing::Replace } else { Existing::Keep },
            ..Request::new(&self.sequence, outputs.map_err(wrong_value)?)
        };
        let watched = Watched { progress: progress.as_ref(), frames: request.frames.len(), settles: true };
        let sequence = Arc::clone(&self.sequence);
        let done =
            watch::run(py, watched, move |meter, stop| render_until(&sequence, &request, meter, stop))?;
        let done = done.map_err(|error| not_rendered(&error))?;
        Ok((done.files, done.notes))
    }

    /// Writes pictures into an animation, or into a still for each of them. Returns notes.
    fn save(
        &self,
        py: Python<'_>,
        path: OsString,
        frames: Vec<u32>,
        size: (u32, u32),
        pictures: Vec<Vec<u8>>,
    ) -> PyResult<Vec<String>> {
        let output = Output::parse(path).map_err(wrong_value)?;
        let (width, height) = size;
        let pixels = width as usize * height as usize;
        let picture = |codes: Vec<u8>| match codes.len().checked_div(pixels) {
            Some(3) => Ok(Picture::opaque(width, height, codes)),
            Some(4) => {
                let pixels = codes.as_chunks::<4>().0;
                let rgb = pixels.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
                Ok(Picture { width, height, rgb, alpha: Some(pixels.iter().map(|pixel| pixel[3]).collect()) })
            }
            _ => Err(wrong_value("pictures need 3 or 4 values per pixel")),
        };
        let pictures = pictures.into_iter().map(picture).collect::<PyResult<Vec<_>>>()?;
        let sequence = Arc::clone(&self.sequence);
        let watched = Watched { progress: None, frames: 0, settles: false };
        let written =
            watch::run(py, watched, move |_, _| write_pictures(&sequence, (&frames, &pictures), &output))?;
        written.map(|report| report.notes).map_err(|error| not_rendered(&error))
    }
}

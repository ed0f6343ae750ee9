//! Raw video for any encoder: YUV4MPEG2, to a file or the standard output.

use super::yuv::Planes;
use crate::base::cancel::Stop;
use crate::encode::atomic::Aside;
use crate::encode::error::EncodeError;
use crate::encode::job::Job;
use crate::encode::movie::Movie;
use crate::encode::picture::Picture;
use std::io::{self, BufWriter, Stdout, Write};
use std::path::{Path, PathBuf};

/// Raw video in the making.
pub struct Y4m {
    to: To,
    full_chroma: bool,
}

enum To {
    File { path: PathBuf, file: Box<Aside> },
    Stdout(BufWriter<Stdout>),
}

impl Y4m {
    pub fn create(path: &Path, job: &Job, stop: &Stop) -> Result<Self, EncodeError> {
        let file = Box::new(Aside::create_until(path, stop)?);
        Self::start(To::File { path: path.to_path_buf(), file }, job)
    }

    /// Frames go out as soon as they are there.
    pub fn to_stdout(job: &Job) -> Result<Self, EncodeError> {
        Self::start(To::Stdout(BufWriter::with_capacity(1 << 16, io::stdout())), job)
    }

    fn start(to: To, job: &Job) -> Result<Self, EncodeError> {
        let full_chroma = job.formats.y4m.full_chroma;
        let mut y4m = Self { to, full_chroma };
        // Colour is in the middle of its four pixels, as in JPEG.
        let chroma = if full_chroma { "C444" } else { "C420jpeg" };
        let (rate, (width, height)) = (job.rate.per_second(), job.size);
        let (frames, seconds) = (rate.numer(), rate.denom());
        let head = format!(
            "YUV4MPEG2 W{width} H{height} F{frames}:{seconds} Ip A1:1 {chroma} XCOLORRANGE=LIMITED\n"
        );
        y4m.put(&[head.as_bytes()])?;
        Ok(y4m)
    }

    fn put(&mut self, parts: &[&[u8]]) -> Result<(), EncodeError> {
        let (path, to): (&Path, &mut dyn Write) = match &mut self.to {
            To::File { path, file } => (path, file),
            To::Stdout(stdout) => (Path::new("the standard output"), stdout),
        };
        parts.iter().try_for_each(|part| to.write_all(part)).map_err(|e| EncodeError::write(path, e))
    }
}

impl Movie for Y4m {
    fn push(&mut self, picture: &Picture) -> Result<(), EncodeError> {
        let planes = if self.full_chroma { Planes::full(picture) } else { Planes::halved(picture) };
        let [y, u, v] = planes.all();
        self.put(&[b"FRAME\n", y, u, v])?;
        match &mut self.to {
            To::Stdout(stdout) => stdout.flush().map_err(|e| EncodeError::write("the standard output", e)),
            To::File { .. } => Ok(()),
        }
    }

    fn divert(&mut self) -> Option<PathBuf> {
        match &mut self.to {
            To::File { file, .. } => Some(file.divert()),
            To::Stdout(_) => None,
        }
    }

    fn finish(self: Box<Self>) -> Result<(), EncodeError> {
        match self.to {
            To::File { file, .. } => file.commit(),
            To::Stdout(mut stdout) => {
                stdout.flush().map_err(|e| EncodeError::write("the standard output", e))
            }
        }
    }
}

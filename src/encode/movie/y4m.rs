//! Raw video for other encoders: YUV4MPEG2, to a file or the standard output.

use super::writer::MovieWriter;
use super::yuv::Planes;
use crate::base::cancel::Stop;
use crate::encode::atomic::AtomicFile;
use crate::encode::error::EncodeError;
use crate::encode::job::EncodeJob;
use crate::encode::picture::Picture;
use std::io::{self, BufWriter, Stdout, Write};
use std::path::{Path, PathBuf};

/// Raw video that is being written.
pub struct Y4m {
    sink: Sink,
    full_chroma: bool,
}

enum Sink {
    File { path: PathBuf, file: Box<AtomicFile> },
    Stdout(BufWriter<Stdout>),
}

impl Y4m {
    pub fn create(path: &Path, job: &EncodeJob, stop: &Stop) -> Result<Self, EncodeError> {
        let file = Box::new(AtomicFile::create_until(path, stop)?);
        Self::start(Sink::File { path: path.to_path_buf(), file }, job)
    }

    /// Writes to the standard output, which is flushed after every frame.
    pub fn to_stdout(job: &EncodeJob) -> Result<Self, EncodeError> {
        Self::start(Sink::Stdout(BufWriter::with_capacity(1 << 16, io::stdout())), job)
    }

    fn start(sink: Sink, job: &EncodeJob) -> Result<Self, EncodeError> {
        let full_chroma = job.formats.y4m.full_chroma;
        let mut y4m = Self { sink, full_chroma };
        // Chroma samples are in the centre of four pixels, as in JPEG.
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
        let (path, writer): (&Path, &mut dyn Write) = match &mut self.sink {
            Sink::File { path, file } => (path, file),
            Sink::Stdout(stdout) => (Path::new("the standard output"), stdout),
        };
        parts.iter().try_for_each(|part| writer.write_all(part)).map_err(|e| EncodeError::write(path, e))
    }
}

impl MovieWriter for Y4m {
    fn push(&mut self, picture: &Picture) -> Result<(), EncodeError> {
        let planes = if self.full_chroma { Planes::full(picture) } else { Planes::halved(picture) };
        let [y, u, v] = planes.all();
        self.put(&[b"FRAME\n", y, u, v])?;
        match &mut self.sink {
            Sink::Stdout(stdout) => stdout.flush().map_err(|e| EncodeError::write("the standard output", e)),
            Sink::File { .. } => Ok(()),
        }
    }

    fn divert(&mut self) -> Option<PathBuf> {
        match &mut self.sink {
            Sink::File { file, .. } => Some(file.divert()),
            Sink::Stdout(_) => None,
        }
    }

    fn finish(self: Box<Self>) -> Result<(), EncodeError> {
        match self.sink {
            Sink::File { file, .. } => file.commit(),
            Sink::Stdout(mut stdout) => {
                stdout.flush().map_err(|e| EncodeError::write("the standard output", e))
            }
        }
    }
}

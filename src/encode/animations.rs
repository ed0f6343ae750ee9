//! All animations of a run. They take the same pictures.

use super::atomic::part_of;
use super::error::EncodeError;
use super::gif::Animation;
use super::job::EncodeJob;
use super::movie::{self, MovieWriter};
use super::output::{AnimationFormat, Output};
use super::picture::Picture;
use super::store::Store;
use crate::base::cancel::Stop;
use crate::base::escape;
use rayon::ThreadPool;
use std::path::PathBuf;
use std::sync::Arc;

/// The animations that are being written.
pub struct Animations {
    /// Each with whether its pictures may have alpha.
    movies: Vec<(Box<dyn MovieWriter>, bool)>,
    gifs: Vec<Animation>,
    /// Frames on disk until the palettes of the GIFs are known. `None` if there are no GIFs.
    store: Option<Store>,
    /// Number of pictures so far.
    done: usize,
}

impl Animations {
    /// Starts the animations of a job, which use the threads of `pool`. `own` is a store that the run's own stills
    /// fill. A request of `stop` ends the wait for a pipe's reader.
    pub fn start(
        job: &EncodeJob,
        own: Option<Store>,
        pool: &Arc<ThreadPool>,
        stop: &Stop,
    ) -> Result<Self, EncodeError> {
        let mut movies = Vec::new();
        for output in &job.outputs {
            movies.extend(movie::start(output, job, pool, stop)?.map(|movie| (movie, output.takes_alpha())));
        }
        let gifs = job.outputs.iter().filter_map(|output| match output {
            Output::Movie(AnimationFormat::Gif, path) => Some(path),
            _ => None,
        });
        let store = match (gifs.clone().next(), own) {
            (None, _) => None,
            (Some(_), Some(own)) => Some(own),
            (Some(path), None) => Some(Store::spool_for(path)?),
        };
        let gifs = gifs.map(|path| Animation::new(path, job)).collect::<Result<_, _>>()?;
        Ok(Self { movies, gifs, store, done: 0 })
    }

    /// Adds the next picture. Formats without alpha take `opaque`, the same picture on a background.
    pub fn push(&mut self, picture: &Picture, opaque: &Picture) -> Result<(), EncodeError> {
        for (movie, alpha) in &mut self.movies {
            movie.push(if *alpha { picture } else { opaque })?;
        }
        let index = self.done;
        self.done += 1;
        let mut shown = self.gifs.iter_mut().filter(|animation| animation.shows(index)).peekable();
        if shown.peek().is_none() {
            return Ok(());
        }
        let cut =
            picture.alpha.as_ref().map(|alpha| Picture { alpha: Some(one_bit(alpha)), ..opaque.clone() });
        let picture = cut.as_ref().unwrap_or(opaque);
        shown.for_each(|animation| animation.count(picture));
        self.store.as_ref().map_or(Ok(()), |store| store.put(index, picture))
    }

    /// Processor time of the pool for animations so far, in seconds.
    pub fn cpu(&self) -> f64 {
        self.movies.iter().map(|(movie, _)| movie.cpu()).sum()
    }

    /// Whether there was no picture yet.
    pub fn is_empty(&self) -> bool {
        self.done == 0
    }

    /// Closes all animations with the pictures so far, as `part_NAME`. Returns the paths.
    pub fn stop(self, pool: &ThreadPool) -> Result<Vec<PathBuf>, EncodeError> {
        let mut files = Vec::new();
        for (movie, _) in self.movies {
            files.extend(movie.stop()?);
        }
        if let Some(store) = self.store {
            for animation in self.gifs {
                let animation = animation.truncated(self.done);
                files.push(animation.path().to_path_buf());
                pool.install(|| animation.write(|index| store.get(index)))?;
            }
        }
        Ok(files)
    }

    /// Finishes all animations and renames their files into place. Returns notes for the user.
    pub fn finish(self, job: &EncodeJob, pool: &ThreadPool) -> Result<Vec<String>, EncodeError> {
        let mut notes = Vec::new();
        for (movie, _) in self.movies {
            movie.finish()?;
        }
        if let Some(store) = self.store {
            for animation in self.gifs {
                notes.extend(animation.dropped_note(job));
                notes.extend(pool.install(|| animation.write(|index| store.get(index)))?);
            }
        }
        notes.extend(job.outputs.iter().filter_map(|output| left_part(output, job)));
        Ok(notes)
    }
}

/// Alpha of GIFs, which have one bit: a pixel is opaque if at least half of it is covered.
fn one_bit(alpha: &[u8]) -> Vec<u8> {
    alpha.iter().map(|&alpha| if alpha < 128 { 0 } else { 255 }).collect()
}

/// A note about the partial animation of an earlier run. It stays, because the user may want it.
fn left_part(output: &Output, job: &EncodeJob) -> Option<String> {
    let Output::Movie(_, path) = output else { return None };
    let part = part_of(path);
    let own = job.outputs.iter().any(|other| matches!(other, Output::Movie(_, path) if *path == part));
    let there = !own && part.is_file();
    there.then(|| {
        format!(
            "{} holds a part of this animation from an earlier run and can be deleted",
            escape::path(part)
        )
    })
}

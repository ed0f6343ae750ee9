//! All animations of a run, fed with the same pictures.

use super::atomic::part_of;
use super::error::EncodeError;
use super::gif::Animation;
use super::job::Job;
use super::movie::{self, Movie};
use super::output::{Moving, Output};
use super::picture::Picture;
use super::store::Store;
use crate::base::cancel::Stop;
use crate::base::escape;
use rayon::ThreadPool;
use std::path::PathBuf;
use std::sync::Arc;

/// The animations in the making.
pub struct Animations {
    /// Each with whether its pictures may have alpha.
    movies: Vec<(Box<dyn Movie>, bool)>,
    gifs: Vec<Animation>,
    /// Where frames wait until the GIFs' palettes are known; there if there are GIFs.
    store: Option<Store>,
    /// Pictures so far.
    done: usize,
}

impl Animations {
    /// Those of a job, which use the threads of `pool`. `own` is a store that the run fills anyhow, if there is one.
    /// `stop` ends waiting for who reads a pipe.
    pub fn start(
        job: &Job,
        own: Option<Store>,
        pool: &Arc<ThreadPool>,
        stop: &Stop,
    ) -> Result<Self, EncodeError> {
        let mut movies = Vec::new();
        for output in &job.outputs {
            movies.extend(movie::start(output, job, pool, stop)?.map(|movie| (movie, output.takes_alpha())));
        }
        let gifs = job.outputs.iter().filter_map(|output| match output {
            Output::Movie(Moving::Gif, path) => Some(path),
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

    /// Adds the next picture, in front of `matte` for formats without alpha.
    pub fn push(&mut self, picture: &Picture, matte: &Picture) -> Result<(), EncodeError> {
        for (movie, alpha) in &mut self.movies {
            movie.push(if *alpha { picture } else { matte })?;
        }
        let index = self.done;
        self.done += 1;
        let mut shown = self.gifs.iter_mut().filter(|animation| animation.shows(index)).peekable();
        if shown.peek().is_none() {
            return Ok(());
        }
        let cut = picture.alpha.as_ref().map(|alpha| Picture { alpha: Some(halved(alpha)), ..matte.clone() });
        let picture = cut.as_ref().unwrap_or(matte);
        shown.for_each(|animation| animation.count(picture));
        self.store.as_ref().map_or(Ok(()), |store| store.put(index, picture))
    }

    /// Seconds of processor time that the pool has spent on animations so far.
    pub fn cpu(&self) -> f64 {
        self.movies.iter().map(|(movie, _)| movie.cpu()).sum()
    }

    /// Whether no picture has come.
    pub fn is_empty(&self) -> bool {
        self.done == 0
    }

    /// Closes all animations as they are, each beside its place, and names the files.
    pub fn stop(self, pool: &ThreadPool) -> Result<Vec<PathBuf>, EncodeError> {
        let mut files = Vec::new();
        for (movie, _) in self.movies {
            files.extend(movie.stop()?);
        }
        if let Some(store) = self.store {
            for animation in self.gifs {
                let animation = animation.cut(self.done);
                files.push(animation.path().to_path_buf());
                pool.install(|| animation.write(|index| store.get(index)))?;
            }
        }
        Ok(files)
    }

    /// Writes what is left and puts all files in their places. Returns what users should know.
    pub fn finish(self, job: &Job, pool: &ThreadPool) -> Result<Vec<String>, EncodeError> {
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

/// Alpha for GIFs, whose pixels are there or not: there if half of them is covered.
fn halved(alpha: &[u8]) -> Vec<u8> {
    alpha.iter().map(|&alpha| if alpha < 128 { 0 } else { 255 }).collect()
}

/// Tells of a part that an earlier run has left beside a whole animation. It may be wanted, and stays.
fn left_part(output: &Output, job: &Job) -> Option<String> {
    let Output::Movie(_, path) = output else { return None };
    let part = part_of(path);
    let own = job.outputs.iter().any(|other| matches!(other, Output::Movie(_, path) if *path == part));
    let there = !own && part.is_file();
    there.then(|| {
        format!("{} holds a part of this animation, of an earlier run, and may go", escape::path(part))
    })
}

//! Series of meshes: one file per time. All files are checked once. Each is loaded again when its time comes, or just
//! before, so that memory holds a few of them, however many there are.

mod ahead;
mod cache;
mod numbered;
mod pvd;

pub use numbered::{NumberRange, NumberedError, numbered};
pub use pvd::{PvdFile, PvdStep, read as read_pvd};

use super::LoadProgress;
use super::load::{build, load_parts};
use crate::base::digest::Digest;
use crate::base::escape;
use crate::base::files::Root;
use crate::base::math::{Aabb, DVec3, gamma};
use crate::base::time::{Fraction, Time};
use crate::geometry::mesh::{MeshData, MeshError, MeshSummary, Normals, Preparation, TriangleMesh};
use crate::geometry::shape::{Mesh, MeshStep};
use crate::track::{Animate, Animated, Modes};
use ahead::Ahead;
use cache::Cache;
use rayon::prelude::*;
use std::fmt;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

/// Files that are checked at the same time; as many meshes are in memory then.
const CHECKED_AT_ONCE: usize = 4;

/// Where a series is between its steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepMix {
    pub from: usize,
    pub to: usize,
    pub share: Fraction,
}

impl StepMix {
    /// A step alone.
    pub fn only(step: usize) -> Self {
        Self { from: step, to: step, share: Fraction { num: 0.0, den: 1.0 } }
    }
}

impl Animate for StepMix {
    const MODES: Modes = Modes::Ease;

    fn mix(a: &Self, b: &Self, share: Fraction) -> Self {
        Self { from: a.from, to: b.from, share }
    }
}

/// The files of a series and what is done with them.
#[derive(Clone, Debug, PartialEq)]
pub struct SeriesFiles {
    /// The admitted paths of each step, in the order of time. There is at least one step, and each has one file, or one for
    /// each part of its mesh.
    pub steps: Vec<Vec<PathBuf>>,
    /// The step of every time.
    pub track: Animated<StepMix>,
    pub preparation: Preparation,
    /// The kind of normals. None for the files' own where there are some, otherwise flat.
    pub normals: Option<Normals>,
}

/// Files and what was found in them.
#[derive(Debug)]
struct CheckedFiles {
    files: SeriesFiles,
    root: Root,
    steps: Vec<MeshSummary>,
    /// The point of the first file that moves to the origin, in all files.
    center: Option<DVec3>,
}

/// A series of checked mesh files.
#[derive(Debug)]
pub struct MeshSeries {
    checked: Arc<CheckedFiles>,
    /// The first step whose file has other materials than the first file.
    other_materials: Option<usize>,
    first: Arc<TriangleMesh>,
    cache: Mutex<Cache>,
}

/// Compared by address, as meshes are.
impl PartialEq for MeshSeries {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}

/// Why a file of a series cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StepError {
    pub path: PathBuf,
    pub why: String,
}

impl fmt::Display for StepError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "cannot read the mesh {}: {}", escape::path(&self.path), self.why)
    }
}

impl std::error::Error for StepError {}

impl MeshSeries {
    /// Checks all files, and loads the first.
    ///
    /// # Errors
    /// Every file that cannot be used.
    pub fn open(files: SeriesFiles, root: Root, meter: &LoadProgress) -> Result<Self, Vec<StepError>> {
        let read = Reader { files: &files, root: &root };
        let (data, center) = read.placed(0, None).map_err(|error| vec![error])?;
        let first_step = read.summary(0, &data);
        let materials = data.materials.clone();
        let first = first_step.is_ok().then(|| read.mesh(0, data, None));
        let mut checked = vec![first_step.map(|step| (step, true))];
        let count = files.steps.len();
        let rest: Vec<usize> = (1..count).collect();
        for some in rest.chunks(CHECKED_AT_ONCE) {
            let check = |&step: &usize| {
                let (data, _) = read.placed(step, center)?;
                Ok((read.summary(step, &data)?, data.materials == materials))
            };
            meter.start(format!("checking mesh {} of {count}", some[0] + 1), 0);
            checked.extend(some.par_iter().map(check).collect::<Vec<_>>());
        }
        let errors: Vec<_> = checked.iter().filter_map(|step| step.as_ref().err().cloned()).collect();
        let (Some(Ok(first)), true) = (first, errors.is_empty()) else { return Err(errors) };
        let other_materials = checked.iter().position(|step| step.as_ref().is_ok_and(|(_, same)| !same));
        let steps = checked.into_iter().filter_map(Result::ok).map(|(step, _)| step).collect();
        let (first, cache) = (Arc::new(first), Mutex::default());
        let checked = Arc::new(CheckedFiles { files, root, steps, center });
        Ok(Self { checked, other_materials, first, cache })
    }

    /// The mesh of the first file.
    pub fn first(&self) -> &Arc<TriangleMesh> {
        &self.first
    }

    /// The first file of each step, in the order of time.
    pub fn paths(&self) -> impl Iterator<Item = &PathBuf> {
        self.checked.files.steps.iter().filter_map(|files| files.first())
    }

    /// What is known of each file's mesh.
    pub fn steps(&self) -> &[MeshSummary] {
        &self.checked.steps
    }

    /// The first file with other materials than the first file of all.
    pub fn other_materials(&self) -> Option<&PathBuf> {
        self.other_materials.and_then(|step| self.paths().nth(step))
    }

    /// Whether the files, times and settings are these.
    pub fn is_of(&self, files: &SeriesFiles) -> bool {
        self.checked.files == *files
    }

    /// Whether different times may have different meshes.
    pub fn is_keyed(&self) -> bool {
        self.checked.files.track.is_keyed()
    }

    /// A box around all meshes.
    pub fn bounds(&self) -> Aabb {
        self.checked.steps.iter().fold(Aabb::EMPTY, |all, step| all.union(step.bounds))
    }

    /// The steps at a time. Steps with other triangles are held instead of blended.
    pub fn at(&self, time: Time) -> StepMix {
        let mix = self.checked.files.track.at(time);
        let blends = mix.share.num != 0.0
            && self.checked.steps[mix.from].topology == self.checked.steps[mix.to].topology;
        if blends { mix } else { StepMix::only(mix.from) }
    }

    /// The shape at a time without its mesh: the first file's mesh takes its place.
    pub fn named(&self, time: Time) -> Mesh {
        let mix = self.at(time);
        let has_normals = self.checked.steps[mix.from].has_normals && self.checked.steps[mix.to].has_normals;
        Mesh { normals: self.normals(has_normals), step: Some(self.step(mix)), mesh: Arc::clone(&self.first) }
    }

    /// The shape at a time.
    ///
    /// # Errors
    /// If the file cannot be read or has changed since it was checked.
    pub fn loaded(&self, time: Time) -> Result<Mesh, StepError> {
        let (mix, named) = (self.at(time), self.named(time));
        if mix == StepMix::only(0) {
            return Ok(named);
        }
        let mesh = self.cache().mesh(named.step.map(|step| step.digest), |cache| self.load(mix, cache))?;
        Ok(Mesh { mesh, ..named })
    }

    fn load(&self, mix: StepMix, cache: &mut Cache) -> Result<TriangleMesh, StepError> {
        let read = self.checked.reader();
        if mix.from == mix.to {
            let data = self.data(mix.from, cache.ahead())?;
            return read.mesh(mix.from, data, Some(cache.last().unwrap_or(&self.first)));
        }
        let from = cache.data(mix.from, [mix.from, mix.to], |ahead| self.data(mix.from, ahead))?;
        let to = cache.data(mix.to, [mix.from, mix.to], |ahead| self.data(mix.to, ahead))?;
        let data = crate::geometry::mesh::blended(&from, &to, mix.share);
        read.mesh(mix.from, data, Some(cache.last().unwrap_or(&self.first)))
    }

    /// A step's data.
    fn data(&self, step: usize, ahead: &mut Ahead) -> Result<MeshData, StepError> {
        let checked = Arc::clone(&self.checked);
        let found = ahead.take(step, self.checked.steps.len(), move |step| checked.unchanged(step).ok());
        found.map_or_else(|| self.checked.unchanged(step), Ok)
    }

    fn cache(&self) -> std::sync::MutexGuard<'_, Cache> {
        self.cache.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The normals of a mesh that has some of its own, or none.
    fn normals(&self, has_normals: bool) -> Normals {
        let own = if has_normals || self.checked.files.preparation.crease.is_some() {
            Normals::File
        } else {
            Normals::Flat
        };
        self.checked.files.normals.unwrap_or(own)
    }

    fn step(&self, mix: StepMix) -> MeshStep {
        let (a, b) = (&self.checked.steps[mix.from], &self.checked.steps[mix.to]);
        let crease = self.checked.files.preparation.crease.map(|angle| angle.0);
        if mix.from == mix.to {
            return MeshStep { digest: Digest::of(&(crease, a.content)), bounds: a.bounds };
        }
        let share = [mix.share.num, mix.share.den];
        let digest = Digest::of(&(crease, (a.content, b.content), share));
        // A mix of boxes contains the mixes of their points, but for the rounding of both.
        let corner = |a: DVec3, b: DVec3| DVec3::mix(&a, &b, mix.share);
        let (min, max) = (corner(a.bounds.min, b.bounds.min), corner(a.bounds.max, b.bounds.max));
        let reach = |bounds: &Aabb| bounds.min.abs().max(bounds.max.abs());
        let rounding = (reach(&a.bounds) + reach(&b.bounds)) * gamma(8);
        MeshStep { digest, bounds: Aabb { min, max }.padded(rounding) }
    }
}

impl CheckedFiles {
    fn reader(&self) -> Reader<'_> {
        Reader { files: &self.files, root: &self.root }
    }

    /// A step's data, which must be what was checked.
    fn unchanged(&self, step: usize) -> Result<MeshData, StepError> {
        let read = self.reader();
        let (data, _) = read.placed(step, self.center)?;
        if data.content() != self.steps[step].content {
            return Err(read.error(step, "it has changed since it was checked"));
        }
        Ok(data)
    }
}

/// Reads the files of a series.
struct Reader<'a> {
    files: &'a SeriesFiles,
    root: &'a Root,
}

impl Reader<'_> {
    fn error(&self, step: usize, why: impl ToString) -> StepError {
        let path = self.files.steps[step].first().cloned().unwrap_or_default();
        StepError { path, why: why.to_string() }
    }

    /// A file's data with changed coordinates, and the point that moved to the origin.
    fn placed(&self, step: usize, center: Option<DVec3>) -> Result<(MeshData, Option<DVec3>), StepError> {
        let data = load_parts(&self.files.steps[step], self.root, &LoadProgress::default());
        let mut data = data.map_err(|error| self.error(step, error))?;
        let center = self.files.preparation.place(&mut data, center);
        Ok((data, center))
    }

    fn summary(&self, step: usize, data: &MeshData) -> Result<MeshSummary, StepError> {
        let summary = MeshSummary::of(data).map_err(|error| self.error(step, error))?;
        let wanted = self.files.normals == Some(Normals::File) && self.files.preparation.crease.is_none();
        match wanted && !summary.has_normals {
            true => Err(self.error(step, "it has no normals of its own")),
            false => Ok(summary),
        }
    }

    /// The mesh of checked data, [after](TriangleMesh::after) another mesh of the series.
    fn mesh(
        &self,
        step: usize,
        mut data: MeshData,
        before: Option<&TriangleMesh>,
    ) -> Result<TriangleMesh, StepError> {
        self.files.preparation.crease(&mut data);
        let built = |data| -> Result<TriangleMesh, MeshError> {
            let mesh = build(data, before)?;
            if self.files.normals == Some(Normals::Smooth) {
                mesh.smooth_normals();
            }
            Ok(mesh)
        };
        built(data).map_err(|error| self.error(step, error))
    }
}

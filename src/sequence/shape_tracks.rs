//! Shapes that change over time.

use crate::base::digest::Digest;
use crate::base::math::Aabb;
use crate::base::time::Time;
use crate::geometry::deformation::DeformedMesh;
use crate::geometry::shape::ParticleTracks;
use crate::geometry::shape::{Geometric, Mesh};
use crate::import::series::MeshSeries;
use std::sync::Arc;

/// What a shape is over time.
#[derive(Clone, Debug, PartialEq)]
pub enum ShapeTracks {
    Series(Arc<MeshSeries>),
    Particles(Arc<ParticleTracks>),
    Deformed(Arc<DeformedMesh>),
}

impl ShapeTracks {
    /// Whether different times may have different shapes.
    pub fn is_keyed(&self) -> bool {
        match self {
            Self::Series(series) => series.is_keyed(),
            Self::Particles(particles) => particles.is_keyed(),
            Self::Deformed(mesh) => mesh.is_keyed(),
        }
    }

    /// A digest that differs if the shape may be different.
    pub fn digest(&self, time: Time) -> Digest {
        match self {
            Self::Series(series) => Digest::of(&series.named(time)),
            Self::Particles(particles) => particles.moment(time),
            Self::Deformed(mesh) => Digest::of(&mesh.named(time)),
        }
    }

    /// A box around the shape at a time, without loading files; none if there is nothing.
    pub fn bounds_at(&self, time: Time) -> Option<Aabb> {
        match self {
            Self::Series(series) => series.named(time).bounds(),
            Self::Particles(particles) => particles.bounds_at(time),
            Self::Deformed(mesh) => mesh.named(time).as_ref().and_then(Mesh::bounds),
        }
    }

    /// A box around the shape over all times. Of deformed meshes at their keys and midway between them.
    pub fn bounds(&self) -> Aabb {
        match self {
            Self::Series(series) => series.bounds(),
            Self::Particles(particles) => particles.bounds(),
            Self::Deformed(mesh) => mesh.key_bounds(),
        }
    }
}

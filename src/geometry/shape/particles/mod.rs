//! Many spheres as one shape, searched by a tree of their own.

mod geometric;
mod packet;
mod search;
mod set;
#[cfg(test)]
mod tests;
mod tracks;

pub use set::ParticleSet;
pub use tracks::{ParticleRows, ParticleTracks, SameTime};

use super::Sphere;
use crate::base::digest::{Content, Digester};
use crate::base::time::Time;
use std::sync::Arc;

/// Particles at one moment. The part of a hit is the index of its sphere.
#[derive(Clone, Debug)]
pub struct Particles(pub Arc<ParticleSet>);

impl Particles {
    /// Spheres that do not move, with their tree.
    pub fn still(spheres: Vec<Sphere>) -> Self {
        let tracks = Arc::new(ParticleTracks::still(spheres));
        Self(Arc::new(tracks.at(Time::from_integer(0)).with_tree(None)))
    }
}

/// Equal spheres with equal numbers in all columns.
impl PartialEq for Particles {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0) || self.0.is_same(&other.0)
    }
}

impl Content for Particles {
    fn feed(&self, into: &mut Digester) {
        self.0.digest().feed(into);
    }
}

//! The memory that shapes take besides their own size.

use super::Shape;
use std::sync::Arc;

/// Bytes per triangle of a mesh, and per particle, with their trees: estimates.
const TRIANGLE: u64 = 128;
const PARTICLE: u64 = 256;

#[warn(missing_docs)]
impl Shape {
    /// Bytes of data that this shape holds and `other` does not: copies of a shape share the data of their mesh or their
    /// particles.
    pub fn bytes_besides(&self, other: &Self) -> u64 {
        match (self, other) {
            (Self::Mesh(own), Self::Mesh(other)) if Arc::ptr_eq(&own.mesh, &other.mesh) => 0,
            (Self::Particles(own), Self::Particles(other)) if Arc::ptr_eq(&own.0, &other.0) => 0,
            (Self::Mesh(own), _) => own.mesh.triangles().len() as u64 * TRIANGLE,
            (Self::Particles(own), _) => own.0.spheres().len() as u64 * PARTICLE,
            (Self::Solid(own), Self::Solid(other)) => {
                let other = other.parts().iter().chain(std::iter::repeat(&Self::Group));
                own.parts().iter().zip(other).map(|(own, other)| own.bytes_besides(other)).sum()
            }
            (Self::Solid(own), _) => own.parts().iter().map(|part| part.bytes_besides(&Self::Group)).sum(),
            _ => 0,
        }
    }
}

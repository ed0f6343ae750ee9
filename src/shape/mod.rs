//! Shapes in their own space: one closed list, one file each.

mod cuboid;
mod disk;
mod plane;
mod rectangle;
mod sphere;
mod triangle;

pub use cuboid::Cuboid;
pub use disk::Disk;
pub use plane::Plane;
pub use rectangle::Rectangle;
pub use sphere::Sphere;
pub use triangle::Triangle;

/// Every shape there is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    Sphere(Sphere),
    Plane(Plane),
    Rectangle(Rectangle),
    Disk(Disk),
    Triangle(Triangle),
    Cuboid(Cuboid),
    /// Nothing to see: a frame of reference for the objects that name it as their parent.
    Group,
}

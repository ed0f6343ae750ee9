//! Where a shape's parameters come from.

use super::Mesh;
use crate::base::math::DVec3;

/// The parameters that a file gives a shape. Every answer is none if the parameter is wrong, or missing
/// without a default; that has been reported then, with its place.
pub trait Parameters {
    /// Any vector.
    fn vector(&mut self, name: &'static str, default: Option<DVec3>) -> Option<DVec3>;

    /// A direction, brought to length 1.
    fn unit_vector(&mut self, name: &'static str, default: Option<DVec3>) -> Option<DVec3>;

    /// A length above 0.
    fn positive(&mut self, name: &'static str, default: Option<f64>) -> Option<f64>;

    /// A triangle mesh: all of its fields.
    fn mesh(&mut self) -> Option<Mesh>;

    /// A length of 0 or more.
    fn not_negative(&mut self, name: &'static str, default: Option<f64>) -> Option<f64>;

    /// Yes or no.
    fn switch(&mut self, name: &'static str, default: Option<bool>) -> Option<bool>;

    /// Reports that the parameters make no shape: `title` says why, `label` what is wrong with `name`.
    fn refuse(&mut self, name: &'static str, title: String, label: String);
}

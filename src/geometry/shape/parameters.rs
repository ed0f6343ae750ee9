//! The source of a shape's parameters.

use super::{Mesh, Operation, Particles, Solid};
use crate::base::math::DVec3;

/// The parameters that a file gives a shape. A method returns none if the parameter is wrong, or missing without a
/// default. The error has then been reported with its location.
pub trait Parameters {
    /// Any vector.
    fn vector(&mut self, name: &'static str, default: Option<DVec3>) -> Option<DVec3>;

    /// A direction, scaled to length 1.
    fn unit_vector(&mut self, name: &'static str, default: Option<DVec3>) -> Option<DVec3>;

    /// A length above 0.
    fn positive(&mut self, name: &'static str, default: Option<f64>) -> Option<f64>;

    /// A triangle mesh, from all fields.
    fn mesh(&mut self) -> Option<Mesh>;

    /// Particles, from all fields.
    fn particles(&mut self) -> Option<Particles>;

    /// A solid made of others, from all fields.
    fn solid(&mut self, operation: Operation) -> Option<Solid>;

    /// A length of 0 or more.
    fn not_negative(&mut self, name: &'static str, default: Option<f64>) -> Option<f64>;

    /// `true` or `false`.
    fn switch(&mut self, name: &'static str, default: Option<bool>) -> Option<bool>;

    /// Reports that the parameters are invalid: `title` gives the reason, `label` the problem with `name`.
    fn refuse(&mut self, name: &'static str, title: String, label: String);
}

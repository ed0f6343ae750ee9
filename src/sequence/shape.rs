//! `shape`: one decoder per shape, and the list of them. Degenerate shapes are refused.

use super::fault::Fault;
use super::fields::Fields;
use super::node::Node;
use super::values::{positive, unit_vector, vector};
use super::words::{Variants, variant};
use crate::math::DVec3;
use crate::shape::{Cuboid, Disk, Plane, Rectangle, Shape, Sphere, Triangle};

/// Every shape of the file format.
pub fn shape(node: Node<'_>) -> Option<Shape> {
    let table: &Variants<'_, Shape> = &[
        ("Sphere", sphere),
        ("Plane", plane),
        ("Rectangle", rectangle),
        ("Disk", disk),
        ("Triangle", triangle),
        ("Box", cuboid),
        ("Group", group),
    ];
    variant(node, "shape", table)
}

fn sphere(node: Node<'_>) -> Option<Shape> {
    let mut fields = Fields::of(node, "`Sphere`")?;
    let center = fields.or("center", vector, DVec3::ZERO);
    let radius = fields.or("radius", positive, 1.0);
    fields.finish();
    Some(Shape::Sphere(Sphere { center: center?, radius: radius? }))
}

fn plane(node: Node<'_>) -> Option<Shape> {
    let mut fields = Fields::of(node, "`Plane`")?;
    let point = fields.or("point", vector, DVec3::ZERO);
    let normal = fields.or("normal", unit_vector, DVec3::Y);
    fields.finish();
    Some(Shape::Plane(Plane { point: point?, normal: normal? }))
}

fn rectangle(node: Node<'_>) -> Option<Shape> {
    let mut fields = Fields::of(node, "`Rectangle`")?;
    let corner = fields.required("corner", vector);
    let (u, v) = (fields.required("u", vector), fields.required("v", vector));
    let place = fields.place("v");
    fields.finish();
    let (u, v) = (u?, v?);
    if !spans_a_plane(u, v) {
        let label = "`u` and `v` are parallel, or one of them has no length";
        node.fault(Fault::new(place, "this rectangle has no area", label));
        return None;
    }
    Some(Shape::Rectangle(Rectangle { corner: corner?, u, v }))
}

fn disk(node: Node<'_>) -> Option<Shape> {
    let mut fields = Fields::of(node, "`Disk`")?;
    let center = fields.or("center", vector, DVec3::ZERO);
    let normal = fields.or("normal", unit_vector, DVec3::Y);
    let radius = fields.or("radius", positive, 1.0);
    fields.finish();
    Some(Shape::Disk(Disk { center: center?, normal: normal?, radius: radius? }))
}

fn triangle(node: Node<'_>) -> Option<Shape> {
    let mut fields = Fields::of(node, "`Triangle`")?;
    let corners = ["a", "b", "c"].map(|name| fields.required(name, vector));
    fields.finish();
    let [a, b, c] = corners;
    let (a, b, c) = (a?, b?, c?);
    if !spans_a_plane(b - a, c - a) {
        let label = "its corners are in one line, or two of them coincide";
        node.fault(Fault::new(node.span(), "this triangle has no area", label));
        return None;
    }
    Some(Shape::Triangle(Triangle { corners: [a, b, c] }))
}

fn cuboid(node: Node<'_>) -> Option<Shape> {
    let mut fields = Fields::of(node, "`Box`")?;
    let mut place = node.span();
    let min = fields.required("min", vector);
    let max = fields.required("max", |node| {
        place = node.span();
        vector(node)
    });
    fields.finish();
    let (min, max) = (min?, max?);
    let flat: Vec<_> = ["x", "y", "z"]
        .into_iter()
        .zip((max - min).to_array())
        .filter_map(|(axis, side)| (side <= 0.0).then_some(axis))
        .collect();
    if !flat.is_empty() {
        let label = format!("not above `min` in {}", flat.join(" and "));
        node.fault(Fault::new(place, "`max` must be above `min` along every axis", label));
        return None;
    }
    Some(Shape::Cuboid(Cuboid { min, max }))
}

fn group(node: Node<'_>) -> Option<Shape> {
    Fields::of(node, "`Group`")?.finish();
    Some(Shape::Group)
}

/// Whether two edges enclose an area: not if one vanishes or they are parallel to within rounding.
fn spans_a_plane(u: DVec3, v: DVec3) -> bool {
    let (Some(u), Some(v)) = (u.try_normalize(), v.try_normalize()) else { return false };
    u.cross(v).length() > 4.0 * f64::EPSILON
}

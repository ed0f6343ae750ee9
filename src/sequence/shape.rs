//! Decodes `shape`: a word, and the fields that the shape reads itself.

use super::boolean::{OPERATIONS, solid};
use super::fault::Fault;
use super::fields::Fields;
use super::instances::{Instances, Shown, instances};
use super::mesh::mesh;
use super::node::Node;
use super::particles::{ShownParticles, particles};
use super::pose_tracks::Placement;
use super::scene::{SCENE, is_scene};
use super::shape_tracks::ShapeTracks;
use super::text_shape::{TEXT, text_solid};
use super::values::{not_negative, positive, switch, unit_vector, vector};
use super::words::known_word;
use crate::base::math::DVec3;
use crate::base::time::Time;
use crate::geometry::shape::{Geometric, Mesh, Operation, Parameters, Particles, Shape, Solid};
use std::collections::HashMap;
use std::ops::Range;
use std::sync::{Arc, LazyLock};

/// A shape at the start, and what it is over time if it changes.
#[derive(Clone)]
pub struct ShapeOverTime {
    pub shape: Shape,
    pub tracks: Option<ShapeTracks>,
}

/// What an object shows.
pub enum ShownShape<'n> {
    /// The object itself has the shape.
    Single(ShapeOverTime),
    Instances(Instances<'n>),
}

/// What objects may show besides shapes.
pub const INSTANCES: &str = "Instances";

/// The names of shapes, and of what objects may show besides.
static NAMES: LazyLock<Vec<&'static str>> = LazyLock::new(|| {
    let operations = OPERATIONS.iter().map(|(name, _)| *name).filter(|name| !Shape::NAMES.contains(name));
    Shape::NAMES.iter().copied().chain(operations).chain([TEXT, INSTANCES, SCENE]).collect()
});

/// A single shape: any but instances.
pub fn shape(node: Node<'_>) -> Option<ShapeOverTime> {
    if node.word() == INSTANCES {
        let title = "instances are places of one shape, not of other instances";
        node.fault(Fault::new(node.head(), title, "needs a shape of its own"));
        return None;
    }
    match shown_shape(node)? {
        ShownShape::Single(shape) => Some(shape),
        ShownShape::Instances(_) => {
            let title = "particles of this shape are objects of their own, which have no place here";
            node.fault(Fault::new(node.head(), title, "needs a single shape"));
            None
        }
    }
}

/// Any shape, or instances of one.
pub fn shown_shape(node: Node<'_>) -> Option<ShownShape<'_>> {
    let name = known_word(node, "shape", &NAMES)?;
    if name == INSTANCES {
        return instances(node).map(ShownShape::Instances);
    }
    if name == TEXT {
        let shape = |mesh| ShapeOverTime { shape: Shape::Mesh(mesh), tracks: None };
        return text_solid(node).map(|mesh| ShownShape::Single(shape(mesh)));
    }
    if is_scene(&node) {
        let title = "a scene is a shape of its own object";
        node.fault(Fault::new(node.head(), title, "needs a single shape"));
        return None;
    }
    let what = format!("`{name}`");
    let operation = OPERATIONS.iter().find(|(known, _)| *known == name).map(|(_, operation)| *operation);
    let fields = if [Mesh::NAME, Particles::NAME].contains(&name) {
        Fields::of_or_only(node, what, "file")
    } else if operation.is_some() {
        Fields::of_or_only(node, what, "of")
    } else {
        Fields::of(node, what)
    };
    let mut read = ShapeFields { fields: fields?, places: HashMap::new(), tracks: None, instances: None };
    let shape = match operation {
        Some(operation) => read.solid(operation).map(Shape::Solid),
        None => Shape::read(name, &mut read),
    };
    read.fields.finish();
    match read.instances {
        Some((shape, placements)) => {
            Some(ShownShape::Instances(Instances { shown: Shown::Shape(shape), placements }))
        }
        None => Some(ShownShape::Single(ShapeOverTime { shape: shape?, tracks: read.tracks })),
    }
}

/// A shape's fields, and the places of the values read so far.
struct ShapeFields<'s> {
    fields: Fields<'s>,
    places: HashMap<&'static str, Range<usize>>,
    /// Set by shapes that change over time.
    tracks: Option<ShapeTracks>,
    /// Set by particles of another shape than spheres.
    instances: Option<(ShapeOverTime, Vec<Placement>)>,
}

impl<'s> ShapeFields<'s> {
    /// A default of axes with y up in the axes of the file: planes lie flat, and cylinders stand.
    fn upright(&self, default: Option<DVec3>) -> Option<DVec3> {
        default.map(|v| self.fields.node().file.up.get().from_y_up(v))
    }

    fn value<T>(
        &mut self,
        name: &'static str,
        default: Option<T>,
        decode: impl FnOnce(Node<'s>) -> Option<T>,
    ) -> Option<T> {
        let places = &mut self.places;
        let decode = |node: Node<'s>| {
            places.insert(name, node.span());
            decode(node)
        };
        match default {
            Some(default) => self.fields.or(name, decode, default),
            None => self.fields.required(name, decode),
        }
    }
}

impl Parameters for ShapeFields<'_> {
    fn vector(&mut self, name: &'static str, default: Option<DVec3>) -> Option<DVec3> {
        self.value(name, self.upright(default), vector)
    }

    fn unit_vector(&mut self, name: &'static str, default: Option<DVec3>) -> Option<DVec3> {
        self.value(name, self.upright(default), unit_vector)
    }

    fn positive(&mut self, name: &'static str, default: Option<f64>) -> Option<f64> {
        self.value(name, default, positive)
    }

    fn mesh(&mut self) -> Option<Mesh> {
        let (mesh, tracks) = mesh(&mut self.fields)?;
        self.tracks = tracks;
        Some(mesh)
    }

    fn particles(&mut self) -> Option<Particles> {
        let tracks = match particles(&mut self.fields)? {
            ShownParticles::Spheres(tracks) => tracks,
            ShownParticles::Shapes(shape, placements) => {
                self.instances = Some((shape, placements));
                return None;
            }
        };
        let set = tracks.at(Time::from_integer(0));
        self.tracks = Some(ShapeTracks::Particles(tracks));
        Some(Particles(Arc::new(set)))
    }

    fn solid(&mut self, operation: Operation) -> Option<Solid> {
        solid(&mut self.fields, operation)
    }

    fn not_negative(&mut self, name: &'static str, default: Option<f64>) -> Option<f64> {
        self.value(name, default, not_negative)
    }

    fn switch(&mut self, name: &'static str, default: Option<bool>) -> Option<bool> {
        self.value(name, default, switch)
    }

    fn refuse(&mut self, name: &'static str, title: String, label: String) {
        let node = self.fields.node();
        let place = self.places.get(name).cloned().unwrap_or_else(|| node.span());
        node.fault(Fault::new(place, title, label));
    }
}

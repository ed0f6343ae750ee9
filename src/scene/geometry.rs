//! The visible geometry, and the transform of each shape to its own space.

use super::hit::Hit;
use super::primitive::{Finish, Primitive, abs, inverse};
use crate::appearance::texture::{Footprint, TextureEvalContext};
use crate::base::digest::{Content, Digest};
use crate::base::math::{DAffine3, DVec2, DVec3};
use crate::geometry::mesh::ArrayKey;
use crate::geometry::shape::{Shape, Surface};
use std::collections::HashMap;

/// All visible primitives, in the order of the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Geometry {
    pub primitives: Vec<Primitive>,
    /// For each primitive, the shape in its own space. Only textures read it.
    origins: Vec<Origin>,
}

/// A shape in its own space.
#[derive(Clone, Debug, PartialEq, Content)]
struct Origin {
    shape: Shape,
    to_object: DAffine3,
}

impl Geometry {
    /// Adds a shape transformed by `to_world`, unless that flattens it.
    pub fn push(&mut self, shape: &Shape, to_world: DAffine3, finish: Finish) {
        let (Some(primitive), Some(to_object)) =
            (Primitive::new(shape, to_world, finish), inverse(&to_world))
        else {
            return;
        };
        self.primitives.push(primitive);
        self.origins.push(Origin { shape: shape.clone(), to_object });
    }

    /// The visible materials, ascending.
    pub fn materials(&self) -> Vec<u32> {
        let mut used: Vec<u32> = self.primitives.iter().flat_map(Primitive::materials).collect();
        used.sort_unstable();
        used.dedup();
        used
    }

    /// The digest of the shapes in their own spaces, for primitives with a material that is `painted`.
    pub fn origins(&self, painted: impl Fn(u32) -> bool) -> Digest {
        let shows = |primitive: &Primitive| primitive.materials().any(&painted);
        let origins = self.primitives.iter().zip(&self.origins);
        let origins = origins.map(|(primitive, origin)| shows(primitive).then_some(origin));
        Digest::of(&origins.collect::<Vec<_>>())
    }

    /// The digest of the meshes' data of these keys, by the materials that read it.
    pub fn arrays(&self, keys: &HashMap<u32, Vec<&ArrayKey>>) -> Digest {
        let mut digests = Vec::new();
        for (primitive, Origin { shape, .. }) in self.primitives.iter().zip(&self.origins) {
            let Shape::Mesh(mesh) = shape else { continue };
            let read = primitive.materials().filter_map(|material| keys.get(&material)).flatten();
            digests.extend(read.map(|key| mesh.mesh.array_digest(key)));
        }
        Digest::of(&digests)
    }

    /// The evaluation context of textures at a hit. `printed` states whether textures need the footprint in u and v.
    pub fn spot(
        &self,
        hit: &Hit,
        surface: &Surface,
        seen: &Footprint,
        printed: bool,
    ) -> TextureEvalContext<'_> {
        let Origin { shape, to_object } = &self.origins[hit.primitive as usize];
        let point = to_object.transform_point3(surface.point);
        let error = abs(to_object).transform_vector3(surface.error);
        let uv = |point: DVec3| DVec2::from(shape.uv::<f64>(point.into(), hit.at.part));
        let seen = seen.moved(&to_object.matrix3);
        let seen_uv = if printed { seen.to_uv(point, uv) } else { Footprint::default() };
        let (color, ends) = (shape.color(point, hit.at.part), shape.uv_ends(hit.at.part));
        TextureEvalContext {
            uv: uv(point),
            ends,
            point,
            error,
            color,
            footprint: seen,
            footprint_uv: seen_uv,
            shape: Some(shape),
            part: hit.at.part,
        }
    }
}

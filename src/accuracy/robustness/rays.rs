//! The scene's own rays, and the candidates for their hits.

use crate::appearance::light::Source;
use crate::base::math::{Aabb, DVec2, DVec3, Ray};
use crate::camera::Camera;
use crate::geometry::bvh::TraversalRay;
use crate::geometry::shape::{PreparedRay, RayInterval, Shape, Surface};
use crate::sampling::{hash, uniform_sphere};
use crate::scene::top_level::Bvh;
use crate::scene::{Primitive, Scene};
use std::collections::HashMap;

/// A candidate for a hit: a primitive, and a triangle if it is a mesh.
pub type Target = (u32, u32);

/// A hit, and the surface there.
pub struct SurfaceHit {
    pub target: Target,
    /// The part of the shape.
    pub part: u32,
    pub t: f64,
    pub surface: Surface,
}

/// A scene with the data for finding candidates.
pub struct SceneRays<'a> {
    pub scene: &'a Scene<'a>,
    pub bvh: Bvh,
    /// For the mesh of a primitive, the triangles around each vertex.
    around: HashMap<u32, Vec<Vec<u32>>>,
}

/// The largest number of hits with a mesh that a ray collects candidates for.
const MAX_CROSSINGS: usize = 8;

impl<'a> SceneRays<'a> {
    pub fn new(scene: &'a Scene<'a>) -> Self {
        let primitives = &scene.geometry.primitives;
        let around = (0..).zip(primitives).filter_map(|(index, primitive)| match &primitive.shape {
            Shape::Mesh(shape) => {
                let mut around = vec![Vec::new(); shape.mesh.positions().len()];
                for (part, corners) in (0..).zip(shape.mesh.triangles()) {
                    corners.iter().for_each(|vertex| around[*vertex as usize].push(part));
                }
                Some((index, around))
            }
            _ => None,
        });
        Self { scene, bvh: Bvh::build(scene.geometry), around: around.collect() }
    }

    pub fn primitive(&self, index: u32) -> &Primitive {
        &self.scene.geometry.primitives[index as usize]
    }

    /// The ray through the centre of a pixel.
    pub fn camera_ray(&self, pixel: (u32, u32), size: (u32, u32)) -> Ray {
        self.ray_within(pixel, size, DVec2::splat(0.5))
    }

    /// The ray through a point of a pixel, with coordinates from 0 to 1, without depth of field.
    pub fn ray_within(&self, (x, y): (u32, u32), (width, height): (u32, u32), place: DVec2) -> Ray {
        let camera = Camera { lens: None, ..*self.scene.camera };
        let at = |pixel: u32, place: f64, of: u32| 2.0 * (f64::from(pixel) + place) / f64::from(of) - 1.0;
        let aspect = f64::from(width) / f64::from(height);
        camera.ray(DVec2::new(at(x, place.x, width) * aspect, -at(y, place.y, height)), DVec2::ZERO)
    }

    /// Whether a primitive that is not a light blocks a shadow ray, which ends at t = 1.
    pub fn blocked(&self, probe: &TraversalRay) -> bool {
        // The ray hits the light's own surface too, and rounding may put that hit before or behind t = 1.
        let mut within = RayInterval::up_to(1.0);
        while let Some(hit) = self.bvh.intersect_within(self.scene.geometry, probe, within) {
            if !self.primitive(hit.primitive).is_light() {
                return true;
            }
            within.min = hit.at.t;
        }
        false
    }

    /// Kinora's closest hit along a ray.
    pub fn closest_hit(&self, ray: &Ray) -> Option<SurfaceHit> {
        let hit = self.bvh.intersect_one(self.scene.geometry, &TraversalRay::new(*ray))?;
        let surface = self.primitive(hit.primitive).surface_at(ray, hit.at);
        Some(SurfaceHit {
            target: self.target(hit.primitive, hit.at.part),
            part: hit.at.part,
            t: hit.at.t,
            surface,
        })
    }

    fn target(&self, primitive: u32, part: u32) -> Target {
        (primitive, if self.around.contains_key(&primitive) { part } else { 0 })
    }

    /// All candidates that a ray may hit in any precision: the primitives that it passes closely and, of meshes, the
    /// triangles around each hit. Lights are included if `lights` is set.
    pub fn candidates(&self, ray: &Ray, lights: bool) -> Vec<Target> {
        let mut found = Vec::new();
        for (index, primitive) in (0..).zip(&self.scene.geometry.primitives) {
            if primitive.is_empty()
                || (!lights && primitive.is_light())
                || !primitive.bounds().is_none_or(|bounds| passes(&bounds, ray))
            {
                continue;
            }
            match self.around.get(&index) {
                None => found.push((index, 0)),
                Some(around) => self.triangle_candidates(index, around, ray, &mut found),
            }
        }
        found
    }

    fn triangle_candidates(&self, index: u32, around: &[Vec<u32>], ray: &Ray, found: &mut Vec<Target>) {
        let primitive = self.primitive(index);
        let Shape::Mesh(shape) = &primitive.shape else { return };
        let prepared = PreparedRay::<f64>::splat(&TraversalRay::new(*ray));
        let mut within = RayInterval::up_to(f64::INFINITY);
        for _ in 0..MAX_CROSSINGS {
            let Some(at) = primitive.intersect(&prepared, within).one() else { break };
            let corners = shape.mesh.triangles()[at.part as usize];
            let near = corners.iter().flat_map(|vertex| &around[*vertex as usize]);
            found.extend(near.map(|part| (index, *part)));
            within.min = at.t;
        }
    }

    /// The triangles around a target on a mesh; otherwise the target alone.
    pub fn neighbours(&self, (primitive, part): Target) -> Vec<Target> {
        let Some(around) = self.around.get(&primitive) else { return vec![(primitive, part)] };
        let Shape::Mesh(shape) = &self.primitive(primitive).shape else { return Vec::new() };
        let corners = shape.mesh.triangles()[part as usize];
        corners.iter().flat_map(|vertex| &around[*vertex as usize]).map(|part| (primitive, *part)).collect()
    }

    /// A point that may light a surface on its visible side: on a random light that casts shadows or, if there are none,
    /// in a random direction.
    pub fn light_for(&self, surface: &Surface, seen_from: DVec3, pixel: u32) -> Option<DVec3> {
        let lights = self.scene.lights().filter(|(_, light)| light.shadows);
        let lights: Vec<&Source> = lights.map(|(_, light)| &light.source).collect();
        let facing = surface.normal.dot(seen_from - surface.point) >= 0.0;
        let normal = if facing { surface.normal } else { -surface.normal };
        let place = match lights.get(((u64::from(hash([pixel, 1, 5])) * lights.len() as u64) >> 32) as usize)
        {
            Some(Source::Point { position, .. } | Source::Spot { position, .. }) => *position,
            Some(Source::Directional { to_light }) => surface.point + *to_light * self.far(),
            Some(Source::Sphere(sphere)) => sphere.center,
            Some(Source::Rectangle { rectangle, .. }) => rectangle.corner + (rectangle.u + rectangle.v) * 0.5,
            None => surface.point + around(normal, pixel) * self.far(),
        };
        // Grazing directions are skipped.
        let way = place - surface.point;
        (normal.dot(way) > 1e-3 * way.length()).then_some(place)
    }

    /// A distance beyond everything in the scene.
    pub fn far(&self) -> f64 {
        4.0 * self.bvh.reach().max(1.0)
    }

    /// A random direction of diffuse reflection.
    pub fn bounce(&self, surface: &Surface, seen_from: DVec3, pixel: u32) -> DVec3 {
        let facing = surface.normal.dot(seen_from - surface.point) >= 0.0;
        around(if facing { surface.normal } else { -surface.normal }, pixel)
    }
}

/// A direction around a normal, with a pdf proportional to the cosine.
fn around(normal: DVec3, pixel: u32) -> DVec3 {
    let unit = |which: u32| f64::from(hash([pixel, which, 6])) / 4_294_967_296.0;
    let ball: DVec3 = uniform_sphere(unit(0), unit(1)).into();
    (normal + ball * 0.999).normalize()
}

/// Whether a ray passes a box within a margin of about a hundredth of its size.
fn passes(bounds: &Aabb, ray: &Ray) -> bool {
    let margin = (bounds.max - bounds.min) * 0.01 + DVec3::splat(1e-3 * (bounds.max - bounds.min).length());
    let (min, max) = (bounds.min - margin, bounds.max + margin);
    let (a, b) = ((min - ray.origin) / ray.direction, (max - ray.origin) / ray.direction);
    let (mut enter, mut leave) = (0.0f64, f64::INFINITY);
    for (a, b) in a.to_array().into_iter().zip(b.to_array()) {
        // NaN if a ray runs along a face: `max` and `min` then keep the previous value.
        enter = enter.max(a.min(b));
        leave = leave.min(a.max(b));
    }
    enter <= leave
}

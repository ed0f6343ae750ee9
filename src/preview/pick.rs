//! What a pixel shows: the object, its material, and the light that reaches it.

use super::session::Session;
use crate::base::math::{DVec3, UpAxis};
use crate::base::stats::RayCounts;
use crate::base::time::Time;
use crate::geometry::bvh::TraversalRay;
use crate::geometry::shape::Shape;
use crate::scene::top_level::Bvh;
use crate::scene::{Finish, Scene};
use crate::sequence::Sequence;
use crate::trace::{TraceSettings, rays_of_pixel};
use serde_json::{Value, json};

/// What the ray through the centre of a pixel hits first.
struct Picked {
    primitive: u32,
    material: Option<u32>,
    light: Option<u32>,
    distance: f64,
    point: DVec3,
    normal: DVec3,
}

/// Rays of a pixel by kind, without those that it does not have.
fn ray_kinds(rays: &RayCounts) -> Value {
    let RayCounts { camera, mirror, transmitted, scattered, shadow } = *rays;
    let kinds = [
        ("camera", camera),
        ("mirror", mirror),
        ("transmitted", transmitted),
        ("scattered", scattered),
        ("shadow", shadow),
    ];
    kinds
        .into_iter()
        .filter(|(_, count)| *count > 0)
        .map(|(kind, count)| (kind.to_owned(), Value::from(count)))
        .collect()
}

impl Session {
    /// What is at a pixel, counted from the top left. None without a picture.
    pub fn pick(&mut self, x: u32, y: u32) -> Option<Value> {
        let (state, camera) = self.current()?;
        let size = self.scene()?.sequence.output.size;
        if x >= size.0 || y >= size.1 {
            return None;
        }
        let center = [x, y].map(|at| f64::from(at) + 0.5);
        let random = state.random;
        let see = |scene: &Scene, bvh: &Bvh, settings: &TraceSettings| {
            (hit(scene, bvh, center, size), rays_of_pixel(scene, bvh, settings, random, (x, y)))
        };
        let (picked, rays) = self.scene()?.tracer().see(&state, camera.as_ref(), see).ok()?;
        let shares = self.light_shares(x, y);
        let scene = self.scene()?;
        let sequence = &scene.sequence;
        let Some(picked) = picked else {
            return Some(
                json!({ "x": x, "y": y, "object": null, "rays": ray_kinds(&rays), "light": shares }),
            );
        };
        let object = object_of(sequence, picked.primitive);
        let name = |index: Option<u32>| {
            index.and_then(|index| sequence.materials.get(index as usize)).map(|material| &material.name)
        };
        let light = picked.light.and_then(|index| sequence.lights.get(index as usize));
        Some(json!({
            "x": x,
            "y": y,
            "object": object.map(|index| &sequence.objects[index].name),
            "lamp": light.map(|light| &light.name),
            "material": name(picked.material),
            "distance": picked.distance,
            "point": axes(picked.point, sequence.up),
            "normal": axes(picked.normal, sequence.up),
            "rays": ray_kinds(&rays),
            "light": shares,
        }))
    }

    /// The share of each layer in the brightness of a pixel, the brightest first.
    fn light_shares(&mut self, x: u32, y: u32) -> Vec<Value> {
        let Some((state, _)) = self.current() else { return Vec::new() };
        let weights = self.weights(&state);
        let Some(film) = self.film.as_ref().and_then(|(_, film)| Some((film.film(&weights)?, film.done()?)))
        else {
            return Vec::new();
        };
        let (film, stride) = (film.0, film.1.stride());
        let pixel = (y / stride * film.width + x / stride) as usize;
        let names = self.scene.as_ref().map(|scene| scene.sequence.about().layers).unwrap_or_default();
        let sum = |layer: usize| film.radiance_of(pixel, layer).element_sum();
        let all = film.radiance_at(pixel).element_sum();
        let mut shares: Vec<(f32, &String)> =
            names.iter().enumerate().map(|(layer, name)| (sum(layer), name)).collect();
        shares.sort_by(|a, b| b.0.total_cmp(&a.0));
        let share = |(sum, name): &(f32, &String)| json!({ "name": name, "share": sum / all.max(1e-30) });
        shares.iter().filter(|(sum, _)| *sum > 0.0).map(share).collect()
    }
}

fn hit(scene: &Scene, bvh: &Bvh, at: [f64; 2], size: (u32, u32)) -> Option<Picked> {
    let ray = scene.camera.pixel_ray(at, size);
    let hit = bvh.intersect_one(scene.geometry, &TraversalRay::new(ray))?;
    let primitive = &scene.geometry.primitives[hit.primitive as usize];
    let surface = primitive.surface_at(&ray, hit.at);
    let light = if let Finish::Light(index) = primitive.finish { Some(index) } else { None };
    Some(Picked {
        primitive: hit.primitive,
        material: primitive.material(hit.at.part),
        light,
        distance: hit.at.t,
        point: surface.point,
        normal: surface.normal,
    })
}

/// The index of the object with a slot: objects with a shape have slots in their order.
fn object_of(sequence: &Sequence, slot: u32) -> Option<usize> {
    let solid =
        (0..sequence.objects.len()).filter(|index| sequence.objects[*index].value.shape != Shape::Group);
    solid.into_iter().nth(slot as usize)
}

fn axes(v: DVec3, up: UpAxis) -> [f64; 3] {
    up.from_y_up(v).to_array()
}

/// A time as text of a sequence file, in seconds.
pub fn key_time(time: Time) -> String {
    super::camera::number(*time.numer() as f64 / *time.denom() as f64)
}

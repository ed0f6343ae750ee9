//! Whitted's integrator: at every hit ambient light, every light that is not in shadow, and on to what the
//! mirror shows (Whitted 1980).

use super::shade::{mirrored, reflected};
use super::spawn::{spawn, spawn_to};
use crate::bvh::Bvh;
use crate::camera::Ray;
use crate::color::Rgb;
use crate::counters::RayCounts;
use crate::environment::Environment;
use crate::film::LayerId;
use crate::light::{Glow, Light};
use crate::material::Material;
use crate::math::{DVec2, DVec3};
use crate::scene::Scene;
use crate::shape::{Probe, Surface};

/// The integrator over one frame's scene, with all that is constant for the frame resolved.
pub struct Whitted<'a> {
    scene: &'a Scene<'a>,
    bvh: &'a Bvh,
    bounces: u32,
    /// Lights that shine: a layer of weight zero is not traced.
    lights: Vec<Light>,
    background: Option<&'a Environment>,
    ambient: Option<Glow>,
}

/// What one sample pushes its light into.
struct Sums<'a> {
    layers: &'a mut [DVec3],
    counts: &'a mut RayCounts,
}

impl Sums<'_> {
    fn add(&mut self, layer: LayerId, radiance: Rgb) {
        self.layers[layer.index()] += radiance.as_dvec3();
    }
}

impl<'a> Whitted<'a> {
    pub fn new(scene: &'a Scene<'a>, bvh: &'a Bvh, bounces: u32) -> Self {
        let shading = scene.shading;
        let weighted = |layer: LayerId| scene.weights.0[layer.index()] != Rgb::ZERO;
        let glow = |glow: Glow| (glow.radiance != Rgb::ZERO && weighted(glow.layer)).then_some(glow);
        let shines = |light: &&Light| light.radiance != Rgb::ZERO && weighted(light.layer);
        Self {
            scene,
            bvh,
            bounces,
            lights: shading.lights.iter().filter(shines).copied().collect(),
            background: Some(&shading.background).filter(|sky| !sky.is_black() && weighted(sky.layer)),
            ambient: glow(shading.ambient),
        }
    }

    /// Adds what is seen through a point of the screen to `layers`.
    pub fn sample(&self, screen: DVec2, layers: &mut [DVec3], counts: &mut RayCounts) {
        let mut sums = Sums { layers, counts };
        sums.counts.camera += 1;
        let mut ray = self.scene.camera.ray(screen);
        let mut throughput = Rgb::ONE;
        let mut left = self.bounces;
        while let Some(reflection) = self.along(&ray, throughput, &mut sums) {
            if left == 0 {
                break;
            }
            left -= 1;
            sums.counts.mirror += 1;
            (ray, throughput) = reflection;
        }
    }

    /// Adds what a ray sees itself, and gives the ray that carries on from there with its throughput.
    fn along(&self, ray: &Ray, throughput: Rgb, sums: &mut Sums) -> Option<(Ray, Rgb)> {
        let Some(hit) = self.bvh.closest(self.scene.geometry, &Probe::new(*ray)) else {
            if let Some(background) = &self.background {
                sums.add(background.layer, throughput * background.radiance(ray.direction));
            }
            return None;
        };
        let primitive = &self.scene.geometry.primitives[hit.primitive as usize];
        let material = &self.scene.shading.materials[primitive.material as usize];
        let mut surface = primitive.surface(ray, hit.t);
        // Surfaces are two-sided: the normal faces the eye.
        if surface.normal.dot(ray.direction) > 0.0 {
            surface.normal = -surface.normal;
        }
        if let Some(ambient) = &self.ambient {
            sums.add(ambient.layer, throughput * material.ambient * ambient.radiance);
        }
        self.add_lights(&surface, material, -ray.direction, throughput, sums);
        let throughput = throughput * material.mirror;
        let onward = mirrored(ray.direction, surface.normal);
        (throughput != Rgb::ZERO).then(|| (spawn(&surface, onward), throughput))
    }

    fn add_lights(
        &self,
        surface: &Surface,
        material: &Material,
        to_eye: DVec3,
        throughput: Rgb,
        sums: &mut Sums,
    ) {
        for light in &self.lights {
            let to_light = (light.position - surface.point).normalize_or_zero();
            let share = reflected(material, surface.normal, to_light, to_eye);
            if share == Rgb::ZERO {
                continue;
            }
            sums.counts.shadow += 1;
            let shadow = Probe::new(spawn_to(surface, light.position));
            // Only what lies before the light, at t = 1, shadows.
            if !self.bvh.occluded(self.scene.geometry, &shadow, 1.0) {
                sums.add(light.layer, throughput * share * light.radiance);
            }
        }
    }
}

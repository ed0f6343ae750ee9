//! Random scenes with everything that light may meet.

use super::{RandomScene, color, layer, one_of};
use crate::appearance::environment::{EnvironmentDistribution, Sky};
use crate::appearance::fog::{Falloff, Fog};
use crate::appearance::light::{Light, Source};
use crate::appearance::light_groups::GroupRadiance;
use crate::appearance::material::{Coat, Lobes, Material, Medium};
use crate::appearance::optics::Fresnel;
use crate::appearance::texture::{Image, SharedAsset};
use crate::base::color::Rgb;
use crate::base::math::DAffine3;
use crate::film::AovSet;
use crate::geometry::shape::{Rectangle, Shape, Sphere};
use crate::scene::Finish;
use crate::sequence::quality::Integrator;
use crate::testing::Random;
use std::sync::Arc;

impl RandomScene {
    /// A scene for either integrator. Some scenes have rough surfaces, absorbing glass, area lights, fog, skies of
    /// images, and all records of films.
    pub fn of_everything(seed: u64) -> Self {
        let mut scene = Self::of_paths(seed);
        let random = &mut Random(seed + 2000);
        scene.shading.materials.iter_mut().for_each(|material| vary(material, random));
        scene.add_lights(random);
        if random.unit() < 0.5 {
            let falloff = Falloff { base: scene.middle.y, height: 3.0 };
            scene.shading.fog = Some(Fog {
                in_scattering: GroupRadiance { radiance: color(random), layer: layer(random) },
                density: 0.1 * random.unit(),
                falloff: one_of(random, &[None, Some(falloff)]),
            });
        }
        if random.unit() < 0.4 {
            let texels = (0..32).map(|_| color(random)).collect();
            let sky = Sky::Equirect(SharedAsset::new(Image::new(8, 4, texels).expect("an image")));
            scene.shading.sky_table = EnvironmentDistribution::new(&sky).map(Arc::new);
            scene.shading.environment.sky = sky;
        }
        if random.unit() < 0.4 {
            scene.quality.integrator = Integrator::Whitted;
            scene.quality.bounces = scene.quality.bounces.min(2);
        }
        scene.aovs =
            AovSet { coverage: random.unit() < 0.3, features: random.unit() < 0.3, ..AovSet::default() };
        scene
    }

    /// Area lights, which are visible too.
    fn add_lights(&mut self, random: &mut Random) {
        let at = self.middle + random.point(5.0);
        let sphere = Sphere { center: self.middle + random.point(5.0), radius: 0.1 + random.unit() };
        let rectangle = Rectangle { corner: at, u: random.point(1.0), v: random.point(1.0) };
        let one_sided = random.unit() < 0.5;
        let lights = [
            (Source::Sphere(sphere), Shape::Sphere(sphere)),
            (Source::Rectangle { rectangle, one_sided }, Shape::Rectangle(rectangle)),
        ];
        for (source, shape) in lights.into_iter().filter(|_| random.unit() < 0.6) {
            let number = self.shading.lights.len() as u32;
            let radiance = color(&mut Random(u64::from(number)));
            let layer = self.shading.ambient.layer;
            self.shading.lights.push(Light { source, radiance, shadows: true, layer });
            self.geometry.push(&shape, DAffine3::IDENTITY, Finish::Light(number));
        }
    }
}

/// Turns some materials into glass, and others into rough metal or plastic.
fn vary(material: &mut Material, random: &mut Random) {
    let absorption = if random.unit() < 0.5 { color(random) } else { Rgb::ZERO };
    let medium = Medium { ior: 1.0 + random.unit(), absorption, priority: one_of(random, &[0, 1]) };
    let rough = Lobes {
        microfacet: 1.0,
        base: color(random),
        metallic: random.unit() as f32,
        roughness: one_of(random, &[0.0, 0.1, 0.4, 1.0]),
        ..Lobes::default()
    };
    let glass = Lobes { refraction: color(random), mirror: color(random), ..Lobes::default() };
    match random.unit() {
        share if share < 0.3 => (material.lobes, material.medium) = (rough, medium),
        share if share < 0.6 => (material.lobes, material.medium) = (glass, medium),
        _ => return,
    }
    if random.unit() < 0.3 {
        material.lobes.coat = Coat { share: 0.8, roughness: one_of(random, &[0.0, 0.2]), hole: 0.0 };
    }
    material.fresnel = one_of(random, &[Fresnel::Off, Fresnel::Exact, Fresnel::Schlick]);
}

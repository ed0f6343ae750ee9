//! A scene at one moment with all that is constant resolved, ready to be traced.

use super::TraceSettings;
use super::light::LightSampler;
use super::materials::{LobeSet, LobeTable};
use super::stream::Columns;
use crate::bvh::{Bvh, Passing};
use crate::color::Rgb;
use crate::environment::Environment;
use crate::film::LayerId;
use crate::fog::Fog;
use crate::glow::Glow;
use crate::material::{MadeOf, Material};
use crate::math::{DVec3, gamma};
use crate::quality::{Integrator, Quality};
use crate::scene::{Finish, Primitive, Scene, SurfaceTable};

/// What a path that has met something goes on with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Queue {
    /// It has met nothing.
    Escaped,
    /// It has met a light.
    Light,
    /// A surface whose material has the lobes of this number.
    Surface(u32),
}

/// The queue of a primitive's hits.
#[derive(Clone, Copy, Debug)]
enum Route {
    One(Queue, u32),
    /// By the part that is met.
    Parts,
}

/// One moment's scene, ready to be traced.
pub struct TraceContext<'a> {
    pub scene: &'a Scene<'a>,
    pub bvh: &'a Bvh,
    pub settings: &'a TraceSettings,
    pub quality: &'a Quality,
    pub surfaces: SurfaceTable,
    pub lights: LightSampler<'a>,
    pub environment: Option<&'a Environment>,
    pub ambient: Option<Glow>,
    pub fog: Option<Fog>,
    /// Where the shares of eye rays that meet nothing go, in place of what the sky would add.
    pub holdout: Option<LayerId>,
    /// The first layer of AOVs, if there are any.
    pub aovs: Option<usize>,
    /// How many layers hold light, and how many there are.
    pub lit_layers: usize,
    pub layers: usize,
    /// Whether shadow rays pass what refracts.
    pub refractive_shadows: bool,
    /// Lobes by which shadow rays pass surfaces.
    pub passes: LobeSet,
    /// Whether samples are drawn at random.
    pub is_random: bool,
    /// The axes of the picture, to the right and up: frames around directions to the eye are turned by them.
    pub picture_axes: [DVec3; 2],
    /// Whether some light cannot be sampled: paths find it by chance alone.
    pub unsampled_light: bool,
    /// Whether paths that reflect and refract no more can meet light: emitters, the sky or the glow of fog.
    pub emits: bool,
    /// What rounding may do to a point of any surface, at most, as a length.
    pub rounding: f64,
    pub columns: Columns,
    /// The lobes of materials, and those that differ from each other with their numbers.
    pub table: LobeTable,
    pub classes: Vec<LobeSet>,
    class_of: Vec<u32>,
    routes: Vec<Route>,
    /// Of every primitive, whether shadow rays pass it.
    passing: Vec<bool>,
    /// Whether there are any.
    pub clear: bool,
    /// Whether any material refracts, so that rays must know what they are inside of.
    pub media: bool,
}

impl<'a> TraceContext<'a> {
    pub fn new(scene: &'a Scene<'a>, bvh: &'a Bvh, settings: &'a TraceSettings) -> Self {
        let (shading, quality) = (scene.shading, &settings.quality);
        let weighted = |layer: LayerId| scene.weights.0[layer.index()] != Rgb::ZERO;
        let (path, refractive_shadows) = match quality.integrator {
            Integrator::Whitted => (false, true),
            Integrator::Path(path) => (true, path.refractive_shadows),
        };
        let environment = &shading.environment;
        let is_lit = !environment.is_black() && weighted(environment.layer);
        let environment = is_lit.then_some(environment);
        let lights = LightSampler::new(scene, environment, path);
        let mut used = vec![false; shading.materials.len()];
        let primitives = &scene.geometry.primitives;
        primitives.iter().flat_map(Primitive::materials).for_each(|index| used[index as usize] = true);
        let lobes: Vec<_> = shading.materials.iter().map(LobeSet::of).collect();
        let any = |set: LobeSet| lobes.iter().zip(&used).any(|(lobes, used)| *used && lobes.has(set));
        let media = any(LobeSet::REFRACTION);
        let passes =
            LobeSet::TRANSPARENT | if refractive_shadows { LobeSet::REFRACTION } else { LobeSet::default() };
        let shines =
            |material: &Material| material.lobes.emission != Rgb::ZERO && weighted(material.emission_layer);
        let emits = shading.materials.iter().zip(&used).any(|(material, used)| *used && shines(material));
        let unsampled = lights.leaves_out_emission();
        let lit_layers = scene.weights.0.len();
        let extras = settings.extras;
        let is_random = is_random(scene, quality.integrator);
        let columns = Columns {
            fog: shading.fog.is_some(),
            cones: any(LobeSet::TEXTURED),
            mis: path && lights.weighs(),
            media: any(LobeSet::PASSES),
            keys: !path && is_random,
            flags: path
                || extras.guides_layer(lit_layers).is_some()
                || primitives.iter().any(Primitive::is_light),
        };
        let glows = |glow: &Glow| glow.radiance != Rgb::ZERO && weighted(glow.layer);
        let glows_in_fog = shading.fog.is_some_and(|fog| glows(&fog.glow));
        let mut context = Self {
            scene,
            bvh,
            settings,
            quality,
            surfaces: SurfaceTable::new(scene.geometry),
            environment,
            ambient: Some(shading.ambient).filter(glows),
            fog: shading.fog,
            holdout: extras.coverage_layer(lit_layers),
            aovs: extras.guides_layer(lit_layers).map(LayerId::index),
            lit_layers,
            layers: lit_layers + extras.layers(),
            refractive_shadows,
            passes,
            is_random,
            picture_axes: [scene.camera.basis.right, scene.camera.basis.up],
            emits: environment.is_some() || emits || lights.weighs() || glows_in_fog,
            unsampled_light: (environment.is_some() && !lights.samples_sky()) || unsampled || glows_in_fog,
            rounding: bvh.reach() * gamma(32),
            columns,
            lights,
            table: LobeTable::new(shading.materials.iter().map(|material| &material.lobes)),
            classes: Vec::new(),
            class_of: Vec::new(),
            routes: Vec::new(),
            passing: primitives
                .iter()
                .map(|p| p.materials().any(|m| lobes[m as usize].has(passes)))
                .collect(),
            clear: any(passes),
            media,
        };
        context.classify(&lobes);
        context
    }

    /// Numbers the sets of lobes that differ, and notes where hits of each primitive go.
    fn classify(&mut self, lobes: &[LobeSet]) {
        self.classes = lobes.to_vec();
        self.classes.sort_unstable();
        self.classes.dedup();
        let class = |lobes: &LobeSet| self.classes.binary_search(lobes).unwrap_or_default() as u32;
        self.class_of = lobes.iter().map(class).collect();
        let route = |primitive: &Primitive| match primitive.finish {
            Finish::Light(index) => Route::One(Queue::Light, index),
            Finish::Material(MadeOf::One(material)) => {
                Route::One(Queue::Surface(self.class_of[material as usize]), material)
            }
            Finish::Material(MadeOf::Slots { .. }) => Route::Parts,
        };
        self.routes = self.scene.geometry.primitives.iter().map(route).collect();
    }

    /// Where a hit goes, with the index of its material or light.
    #[inline]
    pub fn route(&self, primitive: u32, part: u32) -> (Queue, u32) {
        match self.routes[primitive as usize] {
            Route::One(queue, index) => (queue, index),
            Route::Parts => {
                let material = self.scene.geometry.primitives[primitive as usize].material(part);
                let material = material.unwrap_or_default();
                (Queue::Surface(self.class_of[material as usize]), material)
            }
        }
    }

    pub fn lobes_of(&self, material: u32) -> LobeSet {
        self.classes[self.class_of[material as usize] as usize]
    }

    pub fn material(&self, index: u32) -> &'a Material {
        &self.scene.shading.materials[index as usize]
    }

    /// Which primitives shadow rays pass, if any.
    pub fn passing(&self) -> Option<Passing<'_>> {
        self.clear.then_some(Passing(&self.passing))
    }
}

/// Whether samples of one moment of the scene are drawn at random: along paths, and where a lens, a light with an area
/// or a rough surface has to be sampled.
pub fn is_random(scene: &Scene, integrator: Integrator) -> bool {
    let rough = || {
        let mut materials = scene.geometry.primitives.iter().flat_map(Primitive::materials);
        materials.any(|index| scene.shading.materials[index as usize].is_rough())
    };
    let area = || scene.lights().any(|(_, light)| light.source.is_sampled());
    integrator.looks_for_lights() || scene.camera.lens.is_some() || area() || rough()
}

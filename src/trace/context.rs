//! A scene at one moment with all that is constant resolved, ready to be traced.

use super::TraceSettings;
use super::light::LightSampler;
use super::materials::{LobeSet, LobeTable};
use super::stream::Columns;
use crate::appearance::environment::Environment;
use crate::appearance::fog::Fog;
use crate::appearance::light_groups::glow::Glow;
use crate::appearance::material::{MadeOf, Material};
use crate::base::color::Rgb;
use crate::base::math::{DVec3, gamma};
use crate::film::LayerId;
use crate::scene::top_level::{Bvh, Passing};
use crate::scene::{Finish, Primitive, Scene, SurfaceTable};
use crate::sequence::quality::{Integrator, Quality};

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
        let (shading, quality, extras) = (scene.shading, &settings.quality, settings.extras);
        let (path, refractive_shadows) = match quality.integrator {
            Integrator::Whitted => (false, true),
            Integrator::Path(path) => (true, path.refractive_shadows),
        };
        let environment = &shading.environment;
        let is_lit = !environment.is_black() && is_weighted(scene, environment.layer);
        let environment = is_lit.then_some(environment);
        let lights = LightSampler::new(scene, environment, path);
        let materials = UsedMaterials::new(scene);
        let passes =
            LobeSet::TRANSPARENT | if refractive_shadows { LobeSet::REFRACTION } else { LobeSet::default() };
        let lit_layers = scene.weights.0.len();
        let aovs = extras.guides_layer(lit_layers).map(LayerId::index);
        let is_random = is_random(scene, quality.integrator);
        let glows = |glow: &Glow| glow.radiance != Rgb::ZERO && is_weighted(scene, glow.layer);
        let glows_in_fog = shading.fog.is_some_and(|fog| glows(&fog.glow));
        let unsampled_sky = environment.is_some() && !lights.samples_sky();
        let columns = Columns {
            fog: shading.fog.is_some(),
            cones: materials.any(LobeSet::TEXTURED),
            mis: path && lights.weighs(),
            media: materials.any(LobeSet::PASSES),
            keys: !path && is_random,
            flags: path || aovs.is_some() || scene.geometry.primitives.iter().any(Primitive::is_light),
        };
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
            aovs,
            lit_layers,
            layers: lit_layers + extras.layers(),
            refractive_shadows,
            passes,
            is_random,
            picture_axes: [scene.camera.basis.right, scene.camera.basis.up],
            emits: environment.is_some() || materials.emit(scene) || lights.weighs() || glows_in_fog,
            unsampled_light: unsampled_sky || lights.leaves_out_emission() || glows_in_fog,
            rounding: bvh.reach() * gamma(32),
            columns,
            lights,
            table: LobeTable::new(shading.materials.iter().map(|material| &material.lobes)),
            classes: Vec::new(),
            class_of: Vec::new(),
            routes: Vec::new(),
            passing: Vec::new(),
            clear: materials.any(passes),
            media: materials.any(LobeSet::REFRACTION),
        };
        context.classify(&materials.lobes);
        context
    }

    /// Numbers the sets of lobes that differ, and notes of each primitive where its hits go and whether shadow rays pass it.
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
        let primitives = &self.scene.geometry.primitives;
        self.routes = primitives.iter().map(route).collect();
        let passes =
            |primitive: &Primitive| primitive.materials().any(|m| lobes[m as usize].has(self.passes));
        self.passing = primitives.iter().map(passes).collect();
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

/// The lobes of a scene's materials, and which of them are seen somewhere.
struct UsedMaterials {
    lobes: Vec<LobeSet>,
    used: Vec<bool>,
}

impl UsedMaterials {
    fn new(scene: &Scene) -> Self {
        let materials = &scene.shading.materials;
        let mut used = vec![false; materials.len()];
        let primitives = scene.geometry.primitives.iter();
        primitives.flat_map(Primitive::materials).for_each(|index| used[index as usize] = true);
        Self { lobes: materials.iter().map(LobeSet::of).collect(), used }
    }

    /// Whether any has lobes of a set.
    fn any(&self, set: LobeSet) -> bool {
        self.lobes.iter().zip(&self.used).any(|(lobes, used)| *used && lobes.has(set))
    }

    /// Whether any emits light.
    fn emit(&self, scene: &Scene) -> bool {
        let shines = |material: &Material| {
            material.lobes.emission != Rgb::ZERO && is_weighted(scene, material.emission_layer)
        };
        scene.shading.materials.iter().zip(&self.used).any(|(material, used)| *used && shines(material))
    }
}

/// Whether light of a layer shows.
fn is_weighted(scene: &Scene, layer: LayerId) -> bool {
    scene.weights.0[layer.index()] != Rgb::ZERO
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

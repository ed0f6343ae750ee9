//! A scene at one moment, prepared for tracing: everything that is constant is resolved.

use super::light::{LightSampler, Scattering};
use super::materials::{LobeSet, LobeTable};
use super::settings::TraceSettings;
use super::stream::{Columns, PathState};
use crate::appearance::environment::Environment;
use crate::appearance::fog::Fog;
use crate::appearance::light_groups::GroupRadiance;
use crate::appearance::material::{Material, MaterialBinding};
use crate::appearance::texture::TextureInputs;
use crate::base::color::Rgb;
use crate::base::lanes::{Bits, Real, Row};
use crate::base::math::{DVec3, gamma};
use crate::film::LayerId;
use crate::geometry::ray_kinds::RayKind;
use crate::scene::movers::Movers;
use crate::scene::top_level::{Bvh, TransmissiveFlags};
use crate::scene::{Finish, Scene};
use crate::sequence::quality::{Integrator, Quality};

/// The queue of a path after the intersect stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Queue {
    /// Paths that hit nothing.
    Escaped,
    /// Paths that hit a light.
    Light,
    /// Paths that hit a surface. The number is that of the set of lobes.
    Surface(u32),
}

/// A scene at one moment, prepared for tracing.
pub struct TraceContext<'a> {
    pub scene: &'a Scene<'a>,
    pub bvh: &'a Bvh,
    /// Whether camera rays and scattered ones see different primitives.
    pub parts_rays: bool,
    pub settings: &'a TraceSettings,
    pub quality: &'a Quality,
    pub lights: LightSampler<'a>,
    pub environment: Option<&'a Environment>,
    pub ambient: Option<GroupRadiance>,
    pub fog: Option<Fog>,
    /// The layer that records the share of camera rays that hit nothing, instead of light from the sky.
    pub holdout: Option<LayerId>,
    /// The first layer of the features of the first visible surface, if films record them.
    pub aovs: Option<usize>,
    /// Where and how films record the denoiser's guides, if they do.
    pub guides: Option<GuideRecord>,
    /// The number of layers of light, and the number of all layers.
    pub lit_layers: usize,
    pub layers: usize,
    /// Whether shadow rays pass refracting surfaces.
    pub refractive_shadows: bool,
    /// The lobes that let shadow rays pass.
    pub passes: LobeSet,
    /// Whether samples are random.
    pub is_random: bool,
    /// The axes of the image, to the right and up. Frames around directions to the eye are aligned with them.
    pub picture_axes: [DVec3; 2],
    /// Whether the scene has light that cannot be sampled, so that paths find it only by chance.
    pub unsampled_light: bool,
    /// Whether paths at their last bounce can still find light: emitters, the sky, or in-scattering of fog.
    pub emits: bool,
    /// The largest rounding error of a point of any surface, as a length.
    pub rounding: f64,
    pub columns: Columns,
    /// What the textures of each material read at a point.
    texture_inputs: Vec<TextureInputs>,
    /// The lobes of all materials, and the different sets of lobes in numbered order.
    pub table: LobeTable,
    pub classes: Vec<LobeSet>,
    class_of: Vec<u32>,
    /// For each primitive, whether shadow rays pass it. None if they pass no primitive.
    passing: Option<Vec<bool>>,
    /// Whether any material refracts, so that paths record the media around them.
    pub media: bool,
    /// Whether any of these media absorbs.
    pub absorbs: bool,
    /// Whether a sample may have several paths.
    pub branches: bool,
    /// The movers that segments of paths are tested against, if paths are shared by several frames.
    pub movers: Option<&'a Movers<'a>>,
}

/// How films record the denoiser's guides: from the first samples of each pixel alone, since they are far less noisy than
/// light, and take time.
#[derive(Clone, Copy, Debug)]
pub struct GuideRecord {
    /// The first layer.
    pub layer: usize,
    /// The number of the first sample that records none.
    pub end: u32,
    /// All samples of the film over those that record guides.
    pub scale: f64,
}

impl GuideRecord {
    fn new(layer: LayerId, settings: &TraceSettings) -> Self {
        let count = settings.quality.samples;
        let recorded = (count / 4).max(LEAST_GUIDES).min(count);
        let scale = f64::from(count) / f64::from(recorded.max(1));
        Self { layer: layer.index(), end: settings.first_sample + recorded, scale }
    }
}

/// The least number of samples that record guides, if there are so many.
const LEAST_GUIDES: u32 = 32;

impl<'a> TraceContext<'a> {
    pub fn new(scene: &'a Scene<'a>, bvh: &'a Bvh, settings: &'a TraceSettings) -> Self {
        let (shading, quality, set) = (scene.shading, &settings.quality, settings.aovs);
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
        let aovs = set.features_layer(lit_layers).map(LayerId::index);
        let guides = set.guides_layer(lit_layers).map(|layer| GuideRecord::new(layer, settings));
        let is_random = is_random(scene, quality.integrator);
        let glows = |glow: &GroupRadiance| glow.radiance != Rgb::ZERO && is_weighted(scene, glow.layer);
        let glows_in_fog = shading.fog.is_some_and(|fog| glows(&fog.in_scattering));
        let unsampled_sky = environment.is_some() && !lights.samples_sky();
        let columns = Columns {
            fog: shading.fog.is_some(),
            cones: materials.any(LobeSet::TEXTURED),
            mis: path && lights.needs_mis(),
            media: materials.any(LobeSet::PASSES),
            keys: !path && is_random,
            flags: path
                || aovs.is_some()
                || guides.is_some()
                || scene.geometry.lights().next().is_some()
                || parts_rays(scene),
        };
        let (classes, class_of) = materials.classes();
        Self {
            scene,
            bvh,
            parts_rays: parts_rays(scene),
            settings,
            quality,
            environment,
            ambient: Some(shading.ambient).filter(glows),
            fog: shading.fog,
            holdout: set.coverage_layer(lit_layers),
            aovs,
            guides,
            lit_layers,
            layers: lit_layers + set.layers(),
            refractive_shadows,
            passes,
            is_random,
            picture_axes: [scene.camera.basis.right, scene.camera.basis.up],
            emits: environment.is_some() || materials.emit(scene) || lights.needs_mis() || glows_in_fog,
            unsampled_light: unsampled_sky || lights.has_unsampled_emission() || glows_in_fog,
            rounding: bvh.reach() * gamma(32),
            columns,
            lights,
            texture_inputs: shading.materials.iter().map(Material::texture_inputs).collect(),
            table: LobeTable::new(shading.materials.iter().map(|material| &material.lobes)),
            classes,
            class_of,
            passing: materials.any(passes).then(|| materials.passing(scene, passes)),
            media: materials.any(LobeSet::REFRACTION),
            absorbs: materials.absorb(scene),
            branches: !path && materials.branch(),
            movers: None,
        }
    }

    /// Where paths were scattered last: at the first surface, if only one bounce is gone. Mirrors and boundaries behind
    /// it take bounces, too; but then the light that paths hit has a weight that no density changes.
    #[inline(always)]
    pub fn scattering<F: Real>(&self, path: &PathState<F>) -> Scattering<F> {
        let is_first = path.bounces_left.eq(F::U32::splat(self.quality.bounces));
        Scattering { point: path.scattered_at, is_first }
    }

    /// The queue of a hit, and the index of its material or light.
    #[inline]
    pub fn route(&self, primitive: u32, part: u32) -> (Queue, u32) {
        let geometry = self.scene.geometry;
        let material = match geometry.finishes()[primitive as usize] {
            Finish::Empty => return (Queue::Escaped, 0),
            Finish::Light(index) => return (Queue::Light, index),
            Finish::Material(MaterialBinding::One(material)) => material,
            Finish::Material(MaterialBinding::Slots { .. } | MaterialBinding::Capped { .. }) => {
                geometry.primitives[primitive as usize].material(part).unwrap_or_default()
            }
        };
        (Queue::Surface(self.class_of[material as usize]), material)
    }

    pub fn lobes_of(&self, material: u32) -> LobeSet {
        self.classes[self.class_of[material as usize] as usize]
    }

    pub fn material(&self, index: u32) -> &'a Material {
        &self.scene.shading.materials[index as usize]
    }

    /// What the textures of a material read at a point.
    pub fn texture_inputs(&self, material: u32) -> TextureInputs {
        self.texture_inputs[material as usize]
    }

    /// Whether shadow rays pass any primitive.
    pub fn has_transparency(&self) -> bool {
        self.passing.is_some()
    }

    /// The primitives that shadow rays pass, if there are any.
    pub fn passing(&self) -> Option<TransmissiveFlags<'_>> {
        self.passing.as_deref().map(TransmissiveFlags)
    }
}

/// Whether camera rays and scattered ones see different primitives.
fn parts_rays(scene: &Scene) -> bool {
    [RayKind::Camera, RayKind::Scattered].into_iter().any(|kind| scene.geometry.hides_from(kind))
}

/// The lobes of a scene's materials, and whether each material is used.
struct UsedMaterials {
    lobes: Vec<LobeSet>,
    used: Vec<bool>,
}

impl UsedMaterials {
    fn new(scene: &Scene) -> Self {
        let materials = &scene.shading.materials;
        let mut used = vec![false; materials.len()];
        scene.geometry.materials().for_each(|index| used[index as usize] = true);
        Self { lobes: materials.iter().map(LobeSet::of).collect(), used }
    }

    /// Whether a used material has any of these lobes.
    fn any(&self, set: LobeSet) -> bool {
        self.lobes.iter().zip(&self.used).any(|(lobes, used)| *used && lobes.has(set))
    }

    /// Whether a used material refracts into a medium that absorbs.
    fn absorb(&self, scene: &Scene) -> bool {
        let mut materials = scene.shading.materials.iter().zip(self.lobes.iter().zip(&self.used));
        materials.any(|(material, (lobes, used))| {
            *used && lobes.has(LobeSet::REFRACTION) && material.medium.absorption != Rgb::ZERO
        })
    }

    /// Whether a used material reflects or transmits light in several ways.
    fn branch(&self) -> bool {
        let ways = [LobeSet::MICROFACET, LobeSet::COAT, LobeSet::MIRROR, LobeSet::TRANSPARENT];
        let branches = |set: &LobeSet| {
            set.has(LobeSet::REFRACTION) || ways.iter().filter(|way| set.has(**way)).count() > 1
        };
        self.lobes.iter().zip(&self.used).any(|(lobes, used)| *used && branches(lobes))
    }

    /// The different sets of lobes in numbered order, and the number of each material's set.
    fn classes(&self) -> (Vec<LobeSet>, Vec<u32>) {
        let mut classes = self.lobes.clone();
        classes.sort_unstable();
        classes.dedup();
        let class = |lobes: &LobeSet| classes.binary_search(lobes).unwrap_or_default() as u32;
        let class_of = self.lobes.iter().map(class).collect();
        (classes, class_of)
    }

    /// For each primitive, whether it has a material with any of these lobes.
    fn passing(&self, scene: &Scene, passes: LobeSet) -> Vec<bool> {
        let has = |material: u32| self.lobes[material as usize].has(passes);
        scene.geometry.finishes().iter().map(|finish| finish.materials().any(has)).collect()
    }

    /// Whether a used material emits light.
    fn emit(&self, scene: &Scene) -> bool {
        let shines = |material: &Material| {
            material.lobes.emission != Rgb::ZERO && is_weighted(scene, material.emission_layer)
        };
        scene.shading.materials.iter().zip(&self.used).any(|(material, used)| *used && shines(material))
    }
}

/// Whether the weight of a layer is not black.
fn is_weighted(scene: &Scene, layer: LayerId) -> bool {
    scene.weights.0[layer.index()] != Rgb::ZERO
}

/// Whether samples of a moment are random: along paths, and for a lens, a light with an area or a rough surface.
pub fn is_random(scene: &Scene, integrator: Integrator) -> bool {
    let rough = || {
        let mut materials = scene.geometry.materials();
        materials.any(|index| scene.shading.materials[index as usize].is_rough())
    };
    let area = || scene.lights().any(|(_, light)| light.source.is_sampled());
    integrator.samples_lights() || scene.camera.lens.is_some() || area() || rough()
}

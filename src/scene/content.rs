//! Digests of a scene. Whatever has no effect on the image is left out.

use super::{Finish, Geometry, Primitive, Scene, Shading};
use crate::appearance::environment::{Environment, Sky};
use crate::appearance::fog::Fog;
use crate::appearance::light::Light;
use crate::appearance::light_groups::GroupRadiance;
use crate::appearance::material::{Material, MaterialBinding, TextureSlot};
use crate::appearance::texture::DataSource;
use crate::base::color::Rgb;
use crate::base::digest::{Content, Digest, Digester};
use crate::film::LayerId;
use crate::geometry::mesh::ArrayKey;
use std::collections::{BTreeMap, HashMap, HashSet};

/// Digests of the parts of a scene that take long to hash. Each is computed again only when its part has changed.
#[derive(Clone, Debug, Default)]
pub struct Digests {
    geometry: Digest,
    /// The visible materials, in the order in which primitives show them.
    used: Vec<u32>,
    /// The lights that are primitives, in the order of these.
    luminous: Vec<u32>,
    /// The textured materials, and a digest of the shapes' own spaces where these are visible. Only textures read the
    /// own spaces.
    origins: Option<(Vec<u32>, Digest)>,
    /// The data of meshes that visible textures read, if they read any.
    arrays: Option<Digest>,
    shading: Digest,
    shown: Option<Shown>,
}

/// The shading with only some layers lit.
#[derive(Clone, Debug)]
struct Shown {
    lit: Vec<bool>,
    /// The layers that contain light.
    layers: Vec<LayerId>,
    digest: Digest,
}

impl Digests {
    /// Updates the digest after a change of the geometry.
    pub fn geometry(&mut self, geometry: &Geometry) {
        (self.origins, self.shown) = (None, None);
        let light = |primitive: &Primitive| match primitive.finish {
            Finish::Light(index) => Some(index),
            Finish::Material(_) => None,
        };
        self.luminous = geometry.primitives.iter().filter_map(light).collect();
        self.geometry = self.of_primitives(&geometry.primitives);
    }

    /// Digest of primitives. Materials are numbered in the order in which primitives show them, so their order in the
    /// file and unused materials have no effect. The identity of a light belongs to the shading.
    fn of_primitives(&mut self, primitives: &[Primitive]) -> Digest {
        let mut places: HashMap<u32, u32> = HashMap::new();
        let used = &mut self.used;
        used.clear();
        let mut place = |material: u32| {
            *places.entry(material).or_insert_with(|| {
                used.push(material);
                used.len() as u32 - 1
            })
        };
        let mut digester = Digester::new();
        for primitive in primitives {
            (&primitive.shape, &primitive.transform).feed(&mut digester);
            // Shapes with a material per part are not sampled as lights.
            let by_part = matches!(primitive.finish, Finish::Material(MaterialBinding::Slots { .. }));
            by_part.feed(&mut digester);
            primitive.materials().map(&mut place).collect::<Vec<u32>>().feed(&mut digester);
        }
        digester.finish()
    }

    /// Updates the digest after a change of the shading or the geometry. If both changed, call [`Digests::geometry`]
    /// first.
    pub fn shading(&mut self, geometry: &Geometry, shading: &Shading) {
        self.shown = None;
        self.note_origins(geometry, shading);
        self.note_arrays(geometry, shading);
        let parts = EffectiveShading::of(&self.used, shading, |_| true);
        let mut digester = Digester::new();
        parts.feed(&|layer| layer, &|index, _| Some(index), &mut digester);
        self.luminous.feed(&mut digester);
        self.feed_origins(&mut digester);
        self.shading = digester.finish();
    }

    fn note_origins(&mut self, geometry: &Geometry, shading: &Shading) {
        let is_painted = |index: &u32| !shading.materials[*index as usize].textures.is_empty();
        let painted: Vec<u32> = self.used.iter().copied().filter(is_painted).collect();
        if self.origins.as_ref().is_none_or(|(known, _)| *known != painted) {
            let is_painted: HashSet<u32> = painted.iter().copied().collect();
            let origins = geometry.origins(|material| is_painted.contains(&material));
            self.origins = Some((painted, origins));
        }
    }

    fn note_arrays(&mut self, geometry: &Geometry, shading: &Shading) {
        let mut keys: HashMap<u32, Vec<&ArrayKey>> = HashMap::new();
        for &index in &self.used {
            for (_, texture) in &shading.materials[index as usize].textures {
                texture.each_data(&mut |data| {
                    if let DataSource::Array(key) = &data.source {
                        keys.entry(index).or_default().push(key);
                    }
                });
            }
        }
        self.arrays = (!keys.is_empty()).then(|| geometry.arrays(&keys));
    }

    fn feed_origins(&self, digester: &mut Digester) {
        if let Some(arrays) = &self.arrays {
            arrays.feed(digester);
        }
        let (painted, origins) = self.origins.clone().unwrap_or_default();
        (!painted.is_empty()).then_some(origins).feed(digester);
    }

    /// The digest of the primitives, over which the tree is built.
    pub fn primitives(&self) -> Digest {
        self.geometry
    }

    /// The digest of everything that affects light transport, without weights. All parts must be up to date.
    pub fn transport(&self, scene: &Scene) -> Digest {
        Digest::of(&(self.geometry, self.shading, scene.camera))
    }

    /// The digest of the image: [`Digests::transport`] with weights, but without emitters in layers of weight 0 and
    /// without layers that contain no light. `samples_emitters` states whether points of emitters and of skies are
    /// sampled. All parts must be up to date.
    pub fn radiance(&mut self, scene: &Scene, samples_emitters: bool) -> Digest {
        let weights = &scene.weights.0;
        let lit: Vec<bool> = weights.iter().map(|weight| *weight != Rgb::ZERO).collect();
        let shown = match self.shown.take().filter(|shown| shown.lit == lit) {
            Some(shown) => shown,
            None => self.shown_with(lit, scene.shading, samples_emitters),
        };
        let weights: Vec<Rgb> = shown.layers.iter().map(|layer| weights[layer.index()]).collect();
        let digest = Digest::of(&((self.geometry, shown.digest, scene.camera), weights));
        self.shown = Some(shown);
        digest
    }

    fn shown_with(&self, lit: Vec<bool>, shading: &Shading, samples_emitters: bool) -> Shown {
        let parts = EffectiveShading::of(&self.used, shading, |layer| lit[layer.index()]);
        let layers = parts.layers(samples_emitters);
        let place = |layer: LayerId| LayerId(layers.range(..layer).count() as u32);
        let mut digester = Digester::new();
        // The random numbers of a light depend on its layer and on its position there.
        parts.feed(&place, &|_, _| None, &mut digester);
        let named = |(layer, drawn): (&LayerId, &bool)| drawn.then_some(layer.0);
        layers.iter().map(named).collect::<Vec<_>>().feed(&mut digester);
        let light = |index: &u32| parts.lights.binary_search_by_key(index, |(lit, _)| *lit).ok();
        self.luminous.iter().map(light).collect::<Vec<_>>().feed(&mut digester);
        self.feed_origins(&mut digester);
        Shown { lit, layers: layers.into_keys().collect(), digest: digester.finish() }
    }
}

/// Emitters and the materials that reflect their light, without those that have no effect.
struct EffectiveShading<'a> {
    materials: Vec<Material>,
    /// With their indices in the file.
    lights: Vec<(u32, Light)>,
    environment: Option<&'a Environment>,
    ambient: Option<GroupRadiance>,
    fog: Option<Fog>,
}

impl<'a> EffectiveShading<'a> {
    /// The parts with an effect, if only these materials are visible and only `lit` layers count.
    fn of(used: &[u32], shading: &'a Shading, lit: impl Fn(LayerId) -> bool) -> Self {
        let Shading { materials, lights, environment, sky_table: _, ambient, fog } = shading;
        let material = |&index: &u32| without_dark(&materials[index as usize], &lit);
        let materials: Vec<Material> = used.iter().map(material).collect();
        let reflects = materials.iter().any(|material| material.lobes.reflects_lights());
        let gathers = materials.iter().any(|material| material.lobes.ambient != Rgb::ZERO);
        // Lights with an area are visible themselves.
        let shines = |(_, light): &(u32, &Light)| {
            light.radiance != Rgb::ZERO && lit(light.layer) && (reflects || light.source.is_sampled())
        };
        let glows = |glow: &GroupRadiance| glow.radiance != Rgb::ZERO && lit(glow.layer);
        Self {
            materials,
            lights: (0..).zip(lights).filter(shines).map(|(index, light)| (index, *light)).collect(),
            environment: (!environment.is_black() && lit(environment.layer)).then_some(environment),
            ambient: Some(*ambient).filter(|ambient| gathers && glows(ambient)),
            // Fog without light still attenuates what is behind it.
            fog: fog.map(|fog| Fog {
                in_scattering: Some(fog.in_scattering).filter(glows).unwrap_or_default(),
                ..fog
            }),
        }
    }

    /// The layers that contain light. The flag is set if random numbers are drawn for the layer: for light sources
    /// that are sampled by points, and for a choice among several.
    fn layers(&self, samples_emitters: bool) -> BTreeMap<LayerId, bool> {
        let Self { materials, lights, environment, ambient, fog } = self;
        let mut layers = BTreeMap::new();
        for (_, light) in lights {
            let several = layers.contains_key(&light.layer);
            *layers.entry(light.layer).or_insert(false) |= light.source.is_sampled() || several;
        }
        let shining = materials.iter().filter(|material| material.lobes.emission != Rgb::ZERO);
        let shining = shining.map(|material| (material.emission_layer, samples_emitters));
        let sky =
            environment.map(|sky| (sky.layer, samples_emitters && !matches!(sky.sky, Sky::Constant(_))));
        let rest = [*ambient, fog.map(|fog| fog.in_scattering).filter(|glow| glow.radiance != Rgb::ZERO)];
        let rest = rest.into_iter().flatten().map(|glow| (glow.layer, false));
        for (layer, drawn) in shining.chain(sky).chain(rest) {
            *layers.entry(layer).or_insert(false) |= drawn;
        }
        layers
    }

    /// Feeds all parts to the digester. `layer` maps their layers, `number` the indices of lights.
    fn feed(
        &self,
        layer: &dyn Fn(LayerId) -> LayerId,
        number: &dyn Fn(u32, &Light) -> Option<u32>,
        into: &mut Digester,
    ) {
        let Self { materials, lights, environment, ambient, fog } = self;
        materials.len().feed(into);
        for material in materials {
            let shines = material.lobes.emission != Rgb::ZERO;
            let emission_layer = if shines { layer(material.emission_layer) } else { LayerId::CONSTANT };
            Material { emission_layer, ..material.clone() }.feed(into);
        }
        lights.len().feed(into);
        for (index, light) in lights {
            (number(*index, light), Light { layer: layer(light.layer), ..*light }).feed(into);
        }
        let placed = |environment: &Environment| Environment {
            layer: layer(environment.layer),
            ..environment.clone()
        };
        environment.map(placed).feed(into);
        let glow = |glow: GroupRadiance| GroupRadiance { layer: layer(glow.layer), ..glow };
        ambient.map(glow).feed(into);
        let dark = |fog: &Fog| fog.in_scattering.radiance == Rgb::ZERO;
        fog.map(|fog| if dark(&fog) { fog } else { Fog { in_scattering: glow(fog.in_scattering), ..fog } })
            .feed(into);
    }
}

/// A material, without emission if its emission's layer is not lit.
fn without_dark(material: &Material, lit: impl Fn(LayerId) -> bool) -> Material {
    let mut material = material.clone();
    if !lit(material.emission_layer) {
        material.lobes.emission = Rgb::ZERO;
        material.textures.retain_mut(|(slots, _)| {
            slots.retain(|slot| *slot != TextureSlot::Emission);
            !slots.is_empty()
        });
    }
    material
}

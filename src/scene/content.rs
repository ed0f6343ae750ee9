//! What tracing would make of a scene, as a digest: nothing that has no effect on it is part of it.

use super::{Finish, Geometry, Primitive, Scene, Shading};
use crate::appearance::environment::{Environment, Sky};
use crate::appearance::fog::Fog;
use crate::appearance::light::Light;
use crate::appearance::light_groups::glow::Glow;
use crate::appearance::material::{MadeOf, Material, Slot};
use crate::base::color::Rgb;
use crate::base::digest::{Content, Digest, Digester};
use crate::film::LayerId;
use std::collections::{BTreeMap, HashMap, HashSet};

/// The parts of a scene that take long to hash, each hashed when it has changed.
#[derive(Clone, Debug, Default)]
pub struct Digests {
    geometry: Digest,
    /// The materials that are seen somewhere, in the order in which primitives show them.
    used: Vec<u32>,
    /// The lights that are primitives, in the order of these.
    luminous: Vec<u32>,
    /// Materials that are painted, and the shapes' own spaces where they are seen: only paint asks for these.
    origins: Option<(Vec<u32>, Digest)>,
    shading: Digest,
    shown: Option<Shown>,
}

/// The shading as it is with some layers of light.
#[derive(Clone, Debug)]
struct Shown {
    lit: Vec<bool>,
    /// The layers that hold anything.
    layers: Vec<LayerId>,
    digest: Digest,
}

impl Digests {
    /// Notes that the geometry has changed.
    pub fn geometry(&mut self, geometry: &Geometry) {
        (self.origins, self.shown) = (None, None);
        let light = |primitive: &Primitive| match primitive.finish {
            Finish::Light(index) => Some(index),
            Finish::Material(_) => None,
        };
        self.luminous = geometry.primitives.iter().filter_map(light).collect();
        self.geometry = self.of_primitives(&geometry.primitives);
    }

    /// Of primitives, whose materials are counted in the order in which they are seen: where they stand in the file does not
    /// matter, nor do others. Which light a primitive is belongs to the shading.
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
            (&primitive.shape, &primitive.placement).feed(&mut digester);
            // Points of shapes with materials for each part are not drawn to look for light.
            let by_part = matches!(primitive.finish, Finish::Material(MadeOf::Slots { .. }));
            by_part.feed(&mut digester);
            primitive.materials().map(&mut place).collect::<Vec<u32>>().feed(&mut digester);
        }
        digester.finish()
    }

    /// Notes that the shading or the geometry has changed; of both, the geometry is noted first.
    pub fn shading(&mut self, geometry: &Geometry, shading: &Shading) {
        self.shown = None;
        self.note_origins(geometry, shading);
        let parts = Parts::of(&self.used, shading, |_| true);
        let mut digester = Digester::new();
        parts.feed(&|layer| layer, &|index, _| Some(index), &mut digester);
        self.luminous.feed(&mut digester);
        self.feed_origins(&mut digester);
        self.shading = digester.finish();
    }

    fn note_origins(&mut self, geometry: &Geometry, shading: &Shading) {
        let is_painted = |index: &u32| !shading.materials[*index as usize].paints.is_empty();
        let painted: Vec<u32> = self.used.iter().copied().filter(is_painted).collect();
        if self.origins.as_ref().is_none_or(|(known, _)| *known != painted) {
            let is_painted: HashSet<u32> = painted.iter().copied().collect();
            let origins = geometry.origins(|material| is_painted.contains(&material));
            self.origins = Some((painted, origins));
        }
    }

    fn feed_origins(&self, digester: &mut Digester) {
        let (painted, origins) = self.origins.clone().unwrap_or_default();
        (!painted.is_empty()).then_some(origins).feed(digester);
    }

    /// Of what a tree is built over.
    pub fn primitives(&self) -> Digest {
        self.geometry
    }

    /// All that light meets on its way through a scene whose parts have been noted, but for weights.
    pub fn transport(&self, scene: &Scene) -> Digest {
        Digest::of(&(self.geometry, self.shading, scene.camera))
    }

    /// What is seen of a scene whose parts have been noted, with its weights: as [`Digests::transport`], but what shines
    /// in layers of weight 0 has no part in it, nor have layers in which nothing shines. `samples_emitters` says whether
    /// points of objects that shine and of skies are drawn.
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
        let parts = Parts::of(&self.used, shading, |layer| lit[layer.index()]);
        let layers = parts.layers(samples_emitters);
        let place = |layer: LayerId| LayerId(layers.range(..layer).count() as u32);
        let mut digester = Digester::new();
        // The random numbers of a light depend on its layer and on its place there.
        parts.feed(&place, &|_, _| None, &mut digester);
        let named = |(layer, drawn): (&LayerId, &bool)| drawn.then_some(layer.0);
        layers.iter().map(named).collect::<Vec<_>>().feed(&mut digester);
        let light = |index: &u32| parts.lights.binary_search_by_key(index, |(lit, _)| *lit).ok();
        self.luminous.iter().map(light).collect::<Vec<_>>().feed(&mut digester);
        self.feed_origins(&mut digester);
        Shown { lit, layers: layers.into_keys().collect(), digest: digester.finish() }
    }
}

/// What shines and what reflects it, without what has no effect.
struct Parts<'a> {
    materials: Vec<Material>,
    /// With their places in the file.
    lights: Vec<(u32, Light)>,
    environment: Option<&'a Environment>,
    ambient: Option<Glow>,
    fog: Option<Fog>,
}

impl<'a> Parts<'a> {
    /// Those of a scene that shows these materials, where some layers are `lit`.
    fn of(used: &[u32], shading: &'a Shading, lit: impl Fn(LayerId) -> bool) -> Self {
        let Shading { materials, lights, environment, sky_table: _, ambient, fog } = shading;
        let material = |&index: &u32| without_dark(&materials[index as usize], &lit);
        let materials: Vec<Material> = used.iter().map(material).collect();
        let reflects = materials.iter().any(|material| material.lobes.reflects_lights());
        let gathers = materials.iter().any(|material| material.lobes.ambient != Rgb::ZERO);
        // Lights with an area are seen as they are, too.
        let shines = |(_, light): &(u32, &Light)| {
            light.radiance != Rgb::ZERO && lit(light.layer) && (reflects || light.source.is_sampled())
        };
        let glows = |glow: &Glow| glow.radiance != Rgb::ZERO && lit(glow.layer);
        Self {
            materials,
            lights: (0..).zip(lights).filter(shines).map(|(index, light)| (index, *light)).collect(),
            environment: (!environment.is_black() && lit(environment.layer)).then_some(environment),
            ambient: Some(*ambient).filter(|ambient| gathers && glows(ambient)),
            // Fog dims what is behind it, also where it is dark.
            fog: fog.map(|fog| Fog { glow: Some(fog.glow).filter(glows).unwrap_or_default(), ..fog }),
        }
    }

    /// The layers in which anything shines, each with whether random numbers are drawn for it alone: for sources of which
    /// a point is drawn, and where there are several, of which one may be.
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
        let rest = [*ambient, fog.map(|fog| fog.glow).filter(|glow| glow.radiance != Rgb::ZERO)];
        let rest = rest.into_iter().flatten().map(|glow| (glow.layer, false));
        for (layer, drawn) in shining.chain(sky).chain(rest) {
            *layers.entry(layer).or_insert(false) |= drawn;
        }
        layers
    }

    /// Tells all of them, with `layer` for their layers and `number` for the lights' places.
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
        let glow = |glow: Glow| Glow { layer: layer(glow.layer), ..glow };
        ambient.map(glow).feed(into);
        let dark = |fog: &Fog| fog.glow.radiance == Rgb::ZERO;
        fog.map(|fog| if dark(&fog) { fog } else { Fog { glow: glow(fog.glow), ..fog } }).feed(into);
    }
}

/// A material without emission that is in the dark.
fn without_dark(material: &Material, lit: impl Fn(LayerId) -> bool) -> Material {
    let mut material = material.clone();
    if !lit(material.emission_layer) {
        material.lobes.emission = Rgb::ZERO;
        material.paints.retain_mut(|(slots, _)| {
            slots.retain(|slot| *slot != Slot::Emission);
            !slots.is_empty()
        });
    }
    material
}

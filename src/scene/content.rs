//! Digests of a scene. Whatever has no effect on the image is left out.

use super::hash_tree::HashTree;
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
use crate::geometry::ray_kinds::RayKinds;
use rayon::prelude::*;
use std::collections::{BTreeMap, HashMap};

/// Fewest primitives that are worth a task of their own.
const MIN_TASK: usize = 256;

/// Digests of the parts of a scene that take long to hash. They follow the scene: what did not change is not hashed
/// again. They depend on the scene alone, not on how it came about.
#[derive(Clone, Debug, Default)]
pub struct Digests {
    /// The revision of the geometry that has been hashed.
    seen: Option<u64>,
    /// For each slot, the digest of its shape and transform, and its finish.
    slots: Vec<(Digest, Finish)>,
    /// For each slot, the number of primitives before it.
    ranks: Vec<u32>,
    /// Over the primitives, without empty slots.
    primitives: HashTree,
    /// Digest of which primitive shows which material.
    bindings: Digest,
    geometry: Digest,
    /// Digest of the slots that are not empty.
    arrangement: Digest,
    /// The visible materials, in the order in which primitives show them.
    used: Vec<u32>,
    /// The lights that are primitives, in the order of these.
    luminous: Vec<u32>,
    /// For each material, whether it is visible and textured; and a tree over the own spaces of the shapes that show
    /// these materials. Only textures read the own spaces.
    origins: Option<(Vec<bool>, HashTree)>,
    /// The data of meshes that visible textures read, if they read any.
    arrays: Option<Digest>,
    /// Digest of materials and emitters, without `origins` and `arrays`.
    effective: Digest,
    /// Digest of lights, sky, ambient light and fog.
    sources: Digest,
    shown: Option<Shown>,
}

/// The shading with only some layers lit.
#[derive(Clone, Debug)]
struct Shown {
    lit: Vec<bool>,
    /// The layers that contain light.
    layers: Vec<LayerId>,
    digest: Digest,
    /// The visible materials, if some of them have textures in dark layers only. These textures are left out.
    fewer_textures: Option<Vec<Material>>,
    /// The number of materials of the file.
    materials: usize,
}

/// The digest of what textures read; none if they read nothing.
fn texture_inputs(own_spaces: Option<Digest>, data: Option<Digest>) -> Option<Digest> {
    data.map_or(own_spaces, |data| Some(Digest::of(&(data, own_spaces))))
}

impl Digests {
    /// Follows the changes of a scene. `shading_changed` states whether the shading may differ from that of the last
    /// call.
    pub fn update(&mut self, geometry: &Geometry, shading: &Shading, shading_changed: bool) {
        let count = geometry.primitives.len();
        let seen = self.seen.filter(|_| self.slots.len() == count);
        self.slots.resize(count, (Digest::default(), Finish::Empty));
        let changes = seen.and_then(|seen| geometry.changes_since(seen));
        let mut changed = changes.map_or_else(|| (0..count as u32).collect(), <[u32]>::to_vec);
        changed.sort_unstable();
        changed.dedup();
        let regrouped = self.hash(geometry, &changed) || seen.is_none();
        self.seen = Some(geometry.revision());
        if regrouped {
            self.regroup(geometry);
        }
        if regrouped || shading_changed {
            self.shown = None;
            self.shading(geometry, shading, regrouped);
        }
        // These shapes may have data.
        let has_data = |slot: &u32| geometry.primitives[*slot as usize].shape.has_data();
        if regrouped || shading_changed || self.arrays.is_some() && changed.iter().any(has_data) {
            self.note_arrays(geometry, shading);
        }
        if !regrouped && !changed.is_empty() {
            let visible = changed.iter().map(|slot| *slot as usize);
            let visible: Vec<usize> = visible.filter(|slot| self.slots[*slot].1 != Finish::Empty).collect();
            let rank = |slot: usize| self.ranks[slot] as usize;
            self.primitives.update(visible.iter().map(|&slot| (rank(slot), self.slots[slot].0)));
            if let Some((painted, tree)) = &mut self.origins {
                tree.update(visible.iter().map(|&slot| (rank(slot), origin(geometry, slot, painted))));
            }
        }
        self.geometry = Digest::of(&(self.primitives.root(), self.bindings));
    }

    /// Hashes the primitives in slots. Returns whether any of them appeared, vanished or changed its finish.
    fn hash(&mut self, geometry: &Geometry, changed: &[u32]) -> bool {
        let hashed = |slot: &u32| {
            let Primitive { shape, transform, finish, rays } = &geometry.primitives[*slot as usize];
            let digest = Digest::of(&(shape, transform));
            let digest = if *rays == RayKinds::ALL { digest } else { Digest::of(&(digest, *rays)) };
            (digest, *finish)
        };
        let hashed: Vec<_> = match changed.len() < 2 * MIN_TASK {
            true => changed.iter().map(hashed).collect(),
            false => changed.par_iter().with_min_len(MIN_TASK).map(hashed).collect(),
        };
        let mut regrouped = false;
        for (slot, hashed) in changed.iter().zip(hashed) {
            regrouped |= self.slots[*slot as usize].1 != hashed.1;
            self.slots[*slot as usize] = hashed;
        }
        regrouped
    }

    /// Numbers primitives and materials. Materials are numbered in the order in which primitives show them, so their
    /// order in the file and unused materials have no effect. The identity of a light belongs to the shading.
    fn regroup(&mut self, geometry: &Geometry) {
        let mut places: HashMap<u32, u32> = HashMap::new();
        let (mut digester, mut primitives) = (Digester::new(), Vec::new());
        (self.used, self.luminous, self.ranks) = Default::default();
        let occupied =
            |(slot, (_, finish)): (u32, &(Digest, Finish))| (*finish != Finish::Empty).then_some(slot);
        self.arrangement = Digest::of(&(0..).zip(&self.slots).filter_map(occupied).collect::<Vec<u32>>());
        for ((digest, finish), primitive) in self.slots.iter().zip(&geometry.primitives) {
            self.ranks.push(primitives.len() as u32);
            match finish {
                Finish::Empty => continue,
                Finish::Light(index) => self.luminous.push(*index),
                Finish::Material(_) => {}
            }
            primitives.push(*digest);
            // Shapes with a material per part are not sampled as lights.
            let by_part = matches!(
                finish,
                Finish::Material(MaterialBinding::Slots { .. } | MaterialBinding::Capped { .. })
            );
            (by_part, primitive.materials().count()).feed(&mut digester);
            for material in primitive.materials() {
                let next = self.used.len() as u32;
                let place = *places.entry(material).or_insert(next);
                if place == next {
                    self.used.push(material);
                }
                place.feed(&mut digester);
            }
        }
        self.bindings = digester.finish();
        self.primitives = HashTree::new(primitives);
    }

    /// Hashes the materials and emitters, and the own spaces of textured shapes.
    fn shading(&mut self, geometry: &Geometry, shading: &Shading, regrouped: bool) {
        let parts = EffectiveShading::of(&self.used, shading, |_| true);
        let mut digester = Digester::new();
        parts.feed(&|layer| layer, &|index, _| Some(index), &mut digester);
        self.luminous.feed(&mut digester);
        self.effective = digester.finish();
        let Shading { materials: _, lights, environment, sky_table: _, ambient, fog } = shading;
        self.sources = Digest::of(&(lights, environment, (ambient, fog)));
        let painted = self.painted(&parts.materials, shading.materials.len());
        if !painted.contains(&true) {
            self.origins = None;
        } else if regrouped || self.origins.as_ref().is_none_or(|(known, _)| *known != painted) {
            let tree = self.own_spaces(geometry, &painted);
            self.origins = Some((painted, tree));
        }
    }

    /// For each material of the file, whether it is visible and textured. `materials` are the visible ones.
    fn painted(&self, materials: &[Material], count: usize) -> Vec<bool> {
        let mut painted = vec![false; count];
        for (index, material) in self.used.iter().zip(materials) {
            painted[*index as usize] = !material.textures.is_empty();
        }
        painted
    }

    /// Hashes the own spaces of the visible shapes that show a painted material.
    fn own_spaces(&self, geometry: &Geometry, painted: &[bool]) -> HashTree {
        let visible = (0..self.slots.len()).filter(|slot| self.slots[*slot].1 != Finish::Empty);
        HashTree::new(visible.map(|slot| origin(geometry, slot, painted)).collect())
    }

    /// Hashes the data of meshes that visible textures read.
    fn note_arrays(&mut self, geometry: &Geometry, shading: &Shading) {
        let materials = self.used.iter().map(|index| &shading.materials[*index as usize]);
        self.arrays = self.data(geometry, materials);
    }

    /// The digest of the data of meshes that textures of the visible materials read, if they read any.
    fn data<'m>(&self, geometry: &Geometry, materials: impl Iterator<Item = &'m Material>) -> Option<Digest> {
        let mut keys: HashMap<u32, Vec<&ArrayKey>> = HashMap::new();
        for (index, material) in self.used.iter().zip(materials) {
            for (_, texture) in &material.textures {
                texture.each_data(&mut |data| {
                    if let DataSource::Array(key) = &data.source {
                        keys.entry(*index).or_default().push(key);
                    }
                });
            }
        }
        (!keys.is_empty()).then(|| geometry.arrays(&keys))
    }

    /// What textures read besides points: the own spaces of shapes, and data.
    fn origins(&self) -> Option<Digest> {
        texture_inputs(self.origins.as_ref().map(|(_, tree)| tree.root()), self.arrays)
    }

    /// [`Digests::origins`] without textures of emission in dark layers.
    fn shown_origins(&self, geometry: &Geometry, shown: &Shown) -> Option<Digest> {
        let Some(materials) = &shown.fewer_textures else { return self.origins() };
        let painted = self.painted(materials, shown.materials);
        let tree = painted.contains(&true).then(|| self.own_spaces(geometry, &painted));
        texture_inputs(tree.map(|tree| tree.root()), self.data(geometry, materials.iter()))
    }

    /// The digest of the primitives and of their slots, over which the top-level tree is built.
    pub fn primitives(&self) -> Digest {
        Digest::of(&(self.geometry, self.arrangement))
    }

    /// The digest of the camera, lights, sky, ambient light and fog: of everything but objects and their materials. All
    /// parts must be up to date.
    pub fn surroundings(&self, scene: &Scene) -> Digest {
        Digest::of(&(self.sources, scene.camera))
    }

    /// The digest of everything that affects light transport, without weights. All parts must be up to date.
    pub fn scene_hash(&self, scene: &Scene) -> Digest {
        Digest::of(&((self.geometry, self.effective, self.origins()), scene.camera))
    }

    /// The digest of the image: [`Digests::scene_hash`] with weights, but without emitters in layers of weight 0 and
    /// without layers that contain no light. `samples_emitters` states whether points of emitters and of skies are
    /// sampled. All parts must be up to date.
    pub fn image_hash(&mut self, scene: &Scene, samples_emitters: bool) -> Digest {
        let weights = &scene.weights.0;
        let lit: Vec<bool> = weights.iter().map(|weight| *weight != Rgb::ZERO).collect();
        let shown = match self.shown.take().filter(|shown| shown.lit == lit) {
            Some(shown) => shown,
            None => self.shown_with(lit, scene.shading, samples_emitters),
        };
        let weights: Vec<Rgb> = shown.layers.iter().map(|layer| weights[layer.index()]).collect();
        let shape = (self.geometry, shown.digest, self.shown_origins(scene.geometry, &shown));
        let digest = Digest::of(&((shape, scene.camera), weights));
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
        let all = self.used.iter().map(|index| &shading.materials[*index as usize].textures);
        let is_same = all.eq(parts.materials.iter().map(|material| &material.textures));
        let (digest, layers) = (digester.finish(), layers.into_keys().collect());
        let fewer_textures = (!is_same).then_some(parts.materials);
        Shown { lit, layers, digest, fewer_textures, materials: shading.materials.len() }
    }
}

/// Digest of a shape's own space, if a painted material is visible on it.
fn origin(geometry: &Geometry, slot: usize, painted: &[bool]) -> Digest {
    let shows = geometry.primitives[slot].materials().any(|material| painted[material as usize]);
    Digest::of(&shows.then(|| geometry.origin(slot)))
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

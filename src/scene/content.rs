//! What tracing would make of a scene, as a digest: nothing that has no effect on it is part of it.

use super::{Finish, Geometry, Primitive, Scene, Shading};
use crate::color::Rgb;
use crate::digest::{Content, Digest, Digester};
use crate::light::Light;
use crate::material::MadeOf;

/// The parts of a scene that take long to hash, each hashed when it has changed.
#[derive(Clone, Debug, Default)]
pub struct Digests {
    geometry: Digest,
    /// The materials that are seen somewhere, ascending.
    used: Vec<u32>,
    /// The shapes' own spaces, which only paint asks for.
    origins: Option<Digest>,
    shading: Digest,
}

impl Digests {
    /// Notes that the geometry has changed.
    pub fn geometry(&mut self, geometry: &Geometry) {
        self.origins = None;
        self.used = geometry.materials();
        self.geometry = self.of_primitives(&geometry.primitives);
    }

    /// Of primitives, whose materials are counted among those that are used: others do not matter, nor how many there are.
    fn of_primitives(&self, primitives: &[Primitive]) -> Digest {
        let place = |material: u32| self.used.partition_point(|used| *used < material) as u32;
        let mut digester = Digester::new();
        for Primitive { shape, placement, finish } in primitives {
            (shape, placement).feed(&mut digester);
            let finish = match *finish {
                Finish::Material(MadeOf::One(index)) => Finish::Material(MadeOf::One(place(index))),
                Finish::Material(MadeOf::Slots { first, count }) => {
                    Finish::Material(MadeOf::Slots { first: place(first), count })
                }
                Finish::Light(index) => Finish::Light(index),
            };
            finish.feed(&mut digester);
        }
        digester.finish()
    }

    /// Notes that the shading or the geometry has changed; of both, the geometry is noted first.
    pub fn shading(&mut self, geometry: &Geometry, shading: &Shading) {
        let mut digester = Digester::new();
        let materials = self.used.iter().map(|&index| &shading.materials[index as usize]);
        let (mut painted, mut ambient) = (false, false);
        for material in materials {
            painted |= !material.paints.is_empty();
            ambient |= material.lobes.ambient != Rgb::ZERO;
            material.feed(&mut digester);
        }
        feed_light(shading, ambient, &mut digester);
        if painted {
            self.origins.get_or_insert_with(|| geometry.origins()).feed(&mut digester);
        }
        self.shading = digester.finish();
    }

    /// Of what a tree is built over.
    pub fn primitives(&self) -> Digest {
        self.geometry
    }

    /// All that light meets on its way through a scene whose parts have been noted, but for weights.
    pub fn transport(&self, scene: &Scene) -> Digest {
        Digest::of(&(self.geometry, self.shading, scene.camera))
    }
}

/// What shines; ambient light where any material reflects it.
fn feed_light(shading: &Shading, reflects: bool, digester: &mut Digester) {
    let Shading { materials: _, lights, environment, sky_table: _, ambient, fog } = shading;
    let shines = |(_, light): &(u32, &Light)| light.radiance != Rgb::ZERO;
    let lights: Vec<(u32, &Light)> = (0..).zip(lights).filter(shines).collect();
    lights.feed(digester);
    (!environment.is_black()).then_some(environment).feed(digester);
    (reflects && ambient.radiance != Rgb::ZERO).then_some(ambient).feed(digester);
    fog.feed(digester);
}

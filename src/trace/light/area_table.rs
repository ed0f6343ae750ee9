//! Several sources with an area: each lane samples the one that it has chosen.

use super::evaluate::Face;
use super::sampled_emitter::SampledEmitter;
use super::{LightSample, Receiver, area};
use crate::appearance::light::Source;
use crate::base::color::Rgb;
use crate::base::lanes::{Bits, Color, Lookup, Mask, Real, Row, Select, Vec3};
use crate::geometry::shape::{Rectangle, RectangleLanes, Shape, Sphere, SphereLanes};
use crate::scene::Scene;

/// The spheres and rectangles among the sources of a group, as structure of arrays.
pub struct AreaTable {
    spheres: Option<Kind<4>>,
    rectangles: Option<Kind<13>>,
    radiance: [Vec<f32>; 3],
    /// 1 for sources whose light objects block, otherwise 0.
    casts_shadows: Vec<u32>,
}

impl AreaTable {
    pub fn new(sources: &[SampledEmitter], scene: &Scene) -> Self {
        let sources: Vec<Option<AreaSource>> =
            sources.iter().map(|source| AreaSource::new(source, scene)).collect();
        let spheres = sources.iter().map(|source| source.as_ref()?.sphere());
        let rectangles = sources.iter().map(|source| source.as_ref()?.rectangle());
        let radiance = |channel: usize| {
            sources
                .iter()
                .map(|source| source.as_ref().map_or(0.0, |source| source.radiance[channel]))
                .collect()
        };
        let casts_shadows =
            |source: &Option<AreaSource>| source.as_ref().is_some_and(|source| source.casts_shadows);
        Self {
            spheres: Kind::new(&spheres.collect::<Vec<_>>()),
            rectangles: Kind::new(&rectangles.collect::<Vec<_>>()),
            radiance: [0, 1, 2].map(radiance),
            casts_shadows: sources.iter().map(|source| u32::from(casts_shadows(source))).collect(),
        }
    }

    /// Samples the chosen sources at points, from two numbers in 0..1. Also returns the lanes whose source is in the
    /// table.
    #[inline(always)]
    pub fn sample<F: Real>(&self, chosen: F::U32, at: &Receiver<F>, u: [F; 2]) -> (LightSample<F>, F::Mask) {
        let (mut sample, mut known) = (LightSample::none(), F::Mask::splat(false));
        if self.spheres.is_none() && self.rectangles.is_none() {
            return (sample, known);
        }
        let (numbers, mut indices) = (chosen.to_array(), [0; 8]);
        for lane in 0..F::LANES {
            indices[lane] = numbers[lane];
        }
        let chosen = Lookup::new(&indices[..F::LANES]);
        let radiance = Color::gather(self.radiance.each_ref().map(Vec::as_slice), &chosen);
        if let Some(kind) = &self.spheres {
            let is_one = flagged::<F>(&kind.is_one, &chosen);
            if is_one.any() {
                let sphere = SphereLanes { center: kind.vector(0, &chosen), radius: kind.number(3, &chosen) };
                let drawn = area::spheres(&sphere, flagged::<F>(&kind.both_sides, &chosen), at, u, radiance);
                (sample, known) = (LightSample::select(is_one, drawn, sample), known | is_one);
            }
        }
        if let Some(kind) = &self.rectangles {
            let is_one = flagged::<F>(&kind.is_one, &chosen);
            if is_one.any() {
                let rectangle = RectangleLanes {
                    corner: kind.vector(0, &chosen),
                    u: kind.vector(3, &chosen),
                    v: kind.vector(6, &chosen),
                    normal: kind.vector(9, &chosen),
                };
                let rectangle = (&rectangle, kind.number(12, &chosen));
                let drawn =
                    area::rectangles(rectangle, flagged::<F>(&kind.both_sides, &chosen), at, u, radiance);
                (sample, known) = (LightSample::select(is_one, drawn, sample), known | is_one);
            }
        }
        let casts_shadows = flagged::<F>(&self.casts_shadows, &chosen);
        (LightSample { casts_shadows, ..sample }, known)
    }
}

/// The sources of one kind. The entries of other sources repeat those of the first source of this kind, so computing
/// with them is harmless.
struct Kind<const NUMBERS: usize> {
    /// 1 for sources of this kind, otherwise 0.
    is_one: Vec<u32>,
    /// What describes their places, a column each.
    numbers: [Vec<f64>; NUMBERS],
    /// 1 for sources that emit to both sides, otherwise 0.
    both_sides: Vec<u32>,
}

impl<const NUMBERS: usize> Kind<NUMBERS> {
    /// None if no source is of this kind.
    fn new(sources: &[Option<([f64; NUMBERS], bool)>]) -> Option<Self> {
        let first = sources.iter().find_map(|source| *source)?;
        let filled = || sources.iter().map(|source| source.unwrap_or(first));
        Some(Self {
            is_one: sources.iter().map(|source| u32::from(source.is_some())).collect(),
            numbers: std::array::from_fn(|column| filled().map(|(numbers, _)| numbers[column]).collect()),
            both_sides: filled().map(|(_, both)| u32::from(both)).collect(),
        })
    }

    #[inline(always)]
    fn number<F: Real>(&self, column: usize, chosen: &Lookup) -> F {
        F::gather(&self.numbers[column], chosen)
    }

    /// A vector from three columns.
    #[inline(always)]
    fn vector<F: Real>(&self, first: usize, chosen: &Lookup) -> Vec3<F> {
        let [x, y, z] = [first, first + 1, first + 2];
        Vec3::gather([&self.numbers[x], &self.numbers[y], &self.numbers[z]], chosen)
    }
}

/// The lanes whose source has a flag.
#[inline(always)]
fn flagged<F: Real>(flags: &[u32], chosen: &Lookup) -> F::Mask {
    F::U32::gather(flags, chosen).eq(F::U32::splat(1))
}

/// A sphere or a rectangle that emits the same radiance everywhere.
struct AreaSource {
    shape: AreaShape,
    both_sides: bool,
    radiance: Rgb,
    casts_shadows: bool,
}

enum AreaShape {
    Sphere(Sphere),
    Rectangle(Rectangle),
}

impl AreaSource {
    /// None if a source has another shape, or varying radiance.
    fn new(source: &SampledEmitter, scene: &Scene) -> Option<Self> {
        match source {
            SampledEmitter::Light(_, light, _) => {
                let (shape, both_sides) = match light.source {
                    Source::Sphere(sphere) => (AreaShape::Sphere(sphere), false),
                    Source::Rectangle { rectangle, one_sided } => {
                        (AreaShape::Rectangle(rectangle), !one_sided)
                    }
                    Source::Point { .. } | Source::Spot { .. } | Source::Directional { .. } => return None,
                };
                Some(Self { shape, both_sides, radiance: light.radiance, casts_shadows: light.shadows })
            }
            SampledEmitter::Object(index, _) => {
                let primitive = &scene.geometry.primitives[*index as usize];
                let material = &scene.shading.materials[primitive.material(0)? as usize];
                if primitive.transform.is_some() || !material.textures.is_empty() {
                    return None;
                }
                let shape = match &primitive.shape {
                    Shape::Sphere(sphere) => AreaShape::Sphere(*sphere),
                    Shape::Rectangle(rectangle) => AreaShape::Rectangle(*rectangle),
                    _ => return None,
                };
                Some(Self { shape, both_sides: true, radiance: material.lobes.emission, casts_shadows: true })
            }
            SampledEmitter::Sky(_) => None,
        }
    }

    fn sphere(&self) -> Option<([f64; 4], bool)> {
        let AreaShape::Sphere(Sphere { center, radius }) = self.shape else { return None };
        Some(([center.x, center.y, center.z, radius], self.both_sides))
    }

    fn rectangle(&self) -> Option<([f64; 13], bool)> {
        let AreaShape::Rectangle(rectangle) = self.shape else { return None };
        // The last number stays 1 over the area.
        let (Rectangle { corner, u, v }, face) = (rectangle, Face::new(&rectangle));
        let mut numbers = [face.per_area; 13];
        let vectors = [corner, u, v, face.normal];
        for (vector, numbers) in vectors.into_iter().zip(numbers.chunks_exact_mut(3)) {
            numbers.copy_from_slice(&vector.to_array());
        }
        Some((numbers, self.both_sides))
    }
}

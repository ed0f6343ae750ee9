//! Materials: the strengths of their lobes, and the media that they enclose.

mod exponent;
mod lobes;
mod point_lobes;
mod tracks;

pub use exponent::{Exponent, Highlight};
pub use lobes::{Coat, Lobes, MIN_FUZZ, TextureSlot};
pub use point_lobes::PointLobes;
pub use tracks::{LobeTracks, MaterialTracks, ReliefTracks, ScalarTextureTracks};

use crate::appearance::optics::Fresnel;
use crate::appearance::texture::relief::{self, ReliefStrength};
use crate::appearance::texture::{Texel, Texture, TextureEvalContext, TextureInputs};
use crate::base::color::Rgb;
use crate::base::digest::Content;
use crate::base::lanes::{Mask, Real, Row, Single};
use crate::base::math::DVec3;
use crate::film::LayerId;
use bevy_ecs::component::Component;

/// A material at one moment.
#[derive(Clone, Component, Debug, PartialEq, Content)]
#[warn(missing_docs)]
pub struct Material {
    /// The lobes before textures multiply them.
    pub lobes: Lobes,
    /// Textures, each with the slots that it multiplies.
    pub textures: Vec<(Vec<TextureSlot>, Texture)>,
    /// The film layer of its emission.
    pub emission_layer: LayerId,
    /// The formula of the highlight.
    pub highlight: Highlight,
    /// The exponent of the highlight.
    pub shininess: Exponent,
    /// The reflectance formula of the boundary, if it refracts.
    pub fresnel: Fresnel,
    /// What is inside, if it refracts.
    pub medium: Medium,
    /// The depth of the texture of heights, or the factor of that of normals; 0 if there is neither.
    pub relief: ReliefStrength,
}

/// The materials of an object, as indices into the scene's materials.
#[derive(Clone, Copy, Component, Debug, PartialEq, Eq, Content, Hash)]
#[warn(missing_docs)]
pub enum MaterialBinding {
    /// One material for the whole object.
    One(u32),
    /// The materials of a mesh file, in the order of their slots, from index `first` on. The material behind the last
    /// slot is for triangles without a slot.
    Slots {
        /// The index of the material of the first slot.
        first: u32,
        /// The number of slots.
        count: u32,
    },
    /// Materials in slots from index `first` on, the last one at `first + count`, and the material of the faces at which
    /// planes cut the object open.
    Capped {
        /// The index of the material of the first slot.
        first: u32,
        /// The number of slots.
        count: u32,
        /// The index of the material of the cut faces.
        cap: u32,
    },
}

#[warn(missing_docs)]
impl MaterialBinding {
    /// All indices in use.
    pub fn indices(self) -> impl Iterator<Item = u32> {
        match self {
            Self::One(index) => (index..=index).chain(None),
            Self::Slots { first, count } => (first..=first + count).chain(None),
            Self::Capped { first, count, cap } => {
                let is_other = cap < first || first + count < cap;
                (first..=first + count).chain(is_other.then_some(cap))
            }
        }
    }

    /// The same with a material for the faces at which planes cut the object open.
    pub fn capped(self, cap: u32) -> Self {
        match self {
            Self::One(first) => Self::Capped { first, count: 0, cap },
            Self::Slots { first, count } | Self::Capped { first, count, .. } => {
                Self::Capped { first, count, cap }
            }
        }
    }
}

/// The medium inside a refracting surface.
#[derive(Clone, Copy, Debug, PartialEq, Content)]
pub struct Medium {
    /// Index of refraction, above 0.
    pub ior: f64,
    /// Absorption per unit of length. After a distance d, exp(-absorption · d) of the light is left.
    pub absorption: Rgb,
    /// Where media overlap, the one of the highest priority counts.
    pub priority: i32,
}

impl Default for Material {
    /// A black surface.
    fn default() -> Self {
        Self {
            lobes: Lobes::default(),
            textures: Vec::new(),
            emission_layer: LayerId::CONSTANT,
            highlight: Highlight::default(),
            shininess: Exponent::new(0.0),
            fresnel: Fresnel::default(),
            medium: Medium::EMPTY,
            relief: ReliefStrength::default(),
        }
    }
}

#[warn(missing_docs)]
impl Material {
    /// The lobes at points of the surface in the lanes `wanted`. The other lanes are arbitrary.
    #[inline(always)]
    pub fn lobes_at<F: Real>(
        &self,
        context: &TextureEvalContext<'_, F>,
        wanted: F::Mask,
    ) -> PointLobes<F::F32> {
        let (mut lobes, one) = (PointLobes::splat(&self.lobes), F::F32::splat(1.0));
        let mut coverage = one;
        for (slots, texture) in &self.textures {
            if slots.iter().all(|slot| slot.is_relief()) {
                continue;
            }
            let Texel { color, alpha } = texture.at(context, wanted);
            // Alpha of the base colour removes the surface there. Alpha of another texture removes only its lobe.
            let color = match slots.contains(&TextureSlot::Coverage) {
                true => {
                    coverage = alpha;
                    color
                }
                false => color * alpha,
            };
            for slot in slots {
                lobes.tint(*slot, color);
            }
        }
        if (wanted & coverage.lt(one)).any() { lobes.with_coverage(coverage) } else { lobes }
    }

    /// Whether textures turn its normals.
    pub fn has_relief(&self) -> bool {
        self.relief.0 != 0.0
    }

    /// The normal at a point with this unit normal, both in the space of the shape.
    pub fn normal_at(&self, context: &TextureEvalContext<'_>, normal: DVec3) -> DVec3 {
        let mut turned = normal;
        for (slots, texture) in &self.textures {
            match slots[..] {
                [TextureSlot::Height] => turned = relief::raised(texture, self.relief.0, context, normal),
                [TextureSlot::Normal] => turned = relief::mapped(texture, self.relief.0, context, normal),
                _ => {}
            }
        }
        turned
    }

    /// Whether light passes straight through some part of the surface.
    pub fn is_transparent(&self) -> bool {
        self.lobes.transparency != Rgb::ZERO || self.is_cut_out()
    }

    /// Whether a texture's alpha removes parts of the surface.
    pub fn is_cut_out(&self) -> bool {
        self.textures.iter().any(|(slots, _)| slots.contains(&TextureSlot::Coverage))
    }

    /// Whether textures matter for a path that may be reflected or refracted `left` more times. If `left` is 0, only
    /// emission and straight transmission matter.
    pub fn is_textured(&self, left: u32) -> bool {
        let passed = [
            TextureSlot::Emission,
            TextureSlot::Transparency,
            TextureSlot::Refraction,
            TextureSlot::Coverage,
            TextureSlot::Coat,
        ];
        let matters = |slots: &[TextureSlot]| left > 0 || slots.iter().any(|slot| passed.contains(slot));
        self.textures.iter().any(|(slots, _)| matters(slots))
    }

    /// What the textures read at a point. Relief compares points a footprint apart, and normal maps follow u and v.
    pub fn texture_inputs(&self) -> TextureInputs {
        let inputs = self.textures.iter().map(|(slots, texture)| {
            let is_relief = self.has_relief() && slots.iter().all(|slot| slot.is_relief());
            let own = TextureInputs {
                footprint: is_relief,
                uv: is_relief && slots.contains(&TextureSlot::Normal),
                ..TextureInputs::default()
            };
            own | texture.inputs()
        });
        inputs.fold(TextureInputs::default(), |all, one| all | one)
    }

    /// Whether light refracts into the body.
    pub fn refracts(&self) -> bool {
        self.lobes.refraction != Rgb::ZERO
    }

    /// Whether its reflections are scattered, so that they take random samples.
    pub fn is_rough(&self) -> bool {
        let lobes = &self.lobes;
        let fuzzy = lobes.fuzz > 0.0 && lobes.mirror != Rgb::ZERO;
        let rough = lobes.microfacet > 0.0 && lobes.roughness > 0.0;
        fuzzy || rough || (lobes.coat.share > 0.0 && lobes.coat.roughness > 0.0)
    }
}

impl Medium {
    pub const EMPTY: Self = Self { ior: 1.0, absorption: Rgb::ZERO, priority: i32::MIN };
}

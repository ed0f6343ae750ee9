//! Sequences with one change: an effect, a light or an object switched off, or a remedy for fireflies. The difference
//! to the original sequence shows what each of them costs and adds.

use super::layering::Layering;
use crate::appearance::environment::SkyTracks;
use crate::appearance::light::{LightKind, LightTracks};
use crate::appearance::material::{LobeTracks, MaterialTracks, ScalarTextureTracks};
use crate::appearance::texture::TextureTracks;
use crate::base::color::Rgb;
use crate::base::time::Time;
use crate::film::LayerId;
use crate::geometry::shape::Shape;
use crate::sequence::{Object, Sequence};
use crate::track::Animated;

/// How a sequence differs from the file's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SceneChange {
    #[default]
    None,
    /// Lights are assigned to film layers in another way, which does not change the picture.
    Layers(Layering),
    Without(RemovableEffect),
    /// By its index in the sequence.
    LightOff(usize),
    /// By its index in the sequence; its children are hidden too.
    ObjectHidden(usize),
    /// Area lights of twice the size and the same power.
    LargerLights,
}

/// A part of the scene description that a sequence can be rendered without.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RemovableEffect {
    Fog,
    Ambient,
    Background,
    DepthOfField,
    MotionBlur,
    Emission,
    Highlights,
    Mirrors,
    Roughness,
    Transparency,
    Refraction,
    Absorption,
    Textures,
}

impl RemovableEffect {
    pub const ALL: [Self; 13] = [
        Self::Fog,
        Self::Ambient,
        Self::Background,
        Self::DepthOfField,
        Self::MotionBlur,
        Self::Emission,
        Self::Highlights,
        Self::Mirrors,
        Self::Roughness,
        Self::Transparency,
        Self::Refraction,
        Self::Absorption,
        Self::Textures,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::Fog => "fog",
            Self::Ambient => "ambient light",
            Self::Background => "background",
            Self::DepthOfField => "depth of field",
            Self::MotionBlur => "motion blur",
            Self::Emission => "emission",
            Self::Highlights => "highlights",
            Self::Mirrors => "mirrors",
            Self::Roughness => "roughness of mirrors",
            Self::Transparency => "transparency",
            Self::Refraction => "refraction",
            Self::Absorption => "absorption",
            Self::Textures => "textures and patterns",
        }
    }

    fn remove(self, sequence: &mut Sequence) {
        match self {
            Self::Fog => sequence.fog = None,
            Self::Ambient => sequence.ambient = Rgb::ZERO.into(),
            Self::Background => sequence.background.sky = SkyTracks::Constant(Rgb::ZERO.into()),
            Self::DepthOfField => sequence.cameras.iter_mut().for_each(|c| c.value.aperture = 0.0.into()),
            Self::MotionBlur => sequence.cameras.iter_mut().for_each(|c| c.value.shutter = 0.0.into()),
            _ => sequence.materials.iter_mut().for_each(|material| self.remove_from(&mut material.value)),
        }
    }

    fn remove_from(self, material: &mut MaterialTracks) {
        let off = |lobe: &mut LobeTracks| lobe.strength = 0.0.into();
        match self {
            Self::Emission => off(&mut material.emission),
            Self::Highlights => off(&mut material.specular),
            Self::Mirrors => off(&mut material.mirror),
            Self::Roughness => {
                let sharp = || ScalarTextureTracks::Constant(0.0.into());
                (material.fuzz, material.roughness, material.coat_roughness) = (sharp(), sharp(), sharp());
            }
            Self::Transparency => off(&mut material.transparency),
            Self::Refraction => off(&mut material.refraction),
            Self::Absorption => material.absorption = Rgb::ZERO.into(),
            Self::Textures => plain(material),
            Self::Fog | Self::Ambient | Self::Background | Self::DepthOfField | Self::MotionBlur => {}
        }
    }
}

/// Replaces textures by grey, and textures of scalars by 0.5.
fn plain(material: &mut MaterialTracks) {
    const GREY: f32 = 0.5;
    let MaterialTracks { emission, ambient, diffuse, specular, mirror, transparency, refraction, .. } =
        material;
    let lobes = [emission, ambient, diffuse, specular, mirror, transparency, refraction];
    for paint in lobes.into_iter().map(|lobe| &mut lobe.tint).chain([&mut material.base]) {
        if !matches!(paint, TextureTracks::Color(_)) {
            *paint = TextureTracks::Color(Rgb::splat(GREY).into());
        }
    }
    material.relief = None;
    let levels = [&mut material.fuzz, &mut material.metallic, &mut material.roughness];
    for level in levels.into_iter().chain([&mut material.coat, &mut material.coat_roughness]) {
        if matches!(level, ScalarTextureTracks::Textured(_)) {
            *level = ScalarTextureTracks::Constant(f64::from(GREY).into());
        }
    }
}

impl SceneChange {
    /// The sequence with the change; layerings and enlarged lights take their values at `time`.
    pub fn of(self, sequence: &Sequence, time: Time) -> Sequence {
        if let Self::Layers(layering) = self {
            return layering.of(sequence, time);
        }
        let mut sequence = sequence.clone();
        match self {
            Self::None | Self::Layers(_) => {}
            Self::Without(effect) => effect.remove(&mut sequence),
            Self::LightOff(index) => sequence.lights[index].value.on = false.into(),
            Self::ObjectHidden(index) => sequence.objects[index].value.visible = false.into(),
            Self::LargerLights => {
                sequence.lights.iter_mut().for_each(|light| enlarge(&mut light.value, time));
            }
        }
        sequence
    }

    /// The name of what is switched off, for tables.
    pub fn name(self, sequence: &Sequence) -> String {
        match self {
            Self::None => "nothing".to_owned(),
            Self::Layers(_) => "layers of light".to_owned(),
            Self::Without(effect) => effect.name().to_owned(),
            Self::LightOff(index) => format!("light \"{}\"", sequence.lights[index].name),
            Self::ObjectHidden(index) => format!("object \"{}\"", sequence.objects[index].name),
            Self::LargerLights => "area lights of twice the size".to_owned(),
        }
    }

    /// The removal of each effect that the sequence has at a moment.
    pub fn effects(sequence: &Sequence, time: Time) -> Vec<Self> {
        let has = |effect: &RemovableEffect| {
            let mut without = sequence.clone();
            effect.remove(&mut without);
            without != *sequence && effect.shows(sequence, time)
        };
        RemovableEffect::ALL.into_iter().filter(has).map(Self::Without).collect()
    }

    /// The removal of each light that is on at a moment.
    pub fn lights(sequence: &Sequence, time: Time) -> Vec<Self> {
        let shines = |light: &LightTracks| light.on.at(time) && light.intensity.at(time) > 0.0;
        let lights = sequence.lights.iter().enumerate().filter(|(_, light)| shines(&light.value));
        lights.map(|(index, _)| Self::LightOff(index)).collect()
    }

    /// The removal of each object that is visible at a moment.
    pub fn objects(sequence: &Sequence, time: Time) -> Vec<Self> {
        let seen = |object: &Object| object.visible.at(time) && object.shape != Shape::Group;
        let objects = sequence.objects.iter().enumerate().filter(|(_, object)| seen(&object.value));
        objects.map(|(index, _)| Self::ObjectHidden(index)).collect()
    }
}

impl RemovableEffect {
    /// Whether the effect may change the picture at a moment; true if unsure.
    fn shows(self, sequence: &Sequence, time: Time) -> bool {
        let any = |of: &dyn Fn(&MaterialTracks) -> f64| sequence.materials.iter().any(|m| of(&m.value) > 0.0);
        let strength = |lobe: &LobeTracks| lobe.strength.at(time);
        match self {
            Self::Fog => sequence.fog.as_ref().is_some_and(|fog| fog.density.at(time) > 0.0),
            Self::Ambient => any(&|material| strength(&material.ambient)),
            Self::Background => sequence.background.intensity.at(time) > 0.0,
            Self::Emission => any(&|material| strength(&material.emission)),
            Self::Highlights => any(&|material| strength(&material.specular)),
            Self::Mirrors => any(&|material| strength(&material.mirror)),
            Self::Roughness => any(&|material| {
                let coated = f64::from(material.at(time, LayerId::CONSTANT).lobes.coat.share);
                strength(&material.mirror).max(material.microfacet.at(time)).max(coated)
            }),
            Self::Transparency => any(&|material| strength(&material.transparency)),
            Self::Refraction | Self::Absorption => any(&|material| strength(&material.refraction)),
            Self::DepthOfField | Self::MotionBlur | Self::Textures => true,
        }
    }
}

/// Doubles the size of an area light and quarters its radiance.
fn enlarge(light: &mut LightTracks, time: Time) {
    match &mut light.kind {
        LightKind::Sphere { radius, .. } => *radius = (2.0 * radius.at(time)).into(),
        LightKind::Rectangle { corner, u, v, .. } => {
            let (at, across, along) = (corner.at(time), u.at(time), v.at(time));
            *corner = (at - (across + along) * 0.5).into();
            (*u, *v) = ((across * 2.0).into(), (along * 2.0).into());
        }
        LightKind::Point { .. }
        | LightKind::Spot { .. }
        | LightKind::Directional { .. }
        | LightKind::Carried { .. } => return,
    }
    light.intensity = Animated::Constant(0.25 * light.intensity.at(time));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::parse;

    fn sequence() -> Sequence {
        let text = r#"(
            lights: { "a": Point(position: (0, 9, 0)), "b": Sphere(center: (1, 9, 0), radius: 0.5, intensity: 8),
                "c": Point(position: (2, 9, 0), on: false) },
            materials: { "glass": Dielectric(), "plain": (ambient: 0) },
            default_material: (ambient: 0),
            objects: { "ball": (shape: Sphere(), material: "glass"), "floor": (shape: Plane(), material: "plain") },
        )"#;
        parse("test.ron", text).expect("a sequence")
    }

    #[test]
    fn only_existing_effects_are_switched_off() {
        let (sequence, time) = (sequence(), Time::from_integer(0));
        let effects = SceneChange::effects(&sequence, time);
        assert!(effects.contains(&SceneChange::Without(RemovableEffect::Refraction)), "{effects:?}");
        assert!(!effects.contains(&SceneChange::Without(RemovableEffect::Fog)), "{effects:?}");
        assert!(!effects.contains(&SceneChange::Without(RemovableEffect::DepthOfField)), "{effects:?}");
        assert_eq!(
            SceneChange::lights(&sequence, time),
            [SceneChange::LightOff(0), SceneChange::LightOff(1)]
        );
        assert_eq!(SceneChange::objects(&sequence, time).len(), 2);
        assert_eq!(SceneChange::ObjectHidden(0).name(&sequence), "object \"ball\"");
    }

    #[test]
    fn larger_lights_send_out_as_much_light() {
        let time = Time::from_integer(0);
        let larger = SceneChange::LargerLights.of(&sequence(), time);
        let LightKind::Sphere { radius, .. } = &larger.lights[1].value.kind else { panic!("a sphere") };
        assert_eq!((radius.at(time), larger.lights[1].value.intensity.at(time)), (1.0, 2.0));
        assert_eq!(larger.lights[0], sequence().lights[0]);
    }
}

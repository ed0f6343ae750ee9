//! Environments over time.

use super::{CubeMap, Environment, Sky};
use crate::appearance::light_groups::GroupWeight;
use crate::appearance::texture::{Image, SharedAsset};
use crate::base::color::Rgb;
use crate::base::math::{DMat3, DQuat, DVec3};
use crate::base::time::Time;
use crate::film::LayerId;
use crate::geometry::transform::Rotation;
use crate::track::Animated;
use bevy_ecs::component::Component;

/// An environment over time.
#[derive(Clone, Component, Debug, PartialEq)]
pub struct EnvironmentTracks {
    pub sky: SkyTracks,
    /// Factor of its radiance, at least 0.
    pub intensity: Animated<f64>,
    /// The rotation of the sky, with the conventions of objects.
    pub rotation: Rotation,
    /// Whether the sky is first mirrored from front to back.
    pub mirrored: bool,
}

/// A [`Sky`] over time.
#[derive(Clone, Debug, PartialEq)]
pub enum SkyTracks {
    Constant(Animated<Rgb>),
    /// Along the unit vector `up`.
    Gradient {
        bottom: Animated<Rgb>,
        top: Animated<Rgb>,
        up: DVec3,
    },
    CubeMap(SharedAsset<CubeMap>),
    Equirect(SharedAsset<Image>),
}

impl From<SkyTracks> for EnvironmentTracks {
    fn from(sky: SkyTracks) -> Self {
        let rotation = Rotation::Quaternion(DQuat::IDENTITY.into());
        Self { sky, intensity: 1.0.into(), rotation, mirrored: false }
    }
}

/// The same colour everywhere.
impl From<Animated<Rgb>> for EnvironmentTracks {
    fn from(color: Animated<Rgb>) -> Self {
        SkyTracks::Constant(color).into()
    }
}

impl From<Rgb> for EnvironmentTracks {
    fn from(color: Rgb) -> Self {
        Animated::from(color).into()
    }
}

impl EnvironmentTracks {
    /// Whether any of its images has alpha, which a sky ignores.
    pub fn has_alpha(&self) -> bool {
        match &self.sky {
            SkyTracks::Equirect(image) => image.has_alpha(),
            SkyTracks::CubeMap(map) => map.has_alpha,
            SkyTracks::Constant(_) | SkyTracks::Gradient { .. } => false,
        }
    }

    /// The keyed weight of this environment: its keyed intensity, and the keyed colour of a constant sky. Other keys
    /// change the environment itself.
    pub fn group_weight(&self) -> GroupWeight {
        let keyed_color = |color: &Animated<Rgb>| color.is_keyed().then(|| color.clone());
        let color = if let SkyTracks::Constant(color) = &self.sky { keyed_color(color) } else { None };
        let intensity = self.intensity.is_keyed().then(|| self.intensity.clone());
        GroupWeight { on: None, intensity, color }
    }

    /// The environment at a moment, without its keyed weight. `layer` is the layer of
    /// [`EnvironmentTracks::group_weight`].
    pub fn at(&self, time: Time, layer: LayerId) -> Environment {
        let strength =
            if let Animated::Constant(intensity) = self.intensity { intensity as f32 } else { 1.0 };
        let mirror = if self.mirrored { DVec3::new(1.0, 1.0, -1.0) } else { DVec3::ONE };
        let from_world = DMat3::from_diagonal(mirror) * self.rotation.at(time).transpose();
        Environment { sky: self.sky.at(time), from_world, strength, layer }
    }
}

impl SkyTracks {
    fn at(&self, time: Time) -> Sky {
        let positive = |color: &Animated<Rgb>| color.at(time).max(Rgb::ZERO);
        match self {
            Self::Constant(Animated::Constant(color)) => Sky::Constant(*color),
            Self::Constant(Animated::Keyed(_)) => Sky::Constant(Rgb::ONE),
            Self::Gradient { bottom, top, up } => {
                Sky::Gradient { bottom: positive(bottom), top: positive(top), up: *up }
            }
            Self::CubeMap(map) => Sky::CubeMap(map.clone()),
            Self::Equirect(image) => Sky::Equirect(image.clone()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::math::Angle;
    use crate::track::{Ease, Key, Repeat, Track};

    fn keyed<T: crate::track::Animate>(from: T, to: T) -> Animated<T> {
        let key = |time: i128, value| Key { time: Time::from_integer(time), value, ease: Ease::Linear };
        let track = Track::new(vec![key(0, from), key(2, to)], Repeat::Hold, false);
        Animated::Keyed(track.expect("a track"))
    }

    fn radiance(environment: &Environment, direction: DVec3) -> Rgb {
        environment.radiance::<f64>(direction.into()).into()
    }

    fn at(tracks: &EnvironmentTracks, second: i128) -> Environment {
        tracks.at(Time::from_integer(second), LayerId(3))
    }

    #[test]
    fn constant_skies_are_weighted_by_their_keys() {
        let tracks =
            EnvironmentTracks { intensity: 2.0.into(), ..EnvironmentTracks::from(keyed(Rgb::ZERO, Rgb::X)) };
        assert_eq!(tracks.group_weight().at(Time::from_integer(1)), Rgb::X * 0.5);
        assert_eq!(at(&tracks, 0), at(&tracks, 1), "the environment itself does not change");
        assert_eq!(radiance(&at(&tracks, 1), DVec3::Y), Rgb::splat(2.0));
        assert!(EnvironmentTracks::from(Rgb::X).group_weight().is_constant());
    }

    #[test]
    fn images_are_faded_by_their_layer_and_turned_by_themselves() {
        let image = Image::new(4, 1, vec![Rgb::X, Rgb::Y, Rgb::Z, Rgb::ONE]).expect("an image");
        let tracks = EnvironmentTracks {
            intensity: keyed(0.0, 2.0),
            rotation: Rotation::AxisAngle { axis: DVec3::Y.into(), angle: keyed(Angle(0.0), Angle(180.0)) },
            ..SkyTracks::Equirect(SharedAsset::new(image)).into()
        };
        assert_eq!(tracks.group_weight().at(Time::from_integer(1)), Rgb::ONE);
        let ahead = |degrees: f64| DVec3::new(Angle(degrees).cos_sin().y, 0.0, -Angle(degrees).cos_sin().x);
        assert_eq!(radiance(&at(&tracks, 0), ahead(45.0)), Rgb::Z);
        // After a turn of 90 degrees to the left, the right part is ahead.
        assert_eq!(radiance(&at(&tracks, 1), ahead(-45.0)), Rgb::Z);
        assert_eq!(at(&tracks, 1).layer, LayerId(3));
    }

    #[test]
    fn keyed_gradients_change_without_a_weight() {
        let (bottom, top) = (keyed(Rgb::ZERO, Rgb::ONE), Rgb::ONE.into());
        let tracks = EnvironmentTracks::from(SkyTracks::Gradient { bottom, top, up: DVec3::Y });
        assert!(tracks.group_weight().is_constant());
        assert_eq!(radiance(&at(&tracks, 1), DVec3::NEG_Y), Rgb::splat(0.5));
    }
}

//! Lights over time.

use super::{Attenuation, Source, SpotCone};
use crate::appearance::light_groups::GroupWeight;
use crate::base::color::Rgb;
use crate::base::math::{Angle, DAffine3, DVec3};
use crate::base::time::Time;
use crate::geometry::carrier::Carrier;
use crate::geometry::shape::{Rectangle, Sphere};
use crate::track::{Animated, Switch};
use bevy_ecs::component::Component;

/// A light over time.
#[derive(Clone, Component, Debug, PartialEq)]
#[warn(missing_docs)]
pub struct LightTracks {
    /// Its shape and position.
    pub kind: LightKind,
    /// The colour that `intensity` scales.
    pub color: Animated<Rgb>,
    /// At least 0. For its unit, see [`Light::radiance`](super::Light::radiance).
    pub intensity: Animated<f64>,
    /// The keys that switch it.
    pub on: Switch,
    /// Whether objects block its light. They always do for area lights.
    pub shadows: bool,
}

/// A [`Source`] over time.
#[derive(Clone, Debug, PartialEq)]
#[warn(missing_docs)]
pub enum LightKind {
    /// Light from one point, the same in all directions.
    Point {
        /// The point.
        position: Animated<DVec3>,
        /// What is left at a distance.
        attenuation: Attenuation,
    },
    /// Light from one point into a cone.
    Spot {
        /// The point.
        position: Animated<DVec3>,
        /// A point on the axis of the cone.
        target: Animated<DVec3>,
        /// Full angles of the outer cone, which ends the light, and of the inner cone, which has full light.
        angle: Animated<Angle>,
        /// The full angle of the cone of full light; that of the outer cone if absent.
        inner_angle: Option<Animated<Angle>>,
        /// What is left at a distance.
        attenuation: Attenuation,
    },
    /// Light from infinitely far away.
    Directional {
        /// The direction in which the light travels, of any length.
        direction: Animated<DVec3>,
    },
    /// Every point of a sphere emits outwards.
    Sphere {
        /// The centre of the sphere.
        center: Animated<DVec3>,
        /// The radius of the sphere.
        radius: Animated<f64>,
    },
    /// Every point of a rectangle emits.
    Rectangle {
        /// A corner of the rectangle.
        corner: Animated<DVec3>,
        /// One of the sides at the corner.
        u: Animated<DVec3>,
        /// The other side at the corner.
        v: Animated<DVec3>,
        /// Whether only the side of `u` × `v` emits.
        one_sided: bool,
    },
    /// A point, spot or directional light in the space of an object, which carries it.
    Carried {
        /// The light in the space of the object.
        kind: Box<LightKind>,
        /// What carries it.
        carrier: Carrier,
    },
}

/// Least radius of a sphere light. An easing may overshoot to a radius of 0 or less.
const MIN_RADIUS: f64 = 1e-30;

#[warn(missing_docs)]
impl LightKind {
    /// Whether the light may move, turn or change its size over time.
    pub fn is_keyed(&self) -> bool {
        match self {
            Self::Point { position, attenuation: _ } => position.is_keyed(),
            Self::Spot { position, target, angle, inner_angle, attenuation: _ } => {
                let inner = inner_angle.as_ref().is_some_and(Animated::is_keyed);
                position.is_keyed() || target.is_keyed() || angle.is_keyed() || inner
            }
            Self::Directional { direction } => direction.is_keyed(),
            Self::Sphere { center, radius } => center.is_keyed() || radius.is_keyed(),
            Self::Rectangle { corner, u, v, one_sided: _ } => {
                corner.is_keyed() || u.is_keyed() || v.is_keyed()
            }
            Self::Carried { kind, carrier } => kind.is_keyed() || carrier.is_keyed(),
        }
    }

    /// The light at a time.
    pub fn at(&self, time: Time) -> Source {
        match self {
            Self::Point { position, attenuation } => {
                Source::Point { position: position.at(time), attenuation: *attenuation }
            }
            Self::Spot { position, target, angle, inner_angle, attenuation } => {
                let position = position.at(time);
                let cos_falloff_end = half_cosine(angle.at(time));
                let start = inner_angle.as_ref().map_or(cos_falloff_end, |inner| half_cosine(inner.at(time)));
                // If the target is at the light's position, the light points downwards.
                let axis = (target.at(time) - position).normalize_or(DVec3::NEG_Y);
                let cone = SpotCone { axis, cos_falloff_start: start.max(cos_falloff_end), cos_falloff_end };
                Source::Spot { position, cone, attenuation: *attenuation }
            }
            Self::Directional { direction } => {
                Source::Directional { to_light: -direction.at(time).normalize_or(DVec3::NEG_Y) }
            }
            Self::Sphere { center, radius } => {
                Source::Sphere(Sphere { center: center.at(time), radius: radius.at(time).max(MIN_RADIUS) })
            }
            Self::Rectangle { corner, u, v, one_sided } => {
                let rectangle = Rectangle { corner: corner.at(time), u: u.at(time), v: v.at(time) };
                Source::Rectangle { rectangle, one_sided: *one_sided }
            }
            Self::Carried { kind, carrier } => carried(kind.at(time), &carrier.rigid_at(time)),
        }
    }
}

/// A point, spot or directional light after a map that only turns and moves.
fn carried(source: Source, map: &DAffine3) -> Source {
    let turned = |direction: DVec3| (map.matrix3 * direction).normalize();
    match source {
        Source::Point { position, attenuation } => {
            Source::Point { position: map.transform_point3(position), attenuation }
        }
        Source::Spot { position, cone, attenuation } => {
            let cone = SpotCone { axis: turned(cone.axis), ..cone };
            Source::Spot { position: map.transform_point3(position), cone, attenuation }
        }
        Source::Directional { to_light } => Source::Directional { to_light: -turned(-to_light) },
        Source::Sphere(_) | Source::Rectangle { .. } => source,
    }
}

/// Cosine of half an angle in 0..=360 degrees.
fn half_cosine(angle: Angle) -> f64 {
    Angle(angle.0.clamp(0.0, 360.0) * 0.5).cos_sin().x
}

#[warn(missing_docs)]
impl LightTracks {
    /// The keyed weight of this light. Lights with equal weights share a layer.
    pub fn group_weight(&self) -> GroupWeight {
        GroupWeight::split(&self.on, &self.intensity, &self.color).1
    }

    /// The product of the constant factors.
    pub fn constant_radiance(&self) -> Rgb {
        GroupWeight::split(&self.on, &self.intensity, &self.color).0
    }
}

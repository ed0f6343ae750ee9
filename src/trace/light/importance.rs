//! How much light sources may give at points: an estimate for the choice of one, without shadows.

use super::sampled_emitter::SampledEmitter;
use crate::appearance::light::{Attenuation, Source, SpotCone};
use crate::base::color::Rgb;
use crate::base::lanes::{Real, Row, Single, Vec3};
use crate::base::math::{Aabb, DVec3};
use crate::geometry::shape::Rectangle;
use crate::scene::Scene;
use std::f64::consts::PI;

/// An estimate of the light of a source on surfaces that face it. At least 0.
#[derive(Clone, Copy, Debug)]
pub enum Importance {
    /// The same everywhere.
    Distant(f64),
    Point {
        position: DVec3,
        attenuation: Attenuation,
        brightness: f64,
        /// None if the light is the same in all directions.
        cone: Option<SpotCone>,
    },
    Area {
        center: DVec3,
        /// The power over π that is seen from far away, at its brightest.
        brightness: f64,
        /// The least square of the distance. Nearer to the centre, it is this.
        least_square: f64,
        facing: Facing,
    },
}

/// The directions in which areas emit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Facing {
    All,
    /// To the side of the normal of a plane.
    Front(DVec3),
    /// To both sides of a plane.
    Both(DVec3),
}

impl Importance {
    pub fn of(emitter: &SampledEmitter, scene: &Scene) -> Self {
        match emitter {
            SampledEmitter::Light(_, light, _) => {
                let brightness = brightness(light.radiance);
                match light.source {
                    Source::Directional { .. } => Self::Distant(brightness),
                    Source::Point { position, attenuation } => {
                        Self::Point { position, attenuation, brightness, cone: None }
                    }
                    Source::Spot { position, cone, attenuation } => {
                        Self::Point { position, attenuation, brightness, cone: Some(cone) }
                    }
                    Source::Sphere(sphere) => {
                        let least_square = sphere.radius * sphere.radius;
                        let brightness = brightness * least_square;
                        Self::Area { center: sphere.center, brightness, least_square, facing: Facing::All }
                    }
                    Source::Rectangle { rectangle, one_sided } => {
                        Self::flat(&rectangle, brightness, one_sided)
                    }
                }
            }
            SampledEmitter::Object(index, _) => {
                let primitive = &scene.geometry.primitives[*index as usize];
                let emission = primitive.material(0).map_or(0.0, |material| {
                    brightness(scene.shading.materials[material as usize].lobes.emission)
                });
                // What has an area has bounds.
                let bounds = primitive.bounds().unwrap_or(Aabb { min: DVec3::ZERO, max: DVec3::ZERO });
                Self::Area {
                    center: bounds.center(),
                    // What convex surfaces show on average is a quarter of their area (Cauchy).
                    brightness: emission * bounds.area() / (4.0 * PI),
                    least_square: 0.25 * bounds.size().length_squared(),
                    facing: Facing::All,
                }
            }
            SampledEmitter::Sky(table) => {
                let strength = f64::from(scene.shading.environment.strength);
                Self::Distant(brightness(Rgb::ONE) * strength * table.mean())
            }
        }
    }

    /// Where the source is, if its light falls with the square of the distance.
    pub fn place(&self) -> Option<DVec3> {
        match self {
            Self::Point { position, attenuation, .. } if attenuation.quadratic > 0.0 => Some(*position),
            Self::Distant(_) | Self::Point { .. } => None,
            Self::Area { center, .. } => Some(*center),
        }
    }

    /// What it may give far away: times the square of the distance, if its light falls with that.
    pub fn far_light(&self) -> f64 {
        match self {
            Self::Point { attenuation, brightness, .. } if attenuation.quadratic > 0.0 => {
                brightness / attenuation.quadratic
            }
            Self::Distant(brightness) | Self::Point { brightness, .. } | Self::Area { brightness, .. } => {
                *brightness
            }
        }
    }

    /// The square of the distance below which it gives no more.
    pub fn least_square(&self) -> f64 {
        match self {
            Self::Point { attenuation, .. } if attenuation.quadratic > 0.0 => 1.0 / attenuation.quadratic,
            Self::Distant(_) | Self::Point { .. } => 0.0,
            Self::Area { least_square, .. } => *least_square,
        }
    }

    /// The directions in which it emits, but for cones.
    pub fn facing(&self) -> Facing {
        match self {
            Self::Distant(_) | Self::Point { .. } => Facing::All,
            Self::Area { facing, .. } => *facing,
        }
    }

    fn flat(rectangle: &Rectangle, brightness: f64, one_sided: bool) -> Self {
        let Rectangle { corner, u, v } = *rectangle;
        let normal = rectangle.normal();
        Self::Area {
            center: corner + 0.5 * (u + v),
            brightness: brightness * u.cross(v).length() / PI,
            least_square: 0.25 * (u + v).length_squared().min((u - v).length_squared()),
            facing: if one_sided { Facing::Front(normal) } else { Facing::Both(normal) },
        }
    }

    /// The estimates at points. Those of areas have the precision and the range of f32.
    #[inline(always)]
    pub fn at<F: Real>(&self, point: Vec3<F>) -> F {
        let zero = F::F32::splat(0.0);
        match self {
            Self::Distant(brightness) => F::splat(*brightness),
            Self::Point { position, attenuation, brightness, cone } => {
                let way = Vec3::splat(*position) - point;
                let share = F::splat(*brightness) * attenuation.share(way.length());
                match cone {
                    Some(cone) => {
                        let to_light = way.normalize_or(Vec3::zero());
                        share * cone.share(-to_light.dot(Vec3::splat(cone.axis)))
                    }
                    None => share,
                }
            }
            Self::Area { center, brightness, least_square, facing } => {
                let way = point - Vec3::splat(*center);
                let square = way.dot(way).max(F::splat(*least_square)).to_f32();
                let light = F::F32::splat(*brightness as f32) / square;
                let light = match facing {
                    Facing::All => light,
                    Facing::Front(normal) => {
                        light / square.sqrt() * way.dot(Vec3::splat(*normal)).to_f32().max(zero)
                    }
                    Facing::Both(normal) => {
                        light / square.sqrt() * way.dot(Vec3::splat(*normal)).to_f32().abs()
                    }
                };
                light.to_f64()
            }
        }
    }
}

fn brightness(color: Rgb) -> f64 {
    f64::from(color.element_sum())
}

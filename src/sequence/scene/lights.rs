//! Lights of a scene.
//!
//! A surface that faces a point light of intensity 1 without attenuation shows its own colour: it receives an irradiance
//! of π. So radiant intensity I, at the distance d, is the intensity I / π with the attenuation 1 / d².

use crate::appearance::light::{Attenuation, LightKind, LightTracks};
use crate::base::math::{Angle, DVec3};
use crate::import::gltf::{GltfLight, GltfLightKind};
use crate::sequence::values::LARGEST;
use std::f64::consts::PI;

/// The unit of the numbers in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightUnit {
    /// Candela and lux, as the extension says.
    Photometric,
    /// Watts per steradian and watts per square metre.
    Radiometric,
}

impl LightUnit {
    /// Lumens per watt of light of 555 nm, by which exporters convert (683 lm/W, the definition of the candela).
    pub const LUMENS_PER_WATT: f64 = 683.0;
}

/// Attenuation never brightens. So the light of 1 / d² is `NEAR` times as strong at the distance 1 and fades by
/// 1 / (`NEAR` d²), which is exact from the distance 1 / √`NEAR` on.
const NEAR: f64 = 1e4;

/// Whether a light is so bright that sums of its light overflow.
pub fn is_too_bright(light: &LightTracks) -> bool {
    let color = light.color.peak(|color| f64::from(color.abs().max_element()));
    let intensity = light.intensity.peak(|intensity| intensity.abs());
    // False for numbers that are none, too.
    !(color <= LARGEST && intensity <= LARGEST && color * intensity <= LARGEST)
}

/// What an intensity of 1 of a light in a file comes to.
pub fn factor(kind: GltfLightKind, unit: LightUnit) -> f64 {
    let watts = match unit {
        LightUnit::Photometric => 1.0 / LightUnit::LUMENS_PER_WATT,
        LightUnit::Radiometric => 1.0,
    };
    match kind {
        GltfLightKind::Directional => watts / PI,
        GltfLightKind::Point | GltfLightKind::Spot { .. } => NEAR * watts / PI,
    }
}

/// A light at the origin of its object, which shines along its -z.
pub fn light(given: &GltfLight, unit: LightUnit) -> LightTracks {
    let intensity = given.intensity * factor(given.kind, unit);
    let attenuation = Attenuation { constant: 0.0, linear: 0.0, quadratic: NEAR };
    let position = DVec3::ZERO.into();
    let kind = match given.kind {
        GltfLightKind::Point => LightKind::Point { position, attenuation },
        GltfLightKind::Directional => LightKind::Directional { direction: DVec3::NEG_Z.into() },
        GltfLightKind::Spot { inner, outer } => {
            let angle = |half: f64| Angle((2.0 * half).to_degrees()).into();
            let (target, angle, inner_angle) = (DVec3::NEG_Z.into(), angle(outer), Some(angle(inner)));
            LightKind::Spot { position, target, angle, inner_angle, attenuation }
        }
    };
    LightTracks {
        kind,
        color: given.color.as_vec3().into(),
        intensity: intensity.into(),
        on: true.into(),
        shadows: true,
    }
}

//! Lights of the extension `KHR_lights_punctual`.

use super::GltfResult;
use super::json::Item;
use crate::base::math::DVec3;
use std::f64::consts::{FRAC_PI_4, PI};

/// The extension.
pub const LIGHTS: &str = "KHR_lights_punctual";

/// A light at the origin of its node, which shines along the -z axis.
#[derive(Clone, Debug, PartialEq)]
pub struct GltfLight {
    /// Empty if it has none.
    pub name: String,
    pub kind: GltfLightKind,
    /// Linear.
    pub color: DVec3,
    /// Luminous intensity in candela, or illuminance in lux for directional lights.
    pub intensity: f64,
}

/// The kind of a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GltfLightKind {
    Point,
    /// Angles between the axis and the edges of the cone of full light, and of the cone of any light, in radians.
    Spot {
        inner: f64,
        outer: f64,
    },
    Directional,
}

/// Reads all lights.
pub fn lights(root: &Item<'_>) -> GltfResult<Vec<GltfLight>> {
    let Some(item) = root.extension(LIGHTS)? else { return Ok(Vec::new()) };
    item.list("lights")?.iter().map(light).collect()
}

fn light(item: &Item<'_>) -> GltfResult<GltfLight> {
    let kind = match item.text("type")? {
        Some("point") => GltfLightKind::Point,
        Some("directional") => GltfLightKind::Directional,
        Some("spot") => spot(item)?,
        _ => return Err(item.error("its `type` is none of point, spot and directional")),
    };
    let name = item.name()?;
    let color = DVec3::from_array(item.color("color", [1.0; 3])?);
    Ok(GltfLight { name, kind, color, intensity: item.not_negative("intensity", 1.0)? })
}

fn spot(item: &Item<'_>) -> GltfResult<GltfLightKind> {
    let (mut inner, mut outer) = (0.0, FRAC_PI_4);
    if let Some(spot) = item.object("spot")? {
        inner = spot.not_negative("innerConeAngle", inner)?;
        outer = spot.not_negative("outerConeAngle", outer)?;
    }
    // Some exporters write two equal angles for a sharp edge.
    if inner > outer {
        let why = format!("its `innerConeAngle` {inner} is above its `outerConeAngle` {outer}");
        return Err(item.error(why));
    }
    // Half a turn is all directions. In floats, it may be a little more.
    if outer as f32 > PI as f32 {
        return Err(
            item.error(format!("its `outerConeAngle` {outer} is above half a turn; it is in radians"))
        );
    }
    Ok(GltfLightKind::Spot { inner: inner.min(PI), outer: outer.min(PI) })
}

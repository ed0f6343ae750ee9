//! Lights, in world space.

use super::Exporter;
use super::keys::Keys;
use super::nodes::{Placed, quaternion};
use crate::appearance::light::{Attenuation, LightKind, LightTracks, Source};
use crate::base::color::Rgb;
use crate::base::math::{Angle, Basis, DMat3, DQuat, DVec3, look_at};
use crate::base::time::Time;
use crate::geometry::shape::Shape;
use crate::sequence::LightUnit;
use crate::track::Animated;
use serde_json::{Map, Value, json};
use std::f64::consts::PI;

impl Exporter<'_> {
    /// Adds the lights. Those with an area become shapes that emit.
    pub fn lights(&mut self) {
        for light in &self.sequence.lights {
            let start = self.sequence.timeline.clock(0).time;
            match light.value.kind.at(start) {
                Source::Point { position, attenuation } => {
                    self.note_angles(&light.value.kind);
                    let factor = self.point_factor(attenuation, position);
                    self.punctual(&light.name, &light.value, json!({ "type": "point" }), factor);
                }
                Source::Spot { position, cone, attenuation } => {
                    self.note_angles(&light.value.kind);
                    let half = |cosine: f64| libm::acos(cosine.clamp(-1.0, 1.0));
                    // Readers ask for two different angles, and a cone of at most half of all directions.
                    let outer = half(cone.cos_falloff_end).min(0.5 * PI);
                    let inner = half(cone.cos_falloff_start).min(outer.next_down());
                    let spot = json!({ "innerConeAngle": inner, "outerConeAngle": outer });
                    let factor = self.point_factor(attenuation, position);
                    self.punctual(&light.name, &light.value, json!({ "type": "spot", "spot": spot }), factor);
                }
                Source::Directional { .. } => {
                    let factor = PI * self.per_watt();
                    self.punctual(&light.name, &light.value, json!({ "type": "directional" }), factor);
                }
                Source::Sphere(_) | Source::Rectangle { .. } => self.area_light(&light.name, &light.value),
            }
        }
    }

    /// The number that a watt comes to in the unit of the file.
    fn per_watt(&self) -> f64 {
        match self.options.light_unit {
            LightUnit::Photometric => LightUnit::LUMENS_PER_WATT,
            LightUnit::Radiometric => 1.0,
        }
    }

    /// What an intensity of 1 comes to, for a light from a point. glTF's lights fade with the square of the distance.
    /// Others are as bright at the origin of the scene.
    fn point_factor(&mut self, attenuation: Attenuation, position: DVec3) -> f64 {
        let Attenuation { constant, linear, quadratic } = attenuation;
        if constant == 0.0 && linear == 0.0 && quadratic > 0.0 {
            return PI * self.per_watt() / quadratic;
        }
        self.left_out.note_of("the exact attenuation", "light");
        let distance = position.length().max(1e-3 * self.extent());
        PI * self.per_watt() * attenuation.share(distance) * distance * distance
    }

    fn punctual(&mut self, name: &str, light: &LightTracks, mut given: Value, factor: f64) {
        let timeline = &self.sequence.timeline;
        let start = timeline.clock(0).time;
        // The switch is part of the intensity.
        let steps = light.on.is_keyed();
        let level = |time: Time| match light.on.at(time) {
            true => light.intensity.at(time).max(0.0) * factor,
            false => 0.0,
        };
        let levels = match light.on.parts() {
            [] => Keys::of(&light.intensity, timeline).map(|keys| keys.scaled(factor, &[0.0])),
            [on] if on.is_keyed() && !light.intensity.is_keyed() => {
                let brightness = light.intensity.at(start).max(0.0) * factor;
                Keys::of(on, timeline).map(|keys| keys.scaled(brightness, &[0.0]))
            }
            _ => Keys::sampled(timeline, steps, false, |time| vec![level(time)]),
        };
        let colors = Keys::of(&light.color, timeline);
        given["name"] = json!(name);
        given["intensity"] = json!(level(start));
        // Readers ask for colours in 0..=1. Brighter ones go into the intensity, unless keys change them.
        let color = light.color.at(start).max(Rgb::ZERO).as_dvec3();
        given["color"] = json!(color.to_array());
        if !light.shadows {
            self.left_out.note_of("`shadows: false`", "light");
        }
        let index = self.document.push_light(given);
        for (keys, property) in [(levels, "intensity"), (colors, "color")] {
            if let Some(keys) = keys {
                let sampler = keys.sampler(&mut self.document);
                let pointer = format!("/extensions/KHR_lights_punctual/lights/{index}/{property}");
                self.document.animate_pointer(&pointer, sampler);
            }
        }
        let placed = self.light_place(&light.kind);
        let extension = json!({ "KHR_lights_punctual": { "light": index } });
        self.node(name, &placed, Map::from_iter([("extensions".into(), extension)]), None);
    }

    /// Adds a shape that emits. Its place is that of the start.
    fn area_light(&mut self, name: &str, light: &LightTracks) {
        let start = self.sequence.timeline.clock(0).time;
        let shape = match light.kind.at(start) {
            Source::Sphere(sphere) => Shape::Sphere(sphere),
            Source::Rectangle { rectangle, .. } => Shape::Rectangle(rectangle),
            _ => return,
        };
        if light.kind.is_keyed() {
            self.left_out.note_of("the motion", "area light");
        }
        let material = self.emitter(name, light);
        let Some(mesh) = self.single_mesh(&shape, material) else { return };
        self.node(name, &Placed::at(DVec3::ZERO), Map::from_iter([("mesh".into(), json!(mesh))]), None);
    }

    /// The place and the direction of a light.
    fn light_place(&self, kind: &LightKind) -> Placed {
        let timeline = &self.sequence.timeline;
        let place = |time: Time| match kind.at(time) {
            Source::Point { position, .. } | Source::Spot { position, .. } => position,
            _ => DVec3::ZERO,
        };
        let turn = |time: Time| match kind.at(time) {
            Source::Spot { cone, .. } => towards(cone.axis),
            Source::Directional { to_light } => towards(-to_light),
            _ => DQuat::IDENTITY,
        };
        let moved = match kind {
            LightKind::Point { position, .. } | LightKind::Spot { position, .. } => {
                Keys::of(position, timeline)
            }
            _ => Keys::sampled(timeline, false, false, |time| place(time).to_array().to_vec()),
        };
        let turned = Keys::sampled(timeline, false, true, |time| turn(time).to_array().to_vec());
        let start = timeline.clock(0).time;
        let keys = [moved, turned, None];
        Placed { translation: place(start), rotation: turn(start), scale: DVec3::ONE, keys }
    }

    fn note_angles(&mut self, kind: &LightKind) {
        if let LightKind::Spot { angle, inner_angle, .. } = kind {
            let keyed = angle.is_keyed() || inner_angle.as_ref().is_some_and(Animated::<Angle>::is_keyed);
            if keyed {
                self.left_out.note_of("keyed cones", "light");
            }
        }
    }
}

/// The rotation of -z to a direction.
fn towards(direction: DVec3) -> DQuat {
    let Some(Basis { right, up, forward }) = look_at(DVec3::ZERO, direction, DVec3::Y) else {
        return DQuat::IDENTITY;
    };
    quaternion(&DMat3::from_cols(right, up, -forward))
}

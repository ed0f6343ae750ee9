//! The state of a session as JSON, for the page.

use super::session::Session;
use crate::base::time::Time;
use crate::sequence::Sequence;
use crate::sequence::quality::Integrator;
use serde_json::{Value, json};

impl Session {
    /// What the picture is, and what is still to come.
    pub fn state(&mut self) -> Value {
        let diagnostics = self.diagnostics().map(str::to_owned);
        let mut state = json!({
            "generation": self.generation,
            "file": self.options.file.to_string_lossy(),
            "edit": self.options.edit,
            "frame": self.frame,
            "diagnostics": diagnostics,
            "camera_moved": self.view.is_some(),
            "parallel": self.view.as_ref().is_some_and(|view| view.is_parallel()),
            "heat": self.heat.map(|heat| heat.name()),
            "heat_scale": self.heat_scale().map(|(from, to)| [from, to]),
            "films": self.films(),
            "first_ms": self.first_picture.map(|time| time.as_secs_f64() * 1e3),
            "rays": self.counts.rays.total(),
            "tracing_seconds": self.tracing.as_secs_f64(),
        });
        let Some((frame, _)) = self.current() else { return state };
        let most = self.most_samples(&frame);
        let weights = self.weights(&frame);
        let film = self.film.as_ref().map(|(_, film)| film);
        let done = film.and_then(|film| film.done());
        let error = film.filter(|_| frame.random).and_then(|film| film.error(&weights));
        let Some(scene) = &self.scene else { return state };
        let sequence = &scene.sequence;
        let start = sequence.timeline.clock(frame.frame).start;
        let more = json!({
            "time": seconds(start),
            "size": [sequence.output.size.0, sequence.output.size.1],
            "reduced": scene.reduced,
            "samples": done.map_or(0, |done| done.samples),
            "stride": done.map_or(0, |done| done.stride()),
            "most": most,
            "random": frame.random,
            "moments": frame.moments,
            "error": error,
            "target": sequence.quality.noise.map(|target| target.error),
            "bounces": sequence.quality.bounces,
            "antialias": sequence.quality.antialias,
            "quality_samples": sequence.quality.samples,
            "lights": self.lights(sequence, start),
            "changed": self.changes(),
        });
        if let (Value::Object(state), Value::Object(more)) = (&mut state, more) {
            state.extend(more);
        }
        state
    }

    /// The names of settings that the session changes.
    fn changes(&self) -> Vec<&'static str> {
        let set = &self.overrides;
        let changes = [
            ("lights", !set.lights.is_empty()),
            ("size", set.size != self.options.size),
            ("bounces", set.bounces.is_some()),
            ("antialias", set.antialias.is_some()),
            ("samples", set.samples.is_some()),
            ("camera", self.view.is_some()),
        ];
        changes.into_iter().filter(|(_, is_set)| *is_set).map(|(name, _)| name).collect()
    }

    fn lights(&self, sequence: &Sequence, time: Time) -> Vec<Value> {
        let light = |light: &crate::sequence::Named<crate::appearance::light::LightTracks>| {
            let own = light.value.on.at(time);
            let changed = self.overrides.lights.get(&light.name);
            json!({
                "name": light.name,
                "on": changed.unwrap_or(&own),
                "changed": changed.is_some(),
                "intensity": light.value.intensity.at(time),
                "color": light.value.color.at(time).to_array(),
            })
        };
        sequence.lights.iter().map(light).collect()
    }

    /// The description of the sequence, which changes only with the file.
    pub fn info(&self) -> Value {
        let Some(sequence) = &self.loaded else { return json!({ "generation": self.generation }) };
        let timeline = &sequence.timeline;
        json!({
            "generation": self.generation,
            "name": sequence.name,
            "frames": timeline.frames,
            "fps": seconds(timeline.rate.per_second()),
            "duration": seconds(timeline.duration),
            "size": [sequence.output.size.0, sequence.output.size.1],
            "integrator": match sequence.quality.integrator {
                Integrator::Whitted => "whitted",
                Integrator::Path(_) => "path",
            },
            "objects": sequence.objects.len(),
            "outputs": sequence.output.files.iter().map(ToString::to_string).collect::<Vec<_>>(),
            "notes": sequence.notes(),
            "curves": super::curves::curves(sequence),
        })
    }
}

fn seconds(time: Time) -> f64 {
    *time.numer() as f64 / *time.denom() as f64
}

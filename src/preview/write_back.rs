//! Changes of the page, written into the user's file.

use super::camera::{ViewCamera, number};
use super::command::LightField;
use super::session::Session;
use super::{edit, places};
use crate::encode::write_file;
use crate::sequence::{Sequence, load_text};
use std::sync::Arc;

impl Session {
    /// Writes the camera of the session into the file.
    pub fn write_camera(&mut self) -> Result<(), String> {
        let view = self.view.clone().ok_or("the camera was not moved")?;
        let sequence = self.loaded.clone().ok_or("there is no sequence")?;
        let [camera] = &sequence.cameras[..] else {
            return Err("the file has several cameras; copy the text and place it by hand".to_owned());
        };
        ViewCamera::may_replace(&camera.value)?;
        let text = self.file_text()?;
        let fields = view.fields(sequence.up);
        let written = match places::find(&text, &["camera"]) {
            None => edit::with_value(
                &text,
                &["camera"],
                view.ron(sequence.up).trim_start_matches("camera: ").trim_end_matches(','),
            ),
            Some(_) => fields
                .iter()
                .filter(|(name, _)| *name != "projection" || view.path().lens != camera.value.lens)
                .try_fold(text.clone(), |text, (name, value)| {
                    edit::with_value(&text, &["camera", name], value)
                }),
        }?;
        self.write(&written)?;
        self.view = None;
        Ok(())
    }

    /// Writes a field of a light into the file.
    pub fn write_light(&mut self, index: usize, field: &LightField) -> Result<(), String> {
        let sequence = self.loaded.clone().ok_or("there is no sequence")?;
        let light = sequence.lights.get(index).ok_or("there is no such light")?;
        let tracks = &light.value;
        let (name, value, is_keyed) = match field {
            LightField::On(on) => ("on", on.to_string(), tracks.on.is_keyed()),
            LightField::Intensity(intensity) => {
                ("intensity", number(*intensity), tracks.intensity.is_keyed())
            }
            LightField::Color(color) => ("color", format!("{color:?}"), tracks.color.is_keyed()),
        };
        if is_keyed {
            return Err(format!("`{name}` of {} has keys; change them in the file", light.name));
        }
        let written = edit::with_value(&self.file_text()?, &["lights", &light.name, name], &value)?;
        self.write(&written)?;
        let mut overrides = self.overrides.clone();
        if overrides.lights.remove(&light.name).is_some() {
            self.set_overrides(overrides);
        }
        Ok(())
    }

    fn file_text(&self) -> Result<String, String> {
        if !self.options.edit {
            return Err("the preview was started without --edit".to_owned());
        }
        std::fs::read_to_string(&self.options.file).map_err(|error| error.to_string())
    }

    /// Writes the user's file, unless the new text has mistakes.
    fn write(&mut self, text: &str) -> Result<(), String> {
        let file = self.options.file.clone();
        self.parse(text).map_err(|error| format!("this would be a mistake in the file: {error}"))?;
        // Links stay links.
        let target = file.canonicalize().map_err(|error| error.to_string())?;
        write_file(&target, text.as_bytes()).map_err(|error| error.to_string())?;
        self.reload();
        Ok(())
    }

    /// The sequence that a text in place of the file would give.
    fn parse(&self, text: &str) -> Result<Sequence, String> {
        let root = self.root();
        load_text(&self.options.file, text, root, &Arc::default()).map_err(|error| error.render(false))
    }
}

//! Notes about images whose alpha is ignored.

use crate::appearance::material::ScalarTextureTracks;
use crate::sequence::suggest::{listed, shortened};
use crate::sequence::{Named, Sequence};

impl Sequence {
    /// Images whose alpha is ignored, or has an effect that may not be intended.
    pub(super) fn ignored_alpha(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if self.background.has_alpha() {
            notes.push("the alpha of the images of `background` is ignored: skies have none".to_owned());
        }
        for Named { name, value } in self.used_materials() {
            let levels = [
                ("fuzz", &value.fuzz),
                ("metallic", &value.metallic),
                ("roughness", &value.roughness),
                ("coat", &value.coat),
                ("coat_roughness", &value.coat_roughness),
            ];
            let textured = |level: &ScalarTextureTracks| matches!(level, ScalarTextureTracks::Textured(paint) if paint.has_alpha());
            let fields: Vec<_> =
                levels.iter().filter(|(_, level)| textured(level)).map(|(name, _)| *name).collect();
            let name = shortened(name);
            if !fields.is_empty() {
                let fields = listed(fields);
                notes.push(format!(
                    "material `{name}`: the alpha of the images of {fields} is ignored: numbers have none"
                ));
            }
            if value.base.has_alpha() && value.refraction.strength.values().any(|share| *share > 0.0) {
                notes.push(format!(
                    "material `{name}`: where the image of `color` is clear, light enters the refracting body without \
                     bending, unlike through a real hole; put the image on another object"
                ));
            }
        }
        notes
    }
}

//! "Did you mean": finds the nearest known name.

pub use crate::base::lists::{either, listed, shortened};

/// Maximum number of names that are compared for one suggestion.
const COMPARED: usize = 2000;

/// The candidate that `wrong` most likely means. None if all are too different.
pub fn nearest<'n>(wrong: &str, candidates: impl IntoIterator<Item = &'n str>) -> Option<&'n str> {
    if wrong.len() > 100 {
        return None;
    }
    // Any two names of one letter are near each other, so a suggestion would be meaningless.
    if wrong.chars().count() < 2 {
        return None;
    }
    let lower = wrong.to_lowercase();
    let allowed = (wrong.chars().count() / 3).max(1);
    candidates
        .into_iter()
        .take(COMPARED)
        .filter(|name| name.len() <= 120)
        .map(|name| (distance(&lower, &name.to_lowercase()), name.len().abs_diff(wrong.len()), name))
        .filter(|(distance, ..)| *distance <= allowed)
        .min_by_key(|(distance, longer, _)| (*distance, *longer))
        .map(|(.., name)| name)
}

/// What other programs call the things that have a name here. In each row, all words mean the same.
const SYNONYMS: [&[&str]; 17] = [
    &["translation", "position", "location", "translate", "pos"],
    &["target", "look_at", "lookat", "aim"],
    &["rotation", "rotate", "orientation"],
    &["color", "colour", "albedo", "base_color", "pigment"],
    &["emission", "emissive", "glow", "emit"],
    &["intensity", "strength", "power", "energy", "brightness"],
    &["ior", "refractive_index", "index_of_refraction", "eta"],
    &["fov", "field_of_view"],
    &["samples", "spp"],
    &["fuzz", "roughness"],
    &["fps", "frame_rate", "framerate"],
    &["visible", "show", "enabled"],
    &["box", "cube", "cuboid", "brick"],
    &["dielectric", "glass"],
    &["lambertian", "matte", "matt", "diffuse"],
    &["directional", "sun", "distant"],
    &["point", "omni", "bulb"],
];

/// The candidate that other programs call `wrong`.
pub fn synonym<'n>(wrong: &str, candidates: impl IntoIterator<Item = &'n str>) -> Option<&'n str> {
    let wrong = wrong.to_lowercase();
    let row = SYNONYMS.iter().find(|row| row.contains(&wrong.as_str()))?;
    candidates.into_iter().find(|name| row.contains(&name.to_lowercase().as_str()))
}

/// Edit distance of two names. A name that only has more letters in front or behind counts as near.
fn distance(a: &str, b: &str) -> usize {
    let (short, long) = if a.len() < b.len() { (a, b) } else { (b, a) };
    if short.len() >= 3 && (long.starts_with(short) || long.ends_with(short)) {
        return 1 + (long.len() - short.len()) / 8;
    }
    strsim::damerau_levenshtein(a, b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_slips_and_nothing_else() {
        let names = ["radius", "center", "material", "Sphere", "EaseIn", "InOutQuad", "fov"];
        let near = |wrong| nearest(wrong, names);
        assert_eq!(near("raduis"), Some("radius"));
        assert_eq!(near("centre"), Some("center"));
        assert_eq!(near("sphere"), Some("Sphere"));
        assert_eq!(near("mat"), Some("material"));
        assert_eq!(near("fow"), Some("fov"));
        assert_eq!(near("EaseInOutQuad"), Some("InOutQuad"));
        assert_eq!(near("torus"), None);
        assert_eq!(near(""), None);
    }

    #[test]
    fn knows_what_others_call_it() {
        let names = ["Box", "Sphere", "translation", "color"];
        let meant = |wrong| synonym(wrong, names);
        assert_eq!((meant("position"), meant("Cube")), (Some("translation"), Some("Box")));
        assert_eq!((meant("ior"), meant("torus"), meant("")), (None, None, None));
    }
}

//! The scene, with one effect at a time.

use kinora::sequence::{Sequence, parse};

/// What an effect changes in the scene: fields of the sequence, of the ball's material, and the lamp.
#[derive(Debug)]
pub struct Case {
    pub name: &'static str,
    pub about: &'static str,
    fields: &'static str,
    camera: &'static str,
    lamp: &'static str,
    ball: &'static str,
    /// Of the ball's object.
    object: &'static str,
}

const LAMP: &str = r#""lamp": Point(position: (4, 6, 5))"#;

const PLAIN: Case = Case {
    name: "plain",
    about: "a matt ball and floor, one point light",
    fields: "",
    camera: "",
    lamp: LAMP,
    ball: "(color: \"#c8503a\")",
    object: "",
};

const fn fields(name: &'static str, about: &'static str, fields: &'static str) -> Case {
    Case { name, about, fields, ..PLAIN }
}

const fn camera(name: &'static str, about: &'static str, camera: &'static str) -> Case {
    Case { name, about, camera, ..PLAIN }
}

const fn lamp(name: &'static str, about: &'static str, lamp: &'static str) -> Case {
    Case { name, about, lamp, ..PLAIN }
}

const fn ball(name: &'static str, about: &'static str, ball: &'static str) -> Case {
    Case { name, about, ball, ..PLAIN }
}

/// What effects cost.
pub const CASES: &[Case] = &[
    PLAIN,
    lamp("no-light", "ambient light only, no shadow rays", ""),
    lamp(
        "two-lights",
        "a second point light",
        r#""lamp": Point(position: (4, 6, 5)), "fill": Point(position: (-5, 4, 4), intensity: 0.4)"#,
    ),
    lamp(
        "attenuation",
        "light that fades with distance",
        r#""lamp": Point(position: (4, 6, 5), intensity: 6, attenuation: (constant: 1, quadratic: 0.08))"#,
    ),
    lamp(
        "spot",
        "a spot light with a soft edge",
        r#""lamp": Spot(position: (4, 6, 5), target: (0, 1, 0), angle: 40, inner_angle: 20)"#,
    ),
    lamp(
        "area-light",
        "a light with an area: random samples and soft shadows",
        r#""lamp": Sphere(center: (4, 6, 5), radius: 0.8, intensity: 110)"#,
    ),
    ball("highlight", "a highlight", "(color: \"#c8503a\", specular: 0.6, shininess: 40)"),
    ball("mirror", "a sharp mirror", "(color: \"#c8503a\", diffuse: 0.4, mirror: 0.5)"),
    ball("fuzzy-mirror", "a mirror that scatters", "Metal(color: (0.85, 0.6, 0.4), fuzz: 0.2)"),
    ball(
        "rough",
        "the metallic-roughness model",
        "MetallicRoughness(color: \"#c8503a\", metallic: 0.6, roughness: 0.4)",
    ),
    ball(
        "transparency",
        "transparency, also in shadows",
        "(color: \"#c8503a\", diffuse: 0.4, transparency: 0.6)",
    ),
    ball("refraction", "glass, with Fresnel's reflection", "Dielectric()"),
    ball("absorption", "glass that absorbs", "Dielectric(absorption: (0.2, 0.9, 0.9))"),
    ball("emission", "a ball that emits light", "(color: \"#c8503a\", emission: 0.5)"),
    ball("pattern", "a checker", "(color: Checker(a: \"#c8503a\", b: \"#f0e0c0\", scale: 0.4))"),
    ball("noise", "marble of four octaves", "(color: Marble(a: \"#c8503a\", b: \"#f0e0c0\", scale: 0.5))"),
    ball("texture", "an image over u and v", "(color: Image(\"assets/textures/planet.png\"))"),
    fields("sky", "a gradient instead of a plain background", "background: Gradient(),"),
    fields("fog", "uniform fog", "fog: (density: 0.06, color: 0.7),"),
    fields(
        "fog-height",
        "fog that thins with height",
        "fog: (density: 0.2, color: 0.7, falloff: (height: 0.8)),",
    ),
    camera("orthographic", "an orthographic camera", "projection: Orthographic(height: 5.2),"),
    camera("lens", "depth of field: random samples", "aperture: 0.4,"),
    Case {
        name: "motion-blur",
        about: "an open shutter while the ball moves: random samples at sixteen moments",
        camera: "shutter: 1,",
        object: "translation: [(0, (-0.5, 0, 0)), (0.04166, (0.5, 0, 0))],",
        ..PLAIN
    },
    fields(
        "paths",
        "path tracing with three bounces",
        "quality: (antialias: 4, samples: 16, bounces: 3, shutter_steps: 16, integrator: Path),",
    ),
];

/// Effects that are written down, and have no strength.
pub const IDLE: &[Case] = &[
    ball(
        "idle-mirror",
        "a mirror that reflects nothing",
        "(color: \"#c8503a\", mirror: 0, mirror_color: (1, 0, 0))",
    ),
    ball(
        "idle-highlight",
        "a highlight of zero strength",
        "(color: \"#c8503a\", specular: 0, shininess: 40)",
    ),
    ball(
        "idle-transparency",
        "transparency of zero",
        "(color: \"#c8503a\", transparency: 0, transparency_color: (1, 0, 0))",
    ),
    ball(
        "idle-refraction",
        "refraction of zero",
        "(color: \"#c8503a\", refraction: 0, ior: 2, absorption: 3, fresnel: Exact)",
    ),
    ball("idle-emission", "emission of zero", "(color: \"#c8503a\", emission: 0, emission_color: (9, 9, 9))"),
    ball("idle-fuzz", "a rough mirror that reflects nothing", "(color: \"#c8503a\", mirror: 0, fuzz: 0.5)"),
    lamp(
        "idle-light",
        "a second point light of zero intensity",
        r#""lamp": Point(position: (4, 6, 5)), "fill": Point(position: (-5, 4, 4), intensity: 0)"#,
    ),
    lamp(
        "idle-switch",
        "a second point light, switched off",
        r#""lamp": Point(position: (4, 6, 5)), "fill": Point(position: (-5, 4, 4), on: false)"#,
    ),
    fields("idle-fog", "fog of zero density", "fog: (density: 0, color: 0.7, falloff: (height: 0.8)),"),
    camera("idle-lens", "an aperture of 0", "aperture: 0, focus: 3,"),
    camera("idle-shutter", "a closed shutter", "shutter: 0,"),
    Case { name: "idle-motion", about: "an open shutter without motion", camera: "shutter: 1,", ..PLAIN },
];

impl Case {
    /// The scene with the effect, or what keeps it from being one.
    pub fn sequence(&self, size: (u32, u32)) -> Result<Sequence, String> {
        let Self { fields, camera, lamp, ball, object, .. } = self;
        let default = "quality: (antialias: 4, samples: 16, bounces: 3, shutter_steps: 16),";
        let quality = if fields.contains("quality:") { "" } else { default };
        let background = if fields.contains("background:") { "" } else { "background: (0.35, 0.5, 0.7)," };
        let text = format!(
            "(timeline: (frames: 1), output: (size: ({}, {}), png: (metadata: false)), {quality} {background} {fields}
            camera: (position: (0, 2.2, 7), target: (0, 0.9, 0), {camera}), lights: {{ {lamp} }},
            default_material: (ambient: 0.2),
            objects: {{
                \"floor\": (shape: Plane(), material: (color: 0.6)),
                \"ball\": (shape: Sphere(center: (0, 1, 0)), material: {ball}, {object}),
            }})",
            size.0, size.1
        );
        parse("effects.ron", &text).map_err(|faults| format!("{}: {faults}", self.name))
    }
}

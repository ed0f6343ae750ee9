//! What the page may ask for, read from JSON.

use super::heat::HeatKind;
use serde_json::Value;

/// A change of the session, or a question.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    Frame(u32),
    Play {
        from: u32,
        to: u32,
        repeats: bool,
        /// Factor on the frame rate.
        speed: f64,
    },
    Pause,
    /// Switches a light, or returns it to the file.
    Light {
        index: usize,
        on: Option<bool>,
    },
    Size(Option<(u32, u32)>),
    Bounces(Option<u32>),
    Antialias(Option<u32>),
    Samples(Option<u32>),
    Camera(CameraMove),
    /// Returns everything to the file.
    Reset,
    Heat(Option<HeatKind>),
    /// The description of the sequence.
    Info,
    Pick {
        x: u32,
        y: u32,
    },
    CopyCamera,
    CopyKey,
    /// The place of a value in the files, by the names that lead to it.
    Place(Vec<String>),
    Forecast,
    Render {
        from: u32,
    },
    StopRender,
    WriteCamera,
    /// Writes a field of a light.
    WriteLight {
        index: usize,
        field: LightField,
    },
}

/// A field of a light with its value.
#[derive(Clone, Debug, PartialEq)]
pub enum LightField {
    On(bool),
    Intensity(f64),
    Color(String),
}

/// A move of the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CameraMove {
    /// Around the target, in radians: right, up.
    Orbit(f64, f64),
    /// In heights of the picture: right, up.
    Pan(f64, f64),
    /// In distances to the target: forward, right, up.
    Step(f64, f64, f64),
    /// Factor of the distance to the target.
    Dolly(f64),
    /// Factor of the height of the picture.
    Zoom(f64),
    Projection,
    Reset,
}

/// Most names of a place, and the longest.
const MOST_NAMES: usize = 8;
const LONGEST_NAME: usize = 500;

/// The largest picture, in pixels along a side; the most bounces, samples and antialiasing.
const MOST_SIDE: u64 = 16_384;
const MOST_BOUNCES: u64 = 1000;
const MOST_ANTIALIAS: u64 = 64;
const MOST_SAMPLES: u64 = 1 << 24;

impl Command {
    /// Reads a command. The message of an error says what is wrong.
    pub fn parse(text: &[u8]) -> Result<Self, String> {
        let value: Value =
            serde_json::from_slice(text).map_err(|error| format!("this is no JSON: {error}"))?;
        let what = value.get("do").and_then(Value::as_str).ok_or("`do` is missing")?;
        Ok(match what {
            "frame" => Self::Frame(small(&value, "frame", u64::from(u32::MAX))?),
            "play" => Self::Play {
                from: small(&value, "from", u64::from(u32::MAX))?,
                to: small(&value, "to", u64::from(u32::MAX))?,
                repeats: value.get("loop").and_then(Value::as_bool).unwrap_or(false),
                speed: value.get("speed").and_then(Value::as_f64).unwrap_or(1.0),
            },
            "pause" => Self::Pause,
            "light" => Self::Light {
                index: small(&value, "index", u64::from(u32::MAX))? as usize,
                on: value.get("on").and_then(Value::as_bool),
            },
            "size" => Self::Size(size(&value)?),
            "bounces" => Self::Bounces(optional(&value, 0, MOST_BOUNCES)?),
            "antialias" => Self::Antialias(optional(&value, 1, MOST_ANTIALIAS)?),
            "samples" => Self::Samples(optional(&value, 1, MOST_SAMPLES)?),
            "camera" => Self::Camera(camera(&value)?),
            "reset" => Self::Reset,
            "heat" => Self::Heat(value.get("kind").and_then(Value::as_str).and_then(HeatKind::named)),
            "info" => Self::Info,
            "pick" => Self::Pick { x: small(&value, "x", MOST_SIDE)?, y: small(&value, "y", MOST_SIDE)? },
            "copy-camera" => Self::CopyCamera,
            "copy-key" => Self::CopyKey,
            "place" => Self::Place(names(&value)?),
            "forecast" => Self::Forecast,
            "render" => Self::Render { from: small(&value, "from", u64::from(u32::MAX))? },
            "stop-render" => Self::StopRender,
            "write-camera" => Self::WriteCamera,
            "write-light" => Self::WriteLight {
                index: small(&value, "index", u64::from(u32::MAX))? as usize,
                field: light_field(&value)?,
            },
            _ => return Err("`do` is none of the commands".to_owned()),
        })
    }
}

/// A whole number from 0 to `most`.
fn small(value: &Value, name: &str, most: u64) -> Result<u32, String> {
    let number = value.get(name).and_then(Value::as_u64).filter(|number| *number <= most);
    number.map(|number| number as u32).ok_or_else(|| format!("`{name}` must be a whole number up to {most}"))
}

/// The number `value` within bounds, or none.
fn optional(value: &Value, least: u64, most: u64) -> Result<Option<u32>, String> {
    match value.get("value") {
        None | Some(Value::Null) => Ok(None),
        Some(_) => small(value, "value", most).map(|number| Some(number.max(least as u32))),
    }
}

fn size(value: &Value) -> Result<Option<(u32, u32)>, String> {
    if value.get("width").is_none_or(Value::is_null) {
        return Ok(None);
    }
    let (width, height) = (small(value, "width", MOST_SIDE)?, small(value, "height", MOST_SIDE)?);
    if width == 0 || height == 0 { Err("a picture has pixels".to_owned()) } else { Ok(Some((width, height))) }
}

fn camera(value: &Value) -> Result<CameraMove, String> {
    let number = |name: &str| value.get(name).and_then(Value::as_f64).filter(|number| number.is_finite());
    let by = |name: &str| number(name).unwrap_or(0.0).clamp(-100.0, 100.0);
    let factor = number("factor").filter(|factor| (1e-3..=1e3).contains(factor));
    let factor = || factor.ok_or("`factor` must be from 0.001 to 1000".to_owned());
    match value.get("move").and_then(Value::as_str) {
        Some("orbit") => Ok(CameraMove::Orbit(by("x"), by("y"))),
        Some("pan") => Ok(CameraMove::Pan(by("x"), by("y"))),
        Some("step") => Ok(CameraMove::Step(by("z"), by("x"), by("y"))),
        Some("dolly") => Ok(CameraMove::Dolly(factor()?)),
        Some("zoom") => Ok(CameraMove::Zoom(factor()?)),
        Some("projection") => Ok(CameraMove::Projection),
        Some("reset") => Ok(CameraMove::Reset),
        _ => Err("`move` is none of the moves".to_owned()),
    }
}

fn names(value: &Value) -> Result<Vec<String>, String> {
    let list = value.get("names").and_then(Value::as_array).filter(|list| list.len() <= MOST_NAMES);
    let list = list.ok_or("`names` must be a short list")?;
    let text = |name: &Value| name.as_str().filter(|name| name.len() <= LONGEST_NAME).map(str::to_owned);
    list.iter().map(text).collect::<Option<_>>().ok_or_else(|| "`names` must be short texts".to_owned())
}

fn light_field(value: &Value) -> Result<LightField, String> {
    let given = value.get("value");
    match value.get("field").and_then(Value::as_str) {
        Some("on") => {
            given.and_then(Value::as_bool).map(LightField::On).ok_or("`on` is true or false".to_owned())
        }
        Some("intensity") => given
            .and_then(Value::as_f64)
            .filter(|number| number.is_finite() && *number >= 0.0)
            .map(LightField::Intensity)
            .ok_or("`intensity` is a number of at least 0".to_owned()),
        Some("color") => {
            let is_hex = |text: &&str| {
                text.len() == 7
                    && text.starts_with('#')
                    && text[1..].bytes().all(|byte| byte.is_ascii_hexdigit())
            };
            let color = given.and_then(Value::as_str).filter(is_hex);
            color.map(|color| LightField::Color(color.to_owned())).ok_or("`color` is \"#rrggbb\"".to_owned())
        }
        _ => Err("`field` is on, intensity or color".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Result<Command, String> {
        Command::parse(text.as_bytes())
    }

    #[test]
    fn commands_are_read() {
        assert_eq!(parsed(r#"{"do":"frame","frame":3}"#), Ok(Command::Frame(3)));
        assert_eq!(parsed(r#"{"do":"bounces","value":null}"#), Ok(Command::Bounces(None)));
        assert_eq!(parsed(r#"{"do":"antialias","value":0}"#), Ok(Command::Antialias(Some(1))));
        assert_eq!(
            parsed(r#"{"do":"camera","move":"orbit","x":0.1,"y":-0.2}"#),
            Ok(Command::Camera(CameraMove::Orbit(0.1, -0.2)))
        );
        let field = LightField::Color("#ff8800".to_owned());
        assert_eq!(
            parsed(r##"{"do":"write-light","index":1,"field":"color","value":"#ff8800"}"##),
            Ok(Command::WriteLight { index: 1, field })
        );
    }

    #[test]
    fn wrong_commands_are_refused() {
        for text in [
            "",
            "[]",
            "{}",
            r#"{"do":3}"#,
            r#"{"do":"delete"}"#,
            r#"{"do":"frame"}"#,
            r#"{"do":"frame","frame":-1}"#,
            r#"{"do":"frame","frame":1e99}"#,
            r#"{"do":"size","width":0,"height":4}"#,
            r#"{"do":"size","width":99999,"height":4}"#,
            r#"{"do":"camera","move":"dolly","factor":0}"#,
            r#"{"do":"place","names":["a","a","a","a","a","a","a","a","a"]}"#,
            r##"{"do":"write-light","index":1,"field":"color","value":"#ff\")("}"##,
        ] {
            assert!(parsed(text).is_err(), "{text}");
        }
    }
}

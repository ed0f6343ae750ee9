//! MTL files: the materials of OBJ files, as they are written.

use super::lines::{Lines, numbers, parsed, split_word, unexpected, words};
use crate::base::color::Rgb;
use crate::base::math::DVec2;
use crate::geometry::mesh::{Map, MapChannel, MapUse, MeshError, MtlMaterial};
use std::io::BufRead;

/// Values that other programs read but this reader does not. It reports them.
const LEFT_OUT: [&str; 14] = [
    "Tf", "map_Ns", "map_Tr", "disp", "map_disp", "decal", "refl", "map_refl", "Ps", "aniso", "anisor",
    "map_Ps", "map_Pc", "map_Pcr",
];

/// Images, by the names of their statements.
const MAPS: [(&str, MapUse); 10] = [
    ("map_Ka", MapUse::Ambient),
    ("map_Kd", MapUse::Diffuse),
    ("map_Ks", MapUse::Specular),
    ("map_Ke", MapUse::Emission),
    ("map_d", MapUse::Opacity),
    ("map_Bump", MapUse::Bump),
    ("bump", MapUse::Bump),
    ("norm", MapUse::Normal),
    ("map_Pr", MapUse::Roughness),
    ("map_Pm", MapUse::Metallic),
];

/// Options of images that would change the picture but are not read.
const OPTIONS_LEFT_OUT: [(&[u8], &str); 3] = [(b"-mm", "-mm"), (b"-t", "-t"), (b"-cc", "-cc")];

const CHANNELS: [(&[u8], MapChannel); 5] = [
    (b"r", MapChannel::Red),
    (b"g", MapChannel::Green),
    (b"b", MapChannel::Blue),
    (b"m", MapChannel::Alpha),
    (b"l", MapChannel::Grey),
];

/// Reads the materials of an MTL file. Unknown lines are skipped.
pub fn read(input: impl BufRead) -> Result<Vec<MtlMaterial>, MeshError> {
    let mut lines = Lines::new(input, true);
    let mut materials: Vec<MtlMaterial> = Vec::new();
    while let Some((number, line)) = lines.next()? {
        let (word, rest) = split_word(line);
        if word == b"newmtl" {
            if rest.is_empty() {
                return Err(unexpected(number, line, "a name after `newmtl`"));
            }
            let name = String::from_utf8_lossy(rest).into_owned();
            materials.push(MtlMaterial { name, ..MtlMaterial::default() });
        } else if let Some(material) = materials.last_mut() {
            material.line(word, rest).map_err(|what| unexpected(number, line, what))?;
        } else if is_known(word) {
            return Err(unexpected(number, line, "`newmtl` and a name before the first value"));
        }
    }
    materials.iter_mut().for_each(MtlMaterial::finish);
    Ok(materials)
}

fn is_known(word: &[u8]) -> bool {
    matches!(word, b"Ka" | b"Kd" | b"Ks" | b"Ke" | b"Ns" | b"Ni" | b"d" | b"Tr" | b"illum")
        || matches!(word, b"Pr" | b"Pm" | b"Pc" | b"Pcr")
        || map_use(word).is_some()
}

/// What the image of a statement is for, with the name of the statement.
fn map_use(word: &[u8]) -> Option<(&'static str, MapUse)> {
    MAPS.into_iter().find(|(name, _)| name.as_bytes().eq_ignore_ascii_case(word))
}

impl MtlMaterial {
    /// Reads one line. The error says what would be right.
    fn line(&mut self, word: &[u8], rest: &[u8]) -> Result<(), &'static str> {
        match word {
            b"Ka" => self.ambient = Some(color(rest)?),
            b"Kd" => self.diffuse = Some(color(rest)?),
            b"Ks" => self.specular = Some(color(rest)?),
            b"Ke" => self.emission = Some(color(rest)?),
            b"Ns" => {
                let shininess = Some(number(rest)?).filter(|value| *value >= 0.0);
                self.shininess = Some(shininess.ok_or("a number of 0 or more")?);
            }
            b"Ni" => self.ior = Some(Some(number(rest)?).filter(|ior| *ior > 0.0).ok_or("a number above 0")?),
            // `d -halo 0.5` fades towards the rim. Only the number is read.
            b"d" => self.opacity = Some(share(rest.strip_prefix(b"-halo").unwrap_or(rest))?),
            b"Tr" => self.opacity = Some(1.0 - share(rest)?),
            b"illum" => {
                let model = words(rest).next().and_then(parsed);
                self.model = Some(model.ok_or("a whole number after `illum`")?);
            }
            // The format states no range for these, and exporters write others.
            b"Pr" => self.roughness = Some(number(rest)?.clamp(0.0, 1.0)),
            b"Pm" => self.metallic = Some(number(rest)?.clamp(0.0, 1.0)),
            b"Pc" => self.coat = Some(number(rest)?.clamp(0.0, 1.0)),
            b"Pcr" => self.coat_roughness = Some(number(rest)?.clamp(0.0, 1.0)),
            // A white filter has no effect.
            b"Tf" if color(rest) == Ok(Rgb::ONE) => {}
            _ if let Some((name, usage)) = map_use(word) => match self.read_map(rest)? {
                Some(map) => {
                    self.maps.retain(|(other, _)| *other != usage);
                    self.maps.push((usage, map));
                }
                None if usage == MapUse::Diffuse => return Err("the name of an image after `map_Kd`"),
                None => self.leave_out(name),
            },
            _ => {
                let known = LEFT_OUT.into_iter().find(|name| name.as_bytes().eq_ignore_ascii_case(word));
                known.into_iter().for_each(|name| self.leave_out(name));
            }
        }
        Ok(())
    }

    /// Drops `map_d` if it names the image of `map_Kd`: exporters then mean its alpha, which is read with its
    /// colours.
    fn finish(&mut self) {
        let Some(color) = self.map(MapUse::Diffuse).map(|map| map.file.clone()) else { return };
        let means_alpha = |map: &Map| map.channel.is_none_or(|channel| channel == MapChannel::Alpha);
        self.maps.retain(|(usage, map)| *usage != MapUse::Opacity || map.file != color || !means_alpha(map));
    }

    /// The ambient reflectance that the file intends; `None` if it intends nothing. Exporters without ambient light
    /// write white, or repeat the diffuse reflectance. Black is intended.
    pub fn effective_ambient(&self) -> Option<Rgb> {
        let said = |color: &Rgb| *color != Rgb::ONE && Some(*color) != self.diffuse;
        self.ambient.filter(|color| *color == Rgb::ZERO || said(color))
    }

    fn leave_out(&mut self, name: &'static str) {
        if !self.left_out.contains(&name) {
            self.left_out.push(name);
        }
    }

    /// Reads an image: its options, and then its name, which may contain blanks. None without a name.
    fn read_map(&mut self, mut rest: &[u8]) -> Result<Option<Map>, &'static str> {
        let mut map = Map {
            file: String::new(),
            scale: DVec2::ONE,
            offset: DVec2::ZERO,
            clamps: false,
            strength: 1.0,
            channel: None,
        };
        loop {
            let (option, after) = split_word(rest);
            let most = match option {
                b"-o" | b"-s" | b"-t" => 3,
                b"-mm" => 2,
                [b'-', letter, ..] if letter.is_ascii_alphabetic() => 1,
                _ => break,
            };
            let (values, after) = option_values(after, most);
            match option {
                b"-o" => map.offset = pair(&values, 0.0).ok_or("finite numbers after `-o`")?,
                b"-s" => {
                    let scale =
                        pair(&values, 1.0).filter(|scale| scale.abs().min_element() >= SMALLEST_SCALE);
                    map.scale = scale.ok_or("finite numbers other than 0 after `-s`")?;
                }
                b"-clamp" => map.clamps = values == [b"on"],
                b"-bm" => {
                    let strength = values.first().and_then(|value| parsed::<f64>(value));
                    let strength = strength.filter(|value| value.abs() <= 1e30);
                    map.strength = strength.ok_or("a finite number after `-bm`")?;
                }
                b"-imfchan" => {
                    let known = CHANNELS.iter().find(|(name, _)| values == [*name]);
                    map.channel = known.map(|(_, channel)| *channel);
                    if known.is_none() {
                        self.leave_out("-imfchan");
                    }
                }
                _ => {
                    let known = OPTIONS_LEFT_OUT.iter().find(|(name, _)| *name == option);
                    known.into_iter().for_each(|(_, name)| self.leave_out(name));
                }
            }
            rest = after;
        }
        map.file = path(rest);
        Ok((!map.file.is_empty()).then_some(map))
    }
}

/// The path of a file, with `/` between folders.
fn path(rest: &[u8]) -> String {
    String::from_utf8_lossy(rest).replace('\\', "/")
}

/// The smallest scale. The reciprocals of smaller ones could overflow.
const SMALLEST_SCALE: f64 = 1e-30;

/// Up to `most` values of an option, and the rest of the line. The first word is always a value; further values are
/// numbers.
fn option_values(mut rest: &[u8], most: usize) -> (Vec<&[u8]>, &[u8]) {
    let mut values = Vec::new();
    while values.len() < most {
        let (value, after) = split_word(rest);
        if value.is_empty() || (!values.is_empty() && parsed::<f64>(value).is_none()) {
            break;
        }
        values.push(value);
        rest = after;
    }
    (values, rest)
}

/// The first two numbers of an option. If there is only one, the second is `otherwise`.
fn pair(values: &[&[u8]], otherwise: f64) -> Option<DVec2> {
    let (numbers, count) = numbers::<2>(values.iter().copied())?;
    let pair = match count {
        0 => return None,
        1 => DVec2::new(numbers[0], otherwise),
        _ => DVec2::from_array(numbers),
    };
    (pair.abs().max_element() <= 1e30).then_some(pair)
}

fn number(rest: &[u8]) -> Result<f32, &'static str> {
    let value = words(rest).next().and_then(parsed::<f32>).filter(|value| value.is_finite());
    value.ok_or("a finite number")
}

/// Reads a number from 0 to 1.
fn share(rest: &[u8]) -> Result<f32, &'static str> {
    Some(number(rest)?).filter(|value| (0.0..=1.0).contains(value)).ok_or("a number from 0 to 1")
}

/// Reads three numbers, or one for grey.
fn color(rest: &[u8]) -> Result<Rgb, &'static str> {
    let color = match numbers::<3>(words(rest)) {
        Some((rgb, 3)) => Some(Rgb::from_array(rgb.map(|part| part as f32))),
        Some(([grey, ..], 1)) => Some(Rgb::splat(grey as f32)),
        _ => None,
    };
    color.filter(|color| color.is_finite()).ok_or("three finite numbers, red, green and blue")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_read_as_written() {
        let text = "# a comment\r\nnewmtl red paint\r\n Kd 0.8 0.1 0.05\nKa 0.5\nNs 96\nNi 1.5\nillum 2\n\
                    Tr 0.25\nsharpness 60\nmap_Kd -s 1 1 -o 0.5 -clamp on tex\\red brick.png\n\
                    newmtl b\nd 0.5 # half\nKe 1 2 3";
        let materials = read(text.as_bytes()).expect("materials");
        let [red, b] = &materials[..] else { panic!("{materials:?}") };
        assert_eq!(red.name, "red paint");
        assert_eq!(red.diffuse, Some(Rgb::new(0.8, 0.1, 0.05)));
        assert_eq!(red.ambient, Some(Rgb::splat(0.5)));
        assert_eq!((red.shininess, red.ior, red.opacity), (Some(96.0), Some(1.5), Some(0.75)));
        assert_eq!((red.model, red.specular), (Some(2), None));
        let map = red.map(MapUse::Diffuse).expect("an image");
        assert_eq!((map.file.as_str(), map.clamps), ("tex/red brick.png", true));
        assert_eq!((map.scale, map.offset), (DVec2::ONE, DVec2::new(0.5, 0.0)));
        assert_eq!((b.opacity, b.emission), (Some(0.5), Some(Rgb::new(1.0, 2.0, 3.0))));
    }

    #[test]
    fn options_of_images_are_read_or_reported() {
        let map = |options: &str| {
            let text = format!("newmtl a\nmap_Kd {options} a.png");
            let material = read(text.as_bytes()).expect("a material").remove(0);
            (material.map(MapUse::Diffuse).expect("an image").clone(), material.left_out)
        };
        let (placed, left_out) = map("-s 2 -3 1 -blendu on -o 0.5 -clamp off");
        assert_eq!((placed.scale, placed.offset), (DVec2::new(2.0, -3.0), DVec2::new(0.5, 0.0)));
        assert_eq!((placed.file.as_str(), placed.clamps, left_out), ("a.png", false, vec![]));
        assert_eq!(map("-s 2").0.scale, DVec2::new(2.0, 1.0));
        assert_eq!(map("-mm 0.1 0.9 -t 1 -mm 0 1").1, ["-mm", "-t"]);
        let bumped = map("-bm -0.5 -imfchan g").0;
        assert_eq!((bumped.strength, bumped.channel), (-0.5, Some(MapChannel::Green)));
        assert_eq!(map("-imfchan z").1, ["-imfchan"]);
        let nameless =
            read(&b"newmtl a\nmap_Ks\nmap_Bump -bm 2\nPr 1.5\nPc -1"[..]).expect("a material").remove(0);
        assert_eq!((nameless.left_out, nameless.maps), (vec!["map_Ks", "map_Bump"], vec![]));
        assert_eq!((nameless.roughness, nameless.coat), (Some(1.0), Some(0.0)));
    }

    #[test]
    fn the_alpha_of_an_image_is_read_with_its_colours() {
        let has_own = |text: &str| {
            let material = read(text.as_bytes()).expect("a material").remove(0);
            assert!(material.left_out.is_empty());
            material.map(MapUse::Opacity).is_some()
        };
        for same in [
            "map_Kd -s 2 tex\\leaf 1.png\nmap_d tex/leaf 1.png",
            "map_d -imfchan m leaf.png\nmap_Kd leaf.png",
            "map_Kd leaf.png\nmap_d -imfchan m\tleaf.png",
        ] {
            assert!(!has_own(&format!("newmtl a\n{same}")), "{same}");
        }
        for other in [
            "map_Kd leaf.png\nmap_d mask.png",
            "map_d mask.png",
            "map_Kd leaf.png\nmap_d other leaf.png",
            "map_Kd leaf.png\nmap_d -imfchan m tex\\leaf.png",
            "map_Kd leaf.png\nmap_d -imfchan r leaf.png",
        ] {
            assert!(has_own(&format!("newmtl a\n{other}")), "{other}");
        }
    }

    #[test]
    fn default_ambient_reflectance_is_ignored() {
        let ambient_of =
            |text: &str| read(text.as_bytes()).expect("a material").remove(0).effective_ambient();
        for nothing in ["Ka 1 1 1", "Ka 1", "Ka 1 1 1\nKd 0.5", "Ka 0.8 0.2 0\nKd 0.8 0.2 0", ""] {
            assert_eq!(ambient_of(&format!("newmtl a\n{nothing}")), None, "{nothing}");
        }
        for (text, ambient) in [("Ka 0 0 0\nKd 0 0 0", 0.0), ("Ka 0.2\nKd 0.8", 0.2), ("Ka 0.5", 0.5)] {
            assert_eq!(ambient_of(&format!("newmtl a\n{text}")), Some(Rgb::splat(ambient)), "{text}");
        }
    }

    #[test]
    fn ignored_statements_are_recorded() {
        let text = "newmtl a\ndisp -bm 1 b.png\nTf 1 1 1\nmap_ns s.png\nDisp c.png\nsharpness 60\n\
                    newmtl b\nTf 1 0 0";
        let materials = read(text.as_bytes()).expect("materials");
        let left_out = materials.iter().map(|material| &material.left_out[..]).collect::<Vec<_>>();
        assert_eq!(left_out, [&["disp", "map_Ns"][..], &["Tf"]]);
    }

    #[test]
    fn faults_name_their_line() {
        for (text, expected) in [
            (
                "newmtl a\nKd 1 x 0",
                "line 2: expected three finite numbers, red, green and blue, found `Kd 1 x 0`",
            ),
            (
                "newmtl a\nKd 1 2",
                "line 2: expected three finite numbers, red, green and blue, found `Kd 1 2`",
            ),
            ("newmtl a\n\nNs nan", "line 3: expected a finite number, found `Ns nan`"),
            ("Kd 1 1 1", "line 1: expected `newmtl` and a name before the first value, found `Kd 1 1 1`"),
            ("newmtl", "line 1: expected a name after `newmtl`, found `newmtl`"),
            ("newmtl a\nd 3", "line 2: expected a number from 0 to 1, found `d 3`"),
            ("newmtl a\nTr -1", "line 2: expected a number from 0 to 1, found `Tr -1`"),
            ("newmtl a\nNs -4", "line 2: expected a number of 0 or more, found `Ns -4`"),
            ("newmtl a\nNi 0", "line 2: expected a number above 0, found `Ni 0`"),
            (
                "newmtl a\nmap_Kd -s 0 1 a.png",
                "line 2: expected finite numbers other than 0 after `-s`, found `map_Kd -s 0 1 a.png`",
            ),
            (
                "newmtl a\nmap_Kd -o left a.png",
                "line 2: expected finite numbers after `-o`, found `map_Kd -o left a.png`",
            ),
            (
                "newmtl a\nmap_Kd -s 1",
                "line 2: expected the name of an image after `map_Kd`, found `map_Kd -s 1`",
            ),
        ] {
            assert_eq!(read(text.as_bytes()).expect_err("a fault").to_string(), expected);
        }
    }
}

//! MTL files: the materials of OBJ files, as they are written.

use super::MeshError;
use super::lines::{Lines, numbers, parsed, split_word, unlike, words};
use crate::color::Rgb;
use std::io::BufRead;

/// A material of an OBJ file: the raw values of its MTL file, and nothing where the file says nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MtlMaterial {
    pub name: String,
    /// `Ka`, `Kd`, `Ks` and `Ke`: ambient, diffuse and specular reflectance, and emitted radiance.
    pub ambient: Option<Rgb>,
    pub diffuse: Option<Rgb>,
    pub specular: Option<Rgb>,
    pub emission: Option<Rgb>,
    /// `Ns`: the exponent of highlights.
    pub shininess: Option<f32>,
    /// `Ni`: the index of refraction.
    pub ior: Option<f32>,
    /// `d`, or 1 - `Tr`: 1 is opaque, 0 is not there.
    pub opacity: Option<f32>,
    /// `illum`: the number of a model of illumination.
    pub model: Option<u32>,
    /// `map_Kd`: the image that the diffuse reflectance is multiplied with. As the file names it, with `/` between
    /// folders; [`load`](super::load) puts the folder of the mesh before it.
    pub diffuse_map: Option<String>,
}

/// Reads the materials of an MTL file. Lines that are not known are skipped.
pub fn read(input: impl BufRead) -> Result<Vec<MtlMaterial>, MeshError> {
    let mut lines = Lines::new(input, true);
    let mut materials: Vec<MtlMaterial> = Vec::new();
    while let Some((number, line)) = lines.next()? {
        let (word, rest) = split_word(line);
        if word == b"newmtl" {
            if rest.is_empty() {
                return Err(unlike(number, line, "a name behind `newmtl`"));
            }
            let name = String::from_utf8_lossy(rest).into_owned();
            materials.push(MtlMaterial { name, ..MtlMaterial::default() });
        } else if let Some(material) = materials.last_mut() {
            material.line(word, rest).map_err(|what| unlike(number, line, what))?;
        } else if is_known(word) {
            return Err(unlike(number, line, "`newmtl` and a name before the first value"));
        }
    }
    Ok(materials)
}

fn is_known(word: &[u8]) -> bool {
    matches!(word, b"Ka" | b"Kd" | b"Ks" | b"Ke" | b"Ns" | b"Ni" | b"d" | b"Tr" | b"illum" | b"map_Kd")
}

impl MtlMaterial {
    /// Reads one line; fails with what would have been right.
    fn line(&mut self, word: &[u8], rest: &[u8]) -> Result<(), &'static str> {
        match word {
            b"Ka" => self.ambient = Some(color(rest)?),
            b"Kd" => self.diffuse = Some(color(rest)?),
            b"Ks" => self.specular = Some(color(rest)?),
            b"Ke" => self.emission = Some(color(rest)?),
            b"Ns" => self.shininess = Some(number(rest)?),
            b"Ni" => self.ior = Some(number(rest)?),
            // `d -halo 0.5` fades towards the rim; the number is all that is kept of it.
            b"d" => self.opacity = Some(number(rest.strip_prefix(b"-halo").unwrap_or(rest))?),
            b"Tr" => self.opacity = Some(1.0 - number(rest)?),
            b"illum" => {
                let model = words(rest).next().and_then(parsed);
                self.model = Some(model.ok_or("a whole number behind `illum`")?);
            }
            b"map_Kd" => {
                let name = file_name(rest).ok_or("the name of an image behind `map_Kd`")?;
                self.diffuse_map = Some(name);
            }
            _ => {}
        }
        Ok(())
    }
}

fn number(rest: &[u8]) -> Result<f32, &'static str> {
    let value = words(rest).next().and_then(parsed::<f32>).filter(|value| value.is_finite());
    value.ok_or("a finite number")
}

/// Three numbers, or one for grey.
fn color(rest: &[u8]) -> Result<Rgb, &'static str> {
    let color = match numbers::<3>(words(rest)) {
        Some((rgb, 3)) => Some(Rgb::from_array(rgb.map(|part| part as f32))),
        Some(([grey, ..], 1)) => Some(Rgb::splat(grey as f32)),
        _ => None,
    };
    color.filter(|color| color.is_finite()).ok_or("three finite numbers, red, green and blue")
}

/// The file name behind the options of a map. Names may contain blanks.
fn file_name(mut rest: &[u8]) -> Option<String> {
    loop {
        let (word, behind) = split_word(rest);
        let most = match word {
            b"-o" | b"-s" | b"-t" => 3,
            b"-mm" => 2,
            [b'-', letter, ..] if letter.is_ascii_alphabetic() => 1,
            _ => break,
        };
        rest = behind;
        for place in 0..most {
            let (value, behind) = split_word(rest);
            // One number is enough for `-o`, `-s` and `-t`.
            if place > 0 && parsed::<f64>(value).is_none() {
                break;
            }
            rest = behind;
        }
    }
    (!rest.is_empty()).then(|| String::from_utf8_lossy(rest).replace('\\', "/"))
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
        assert_eq!(red.diffuse_map.as_deref(), Some("tex/red brick.png"));
        assert_eq!((b.opacity, b.emission), (Some(0.5), Some(Rgb::new(1.0, 2.0, 3.0))));
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
            ("newmtl", "line 1: expected a name behind `newmtl`, found `newmtl`"),
            (
                "newmtl a\nmap_Kd -s 1",
                "line 2: expected the name of an image behind `map_Kd`, found `map_Kd -s 1`",
            ),
        ] {
            assert_eq!(read(text.as_bytes()).expect_err("a fault").to_string(), expected);
        }
    }
}

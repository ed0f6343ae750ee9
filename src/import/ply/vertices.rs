//! The vertices of a PLY file.

use super::header::{Element, Property, Scalar};
use super::records::{Reader, Records};
use super::scalars::Scalars;
use crate::base::color::{Rgb, srgb_to_linear};
use crate::base::math::{DVec2, DVec3};
use crate::geometry::mesh::build::{is_placed, not_placed};
use crate::geometry::mesh::{MeshError, Place};
use glam::Vec3;
use std::ops::Range;

/// Names of what is read of a vertex, and its place in a record. Programs do not agree on those of texture
/// coordinates.
const NAMES: [(&str, usize); 17] = [
    ("x", 0),
    ("y", 1),
    ("z", 2),
    ("nx", 3),
    ("ny", 4),
    ("nz", 5),
    ("red", 6),
    ("green", 7),
    ("blue", 8),
    ("u", 9),
    ("v", 10),
    ("s", 9),
    ("t", 10),
    ("texture_u", 9),
    ("texture_v", 10),
    ("texture_s", 9),
    ("texture_t", 10),
];

/// Values of one vertex by their places.
type Record = [f64; MOST];

/// How many of them there are at most.
const MOST: usize = 11;

/// Everything about the vertices. Lists are empty if the file has no such properties.
#[derive(Default)]
pub struct Vertices {
    pub positions: Vec<DVec3>,
    pub normals: Vec<Vec3>,
    pub colors: Vec<Rgb>,
    pub uvs: Vec<DVec2>,
    /// The first vertex that is nowhere, with its line.
    pub nowhere: Option<(u32, Option<u64>)>,
}

/// What a file has of a vertex, and how its colours are to be read.
struct Layout<'a> {
    element: &'a Element,
    /// The place of each property, if it is read.
    places: Vec<Option<usize>>,
    has: [bool; MOST],
    /// The places of the properties, if all are floats and read, and no more than there are places.
    floats: Option<Vec<usize>>,
    color: Scalar,
    /// The linear value of every code of a byte.
    codes: Vec<f32>,
}

impl Reader for Layout<'_> {
    type Output = Vertices;

    fn read(
        &self,
        records: Range<u64>,
        values: &mut impl Scalars,
        vertices: &mut Vertices,
    ) -> Result<(), MeshError> {
        for index in records {
            let record = self.record(values).map_err(|error| incomplete(error, self.element, index))?;
            let line = values.line();
            let place = || line.map_or(Place::Vertex(index), Place::Line);
            vertices.add(self, &record, line).map_err(|why| MeshError::at(place(), why))?;
        }
        Ok(())
    }

    fn append(whole: &mut Vertices, part: &mut Vertices) {
        let Vertices { positions, normals, colors, uvs, nowhere } = part;
        let before = whole.positions.len() as u32;
        let nowhere = nowhere.take().map(|(vertex, line)| (vertex + before, line));
        whole.nowhere = whole.nowhere.or(nowhere);
        whole.positions.append(positions);
        whole.normals.append(normals);
        whole.colors.append(colors);
        whole.uvs.append(uvs);
    }
}

impl Vertices {
    pub fn read(element: &Element, records: &mut impl Records) -> Result<Self, MeshError> {
        records.read(element, &Layout::of(element)?)
    }

    fn add(&mut self, layout: &Layout<'_>, r: &Record, line: Option<u64>) -> Result<(), String> {
        let position = DVec3::new(r[0], r[1], r[2]);
        if self.nowhere.is_none() && !is_placed(position) {
            self.nowhere = Some((self.positions.len() as u32, line));
        }
        self.positions.push(position);
        if layout.all(3..6) {
            self.normals.push(DVec3::new(r[3], r[4], r[5]).as_vec3());
        }
        if layout.all(6..9) {
            self.colors.push(layout.color([r[6], r[7], r[8]])?);
        }
        if layout.all(9..11) {
            let uv = DVec2::new(r[9], r[10]);
            if !uv.is_finite() {
                return Err(format!("expected finite texture coordinates, found {} {}", uv.x, uv.y));
            }
            self.uvs.push(uv);
        }
        Ok(())
    }

    /// The fault of the vertex that is nowhere, with a face that uses it.
    pub fn at_nowhere(&self, face: Option<u64>) -> Option<MeshError> {
        let (vertex, line) = self.nowhere?;
        let place = line.map_or(Place::Vertex(vertex.into()), Place::Line);
        Some(not_placed(place, *self.positions.get(vertex as usize)?, face))
    }
}

impl<'a> Layout<'a> {
    fn of(element: &'a Element) -> Result<Self, MeshError> {
        let places = element.properties.iter().map(place).collect();
        let (has, color, codes) = ([false; MOST], Scalar::F32, Vec::new());
        let mut layout = Self { element, places, has, floats: None, color, codes };
        for (property, place) in element.properties.iter().zip(&layout.places) {
            let Some(place) = *place else { continue };
            layout.has[place] = true;
            if place == 6 {
                layout.color = property.item;
            }
        }
        if !layout.all(0..3) {
            return Err(element.lacks("x, y and z"));
        }
        let floats = element.properties.iter().all(|property| property.item == Scalar::F32);
        let each: Option<Vec<_>> = layout.places.iter().copied().collect();
        layout.floats = each.filter(|each| floats && each.len() <= MOST);
        layout.codes = (0..256).map(|code| srgb_to_linear(f64::from(code) / 255.0) as f32).collect();
        Ok(layout)
    }

    #[inline]
    fn record(&self, values: &mut impl Scalars) -> Result<Record, MeshError> {
        let mut record = [0.0; MOST];
        if let Some(places) = &self.floats {
            let mut floats = [0.0; MOST];
            let floats = &mut floats[..places.len()];
            if values.floats(floats) {
                places.iter().zip(floats).for_each(|(place, float)| record[*place] = f64::from(*float));
                return Ok(record);
            }
        }
        values.begin()?;
        for (property, place) in self.element.properties.iter().zip(&self.places) {
            if let Some(count) = property.list {
                skip_list(property, count, values)?;
                continue;
            }
            let value = values.next(property.item)?;
            if let Some(place) = *place {
                record[place] = value;
            }
        }
        values.end()?;
        Ok(record)
    }

    fn all(&self, mut places: std::ops::Range<usize>) -> bool {
        places.all(|place| self.has[place])
    }

    /// Whole numbers are sRGB codes, others are linear.
    fn color(&self, rgb: [f64; 3]) -> Result<Rgb, String> {
        let part = |value: f64| match self.color {
            Scalar::U8 => self.codes[value.clamp(0.0, 255.0) as usize],
            Scalar::U16 => srgb_to_linear(value / 65_535.0) as f32,
            _ => value as f32,
        };
        let color = Rgb::from_array(rgb.map(part));
        let good = color.is_finite() && color.min_element() >= 0.0;
        let [r, g, b] = rgb;
        good.then_some(color).ok_or_else(|| format!("expected a colour of 0 or more, found {r} {g} {b}"))
    }
}

fn place(property: &Property) -> Option<usize> {
    let place = NAMES.iter().find(|(name, _)| *name == property.name).map(|(_, place)| *place);
    place.filter(|_| property.list.is_none())
}

/// Reads over a list.
pub fn skip_list(property: &Property, count: Scalar, values: &mut impl Scalars) -> Result<(), MeshError> {
    let count = values.next(count)?;
    (0..count as u64).try_for_each(|_| values.next(property.item).map(|_| ()))
}

/// Says of a fault without a place which record it is in.
pub fn incomplete(error: MeshError, element: &Element, index: u64) -> MeshError {
    match error.place {
        Some(_) => error,
        None => MeshError::new(format!("{} in {} {index} of {}", error.why, element.name, element.count)),
    }
}

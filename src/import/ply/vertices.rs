//! The vertices of a PLY file.

use super::header::{Element, Property, ScalarType};
use super::records::{RecordReader, RecordSource};
use super::scalars::{Scalars, skip_list};
use crate::base::color::{Rgb, srgb_to_linear};
use crate::base::math::{DVec2, DVec3};
use crate::geometry::mesh::build::{is_placed, not_placed};
use crate::geometry::mesh::{Centering, DataArray, MeshError, MeshLocation};
use glam::Vec3;
use std::ops::Range;

/// The names of the properties that are read, and their places in a [`VertexRecord`]. Programs use different names
/// for texture coordinates.
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

/// The values of one vertex by their places.
type VertexRecord = [f64; MAX_VALUES];

/// The maximum number of values.
const MAX_VALUES: usize = 11;

/// The place of the first property that becomes a data array. Further ones follow.
const FIRST_EXTRA: usize = MAX_VALUES;

/// The memory of a number of a data array in bytes: as read, and in the array, where most numbers are f32.
pub const EXTRA_SIZE: usize = size_of::<f64>() + size_of::<f32>();

/// The maximum number of floats that are read at once.
const MAX_FLOATS: usize = 32;

/// The groups of places that are read only together.
const GROUPS: [Range<usize>; 4] = [0..3, 3..6, 6..9, 9..11];

/// All data of the vertices. A list is empty if the file lacks its properties.
#[derive(Default)]
pub struct Vertices {
    pub positions: Vec<DVec3>,
    pub normals: Vec<Vec3>,
    pub colors: Vec<Rgb>,
    pub uvs: Vec<DVec2>,
    /// The numbers that become data arrays, all those of a vertex together.
    pub extras: Vec<f64>,
    /// The first vertex with invalid coordinates, and its line.
    pub invalid: Option<(u32, Option<u64>)>,
}

/// The properties of a vertex in a file, and the type of its colours.
struct VertexLayout<'a> {
    element: &'a Element,
    /// The place of each property, from [`FIRST_EXTRA`] on for data arrays; `None` for those that are not read.
    places: Vec<Option<usize>>,
    has: [bool; MAX_VALUES],
    /// The places of the properties, if all of them are floats, are read, and fit into a record.
    floats: Option<Vec<usize>>,
    /// The number of properties that become data arrays.
    extras: usize,
    color: ScalarType,
    /// The linear value of each 8-bit sRGB code.
    codes: Vec<f32>,
}

impl RecordReader for VertexLayout<'_> {
    type Output = Vertices;

    fn read(
        &self,
        records: Range<u64>,
        values: &mut impl Scalars,
        vertices: &mut Vertices,
    ) -> Result<(), MeshError> {
        for index in records {
            let record = self
                .record(values, &mut vertices.extras)
                .map_err(|error| self.element.in_record(error, index))?;
            let line = values.line();
            let place = || line.map_or(MeshLocation::Vertex(index), MeshLocation::Line);
            vertices.add(self, &record, line).map_err(|why| MeshError::at(place(), why))?;
        }
        Ok(())
    }

    fn append(whole: &mut Vertices, part: &mut Vertices) {
        let Vertices { positions, normals, colors, uvs, extras, invalid } = part;
        let before = whole.positions.len() as u32;
        let invalid = invalid.take().map(|(vertex, line)| (vertex + before, line));
        whole.invalid = whole.invalid.or(invalid);
        whole.positions.append(positions);
        whole.normals.append(normals);
        whole.colors.append(colors);
        whole.uvs.append(uvs);
        whole.extras.append(extras);
    }
}

impl Vertices {
    pub fn read(element: &Element, records: &mut impl RecordSource) -> Result<Self, MeshError> {
        records.read(element, &VertexLayout::of(element)?)
    }

    /// The memory of a vertex in bytes.
    pub fn size_of_one(element: &Element) -> Result<usize, MeshError> {
        let layout = VertexLayout::of(element)?;
        let size_if = |places, size: usize| if layout.all(places) { size } else { 0 };
        Ok(size_of::<DVec3>()
            + size_if(3..6, size_of::<Vec3>())
            + size_if(6..9, size_of::<Rgb>())
            + size_if(9..11, size_of::<DVec2>())
            + layout.extras * EXTRA_SIZE)
    }

    /// The data arrays of the vertices.
    pub fn arrays(&mut self, element: &Element) -> Result<Vec<DataArray>, MeshError> {
        let layout = VertexLayout::of(element)?;
        let properties = element.properties.iter().zip(&layout.places);
        let extra = properties.filter(|(_, place)| place.is_some_and(|place| place >= FIRST_EXTRA));
        let names = extra.map(|(property, _)| property.name.as_str()).collect();
        Ok(arrays(names, Centering::Points, std::mem::take(&mut self.extras)))
    }

    fn add(&mut self, layout: &VertexLayout<'_>, r: &VertexRecord, line: Option<u64>) -> Result<(), String> {
        let position = DVec3::new(r[0], r[1], r[2]);
        if self.invalid.is_none() && !is_placed(position) {
            self.invalid = Some((self.positions.len() as u32, line));
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

    /// The error of the invalid vertex. It names `face`, which uses the vertex.
    pub fn invalid_vertex_error(&self, face: Option<u64>) -> Option<MeshError> {
        let (vertex, line) = self.invalid?;
        let place = line.map_or(MeshLocation::Vertex(vertex.into()), MeshLocation::Line);
        Some(not_placed(place, *self.positions.get(vertex as usize)?, face))
    }
}

impl<'a> VertexLayout<'a> {
    fn of(element: &'a Element) -> Result<Self, MeshError> {
        let places = element.properties.iter().map(place).collect();
        let (has, color, codes) = ([false; MAX_VALUES], ScalarType::F32, Vec::new());
        let mut layout = Self { element, places, has, floats: None, extras: 0, color, codes };
        for (property, place) in element.properties.iter().zip(&layout.places) {
            let Some(place) = *place else { continue };
            layout.has[place] = true;
            if place == 6 {
                layout.color = property.item;
            }
        }
        layout.place_extras();
        if !layout.all(0..3) {
            return Err(element.lacks("x, y and z"));
        }
        let floats = element.properties.iter().all(|property| property.item == ScalarType::F32);
        let each: Option<Vec<_>> = layout.places.iter().copied().collect();
        layout.floats = each.filter(|each| floats && each.len() <= MAX_FLOATS);
        layout.codes = (0..256).map(|code| srgb_to_linear(f64::from(code) / 255.0) as f32).collect();
        Ok(layout)
    }

    /// Gives the properties that are not read otherwise places as data arrays.
    fn place_extras(&mut self) {
        let complete =
            |place: usize| GROUPS.into_iter().any(|group| group.contains(&place) && self.all(group));
        let is_extra = |place: &Option<usize>| place.is_none_or(|place| !complete(place));
        let extra: Vec<bool> = self.places.iter().map(is_extra).collect();
        let properties = self.element.properties.iter().zip(extra);
        for ((property, extra), place) in properties.zip(&mut self.places) {
            if extra {
                *place = property.list.is_none().then_some(FIRST_EXTRA + self.extras);
                self.extras += usize::from(place.is_some());
            }
        }
    }

    #[inline]
    fn record(&self, values: &mut impl Scalars, extras: &mut Vec<f64>) -> Result<VertexRecord, MeshError> {
        let mut record = [0.0; MAX_VALUES];
        let mut put = |place: usize, value: f64| match record.get_mut(place) {
            Some(known) => *known = value,
            None => extras.push(value),
        };
        if let Some(places) = &self.floats {
            let mut floats = [0.0; MAX_FLOATS];
            let floats = &mut floats[..places.len()];
            if values.floats(floats) {
                places.iter().zip(floats).for_each(|(place, float)| put(*place, f64::from(*float)));
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
                put(place, value);
            }
        }
        values.end()?;
        Ok(record)
    }

    fn all(&self, mut places: Range<usize>) -> bool {
        places.all(|place| self.has[place])
    }

    /// Unsigned integers are sRGB codes; other numbers are linear.
    fn color(&self, rgb: [f64; 3]) -> Result<Rgb, String> {
        let part = |value: f64| match self.color {
            ScalarType::U8 => self.codes[value.clamp(0.0, 255.0) as usize],
            ScalarType::U16 => srgb_to_linear(value / 65_535.0) as f32,
            _ => value as f32,
        };
        let color = Rgb::from_array(rgb.map(part));
        let good = color.is_finite() && color.min_element() >= 0.0;
        let [r, g, b] = rgb;
        good.then_some(color).ok_or_else(|| format!("expected a colour of 0 or more, found {r} {g} {b}"))
    }
}

/// The arrays of these names in records of one number for each of them.
pub fn arrays(names: Vec<&str>, centering: Centering, records: Vec<f64>) -> Vec<DataArray> {
    let count = names.len();
    let array = |(index, name): (usize, &str)| {
        let values = records.iter().skip(index).step_by(count).copied().collect::<Vec<f64>>().into();
        DataArray { name: name.to_owned(), centering, components: 1, values }
    };
    names.into_iter().enumerate().map(array).collect()
}

fn place(property: &Property) -> Option<usize> {
    let place = NAMES.iter().find(|(name, _)| *name == property.name).map(|(_, place)| *place);
    place.filter(|_| property.list.is_none())
}

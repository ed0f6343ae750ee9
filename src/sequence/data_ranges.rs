//! Finds the data that textures name, and the ranges of data where a file leaves them to Kinora.

use super::fault::Fault;
use super::node::File;
use super::suggest::{listed, nearest, shortened};
use super::{Named, Object};
use crate::appearance::material::MaterialTracks;
use crate::appearance::texture::{DataScale, DataSource, DataTexture};
use crate::geometry::mesh::{ArrayKey, Centering, Component, TriangleMesh};
use crate::geometry::shape::{self, Shape};
use std::collections::HashMap;
use std::ops::Range;

/// The ranges of data, each with the place of the first object that shows it.
type Ranges = HashMap<(DataSource, DataScale), (Option<[f64; 2]>, usize)>;

/// Reports objects that lack the data of their materials, and sets the ranges that are `Auto`: one for all objects that
/// show the same data on the same scale. `places` holds the place of each object's material.
pub fn resolve(
    file: &File<'_>,
    materials: &mut [Named<MaterialTracks>],
    objects: &[Named<Object>],
    places: &[Range<usize>],
) {
    let mut data: Vec<Vec<DataTexture>> = Vec::new();
    for material in &mut *materials {
        let mut found = Vec::new();
        material.value.each_data(&mut |texture| found.push(texture.clone()));
        data.push(found);
    }
    let mut ranges = Ranges::new();
    for (object, place) in objects.iter().zip(places) {
        let shown = object.value.made_of.indices().filter_map(|index| data.get(index as usize));
        let mut seen: Vec<&DataSource> = Vec::new();
        for texture in shown.flatten().filter(|_| object.value.shape != Shape::Group) {
            if let Err(fault) = note(texture, &object.value.shape, place, &mut ranges)
                && !seen.contains(&&texture.source)
            {
                file.push(*fault);
            }
            seen.push(&texture.source);
        }
    }
    let found = |texture: &DataTexture| ranges.get(&(texture.source.clone(), texture.scale));
    let set = |texture: &mut DataTexture| {
        if let Some((range, _)) = found(texture).filter(|_| texture.auto) {
            texture.range = *range;
        }
    };
    materials.iter_mut().for_each(|material| material.value.each_data(&mut { set }));
    let mut notes: Vec<_> = ranges
        .iter()
        .map(|((source, scale), (range, at))| (*at, described(source, *scale, *range)))
        .collect();
    notes.sort();
    notes.into_iter().for_each(|(at, note)| file.warn(at, note));
}

/// Notes the range of a shape's data.
fn note(
    texture: &DataTexture,
    shape: &Shape,
    place: &Range<usize>,
    ranges: &mut Ranges,
) -> Result<(), Box<Fault>> {
    let DataTexture { source, scale, auto, .. } = texture;
    let counts = |value: f64| scale.has(value);
    let range = match source {
        DataSource::Array(key) => {
            let Shape::Mesh(shape::Mesh { mesh, .. }) = shape else {
                return Err(Box::new(no_mesh(key, place)));
            };
            if mesh.array(key).is_none() {
                return Err(Box::new(missing(key, mesh, place)));
            }
            if !auto {
                return Ok(());
            }
            mesh.array_range(key, counts)
        }
        DataSource::Coordinate(_) if !auto => return Ok(()),
        DataSource::Coordinate(axis) => {
            let bounds = shape.bounds().ok_or_else(|| Box::new(endless(place)))?;
            let ends = [bounds.min, bounds.max].map(|corner| corner[*axis as usize]);
            Some(ends).filter(|[min, _]| counts(*min))
        }
    };
    let (whole, _) = ranges.entry((source.clone(), *scale)).or_insert((None, place.start));
    *whole = match (*whole, range) {
        (Some([a, b]), Some([c, d])) => Some([a.min(c), b.max(d)]),
        (one, other) => one.or(other),
    };
    Ok(())
}

fn no_mesh(key: &ArrayKey, place: &Range<usize>) -> Fault {
    let title = format!("only meshes have data such as `{}`", shortened(&key.name));
    Fault::new(place.clone(), title, "the shape of this object is no mesh")
        .help("X, Y and Z are the coordinates of any shape")
}

fn endless(place: &Range<usize>) -> Fault {
    let label = "the shape of this object has no end";
    Fault::new(place.clone(), "the range of a coordinate cannot be found", label)
        .help("write the range: `range: (lowest, highest)`")
}

/// The fault of data that a mesh lacks.
fn missing(key: &ArrayKey, mesh: &TriangleMesh, place: &Range<usize>) -> Fault {
    let whole = ArrayKey { component: Component::Whole, ..key.clone() };
    let name = shortened(&key.name);
    if let (Some(array), Component::Index(index)) = (mesh.array(&whole), key.component) {
        let title = format!("the data `{name}` has no component {index}");
        let label = match array.components {
            1 => "it has one, 0".to_owned(),
            count => format!("it has {count}, counted from 0"),
        };
        return Fault::new(place.clone(), title, label);
    }
    let kind = match key.centering {
        None => "data",
        Some(Centering::Points) => "data of points",
        Some(Centering::Cells) => "data of cells",
    };
    let fits = |centering| key.centering.is_none_or(|wanted| wanted == centering);
    let names =
        || mesh.arrays().iter().filter(|array| fits(array.centering)).map(|array| array.name.as_str());
    let label = match nearest(&key.name, names()) {
        Some(name) => format!("did you mean `{}`?", shortened(name)),
        None => "unknown".to_owned(),
    };
    let help = match names().next() {
        Some(_) => format!("the mesh has {}", listed(names())),
        None => format!("the mesh has no {kind}"),
    };
    Fault::new(place.clone(), format!("the mesh of this object has no {kind} `{name}`"), label).help(help)
}

/// A note about a range that was found.
fn described(source: &DataSource, scale: DataScale, range: Option<[f64; 2]>) -> String {
    let name = match source {
        DataSource::Coordinate(axis) => ["X", "Y", "Z"][*axis as usize % 3].to_owned(),
        DataSource::Array(ArrayKey { name, component: Component::Whole, .. }) => {
            format!("`{}`", shortened(name))
        }
        DataSource::Array(ArrayKey { name, component: Component::Index(index), .. }) => {
            format!("component {index} of `{}`", shortened(name))
        }
    };
    match range {
        Some([min, max]) => format!("the range of {name} is ({}, {})", plain(min), plain(max)),
        None if scale == DataScale::Log => format!("{name} has no range: no value is above 0"),
        None => format!("{name} has no range: no value is a finite number"),
    }
}

/// A number in the fewest digits that no other number of its width has.
fn plain(value: f64) -> String {
    // No sign of 0.
    let value = value + 0.0;
    let narrow = value as f32;
    let text = if f64::from(narrow) == value { format!("{narrow:?}") } else { format!("{value:?}") };
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}

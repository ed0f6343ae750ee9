//! Finds the data that textures name, and the ranges of data where a file leaves them to Kinora.

use super::fault::Fault;
use super::group_instances::CopiedObjects;
use super::placement::all_above;
use super::source_file::File;
use super::suggest::{listed, nearest, shortened};
use super::{Named, Object, ShapeTracks};
use crate::appearance::material::{MaterialBinding, MaterialTracks};
use crate::appearance::texture::{DataScale, DataSource, DataTexture};
use crate::geometry::mesh::{ArrayKey, Centering, Component, DataArray};
use crate::geometry::shape::{self, Shape};
use crate::geometry::table_rows::TableColumns;
use crate::import::series::MeshSeries;
use crate::track::Animated;
use rustc_hash::FxHashSet;
use std::collections::HashMap;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

/// The ranges of data, each with the place of the first object that shows it.
type Ranges = HashMap<(DataSource, DataScale), (Option<[f64; 2]>, usize)>;

/// Reports objects that lack the data of their materials, and sets the ranges that are `Auto`: one for all objects that
/// show the same data on the same scale. Objects keep only those columns of tables that their materials show. `places`
/// holds the place of each object's material.
pub fn resolve(
    file: &File<'_>,
    materials: &mut [Named<MaterialTracks>],
    objects: &mut [Named<Object>],
    (places, copied): (&[Range<usize>], &CopiedObjects),
) {
    let is_copied = copied.are_copied();
    let mut data: Vec<Vec<DataTexture>> = Vec::new();
    for material in &mut *materials {
        let mut found = Vec::new();
        material.value.each_data(&mut |texture| found.push(texture.clone()));
        data.push(found);
    }
    let (mut ranges, mut noted) = (Ranges::new(), FxHashSet::default());
    for (index, (object, place)) in objects.iter().zip(places).enumerate() {
        let shown = object.value.made_of.indices().filter_map(|index| data.get(index as usize));
        let mut seen: Vec<&DataSource> = Vec::new();
        for texture in shown.flatten().filter(|_| object.value.shape != Shape::Group) {
            // Many instances have the same data, whose range takes long to find.
            let read = (std::ptr::from_ref(texture), data_of(&object.value));
            if noted.contains(&read) {
                continue;
            }
            match note(texture, &object.value, place, &mut ranges) {
                Ok(()) if matches!(texture.source, DataSource::Array(_)) => {
                    noted.insert(read);
                }
                // A group that only its instances show may lack what their rows have.
                Err(_) if is_copied[index] && is_hidden(objects, index) => {}
                Err(fault) if !seen.contains(&&texture.source) => file.push(*fault),
                _ => {}
            }
            seen.push(&texture.source);
        }
    }
    keep_read_columns(objects, &data);
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

/// Notes the range of the data of an object's shape.
fn note(
    texture: &DataTexture,
    object: &Object,
    place: &Range<usize>,
    ranges: &mut Ranges,
) -> Result<(), Box<Fault>> {
    let DataTexture { source, scale, auto, .. } = texture;
    let counts = |value: f64| scale.has(value);
    let range = match source {
        DataSource::Array(key) => {
            let owners = owners(object);
            if owners.is_empty() {
                return Err(Box::new(no_data(key, place)));
            }
            let Some((owner, array)) = owners.iter().find_map(|owner| Some((owner, owner.find(key)?))) else {
                let why = owners.iter().find_map(|owner| owner.columns()?.unusable(&key.name));
                return Err(Box::new(match why {
                    Some(why) => no_numbers(&key.name, why, place),
                    None => missing(key, &owners[0], place),
                }));
            };
            match (owner, &object.shape, &object.tracks) {
                (Owner::Mesh(_), _, Some(ShapeTracks::Series(series))) => {
                    let range = series_range(series, key, *scale);
                    let range = range.map_err(|file| Box::new(lacking(key, file, place)))?;
                    if !auto {
                        return Ok(());
                    }
                    range
                }
                _ if !auto => return Ok(()),
                (Owner::Mesh(_), Shape::Mesh(shape::Mesh { mesh, .. }), _) => mesh.array_range(key, counts),
                _ => array.range(0..array.entries(), key.component, counts),
            }
        }
        DataSource::Coordinate(_) if !auto => return Ok(()),
        DataSource::Coordinate(axis) => {
            let bounds = match &object.tracks {
                Some(tracks) => Some(tracks.bounds()),
                None => object.shape.bounds(),
            };
            let bounds = bounds.ok_or_else(|| Box::new(endless(place)))?;
            let ends = [bounds.min, bounds.max].map(|corner| corner[*axis as usize]);
            Some(ends).filter(|[min, _]| counts(*min))
        }
    };
    let (whole, _) = ranges.entry((source.clone(), *scale)).or_insert((None, place.start));
    *whole = union(*whole, range);
    Ok(())
}

/// Leaves objects only those columns of their tables that their textures read, so that other numbers change nothing.
fn keep_read_columns(objects: &mut [Named<Object>], data: &[Vec<DataTexture>]) {
    // Instances share what is left of their table.
    let mut kept: HashMap<(*const TableColumns, MaterialBinding), Arc<TableColumns>> = HashMap::new();
    for Named { value: object, .. } in objects {
        let Some(row) = object.row.take() else { continue };
        let columns = kept.entry((Arc::as_ptr(row.columns()), object.made_of)).or_insert_with(|| {
            let shown = object.made_of.indices().filter_map(|index| data.get(index as usize)).flatten();
            let names: Vec<&str> = shown.filter_map(array_name).collect();
            Arc::new(row.columns().only(&names))
        });
        object.row = (!columns.arrays().is_empty()).then(|| row.with_columns(Arc::clone(columns)));
    }
}

/// The name of the data that a texture reads, if it does not read a coordinate.
fn array_name(texture: &DataTexture) -> Option<&str> {
    match &texture.source {
        DataSource::Array(key) => Some(&key.name),
        DataSource::Coordinate(_) => None,
    }
}

/// Whether no frame shows an object.
fn is_hidden(objects: &[Named<Object>], index: usize) -> bool {
    !all_above(objects, index, &|at| objects[at].value.visible != Animated::Constant(false))
}

/// The addresses of an object's data: that of its shape, and that of its table.
fn data_of(object: &Object) -> [Option<*const ()>; 2] {
    let of_shape = match (&object.tracks, &object.shape) {
        (Some(ShapeTracks::Series(series)), _) => Some(Arc::as_ptr(series).cast()),
        (Some(ShapeTracks::Particles(particles)), _) => Some(Arc::as_ptr(particles).cast()),
        (_, Shape::Mesh(shape::Mesh { mesh, .. })) => Some(Arc::as_ptr(mesh).cast()),
        _ => None,
    };
    [of_shape, object.row.as_ref().map(|row| Arc::as_ptr(row.columns()).cast())]
}

/// What has data.
enum Owner<'a> {
    Mesh(&'a [DataArray]),
    Table(&'a TableColumns),
}

impl<'a> Owner<'a> {
    fn name(&self) -> &'static str {
        match self {
            Self::Mesh(_) => "mesh",
            Self::Table(_) => "table",
        }
    }

    fn arrays(&self) -> &'a [DataArray] {
        match self {
            Self::Mesh(arrays) => arrays,
            Self::Table(columns) => columns.arrays(),
        }
    }

    fn columns(&self) -> Option<&'a TableColumns> {
        match self {
            Self::Mesh(_) => None,
            Self::Table(columns) => Some(columns),
        }
    }

    fn find(&self, key: &ArrayKey) -> Option<&'a DataArray> {
        key.find_in(self.arrays()).map(|index| &self.arrays()[index])
    }
}

/// What may have the data of an object, in the order in which textures ask.
fn owners(object: &Object) -> Vec<Owner<'_>> {
    let of_shape = match &object.tracks {
        Some(ShapeTracks::Particles(particles)) => vec![Owner::Table(particles.columns())],
        _ => object.shape.meshes().into_iter().map(|mesh| Owner::Mesh(mesh.mesh.arrays())).collect(),
    };
    of_shape.into_iter().chain(object.row.as_ref().map(|row| Owner::Table(row.columns()))).collect()
}

/// The range of both.
fn union(one: Option<[f64; 2]>, other: Option<[f64; 2]>) -> Option<[f64; 2]> {
    match (one, other) {
        (Some([a, b]), Some([c, d])) => Some([a.min(c), b.max(d)]),
        _ => one.or(other),
    }
}

/// The range of data in all files of a series, or a file without the data.
fn series_range<'a>(
    series: &'a MeshSeries,
    key: &ArrayKey,
    scale: DataScale,
) -> Result<Option<[f64; 2]>, &'a Path> {
    let mut whole = None;
    for (step, path) in series.steps().iter().zip(series.paths()) {
        let array = step.array(key).ok_or(path.as_path())?;
        whole = union(whole, array.range(key.component, scale == DataScale::Log));
    }
    Ok(whole)
}

/// The fault of data that a file of a series lacks.
fn lacking(key: &ArrayKey, file: &Path, place: &Range<usize>) -> Fault {
    let file = file.file_name().unwrap_or(file.as_os_str()).to_string_lossy();
    let title = format!("not all files of the series have the data `{}`", shortened(&key.name));
    Fault::new(place.clone(), title, format!("{:?} has none", shortened(&file)))
}

fn no_data(key: &ArrayKey, place: &Range<usize>) -> Fault {
    let title = format!("only meshes, particles and instances have data such as `{}`", shortened(&key.name));
    Fault::new(place.clone(), title, "the shape of this object has none")
        .help("X, Y and Z are the coordinates of any shape")
}

/// The fault of a column that does not hold numbers.
fn no_numbers(name: &str, why: &str, place: &Range<usize>) -> Fault {
    let title = format!("cannot colour by the column `{}`", shortened(name));
    Fault::new(place.clone(), title, why)
        .help("cells that are empty, NaN, NA or null have no number: they show the colour `nan`")
}

fn endless(place: &Range<usize>) -> Fault {
    let label = "the shape of this object has no end";
    Fault::new(place.clone(), "the range of a coordinate cannot be found", label)
        .help("write the range: `range: (lowest, highest)`")
}

/// The fault of data that a mesh or a table lacks.
fn missing(key: &ArrayKey, owner: &Owner<'_>, place: &Range<usize>) -> Fault {
    let whole = ArrayKey { component: Component::Whole, ..key.clone() };
    let name = shortened(&key.name);
    if let (Some(array), Component::Index(index)) = (owner.find(&whole), key.component) {
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
    let (owner, arrays) = (owner.name(), owner.arrays());
    let fits = |centering| key.centering.is_none_or(|wanted| wanted == centering);
    let names = || arrays.iter().filter(|array| fits(array.centering)).map(|array| array.name.as_str());
    let label = match nearest(&key.name, names()) {
        Some(name) => format!("did you mean `{}`?", shortened(name)),
        None => "unknown".to_owned(),
    };
    let help = match names().next() {
        Some(_) => format!("the {owner} has {}", listed(names())),
        None => format!("the {owner} has no {kind}"),
    };
    Fault::new(place.clone(), format!("the {owner} of this object has no {kind} `{name}`"), label).help(help)
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

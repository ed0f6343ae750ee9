//! A piece of an XML file → points, cells and data.

use super::document::{Array, Document, Piece};
use super::payload;
use crate::base::math::DVec3;
use crate::geometry::mesh::{Centering, DataArray, MeshError};
use crate::import::vtk::grid::{Cells, Grid};
use crate::import::vtk::number::NumberType;
use crate::import::vtk::surface;

/// The elements of polygonal data and the types of their cells, in the order of the data of cells.
const KINDS: [(&str, u8); 4] = [
    ("Verts", surface::VERTICES),
    ("Lines", surface::POLYLINE),
    ("Polys", surface::POLYGON),
    ("Strips", surface::STRIP),
];

/// Adds a piece to the data set.
pub fn add(document: &Document<'_>, piece: &Piece, grid: &mut Grid) -> Result<(), MeshError> {
    let own = PieceReader { document, piece }.read()?;
    if grid.positions.len() + own.positions.len() >= u32::MAX as usize {
        return Err(document.fault(piece.at, "the pieces have too many points; the maximum is 4 294 967 294"));
    }
    append(grid, own);
    Ok(())
}

/// Adds the points, cells and data of another part. Data that one of them lacks is left out.
fn append(grid: &mut Grid, mut part: Grid) {
    if grid.positions.is_empty() && grid.cells.len() == 0 {
        *grid = part;
        return;
    }
    if grid.normals.is_empty() || part.normals.is_empty() {
        grid.normals.clear();
    } else {
        grid.normals.append(&mut part.normals);
    }
    grid.arrays.retain_mut(|array| {
        let same = |other: &&DataArray| {
            (&other.name, other.centering, other.components)
                == (&array.name, array.centering, array.components)
        };
        let Some(other) = part.arrays.iter().find(same) else { return false };
        let values = [&array.values, &other.values];
        let values = values.into_iter().flat_map(|values| (0..values.len()).map(|index| values.get(index)));
        array.values = values.collect::<Vec<f64>>().into();
        true
    });
    let before = grid.positions.len() as u32;
    grid.positions.append(&mut part.positions);
    grid.cells.append(part.cells.after(before));
}

struct PieceReader<'a, 'b> {
    document: &'a Document<'b>,
    piece: &'a Piece,
}

impl PieceReader<'_, '_> {
    fn read(&self) -> Result<Grid, MeshError> {
        let mut grid = Grid::default();
        let points = self.array("Points", None)?;
        let coordinates = self.numbers(points)?;
        self.check_count(points, coordinates.len(), "NumberOfPoints", 3)?;
        grid.push_points(&coordinates)?;
        drop(coordinates);
        match self.piece.arrays.iter().any(|array| array.group == "Cells") {
            true => self.cells("Cells", None, &mut grid)?,
            false => {
                for (group, kind) in KINDS {
                    if self.piece.arrays.iter().any(|array| array.group == group) {
                        self.cells(group, Some(kind), &mut grid)?;
                    }
                }
            }
        }
        for array in &self.piece.arrays {
            self.data(array, &mut grid)?;
        }
        Ok(grid)
    }

    /// The array of a group with this name; the first if none is given.
    fn array(&self, group: &str, name: Option<&str>) -> Result<&Array, MeshError> {
        let is_it = |array: &&Array| array.group == group && name.is_none_or(|name| array.name == name);
        self.piece.arrays.iter().find(is_it).ok_or_else(|| {
            let what = name.map_or_else(String::new, |name| format!(" `{name}`"));
            self.document.fault(self.piece.at, format!("the piece has no array{what} in `{group}`"))
        })
    }

    fn numbers(&self, array: &Array) -> Result<Vec<f64>, MeshError> {
        let Some(kind) = NumberType::xml(&array.kind) else {
            let why = format!(
                "expected a type such as `Float32` of the array `{}`, found `{}`",
                array.name, array.kind
            );
            return Err(self.document.fault(array.at, why));
        };
        payload::numbers(self.document, array, kind)
    }

    /// Checks an array against the count that the piece states, if it does.
    fn check_count(&self, array: &Array, found: usize, count: &str, each: u64) -> Result<(), MeshError> {
        match self.piece.count(count) {
            Some(stated) if stated.checked_mul(each) != Some(found as u64) => {
                let why = format!(
                    "`{count}` is {stated}, but the array `{}` has {found} numbers, {each} each",
                    array.name
                );
                Err(self.document.fault(array.at, why))
            }
            _ => Ok(()),
        }
    }

    /// Adds the cells of a group, of one type or of those that it lists.
    fn cells(&self, group: &str, kind: Option<u8>, grid: &mut Grid) -> Result<(), MeshError> {
        let array = |name: &str| self.array(group, Some(name));
        let (offsets, connectivity) = (array("offsets")?, array("connectivity")?);
        let (ends, corners) = (self.numbers(offsets)?, self.numbers(connectivity)?);
        self.check_count(offsets, ends.len(), &format!("NumberOf{group}"), 1)?;
        let kinds = match kind {
            Some(_) => Vec::new(),
            None => self.numbers(array("types")?)?,
        };
        if kind.is_none() && kinds.len() != ends.len() {
            let why = format!("`types` has {} numbers, and `offsets` has {}", kinds.len(), ends.len());
            return Err(self.document.fault(offsets.at, why));
        }
        let mut cells = Cells::default();
        let kind_of = |cell: usize| kind.unwrap_or_else(|| kinds[cell] as u8);
        let added = cells.push_listed(kind_of, &corners, &ends, grid.positions.len());
        added.map_err(|why| self.document.fault(connectivity.at, format!("in `{group}`, {why}")))?;
        grid.cells.append(cells);
        Ok(())
    }

    /// Adds an array of numbers of points or cells, or the points' normals.
    fn data(&self, array: &Array, grid: &mut Grid) -> Result<(), MeshError> {
        let centering = match array.group.as_str() {
            "PointData" => Centering::Points,
            "CellData" => Centering::Cells,
            _ => return Ok(()),
        };
        // Texts have no colours.
        if NumberType::xml(&array.kind).is_none() {
            return Ok(());
        }
        let values = self.numbers(array)?;
        let (components, entries) = (array.components as usize, grid.entries(centering));
        if entries.checked_mul(components) != Some(values.len()) {
            let (name, found) = (&array.name, values.len());
            let why =
                format!("the array `{name}` has {found} numbers; it needs {entries} times {components}");
            return Err(self.document.fault(array.at, why));
        }
        if array.normals && components == 3 {
            let normals = values.as_chunks::<3>().0.iter();
            grid.normals = normals.map(|normal| DVec3::from_array(*normal).as_vec3()).collect();
            return Ok(());
        }
        grid.arrays.push(DataArray {
            name: array.name.clone(),
            centering,
            components,
            values: values.into(),
        });
        Ok(())
    }
}

//! A piece of an XML file → points, cells and data.

use super::document::{Array, Document, Piece};
use super::payload::EncodedArray;
use crate::base::math::DVec3;
use crate::geometry::mesh::{Centering, DataArray, MeshError};
use crate::import::vtk::grid::{Cells, Grid};
use crate::import::vtk::number::NumberType;
use crate::import::vtk::surface::{POLYGONAL_KINDS, PolygonalKind};

/// Adds a piece to the data set.
pub fn add(document: &Document<'_>, piece: &Piece, grid: &mut Grid) -> Result<(), MeshError> {
    if piece.is_empty() {
        return Ok(());
    }
    grid.append(PieceReader { document, piece }.read()?)
}

struct PieceReader<'a, 'b> {
    document: &'a Document<'b>,
    piece: &'a Piece,
}

impl PieceReader<'_, '_> {
    fn read(&self) -> Result<Grid, MeshError> {
        let mut grid = Grid::default();
        let points = self.array("Points", None)?;
        if points.components != 3 {
            let why = format!("expected points of 3 components, found {}", points.components);
            return Err(self.document.fault(points.at, why));
        }
        let coordinates =
            self.numbers(points, |amount| self.check_count(points, amount, "NumberOfPoints", 3))?;
        grid.push_points(&coordinates)?;
        drop(coordinates);
        match self.piece.arrays.iter().any(|array| array.group == "Cells") {
            true => self.cells("Cells", None, &mut grid)?,
            false => {
                for PolygonalKind { element, cell_type, .. } in POLYGONAL_KINDS {
                    if self.piece.arrays.iter().any(|array| array.group == element) {
                        self.cells(element, Some(cell_type), &mut grid)?;
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

    /// The numbers of an array. `check` judges their amount before they are decompressed.
    fn numbers(
        &self,
        array: &Array,
        check: impl FnOnce(u64) -> Result<(), String>,
    ) -> Result<Vec<f64>, MeshError> {
        let Some(kind) = NumberType::xml(&array.kind) else {
            let why = format!(
                "expected a type such as `Float32` of the array `{}`, found `{}`",
                array.name, array.kind
            );
            return Err(self.document.fault(array.at, why));
        };
        let encoded = EncodedArray::open(self.document, array, kind)?;
        check(encoded.amount()?).map_err(|why| self.document.fault(array.at, why))?;
        encoded.numbers()
    }

    /// Checks an array of `each` numbers per entry against the count that the piece states, if it does.
    fn check_count(&self, array: &Array, found: u64, count: &str, each: u64) -> Result<(), String> {
        let name = &array.name;
        match self.piece.count(count) {
            Some(stated) if stated.checked_mul(each) != Some(found) => {
                Err(format!("`{count}` is {stated}, but the array `{name}` has {found} numbers, {each} each"))
            }
            None if !found.is_multiple_of(each) => {
                Err(format!("the array `{name}` has {found} numbers, not {each} for each point"))
            }
            _ => Ok(()),
        }
    }

    /// Adds the cells of a group, of one type or of those that it lists.
    fn cells(&self, group: &str, kind: Option<u8>, grid: &mut Grid) -> Result<(), MeshError> {
        let array = |name: &str| self.array(group, Some(name));
        let (offsets, connectivity) = (array("offsets")?, array("connectivity")?);
        let count = format!("NumberOf{group}");
        let ends = self.numbers(offsets, |amount| self.check_count(offsets, amount, &count, 1))?;
        let kinds = match kind {
            Some(_) => Vec::new(),
            None => self.numbers(array("types")?, |amount| match amount == ends.len() as u64 {
                true => Ok(()),
                false => Err(format!("`types` has {amount} numbers, and `offsets` has {}", ends.len())),
            })?,
        };
        let corners = self.numbers(connectivity, |_| Ok(()))?;
        let mut cells = Cells::default();
        let kind_of = |cell: usize| kind.map_or_else(|| kinds[cell], f64::from);
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
        let (components, entries) = (array.components, grid.entries(centering));
        let name = &array.name;
        let values = self.numbers(array, |found| match (entries as u64).checked_mul(components) {
            Some(needed) if needed == found => Ok(()),
            _ => {
                Err(format!("the array `{name}` has {found} numbers; it needs {entries} times {components}"))
            }
        })?;
        if array.normals && components == 3 {
            let normals = values.as_chunks::<3>().0.iter();
            grid.normals = normals.map(|normal| DVec3::from_array(*normal).as_vec3()).collect();
            return Ok(());
        }
        grid.arrays.push(DataArray {
            name: name.clone(),
            centering,
            components: components as usize,
            values: values.into(),
        });
        Ok(())
    }
}

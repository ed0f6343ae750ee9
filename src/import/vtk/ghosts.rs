//! Cells that are not to be shown.

use crate::geometry::mesh::{Centering, DataArray};

/// Flags of cells in the array `vtkGhostType` (VTK, `vtkDataSetAttributes::CellGhostTypes`). Another piece shows the cells
/// that are duplicates; here they only cover the faces of their neighbours.
pub const DUPLICATE: u8 = 1;
pub const HIDDEN: u8 = 32;

/// The flags of all cells; none if the file has none.
pub struct Ghosts(Vec<u8>);

impl Ghosts {
    pub fn of(arrays: &[DataArray]) -> Self {
        let is_it = |array: &&DataArray| array.centering == Centering::Cells && array.name == "vtkGhostType";
        let array = arrays.iter().find(is_it).filter(|array| array.components == 1);
        Self(array.map_or_else(Vec::new, |array| {
            (0..array.values.len()).map(|cell| array.values.get(cell) as u8).collect()
        }))
    }

    pub fn has(&self, cell: usize, flag: u8) -> bool {
        self.0.get(cell).is_some_and(|flags| flags & flag != 0)
    }
}

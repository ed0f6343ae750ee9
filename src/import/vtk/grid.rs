//! The cells of a VTK file, of any kind.

use super::surface;
use crate::base::machine;
use crate::base::math::DVec3;
use crate::geometry::mesh::build::{is_placed, not_placed};
use crate::geometry::mesh::{Centering, DataArray, MeshError, MeshLocation};
use glam::Vec3;

/// Points, cells and their data.
#[derive(Default)]
pub struct Grid {
    pub positions: Vec<DVec3>,
    /// A normal per point; empty if the file has none.
    pub normals: Vec<Vec3>,
    pub cells: Cells,
    /// Data of points and of cells.
    pub arrays: Vec<DataArray>,
    /// Whether it has several parts, each with points of its own.
    pub is_joined: bool,
}

/// Cells by their type and their corners.
#[derive(Default)]
pub struct Cells {
    pub types: Vec<u8>,
    /// The index in `corners` after the last corner of each cell.
    ends: Vec<usize>,
    corners: Vec<u32>,
}

impl Cells {
    pub fn len(&self) -> usize {
        self.types.len()
    }

    /// The corners of a cell.
    pub fn corners(&self, cell: usize) -> &[u32] {
        let begin = cell.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.corners[begin..self.ends[cell]]
    }

    /// Adds a cell of a known type whose corners are below `points`.
    pub fn push(
        &mut self,
        kind: u8,
        corners: impl Iterator<Item = f64>,
        points: usize,
    ) -> Result<(), String> {
        let begin = self.corners.len();
        for corner in corners {
            let index = corner as u32;
            if f64::from(index) != corner || index as usize >= points {
                let cell = self.types.len();
                return Err(format!(
                    "cell {cell} has the point {corner}; the file has {points}, numbered from 0"
                ));
            }
            self.corners.push(index);
        }
        surface::check_cell(self.types.len(), kind, self.corners.len() - begin)?;
        self.ends.push(self.corners.len());
        self.types.push(kind);
        Ok(())
    }

    /// The same cells with points that are numbered from `first` on.
    pub fn after(mut self, first: u32) -> Self {
        self.corners.iter_mut().for_each(|corner| *corner += first);
        self
    }

    pub fn append(&mut self, other: Self) {
        let before = self.corners.len();
        self.types.extend(other.types);
        self.ends.extend(other.ends.into_iter().map(|end| before + end));
        self.corners.extend(other.corners);
    }

    /// Adds cells that are listed by corners and by ends, as in files since VTK 5.1.
    pub fn push_listed(
        &mut self,
        kinds: impl Fn(usize) -> f64,
        connectivity: &[f64],
        ends: &[f64],
        points: usize,
    ) -> Result<(), String> {
        let needed = ends.len() * (size_of::<u8>() + size_of::<usize>()) + size_of_val(connectivity) / 2;
        machine::check_memory(needed as u64).map_err(|error| error.to_string())?;
        self.types.reserve_exact(ends.len());
        self.ends.reserve_exact(ends.len());
        self.corners.reserve_exact(connectivity.len());
        let mut begin = 0;
        for (cell, &end) in ends.iter().enumerate() {
            let whole = end as usize;
            if whole as f64 != end || whole < begin || whole > connectivity.len() {
                return Err(format!(
                    "cell {cell} ends at {end} in a list of {}; offsets must ascend",
                    connectivity.len()
                ));
            }
            let kind = kinds(cell);
            if f64::from(kind as u8) != kind {
                return Err(format!(
                    "cell {cell} has the type {kind}; types are whole numbers from 0 to 255"
                ));
            }
            self.push(kind as u8, connectivity[begin..whole].iter().copied(), points)?;
            begin = whole;
        }
        Ok(())
    }
}

impl Grid {
    /// Whether there are neither points nor cells.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty() && self.cells.len() == 0
    }

    /// Adds the points, cells and data of another part. Data that one of them lacks is left out.
    pub fn append(&mut self, mut part: Grid) -> Result<(), MeshError> {
        if part.is_empty() {
            return Ok(());
        }
        if self.is_empty() {
            *self = part;
            return Ok(());
        }
        let before = self.positions.len();
        if before + part.positions.len() >= u32::MAX as usize {
            return Err(MeshError::new("the parts have too many points; the maximum is 4 294 967 294"));
        }
        self.is_joined = true;
        match self.normals.is_empty() || part.normals.is_empty() {
            true => self.normals.clear(),
            false => self.normals.append(&mut part.normals),
        }
        self.arrays.retain_mut(|array| {
            let other = part.arrays.iter().find(|other| array.is_like(other));
            if let Some(other) = other {
                array.values.extend(&other.values);
            }
            other.is_some()
        });
        self.positions.append(&mut part.positions);
        self.cells.append(part.cells.after(before as u32));
        Ok(())
    }

    /// Adds points from their coordinates.
    pub fn push_points(&mut self, coordinates: &[f64]) -> Result<(), MeshError> {
        if self.positions.len() + coordinates.len() / 3 >= u32::MAX as usize {
            return Err(MeshError::new("it has too many points; the maximum is 4 294 967 294"));
        }
        for &[x, y, z] in coordinates.as_chunks::<3>().0 {
            let position = DVec3::new(x, y, z);
            if !is_placed(position) {
                return Err(not_placed(MeshLocation::Vertex(self.positions.len() as u64), position, None));
            }
            self.positions.push(position);
        }
        Ok(())
    }

    /// Adds the cells of a structured grid of this many points along its axes: volumes, or faces if one axis has a
    /// single point.
    pub fn push_structured(&mut self, [nx, ny, nz]: [usize; 3]) -> Result<(), String> {
        let index = |[x, y, z]: [usize; 3]| ((z * ny + y) * nx + x) as f64;
        let (counts, points) = ([nx, ny, nz], self.positions.len());
        // The axes along which there are cells.
        let axes: Vec<usize> = (0..3).filter(|&axis| counts[axis] > 1).collect();
        let last = counts.map(|count| (count - 1).max(1));
        // The corners of a quadrilateral and of a hexahedron, in VTK's order.
        const CORNERS: [[usize; 3]; 8] =
            [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
        let (kind, corners) = match axes.len() {
            2 => (surface::QUAD, &CORNERS[..4]),
            3 => (surface::HEXAHEDRON, &CORNERS[..]),
            _ => return Err(format!("a grid of {nx} x {ny} x {nz} points has no faces")),
        };
        for z in 0..last[2] {
            for y in 0..last[1] {
                for x in 0..last[0] {
                    let corner = |steps: &[usize; 3]| {
                        let mut at = [x, y, z];
                        axes.iter().zip(steps).for_each(|(&axis, step)| at[axis] += step);
                        index(at)
                    };
                    self.cells.push(kind, corners.iter().map(corner), points)?;
                }
            }
        }
        Ok(())
    }

    /// The number of entries of data.
    pub fn entries(&self, centering: Centering) -> usize {
        match centering {
            Centering::Points => self.positions.len(),
            Centering::Cells => self.cells.len(),
        }
    }
}

//! Legacy VTK files (`.vtk`): a few lines of text that announce numbers, as text or in big-endian binary.

mod attributes;
mod source;

use super::grid::{Cells, Grid};
use super::number::NumberType;
use super::surface::POLYGONAL_KINDS;
use crate::geometry::mesh::{Centering, MeshError, MeshLocation};
use crate::import::lines::quoted;
use source::Source;

/// Reads the bytes of a file.
pub fn read(bytes: &[u8]) -> Result<Grid, MeshError> {
    let mut source = Source::new(bytes);
    let first = source.line().unwrap_or_default();
    if !first.to_ascii_lowercase().starts_with("# vtk datafile") {
        let why = "it is no legacy VTK file: its first line is not like `# vtk DataFile Version 3.0`";
        return Err(source.fault(why));
    }
    source.line();
    let encoding = source.words().unwrap_or_default().concat().to_ascii_uppercase();
    let binary = match encoding.as_str() {
        "ASCII" => false,
        "BINARY" => true,
        _ => return Err(source.unexpected("`ASCII` or `BINARY`")),
    };
    let words = source.words().unwrap_or_default();
    let kind = match &words.iter().map(|word| word.to_ascii_uppercase()).collect::<Vec<_>>()[..] {
        [dataset, kind] if dataset == "DATASET" => kind.clone(),
        _ => return Err(source.unexpected("`DATASET` and its kind")),
    };
    if !["POLYDATA", "UNSTRUCTURED_GRID", "STRUCTURED_GRID"].contains(&kind.as_str()) {
        return Err(source.unexpected("`DATASET POLYDATA`, `UNSTRUCTURED_GRID` or `STRUCTURED_GRID`"));
    }
    source.binary = binary;
    let mut reader = Reader {
        source,
        grid: Grid::default(),
        parts: Default::default(),
        kinds: None,
        cells: None,
        array_places: Vec::new(),
        data: None,
    };
    while let Some(words) = reader.source.words() {
        reader.section(&words)?;
    }
    reader.finished()
}

struct Reader<'b> {
    source: Source<'b>,
    grid: Grid,
    /// Polygonal data, in the order of [`POLYGONAL_KINDS`].
    parts: [Cells; 4],
    /// The types of the cells of an unstructured grid, and the place of their section.
    kinds: Option<(Vec<f64>, MeshLocation)>,
    /// The cells' corners and ends, and the place of their section.
    cells: Option<(Vec<f64>, Vec<f64>, MeshLocation)>,
    /// The places of the grid's data arrays.
    array_places: Vec<MeshLocation>,
    /// What the data that follows belongs to, and its number of entries.
    data: Option<(Centering, u64)>,
}

impl Reader<'_> {
    fn section(&mut self, words: &[String]) -> Result<(), MeshError> {
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let keyword = words[0].to_ascii_uppercase();
        match (keyword.as_str(), &words[1..]) {
            ("POINTS", [amount, kind]) => {
                let (amount, kind) = (self.count(amount)?, self.kind(kind)?);
                let coordinates = self.source.numbers(amount.saturating_mul(3), kind, "`POINTS`")?;
                self.grid.push_points(&coordinates)
            }
            ("DIMENSIONS", [x, y, z]) => self.structured([x, y, z]),
            ("CELLS", [first, second]) => {
                let place = self.source.place();
                let (corners, ends) = self.cell_list(first, second, "`CELLS`")?;
                self.cells = Some((corners, ends, place));
                Ok(())
            }
            ("CELL_TYPES", [amount]) => {
                let (amount, place) = (self.count(amount)?, self.source.place());
                self.kinds = Some((self.source.numbers(amount, NumberType::I32, "`CELL_TYPES`")?, place));
                Ok(())
            }
            (keyword, [first, second])
                if let Some(index) = POLYGONAL_KINDS.iter().position(|kind| kind.section == keyword) =>
            {
                let (corners, ends) = self.cell_list(first, second, &format!("`{keyword}`"))?;
                let (kind, points) = (POLYGONAL_KINDS[index].cell_type, self.grid.positions.len());
                let added = self.parts[index].push_listed(|_| kind.into(), &corners, &ends, points);
                added.map_err(|why| self.source.fault(format!("in `{keyword}`, {why}")))
            }
            ("POINT_DATA", [amount]) => {
                self.data = Some((Centering::Points, self.count(amount)?));
                Ok(())
            }
            ("CELL_DATA", [amount]) => {
                self.data = Some((Centering::Cells, self.count(amount)?));
                Ok(())
            }
            ("METADATA", _) => {
                self.source.skip_section();
                Ok(())
            }
            ("FIELD", [_, amount]) => self.fields(amount),
            (keyword, rest) => match self.data {
                Some((centering, entries)) => self.attribute(keyword, rest, centering, entries),
                None => Err(self
                    .source
                    .unexpected("a section such as `POINTS`, `POLYGONS`, `CELLS` or `POINT_DATA`")),
            },
        }
    }

    fn count(&self, word: &str) -> Result<u64, MeshError> {
        word.parse()
            .map_err(|_| self.source.fault(format!("expected a count, found {}", quoted(word.as_bytes()))))
    }

    fn kind(&self, word: &str) -> Result<NumberType, MeshError> {
        let why = || {
            self.source.fault(format!("expected a type such as `float`, found {}", quoted(word.as_bytes())))
        };
        NumberType::legacy(word).ok_or_else(why)
    }

    fn structured(&mut self, sizes: [&&str; 3]) -> Result<(), MeshError> {
        let mut counts = [0; 3];
        for (count, size) in counts.iter_mut().zip(sizes) {
            *count = self.count(size)?;
        }
        let Some(words) = self.source.words() else {
            return Err(self.source.fault("the file ends before `POINTS`"));
        };
        let points = counts.iter().try_fold(1_u64, |product, &count| product.checked_mul(count));
        match &words.iter().map(String::as_str).collect::<Vec<_>>()[..] {
            ["POINTS", amount, _] if Some(self.count(amount)?) == points => {}
            _ => {
                let [x, y, z] = counts;
                return Err(self
                    .source
                    .unexpected(&format!("`POINTS` of the {x} x {y} x {z} points of `DIMENSIONS`")));
            }
        }
        self.section(&words)?;
        if counts.contains(&0) {
            return Err(self.source.fault("`DIMENSIONS` are at least 1"));
        }
        self.grid.push_structured(counts.map(|count| count as usize)).map_err(|why| self.source.fault(why))
    }

    /// The corners and the ends of cells, in either of the two notations.
    fn cell_list(
        &mut self,
        first: &str,
        second: &str,
        what: &str,
    ) -> Result<(Vec<f64>, Vec<f64>), MeshError> {
        let (cells, size) = (self.count(first)?, self.count(second)?);
        match self.source.offsets_follow() {
            true => self.offsets(cells, size, what),
            false => self.counted(cells, size, what),
        }
    }

    /// Each cell as the number of its corners and these.
    fn counted(&mut self, cells: u64, size: u64, what: &str) -> Result<(Vec<f64>, Vec<f64>), MeshError> {
        let numbers = self.source.numbers(size, NumberType::I32, what)?;
        let (mut corners, mut ends, mut at) = (Vec::with_capacity(numbers.len()), Vec::new(), 0);
        while let Some(&amount) = numbers.get(at) {
            let Some(own) = numbers[at + 1..].get(..amount as usize).filter(|_| amount >= 0.0) else {
                let why = format!("cell {} of {what} has {amount} points; the list has fewer", ends.len());
                return Err(self.source.fault(why));
            };
            corners.extend(own);
            ends.push(corners.len() as f64);
            at += 1 + own.len();
        }
        if ends.len() as u64 != cells {
            return Err(self.source.fault(format!("{what} has {} cells instead of {cells}", ends.len())));
        }
        Ok((corners, ends))
    }

    /// Lists of offsets and corners, as since VTK 5.1.
    fn offsets(&mut self, offsets: u64, size: u64, what: &str) -> Result<(Vec<f64>, Vec<f64>), MeshError> {
        let mut lists = [Vec::new(), Vec::new()];
        for (list, (name, amount)) in lists.iter_mut().zip([("OFFSETS", offsets), ("CONNECTIVITY", size)]) {
            let words = self.source.words().unwrap_or_default();
            let kind = match &words[..] {
                [word, kind] if word.eq_ignore_ascii_case(name) => self.kind(kind)?,
                _ => return Err(self.source.unexpected(&format!("`{name}` and a type"))),
            };
            *list = self.source.numbers(amount, kind, what)?;
        }
        let [ends, corners] = lists;
        Ok((corners, ends.into_iter().skip(1).collect()))
    }

    /// The grid with all its cells.
    fn finished(self) -> Result<Grid, MeshError> {
        let Self { source, mut grid, parts, kinds, cells, array_places, .. } = self;
        match (kinds, cells) {
            (Some((kinds, types_place)), Some((corners, ends, place))) => {
                if kinds.len() != ends.len() {
                    let why = format!("`CELL_TYPES` has {} types for {} cells", kinds.len(), ends.len());
                    return Err(MeshError::at(types_place, why));
                }
                let points = grid.positions.len();
                let added = grid.cells.push_listed(|cell| kinds[cell], &corners, &ends, points);
                added.map_err(|why| MeshError::at(place, format!("in `CELLS`, {why}")))?;
            }
            (None, None) => {}
            _ => return Err(source.fault("the file ends, but it needs both `CELLS` and `CELL_TYPES`")),
        }
        parts.into_iter().for_each(|part| grid.cells.append(part));
        for (array, place) in grid.arrays.iter().zip(array_places) {
            let needed = grid.entries(array.centering);
            if array.entries() != needed {
                let (name, entries) = (&array.name, array.entries());
                return Err(MeshError::at(
                    place,
                    format!("the data `{name}` has {entries} entries; it needs {needed}"),
                ));
            }
        }
        Ok(grid)
    }
}

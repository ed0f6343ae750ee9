//! Accessors: typed numbers in buffers, also sparse and normalised ones. Every size is checked against the bytes that
//! are there before memory is taken.
//!
//! Source: glTF 2.0 specification, sections 3.6.2 (accessors) and 3.11 (normalised integers).

use super::GltfResult;
use super::buffers::Buffers;
use super::json::Item;
use crate::base::lists::either;
use crate::base::machine;
use crate::geometry::mesh::MeshError;
use rayon::prelude::*;

/// The largest number of elements that are stored nowhere, because all of them are zero.
const MAX_ZEROS: u64 = 1 << 24;

/// Fewest elements that several threads read together.
const MANY: usize = 1 << 16;

/// The type of the numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Number {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Number {
    fn of(code: u64) -> Option<Self> {
        Some(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    /// Its code and its name in the specification.
    fn name(self) -> &'static str {
        match self {
            Self::I8 => "5120 (byte)",
            Self::U8 => "5121 (unsigned byte)",
            Self::I16 => "5122 (short)",
            Self::U16 => "5123 (unsigned short)",
            Self::U32 => "5125 (unsigned int)",
            Self::F32 => "5126 (float)",
        }
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// The number at the start of some bytes, of which there are enough. Normalised integers become -1..=1 or 0..=1.
    fn read(self, bytes: &[u8], normalized: bool) -> f64 {
        fn first<const N: usize>(bytes: &[u8]) -> [u8; N] {
            bytes.first_chunk().copied().unwrap_or([0; N])
        }
        let (value, largest) = match self {
            Self::I8 => (f64::from(i8::from_le_bytes(first(bytes))), 127.0),
            Self::U8 => (f64::from(u8::from_le_bytes(first(bytes))), 255.0),
            Self::I16 => (f64::from(i16::from_le_bytes(first(bytes))), 32767.0),
            Self::U16 => (f64::from(u16::from_le_bytes(first(bytes))), 65535.0),
            Self::U32 => return f64::from(u32::from_le_bytes(first(bytes))),
            Self::F32 => return f64::from(f32::from_le_bytes(first(bytes))),
        };
        if normalized { (value / largest).max(-1.0) } else { value }
    }
}

/// Elements of a number of components each.
pub struct Accessor<'a> {
    index: usize,
    pub count: usize,
    components: usize,
    number: Number,
    normalized: bool,
    /// Bytes and the distance of elements; all elements are zero if there are none.
    dense: Option<(&'a [u8], usize)>,
    sparse: Option<Sparse<'a>>,
}

/// Elements that replace others.
struct Sparse<'a> {
    count: usize,
    indices: (&'a [u8], Number),
    values: &'a [u8],
}

impl<'a> Accessor<'a> {
    /// The accessor with an index that has been checked.
    pub fn new(root: &Item<'_>, buffers: &'a Buffers<'_>, index: usize) -> GltfResult<Self> {
        let item = root.entry("accessors", index)?;
        let count = item.whole("count")?.ok_or_else(|| item.error("it has no `count`"))?;
        let number = number(&item)?;
        let kind = item.text("type")?.ok_or_else(|| item.error("it has no `type`"))?;
        let components = match kind {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            "MAT4" => 16,
            _ => return Err(item.error("its `type` is not SCALAR, VEC2, VEC3, VEC4 or MAT4")),
        };
        let size = number.size() * components;
        let dense = match item.index("bufferView", ("bufferViews", buffers.views()))? {
            Some(view) => {
                let (bytes, stride) = buffers.view(view)?;
                let stride = stride.unwrap_or(size);
                if stride < size {
                    return Err(
                        item.error(format!("its elements have {size} bytes, but lie {stride} bytes apart"))
                    );
                }
                let bytes = from(bytes, item.whole("byteOffset")?.unwrap_or(0));
                let fits = bytes.is_some_and(|bytes| fits(bytes, count, stride, size));
                let Some(bytes) = bytes.filter(|_| fits) else {
                    return Err(
                        item.error(format!("bufferViews[{view}] is too short for its {count} elements"))
                    );
                };
                Some((bytes, stride))
            }
            None if count > MAX_ZEROS => {
                return Err(item.error(format!("it has {count} elements, but no bufferView")));
            }
            None => None,
        };
        let sparse =
            item.object("sparse")?.map(|item| Sparse::new(&item, buffers, size, count)).transpose()?;
        let normalized = item.flag("normalized", false)?;
        Ok(Self { index, count: count as usize, components, number, normalized, dense, sparse })
    }

    /// The number type and the number of components.
    pub fn layout(&self) -> (Number, bool, usize) {
        (self.number, self.normalized, self.components)
    }

    pub fn error(&self, why: impl std::fmt::Display) -> MeshError {
        MeshError::new(format!("accessors[{}]: {why}", self.index))
    }

    /// All elements, of `N` components each.
    ///
    /// # Errors
    /// Another number of components, numbers that are not finite, and too little memory.
    pub fn elements<const N: usize>(&self) -> GltfResult<Vec<[f64; N]>> {
        if self.components != N {
            return Err(self.error(format!("its elements have {} numbers, not {N}", self.components)));
        }
        machine::check_memory((self.count * N * size_of::<f64>()) as u64)?;
        let element = |bytes: &[u8]| {
            let part = |at: usize| bytes.get(at * self.number.size()..).unwrap_or_default();
            std::array::from_fn(|at| self.number.read(part(at), self.normalized))
        };
        let mut all = match self.dense {
            Some((bytes, stride)) => {
                let read = |at: usize| element(bytes.get(at * stride..).unwrap_or_default());
                match self.count < MANY {
                    true => (0..self.count).map(read).collect(),
                    false => (0..self.count).into_par_iter().with_min_len(MANY / 4).map(read).collect(),
                }
            }
            None => vec![[0.0; N]; self.count],
        };
        if let Some(sparse) = &self.sparse {
            let size = N * self.number.size();
            for at in 0..sparse.count {
                let index = sparse.index(at);
                let values = sparse.values.get(at * size..).unwrap_or_default();
                let Some(found) = all.get_mut(index) else {
                    return Err(self.error(format!("its sparse element {index} does not exist")));
                };
                *found = element(values);
            }
        }
        match all.iter().position(|element| element.iter().any(|number| !number.is_finite())) {
            Some(at) => Err(self.error(format!("its element {at} is not finite"))),
            None => Ok(all),
        }
    }

    /// All elements as whole numbers of one of the types `allowed`; `what` names them in messages.
    ///
    /// # Errors
    /// Another type, normalised numbers, another number of components, and too little memory.
    pub fn whole<const N: usize>(&self, what: &str, allowed: &[Number]) -> GltfResult<Vec<[u32; N]>> {
        if !allowed.contains(&self.number) {
            let names: Vec<_> = allowed.iter().map(|number| number.name()).collect();
            let names = either(names);
            return Err(self.error(format!("{what} have the component type {names}")));
        }
        if self.normalized {
            return Err(self.error(format!("{what} are whole numbers, but it is `normalized`")));
        }
        // Every number of 32 bits is exact in f64.
        Ok(self.elements::<N>()?.into_iter().map(|numbers| numbers.map(|number| number as u32)).collect())
    }
}

impl<'a> Sparse<'a> {
    fn new(item: &Item<'_>, buffers: &'a Buffers<'_>, size: usize, elements: u64) -> GltfResult<Self> {
        let count = item.whole("count")?.unwrap_or(0);
        if count > elements {
            return Err(item.error(format!("it replaces {count} of {elements} elements")));
        }
        let (indices, values) = (item.required("indices")?, item.required("values")?);
        let bytes = |item: &Item<'_>, size: usize| {
            let view = item.index("bufferView", ("bufferViews", buffers.views()))?;
            let view = view.ok_or_else(|| item.error("it has no `bufferView`"))?;
            let bytes = from(buffers.view(view)?.0, item.whole("byteOffset")?.unwrap_or(0));
            let bytes = bytes.filter(|bytes| fits(bytes, count, size, size));
            bytes.ok_or_else(|| item.error(format!("bufferViews[{view}] is too short for {count} elements")))
        };
        let number = number(&indices)?;
        if !matches!(number, Number::U8 | Number::U16 | Number::U32) {
            return Err(indices.error("its `componentType` is not an unsigned one"));
        }
        let (of_indices, of_values) = (bytes(&indices, number.size())?, bytes(&values, size)?);
        Ok(Self { count: count as usize, indices: (of_indices, number), values: of_values })
    }

    fn index(&self, at: usize) -> usize {
        let (bytes, number) = self.indices;
        number.read(bytes.get(at * number.size()..).unwrap_or_default(), false) as usize
    }
}

fn number(item: &Item<'_>) -> GltfResult<Number> {
    let code = item.whole("componentType")?.and_then(Number::of);
    code.ok_or_else(|| item.error("its `componentType` is none of 5120, 5121, 5122, 5123, 5125 and 5126"))
}

/// The bytes from an offset on.
fn from(bytes: &[u8], offset: u64) -> Option<&[u8]> {
    bytes.get(usize::try_from(offset).ok()?..)
}

/// Whether some bytes hold `count` elements of `size` bytes, `stride` bytes apart.
fn fits(bytes: &[u8], count: u64, stride: usize, size: usize) -> bool {
    let Some(before) = count.checked_sub(1) else { return true };
    let needed = before.checked_mul(stride as u64).and_then(|before| before.checked_add(size as u64));
    needed.is_some_and(|needed| needed <= bytes.len() as u64)
}

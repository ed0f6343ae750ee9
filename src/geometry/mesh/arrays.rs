//! Data arrays: numbers that a file gives for every vertex or every face, such as a pressure or a velocity.

use crate::base::digest::{Content, Digest, Digester};
use std::sync::OnceLock;

/// What the entries of an array belong to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Content)]
pub enum Centering {
    /// The vertices of the mesh. Values vary linearly over a triangle.
    Points,
    /// The triangles of the mesh. All triangles of a face have its value.
    Cells,
}

/// A named array of a mesh: one entry per vertex or per triangle, each of one or more components.
#[derive(Clone, Debug, PartialEq)]
pub struct DataArray {
    pub name: String,
    pub centering: Centering,
    /// Numbers per entry, at least 1.
    pub components: usize,
    /// All components of an entry are consecutive.
    pub values: ArrayValues,
}

/// The numbers of an array, in f32 if that is exact for all of them. Most files hold floats, which take half the
/// memory then; in f32 alone, an atmospheric pressure in pascals would have steps of 0.008.
#[derive(Clone, Debug, PartialEq)]
pub enum ArrayValues {
    F32(Vec<f32>),
    F64(Vec<f64>),
}

/// The number that is taken of an entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Content)]
pub enum Component {
    /// The only component, or the length of the vector of all components.
    Whole,
    Index(u32),
}

/// The numbers of meshes that a texture reads.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct ArrayKey {
    pub name: String,
    /// Points before cells, if not given.
    pub centering: Option<Centering>,
    pub component: Component,
}

impl ArrayKey {
    /// All components of the data of this name.
    pub fn whole(name: String) -> Self {
        Self { name, centering: None, component: Component::Whole }
    }

    /// The index of the array that has these numbers.
    pub fn find_in(&self, arrays: &[DataArray]) -> Option<usize> {
        let index = self.index(arrays.iter().map(|array| (array.name.as_str(), array.centering)))?;
        arrays[index].has(self.component).then_some(index)
    }

    /// The index of the array that the key means, among arrays of these names and centerings.
    pub fn index<'a>(&self, arrays: impl Iterator<Item = (&'a str, Centering)> + Clone) -> Option<usize> {
        let of = |centering| arrays.clone().position(|array| array == (self.name.as_str(), centering));
        match self.centering {
            Some(centering) => of(centering),
            None => of(Centering::Points).or_else(|| of(Centering::Cells)),
        }
    }
}

impl Content for ArrayKey {
    fn feed(&self, into: &mut Digester) {
        let Self { name, centering, component } = self;
        name.as_str().feed(into);
        centering.feed(into);
        component.feed(into);
    }
}

impl From<Vec<f64>> for ArrayValues {
    fn from(values: Vec<f64>) -> Self {
        let exact = |value: &f64| value.is_nan() || f64::from(*value as f32) == *value;
        match values.iter().all(exact) {
            true => Self::F32(values.into_iter().map(|value| value as f32).collect()),
            false => Self::F64(values),
        }
    }
}

impl ArrayValues {
    pub fn len(&self) -> usize {
        match self {
            Self::F32(values) => values.len(),
            Self::F64(values) => values.len(),
        }
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// # Panics
    /// If the index is out of range.
    #[inline]
    pub fn get(&self, index: usize) -> f64 {
        match self {
            Self::F32(values) => values[index].into(),
            Self::F64(values) => values[index],
        }
    }

    /// Adds numbers at the end.
    pub fn extend(&mut self, other: &Self) {
        match (&mut *self, other) {
            (Self::F32(values), Self::F32(more)) => values.extend(more),
            (Self::F64(values), _) => values.extend((0..other.len()).map(|index| other.get(index))),
            (Self::F32(values), Self::F64(more)) => {
                let values = values.iter().map(|&value| f64::from(value));
                *self = Self::F64(values.chain(more.iter().copied()).collect());
            }
        }
    }

    /// Keeps the groups of `components` numbers whose flag is set.
    fn retain(&mut self, components: usize, keep: &[bool]) {
        fn kept<T: Copy>(values: &[T], components: usize, keep: &[bool]) -> Vec<T> {
            let groups = values.chunks(components).zip(keep).filter(|(_, keep)| **keep);
            groups.flat_map(|(group, _)| group.iter().copied()).collect()
        }
        match self {
            Self::F32(values) => *values = kept(values, components, keep),
            Self::F64(values) => *values = kept(values, components, keep),
        }
    }
}

impl DataArray {
    /// Whether it holds the same quantity as another array, of other entries.
    pub fn is_like(&self, other: &Self) -> bool {
        (&self.name, self.centering, self.components) == (&other.name, other.centering, other.components)
    }

    /// The number of entries.
    pub fn entries(&self) -> usize {
        self.values.len() / self.components.max(1)
    }

    /// A number of an entry.
    #[inline]
    pub fn value(&self, entry: usize, component: Component) -> f64 {
        let first = entry * self.components;
        match component {
            Component::Whole if self.components == 1 => self.values.get(first),
            Component::Whole => length((first..first + self.components).map(|index| self.values.get(index))),
            Component::Index(index) => self.values.get(first + index as usize),
        }
    }

    /// Whether entries have this component.
    pub fn has(&self, component: Component) -> bool {
        match component {
            Component::Whole => true,
            Component::Index(index) => (index as usize) < self.components,
        }
    }

    /// The smallest and the largest number of some entries, without those that are not finite or fail `counts`.
    pub fn range(
        &self,
        entries: impl Iterator<Item = usize>,
        component: Component,
        counts: impl Fn(f64) -> bool,
    ) -> Option<[f64; 2]> {
        let values = entries.map(|entry| self.value(entry, component));
        values.filter(|value| value.is_finite() && counts(*value)).fold(None, |range, value| {
            let [min, max] = range.unwrap_or([value; 2]);
            Some([min.min(value), max.max(value)])
        })
    }

    /// The smallest and the largest number on these triangles, without those that are not finite or fail `counts`.
    pub fn range_on(
        &self,
        triangles: &[[u32; 3]],
        component: Component,
        counts: impl Fn(f64) -> bool,
    ) -> Option<[f64; 2]> {
        match self.centering {
            Centering::Cells => self.range(0..self.entries(), component, counts),
            Centering::Points => {
                let corners = triangles.as_flattened().iter();
                self.range(corners.map(|vertex| *vertex as usize), component, counts)
            }
        }
    }

    /// Removes the triangles that `keep` does not flag.
    pub(super) fn retain_triangles(&mut self, keep: &[bool]) {
        if self.centering == Centering::Cells {
            self.values.retain(self.components, keep);
        }
    }

    /// The digest of the numbers.
    pub fn digest(&self) -> Digest {
        match &self.values {
            ArrayValues::F32(values) => Digest::of(&(self.components, values)),
            ArrayValues::F64(values) => Digest::of(&(self.components, values)),
        }
    }
}

/// The length of a vector.
fn length(components: impl Iterator<Item = f64> + Clone) -> f64 {
    // Powers of two scale exactly.
    const LARGE: f64 = f64::from_bits((1023 + 600) << 52);
    let scaled = |scale: f64| {
        let squares = components.clone().map(|component| (component * scale) * (component * scale));
        squares.sum::<f64>()
    };
    match scaled(1.0) {
        f64::INFINITY => scaled(1.0 / LARGE).sqrt() * LARGE,
        small if small < f64::MIN_POSITIVE * LARGE => scaled(LARGE).sqrt() / LARGE,
        square => square.sqrt(),
    }
}

/// The arrays of a mesh. Digests are computed when they are needed: most frames show no array.
#[derive(Debug, Default)]
pub(super) struct DataArrays {
    arrays: Vec<DataArray>,
    digests: Vec<OnceLock<Digest>>,
}

impl DataArrays {
    pub fn new(arrays: Vec<DataArray>) -> Self {
        let digests = arrays.iter().map(|_| OnceLock::new()).collect();
        Self { arrays, digests }
    }

    pub fn all(&self) -> &[DataArray] {
        &self.arrays
    }

    pub fn find(&self, key: &ArrayKey) -> Option<&DataArray> {
        key.find_in(&self.arrays).map(|index| &self.arrays[index])
    }

    pub fn digest(&self, key: &ArrayKey) -> Option<Digest> {
        let index = key.find_in(&self.arrays)?;
        Some(*self.digests[index].get_or_init(|| self.arrays[index].digest()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn array(components: usize, values: &[f64]) -> DataArray {
        let (name, centering) = ("a".to_owned(), Centering::Cells);
        DataArray { name, centering, components, values: values.to_vec().into() }
    }

    #[test]
    fn numbers_are_kept_exactly() {
        assert!(matches!(array(1, &[0.5, -3.0, f64::NAN, f64::INFINITY]).values, ArrayValues::F32(_)));
        for value in [0.1, 101_325.01, 16_777_217.0, 1e-60, 1e300] {
            let array = array(1, &[0.5, value]);
            assert!(matches!(array.values, ArrayValues::F64(_)), "{value}");
            assert_eq!(array.value(1, Component::Whole), value);
        }
    }

    #[test]
    fn entries_have_components_and_a_length() {
        let mut velocities = array(3, &[3.0, 0.0, 4.0, -1.0, 0.0, 0.0]);
        assert_eq!([0, 1].map(|entry| velocities.value(entry, Component::Whole)), [5.0, 1.0]);
        assert_eq!(velocities.value(0, Component::Index(2)), 4.0);
        assert_eq!([2, 3].map(|index| velocities.has(Component::Index(index))), [true, false]);
        assert_eq!(velocities.range(0..2, Component::Index(0), |_| true), Some([-1.0, 3.0]));
        velocities.retain_triangles(&[false, true]);
        assert_eq!((velocities.entries(), velocities.value(0, Component::Index(0))), (1, -1.0));
        assert_eq!(
            array(1, &[-2.0, 7.0]).range(0..2, Component::Whole, |_| true),
            Some([-2.0, 7.0]),
            "signs stay"
        );
    }

    /// Squares of components overflow above 1e154, and are inexact below 1e-145.
    #[test]
    fn lengths_neither_overflow_nor_underflow() {
        for exponent in -1060..=1020 {
            let unit = libm::exp2(f64::from(exponent));
            assert_eq!(
                array(2, &[3.0 * unit, -4.0 * unit]).value(0, Component::Whole),
                5.0 * unit,
                "{exponent}"
            );
        }
        assert_eq!(array(2, &[0.0, 0.0]).value(0, Component::Whole), 0.0);
        assert_eq!(array(2, &[f64::INFINITY, 1.0]).value(0, Component::Whole), f64::INFINITY);
        assert!(array(2, &[f64::NAN, 1e200]).value(0, Component::Whole).is_nan());
    }

    #[test]
    fn ranges_leave_out_what_is_not_finite() {
        let values = array(1, &[f64::NAN, 2.0, f64::INFINITY, -1.0, 0.25]);
        assert_eq!(values.range(0..5, Component::Whole, |_| true), Some([-1.0, 2.0]));
        assert_eq!(values.range(0..5, Component::Whole, |value| value > 0.0), Some([0.25, 2.0]));
        assert_eq!(array(1, &[f64::NAN]).range(0..1, Component::Whole, |_| true), None);
    }
}

//! Digests: 128-bit hashes of values, by which two moments of a scene are compared and named.
//!
//! A digest depends only on the contents of a value. It is the same in every run and on every processor. It does not
//! depend on memory addresses nor on values hashed before.

pub use kinora_derive::Content;

use glam::{DAffine3, DMat3, DVec2, DVec3, Vec3};
use std::fmt::{Display, Formatter};

/// The first 128 bits of the BLAKE3 hash of a value's contents.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Digest(pub u128);

impl Digest {
    /// The digest of a value.
    pub fn of(value: &(impl Content + ?Sized)) -> Self {
        let mut digester = Digester::new();
        value.feed(&mut digester);
        digester.finish()
    }
}

/// 32 hexadecimal digits.
impl Display for Digest {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:032x}", self.0)
    }
}

/// A value whose contents can be hashed.
///
/// Values of fixed size feed their bytes. Values with a length or with variants feed the length or the variant first,
/// so that different values of a type feed different bytes. `derive(Content)` implements it for structs and enums.
pub trait Content {
    fn feed(&self, into: &mut Digester);

    /// Feeds all values of a list, but not their number.
    fn feed_each(values: &[Self], into: &mut Digester)
    where
        Self: Sized,
    {
        values.iter().for_each(|value| value.feed(into));
    }
}

/// Computes a digest.
pub struct Digester {
    /// What was hashed already; none of most values, which are short.
    hasher: Option<Box<blake3::Hasher>>,
    /// Bytes not hashed yet. Hashing many short pieces takes longer than one long piece.
    bytes: Vec<u8>,
}

/// The size of `bytes`, in bytes, from which they are hashed.
const BUFFER_SIZE: usize = 1 << 16;

/// Numbers that are copied at once.
const PIECE: usize = 64;

impl Digester {
    pub fn new() -> Self {
        // Most values fit, so the list does not grow in steps.
        Self { hasher: None, bytes: Vec::with_capacity(256) }
    }

    /// Adds bytes, but not their number.
    pub fn bytes(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
        if self.bytes.len() >= BUFFER_SIZE {
            self.hasher.get_or_insert_default().update(&self.bytes);
            self.bytes.clear();
        }
    }

    /// Adds the bytes of many numbers, but not how many these are.
    fn numbers<T: Copy, const N: usize>(&mut self, numbers: &[T], bytes: impl Fn(T) -> [u8; N]) {
        // A list that grows number by number takes longer than hashing.
        let mut some = [[0; N]; PIECE];
        for numbers in numbers.chunks(some.len()) {
            some.iter_mut().zip(numbers).for_each(|(some, number)| *some = bytes(*number));
            self.bytes(some[..numbers.len()].as_flattened());
        }
    }

    pub fn finish(self) -> Digest {
        let hash = match self.hasher {
            None => blake3::hash(&self.bytes),
            Some(mut hasher) => hasher.update(&self.bytes).finalize(),
        };
        let mut digest = [0; 16];
        digest.copy_from_slice(&hash.as_bytes()[..16]);
        Digest(u128::from_be_bytes(digest))
    }
}

impl Default for Digester {
    fn default() -> Self {
        Self::new()
    }
}

macro_rules! whole_numbers {
    ($($number:ty),*) => {
        $(impl Content for $number {
            fn feed(&self, into: &mut Digester) {
                into.bytes(&self.to_le_bytes());
            }

            fn feed_each(values: &[Self], into: &mut Digester) {
                into.numbers(values, |number| number.to_le_bytes());
            }
        })*
    };
}

whole_numbers!(u8, u16, u32, u64, u128, i32, i64);

/// Feeds all bits. 0 and -0 feed the same bits, because they are equal in a search for changes; so do all NaNs.
macro_rules! real_numbers {
    ($($number:ident),*) => {
        $(impl Content for $number {
            fn feed(&self, into: &mut Digester) {
                let number = if self.is_nan() { $number::NAN } else { *self + 0.0 };
                into.bytes(&number.to_bits().to_le_bytes());
            }

            fn feed_each(values: &[Self], into: &mut Digester) {
                into.numbers(values, |number| {
                    let number = if number.is_nan() { $number::NAN } else { number + 0.0 };
                    number.to_bits().to_le_bytes()
                });
            }
        })*
    };
}

real_numbers!(f32, f64);

impl Content for bool {
    fn feed(&self, into: &mut Digester) {
        u8::from(*self).feed(into);
    }
}

impl Content for usize {
    fn feed(&self, into: &mut Digester) {
        (*self as u64).feed(into);
    }
}

impl Content for str {
    fn feed(&self, into: &mut Digester) {
        self.len().feed(into);
        into.bytes(self.as_bytes());
    }
}

impl Content for String {
    fn feed(&self, into: &mut Digester) {
        self.as_str().feed(into);
    }
}

impl Content for Digest {
    fn feed(&self, into: &mut Digester) {
        self.0.feed(into);
    }
}

impl<T: Content> Content for [T] {
    fn feed(&self, into: &mut Digester) {
        self.len().feed(into);
        T::feed_each(self, into);
    }
}

impl<T: Content> Content for Vec<T> {
    fn feed(&self, into: &mut Digester) {
        self.as_slice().feed(into);
    }
}

impl<T: Content, const N: usize> Content for [T; N] {
    fn feed(&self, into: &mut Digester) {
        self.iter().for_each(|value| value.feed(into));
    }

    fn feed_each(values: &[Self], into: &mut Digester) {
        T::feed_each(values.as_flattened(), into);
    }
}

impl<T: Content> Content for Option<T> {
    fn feed(&self, into: &mut Digester) {
        self.is_some().feed(into);
        if let Some(value) = self {
            value.feed(into);
        }
    }
}

impl<T: Content + ?Sized> Content for Box<T> {
    fn feed(&self, into: &mut Digester) {
        (**self).feed(into);
    }
}

impl<T: Content + ?Sized> Content for &T {
    fn feed(&self, into: &mut Digester) {
        (**self).feed(into);
    }
}

impl<A: Content, B: Content> Content for (A, B) {
    fn feed(&self, into: &mut Digester) {
        self.0.feed(into);
        self.1.feed(into);
    }
}

impl<A: Content, B: Content, C: Content> Content for (A, B, C) {
    fn feed(&self, into: &mut Digester) {
        self.0.feed(into);
        self.1.feed(into);
        self.2.feed(into);
    }
}

macro_rules! vectors {
    ($($vector:ident),*) => {
        $(impl Content for $vector {
            fn feed(&self, into: &mut Digester) {
                self.to_array().feed(into);
            }

            fn feed_each(values: &[Self], into: &mut Digester) {
                for values in values.chunks(PIECE) {
                    let mut some = [$vector::ZERO.to_array(); PIECE];
                    some.iter_mut().zip(values).for_each(|(some, value)| *some = value.to_array());
                    Content::feed_each(&some[..values.len()], into);
                }
            }
        })*
    };
}

vectors!(DVec2, DVec3, Vec3);

impl Content for DMat3 {
    fn feed(&self, into: &mut Digester) {
        self.to_cols_array().feed(into);
    }
}

impl Content for DAffine3 {
    fn feed(&self, into: &mut Digester) {
        self.to_cols_array().feed(into);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Content)]
    struct Lamp {
        name: &'static str,
        power: f64,
    }

    #[derive(Content)]
    enum Kind {
        Off,
        Fixed(u32),
        Keyed { first: u32 },
    }

    /// Names of frames outlive the program, so digests stay the same on every machine and in every run.
    #[test]
    fn digests_are_known() {
        assert_eq!(Digest::of(&[0u8; 0]).to_string(), "af1349b9f5f9a1a6a0404dea36dcc949");
        let lamp = Lamp { name: "key", power: 0.1 };
        assert_eq!(Digest::of(&lamp), Digest::of(&(3u64, (*b"key", 0.1f64.to_bits()))));
    }

    #[test]
    fn different_values_have_different_digests() {
        let lists: [&[&str]; 4] = [&[], &["ab"], &["a", "b"], &["", "ab"]];
        let kinds = [Kind::Off, Kind::Fixed(0), Kind::Fixed(1), Kind::Keyed { first: 0 }];
        let numbers = [0.0, 1.0, -1.0, f64::from_bits(1), f64::INFINITY, f64::NAN];
        let mut digests: Vec<Digest> = lists.map(Digest::of).to_vec();
        digests.extend(kinds.iter().map(Digest::of));
        digests.extend(numbers.iter().map(|number| Digest::of(&Some(*number))));
        digests.push(Digest::of(&None::<f64>));
        let count = digests.len();
        digests.sort_unstable();
        digests.dedup();
        assert_eq!(digests.len(), count);
    }

    #[test]
    fn equal_numbers_are_one() {
        assert_eq!(Digest::of(&-0.0f64), Digest::of(&0.0f64));
        assert_eq!(Digest::of(&-0.0f32), Digest::of(&0.0f32));
        assert_eq!(Digest::of(&-f64::NAN), Digest::of(&f64::NAN));
    }

    /// Lists are copied in pieces. That feeds the same bytes as one value after the other.
    #[test]
    fn lists_feed_the_bytes_of_their_values() {
        fn one_by_one<T: Content>(values: &[T]) -> Digest {
            let mut digester = Digester::new();
            values.len().feed(&mut digester);
            values.iter().for_each(|value| value.feed(&mut digester));
            digester.finish()
        }
        let special = [-0.0, f64::NAN, -f64::NAN, 0.1, f64::INFINITY];
        let number = |index: usize| special.get(index % 7).copied().unwrap_or(index as f64);
        for count in [0, 1, 63, 64, 65, 1000] {
            let numbers: Vec<f64> = (0..count).map(number).collect();
            let points: Vec<DVec3> = (0..count).map(|i| DVec3::new(number(i), number(i + 1), 3.0)).collect();
            let normals: Vec<Vec3> = points.iter().map(|point| point.as_vec3()).collect();
            let uvs: Vec<DVec2> = points.iter().map(|point| point.truncate()).collect();
            let triangles: Vec<[u32; 3]> = (0..count as u32).map(|i| [i, 3 * i, 7 * i]).collect();
            assert_eq!(Digest::of(&numbers), one_by_one(&numbers));
            assert_eq!(Digest::of(&points), one_by_one(&points));
            assert_eq!(Digest::of(&normals), one_by_one(&normals));
            assert_eq!(Digest::of(&uvs), one_by_one(&uvs));
            assert_eq!(Digest::of(&triangles), one_by_one(&triangles));
        }
    }

    #[test]
    fn long_values_are_hashed_in_pieces() {
        let long: Vec<u64> = (0..20_000).collect();
        let bytes: Vec<u8> =
            [20_000].iter().chain(&long).flat_map(|number: &u64| number.to_le_bytes()).collect();
        assert_eq!(Digest::of(&long).0 >> 64, {
            let hash = blake3::hash(&bytes);
            u128::from(u64::from_be_bytes(*hash.as_bytes().first_chunk().expect("32 bytes")))
        });
    }
}

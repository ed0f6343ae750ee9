//! Large immutable data with several owners.

use crate::base::digest::{Content, Digest, Digester};
use std::ops::Deref;
use std::sync::{Arc, OnceLock};

/// Data that is loaded once and compared by address. Materials are compared in every frame, which must not read all
/// texels of their images.
#[derive(Debug)]
pub struct SharedAsset<T>(Arc<Held<T>>);

#[derive(Debug)]
struct Held<T> {
    value: T,
    /// The digest of the value, computed at its first use.
    digest: OnceLock<Digest>,
}

impl<T> SharedAsset<T> {
    pub fn new(value: T) -> Self {
        Self(Arc::new(Held { value, digest: OnceLock::new() }))
    }
}

impl<T> Clone for SharedAsset<T> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<T> Deref for SharedAsset<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.0.value
    }
}

impl<T: Content> Content for SharedAsset<T> {
    fn feed(&self, into: &mut Digester) {
        self.0.digest.get_or_init(|| Digest::of(&self.0.value)).feed(into);
    }
}

impl<T> PartialEq for SharedAsset<T> {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_clones_are_equal() {
        let one = SharedAsset::new(1);
        assert_eq!(one, one.clone());
        assert_ne!(one, SharedAsset::new(1));
    }
}

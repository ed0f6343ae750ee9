//! Large data that many own and nobody changes.

use crate::base::digest::{Content, Digest, Digester};
use std::ops::Deref;
use std::sync::{Arc, OnceLock};

/// Something loaded once, compared by where it is and not by what it holds: values that are compared in every
/// frame must not walk through an image's texels.
#[derive(Debug)]
pub struct Shared<T>(Arc<Held<T>>);

#[derive(Debug)]
struct Held<T> {
    value: T,
    /// Of the value; computed when first asked for.
    digest: OnceLock<Digest>,
}

impl<T> Shared<T> {
    pub fn new(value: T) -> Self {
        Self(Arc::new(Held { value, digest: OnceLock::new() }))
    }
}

impl<T> Clone for Shared<T> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<T> Deref for Shared<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.0.value
    }
}

impl<T: Content> Content for Shared<T> {
    fn feed(&self, into: &mut Digester) {
        self.0.digest.get_or_init(|| Digest::of(&self.0.value)).feed(into);
    }
}

impl<T> PartialEq for Shared<T> {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_is_who_shares() {
        let one = Shared::new(1);
        assert_eq!(one, one.clone());
        assert_ne!(one, Shared::new(1));
    }
}

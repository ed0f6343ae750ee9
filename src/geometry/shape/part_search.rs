//! Searches through the trees of shapes of many parts, along single rays.

use crate::base::lanes::{Level, SimdKernel};
use crate::geometry::bvh::{LeafVisitor, Stack, TraversalRay, Tree};

/// A search for parts that a ray hits.
pub trait PartSearch<'a>: LeafVisitor + Sized {
    type Found;

    fn tree(&self) -> &'a Tree;
    fn ray(&self) -> &'a TraversalRay;
    /// The t beyond which nothing is searched at first.
    fn t_max(&self) -> f64;
    fn found(self) -> Self::Found;

    /// Searches the whole tree, within a kernel that already runs on a level.
    #[inline(always)]
    fn search_on<L: Level>(self, stack: &mut Stack) -> Self::Found {
        L::Narrow::call(Walk { search: self, stack, tree: std::marker::PhantomData })
    }

    /// [`PartSearch::search_on`] anywhere.
    fn search(mut self) -> Self::Found {
        let (tree, ray, t_max) = (self.tree(), self.ray(), self.t_max());
        tree.walk(ray, t_max, &mut self);
        self.found()
    }
}

/// A search from the root.
struct Walk<'a, 's, S> {
    search: S,
    stack: &'s mut Stack,
    tree: std::marker::PhantomData<&'a Tree>,
}

impl<'a, S: PartSearch<'a>> SimdKernel for Walk<'a, '_, S> {
    type Output = S::Found;

    #[inline(always)]
    fn run<L: Level>(mut self) -> S::Found {
        let (tree, ray, t_max) = (self.search.tree(), self.search.ray(), self.search.t_max());
        tree.walk_on::<L>(ray, t_max, &mut self.search, self.stack);
        self.search.found()
    }
}

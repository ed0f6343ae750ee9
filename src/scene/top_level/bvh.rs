//! The tree over a scene's primitives and its construction.

use super::extent::{Extent, Extents};
use super::gain::{cost, pays};
use super::query::Coherence;
use crate::base::math::Aabb;
use crate::geometry::bvh::{LeafPrimitives, Refitter, Tree};
use crate::geometry::ray_kinds::RayKind;
use crate::scene::{Geometry, Primitive};

/// A tree over the bounded primitives, with lists of those that are tested without it.
#[derive(Clone, Debug, Default)]
#[warn(missing_docs)]
pub struct Bvh {
    pub(super) tree: Tree,
    /// The indices of the primitives in each leaf.
    pub(super) leaves: LeafPrimitives,
    /// Indices of primitives that are tested directly: infinite ones, or all if testing them is cheap.
    pub(super) direct: Vec<u32>,
    /// Indices of meshes and particles outside the tree, if there is none. Each has a tree of its own.
    pub(super) meshes: Vec<u32>,
    /// The largest coordinate of all bounded primitives and of the points of planes. It depends on the geometry alone,
    /// not on the tree.
    pub(super) reach: f64,
    /// Whether any shape may have a tree of its own.
    pub(super) has_parts: bool,
    /// The revision of the geometry. None before the first build.
    revision: Option<u64>,
    /// [`Geometry::replaced`] at this revision.
    replaced: u64,
    places: Vec<Place>,
    extents: Extents,
    refitter: Refitter,
    /// How often primitives were replaced since the tree was built.
    rewritten: u64,
    /// How the directions of eight rays that search together mostly are.
    coherence: Coherence,
    /// The kind of the only rays that search this tree; none if all may.
    kind: Option<RayKind>,
    /// For each kind of ray that does not see all primitives, the tree over those that it sees.
    seen: [Option<Box<Self>>; 3],
}

/// What an update did to the tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BvhUpdate {
    /// Nothing: the primitives are the same.
    None,
    Refit,
    Build,
}

/// Where the primitive of a slot is tested.
#[derive(Clone, Copy, Debug)]
enum Place {
    /// The slot is empty, and was empty when the tree was built.
    Nowhere,
    /// Without the tree.
    Direct,
    Leaf(u32),
}

/// Primitives that appear are tested without the tree as long as testing all of these costs less than this, or there is
/// one alone. A build takes much longer, and objects that take turns would need one in every frame.
const FEW: f64 = 18.0;

/// A tree's space may be larger than that of its boxes by this factor; the coordinates of boxes are coarser by it.
/// Below 2, a primitive that sways across a power of two would need a build in every frame.
const ROOMIEST: f64 = 4.0;

/// A refitted tree may cost this multiple of the built one. Then it is built again.
const WORST_GROWTH: f64 = 1.5;

/// After so many changes per primitive, a refitted tree is built again whatever it costs: primitives that were sorted
/// badly when the tree was built, such as all in one place, stay so while the cost falls. A build takes about as long
/// as three refits of all primitives, so this adds a fifth.
const MOST_CHANGES: u64 = 16;

#[warn(missing_docs)]
impl Bvh {
    /// Builds the tree over `geometry`, for rays in all directions. The same geometry gives the same tree.
    pub fn build(geometry: &Geometry) -> Self {
        Self::default().rebuilt(geometry)
    }

    /// No tree yet. Scenes of few primitives get one if rays of this kind are faster with it.
    pub fn for_rays(coherence: Coherence) -> Self {
        Self { coherence, ..Self::default() }
    }

    /// The tree for a part of a scene, for the same rays and with the same error bounds as in the whole scene: searches
    /// give the hits of that.
    pub fn of_part(&self, geometry: &Geometry) -> Self {
        let part = Self::for_rays(self.coherence).rebuilt(geometry);
        let seen = part.seen.map(|tree| tree.map(|tree| Box::new(Self { reach: self.reach, ..*tree })));
        Self { reach: self.reach, seen, ..part }
    }

    fn rebuilt(self, geometry: &Geometry) -> Self {
        let mut all = self.build_for(geometry, None);
        all.update_seen(geometry);
        all
    }

    /// The tree that rays of a kind search.
    #[inline(always)]
    pub fn of(&self, kind: RayKind) -> &Self {
        self.seen[kind.index()].as_deref().unwrap_or(self)
    }

    /// Brings the trees of single kinds of rays up to date. Scenes in which all rays see everything have none.
    fn update_seen(&mut self, geometry: &Geometry) {
        for kind in RayKind::ALL {
            match &mut self.seen[kind.index()] {
                tree if !geometry.hides_from(kind) => *tree = None,
                Some(tree) => {
                    tree.update_own(geometry);
                }
                None => self.seen[kind.index()] = Some(Box::new(self.build_for(geometry, Some(kind)))),
            }
        }
    }

    /// Builds the tree over the primitives that a kind of rays sees.
    fn build_for(&self, geometry: &Geometry, kind: Option<RayKind>) -> Self {
        let (mut bounded, mut boxes, mut direct) = (Vec::new(), Vec::new(), Vec::new());
        for (index, primitive) in (0..).zip(&geometry.primitives) {
            match primitive.bounds() {
                _ if primitive.is_absent(kind) => {}
                Some(bounds) => {
                    bounded.push(index);
                    boxes.push(bounds);
                }
                None => direct.push(index),
            }
        }
        let mut meshes = Vec::new();
        let (mut tree, mut leaves) = Default::default();
        let extents = Extents::new(&geometry.primitives);
        let primitives = bounded.iter().map(|index| &geometry.primitives[*index as usize]);
        let needs_tree = extents
            .all()
            .bounds()
            .is_some_and(|all| pays(primitives.zip(boxes.iter().copied()), all, self.coherence));
        if needs_tree {
            (tree, leaves) = Tree::of_boxes(&boxes);
        } else {
            for index in bounded.drain(..) {
                let has_tree = geometry.primitives[index as usize].shape.has_tree();
                if has_tree { meshes.push(index) } else { direct.push(index) }
            }
            direct.sort_unstable();
        }
        leaves.renumber(|primitive| bounded[primitive as usize]);
        let has_parts = geometry.primitives.iter().any(|primitive| primitive.shape.has_tree());
        let mut places = vec![Place::Nowhere; geometry.primitives.len()];
        direct.iter().chain(&meshes).for_each(|index| places[*index as usize] = Place::Direct);
        for leaf in 0..leaves.len() as u32 {
            leaves.leaf(leaf).iter().for_each(|index| places[*index as usize] = Place::Leaf(leaf));
        }
        let (reach, refitter) = (extents.all().reach(), Refitter::new(&tree, leaves.len()));
        Self {
            tree,
            leaves,
            direct,
            meshes,
            reach,
            has_parts,
            revision: Some(geometry.revision()),
            replaced: geometry.replaced(),
            places,
            extents,
            refitter,
            rewritten: 0,
            kind,
            coherence: self.coherence,
            seen: Default::default(),
        }
    }

    /// Follows the changes of a geometry: refits the tree, or builds it again if refitting does not suffice. Hits are
    /// those of [`Bvh::build`].
    pub fn update(&mut self, geometry: &Geometry) -> BvhUpdate {
        let update = self.update_own(geometry);
        self.update_seen(geometry);
        update
    }

    fn update_own(&mut self, geometry: &Geometry) -> BvhUpdate {
        if self.revision.is_some() && self.replaced == geometry.replaced() {
            self.revision = Some(geometry.revision());
            return BvhUpdate::None;
        }
        if self.refit(geometry).is_some() {
            return BvhUpdate::Refit;
        }
        *self = Self { seen: std::mem::take(&mut self.seen), ..self.build_for(geometry, self.kind) };
        BvhUpdate::Build
    }

    /// Refits the tree. None if it must be built again: then its state has no meaning.
    fn refit(&mut self, geometry: &Geometry) -> Option<()> {
        let changes = geometry.changes_since(self.revision?)?;
        if self.extents.len() != geometry.primitives.len() {
            return None;
        }
        for slot in changes.iter().map(|slot| *slot as usize) {
            let primitive = &geometry.primitives[slot];
            let (extent, is_empty) = (Extent::of(primitive), primitive.is_absent(self.kind));
            self.extents.set(slot, extent);
            let bounds = extent.bounds().filter(|_| !is_empty);
            match (self.places[slot], is_empty) {
                (Place::Leaf(_), false) if bounds.is_none() => return None,
                (Place::Leaf(leaf), _) => {
                    self.refitter.set_leaf(&mut self.tree, leaf, bounds).then_some(())?;
                }
                (Place::Direct, true) => self.remove_direct(slot),
                (Place::Nowhere, false) => self.add_direct(geometry, slot),
                (Place::Direct, false) | (Place::Nowhere, true) => {}
            }
        }
        self.refitter.finish(&mut self.tree);
        self.extents.update();
        let all = self.extents.all();
        self.reach = all.reach();
        self.rewritten += geometry.replaced() - self.replaced;
        (self.revision, self.replaced) = (Some(geometry.revision()), geometry.replaced());
        // In a much larger space, f32 boxes would be too coarse.
        let is_close = all.space().scale <= ROOMIEST * self.tree.space().scale;
        let is_good = self.tree.is_empty() || is_close && self.is_good();
        let is_complete = match self.tree.is_empty() {
            true => all.bounds().is_none_or(|all| !pays(self.bounded_direct(geometry), all, self.coherence)),
            false => self.is_little(geometry),
        };
        (is_good && is_complete).then_some(())
    }

    /// Adds a primitive that appeared to those that are tested without the tree.
    fn add_direct(&mut self, geometry: &Geometry, slot: usize) {
        let has_tree = geometry.primitives[slot].shape.has_tree();
        let list = if has_tree { &mut self.meshes } else { &mut self.direct };
        let place = list.partition_point(|index| *index < slot as u32);
        list.insert(place, slot as u32);
        self.has_parts |= has_tree;
        self.places[slot] = Place::Direct;
    }

    fn remove_direct(&mut self, slot: usize) {
        self.direct.retain(|index| *index != slot as u32);
        self.meshes.retain(|index| *index != slot as u32);
        self.places[slot] = Place::Nowhere;
    }

    /// Whether testing the bounded primitives outside the tree takes less than a build.
    fn is_little(&self, geometry: &Geometry) -> bool {
        let costs = self.bounded_direct(geometry).map(|(primitive, _)| cost(primitive));
        costs.clone().count() <= 1 || costs.sum::<f64>() < FEW
    }

    /// The bounded primitives outside the tree, with their boxes.
    fn bounded_direct<'a>(
        &self,
        geometry: &'a Geometry,
    ) -> impl Iterator<Item = (&'a Primitive, Aabb)> + Clone {
        self.direct.iter().chain(&self.meshes).filter_map(|index| {
            let bounds = self.extents.bounds(*index as usize)?;
            Some((&geometry.primitives[*index as usize], bounds))
        })
    }

    /// Whether a refitted tree is good enough to keep.
    fn is_good(&self) -> bool {
        // A comparison with NaN is false.
        let is_cheap = self.refitter.growth(&self.tree) <= WORST_GROWTH;
        is_cheap && self.rewritten <= MOST_CHANGES * self.leaves.len() as u64
    }

    /// The cost of the tree for a ray that hits the box around all: the expected number of visits.
    #[cfg(test)]
    pub(super) fn cost(&self) -> f64 {
        self.refitter.cost(&self.tree)
    }

    /// The largest coordinate of all bounded primitives and of the points of planes.
    pub fn reach(&self) -> f64 {
        self.reach
    }
}

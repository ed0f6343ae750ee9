//! What carries a light, a camera or a joint: an object, and everything above it.

use super::transform::TransformTracks;
use crate::base::math::{DAffine3, DMat3};
use crate::base::time::Time;
use std::collections::HashMap;
use std::sync::Arc;

/// The transforms of objects that lie below one another, each stored once, however many things they carry.
#[derive(Debug, Default, PartialEq)]
pub struct TransformTree {
    links: Vec<Link>,
}

/// The index of a link of a tree. None is the space in which the outermost links lie.
pub type LinkIndex = Option<usize>;

/// One transform of a tree.
#[derive(Debug, PartialEq)]
struct Link {
    /// The link above, which comes first.
    above: LinkIndex,
    /// The index of its object; none for a turn of axes.
    object: Option<usize>,
    tracks: TransformTracks,
    /// Whether it or one above it may change over time.
    keyed: bool,
}

impl TransformTree {
    /// Adds the transform of an object below another link, which is in the tree already.
    pub fn push(&mut self, above: LinkIndex, object: Option<usize>, tracks: TransformTracks) -> LinkIndex {
        let keyed = tracks.is_keyed() || self.is_keyed(above);
        self.links.push(Link { above, object, tracks, keyed });
        Some(self.links.len() - 1)
    }

    /// The same tree with other transforms of its objects.
    pub fn replaced(&self, tracks: impl Fn(usize) -> TransformTracks) -> Self {
        let mut tree = Self::default();
        for Link { above, object, tracks: old, .. } in &self.links {
            tree.push(*above, *object, object.map_or_else(|| old.clone(), &tracks));
        }
        tree
    }

    /// Whether the transforms of an object are in the tree.
    pub fn has(&self, object: usize) -> bool {
        self.links.iter().any(|link| link.object == Some(object))
    }

    /// Whether the map of a link may change over time.
    pub fn is_keyed(&self, link: LinkIndex) -> bool {
        link.is_some_and(|link| self.links[link].keyed)
    }

    /// A link and those above it, the outermost first.
    fn chain(&self, link: LinkIndex) -> impl Iterator<Item = &Link> {
        let mut chain: Vec<_> = std::iter::successors(link, |link| self.links[*link].above)
            .map(|link| &self.links[link])
            .collect();
        chain.reverse();
        chain.into_iter()
    }

    /// The transforms of these links and of those above them, each once.
    pub fn tracks(&self, links: impl Iterator<Item = LinkIndex>) -> impl Iterator<Item = &TransformTracks> {
        let mut is_named = vec![false; self.links.len()];
        for link in links {
            let mut at = link;
            while let Some(index) = at.filter(|index| !is_named[*index]) {
                is_named[index] = true;
                at = self.links[index].above;
            }
        }
        self.links.iter().zip(is_named).filter(|(_, named)| *named).map(|(link, _)| &link.tracks)
    }

    /// The maps from these links to the space of the tree. Every transform is evaluated once.
    pub fn maps(&self, links: impl Iterator<Item = LinkIndex>, time: Time) -> Vec<DAffine3> {
        let mut known: HashMap<usize, DAffine3> = HashMap::new();
        let mut way = Vec::new();
        let map = |link: LinkIndex| {
            let mut at = link;
            let mut map = loop {
                let Some(index) = at else { break DAffine3::IDENTITY };
                if let Some(map) = known.get(&index) {
                    break *map;
                }
                way.push(index);
                at = self.links[index].above;
            };
            while let Some(index) = way.pop() {
                map *= self.links[index].tracks.at(time);
                known.insert(index, map);
            }
            map
        };
        links.map(map).collect()
    }
}

/// The transforms from an object to the world over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Carrier {
    /// The index of the object.
    pub object: usize,
    tree: Arc<TransformTree>,
    link: LinkIndex,
}

impl Carrier {
    /// `link` is the link of the object in a tree.
    pub fn new(object: usize, tree: Arc<TransformTree>, link: LinkIndex) -> Self {
        Self { object, tree, link }
    }

    /// Whether the transform may change over time.
    pub fn is_keyed(&self) -> bool {
        self.tree.is_keyed(self.link)
    }

    /// The object's origin in the world, and its axes as far as rotations turn them. Scales move the origin, but neither
    /// mirror, shear nor flatten the axes: lights and cameras have no size.
    pub fn rigid_at(&self, time: Time) -> DAffine3 {
        let (mut map, mut turn) = (DAffine3::IDENTITY, DMat3::IDENTITY);
        for link in self.tree.chain(self.link) {
            map *= link.tracks.at(time);
            turn *= link.tracks.rotation_at(time);
        }
        DAffine3::from_mat3_translation(turn, map.translation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::math::{Angle, DVec3};
    use crate::geometry::transform::Rotation;
    use crate::testing::Random;

    fn tracks(random: &mut Random) -> TransformTracks {
        let angle = Angle(360.0 * random.unit());
        TransformTracks {
            translation: random.point(1.0).into(),
            rotation: Rotation::AxisAngle { axis: random.point(1.0).into(), angle: angle.into() },
            scale: random.point(2.0).into(),
            ..TransformTracks::default()
        }
    }

    #[test]
    fn maps_are_products_from_the_outside() {
        let (mut random, mut tree, time) = (Random(5), TransformTree::default(), Time::from_integer(0));
        let mut expected = Vec::new();
        for index in 0..40usize {
            let above = (index > 0).then(|| (random.unit() * index as f64) as usize);
            let own = tracks(&mut random);
            let outer = above.map_or(DAffine3::IDENTITY, |above: usize| expected[above]);
            expected.push(outer * own.at(time));
            tree.push(above, Some(100 + index), own);
        }
        // Bit by bit, in any order of links, also if a link is asked for twice.
        let order: Vec<usize> = (0..40).rev().chain([7, 7, 39]).collect();
        let found = tree.maps(order.iter().map(|link| Some(*link)), time);
        assert_eq!(found, order.iter().map(|link| expected[*link]).collect::<Vec<_>>());
        assert_eq!(tree.maps([None].into_iter(), time), [DAffine3::IDENTITY]);
        assert!(tree.has(107) && !tree.has(7));
    }

    /// Copies of the chain for every joint would take 60 GB, and two hundred million evaluations.
    #[test]
    fn deep_chains_take_linear_memory_and_time() {
        let mut tree = TransformTree::default();
        let mut link = None;
        for object in 0..20_000 {
            let translation = DVec3::X.into();
            link =
                tree.push(link, Some(object), TransformTracks { translation, ..TransformTracks::default() });
        }
        let tree = Arc::new(tree);
        let maps = tree.maps((0..20_000).map(Some), Time::from_integer(0));
        assert_eq!(maps[19_999].translation, DVec3::X * 20_000.0);
        let last = Carrier::new(19_999, Arc::clone(&tree), link);
        assert_eq!(last.rigid_at(Time::from_integer(0)), maps[19_999]);
    }

    #[test]
    fn scales_neither_flatten_nor_turn_what_is_carried() {
        for scale in [DVec3::ZERO, DVec3::new(1.0, 1.0, -1.0), DVec3::new(3.0, 0.0, 0.5)] {
            let mut tree = TransformTree::default();
            let rotation = Rotation::AxisAngle { axis: DVec3::Y.into(), angle: Angle(90.0).into() };
            let outer = TransformTracks { scale: scale.into(), rotation, ..TransformTracks::default() };
            let above = tree.push(None, Some(0), outer);
            let translation = DVec3::new(0.0, 0.0, 2.0).into();
            let link =
                tree.push(above, Some(1), TransformTracks { translation, ..TransformTracks::default() });
            let map = Carrier::new(1, Arc::new(tree), link).rigid_at(Time::from_integer(0));
            assert_eq!(map.matrix3 * DVec3::NEG_Z, DVec3::NEG_X, "{scale}");
            assert_eq!(map.translation, DVec3::new(2.0 * scale.z, 0.0, 0.0));
        }
    }
}

//! Digests of lists of which single items change.

use crate::base::digest::{Content, Digest, Digester};

/// Children of a node.
const WIDTH: usize = 16;

/// A tree of hashes over a list of digests (Merkle 1987). Each node is the digest of up to [`WIDTH`] nodes below it. The
/// root depends only on the list.
#[derive(Clone, Debug, Default)]
pub struct HashTree {
    /// The items, then the levels above them.
    levels: Vec<Vec<Digest>>,
}

impl HashTree {
    pub fn new(items: Vec<Digest>) -> Self {
        let mut levels = vec![items];
        while let Some(below) = levels.last().filter(|below| below.len() > 1) {
            levels.push(below.chunks(WIDTH).map(node).collect());
        }
        Self { levels }
    }

    /// Replaces items. Their indices are ascending.
    pub fn update(&mut self, changes: impl Iterator<Item = (usize, Digest)>) {
        let mut dirty = Vec::new();
        let Some(items) = self.levels.first_mut() else { return };
        for (index, item) in changes {
            items[index] = item;
            dirty.push(index);
        }
        for level in 1..self.levels.len() {
            dirty.iter_mut().for_each(|index| *index /= WIDTH);
            dirty.dedup();
            let (below, above) = self.levels.split_at_mut(level);
            let below = &below[level - 1];
            for &index in &dirty {
                let last = below.len().min((index + 1) * WIDTH);
                above[0][index] = node(&below[index * WIDTH..last]);
            }
        }
    }

    /// The digest of the list. It includes the length, which decides the shape of the tree.
    pub fn root(&self) -> Digest {
        let length = self.levels.first().map_or(0, Vec::len);
        Digest::of(&(length, self.levels.last().and_then(|top| top.first()).copied()))
    }
}

fn node(children: &[Digest]) -> Digest {
    let mut digester = Digester::new();
    children.iter().for_each(|child| child.feed(&mut digester));
    digester.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;
    use std::collections::HashSet;

    fn items(count: u32) -> Vec<Digest> {
        (0..count).map(|item| Digest::of(&item)).collect()
    }

    #[test]
    fn updates_give_the_tree_of_the_new_list() {
        let mut random = Random(8);
        for count in [0, 1, 2, 15, 16, 17, 255, 256, 257, 5000] {
            let mut list = items(count);
            let mut tree = HashTree::new(list.clone());
            for _ in 0..20 {
                let changed: Vec<usize> = (0..list.len()).filter(|_| random.unit() < 0.02).collect();
                changed.iter().for_each(|&index| list[index] = Digest::of(&random.unit()));
                tree.update(changed.iter().map(|&index| (index, list[index])));
                assert_eq!(tree.root(), HashTree::new(list.clone()).root(), "{count}");
            }
        }
    }

    /// Lists of other items, in another order or of another length have other digests.
    #[test]
    fn order_and_length_count() {
        let mut roots: Vec<Digest> = (0..600).map(|count| HashTree::new(items(count)).root()).collect();
        for (a, b) in [(0, 1), (0, 16), (15, 16), (17, 299)] {
            let mut list = items(300);
            list.swap(a, b);
            roots.push(HashTree::new(list).root());
        }
        // A list of the nodes of another one.
        roots.push(HashTree::new(items(256).chunks(WIDTH).map(node).collect()).root());
        assert_eq!(roots.iter().collect::<HashSet<_>>().len(), roots.len());
    }
}

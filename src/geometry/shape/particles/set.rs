//! The particles at one moment.

use super::packet::SpherePacket;
use super::tracks::ParticleTracks;
use crate::base::digest::{Content, Digest, Digester};
use crate::base::math::Aabb;
use crate::geometry::bvh::{LeafBox, Tree, TreeSpace};
use crate::geometry::mesh::ArrayKey;
use crate::geometry::shape::{Geometric, Sphere};
use crate::geometry::table_rows::interpolated;
use rayon::prelude::*;
use std::sync::Arc;

/// Leaves per parallel task.
const FEW: usize = 1024;

/// Where a particle's numbers come from: a row, and the share of the next one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Origin {
    pub row: u32,
    pub share: f64,
}

/// Spheres at one moment. The part of a hit is the index of its sphere.
#[derive(Debug)]
pub struct ParticleSet {
    tracks: Arc<ParticleTracks>,
    spheres: Vec<Sphere>,
    origins: Vec<Origin>,
    bounds: Aabb,
    digest: Digest,
    tree: Tree,
    /// The spheres of each of the tree's leaves.
    packets: Vec<SpherePacket>,
}

fn box_of(sphere: &Sphere) -> Aabb {
    sphere.bounds().unwrap_or(Aabb::EMPTY)
}

impl ParticleSet {
    /// A set without a tree, which no ray hits.
    pub(super) fn new(tracks: Arc<ParticleTracks>, spheres: Vec<Sphere>, origins: Vec<Origin>) -> Self {
        let around = || spheres.iter().filter_map(Geometric::bounds).fold(Aabb::EMPTY, Aabb::union);
        let (bounds, digest) = rayon::join(around, || Digest::of(&spheres));
        let (tree, packets) = (Tree::default(), Vec::new());
        Self { tracks, spheres, origins, bounds, digest, tree, packets }
    }

    /// The same set with its tree: that of `before`, refitted, or a new one.
    pub fn with_tree(mut self, before: Option<&Self>) -> Self {
        let can_move = |before: &&Self| {
            before.has_tree() && before.tree.can_be_refitted() && before.spheres.len() == self.spheres.len()
        };
        let before = before.filter(can_move);
        if before.is_none_or(|before| self.refit(before).is_none()) {
            self.build();
        }
        self
    }

    fn build(&mut self) {
        let boxes: Vec<Aabb> = self.spheres.par_iter().with_min_len(FEW).map(box_of).collect();
        let (tree, leaves) = Tree::of_packed_boxes(&boxes);
        let packet = |leaf| SpherePacket::new(&self.spheres, leaves.leaf(leaf));
        self.packets = (0..leaves.len() as u32).into_par_iter().with_min_len(FEW).map(packet).collect();
        self.tree = tree;
    }

    /// Takes the tree of other spheres, as many. None if a new one is likely to be better.
    fn refit(&mut self, before: &Self) -> Option<()> {
        let space = TreeSpace::around(self.bounds);
        let moved = |before: &SpherePacket| {
            let parts = before.parts();
            let boxes = parts.iter().map(|&part| box_of(&self.spheres[part as usize]));
            let around = LeafBox::of_box(&space, boxes.fold(Aabb::EMPTY, Aabb::union));
            (SpherePacket::new(&self.spheres, parts), around)
        };
        let (packets, boxes): (Vec<_>, Vec<_>) =
            before.packets.par_iter().with_min_len(FEW).map(moved).unzip();
        (self.tree, self.packets) = (before.tree.refitted(space, &boxes)?, packets);
        Some(())
    }

    pub fn spheres(&self) -> &[Sphere] {
        &self.spheres
    }

    pub fn tree(&self) -> &Tree {
        &self.tree
    }

    #[inline(always)]
    pub fn packets(&self) -> &[SpherePacket] {
        &self.packets
    }

    /// A box around all particles; empty without any.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// The digest of the spheres.
    pub fn digest(&self) -> Digest {
        self.digest
    }

    /// A number of a particle.
    pub fn number(&self, key: &ArrayKey, part: u32) -> Option<f64> {
        let Origin { row, share } = self.origins[part as usize];
        Some(interpolated(self.tracks.columns().find(key)?, [row, row + 1], share))
    }

    /// The digest of a column's numbers; none if there is no such column.
    pub fn column_digest(&self, key: &ArrayKey) -> Option<Digest> {
        self.tracks.columns().find(key)?;
        let mut digester = Digester::new();
        (0..self.spheres.len() as u32).for_each(|part| self.number(key, part).feed(&mut digester));
        Some(digester.finish())
    }

    /// Whether rays find the particles.
    pub fn has_tree(&self) -> bool {
        self.spheres.is_empty() || !self.tree.is_empty()
    }

    /// Whether another set has the same spheres with the same numbers.
    pub fn is_same(&self, other: &Self) -> bool {
        self.digest == other.digest
            && Arc::ptr_eq(&self.tracks, &other.tracks)
            && self.origins == other.origins
    }
}

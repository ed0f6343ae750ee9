//! Tests of views that share samples.

use super::coverage::{Coverage, Overlap};
use super::raster::Raster;
use super::samples::{SampleGrid, SamplePlan};
use super::view::{View, ViewMap, finest_first};
use super::{SharedViews, traced_blocks};
use crate::base::math::{DVec3, gamma, look_at};
use crate::camera::{Camera, Projection};
use crate::film::filter::Filter;
use crate::testing::Random;

const SIZE: (u32, u32) = (48, 30);

fn camera(target: DVec3, half_height: f64) -> Camera {
    let basis = look_at(DVec3::ZERO, target, DVec3::Y).expect("a frame");
    Camera { position: DVec3::ZERO, basis, projection: Projection::Perspective { half_height }, lens: None }
}

fn view(target: DVec3, half_height: f64) -> View {
    View::of(&camera(target, half_height)).expect("a view")
}

fn plan(samples: u32) -> SamplePlan {
    SamplePlan { size: SIZE, filter: Filter::PIXEL, samples, seed: None }
}

/// Views that zoom, pan and turn.
fn some_views() -> Vec<View> {
    let mut random = Random(3);
    let turned = |random: &mut Random| {
        let aside = DVec3::new(0.6 * random.unit() - 0.3, 0.4 * random.unit() - 0.2, -1.0);
        view(aside, 0.2 + 0.4 * random.unit())
    };
    finest_first((0..12).map(|_| turned(&mut random)))
}

#[test]
fn maps_follow_the_rays_of_cameras() {
    let raster = Raster::new(SIZE, Filter::PIXEL, 0.0);
    let cameras = [camera(DVec3::new(0.1, -0.2, -1.0), 0.4), camera(DVec3::new(-0.2, 0.1, -1.0), 0.7)];
    let views = cameras.map(|camera| View::of(&camera).expect("a view"));
    let map = ViewMap::between(&views[0], &views[1], &raster);
    let ray = |camera: &Camera, [across, down]: [f64; 2]| camera.pixel_ray([across, down], SIZE).direction;
    let mut random = Random(5);
    for _ in 0..1000 {
        let from = [48.0 * random.unit(), 30.0 * random.unit()];
        let to = map.position(from);
        let (a, b) = (ray(&cameras[0], from), ray(&cameras[1], [to.across, to.down]));
        let depths = a.dot(cameras[1].basis.forward) / a.dot(cameras[0].basis.forward);
        // A map is two changes of basis and a division: fewer than 32 roundings of coordinates, which are at most this
        // many heights of the picture.
        let extent = 1.0 + (from[0] + from[1] + to.across.abs() + to.down.abs()) / f64::from(SIZE.1);
        let bound = gamma(32) * extent / to.depth;
        assert!((a - b).length() < bound, "{a} {b}");
        assert!((to.depth - depths).abs() < bound * to.depth, "{} {depths}", to.depth);
    }
}

/// Every direction of every view is traced by views that have at least the samples that it asks for.
#[test]
fn every_direction_is_traced_densely_enough() {
    let (views, grid) = (some_views(), SampleGrid::new(&plan(4)));
    let raster = grid.raster(&plan(4));
    let coverage = Coverage::new(&views, raster, &grid);
    let mut random = Random(9);
    for own in 0..views.len() {
        for _ in 0..2000 {
            let position = [48.0 * random.unit(), 30.0 * random.unit()];
            // The densities of the views that trace the direction, from their own side.
            let mut most = 0.0_f64;
            for (other, view) in views.iter().enumerate() {
                let mapped = coverage.map(own, other).position(position);
                let depth = mapped.depth;
                let is_in = depth > 0.0 && !raster.outside(&mapped, raster.traced()).contains(&true);
                let there = [mapped.across, mapped.down];
                if coverage.traces(other) && is_in && coverage.density(other, there, coverage.all()).is_some()
                {
                    // Relative to the own view, whose depth is 1.
                    most = most.max(view.density() / (depth * depth * depth));
                }
            }
            // A depth is the sum of three rounded products, and densities are its third power.
            assert!(
                most >= (1.0 - gamma(32)) * grid.asked_share() * views[own].density(),
                "{own} {position:?}"
            );
        }
    }
}

/// Blocks, cells and samples agree about what is traced.
#[test]
fn blocks_have_the_samples_of_their_cells() {
    let (views, grid) = (some_views(), SampleGrid::new(&plan(4)));
    let coverage = Coverage::new(&views, grid.raster(&plan(4)), &grid);
    let all: Vec<usize> = (0..views.len()).collect();
    for own in 0..views.len() {
        let blocks = traced_blocks(&coverage, &grid, own, &all);
        let (mut listed, mut counted, mut one_by_one) = (0, 0, 0);
        for block in &blocks {
            block.each(&coverage, &grid, (own, 0..grid.count()), |_, _| listed += 1);
            counted += block.count(&coverage, &grid, own);
        }
        for cell in coverage.raster.blocks(1).iter().filter(|_| coverage.traces(own)) {
            grid.each(&coverage, (own, cell, coverage.all()), 0..grid.count(), |_| one_by_one += 1);
        }
        assert_eq!((listed, counted), (one_by_one, one_by_one), "{own}");
    }
}

#[test]
fn views_share_only_where_it_pays() {
    let forward = DVec3::NEG_Z;
    let zoom = (0..48).map(|k| view(forward, 0.4 / libm::pow(4.0, f64::from(k) / 47.0)));
    let shared = SharedViews::new(zoom, &plan(64)).expect("shared views");
    let all: Vec<usize> = (0..48).collect();
    let rays = shared.camera_rays(&plan(64), &all);
    // One picture with a margin of two distances between samples, and 47 frames around it, each 1 - 4^(-2 / 47) of it; five
    // samples for four.
    let margin = 2.0 * 2.0 / 80.0_f64.sqrt();
    let traced = (48.0 + margin) * (30.0 + margin) / (48.0 * 30.0);
    let expected = 1.25 * traced * (1.0 + 47.0 * (1.0 - libm::pow(4.0, -2.0 / 47.0)));
    let pictures = rays as f64 / f64::from(48 * 30 * 64);
    assert!((pictures / expected - 1.0).abs() < 0.02, "{pictures} {expected}");
    let apart = [view(forward, 0.2), view(DVec3::X, 0.2), view(DVec3::Z, 0.2)];
    assert_eq!(SharedViews::new(apart, &plan(4)), None);
    assert_eq!(SharedViews::new([view(forward, 0.2); 3], &plan(4)), None);
}

/// The weights of all samples in each pixel of a view, as shares of those of samples that the view itself would trace.
fn weights(views: &[View], size: (u32, u32), samples: u32, view: usize) -> Vec<f64> {
    let plan = SamplePlan { size, ..plan(samples) };
    let grid = SampleGrid::new(&plan);
    let coverage = Coverage::new(views, grid.raster(&plan), &grid);
    let all = f64::from(grid.count()) / views[view].density();
    let mut weights = vec![0.0; (size.0 * size.1) as usize];
    for own in 0..views.len() {
        let map = coverage.map(own, view);
        for block in traced_blocks(&coverage, &grid, own, &[view]) {
            block.each(&coverage, &grid, (own, 0..grid.count()), |_, sample| {
                let at = map.position(sample.position);
                let (column, row) = (at.across.floor(), at.down.floor());
                if (0.0..f64::from(size.0)).contains(&column) && (0.0..f64::from(size.1)).contains(&row) {
                    let pixel = row as usize * size.0 as usize + column as usize;
                    weights[pixel] += sample.weight / (at.depth * at.depth * at.depth) / all;
                }
            });
        }
    }
    weights
}

/// If a view is larger than the one before by less than the distance of samples, its edge has samples all the same.
#[test]
fn views_that_grow_slowly_have_samples_up_to_their_edges() {
    for (size, samples, factor, frames) in
        [((96, 54), 4, 1.15, 60), ((40, 2), 16, 4.0, 24), ((1, 1), 256, 4.0, 24), ((1, 9), 16, 1.5, 40)]
    {
        let zoom = (0..frames).map(|frame| {
            view(DVec3::NEG_Z, 0.4 * libm::pow(factor, f64::from(frame) / f64::from(frames - 1)))
        });
        let views = finest_first(zoom);
        for place in [frames / 3, frames / 2, frames - 1] {
            let weights = weights(&views, size, samples, place as usize);
            let is_edge = |pixel: &usize| {
                let (column, row) = (*pixel as u32 % size.0, *pixel as u32 / size.0);
                column == 0 || row == 0 || column == size.0 - 1 || row == size.1 - 1
            };
            let edge: Vec<f64> = (0..weights.len()).filter(is_edge).map(|pixel| weights[pixel]).collect();
            let mean = edge.iter().sum::<f64>() / edge.len() as f64;
            // Three of five samples that a view traces where four are asked for.
            let lacking = edge.iter().filter(|weight| **weight < 0.6).count();
            assert!((mean - 1.0).abs() < 0.1, "{size:?} {place}: {mean}");
            assert!(lacking * 8 <= edge.len(), "{size:?} {place}: {lacking} of {}", edge.len());
        }
    }
}

#[test]
fn blocks_behind_a_view_are_not_in_its_picture() {
    let views = [view(DVec3::NEG_Z, 0.2), view(DVec3::Z, 0.2), view(DVec3::new(0.1, 0.0, -1.0), 0.4)];
    let raster = Raster::new(SIZE, Filter::PIXEL, 0.0);
    let coverage = Coverage::new(&views, raster, &SampleGrid::new(&plan(4)));
    for block in raster.blocks(16) {
        assert_eq!(coverage.overlap((0, 1), 0.0, &block).0, Overlap::None);
        assert_eq!(coverage.overlap((0, 2), 0.0, &block).0, Overlap::All);
        assert_eq!(coverage.overlap((0, 0), 0.0, &block).0, Overlap::All);
    }
}

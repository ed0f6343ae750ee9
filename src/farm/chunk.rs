//! Divides frames into chunks of similar cost. No film is traced in two chunks.
//!
//! Frames that share a film stay together: the first of them traces it, and the others cost almost nothing. So chunks
//! consist of films, not of frames. Films that share samples of views count as one film, because each chunk would trace
//! these samples again.

use crate::film::AovSet;
use crate::pipeline::plan::{PilotBudget, Plan, cost_estimate, work_groups};
use crate::sequence::Sequence;
use std::collections::HashMap;
use std::ops::Range;

/// Films of similar cost, in chunks of equally many films.
#[derive(Clone, Debug, PartialEq)]
pub struct CostClass {
    /// Films in each chunk. The last chunks may have one less.
    pub films_per_chunk: usize,
    pub chunks: Vec<Chunk>,
}

/// The frames that one task renders.
#[derive(Clone, Debug, PartialEq)]
pub struct Chunk {
    /// The first frame of each of its films, ascending.
    pub first_frames: Vec<u32>,
    /// All frames of its films, ascending.
    pub frames: Vec<u32>,
    /// The expected cost in rays. Writing pictures counts as `RAYS_PER_WRITTEN_PIXEL`.
    pub work: f64,
}

/// The frames and the work of each film of a sequence.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmCosts(Vec<(Vec<u32>, f64)>);

/// The time to develop, compress and write one pixel of a frame, in rays.
pub(super) const RAYS_PER_WRITTEN_PIXEL: f64 = 0.125;

/// Minimum work of a task, in rays: about a second of one processor, ten times the start of a task.
const MIN_WORK: f64 = (1 << 22) as f64;

/// The largest number of tasks unless the user sets another: the default limit of Slurm for an array.
const MAX_TASKS: usize = 1000;

impl FilmCosts {
    /// The films of these frames, if memory holds all films. The number of machines makes no difference.
    pub fn of(sequence: &Sequence, frames: &[u32], aovs: AovSet) -> Self {
        let plan = Plan::new(sequence, frames, aovs, u64::MAX);
        let write = plan.cache.pixels as f64 * RAYS_PER_WRITTEN_PIXEL;
        let rays = cost_estimate(sequence, &plan, PilotBudget::PLAN).films;
        let groups = work_groups(&plan.states.frames);
        let mut group_of = vec![0; frames.len()];
        for (number, group) in groups.iter().enumerate() {
            group.frames.iter().for_each(|&index| group_of[index] = number);
        }
        let mut films: Vec<(Vec<u32>, f64)> = Vec::new();
        let mut known: HashMap<usize, usize> = HashMap::new();
        for (film, (shared, rays)) in plan.films.iter().zip(rays).enumerate() {
            let own: Vec<u32> = shared.frames.iter().map(|&index| frames[index]).collect();
            let work = rays + write * own.len() as f64;
            let place = *known.entry(group_of[plan.films[film].frames[0]]).or_insert(films.len());
            match films.get_mut(place) {
                Some((all, sum)) => {
                    all.extend(own);
                    all.sort_unstable();
                    *sum += work;
                }
                None => films.push((own, work)),
            }
        }
        Self(films)
    }

    fn total(&self) -> f64 {
        self.0.iter().map(|(_, work)| work).sum()
    }
}

/// Divides films into about `wanted` chunks; by default into chunks of at least `MIN_WORK`.
pub fn cost_classes(films: &FilmCosts, wanted: Option<usize>) -> Vec<CostClass> {
    let affordable = (films.total() / MIN_WORK).ceil() as usize;
    let wanted = wanted.unwrap_or(affordable.min(MAX_TASKS)).max(1);
    let target = films.total() / wanted as f64;
    grouped_by_cost(films).iter().map(|class| divided(films, class, target)).collect()
}

/// Groups films by their work, most expensive first. No film of a group costs twice as much as another. Each group is
/// in the order of the first frames.
fn grouped_by_cost(films: &FilmCosts) -> Vec<Vec<usize>> {
    let work = |index: usize| films.0[index].1;
    let mut order: Vec<usize> = (0..films.0.len()).collect();
    order.sort_by(|&a, &b| work(b).total_cmp(&work(a)));
    let mut classes: Vec<Vec<usize>> = Vec::new();
    for index in order {
        match classes.last_mut() {
            Some(class) if 2.0 * work(index) > work(class[0]) => class.push(index),
            _ => classes.push(vec![index]),
        }
    }
    classes.iter_mut().for_each(|class| class.sort_unstable());
    classes
}

/// Divides a group of films into chunks of about this work.
fn divided(films: &FilmCosts, class: &[usize], target: f64) -> CostClass {
    let total: f64 = class.iter().map(|&index| films.0[index].1).sum();
    let count = ((total / target).round() as usize).clamp(1, class.len());
    // Engines divide a list in the same way, given the number of films in a chunk.
    let films_per_chunk = class.len().div_ceil(count);
    let chunks = even_ranges(class.len(), class.len().div_ceil(films_per_chunk)).map(|range| {
        let mut chunk = Chunk { first_frames: Vec::new(), frames: Vec::new(), work: 0.0 };
        for (frames, work) in class[range].iter().map(|&index| &films.0[index]) {
            chunk.first_frames.extend(frames.first());
            chunk.frames.extend(frames);
            chunk.work += work;
        }
        chunk.frames.sort_unstable();
        chunk
    });
    CostClass { films_per_chunk, chunks: chunks.collect() }
}

/// Divides `0..count` into ranges whose lengths differ by at most 1.
fn even_ranges(count: usize, parts: usize) -> impl Iterator<Item = Range<usize>> {
    (0..parts).map(move |part| part * count / parts..(part + 1) * count / parts)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::parse;

    /// The films per chunk and the frames of the chunks of each class, for films with these frames and this work.
    fn chunks(films: &[(&[u32], f64)], wanted: usize) -> Vec<(usize, Vec<Vec<u32>>)> {
        let films = FilmCosts(films.iter().map(|(frames, work)| (frames.to_vec(), *work)).collect());
        let frames = |class: CostClass| {
            (class.films_per_chunk, class.chunks.into_iter().map(|chunk| chunk.frames).collect())
        };
        cost_classes(&films, Some(wanted)).into_iter().map(frames).collect()
    }

    #[test]
    fn frames_of_a_film_stay_together() {
        let films: [(&[u32], f64); 4] = [(&[0, 4], 10.0), (&[1, 5], 10.0), (&[2, 6], 10.0), (&[3], 10.0)];
        assert_eq!(chunks(&films, 2), [(2, vec![vec![0, 1, 4, 5], vec![2, 3, 6]])]);
        assert_eq!(chunks(&films, 1), [(4, vec![vec![0, 1, 2, 3, 4, 5, 6]])]);
        assert_eq!(chunks(&films, 9).iter().map(|(_, chunks)| chunks.len()).sum::<usize>(), 4);
    }

    #[test]
    fn expensive_films_come_first_in_smaller_chunks() {
        let films: [(&[u32], f64); 6] =
            [(&[0], 10.0), (&[1], 9.0), (&[2], 80.0), (&[3], 11.0), (&[4], 70.0), (&[5], 10.0)];
        let expected = [(1, vec![vec![2], vec![4]]), (4, vec![vec![0, 1, 3, 5]])];
        assert_eq!(chunks(&films, 3), expected);
    }

    /// Every frame is in one chunk for any number of chunks, and no chunk has far more work than the mean.
    #[test]
    fn every_frame_is_in_one_chunk() {
        for (count, wanted) in [(1u32, 1usize), (7, 3), (96, 10), (97, 1000), (5, 2)] {
            let films: Vec<(Vec<u32>, f64)> =
                (0..count).map(|frame| (vec![frame], f64::from(1 + frame * 7919 % 13))).collect();
            let most = films.iter().map(|(_, work)| *work).fold(0.0, f64::max);
            let films = FilmCosts(films);
            let share = films.total() / wanted as f64;
            let classes = cost_classes(&films, Some(wanted));
            let mut frames: Vec<u32> = Vec::new();
            for chunk in classes.iter().flat_map(|class| &class.chunks) {
                assert!(chunk.work <= most.max(3.0 * share), "{chunk:?}, {share}");
                frames.extend(&chunk.frames);
            }
            frames.sort_unstable();
            assert_eq!(frames, (0..count).collect::<Vec<_>>());
        }
    }

    #[test]
    fn light_shows_and_loops_share_films() {
        let films = |text: &str| {
            let sequence = parse("a.ron", text).expect("a sequence");
            let frames: Vec<u32> = (0..sequence.timeline.frames).collect();
            FilmCosts::of(&sequence, &frames, AovSet::default()).0
        };
        let show = films(
            r#"(timeline: (frames: 8, keys: Frames), output: (size: (8, 6)),
            lights: { "a": Point(position: (3, 4, 5), intensity: [(0, 0), (7, 1)]) },
            objects: { "ball": (shape: Sphere(radius: 1)) })"#,
        );
        assert_eq!(show.len(), 1);
        assert_eq!(show[0].0, (0..8).collect::<Vec<u32>>());
        let turn = films(
            r#"(timeline: (frames: 8), output: (size: (8, 6)), camera: (path: Orbit(turns: 2)),
            lights: { "a": Point(position: (3, 4, 5)) }, objects: { "ball": (shape: Sphere(radius: 1)) })"#,
        );
        let frames: Vec<_> = turn.iter().map(|(frames, _)| frames.clone()).collect();
        assert_eq!(frames, [[0, 4], [1, 5], [2, 6], [3, 7]]);
        assert!(turn.iter().all(|(_, work)| *work >= 48.0 + 2.0 * 48.0 * RAYS_PER_WRITTEN_PIXEL));
    }

    /// Another task would trace the samples of all views of a zoom again.
    #[test]
    fn frames_that_share_samples_stay_together() {
        let text = |reuse: &str| {
            format!(
                r#"(timeline: (frames: 20, keys: Frames), output: (size: (24, 16)), quality: (antialias: 2, {reuse}),
                camera: (path: Zoom(factor: [(0, 1), (19, 4)])), background: 0.5,
                objects: {{ "ball": (shape: Sphere()) }})"#
            )
        };
        let all: Vec<u32> = (0..20).collect();
        for (reuse, films) in [("", 20), ("reuse: Zoom", 1)] {
            let sequence = parse("zoom.ron", &text(reuse)).expect("a sequence");
            let costs = FilmCosts::of(&sequence, &all, AovSet::default());
            assert_eq!(costs.0.len(), films, "{reuse}");
            let chunks = cost_classes(&costs, Some(4)).into_iter().flat_map(|class| class.chunks);
            assert_eq!(chunks.count(), if films == 1 { 1 } else { 4 }, "{reuse}");
        }
    }
}

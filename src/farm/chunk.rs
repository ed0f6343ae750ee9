//! Frames into chunks of about the same work, none of which traces what another does.
//!
//! Frames that are made of one film stay together, as one of them has to trace it and the others cost next to nothing.
//! So films are handed out, not frames; and a chunk is as many films as take about as long as any other chunk.

use crate::film::Extras;
use crate::pipeline::plan::{Effort, Plan, work};
use crate::sequence::Sequence;
use std::ops::Range;

/// Films that take about as long as each other, in chunks of as many each.
#[derive(Clone, Debug, PartialEq)]
pub struct Class {
    /// Films of a chunk; the last ones may have one less.
    pub films: usize,
    pub chunks: Vec<Chunk>,
}

/// What one task renders.
#[derive(Clone, Debug, PartialEq)]
pub struct Chunk {
    /// The first frame of each of its films, ascending.
    pub leads: Vec<u32>,
    /// All frames that are made of its films, ascending.
    pub frames: Vec<u32>,
    /// Rays that it is expected to trace, with what writing its pictures costs as so many rays.
    pub work: f64,
}

/// The films of a sequence, with the frames of each and its work.
#[derive(Clone, Debug, PartialEq)]
pub struct Films(Vec<(Vec<u32>, f64)>);

/// Rays that take as long as a pixel of a frame which is developed, compressed and written.
pub(super) const WRITE: f64 = 0.125;

/// Work that is worth a task of its own: about a second of one processor, some ten times what it takes to start one.
const WORTH: f64 = (1 << 22) as f64;

/// Tasks at most, unless more are asked for: what Slurm lets an array have if nobody has changed it.
const MOST: usize = 1000;

impl Films {
    /// The films of these frames if there is room for all of them, however many machines share the work.
    pub fn of(sequence: &Sequence, frames: &[u32], extras: Extras) -> Self {
        let plan = Plan::new(sequence, frames, extras, u64::MAX);
        let write = plan.room.pixels as f64 * WRITE;
        let films = plan.takes.iter().zip(work(sequence, &plan, Effort::PLAN).films).map(|(take, rays)| {
            let frames: Vec<u32> = take.frames.iter().map(|&index| frames[index]).collect();
            let work = rays + write * frames.len() as f64;
            (frames, work)
        });
        Self(films.collect())
    }

    fn total(&self) -> f64 {
        self.0.iter().map(|(_, work)| work).sum()
    }
}

/// Films in about `wanted` chunks, or as many as are worth a task.
pub fn classes(films: &Films, wanted: Option<usize>) -> Vec<Class> {
    let worth = (films.total() / WORTH).ceil() as usize;
    let wanted = wanted.unwrap_or(worth.min(MOST)).max(1);
    let target = films.total() / wanted as f64;
    alike(films).iter().map(|class| divided(films, class, target)).collect()
}

/// The films by their work, those that take longest first; in one class none takes twice as long as another. In each
/// class they are in the order of their first frames.
fn alike(films: &Films) -> Vec<Vec<usize>> {
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

/// A class in chunks of about this work.
fn divided(films: &Films, class: &[usize], target: f64) -> Class {
    let total: f64 = class.iter().map(|&index| films.0[index].1).sum();
    let count = ((total / target).round() as usize).clamp(1, class.len());
    // As engines divide a list that they are told how many of to take.
    let films_each = class.len().div_ceil(count);
    let chunks = even(class.len(), class.len().div_ceil(films_each)).map(|range| {
        let mut chunk = Chunk { leads: Vec::new(), frames: Vec::new(), work: 0.0 };
        for (frames, work) in class[range].iter().map(|&index| &films.0[index]) {
            chunk.leads.extend(frames.first());
            chunk.frames.extend(frames);
            chunk.work += work;
        }
        chunk.frames.sort_unstable();
        chunk
    });
    Class { films: films_each, chunks: chunks.collect() }
}

/// So many things in parts that differ by one at most.
fn even(things: usize, parts: usize) -> impl Iterator<Item = Range<usize>> {
    (0..parts).map(move |part| part * things / parts..(part + 1) * things / parts)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::parse;

    /// The frames of chunks of films with so much work.
    fn chunks(films: &[(&[u32], f64)], wanted: usize) -> Vec<(usize, Vec<Vec<u32>>)> {
        let films = Films(films.iter().map(|(frames, work)| (frames.to_vec(), *work)).collect());
        let told = |class: Class| (class.films, class.chunks.into_iter().map(|chunk| chunk.frames).collect());
        classes(&films, Some(wanted)).into_iter().map(told).collect()
    }

    #[test]
    fn frames_of_a_film_stay_together() {
        let films: [(&[u32], f64); 4] = [(&[0, 4], 10.0), (&[1, 5], 10.0), (&[2, 6], 10.0), (&[3], 10.0)];
        assert_eq!(chunks(&films, 2), [(2, vec![vec![0, 1, 4, 5], vec![2, 3, 6]])]);
        assert_eq!(chunks(&films, 1), [(4, vec![vec![0, 1, 2, 3, 4, 5, 6]])]);
        assert_eq!(chunks(&films, 9).iter().map(|(_, chunks)| chunks.len()).sum::<usize>(), 4);
    }

    #[test]
    fn films_that_take_longest_come_first_and_fewer_at_a_time() {
        let films: [(&[u32], f64); 6] =
            [(&[0], 10.0), (&[1], 9.0), (&[2], 80.0), (&[3], 11.0), (&[4], 70.0), (&[5], 10.0)];
        let expected = [(1, vec![vec![2], vec![4]]), (4, vec![vec![0, 1, 3, 5]])];
        assert_eq!(chunks(&films, 3), expected);
    }

    /// Every frame once, whatever is asked for; and no chunk that takes more than twice its share without need.
    #[test]
    fn every_frame_is_in_one_chunk() {
        for (count, wanted) in [(1u32, 1usize), (7, 3), (96, 10), (97, 1000), (5, 2)] {
            let films: Vec<(Vec<u32>, f64)> =
                (0..count).map(|frame| (vec![frame], f64::from(1 + frame * 7919 % 13))).collect();
            let most = films.iter().map(|(_, work)| *work).fold(0.0, f64::max);
            let films = Films(films);
            let share = films.total() / wanted as f64;
            let classes = classes(&films, Some(wanted));
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
    fn a_light_show_is_one_film_and_a_loop_has_as_many_as_a_round() {
        let films = |text: &str| {
            let sequence = parse("a.ron", text).expect("a sequence");
            let frames: Vec<u32> = (0..sequence.timeline.frames).collect();
            Films::of(&sequence, &frames, Extras::default()).0
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
        assert!(turn.iter().all(|(_, work)| *work >= 48.0 + 2.0 * 48.0 * WRITE));
    }
}

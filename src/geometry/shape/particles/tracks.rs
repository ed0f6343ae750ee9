//! Particles over time: rows of a table.

use super::set::{Origin, ParticleSet};
use crate::base::digest::Digest;
use crate::base::math::{Aabb, DVec3};
use crate::base::time::{Fraction, Time};
use crate::geometry::shape::{Geometric, Sphere};
use crate::geometry::table_rows::TableColumns;
use crate::track::Animate;
use rayon::prelude::*;
use std::sync::{Arc, OnceLock};

/// Particles per parallel task.
const CHUNK: usize = 4096;

/// The rows of a table of particles, in any order.
#[derive(Clone, Debug, Default)]
pub struct ParticleRows {
    /// All times of the table, ascending. Empty if the particles do not move; then every row is a particle.
    pub times: Vec<Time>,
    /// With times: the index of each row's time, and the particle's number.
    pub time_of: Vec<u32>,
    pub id_of: Vec<f64>,
    /// The centre and the radius of each row.
    pub spheres: Vec<Sphere>,
    /// Names and numbers of other columns. NaN stands for a missing number.
    pub columns: Vec<(String, Vec<f64>)>,
    /// The names of columns that do not hold numbers, and why not.
    pub unusable: Vec<(String, String)>,
}

/// Two rows of one particle have the same time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SameTime(pub usize, pub usize);

/// Particles over time. A particle is there from its first to its last row. Particles of the first time are there
/// before it, and those of the last time after it.
#[derive(Debug)]
pub struct ParticleTracks {
    times: Vec<Time>,
    /// By particle, then by time; as all rows.
    time_of: Vec<u32>,
    spheres: Vec<Sphere>,
    columns: TableColumns,
    /// The end of each particle's rows; empty if every row is a particle.
    ends: Vec<u32>,
    /// A box around the particles at each time. Computed at the first call.
    boxes: OnceLock<Vec<Aabb>>,
}

/// Compared by address, as meshes are.
impl PartialEq for ParticleTracks {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}

impl ParticleTracks {
    /// Sorts rows by particle and time.
    ///
    /// # Errors
    /// If a particle has two rows of one time.
    pub fn new(rows: ParticleRows) -> Result<Self, SameTime> {
        let ParticleRows { times, mut time_of, id_of, mut spheres, mut columns, unusable } = rows;
        let mut ends = Vec::new();
        if !times.is_empty() {
            let mut order: Vec<u32> = (0..spheres.len() as u32).collect();
            let key = |row: u32| (id_of[row as usize], time_of[row as usize]);
            order.par_sort_unstable_by(|&a, &b| {
                let ((id, time), (other, later)) = (key(a), key(b));
                id.total_cmp(&other).then(time.cmp(&later)).then(a.cmp(&b))
            });
            for (place, pair) in order.windows(2).enumerate() {
                if key(pair[0]) == key(pair[1]) {
                    return Err(SameTime(pair[0] as usize, pair[1] as usize));
                }
                if key(pair[0]).0 != key(pair[1]).0 {
                    ends.push(place as u32 + 1);
                }
            }
            ends.push(order.len() as u32);
            time_of = sorted(&time_of, &order);
            spheres = sorted(&spheres, &order);
            columns.iter_mut().for_each(|(_, values)| *values = sorted(values, &order));
        }
        let columns = TableColumns::new(columns, unusable);
        Ok(Self { times, time_of, spheres, columns, ends, boxes: OnceLock::new() })
    }

    /// Spheres that do not move.
    pub fn still(spheres: Vec<Sphere>) -> Self {
        let (times, time_of, columns, ends) = Default::default();
        Self { times, time_of, spheres, columns, ends, boxes: OnceLock::new() }
    }

    /// Whether particles move, appear or vanish.
    pub fn is_keyed(&self) -> bool {
        self.times.len() > 1
    }

    /// The columns that textures may read, with the numbers of all rows.
    pub fn columns(&self) -> &TableColumns {
        &self.columns
    }

    /// A time at which the particles are as at `time`.
    fn clamped(&self, time: Time) -> Time {
        match (self.times.first(), self.times.last()) {
            (Some(first), Some(last)) => time.clamp(*first, *last),
            _ => time,
        }
    }

    /// A digest that differs if particles may be different.
    pub fn moment(&self, time: Time) -> Digest {
        let time = self.clamped(time);
        Digest::of(&(time.numer().cast_unsigned(), time.denom().cast_unsigned()))
    }

    /// The particles at a time, without a tree.
    pub fn at(self: &Arc<Self>, time: Time) -> ParticleSet {
        let is_there = |(sphere, _): &(Sphere, Origin)| sphere.radius > 0.0;
        let (spheres, origins) = match self.times.is_empty() {
            true => {
                let rows =
                    (0..).zip(&self.spheres).map(|(row, sphere)| (*sphere, Origin { row, share: 0.0 }));
                rows.filter(is_there).unzip()
            }
            false => self.moving(time).filter(is_there).unzip(),
        };
        ParticleSet::new(Arc::clone(self), spheres, origins)
    }

    /// The particles at a time, in the order of their numbers.
    fn moving(&self, time: Time) -> impl Iterator<Item = (Sphere, Origin)> {
        let time = self.clamped(time);
        let low = self.times.partition_point(|known| *known <= time).saturating_sub(1);
        let now = Moment { time, low: low as u32, exact: self.times[low] == time };
        let chunk = |(chunk, ends): (usize, &[u32])| -> Vec<(Sphere, Origin)> {
            let mut begin = (chunk * CHUNK).checked_sub(1).map_or(0, |before| self.ends[before] as usize);
            let mut last = None;
            let mut found = Vec::with_capacity(ends.len());
            for &end in ends {
                found.extend(self.particle(begin..end as usize, now, &mut last));
                begin = end as usize;
            }
            found
        };
        let chunks: Vec<_> = self.ends.par_chunks(CHUNK).enumerate().map(chunk).collect();
        chunks.into_iter().flatten()
    }

    /// A particle at a moment, if it is there. `last` keeps the fraction that the particle before needed.
    fn particle(
        &self,
        rows: std::ops::Range<usize>,
        now: Moment,
        last: &mut Option<([u32; 2], Fraction)>,
    ) -> Option<(Sphere, Origin)> {
        let times = &self.time_of[rows.clone()];
        // Most particles have a row at every time.
        let guess = now.low as usize;
        let before = match times.get(guess) {
            Some(&time) if time == now.low => guess,
            _ => times.partition_point(|time| *time <= now.low).checked_sub(1)?,
        };
        let (row, time) = (rows.start + before, times[before]);
        if now.exact && time == now.low {
            return Some((self.spheres[row], Origin { row: row as u32, share: 0.0 }));
        }
        let pair = [time, *times.get(before + 1)?];
        let share = match last {
            Some((known, share)) if *known == pair => *share,
            _ => {
                let [a, b] = pair.map(|time| self.times[time as usize]);
                last.insert((pair, Fraction::between(now.time, a, b))).1
            }
        };
        let (a, b) = (&self.spheres[row], &self.spheres[row + 1]);
        let center = DVec3::mix(&a.center, &b.center, share);
        let sphere = Sphere { center, radius: f64::mix(&a.radius, &b.radius, share) };
        Some((sphere, Origin { row: row as u32, share: share.value() }))
    }

    /// A box around the particles at a time; none if there are none.
    pub fn bounds_at(&self, time: Time) -> Option<Aabb> {
        let around = |all: Aabb, sphere: &Sphere| all.union(sphere.bounds().unwrap_or(Aabb::EMPTY));
        let boxes = self.boxes.get_or_init(|| match self.times.is_empty() {
            true => vec![self.spheres.iter().fold(Aabb::EMPTY, around)],
            false => self
                .times
                .iter()
                .map(|time| self.moving(*time).fold(Aabb::EMPTY, |all, (sphere, _)| around(all, &sphere)))
                .collect(),
        });
        // Between two times, every particle is within the box around both of its places there.
        let low = self.times.partition_point(|known| *known <= time).saturating_sub(1);
        let next = boxes.get(low + 1).filter(|_| self.times.get(low).is_some_and(|known| *known < time));
        let bounds = boxes[low].union(next.copied().unwrap_or(Aabb::EMPTY));
        (!bounds.is_empty()).then_some(bounds)
    }

    /// A box around all rows.
    pub fn bounds(&self) -> Aabb {
        let boxes = self.spheres.iter().filter_map(Geometric::bounds);
        boxes.fold(Aabb::EMPTY, Aabb::union)
    }
}

/// A moment between the first and the last time.
#[derive(Clone, Copy)]
struct Moment {
    time: Time,
    /// The index of the last time that is not after it.
    low: u32,
    exact: bool,
}

fn sorted<T: Copy + Send + Sync>(values: &[T], order: &[u32]) -> Vec<T> {
    order.par_iter().map(|row| values[*row as usize]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::mesh::ArrayKey;

    fn at(x: f64) -> Sphere {
        Sphere { center: DVec3::new(x, 0.0, 0.0), radius: 1.0 }
    }

    /// Rows of (time, particle, x), with `heat` = 10 x.
    fn tracks(times: &[i128], rows: &[(u32, f64, f64)]) -> Result<Arc<ParticleTracks>, SameTime> {
        let rows = ParticleRows {
            times: times.iter().map(|time| Time::from_integer(*time)).collect(),
            time_of: rows.iter().map(|row| row.0).collect(),
            id_of: rows.iter().map(|row| row.1).collect(),
            spheres: rows.iter().map(|row| at(row.2)).collect(),
            columns: vec![("heat".to_owned(), rows.iter().map(|row| 10.0 * row.2).collect())],
            unusable: Vec::new(),
        };
        ParticleTracks::new(rows).map(Arc::new)
    }

    fn places(tracks: &Arc<ParticleTracks>, time: Time) -> Vec<f64> {
        tracks.at(time).spheres().iter().map(|sphere| sphere.center.x).collect()
    }

    #[test]
    fn particles_are_born_move_and_die() {
        // 7 is there all the time, 3 from the second time on, 5 until the second; 4 only at the second.
        let rows = [
            (1, 3.0, 30.0),
            (0, 7.0, 70.0),
            (2, 7.0, 90.0),
            (0, 5.0, 50.0),
            (1, 5.0, 52.0),
            (1, 4.0, 40.0),
            (2, 3.0, 31.0),
        ];
        let tracks = tracks(&[0, 2, 4], &rows).expect("tracks");
        let half = |n: i128| places(&tracks, Time::new(n, 2));
        assert_eq!(half(-3), [50.0, 70.0], "before the first time");
        assert_eq!(half(0), [50.0, 70.0]);
        assert_eq!(half(2), [51.0, 75.0], "over a time without a row");
        assert_eq!(half(4), [30.0, 40.0, 52.0, 80.0], "exactly at a time");
        assert_eq!(half(5), [30.25, 82.5]);
        assert_eq!(half(99), [31.0, 90.0], "after the last time");
        let set = tracks.at(Time::new(5, 2));
        let heat = ArrayKey::whole("heat".to_owned());
        assert_eq!([0, 1].map(|part| set.number(&heat, part)), [Some(302.5), Some(800.0 + 25.0)]);
    }

    #[test]
    fn boxes_hold_the_particles() {
        let rows = [(0, 1.0, 0.0), (1, 1.0, 10.0), (0, 2.0, -5.0), (2, 2.0, 5.0)];
        let tracks = tracks(&[0, 1, 3], &rows).expect("tracks");
        for sixth in -6..=24 {
            let time = Time::new(sixth, 6);
            let bounds = tracks.bounds_at(time).expect("particles");
            for x in places(&tracks, time) {
                assert!(bounds.min.x <= x - 1.0 && x + 1.0 <= bounds.max.x, "{sixth}");
            }
        }
        assert!(tracks.bounds().max.x >= 11.0);
    }

    #[test]
    fn a_particle_is_at_one_place() {
        let twice = tracks(&[0, 1], &[(0, 1.0, 0.0), (1, 2.0, 0.0), (0, 1.0, 5.0)]);
        assert_eq!(twice.expect_err("a fault"), SameTime(0, 2));
    }
}

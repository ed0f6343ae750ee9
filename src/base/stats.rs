//! Exact counts of work done, for summaries and tests.

use crate::base::cancel::Stop;
use std::ops::AddAssign;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering::Relaxed};
use std::sync::{Mutex, OnceLock};
use std::time::Instant;

/// Declares a struct of counts that add up.
macro_rules! counts {
    ($(#[$doc:meta])* $name:ident { $($(#[$field_doc:meta])* $field:ident),* $(,)? }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub struct $name {
            $($(#[$field_doc])* pub $field: u64,)*
        }

        impl $name {
            pub fn total(&self) -> u64 {
                [$(self.$field),*].iter().sum()
            }
        }

        impl AddAssign for $name {
            fn add_assign(&mut self, other: Self) {
                $(self.$field += other.$field;)*
            }
        }
    };
}

counts! {
    /// Rays by kind.
    RayCounts {
        camera,
        /// Reflected by mirrors and boundaries, sharp or rough.
        mirror,
        /// Passed on through what is transparent, bent or not.
        transmitted,
        /// Scattered along paths.
        scattered,
        /// Towards lights. One that passes a transparent surface counts again.
        shadow,
    }
}

counts! {
    /// What effects ask for besides rays; exactly none where nothing calls for them.
    Evaluations {
        /// Ways through fog.
        fog,
        /// Points of surfaces that paint was looked up for.
        paint,
        /// Directions that were drawn towards lights with an area, things that shine and skies.
        light_samples,
        /// Points that were drawn on a lens.
        lens_samples,
    }
}

counts! {
    /// Samples that were left out of the picture because they are no light, by cause. A sample counts once in
    /// each of its layers.
    Dropped {
        /// Not a number.
        undefined,
        infinite,
        negative,
    }
}

/// All that tracing counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    pub rays: RayCounts,
    pub evaluations: Evaluations,
    pub dropped: Dropped,
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.rays += other.rays;
        self.evaluations += other.evaluations;
        self.dropped += other.dropped;
    }
}

/// How far a run has come, for whoever watches from another thread, and whether it is to stop. Nothing else is decided
/// by it.
#[derive(Debug, Default)]
pub struct Meter {
    /// Frames made.
    pub frames: AtomicU32,
    /// Those of them that were made of the film of another.
    pub reused: AtomicU32,
    /// Share of the frame in hand, in thousandths.
    pub thousandths: AtomicU32,
    pub rays: AtomicU64,
    /// Told when tracing begins.
    pub outset: OnceLock<Outset>,
    /// Asks films in the making to end with the samples that they have; and whether one has.
    pub stop: OnceLock<Stop>,
    pub unfinished: AtomicBool,
    /// Lines that whoever watches should show.
    pub notices: Mutex<Vec<Line>>,
}

/// A line for people, and the same for programs: an object of JSON.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Line {
    pub text: String,
    pub json: String,
}

/// What a run has before it when tracing begins.
#[derive(Clone, Debug)]
pub struct Outset {
    pub at: Instant,
    /// Frames that were there before.
    pub kept: u32,
    /// Rays that each film is expected to take, in the order in which they are traced; none where there is no plan.
    pub films: Vec<f64>,
}

/// How much is done of what takes time, and how much is left: in rays, or in frames where nobody knows about rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Work {
    pub done: f64,
    pub rest: f64,
}

impl Meter {
    /// Tells that tracing begins.
    pub fn begin(&self, kept: usize, films: Vec<f64>) {
        // Whoever watches a second run with the same meter goes on from the first.
        let _ = self.outset.set(Outset { at: Instant::now(), kept: kept as u32, films });
    }

    /// Whether the run is to stop.
    pub fn is_stopped(&self) -> bool {
        self.stop.get().is_some_and(|stop| stop.signal().is_some())
    }

    /// Has whoever watches show a line.
    pub fn notice(&self, line: Line) {
        if let Ok(mut notices) = self.notices.lock() {
            notices.push(line);
        }
    }

    /// Lines that nobody has shown yet.
    pub fn take_notices(&self) -> Vec<Line> {
        self.notices.lock().map(|mut notices| std::mem::take(&mut *notices)).unwrap_or_default()
    }

    /// Frames traced so far, with the part of the one in hand.
    pub fn frames_done(&self) -> f64 {
        f64::from(self.frames.load(Relaxed)) + f64::from(self.thousandths.load(Relaxed)) / 1000.0
    }

    /// What is done of a run of so many frames. Those that were there, or are made of the film of another, take next to
    /// nothing.
    pub fn work(&self, frames: usize) -> Work {
        let outset = self.outset.get();
        let kept = outset.map_or(0.0, |outset| f64::from(outset.kept));
        // The meter's parts are not read at once, and may be a frame apart.
        let made = (self.frames_done() - kept).max(0.0);
        match outset.map(|outset| &outset.films[..]) {
            Some(films @ [_, ..]) => Work::of(films, made - f64::from(self.reused.load(Relaxed))),
            _ => Work { done: made, rest: (frames as f64 - kept - made).max(0.0) },
        }
    }
}

impl Work {
    /// Of films that take so many rays, of which so many are traced.
    fn of(films: &[f64], traced: f64) -> Self {
        let share = |film: usize| (traced - film as f64).clamp(0.0, 1.0);
        let sum = |part: &dyn Fn(usize) -> f64| {
            films.iter().enumerate().map(|(film, rays)| part(film) * rays).sum()
        };
        Self { done: sum(&share), rest: sum(&|film| 1.0 - share(film)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A meter that shows frames done, those of them that were reused, and the part of the one in hand.
    fn meter(frames: u32, reused: u32, thousandths: u32) -> Meter {
        Meter {
            frames: frames.into(),
            reused: reused.into(),
            thousandths: thousandths.into(),
            ..Meter::default()
        }
    }

    #[test]
    fn without_a_plan_frames_are_counted() {
        assert_eq!(meter(0, 0, 0).work(8), Work { done: 0.0, rest: 8.0 });
        assert_eq!(meter(5, 0, 500).work(8), Work { done: 5.5, rest: 2.5 });
        let resumed = meter(5, 0, 500);
        resumed.begin(4, Vec::new());
        assert_eq!(resumed.work(8), Work { done: 1.5, rest: 2.5 });
    }

    #[test]
    fn frames_of_other_films_and_of_earlier_runs_weigh_nothing() {
        let (films, frames) = (vec![600.0, 100.0, 300.0], 12);
        let work = |frames_done: u32, reused: u32, thousandths: u32| {
            let meter = meter(frames_done, reused, thousandths);
            meter.begin(4, films.clone());
            meter.work(frames)
        };
        assert_eq!(work(4, 0, 0), Work { done: 0.0, rest: 1000.0 });
        assert_eq!(work(4, 0, 500), Work { done: 300.0, rest: 700.0 });
        assert_eq!(work(8, 3, 0), Work { done: 600.0, rest: 400.0 });
        assert_eq!(work(9, 3, 250), Work { done: 775.0, rest: 225.0 });
        // Only frames of films that are traced are left.
        assert_eq!(work(10, 3, 0), Work { done: 1000.0, rest: 0.0 });
        // Read between two stores of whoever counts.
        assert_eq!(work(6, 3, 0), Work { done: 0.0, rest: 1000.0 });
    }
}

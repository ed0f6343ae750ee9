//! What is tried: settings that differ from the file's own along one axis each.

use super::layering::Layering;
use crate::quality::{Integrator, NoiseTarget, PathSettings, Quality};
use crate::sampling::Points;

/// Which setting differs from the file's.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Axis {
    /// Random samples in a pixel, stratified.
    Samples,
    /// The same of independent ones, to see what stratifying gains.
    Independent,
    /// Sampling until an error is reached.
    Noise,
    /// Samples on a regular grid, where nothing is random.
    Antialias,
    /// Longest chain of reflections.
    Bounces,
    /// When dim paths may end.
    Roulette,
    /// In how many layers light is kept apart.
    Layers,
}

impl Axis {
    pub const ALL: [Self; 7] = [
        Self::Samples,
        Self::Independent,
        Self::Noise,
        Self::Antialias,
        Self::Bounces,
        Self::Roulette,
        Self::Layers,
    ];

    /// In plots and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Samples => "samples",
            Self::Independent => "independent samples",
            Self::Noise => "until an error is reached",
            Self::Antialias => "anti-aliasing grid",
            Self::Bounces => "bounces",
            Self::Roulette => "roulette",
            Self::Layers => "layers of light",
        }
    }

    /// For people who have not met it.
    pub fn meaning(self) -> &'static str {
        match self {
            Self::Samples => {
                "How many random rays look through each pixel. Kinora spreads them evenly (Sobol points), so that more \
                 of them help more than chance would."
            }
            Self::Independent => {
                "The same number of rays, each drawn like dice. Only here to show what spreading them gains."
            }
            Self::Noise => {
                "Every block of 8 x 8 pixels gets samples until its error is small enough: smooth parts few, difficult \
                 parts many."
            }
            Self::Antialias => {
                "Rays on a regular grid in each pixel, n x n of them, that smooth jagged edges. Nothing is random."
            }
            Self::Bounces => {
                "How often light may go from one surface to the next. Fewer bounces leave light out: that error is a \
                 bias, which more samples do not take away."
            }
            Self::Roulette => {
                "After this many bounces, dim rays end at random and others make up for them: less time, more noise."
            }
            Self::Layers => {
                "Light that is keyed in one way is kept apart from all other light, in a layer of its own, so that frames \
                 in which only lights change need no rays. Every layer asks its lights by itself."
            }
        }
    }

    /// Whether points along it form a curve along which more is better.
    pub fn is_curve(self) -> bool {
        !matches!(self, Self::Roulette | Self::Layers)
    }
}

/// One point on an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    pub axis: Axis,
    pub quality: Quality,
    /// What it is on its axis: a number, or `off`.
    pub value: String,
    /// What to paste behind `kinora render FILE`; empty if only the file can say it.
    pub flags: String,
    pub layering: Layering,
}

/// An axis that is not tried, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftOut {
    pub what: &'static str,
    pub why: String,
}

/// What is tried of a sequence.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// The first is the file's own.
    pub all: Vec<Setting>,
    pub left_out: Vec<LeftOut>,
    /// Whether pixels have random samples.
    pub random: bool,
    /// Samples in each pixel of each of both references.
    pub reference: u32,
    /// The same where bounces are compared, and how many of these.
    pub deep: (u32, u32),
    /// Samples at most where bounces and roulette are compared.
    short: u32,
}

/// The reference has this many times the samples of anything that it judges.
const FINER: u32 = 64;
/// Samples that show what a bounce or roulette changes.
const SHORT: u32 = 16;
/// Samples that whatever is sampled until it is good may take.
const LEAST_PATIENCE: u32 = 64;

impl Settings {
    /// Along all axes that mean something where pixels are sampled at random, or are not. `most` is how many samples
    /// the longest ladder reaches.
    pub fn new(own: &Quality, random: bool, most: u32) -> Self {
        let mut settings = Self {
            all: Vec::new(),
            left_out: Vec::new(),
            random,
            reference: 0,
            deep: (0, own.bounces.saturating_mul(2).max(16)),
            short: if most > 16 { SHORT } else { SHORT / 4 },
        };
        if random {
            settings.samples(own, most);
            settings.noise(own, most);
        } else {
            settings.grids(own);
        }
        settings.bounces(own);
        settings.roulette(own);
        settings.leave_out(
            "light samples",
            "each surface asks every light once for every sample of a pixel: it is the axis of samples",
        );
        settings
    }

    fn push(&mut self, axis: Axis, quality: Quality, value: String, flags: String) {
        self.all.push(Setting { axis, quality, value, flags, layering: Layering::Own });
    }

    fn leave_out(&mut self, what: &'static str, why: &str) {
        self.left_out.push(LeftOut { what, why: why.to_owned() });
    }

    fn samples(&mut self, own: &Quality, most: u32) {
        let plain = |samples, points| Quality { samples, points, noise: None, ..*own };
        let flags = |samples| format!("--samples {samples}");
        // The file's own comes first.
        match own.noise {
            Some(target) => {
                self.push(Axis::Noise, *own, percent(target.error), format!("--noise {}", target.error));
            }
            None => self.push(Axis::Samples, *own, own.samples.to_string(), flags(own.samples)),
        }
        // Every power of two up to 16, then every other one.
        let ladder = [1, 2, 4, 8, 16, 64, 256, 1024].into_iter().take_while(|&samples| samples <= most);
        let ladder: Vec<u32> = ladder.collect();
        for &samples in ladder.iter().filter(|&&samples| own.noise.is_some() || samples != own.samples) {
            self.push(Axis::Samples, plain(samples, own.points), samples.to_string(), flags(samples));
        }
        for &samples in &ladder {
            self.push(
                Axis::Independent,
                plain(samples, Points::Independent),
                samples.to_string(),
                String::new(),
            );
        }
        let own = if own.noise.is_some() { 0 } else { own.samples };
        self.reference = FINER.saturating_mul(most.max(own));
        self.deep.0 = FINER * self.short;
        self.leave_out(
            "anti-aliasing grid",
            "pixels have random samples in this frame, which smooth edges as well",
        );
    }

    fn noise(&mut self, own: &Quality, most: u32) {
        let errors = [0.2, 0.1, 0.05, 0.02];
        let wanted = if most >= 256 {
            &errors[..]
        } else if most > 16 {
            &errors[..2]
        } else {
            &errors[1..2]
        };
        for error in
            wanted.iter().copied().filter(|error| own.noise.is_none_or(|target| target.error != *error))
        {
            let target = NoiseTarget { error, most: own.noise.map_or(NoiseTarget::MOST, |own| own.most) };
            let quality = Quality { noise: Some(target), ..*own };
            self.push(Axis::Noise, quality, percent(error), format!("--noise {error}"));
        }
    }

    fn grids(&mut self, own: &Quality) {
        let grid = |n| (Quality { antialias: n, ..*own }, format!("{n}x{n}"), format!("--antialias {n}"));
        for n in [own.antialias].into_iter().chain((1..=4).filter(|&n| n != own.antialias)) {
            let (quality, value, flags) = grid(n);
            self.push(Axis::Antialias, quality, value, flags);
        }
        let finest = own.antialias.max(4);
        self.reference = FINER * finest * finest;
        self.deep.0 = own.antialias * own.antialias;
        for what in ["samples", "until an error is reached"] {
            self.leave_out(what, "nothing is random in this frame, so pixels are sampled on a regular grid");
        }
    }

    fn bounces(&mut self, own: &Quality) {
        let deeper = own.bounces.saturating_mul(2).max(1);
        let mut all: Vec<u32> = vec![0, 1, 2, own.bounces / 2, own.bounces, deeper];
        if self.short == SHORT {
            all.extend([3, 5, 8]);
        }
        all.sort_unstable();
        all.dedup();
        for bounces in all.into_iter().filter(|&bounces| bounces <= deeper) {
            let quality = Quality { bounces, ..self.short(own) };
            self.push(Axis::Bounces, quality, bounces.to_string(), format!("--bounces {bounces}"));
        }
    }

    fn roulette(&mut self, own: &Quality) {
        let Integrator::Path(path) = own.integrator else {
            return self.leave_out("roulette", "the integrator is Whitted, which has none");
        };
        let mut all = vec![path.roulette];
        all.extend(
            [None, Some(0), Some(3), Some(8)].into_iter().filter(|roulette| *roulette != path.roulette),
        );
        for roulette in all {
            let integrator = Integrator::Path(PathSettings { roulette, ..path });
            let value = roulette.map_or("off".to_owned(), |bounces| format!("after {bounces}"));
            self.push(Axis::Roulette, Quality { integrator, ..self.short(own) }, value, String::new());
        }
    }

    /// Adds the axis of layers, of which there are so many with each layering; none if there is nothing to compare.
    pub fn layers(&mut self, own: &Quality, counts: &[(Layering, u64)]) {
        if counts.len() < 2 {
            return self.leave_out(
                "layers of light",
                "one frame with several lights shows what they cost, and this is none",
            );
        }
        for &(layering, count) in counts {
            self.push(Axis::Layers, self.short(own), count.to_string(), String::new());
            if let Some(last) = self.all.last_mut() {
                last.layering = layering;
            }
        }
    }

    /// The file's quality with no more samples than it takes to compare.
    fn short(&self, own: &Quality) -> Quality {
        Quality { samples: own.samples.min(self.short), noise: None, ..*own }
    }

    /// Lets no setting but the file's own take more samples in a pixel than these until it is good.
    pub fn hurry(&mut self, most: u32) {
        let targets = self.all.iter_mut().skip(1).filter_map(|setting| setting.quality.noise.as_mut());
        targets.for_each(|target| target.most = target.most.min(most.max(LEAST_PATIENCE)));
    }

    /// Whether a setting was stopped before it was as good as it should be, if it took all samples that it may.
    pub fn is_unfinished(&self, index: usize, took_all: bool) -> bool {
        index > 0 && took_all && self.all[index].quality.noise.is_some()
    }

    /// Leaves out settings that were stopped, with what came of them.
    pub fn without_unfinished<T>(&mut self, came: Vec<T>, took_all: impl Fn(&T) -> bool) -> Vec<T> {
        let unfinished: Vec<bool> =
            came.iter().enumerate().map(|(index, came)| self.is_unfinished(index, took_all(came))).collect();
        for (setting, _) in self.all.iter().zip(&unfinished).filter(|(_, unfinished)| **unfinished) {
            let most = setting.quality.noise.map_or(0, |target| target.most);
            let why = format!(
                "{} is not reached everywhere by {most} samples in a pixel, and there was no time for more",
                setting.value
            );
            self.left_out.push(LeftOut { what: "until an error is reached", why });
        }
        let mut kept = unfinished.iter();
        self.all.retain(|_| kept.next().is_none_or(|unfinished| !unfinished));
        came.into_iter().zip(unfinished).filter(|(_, unfinished)| !unfinished).map(|(came, _)| came).collect()
    }

    /// The qualities of the references: those for most axes, and those for bounces.
    pub fn references(&self, own: &Quality) -> [Quality; 2] {
        let plain = Quality { noise: None, points: Points::Sobol, ..*own };
        let of = |samples, bounces| Quality { samples, bounces, ..plain };
        [of(self.reference, own.bounces), of(self.deep.0, self.deep.1)]
    }
}

fn percent(error: f64) -> String {
    format!("{} %", 100.0 * error)
}

/// How many samples a pixel gets by a quality, at most a guess where it is settled on the way.
pub fn samples_of(quality: &Quality, random: bool) -> f64 {
    match (random, quality.noise) {
        (false, _) => f64::from(quality.antialias * quality.antialias),
        (true, None) => f64::from(quality.samples),
        (true, Some(target)) => (1.0 / target.error).clamp(32.0, f64::from(target.most)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_own_setting_comes_first_and_once() {
        let path = Quality { integrator: Integrator::Path(PathSettings::default()), ..Quality::default() };
        for (own, random) in [(Quality::default(), false), (Quality::default(), true), (path, true)] {
            let settings = Settings::new(&own, random, 64);
            assert_eq!(settings.all[0].quality, own);
            let main = settings
                .all
                .iter()
                .filter(|s| !matches!(s.axis, Axis::Bounces | Axis::Roulette | Axis::Layers));
            assert_eq!(main.filter(|setting| setting.quality == own).count(), 1);
            let finest = settings.all.iter().map(|s| samples_of(&s.quality, random)).fold(0.0, f64::max);
            assert!(f64::from(settings.reference) >= 64.0 * finest || random);
        }
    }

    #[test]
    fn what_is_not_there_is_left_out_with_a_reason() {
        let left_out = |random| {
            let settings = Settings::new(&Quality::default(), random, 64);
            settings.left_out.iter().map(|left| left.what).collect::<Vec<_>>()
        };
        assert!(left_out(false).contains(&"samples") && !left_out(false).contains(&"anti-aliasing grid"));
        assert!(left_out(true).contains(&"anti-aliasing grid") && !left_out(true).contains(&"samples"));
        assert!(left_out(true).contains(&"roulette"));
    }
}

//! Along what settings differ.

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
    /// How light is followed.
    Integrator,
    /// Effects, lights and objects, each switched off.
    Parts,
    /// What may remove fireflies.
    Remedies,
}

impl Axis {
    pub const ALL: [Self; 10] = [
        Self::Samples,
        Self::Independent,
        Self::Noise,
        Self::Antialias,
        Self::Bounces,
        Self::Roulette,
        Self::Layers,
        Self::Integrator,
        Self::Parts,
        Self::Remedies,
    ];

    /// In plots and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Samples => "samples",
            Self::Independent => "independent samples",
            Self::Noise => "noise target",
            Self::Antialias => "anti-aliasing grid",
            Self::Bounces => "bounces",
            Self::Roulette => "roulette",
            Self::Layers => "layers of light",
            Self::Integrator => "integrator",
            Self::Parts => "switched off",
            Self::Remedies => "against fireflies",
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
                "The same number of rays with independent random numbers. Only here to show what Sobol points gain."
            }
            Self::Noise => {
                "--noise: the renderer adds samples until the error of the frame is below the target, most of them where \
                 the picture is noisy."
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
                "Light whose keys differ is kept apart from all other light, in a layer of its own, so that frames in \
                 which only lights change need no rays. Every layer samples its lights by itself."
            }
            Self::Integrator => {
                "Whitted ray tracing follows mirrors and glass only; path tracing follows light from every surface to \
                 every other."
            }
            Self::Parts => "Each effect, light and object of the scene, switched off in turn.",
            Self::Remedies => {
                "Settings that make single bright pixels (fireflies) rarer. Most of them change the picture: that is \
                 their bias."
            }
        }
    }

    /// Whether its settings are compared with the file's own over the same few random numbers, not with the reference.
    pub fn is_short(self) -> bool {
        !matches!(self, Self::Samples | Self::Independent | Self::Noise | Self::Antialias)
    }
}

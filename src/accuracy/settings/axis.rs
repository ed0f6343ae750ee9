//! The axes along which settings differ.

/// Which setting differs from the file's.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SettingAxis {
    /// Number of random samples per pixel, stratified.
    Samples,
    /// Number of independent samples per pixel, to show what stratification gains.
    Independent,
    /// Adaptive sampling until a noise target is reached.
    Noise,
    /// Samples on a regular grid, if nothing is random.
    Antialias,
    /// The largest number of bounces.
    Bounces,
    /// The number of bounces after which Russian roulette starts.
    Roulette,
    /// The number of film layers.
    Layers,
    /// The integrator.
    Integrator,
    /// Effects, lights and objects, each switched off.
    Parts,
    /// Remedies for fireflies.
    Remedies,
}

impl SettingAxis {
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

    /// The name for plots and tables.
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

    /// An explanation for readers of the report.
    pub fn meaning(self) -> &'static str {
        match self {
            Self::Samples => {
                "The number of random camera rays per pixel. Kinora distributes them evenly (Sobol points), so that \
                 the error falls faster than with independent random numbers."
            }
            Self::Independent => {
                "The same number of rays with independent random numbers. Measured only to show what Sobol points gain."
            }
            Self::Noise => {
                "--noise: the renderer adds samples until the error of the frame is below the target. It adds most of \
                 them where the picture is noisy."
            }
            Self::Antialias => {
                "A regular grid of n x n rays in each pixel, which smooths jagged edges. Nothing is random."
            }
            Self::Bounces => {
                "The largest number of surfaces that scatter light on its way. Fewer bounces omit light: that error \
                 is a bias, which more samples do not reduce."
            }
            Self::Roulette => {
                "After this number of bounces, dim paths end at random, and the remaining paths count for more: less \
                 time, more noise."
            }
            Self::Layers => {
                "Lights with different keys have film layers of their own, so that frames in which only lights change \
                 need no rays. Each layer samples its lights separately."
            }
            Self::Integrator => {
                "Whitted ray tracing follows only mirrors and glass; path tracing follows light between all surfaces."
            }
            Self::Parts => "Each effect, light and object of the scene, switched off one at a time.",
            Self::Remedies => {
                "Settings that reduce single bright pixels (fireflies). Most of them change the picture: that change \
                 is their bias."
            }
        }
    }

    /// Whether settings of this axis are compared with a baseline: the file's own setting with as few samples of the
    /// same random numbers. The others are compared with the reference.
    pub fn has_baseline(self) -> bool {
        !matches!(self, Self::Samples | Self::Independent | Self::Noise | Self::Antialias)
    }
}

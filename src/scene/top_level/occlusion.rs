//! Results of shadow rays.

/// A flag for each primitive that transmits light at some point. Shadow rays do not end there.
#[derive(Clone, Copy, Debug)]
pub struct TransmissiveFlags<'a>(pub &'a [bool]);

/// Which shadow rays meet something.
#[derive(Clone, Copy, Debug)]
pub struct Occlusion<M> {
    pub blocked: M,
    /// Rays that are not blocked but hit a transmissive primitive.
    pub dimmed: M,
}

/// Whether a primitive transmits light.
#[inline(always)]
pub(super) fn is_transmissive(transmissive: Option<TransmissiveFlags>, index: u32) -> bool {
    transmissive.is_some_and(|TransmissiveFlags(flags)| flags[index as usize])
}

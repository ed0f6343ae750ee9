//! The choice of the level on which kernels run.

use std::env;
use std::ffi::OsStr;
use std::fmt;
use std::sync::OnceLock;

/// The environment variable that forces a level: `portable`, `avx2` or `avx512`. An empty value counts as unset.
/// Outputs are the same on every level; the variable serves to check that, and to measure.
pub const LEVEL_VARIABLE: &str = "KINORA_SIMD";

/// All levels, the narrowest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum LevelName {
    Portable,
    Avx2,
    Avx512,
}

impl LevelName {
    pub const ALL: [Self; 3] = [Self::Portable, Self::Avx2, Self::Avx512];

    /// The name that users write.
    pub fn name(self) -> &'static str {
        match self {
            Self::Portable => "portable",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }

    /// Whether the processor has it.
    pub fn is_available(self) -> bool {
        match self {
            Self::Portable => true,
            #[cfg(all(target_arch = "x86_64", not(feature = "portable-only")))]
            Self::Avx2 => super::x86::has_avx2(),
            #[cfg(all(target_arch = "x86_64", not(feature = "portable-only")))]
            Self::Avx512 => super::x86::has_avx512(),
            #[cfg(any(not(target_arch = "x86_64"), feature = "portable-only"))]
            _ => false,
        }
    }
}

/// Why [`LEVEL_VARIABLE`] forces no level.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LevelError {
    value: String,
    /// Whether `value` is the name of a level.
    is_known: bool,
    available: Vec<&'static str>,
}

impl fmt::Display for LevelError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { value, is_known, available } = self;
        let why = if *is_known { "this processor does not have it" } else { "there is no such SIMD level" };
        let valid = available.join(", ");
        write!(f, "environment variable {LEVEL_VARIABLE} is {value:?}, but {why}; valid here: {valid}")
    }
}

impl std::error::Error for LevelError {}

/// The level that [`LEVEL_VARIABLE`] forces, if it is set.
///
/// # Errors
/// If its value is not the name of a level that the processor has.
pub fn forced_level() -> Result<Option<LevelName>, LevelError> {
    match env::var_os(LEVEL_VARIABLE).filter(|value| !value.is_empty()) {
        Some(value) => named(&value, &available()).map(Some),
        None => Ok(None),
    }
}

fn available() -> Vec<LevelName> {
    LevelName::ALL.into_iter().filter(|level| level.is_available()).collect()
}

/// The level with a name, if it is available.
fn named(name: &OsStr, available: &[LevelName]) -> Result<LevelName, LevelError> {
    let found = available.iter().find(|level| name == level.name());
    found.copied().ok_or_else(|| LevelError {
        value: name.to_string_lossy().into_owned(),
        is_known: LevelName::ALL.iter().any(|level| name == level.name()),
        available: available.iter().map(|level| level.name()).collect(),
    })
}

/// The level on which kernels run: the level that [`LEVEL_VARIABLE`] forces, or the best level of the processor.
/// Invalid values of the variable count as unset here, so programs should call [`forced_level`] first to report them.
#[inline]
pub fn level() -> LevelName {
    static LEVEL: OnceLock<LevelName> = OnceLock::new();
    #[cfg(test)]
    if let Some(level) = super::tests::FORCED.get() {
        return level;
    }
    *LEVEL.get_or_init(|| {
        let best = || available().pop().unwrap_or(LevelName::Portable);
        forced_level().ok().flatten().unwrap_or_else(best)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_named_exactly_and_must_be_there() {
        let available = [LevelName::Portable, LevelName::Avx2];
        let named = |name: &str| named(OsStr::new(name), &available);
        assert_eq!(named("avx2"), Ok(LevelName::Avx2));
        for (name, why) in [
            ("avx512", "this processor does not have it"),
            ("AVX2", "there is no such SIMD level"),
            (" avx2", "there is no such SIMD level"),
            ("foo", "there is no such SIMD level"),
        ] {
            let message = named(name).map_err(|error| error.to_string());
            let expected = format!(
                "environment variable KINORA_SIMD is {name:?}, but {why}; valid here: portable, avx2"
            );
            assert_eq!(message, Err(expected));
        }
    }
}

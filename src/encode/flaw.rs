//! What can be wrong with a frame's file.

use std::fmt;

/// What is wrong with a frame's file.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Flaw {
    Missing,
    /// It is not a complete picture, or its bytes have changed since it was written; with the reason.
    Damaged(String),
    /// The sequence, its settings or Kinora's version has changed since it was written.
    Stale,
    /// It holds no digest of its pixels, because an earlier version wrote it.
    NoDigest,
    /// It has no metadata, although frames of this job have some.
    NoMetadata,
    /// It differs in a property that frames of one run share, from most other frames or from the job; with the
    /// difference.
    Inconsistent(String),
}

impl fmt::Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Missing => f.write_str("missing"),
            Self::Damaged(why) => write!(f, "damaged: {why}"),
            Self::Stale => {
                f.write_str("stale: the sequence, its settings or the version of Kinora has changed")
            }
            Self::NoDigest => {
                f.write_str("without a digest of their pixels, as earlier versions of Kinora wrote them")
            }
            Self::NoMetadata => f.write_str("without metadata, as --no-metadata writes them"),
            Self::Inconsistent(what) => f.write_str(what),
        }
    }
}

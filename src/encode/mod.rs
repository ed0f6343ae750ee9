//! Film → files.

//! Where the measurements of a report come from.

/// The command, the machine and the file of the measurements.
#[derive(Clone, Debug)]
pub struct Origin {
    /// The command line.
    pub command: String,
    pub machine: String,
    /// The sequence file, quoted for commands to paste.
    pub file: String,
}

//! Reading a lease's file: who holds the lease, and whether it has expired.

use crate::base::digest::Digest;
use crate::base::process::Process;
use crate::encode::disk::{Operation, attempt};
use crate::encode::output::Output;
use crate::encode::place::folder_of;
use crate::encode::temporary::{self, PREFIX};
use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

/// A lease expires when its file was not touched for this long: twelve heartbeats. That is longer than network file
/// systems cache a file's attributes, and longer than a machine is usually suspended.
pub const EXPIRY: Duration = Duration::from_secs(120);

/// How the name of every lease begins, after the prefix of temporary files.
const LEASE_PREFIX: &str = "claim-";

/// Who holds a lease, and for how long its file was not touched.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeaseHolder {
    /// `None` if the file names no process.
    pub process: Option<Process>,
    pub idle: Duration,
    /// The whole text of the file.
    pub(super) text: String,
}

impl LeaseHolder {
    /// An unknown process.
    pub fn unknown(idle: Duration) -> Self {
        Self { process: None, idle, text: String::new() }
    }

    /// Whether the lease has expired or its process has ended, so that another process may take it.
    pub fn is_gone(&self) -> bool {
        self.idle >= EXPIRY || self.process.as_ref().is_some_and(Process::has_ended)
    }
}

/// The file of the lease for the frames of a film, in the folder of an output.
pub fn path_of(output: &Output, film: Digest) -> PathBuf {
    // The name must be the same on all machines, wherever they mount the folder.
    let frame = output.path(0);
    let name = frame.file_name().unwrap_or_default().as_encoded_bytes();
    let what = Digest::of(&(film, name));
    frame.with_file_name(format!("{PREFIX}{LEASE_PREFIX}{what}"))
}

/// Whether a file name is that of a lease.
#[cfg(any(unix, test))]
pub fn is_lease(name: &str) -> bool {
    name.strip_prefix(PREFIX).is_some_and(|rest| rest.starts_with(LEASE_PREFIX))
}

/// Reads who holds a lease. `None` if the file does not exist.
pub fn holder(lease: &Path) -> io::Result<Option<LeaseHolder>> {
    let found = attempt(Operation::Read, lease, || {
        // Opening the file first makes network file systems refresh its attributes.
        let mut file = File::open(lease)?;
        let mut text = String::new();
        file.read_to_string(&mut text)?;
        Ok((file.metadata()?.modified()?, text))
    });
    let (touched, text) = match found {
        Ok(found) => found,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        // A file that is not UTF-8 names no process.
        Err(error) if error.kind() == ErrorKind::InvalidData => {
            (fs::metadata(lease)?.modified()?, String::new())
        }
        Err(error) => return Err(error),
    };
    // In a read-only folder, the clock of this machine has to do.
    let now = file_system_time(folder_of(lease)).unwrap_or_else(|_| SystemTime::now());
    let idle = now.duration_since(touched).unwrap_or_default();
    let process = text.lines().next().and_then(|line| line.parse().ok());
    Ok(Some(LeaseHolder { process, idle, text }))
}

/// The current time by the clock of a folder's file system.
fn file_system_time(folder: &Path) -> io::Result<SystemTime> {
    let probe = || temporary::builder().tempfile_in(folder)?.as_file().metadata()?.modified();
    attempt(Operation::Create, folder, probe)
}

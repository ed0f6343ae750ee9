//! Jobs for openjd.

use super::job::{Export, Job};

pub fn export(job: &Job) -> Export {
    Export { files: Vec::new(), submit: job.beside("") }
}

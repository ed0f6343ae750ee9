//! What an EXR file says about itself: its identity, and a digest of its samples, as the format has no sums of its own.

use crate::digest::{Digest, Digester};
use crate::encode::job::Job;
use crate::files;
use crate::film::Film;
use exr::meta::MetaData;
use exr::meta::attribute::{AttributeValue, Text};
use exr::prelude::{AnyChannel, FlatSamples, ReadChannels, ReadLayers, f16, read};
use std::io::Cursor;
use std::path::Path;

/// The attribute's name.
pub const SEAL: &str = "kinora:identity";

/// Bytes of a file's header at most, and of what stands between its blocks.
const BESIDES: u64 = 1 << 22;

pub fn seal(identity: Digest, samples: Digest) -> AttributeValue {
    AttributeValue::Text(Text::from(format!("{identity} {samples}").as_str()))
}

/// The digest of a film's radiance as [`digest_of`] finds it in the file: pixel by pixel, A, B, G and R.
pub fn plain_digest(film: &Film, half: bool) -> Digest {
    let mut digester = Digester::new();
    for pixel in 0..film.width as usize * film.height as usize {
        let [r, g, b] = film.radiance_at(pixel).to_array();
        let alpha = film.extras.coverage.then(|| film.alpha_at(pixel));
        for value in alpha.into_iter().chain([b, g, r]) {
            match half {
                true => digester.bytes(&f16::from_f32(value).to_bits().to_le_bytes()),
                false => digester.bytes(&value.to_bits().to_le_bytes()),
            }
        }
    }
    digester.finish()
}

/// The digest of all samples, pixel by pixel in the order of the channels.
pub fn digest_of(channels: &[AnyChannel<FlatSamples>]) -> Digest {
    let mut digester = Digester::new();
    let pixels = channels.iter().map(|channel| channel.sample_data.len()).min().unwrap_or(0);
    for pixel in 0..pixels {
        for channel in channels {
            match &channel.sample_data {
                FlatSamples::F16(values) => digester.bytes(&values[pixel].to_bits().to_le_bytes()),
                FlatSamples::F32(values) => digester.bytes(&values[pixel].to_bits().to_le_bytes()),
                FlatSamples::U32(values) => digester.bytes(&values[pixel].to_le_bytes()),
            }
        }
    }
    digester.finish()
}

/// Whether a file has this identity, and all samples that it was written with.
pub fn holds(path: &Path, identity: Digest, job: &Job) -> bool {
    // Layers take what they take; a picture without compression takes less than this of each.
    let layers = job.about.layers.len() as u64 + 4;
    let most = u64::from(job.size.0) * u64::from(job.size.1) * 16 * layers + BESIDES;
    files::read(path, most).is_ok_and(|bytes| is_whole(&bytes, identity, job))
}

fn is_whole(bytes: &[u8], identity: Digest, job: &Job) -> bool {
    let Ok(meta) = MetaData::read_from_buffered(Cursor::new(bytes), true) else { return false };
    let [header] = &*meta.headers else { return false };
    let Some(AttributeValue::Text(text)) = header.shared_attributes.other.get(&Text::from(SEAL)) else {
        return false;
    };
    let text = text.to_string();
    let Some(samples) = text.strip_prefix(&format!("{identity} ")) else { return false };
    let size = (header.layer_size.width(), header.layer_size.height());
    if size != (job.size.0 as usize, job.size.1 as usize) {
        return false;
    }
    let reader = read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer();
    let image = reader.all_attributes().non_parallel().pedantic().from_buffered(Cursor::new(bytes));
    image.is_ok_and(|image| digest_of(&image.layer_data.channel_data.list).to_string() == samples)
}

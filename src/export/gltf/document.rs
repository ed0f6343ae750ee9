//! The JSON of a glTF file and its one buffer.

use super::ExportError;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;

/// Parts of a glTF file, which refer to each other by index.
#[derive(Default)]
pub struct Document {
    lists: Map<String, Value>,
    data: Vec<u8>,
    extensions: BTreeSet<&'static str>,
    lights: Vec<Value>,
    channels: Vec<Value>,
    samplers: Vec<Value>,
}

/// What the numbers of a buffer view are for (OpenGL's names of buffers).
#[derive(Clone, Copy)]
pub enum ViewTarget {
    Vertices = 34962,
    Indices = 34963,
}

/// The first bytes of binary files, and the kinds of their chunks.
const MAGIC: u32 = 0x4654_6C67;
const JSON_CHUNK: u32 = 0x4E4F_534A;
const BINARY_CHUNK: u32 = 0x004E_4942;

impl Document {
    /// Adds an entry to a list at the top level. Returns its index.
    pub fn push(&mut self, list: &str, entry: Value) -> usize {
        let list = self.lists.entry(list).or_insert_with(|| json!([]));
        let Value::Array(entries) = list else { return 0 };
        entries.push(entry);
        entries.len() - 1
    }

    /// The entry of a list at the top level.
    pub fn entry(&mut self, list: &str, index: usize) -> Option<&mut Value> {
        self.lists.get_mut(list)?.get_mut(index)
    }

    /// The number of entries of a list at the top level.
    pub fn count(&self, list: &str) -> usize {
        self.lists.get(list).and_then(Value::as_array).map_or(0, Vec::len)
    }

    /// Notes that the file uses an extension.
    pub fn uses(&mut self, extension: &'static str) -> &'static str {
        self.extensions.insert(extension);
        extension
    }

    /// Adds a light of `KHR_lights_punctual`. Returns its index.
    pub fn push_light(&mut self, light: Value) -> usize {
        self.lights.push(light);
        self.lights.len() - 1
    }

    /// Adds bytes, aligned as every accessor needs. Returns the index of their view.
    pub fn view(&mut self, bytes: &[u8], target: Option<ViewTarget>) -> usize {
        self.data.resize(self.data.len().next_multiple_of(4), 0);
        let mut view = json!({ "buffer": 0, "byteOffset": self.data.len(), "byteLength": bytes.len() });
        if let Some(target) = target {
            view["target"] = json!(target as u32);
        }
        self.data.extend_from_slice(bytes);
        self.push("bufferViews", view)
    }

    /// Adds rows of floats. Returns the index of their accessor, which states the least and the largest numbers if
    /// `bounded`.
    pub fn floats<const N: usize>(
        &mut self,
        rows: impl Iterator<Item = [f64; N]>,
        target: Option<ViewTarget>,
        bounded: bool,
    ) -> usize {
        let rows: Vec<[f32; N]> = rows.map(|row| row.map(|number| number as f32)).collect();
        let bytes: Vec<u8> = rows.iter().flatten().flat_map(|number| number.to_le_bytes()).collect();
        let view = self.view(&bytes, target);
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][N.clamp(1, 4) - 1];
        let mut accessor =
            json!({ "bufferView": view, "componentType": 5126, "count": rows.len(), "type": kind });
        if bounded {
            let bound = |pick: fn(f32, f32) -> f32| {
                (0..N)
                    .map(|at| rows.iter().map(|row| row[at]).reduce(pick).unwrap_or(0.0))
                    .collect::<Vec<_>>()
            };
            accessor["min"] = json!(bound(|a, b| if b < a { b } else { a }));
            accessor["max"] = json!(bound(|a, b| if b > a { b } else { a }));
        }
        self.push("accessors", accessor)
    }

    /// Adds the indices of triangles, with 16 bits if the number of vertices allows it.
    pub fn indices(&mut self, triangles: &[[u32; 3]], vertices: usize) -> usize {
        let all = triangles.iter().flatten();
        // The largest number of either size restarts strips.
        let (bytes, component): (Vec<u8>, u32) = match vertices < usize::from(u16::MAX) {
            true => (all.flat_map(|index| (*index as u16).to_le_bytes()).collect(), 5123),
            false => (all.flat_map(|index| index.to_le_bytes()).collect(), 5125),
        };
        let view = self.view(&bytes, Some(ViewTarget::Indices));
        let count = triangles.len() * 3;
        self.push(
            "accessors",
            json!({ "bufferView": view, "componentType": component, "count": count, "type": "SCALAR" }),
        )
    }

    /// Adds a channel of the animation, with its sampler.
    pub fn animate(&mut self, target: Value, sampler: Value) {
        self.channels.push(json!({ "sampler": self.samplers.len(), "target": target }));
        self.samplers.push(sampler);
    }

    /// Adds a channel to the property at a JSON pointer.
    pub fn animate_pointer(&mut self, pointer: &str, sampler: Value) {
        let name = self.uses("KHR_animation_pointer");
        self.animate(json!({ "path": "pointer", "extensions": { name: { "pointer": pointer } } }), sampler);
    }

    /// The number of lights.
    pub fn light_count(&self) -> usize {
        self.lights.len()
    }

    /// The number of channels of the animation.
    pub fn channel_count(&self) -> usize {
        self.channels.len()
    }

    /// The whole JSON, with the buffer's address if it has one. `name` is that of the animation.
    fn json(&mut self, name: &str, roots: &[usize], uri: Option<String>) -> Value {
        let generator = concat!("Kinora ", env!("CARGO_PKG_VERSION"));
        let mut root = Map::new();
        root.insert("asset".into(), json!({ "version": "2.0", "generator": generator }));
        if !self.lights.is_empty() {
            let key = self.uses("KHR_lights_punctual");
            root.insert("extensions".into(), json!({ key: { "lights": std::mem::take(&mut self.lights) } }));
        }
        if !self.extensions.is_empty() {
            root.insert("extensionsUsed".into(), json!(self.extensions));
        }
        root.insert("scene".into(), json!(0));
        // Lists must not be empty.
        root.insert(
            "scenes".into(),
            if roots.is_empty() { json!([{}]) } else { json!([{ "nodes": roots }]) },
        );
        root.append(&mut self.lists);
        if !self.channels.is_empty() {
            let (channels, samplers) =
                (std::mem::take(&mut self.channels), std::mem::take(&mut self.samplers));
            let animation = json!({ "name": name, "channels": channels, "samplers": samplers });
            root.insert("animations".into(), json!([animation]));
        }
        if !self.data.is_empty() {
            let mut buffer = json!({ "byteLength": self.data.len() });
            if let Some(uri) = uri {
                buffer["uri"] = json!(uri);
            }
            root.insert("buffers".into(), json!([buffer]));
        }
        Value::Object(root)
    }

    /// The file as text, with the buffer as a data URI.
    pub fn text(mut self, name: &str, roots: &[usize]) -> Vec<u8> {
        self.data.resize(self.data.len().next_multiple_of(4), 0);
        let uri = format!("data:application/octet-stream;base64,{}", STANDARD.encode(&self.data));
        format!("{:#}\n", self.json(name, roots, Some(uri))).into_bytes()
    }

    /// The file in its binary form (glTF 2.0, section 4).
    ///
    /// # Errors
    /// If it has 4 GiB or more.
    pub fn binary(mut self, name: &str, roots: &[usize]) -> Result<Vec<u8>, ExportError> {
        self.data.resize(self.data.len().next_multiple_of(4), 0);
        let mut json = self.json(name, roots, None).to_string().into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut chunks = vec![(JSON_CHUNK, &json)];
        if !self.data.is_empty() {
            chunks.push((BINARY_CHUNK, &self.data));
        }
        let length = 12 + chunks.iter().map(|(_, bytes)| 8 + bytes.len()).sum::<usize>();
        let whole = u32::try_from(length).map_err(|_| ExportError::TooLarge(length as u64))?;
        let mut bytes = Vec::with_capacity(length);
        [MAGIC, 2, whole].iter().for_each(|word| bytes.extend_from_slice(&word.to_le_bytes()));
        for (kind, chunk) in chunks {
            bytes.extend_from_slice(&(chunk.len() as u32).to_le_bytes());
            bytes.extend_from_slice(&kind.to_le_bytes());
            bytes.extend_from_slice(chunk);
        }
        Ok(bytes)
    }
}

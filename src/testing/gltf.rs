//! Small glTF files that tests write.

use serde_json::{Value, json};

/// A file being written: its JSON part, and the bytes of its first buffer.
pub struct GltfFixture {
    pub json: Value,
    pub data: Vec<u8>,
}

impl Default for GltfFixture {
    fn default() -> Self {
        let json = json!({ "asset": { "version": "2.0" }, "bufferViews": [], "accessors": [] });
        Self { json, data: Vec::new() }
    }
}

impl GltfFixture {
    /// A file with these members besides its accessors.
    pub fn with(members: Value) -> Self {
        let mut file = Self::default();
        file.set(members);
        file
    }

    /// Sets members of the root.
    pub fn set(&mut self, members: Value) {
        let members = members.as_object().expect("members").clone();
        self.json.as_object_mut().expect("an object").extend(members);
    }

    /// Adds an entry to a list of the root, and returns its index.
    pub fn push(&mut self, list: &str, entry: Value) -> usize {
        let list = &mut self.json[list];
        if list.is_null() {
            *list = json!([]);
        }
        let list = list.as_array_mut().expect("a list");
        list.push(entry);
        list.len() - 1
    }

    /// Adds bytes as a view, aligned to four bytes.
    pub fn view(&mut self, bytes: &[u8]) -> usize {
        self.data.resize(self.data.len().next_multiple_of(4), 0);
        let offset = self.data.len();
        self.data.extend(bytes);
        self.push("bufferViews", json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() }))
    }

    /// Adds an accessor of a component type and a kind.
    pub fn accessor(&mut self, bytes: &[u8], component: u32, kind: &str, count: usize) -> usize {
        let view = self.view(bytes);
        let accessor =
            json!({ "bufferView": view, "componentType": component, "type": kind, "count": count });
        self.push("accessors", accessor)
    }

    /// Adds floats of a kind with `width` components.
    pub fn floats(&mut self, kind: &str, width: usize, values: &[f32]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        self.accessor(&bytes, 5126, kind, values.len() / width)
    }

    pub fn indices(&mut self, values: &[u16]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        self.accessor(&bytes, 5123, "SCALAR", values.len())
    }

    /// Adds a mesh of one triangle with these corners, and returns its index.
    pub fn triangle(&mut self, corners: [[f32; 3]; 3]) -> usize {
        let positions = self.floats("VEC3", 3, corners.as_flattened());
        self.push("meshes", json!({ "primitives": [{ "attributes": { "POSITION": positions } }] }))
    }

    fn buffers(&mut self, uri: Option<String>) {
        let mut buffer = json!({ "byteLength": self.data.len() });
        if let Some(uri) = uri {
            buffer["uri"] = uri.into();
        }
        if !self.data.is_empty() {
            self.json["buffers"] = json!([buffer]);
        }
    }

    /// The bytes of a binary file.
    pub fn glb(mut self) -> Vec<u8> {
        self.buffers(None);
        let mut text = self.json.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        self.data.resize(self.data.len().next_multiple_of(4), 0);
        let total = 12 + 8 + text.len() + 8 + self.data.len();
        let mut file = b"glTF".to_vec();
        for word in [2, total as u32, text.len() as u32] {
            file.extend(word.to_le_bytes());
        }
        file.extend(b"JSON");
        file.extend(text);
        file.extend((self.data.len() as u32).to_le_bytes());
        file.extend(b"BIN\0");
        file.extend(self.data);
        file
    }

    /// The text of a file whose buffer is a data URI.
    pub fn text(mut self) -> String {
        use base64::Engine;
        let data = base64::engine::general_purpose::STANDARD.encode(&self.data);
        self.buffers(Some(format!("data:application/octet-stream;base64,{data}")));
        self.json.to_string()
    }
}

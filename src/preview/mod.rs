//! A live preview: shows a sequence in a browser while its file is edited.
//!
//! In: a sequence file and its changes, commands from a page.
//! Out: pictures that become finer, the state of the session, and, if asked, edits of the file and renders.
//! Uses: `pipeline` and the rooms above.
//!
//! ```text
//! files ──watch──▶ ┐                          ┌──▶ server ──▶ page
//! page ──command──▶ engine ──▶ session ──▶ update
//!                     ▲            │
//!                     └─ plan, forecast, render: on threads of their own
//! ```
//!
//! A session is independent of threads and of HTTP. It finds films by the scene hash of the plan, so whatever leaves
//! the scene hash unchanged shows at once: a light's colour, a comment, a frame that was seen before.

mod camera;
mod command;
mod curves;
mod edit;
mod engine;
mod film_cache;
mod forecast;
mod heat;
mod light_isolation;
mod overrides;
mod pick;
mod picture;
mod places;
mod planned;
mod playback;
mod render_task;
mod scene_in_use;
mod server;
mod session;
#[cfg(test)]
mod session_tests;
mod stages;
mod state;
mod token;
mod value_place;
mod watch;
mod write_back;

pub use engine::{Engine, EngineHandle, Update};
pub use server::{Address, Server, channel};
pub use session::{Session, SessionOptions};
pub use stages::snapshot;
pub use watch::Watcher;

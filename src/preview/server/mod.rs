//! The server of the page: on the loopback address only, for those who know the token.
//!
//! In: requests of the page, updates of the engine.
//! Out: the page, pictures with states, answers to commands.
//!
//! Each request is short: the page asks for the next picture and waits, so a slow page misses pictures instead of
//! queueing them.

mod connections;
mod gate;
mod patient;
mod respond;

use super::engine::{EngineHandle, Update};
use super::token;
use connections::Connections;
use gate::Gate;
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper_util::rt::{TokioIo, TokioTimer};
use patient::Patient;
use respond::Responder;
use std::io;
use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::thread;
use std::time::Duration;
use tokio::sync::watch;

/// Most bytes and lines of a request before its body.
const MOST_HEAD: usize = 16 << 10;
const MOST_HEADERS: usize = 64;

/// The time for the head of a request, and for each piece of an answer.
const HEAD_TIME: Duration = Duration::from_secs(10);

/// The longest life of a connection. Pages open new ones.
const MOST_LIFE: Duration = Duration::from_secs(600);

/// A server that listens.
pub struct Server {
    listener: TcpListener,
    token: String,
}

/// Where the page is.
#[derive(Clone, Debug)]
pub struct Address {
    pub port: u16,
    token: String,
}

impl Address {
    /// The address for a browser.
    pub fn url(&self) -> String {
        format!("http://127.0.0.1:{}/{}/", self.port, self.token)
    }
}

impl Server {
    /// Binds the loopback address; port 0 is any free one.
    pub fn bind(port: u16) -> io::Result<(Self, Address)> {
        let listener = TcpListener::bind(SocketAddr::from((Ipv4Addr::LOCALHOST, port)))?;
        listener.set_nonblocking(true)?;
        let (port, token) = (listener.local_addr()?.port(), token::random()?);
        Ok((Self { listener, token: token.clone() }, Address { port, token }))
    }

    /// Serves on a thread of its own, as long as the process lives.
    pub fn start(
        self,
        engine: EngineHandle,
        updates: watch::Receiver<Option<Arc<Update>>>,
    ) -> io::Result<()> {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_io().enable_time().build()?;
        let responder = Arc::new(Responder::new(Gate::new(self.token), engine, updates));
        let serve = move || runtime.block_on(serve(self.listener, responder));
        thread::Builder::new().name("server".to_owned()).spawn(serve)?;
        Ok(())
    }
}

/// Accepts connections for ever.
async fn serve(listener: TcpListener, responder: Arc<Responder>) {
    let Ok(listener) = tokio::net::TcpListener::from_std(listener) else { return };
    let mut connections = Connections::default();
    loop {
        let Ok((stream, _)) = listener.accept().await else {
            // Out of files, for example. It may pass.
            tokio::time::sleep(Duration::from_millis(50)).await;
            continue;
        };
        // The limit is reached, and all open connections have the token.
        if !connections.make_room() {
            continue;
        }
        let (responder, is_authorized) = (Arc::clone(&responder), Arc::new(AtomicBool::new(false)));
        let authorized = Arc::clone(&is_authorized);
        let task = tokio::spawn(async move {
            let _ = stream.set_nodelay(true);
            let service = service_fn(move |request| {
                let (responder, is_authorized) = (Arc::clone(&responder), Arc::clone(&is_authorized));
                async move { Ok::<_, std::convert::Infallible>(responder.answer(request, &is_authorized).await) }
            });
            let connection = http1::Builder::new()
                .timer(TokioTimer::new())
                .header_read_timeout(HEAD_TIME)
                .max_buf_size(MOST_HEAD)
                .max_headers(MOST_HEADERS)
                .serve_connection(TokioIo::new(Patient::new(stream, HEAD_TIME)), service);
            // Clients that go away are no error.
            let _ = tokio::time::timeout(MOST_LIFE, connection).await;
        });
        connections.add(task.abort_handle(), authorized);
    }
}

/// A pair that passes the latest update from the engine to the server.
pub fn channel() -> (super::engine::Publish, watch::Receiver<Option<Arc<Update>>>) {
    let (sender, receiver) = watch::channel(None);
    let publish = Box::new(move |update: Update| {
        sender.send_replace(Some(Arc::new(update)));
    });
    (publish, receiver)
}

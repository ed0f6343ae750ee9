//! Answers of the server.

use super::gate::Gate;
use crate::preview::command::Command;
use crate::preview::engine::{EngineHandle, Update};
use crate::preview::token;
use http_body_util::{BodyExt, Full, Limited};
use hyper::body::{Bytes, Incoming};
use hyper::header::{self, HeaderName, HeaderValue};
use hyper::{Method, Request, Response, StatusCode};
use serde_json::{Value, json};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use tokio::sync::{oneshot, watch};
use tokio::time::timeout;

/// The page, its style and its program.
const PAGE: &str = include_str!("../page/page.html");
const STYLE: &str = include_str!("../page/page.css");
const PROGRAM: &str = include_str!("../page/page.js");

/// Most bytes of a command, and the time for them.
const MOST_BODY: usize = 16 << 10;
const BODY_TIME: Duration = Duration::from_secs(5);

/// The longest wait for the next picture, and for an answer to a command.
const NEXT_TIME: Duration = Duration::from_secs(20);
const ANSWER_TIME: Duration = Duration::from_secs(30);

/// Longest name of a page.
const LONGEST_PAGE: usize = 64;

type Answer = Response<Full<Bytes>>;

/// Answers requests.
pub struct Responder {
    gate: Gate,
    engine: EngineHandle,
    updates: watch::Receiver<Option<Arc<Update>>>,
    /// The page that holds the session: the last one that was opened.
    owner: Mutex<String>,
}

impl Responder {
    pub fn new(gate: Gate, engine: EngineHandle, updates: watch::Receiver<Option<Arc<Update>>>) -> Self {
        Self { gate, engine, updates, owner: Mutex::default() }
    }

    /// The answer to a request. Sets `is_authorized` if it shows the token.
    pub async fn answer(&self, request: Request<Incoming>, is_authorized: &AtomicBool) -> Answer {
        let uri = request.uri().clone();
        let Some(rest) = self.gate.admitted(uri.path(), request.headers()) else {
            return plain(StatusCode::NOT_FOUND, "there is nothing here\n");
        };
        is_authorized.store(true, Relaxed);
        let query = uri.query().unwrap_or_default();
        match (request.method(), rest) {
            (&Method::GET, "") => with_type("text/html; charset=utf-8", PAGE),
            (&Method::GET, "page.css") => with_type("text/css; charset=utf-8", STYLE),
            (&Method::GET, "page.js") => with_type("text/javascript; charset=utf-8", PROGRAM),
            (&Method::POST, "own") => self.own(query),
            (&Method::GET, "next") if self.is_owner(query) => self.next(query).await,
            (&Method::POST, "do") if self.is_owner(query) => self.command(request.into_body()).await,
            (&Method::GET, "next") | (&Method::POST, "do") => {
                plain(StatusCode::CONFLICT, "another page shows this preview\n")
            }
            (_, "" | "page.css" | "page.js" | "own" | "next" | "do") => {
                plain(StatusCode::METHOD_NOT_ALLOWED, "not like this\n")
            }
            _ => plain(StatusCode::NOT_FOUND, "there is nothing here\n"),
        }
    }

    /// Gives the session to a page.
    fn own(&self, query: &str) -> Answer {
        let page = value_of(query, "page").filter(|page| !page.is_empty() && page.len() <= LONGEST_PAGE);
        let Some(page) = page else { return plain(StatusCode::BAD_REQUEST, "`page` is missing\n") };
        *self.owner.lock().unwrap_or_else(PoisonError::into_inner) = page.to_owned();
        with_json(&json!({}))
    }

    fn is_owner(&self, query: &str) -> bool {
        let owner = self.owner.lock().unwrap_or_else(PoisonError::into_inner);
        !owner.is_empty() && value_of(query, "page").is_some_and(|page| token::is_same(page, &owner))
    }

    /// The update after number `after`, once there is one: the length of the state in four bytes, the state as JSON, and
    /// the picture as PNG.
    async fn next(&self, query: &str) -> Answer {
        let after = value_of(query, "after").and_then(|number| number.parse::<u64>().ok()).unwrap_or(0);
        let mut updates = self.updates.clone();
        let newer = updates.wait_for(|update| update.as_ref().is_some_and(|update| update.number > after));
        let update = match timeout(NEXT_TIME, newer).await {
            Ok(Ok(update)) => update.clone(),
            // Nothing new: the page asks again.
            Err(_) => return with_status(StatusCode::NO_CONTENT, "text/plain", Bytes::new()),
            Ok(Err(_)) => return plain(StatusCode::GONE, "the preview has ended\n"),
        };
        let Some(update) = update else {
            return with_status(StatusCode::NO_CONTENT, "text/plain", Bytes::new());
        };
        if !self.is_owner(query) {
            return plain(StatusCode::CONFLICT, "another page shows this preview\n");
        }
        let picture = update.picture.as_deref().map_or(&[][..], Vec::as_slice);
        let mut body = Vec::with_capacity(4 + update.state.len() + picture.len());
        body.extend((update.state.len() as u32).to_le_bytes());
        body.extend(update.state.as_bytes());
        body.extend(picture);
        with_status(StatusCode::OK, "application/octet-stream", Bytes::from(body))
    }

    async fn command(&self, body: Incoming) -> Answer {
        let body = match timeout(BODY_TIME, Limited::new(body, MOST_BODY).collect()).await {
            Ok(Ok(body)) => body.to_bytes(),
            Ok(Err(_)) => return plain(StatusCode::PAYLOAD_TOO_LARGE, "a command is short\n"),
            Err(_) => return plain(StatusCode::REQUEST_TIMEOUT, "the command did not arrive\n"),
        };
        let command = match Command::parse(&body) {
            Ok(command) => command,
            Err(error) => {
                return with_status(StatusCode::BAD_REQUEST, "text/plain; charset=utf-8", error.into());
            }
        };
        let (sender, receiver) = oneshot::channel();
        self.engine.command(command, move |answer: Value| {
            // The page may be gone.
            let _ = sender.send(answer);
        });
        match timeout(ANSWER_TIME, receiver).await {
            Ok(Ok(answer)) => with_json(&answer),
            _ => plain(StatusCode::SERVICE_UNAVAILABLE, "no answer in time\n"),
        }
    }
}

/// The value of a name in a query. Names and values of the page need no escapes.
fn value_of<'q>(query: &'q str, name: &str) -> Option<&'q str> {
    query
        .split('&')
        .find_map(|part| part.split_once('=').filter(|(key, _)| *key == name).map(|(_, value)| value))
}

fn plain(status: StatusCode, text: &'static str) -> Answer {
    with_status(status, "text/plain; charset=utf-8", Bytes::from_static(text.as_bytes()))
}

fn with_type(kind: &'static str, text: &'static str) -> Answer {
    with_status(StatusCode::OK, kind, Bytes::from_static(text.as_bytes()))
}

fn with_json(value: &Value) -> Answer {
    with_status(StatusCode::OK, "application/json", Bytes::from(value.to_string()))
}

/// What browsers must not do with an answer: guess its type, keep it, show it inside of other pages, tell others its
/// address, or load anything from elsewhere.
const RULES: [(HeaderName, &str); 7] = [
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::CACHE_CONTROL, "no-store"),
    (header::X_FRAME_OPTIONS, "DENY"),
    (header::REFERRER_POLICY, "no-referrer"),
    (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
    (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
    (
        header::CONTENT_SECURITY_POLICY,
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src 'self'; \
         base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    ),
];

fn with_status(status: StatusCode, kind: &'static str, body: Bytes) -> Answer {
    let mut answer = Response::new(Full::new(body));
    *answer.status_mut() = status;
    let headers = answer.headers_mut();
    headers.insert(header::CONTENT_TYPE, HeaderValue::from_static(kind));
    for (name, value) in RULES {
        headers.insert(name, HeaderValue::from_static(value));
    }
    answer
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn queries_have_values() {
        assert_eq!(value_of("page=a&after=3", "after"), Some("3"));
        assert_eq!(value_of("page=a&after=3", "page"), Some("a"));
        assert_eq!(
            (value_of("", "page"), value_of("page", "page"), value_of("xpage=1", "page")),
            (None, None, None)
        );
    }
}

//! Who may enter: requests for this machine's own name, from the page itself, with the token.

use crate::preview::token;
use hyper::header::{HOST, HeaderMap, HeaderName, ORIGIN};

/// Names of this machine in addresses of the page. Through a tunnel (`ssh -L`) the port may be another one, so any port
/// counts. A page of another site that is led here by its own name (DNS rebinding) sends that name.
const NAMES: [&str; 3] = ["127.0.0.1", "localhost", "[::1]"];

/// Browsers say where a request comes from.
const FETCH_SITE: HeaderName = HeaderName::from_static("sec-fetch-site");

/// Checks requests.
pub struct Gate {
    token: String,
}

impl Gate {
    pub fn new(token: String) -> Self {
        Self { token }
    }

    /// The part of the path behind the token, if the request may enter. Everything else looks as if there was nothing.
    pub fn admitted<'r>(&self, path: &'r str, headers: &HeaderMap) -> Option<&'r str> {
        let (token, rest) = path.strip_prefix('/')?.split_once('/')?;
        let mut hosts = headers.get_all(HOST).iter();
        let host = hosts.next()?.to_str().ok()?;
        let is_only = hosts.next().is_none();
        (is_only && is_here(host) && self.is_own(headers, host) && token::is_same(token, &self.token))
            .then_some(rest)
    }

    /// Whether a request comes from the page, or from the address bar.
    fn is_own(&self, headers: &HeaderMap, host: &str) -> bool {
        let origins_fit = headers.get_all(ORIGIN).iter().all(|origin| {
            origin.to_str().ok().and_then(|origin| origin.strip_prefix("http://")) == Some(host)
        });
        let sites_fit = headers
            .get_all(FETCH_SITE)
            .iter()
            .all(|site| matches!(site.as_bytes(), b"same-origin" | b"none"));
        origins_fit && sites_fit
    }
}

/// Whether an authority is this machine, with any port.
fn is_here(host: &str) -> bool {
    NAMES.iter().any(|name| match host.strip_prefix(name) {
        Some("") => true,
        Some(port) => {
            port.strip_prefix(':').is_some_and(|port| !port.is_empty() && port.parse::<u16>().is_ok())
        }
        None => false,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use hyper::header::HeaderValue;

    fn admitted(path: &str, headers: &[(&'static str, &str)]) -> Option<String> {
        let mut map = HeaderMap::new();
        for (name, value) in headers {
            map.append(HeaderName::from_static(name), HeaderValue::from_str(value).expect("a value"));
        }
        Gate::new("secret".to_owned()).admitted(path, &map).map(str::to_owned)
    }

    #[test]
    fn the_page_and_the_address_bar_may_enter() {
        let here = ("host", "127.0.0.1:8000");
        assert_eq!(admitted("/secret/", &[here]).as_deref(), Some(""));
        assert_eq!(admitted("/secret/next", &[("host", "localhost:9")]).as_deref(), Some("next"));
        let own = [here, ("origin", "http://127.0.0.1:8000"), ("sec-fetch-site", "same-origin")];
        assert_eq!(admitted("/secret/do", &own).as_deref(), Some("do"));
    }

    #[test]
    fn all_others_may_not() {
        let here = ("host", "127.0.0.1:8000");
        for (path, headers) in [
            ("/secret/", &[][..]),
            ("/", &[here]),
            ("/secret", &[here]),
            ("/Secret/", &[here]),
            ("/secrets/", &[here]),
            ("//secret/", &[here]),
            ("/secret/", &[("host", "evil.example:8000")]),
            ("/secret/", &[("host", "127.0.0.1.evil.example")]),
            ("/secret/", &[("host", "127.0.0.1:80@evil.example")]),
            ("/secret/", &[("host", "localhost:")]),
            ("/secret/", &[here, ("host", "evil.example")]),
            ("/secret/do", &[here, ("origin", "http://evil.example")]),
            ("/secret/do", &[here, ("origin", "null")]),
            ("/secret/do", &[here, ("origin", "https://127.0.0.1:8000")]),
            ("/secret/do", &[here, ("origin", "http://127.0.0.1:9000")]),
            ("/secret/do", &[here, ("origin", "http://127.0.0.1:8000"), ("origin", "http://evil.example")]),
            ("/secret/", &[here, ("sec-fetch-site", "cross-site")]),
            ("/secret/", &[here, ("sec-fetch-site", "same-site")]),
        ] {
            assert_eq!(admitted(path, headers), None, "{path} {headers:?}");
        }
    }
}

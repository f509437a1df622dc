//! Access control: only pages of this server with the token of this start are answered.
//!
//! For every request, including WebSocket upgrades: the named host is an address of this machine (a
//! foreign site could point a name at it), a named origin is that of this server, and everything
//! except the page itself requires the token. Every answer carries the headers that isolate the
//! page.

use std::net::{IpAddr, SocketAddr};

use axum::extract::{Request, State};
use axum::http::header::{self, HeaderName};
use axum::http::{HeaderMap, HeaderValue, StatusCode};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use super::refusal::Refusal;

/// The values that a request is compared with.
#[derive(Clone, Debug)]
pub(super) struct Guard {
    pub(super) token: String,
    pub(super) bound: SocketAddr,
}

const POLICY: &str = "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self' blob:; \
    style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; font-src 'self' data:; object-src 'none'; \
    base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

const HEADERS: [(HeaderName, &str); 6] = [
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::X_FRAME_OPTIONS, "DENY"),
    // The address contains the token, so it must not be sent to other sites.
    (header::REFERRER_POLICY, "no-referrer"),
    (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
    (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
    (HeaderName::from_static("permissions-policy"), "camera=(), microphone=(), geolocation=()"),
];

/// Passes a request on, or refuses it.
pub(super) async fn guard(State(guard): State<Guard>, request: Request, next: Next) -> Response {
    let judged = guard.judge(&request);
    let mut response = match judged {
        Ok(()) => next.run(request).await,
        Err(refusal) => refusal.into_response(),
    };
    let headers = response.headers_mut();
    for (name, value) in HEADERS {
        headers.insert(name, HeaderValue::from_static(value));
    }
    if let Ok(policy) = HeaderValue::from_str(&guard.policy()) {
        headers.insert(header::CONTENT_SECURITY_POLICY, policy);
    }
    response
}

impl Guard {
    fn judge(&self, request: &Request) -> Result<(), Refusal> {
        let headers = request.headers();
        let host = only(headers, &header::HOST)?.ok_or_else(|| Refusal::bad("this request names no host"))?;
        if !self.is_ours(host) {
            return Err(Refusal::forbidden(format!(
                "this server answers at http://{}/ only, not under other names",
                self.bound
            )));
        }
        if let Some(origin) = only(headers, &header::ORIGIN)? {
            let own = origin.strip_prefix("http://").is_some_and(|o| o.eq_ignore_ascii_case(host));
            if !own {
                return Err(Refusal::forbidden("this request comes from another site: it is not answered"));
            }
        }
        let path = request.uri().path();
        if path != "/api" && !path.starts_with("/api/") {
            return Ok(());
        }
        let site = only(headers, &HeaderName::from_static("sec-fetch-site"))?;
        if site.is_some_and(|s| s != "same-origin" && s != "none") {
            return Err(Refusal::forbidden("this request comes from another site: it is not answered"));
        }
        if self.has_token(request)? {
            return Ok(());
        }
        Err(Refusal::new(
            StatusCode::UNAUTHORIZED,
            "this needs the whole address that `g7 serve` printed when it was started, with its token",
        ))
    }

    /// The token comes in a header, or in the address if the browser cannot set a header.
    fn has_token(&self, request: &Request) -> Result<bool, Refusal> {
        let header = only(request.headers(), &header::AUTHORIZATION)?;
        let given = header.and_then(|h| h.strip_prefix("Bearer "));
        if given.is_some_and(|g| same(g, &self.token)) {
            return Ok(true);
        }
        if request.uri().path() != "/api/live" {
            return Ok(false);
        }
        let mut pairs = request.uri().query().unwrap_or("").split('&');
        Ok(pairs.any(|p| p.strip_prefix("token=").is_some_and(|g| same(g, &self.token))))
    }

    /// True if a host names this server: by its address, or as `localhost`.
    fn is_ours(&self, host: &str) -> bool {
        let (name, port) = match host.rsplit_once(':') {
            Some((name, port)) if !port.contains(']') => (name, port.parse().ok()),
            _ => (host, Some(80)),
        };
        if port != Some(self.bound.port()) {
            return false;
        }
        let bound = self.bound.ip();
        if name.eq_ignore_ascii_case("localhost") {
            return bound.is_loopback() || bound.is_unspecified();
        }
        let bare = name.strip_prefix('[').and_then(|n| n.strip_suffix(']'));
        let address: Option<IpAddr> = match bare {
            Some(six) => six.parse().ok().filter(IpAddr::is_ipv6),
            None => name.parse().ok().filter(IpAddr::is_ipv4),
        };
        address
            .is_some_and(|a| a == bound || bound.is_unspecified() || (a.is_loopback() && bound.is_loopback()))
    }

    /// The content security policy. Older browsers do not count a WebSocket as the same origin, so
    /// it is named.
    fn policy(&self) -> String {
        let port = self.bound.port();
        let mut live = format!("'self' ws://localhost:{port} ws://127.0.0.1:{port}");
        if !self.bound.ip().is_unspecified() && !self.bound.ip().is_loopback() {
            live.push_str(&format!(" ws://{}", self.bound));
        }
        format!("{POLICY}; connect-src {live}")
    }
}

/// The value of a header that may occur at most once.
fn only<'a>(headers: &'a HeaderMap, name: &HeaderName) -> Result<Option<&'a str>, Refusal> {
    let mut all = headers.get_all(name).iter();
    let Some(first) = all.next() else { return Ok(None) };
    let text = first.to_str().ok().filter(|_| all.next().is_none());
    text.map(Some).ok_or_else(|| Refusal::forbidden(format!("the header `{name}` means nothing")))
}

/// Compares in constant time, so that the time does not reveal where the texts differ.
fn same(a: &str, b: &str) -> bool {
    a.len() == b.len() && a.bytes().zip(b.bytes()).fold(0, |d, (x, y)| d | (x ^ y)) == 0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(bound: &str) -> Guard {
        Guard { token: String::new(), bound: bound.parse().expect("an address") }
    }

    #[test]
    fn a_host_is_an_address_of_this_machine_and_no_other_name() {
        let local = at("127.0.0.1:4700");
        for host in ["127.0.0.1:4700", "localhost:4700", "LOCALHOST:4700", "[::1]:4700"] {
            assert!(local.is_ours(host), "{host}");
        }
        for host in [
            "127.0.0.1",
            "127.0.0.1:80",
            "evil.example:4700",
            "localhost.evil.example:4700",
            "10.0.0.1:4700",
            "",
            ":4700",
            "localhost:4700:4700",
            "[::1:4700",
            "::1:4700",
            "0x7f.1:4700",
        ] {
            assert!(!local.is_ours(host), "{host}");
        }
    }

    #[test]
    fn a_server_for_the_network_still_takes_no_names() {
        let wide = at("0.0.0.0:4700");
        assert!(wide.is_ours("192.168.1.7:4700") && wide.is_ours("localhost:4700"));
        assert!(!wide.is_ours("plant.example:4700"));
        let one = at("192.168.1.7:4700");
        assert!(one.is_ours("192.168.1.7:4700"));
        assert!(!one.is_ours("127.0.0.1:4700") && !one.is_ours("localhost:4700"));
    }
}

//! The web page: contained in the binary, or read from a folder during its development.
//!
//! Each file is there as gzip and as Brotli (`web/pack.mjs`), and is sent so: the page is there sooner
//! over a network, and the binary is smaller. A client that reads neither (a `curl`, not a browser) gets
//! the file as it was, unpacked from the gzip.

use std::borrow::Cow;
use std::convert::Infallible;
use std::io::Read as _;
use std::path::Path;
use std::pin::Pin;
use std::task::{Context, Poll};

use axum::body::{Body, Bytes, HttpBody};
use axum::extract::State;
use axum::http::{HeaderMap, HeaderValue, StatusCode, Uri, header};
use axum::response::{IntoResponse, Response};
use flate2::read::GzDecoder;
use hyper::body::{Frame, SizeHint};
use rust_embed::RustEmbed;

use super::encoding::{Encoding, accepted};
use super::fingerprint;
use super::shared::Shared;
use super::shelf::Shelf;

/// The built page; empty if the page was not built before the binary.
#[derive(RustEmbed)]
#[folder = "../../web/packed"]
#[allow_missing = true]
struct Built;

/// The answer to `/` if there is no page.
const NONE: &str = "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>G7</title>\
    <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
    <style>body{font:16px/1.5 system-ui,sans-serif;max-width:36em;margin:4em auto;padding:0 1em;\
    color-scheme:light dark}code{font-size:1.05em}</style>\
    <h1>The page is not in this binary</h1>\
    <p>This <code>g7</code> was built without the editor. In the folder of its sources:</p>\
    <p><code>make web</code> builds the page; then build <code>g7</code> again, \
    or <code>make run</code> does both.</p>";

/// Most bytes that are handed to a connection at once. It holds them until they are sent.
const PIECE: usize = 64 << 10;

/// The files that are being sent, once for all who read them.
static SENT: Shelf = Shelf::new();

/// A file, in pieces.
struct Pieces(Bytes);

impl HttpBody for Pieces {
    type Data = Bytes;
    type Error = Infallible;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        _: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, Infallible>>> {
        let length = self.0.len().min(PIECE);
        Poll::Ready((length > 0).then(|| Ok(Frame::data(self.0.split_to(length)))))
    }

    fn is_end_stream(&self) -> bool {
        self.0.is_empty()
    }

    fn size_hint(&self) -> SizeHint {
        SizeHint::with_exact(self.0.len() as u64)
    }
}

/// Answers with a file of the page.
pub(super) async fn asset(State(shared): State<Shared>, uri: Uri, headers: HeaderMap) -> Response {
    let path = match uri.path().trim_start_matches('/') {
        "" => "index.html",
        // The same page, which shows itself otherwise there.
        "operator" if shared.station.is_some() => "index.html",
        path => path,
    };
    let wanted = accepted(&headers);
    let found = wanted.iter().find_map(|encoding| match &shared.page {
        Some(folder) => on_disk(folder, path, *encoding).map(|bytes| (bytes, *encoding)),
        None => built(path, *encoding).map(|bytes| (bytes, *encoding)),
    });
    let Some((bytes, encoding)) = found else {
        if wanted.is_empty() {
            let no = "this address has a file as it is, as gzip and as br";
            return (StatusCode::NOT_ACCEPTABLE, [(header::VARY, "accept-encoding")], no).into_response();
        }
        if path == "index.html" {
            let html = [(header::CONTENT_TYPE, "text/html; charset=utf-8")];
            return (StatusCode::SERVICE_UNAVAILABLE, html, NONE).into_response();
        }
        return (StatusCode::NOT_FOUND, "there is nothing at this address").into_response();
    };
    let tag = format!("\"{}\"", fingerprint::hash(&bytes));
    // Names below `assets` change with their contents.
    let keep = if path.starts_with("assets/") { "public, max-age=31536000, immutable" } else { "no-cache" };
    let head = [
        (header::CONTENT_TYPE, kind(path).to_owned()),
        (header::CACHE_CONTROL, keep.to_owned()),
        (header::ETAG, tag.clone()),
        (header::VARY, header::ACCEPT_ENCODING.to_string()),
    ];
    if known(&headers, &tag) {
        return (StatusCode::NOT_MODIFIED, head).into_response();
    }
    let mut response = (head, Body::new(Pieces(bytes))).into_response();
    if encoding != Encoding::Identity {
        response.headers_mut().insert(header::CONTENT_ENCODING, HeaderValue::from_static(encoding.name()));
    }
    response
}

/// True if the client has this form of the file.
fn known(headers: &HeaderMap, tag: &str) -> bool {
    let said = headers.get_all(header::IF_NONE_MATCH).iter().filter_map(|v| v.to_str().ok());
    said.flat_map(|v| v.split(',')).any(|known| {
        let known = known.trim();
        known == "*" || known.strip_prefix("W/").unwrap_or(known) == tag
    })
}

/// A file of the binary.
fn built(path: &str, encoding: Encoding) -> Option<Bytes> {
    let ending = if encoding == Encoding::Identity { ".gz" } else { encoding.ending() };
    let packed = Built::get(&format!("{path}{ending}"))?.data;
    if encoding == Encoding::Identity {
        return SENT.of(&fingerprint::hash(&packed), || unpacked(&packed));
    }
    match packed {
        Cow::Borrowed(bytes) => Some(Bytes::from_static(bytes)),
        Cow::Owned(bytes) => SENT.of(&fingerprint::hash(&bytes), || Some(bytes)),
    }
}

fn unpacked(bytes: &[u8]) -> Option<Vec<u8>> {
    let mut plain = Vec::new();
    GzDecoder::new(bytes).read_to_end(&mut plain).ok()?;
    Some(plain)
}

fn on_disk(folder: &Path, path: &str, encoding: Encoding) -> Option<Bytes> {
    let path = folder.join(format!("{path}{}", encoding.ending())).canonicalize().ok()?;
    if !path.starts_with(folder) || !path.is_file() {
        return None;
    }
    let bytes = std::fs::read(path).ok()?;
    SENT.of(&fingerprint::hash(&bytes), || Some(bytes))
}

fn kind(path: &str) -> &'static str {
    match path.rsplit('.').next().unwrap_or_default() {
        "html" => "text/html; charset=utf-8",
        "js" | "mjs" => "text/javascript; charset=utf-8",
        "css" => "text/css; charset=utf-8",
        "wasm" => "application/wasm",
        "json" | "webmanifest" => "application/json",
        "svg" => "image/svg+xml",
        "png" => "image/png",
        "ico" => "image/x-icon",
        "ttf" => "font/ttf",
        "woff2" => "font/woff2",
        "txt" => "text/plain; charset=utf-8",
        _ => "application/octet-stream",
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write as _;

    use super::*;

    #[test]
    fn others_get_the_file_as_it_was() {
        let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
        packed.write_all(NONE.as_bytes()).expect("packed");
        assert_eq!(unpacked(&packed.finish().expect("packed")).as_deref(), Some(NONE.as_bytes()));
        assert_eq!(unpacked(NONE.as_bytes()), None, "no gzip");
    }
}

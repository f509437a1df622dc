//! The web page: contained in the binary, or read from a folder during its development.
//!
//! The binary holds each file as gzip (`web/pack.mjs`), and sends it so: it is a quarter smaller, and
//! the page is there sooner over a network. Only a client that does not read gzip (a `curl`, not a
//! browser) gets the file as it was.

use std::borrow::Cow;
use std::io::Read as _;
use std::path::Path;

use axum::extract::State;
use axum::http::{HeaderMap, HeaderValue, StatusCode, Uri, header};
use axum::response::{IntoResponse, Response};
use flate2::read::GzDecoder;
use rust_embed::RustEmbed;

use super::fingerprint;
use super::shared::Shared;

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

/// Answers with a file of the page.
pub(super) async fn asset(State(shared): State<Shared>, uri: Uri, headers: HeaderMap) -> Response {
    let path = match uri.path().trim_start_matches('/') {
        "" => "index.html",
        // The same page, which shows itself otherwise there.
        "operator" if shared.station.is_some() => "index.html",
        path => path,
    };
    let packed = reads_gzip(&headers);
    let found = match &shared.page {
        Some(folder) => on_disk(folder, path).map(|plain| (Cow::Owned(plain), false)),
        None => Built::get(path).and_then(|file| match packed {
            true => Some((file.data, true)),
            false => unpacked(&file.data).map(|plain| (Cow::Owned(plain), false)),
        }),
    };
    let Some((bytes, packed)) = found else {
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
    if headers.get(header::IF_NONE_MATCH).is_some_and(|known| known.as_bytes() == tag.as_bytes()) {
        return (StatusCode::NOT_MODIFIED, head).into_response();
    }
    let mut response = (head, bytes.into_owned()).into_response();
    if packed {
        response.headers_mut().insert(header::CONTENT_ENCODING, HeaderValue::from_static("gzip"));
    }
    response
}

/// True if the client says that it reads gzip.
fn reads_gzip(headers: &HeaderMap) -> bool {
    headers.get_all(header::ACCEPT_ENCODING).iter().filter_map(|v| v.to_str().ok()).any(|encodings| {
        encodings.split(',').any(|encoding| {
            let (name, weight) = encoding.split_once(';').unwrap_or((encoding, ""));
            let refused = weight.trim().strip_prefix("q=").is_some_and(|q| q.parse() == Ok(0.0));
            name.trim().eq_ignore_ascii_case("gzip") && !refused
        })
    })
}

fn unpacked(bytes: &[u8]) -> Option<Vec<u8>> {
    let mut plain = Vec::new();
    GzDecoder::new(bytes).read_to_end(&mut plain).ok()?;
    Some(plain)
}

fn on_disk(folder: &Path, path: &str) -> Option<Vec<u8>> {
    let path = folder.join(path).canonicalize().ok()?;
    if !path.starts_with(folder) || !path.is_file() {
        return None;
    }
    std::fs::read(path).ok()
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
    fn gzip_is_sent_to_who_reads_it() {
        let reads = |said: &'static str| {
            let mut headers = HeaderMap::new();
            headers.insert(header::ACCEPT_ENCODING, HeaderValue::from_static(said));
            reads_gzip(&headers)
        };
        for said in ["gzip", "deflate, GZIP", "br;q=1.0, gzip;q=0.8, *;q=0.1"] {
            assert!(reads(said), "{said}");
        }
        for said in ["", "identity", "br", "gzip;q=0", "gzip; q=0.0", "x-gzip-not"] {
            assert!(!reads(said), "{said}");
        }
        assert!(!reads_gzip(&HeaderMap::new()));
    }

    #[test]
    fn others_get_the_file_as_it_was() {
        let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
        packed.write_all(NONE.as_bytes()).expect("packed");
        assert_eq!(unpacked(&packed.finish().expect("packed")).as_deref(), Some(NONE.as_bytes()));
        assert_eq!(unpacked(NONE.as_bytes()), None, "no gzip");
    }
}

//! The files of the page: each client gets the form that it reads.

use std::io::Read as _;

use super::*;

/// A text, and what Node's zlib makes of it as Brotli and as gzip.
const PLAIN: [&str; 100] = ["GRAFCET "; 100];
const BROTLI: &[u8] = b"\x1b\x1f\x03\xf8\xc5\x63\x6c\x5d\xeb\x4a\xf8\x12\xbd\x85\x03\xa4\x75\x8c\x7c\x00";
const GZIP: &[u8] = b"\x1f\x8b\x08\x00\x00\x00\x00\x00\x00\x03\x73\x0f\x72\x74\x73\x76\x0d\x51\x70\x1f\xa5\x47\xe9\x51\x1a\x83\x06\x00\x35\xbf\x80\x3c\x20\x03\x00\x00";

fn unbrotli(bytes: &[u8]) -> Vec<u8> {
    let mut plain = Vec::new();
    brotli_decompressor::Decompressor::new(bytes, 4096).read_to_end(&mut plain).expect("Brotli");
    plain
}

fn ungzip(bytes: &[u8]) -> Vec<u8> {
    let mut plain = Vec::new();
    flate2::read::GzDecoder::new(bytes).read_to_end(&mut plain).expect("gzip");
    plain
}

/// Asks for a file as a client that says this about encodings.
async fn asked(server: &Server, path: &str, said: Option<&str>, more: &[(&str, &str)]) -> Reply {
    let host = server.bound.to_string();
    let mut headers = vec![("Host", host.as_str())];
    headers.extend(said.map(|said| ("Accept-Encoding", said)));
    headers.extend(more);
    server.bare("GET", path, &headers, "").await
}

/// Asks in many ways for a file that is there in all forms.
async fn is_there_in_all_forms(server: &Server, path: &str, plain: &[u8]) {
    let cases = [
        (None, None),
        (Some("identity"), None),
        (Some("gzip, deflate, br, zstd"), Some("br")),
        (Some("br"), Some("br")),
        (Some("gzip"), Some("gzip")),
        (Some("br;q=0, gzip"), Some("gzip")),
        (Some("br;q=0, gzip;q=0.0"), None),
        (Some("br;q=0.1, gzip;q=0.9"), Some("gzip")),
    ];
    let mut tags = Vec::new();
    for (said, right) in cases {
        let reply = asked(server, path, said, &[]).await.is(200);
        assert_eq!(reply.header("content-encoding"), right, "{said:?}");
        assert_eq!(reply.header("vary"), Some("accept-encoding"), "{said:?}");
        assert_eq!(reply.header("content-length"), Some(reply.body.len().to_string().as_str()), "{said:?}");
        let unpacked = match right {
            Some("br") => unbrotli(&reply.body),
            Some(_) => ungzip(&reply.body),
            None => reply.body.clone(),
        };
        assert!(unpacked == plain, "{said:?}: other bytes");
        // The tag is that of the form: it is known again, and none of another form.
        let tag = reply.tag();
        asked(server, path, said, &[("If-None-Match", &format!("\"other\", {tag}"))]).await.is(304);
        tags.push((right, tag));
    }
    for (one, tag) in &tags {
        assert!(tags.iter().all(|(other, t)| (one == other) == (tag == t)), "{tags:?}");
    }
    asked(server, path, Some("identity;q=0, zstd"), &[]).await.is(406);
}

#[tokio::test]
async fn a_folder_may_have_packed_forms_beside_its_files() {
    let server = Server::new().await;
    let plain = PLAIN.concat();
    fs::write(server.path("page.wasm"), &plain).expect("written");
    let reply = asked(&server, "/page.wasm", Some("br, gzip"), &[]).await.is(200);
    assert_eq!(reply.header("content-encoding"), None, "there is no other form");
    assert_eq!(reply.text(), plain);
    fs::write(server.path("page.wasm.br"), BROTLI).expect("written");
    fs::write(server.path("page.wasm.gz"), GZIP).expect("written");
    is_there_in_all_forms(&server, "/page.wasm", plain.as_bytes()).await;
    let reply = asked(&server, "/page.wasm", Some("br"), &[]).await.is(200);
    assert_eq!(reply.body, BROTLI);
    assert_eq!(reply.header("content-type"), Some("application/wasm"));
}

#[tokio::test]
async fn the_page_in_the_program_has_all_forms() {
    let server = Server::with(|args| args.page_dir = None, Limits::default()).await;
    let dist = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../web/dist");
    for name in ["index.html", "g7.wasm", "g7-whole.wasm"] {
        let Ok(plain) = fs::read(dist.join(name)) else {
            return g7_peers::skip("the page is not built");
        };
        is_there_in_all_forms(&server, &format!("/{name}"), &plain).await;
    }
    let plain = fs::read(dist.join("index.html")).expect("it was there");
    is_there_in_all_forms(&server, "/", &plain).await;
    asked(&server, "/g7.wasm.br", Some("br"), &[]).await.is(404);
}

//! Files: complete writes, known hashes, only inside the folder.

use super::*;

const AT: &str = "/api/file?path=";

#[tokio::test]
async fn files_are_listed_and_read_with_their_hash() {
    let server = Server::new().await;
    fs::create_dir_all(server.path("tank")).expect("a folder");
    fs::write(server.path("tank/tank.g7"), "// A tank\n// that fills. And more.\n\nchart T {}\n")
        .expect("a chart");
    fs::write(server.path("tank/view.svg"), "<svg/>").expect("a picture");
    for other in ["notes.txt", ".hidden.g7", "tank/key.pem"] {
        fs::write(server.path(other), "not for pages").expect("a file");
    }
    let files = server.get("/api/files").await.is(200).json()["files"].clone();
    let paths: Vec<_> = files.as_array().expect("a list").iter().map(|f| f["path"].clone()).collect();
    assert_eq!(paths, ["chart.g7", "tank/tank.g7", "tank/view.svg"]);
    assert_eq!(files[1]["title"], "A tank that fills");
    assert_eq!(files[2]["size"], 6);
    let read = server.get(&format!("{AT}tank/tank.g7")).await.is(200);
    assert_eq!(read.tag(), format!("\"{}\"", files[1]["hash"].as_str().expect("a hash")));
    assert!(read.text().starts_with("// A tank"));
    let picture = server.get(&format!("{AT}tank%2Fview.svg")).await.is(200);
    assert_eq!(
        picture.header("content-type"),
        Some("text/plain; charset=utf-8"),
        "no browser runs what is in it"
    );
    assert!(server.get(&format!("{AT}none.g7")).await.is(404).text().contains("none.g7"));
}

#[tokio::test]
async fn a_file_is_written_where_it_is_as_the_page_knew_it() {
    let server = Server::new().await;
    let tag = server.get(&format!("{AT}chart.g7")).await.tag();
    let put = server.ask("PUT", &format!("{AT}chart.g7"), &[("If-Match", &tag)], "mine").await.is(204);
    assert_eq!(server.on_disk("chart.g7"), "mine");
    assert_eq!(put.tag(), server.get(&format!("{AT}chart.g7")).await.tag());
    assert_eq!(fs::read_dir(server.path("")).expect("the folder").count(), 1, "nothing left beside it");
}

#[tokio::test]
async fn a_file_changed_outside_is_never_overwritten() {
    let server = Server::new().await;
    let at = format!("{AT}chart.g7");
    let known = server.get(&at).await.tag();
    fs::write(server.path("chart.g7"), "theirs").expect("a change outside");
    let put = server.ask("PUT", &at, &[("If-Match", &known)], "mine").await.is(412);
    assert_eq!(put.text(), "theirs", "the present text comes back");
    assert_eq!(server.on_disk("chart.g7"), "theirs");
    // With the tag of the refused write, the client may overwrite.
    server.ask("PUT", &at, &[("If-Match", &put.tag())], "merged").await.is(204);
    assert_eq!(server.on_disk("chart.g7"), "merged");
    // A deleted file counts as changed.
    let known = server.get(&at).await.tag();
    fs::remove_file(server.path("chart.g7")).expect("deleted outside");
    let put = server.ask("PUT", &at, &[("If-Match", &known)], "mine").await.is(412);
    assert_eq!((put.text().as_str(), put.header("etag")), ("", None));
    server.ask("PUT", &at, &[("If-None-Match", "*")], "mine").await.is(204);
    server.ask("PUT", &at, &[("If-None-Match", "*")], "twice").await.is(412);
    server.ask("PUT", &at, &[], "blind").await.is(428);
    assert_eq!(server.on_disk("chart.g7"), "mine");
}

#[tokio::test]
async fn files_are_made_renamed_and_deleted() {
    let server = Server::new().await;
    let post = async |what: &str, body: Value| {
        server.ask("POST", &format!("/api/{what}"), &[], &body.to_string()).await
    };
    post("new", json!({ "path": "a/b/new.g7", "text": "chart N {}" })).await.is(204);
    assert_eq!(server.on_disk("a/b/new.g7"), "chart N {}");
    let again = post("new", json!({ "path": "a/b/new.g7" })).await.is(409);
    assert!(again.text().contains("already"), "{}", again.text());
    post("rename", json!({ "from": "a/b/new.g7", "to": "chart.g7" })).await.is(409);
    assert_eq!(server.on_disk("chart.g7"), CHART, "nothing is replaced");
    post("rename", json!({ "from": "a/b/new.g7", "to": "named.g7" })).await.is(204);
    assert_eq!(server.on_disk("named.g7"), "chart N {}");
    assert!(!server.path("a/b/new.g7").exists());
    post("rename", json!({ "from": "none.g7", "to": "x.g7" })).await.is(404);
    post("delete", json!({ "path": "named.g7", "hash": "other" })).await.is(412);
    post("delete", json!({ "path": "named.g7" })).await.is(204);
    assert!(!server.path("named.g7").exists());
    post("delete", json!({ "path": "named.g7" })).await.is(404);
    post("delete", json!(["what"])).await.is(400);
}

#[tokio::test]
async fn names_that_lead_out_of_the_folder_are_refused() {
    let server = Server::new().await;
    let absolute = server.root.join("secret.g7").display().to_string();
    let names = [
        "../secret.g7",
        "..%2Fsecret.g7",
        "a/../../secret.g7",
        "%2e%2e/secret.g7",
        "..%5Csecret.g7",
        &absolute,
        "C:secret.g7",
        "CON.g7",
        "x.g7%00",
        ".g7",
        "/chart.g7",
        "chart.g7/../../secret.g7",
        "notes.txt",
    ];
    for name in names {
        let at = format!("{AT}{name}");
        let reply = server.get(&at).await.is(400);
        assert!(!reply.text().is_empty() && reply.text() != "secret", "{name}");
        server.ask("PUT", &at, &[("If-Match", "*")], "x").await.is(400);
        server.ask("PUT", &at, &[("If-None-Match", "*")], "x").await.is(400);
        server.ask("PUT", &format!("/api/draft?window=a&end=open&path={name}"), &[], "x").await.is(400);
    }
    let out = json!({ "from": "chart.g7", "to": "../taken.g7" }).to_string();
    server.ask("POST", "/api/rename", &[], &out).await.is(400);
    let out = json!({ "path": "../secret.g7" }).to_string();
    server.ask("POST", "/api/delete", &[], &out).await.is(400);
    assert_eq!(fs::read_to_string(server.root.join("secret.g7")).expect("there"), "secret");
    assert!(!server.root.join("taken.g7").exists());
}

#[cfg(unix)]
#[tokio::test]
async fn links_out_of_the_folder_are_refused() {
    use std::os::unix::fs::symlink;
    let server = Server::new().await;
    symlink(server.root.join("secret.g7"), server.path("link.g7")).expect("a link");
    symlink(&server.root, server.path("up")).expect("a link to a folder");
    symlink(server.root.join("made.g7"), server.path("dangling.g7")).expect("a link to nothing");
    for name in ["link.g7", "up/secret.g7", "up/new.g7", "dangling.g7", "up/a/b.g7"] {
        let at = format!("{AT}{name}");
        assert!(server.get(&at).await.is(403).text().contains("link"), "{name}");
        server.ask("PUT", &at, &[("If-Match", "*")], "x").await.is(403);
        server.ask("PUT", &at, &[("If-None-Match", "*")], "x").await.is(403);
    }
    let files = server.get("/api/files").await.json();
    assert_eq!(files["files"].as_array().map(Vec::len), Some(1), "links out are not listed: {files}");
    assert_eq!(fs::read_to_string(server.root.join("secret.g7")).expect("there"), "secret");
    assert!(!server.root.join("made.g7").exists() && !server.root.join("new.g7").exists());
    // A link that stays inside the folder remains a link.
    symlink(server.path("chart.g7"), server.path("inside.g7")).expect("a link");
    server.ask("PUT", &format!("{AT}inside.g7"), &[("If-Match", "*")], "through").await.is(204);
    assert_eq!(server.on_disk("chart.g7"), "through");
}

#[cfg(unix)]
#[tokio::test]
async fn a_pipe_is_not_waited_for() {
    let server = Server::new().await;
    let made = std::process::Command::new("mkfifo").arg(server.path("pipe.g7")).status().expect("mkfifo");
    assert!(made.success());
    assert!(server.get(&format!("{AT}pipe.g7")).await.is(403).text().contains("not a regular file"));
    server.ask("PUT", &format!("{AT}pipe.g7"), &[("If-Match", "*")], "x").await.is(403);
    server.get("/api/files").await.is(200);
}

#[tokio::test]
async fn read_only_writes_nothing() {
    let server = Server::with(|args| args.read_only = true, Limits::default()).await;
    assert_eq!(server.get("/api/info").await.json()["read_only"], true);
    let at = format!("{AT}chart.g7");
    let tag = server.get(&at).await.is(200).tag();
    let reply = server.ask("PUT", &at, &[("If-Match", &tag)], "mine").await.is(403);
    assert!(reply.text().contains("--read-only"), "{}", reply.text());
    server.ask("PUT", &format!("{AT}new.g7"), &[("If-None-Match", "*")], "mine").await.is(403);
    for (what, body) in [
        ("new", json!({ "path": "new.g7" })),
        ("rename", json!({ "from": "chart.g7", "to": "new.g7" })),
        ("delete", json!({ "path": "chart.g7" })),
    ] {
        server.ask("POST", &format!("/api/{what}"), &[], &body.to_string()).await.is(403);
    }
    server.ask("PUT", "/api/draft?window=a&end=open&path=chart.g7", &[], "mine").await.is(403);
    server.ask("POST", "/api/draft/saved?window=a&path=chart.g7", &[], "").await.is(403);
    server.ask("DELETE", "/api/draft?window=a&id=0-0", &[], "").await.is(403);
    assert_eq!(server.on_disk("chart.g7"), CHART);
    assert_eq!(fs::read_dir(server.path("")).expect("the folder").count(), 1);
    // Charts can still be run, because a run writes nothing.
    assert_eq!(server.live().await.start("a").await["run"], "a");
}

#[tokio::test]
async fn changes_outside_are_told_once_to_every_page() {
    let server = Server::new().await;
    // A file that is emptied before it is written would be told twice.
    let put = |name: &str, text: &str| {
        let aside = server.root.join("aside");
        fs::write(&aside, text)
            .and_then(|()| fs::rename(&aside, server.path(name)))
            .expect("a change outside");
    };
    let (mut one, mut two) = (server.live().await, server.live().await);
    // Both clients are connected before the change.
    one.call(json!({ "do": "runs" })).await;
    two.call(json!({ "do": "runs" })).await;
    put("chart.g7", "theirs");
    let hash = fingerprint::hash(b"theirs");
    for page in [&mut one, &mut two] {
        assert_eq!(page.hear_of("changed").await, json!({ "path": "chart.g7", "hash": hash }));
    }
    // A file of the same length and the same second counts as changed too.
    let mut file = fs::OpenOptions::new().write(true).open(server.path("chart.g7")).expect("the chart");
    std::io::Write::write_all(&mut file, b"THEIRS").expect("a change outside");
    assert_eq!(one.hear_of("changed").await["hash"], fingerprint::hash(b"THEIRS"));
    put("more.g7", "new");
    assert_eq!(one.hear_of("changed").await["path"], "more.g7");
    fs::remove_file(server.path("more.g7")).expect("gone");
    assert_eq!(one.hear_of("changed").await, json!({ "path": "more.g7", "hash": "" }));
    // A write by one client is announced to the others.
    server.ask("PUT", &format!("{AT}chart.g7"), &[("If-Match", "*")], "mine").await.is(204);
    assert_eq!(one.hear_of("changed").await["hash"], fingerprint::hash(b"mine"));
}

#[tokio::test]
async fn a_file_of_100_mb_is_refused_before_it_is_read() {
    let server = Server::new().await;
    let head = |more: &str| {
        format!(
            "PUT {AT}chart.g7 HTTP/1.1\r\nHost: {}\r\nAuthorization: Bearer {}\r\nIf-Match: *\r\n\
             Connection: close\r\n{more}\r\n\r\n",
            server.bound, server.token
        )
    };
    let reply = server.raw(head("Content-Length: 104857600").as_bytes()).await.is(413);
    assert!(reply.text().contains("8 MB"), "{}", reply.text());
    // Without a length, the body is read up to the limit.
    let mut endless = head("Transfer-Encoding: chunked").into_bytes();
    let block = [b"100000\r\n".as_slice(), &vec![b'x'; 1 << 20], b"\r\n"].concat();
    (0..9).for_each(|_| endless.extend_from_slice(&block));
    let mut stream = TcpStream::connect(server.bound).await.expect("a connection");
    let (mut from, mut to) = stream.split();
    let write = async {
        to.write_all(&endless).await.ok();
        std::future::pending::<()>().await;
    };
    let mut answer = [0u8; 12];
    tokio::select! {
        () = write => {}
        read = from.read_exact(&mut answer) => drop(read.expect("an answer")),
    }
    assert_eq!(&answer, b"HTTP/1.1 413");
    assert_eq!(server.on_disk("chart.g7"), CHART);
    // A file of that size is not opened either.
    fs::File::create(server.path("large.g7")).and_then(|f| f.set_len(100 << 20)).expect("a large file");
    server.get(&format!("{AT}large.g7")).await.is(413);
}
